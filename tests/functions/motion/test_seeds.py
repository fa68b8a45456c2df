"""Seed cases of motion: constant speeds, projections, ICR, VAF, segments; each through the command line.

A case whose layout is not given is put on the robot file that its numbers describe.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wmrgen
from tests.depth import BACKENDS
from tests.functions.motion.common import compute, run_cli
from tests.oracle.harness import Model, named, robot_text, turn
from tests.seeds import layouts

CASES: dict[str, Any] = {
    c["id"]: c
    for c in json.loads((Path(__file__).parents[3] / "textbook" / "cases.json").read_text(encoding="utf-8"))[
        "cases"
    ]
}


class Run:
    """A case, its robot file and functions on one backend."""

    def __init__(self, name: str, folder: Path, backend: str = "exact") -> None:
        self.case, self.backend = CASES[name], backend
        self.given, self.expect = self.case["given"], self.case["expect"]
        self.path = folder / "robot.yaml"
        self.steer: dict[str, float] = {}
        if self.case["layout"]:
            layout, self.steer = layouts.of(self.case, "cartesian")
            self.write(robot_text(layout))

    def write(self, text: str) -> None:
        self.path.write_text(text, encoding="utf-8")

    @property
    def wheels(self) -> list[str]:
        return [w["name"] for w in self.case["layout"]["wheels"]]

    def call(self, function: str, **values: float) -> dict[str, float]:
        """Dots in names are written as double underscores."""
        given = {k.replace("__", "."): v for k, v in values.items()}
        return compute(self.path, function, [given], self.backend)[0]

    def spins(self, rates: Any) -> dict[str, float]:
        names = rates if isinstance(rates, dict) else dict(zip(self.wheels, rates, strict=True))
        return {f"{n}__spin": v for n, v in names.items()}

    def body(self) -> dict[str, float]:
        """The case's world twist in the robot frame."""
        return named(turn(-self.given["phi"]) @ np.array(self.given["twist_world"], float))

    def close(self, result: Any, wanted: Any) -> None:
        np.testing.assert_allclose(
            np.asarray(result, float), np.asarray(wanted, float), rtol=self.case["tol"], atol=self.case["tol"]
        )


@pytest.fixture(params=BACKENDS)
def on(request: pytest.FixtureRequest, tmp_path: Path) -> Callable[[str], Run]:
    """Case id to its run, on every backend."""
    return lambda name: Run(name, tmp_path, request.param)


@pytest.mark.parametrize("name", ["K-straight", "K-circle-a", "T-2.36-arc"])
def test_constant_speeds(on: Callable[[str], Run], name: str) -> None:
    run = on(name)
    spins = run.spins(run.given["wheel_rates"])
    pose = dict(zip(("x", "y", "theta"), run.given["state0"], strict=True))
    end = run.call("motion", **spins, **pose, dt=run.given["t"])
    run.close([end[k] for k in ("x", "y", "theta")], run.expect["state"])
    circle = run.call("circle", **spins, **pose)
    if "speed" in run.expect:
        assert circle["turns"] == 0
        run.close(circle["speed"], run.expect["speed"])
    if "R" in run.expect:
        run.close([circle["x_centre"], circle["y_centre"]], run.expect["center"])
        result = [circle[k] for k in ("radius", "speed", "direction", "curvature", "period")]
        e = run.expect
        run.close(result, [e["R"], e["v"], e["theta"], -e["omega0"] / e["v"], 2 * math.pi / e["omega0"]])
        assert circle["turns"] == -1


def test_k_projections(on: Callable[[str], Run]) -> None:
    for name in ("K-3", "K-2", "K-vi2"):
        run = on(name)
        result = run.call("projections", theta=run.given["phi"], **run.body())
        e = run.expect
        velocities = [[result[f"{w}.{k}"] for k in ("x_rate", "y_rate")] for w in run.wheels]
        if name == "K-3":
            run.close([result[f"{w}.along"] for w in run.wheels], e["lambda"])
            run.close([result[f"{w}.across"] for w in run.wheels], e["mu"])
            run.close(sum(result[f"{w}.across"] for w in run.wheels), e["sum_mu"])
        elif name == "K-2":
            run.close(velocities, e["wheel_velocities"])
        else:
            run.close([a * a + b * b for a, b in velocities], e["v_i_squared"])


def test_k_mu(on: Callable[[str], Run]) -> None:
    run = on("K-mu")
    twist = run.call("forward", **run.spins(run.given["wheel_rates"]))
    twist.pop("slip")
    result = run.call("projections", **twist)
    run.close([result[f"{w}.across"] for w in run.wheels], run.expect["mu"])
    run.close(twist["vx"] ** 2 + twist["vy"] ** 2, run.expect["v_squared"])


@pytest.mark.parametrize("name", ["K-4", "K-4-detail", "T-2.75-ik", "T-2.84-2.85"])
def test_inverse_world(on: Callable[[str], Run], name: str) -> None:
    run = on(name)
    rates = dict(zip(("x_rate", "y_rate", "theta_rate"), run.given["twist_world"], strict=True))
    result = run.call("inverse_world", theta=run.given["phi"], **rates)
    run.close([result[f"{w}.spin"] for w in run.wheels], run.expect["wheel_rates"])


@pytest.mark.parametrize("name", ["T-2.41c", "T-2.75"])
def test_inverse_world_matrix(on: Callable[[str], Run], name: str) -> None:
    run = on(name)
    order = run.given.get("wheel_order", run.wheels)
    columns = [
        run.call("inverse_world", theta=run.given["phi"], **{k: 1.0})
        for k in ("x_rate", "y_rate", "theta_rate")
    ]
    run.close([[c[f"{w}.spin"] for c in columns] for w in order], run.expect["value"])


@pytest.mark.parametrize("name", ["K-5", "T-2.36", "S-3.33-world"])
def test_forward_world(on: Callable[[str], Run], name: str) -> None:
    run = on(name)
    result = run.call("forward_world", theta=run.given["phi"], **run.spins(run.given["wheel_rates"]))
    run.close([result[k] for k in ("x_rate", "y_rate", "theta_rate")], run.expect["twist_world"])


def test_forward_world_matrix(on: Callable[[str], Run]) -> None:
    run = on("T-2.37d")
    columns = [
        run.call("forward_world", theta=run.given["phi"], **{f"{w}__spin": 1.0})
        for w in run.given["wheel_order"]
    ]
    run.close([[c[k] for c in columns] for k in ("x_rate", "y_rate", "theta_rate")], run.expect["value"])


def test_mecanum_compatibility(on: Callable[[str], Run]) -> None:
    run = on("T-mec-compat")
    joints = run.call("inverse", **named(run.given["twist_body"]))
    spins = {k.replace(".", "__"): v for k, v in joints.items() if k.endswith(".spin")}
    run.close(run.call("compatibility", **spins)["residual1"], run.expect["theta1+theta2-theta3-theta4"])


def test_mecanum_diagonal(on: Callable[[str], Run]) -> None:
    run = on("S-2.3.2.2-diag")
    result = run.call("forward_world", theta=0.0, **run.spins(run.given["wheel_rates"]))
    run.close([result[k] for k in ("x_rate", "y_rate", "theta_rate")], run.expect["twist_body"])


def test_tricycle_radius(on: Callable[[str], Run]) -> None:
    run = on("T-2.48")
    result = run.call("axles", front__steer=run.given["psi"])
    run.close([result["radius"], result["curvature"]], [run.expect["R"], 1 / run.expect["R"]])
    run.close(result["mismatch"], 0.0)


ONE_WHEEL = "wmrgen: 1\nname: one\nwheels:\n  - {name: w, type: %s, x: 0, y: 0, heading: %r, r: %r}\n"


def test_icr_of_a_twist(on: Callable[[str], Run]) -> None:
    """The twist is given at the point p: the origin of the robot is p."""
    run = on("KE-ICR")
    run.write(ONE_WHEEL % ("steered", 0.0, 0.1))
    g, e = run.given, run.expect
    p, q = np.array(g["p"]), np.array(g["q"])
    values = {"vx": g["v_p"][0], "vy": g["v_p"][1], "omega": g["omega"]}
    result = run.call("icr", **values, point__x=float((q - p)[0]), point__y=float((q - p)[1]))
    run.close(p + np.array([result["icr.x"], result["icr.y"]]) / result["icr.w"], e["icr"])
    run.close(result["radius"], e["radius_p"])
    run.close([result["point.vx"], result["point.vy"]], e["v_q"])


def four_steered(places: list[list[float]]) -> str:
    wheels = "".join(
        f"  - {{name: w{k}, type: steered, x: {x!r}, y: {y!r}, heading: 0, r: 1}}\n"
        for k, (x, y) in enumerate(places)
    )
    return f"wmrgen: 1\nname: four\nwheels:\n{wheels}"


def test_crab_steering(on: Callable[[str], Run]) -> None:
    run = on("KE-jeantaud-crab")
    run.write(four_steered(run.given["wheels"]))
    vx, vy = run.given["v_body"]
    names = [f"w{k}" for k in range(4)]
    joints = run.call("inverse_world", x_rate=vx, y_rate=vy)
    run.close([joints[f"{n}.steer"] for n in names], run.expect["steer"])
    run.close([joints[f"{n}.spin"] for n in names], run.expect["wheel_speed"])
    to = run.call("steer_to", icr__x=-vy, icr__y=vx, icr__w=run.given["omega"])
    run.close([to[f"{n}.steer"] for n in names], run.expect["steer"])
    back = run.call("axles", **{f"{n}__steer": to[f"{n}.steer"] for n in names})
    run.close([back["icr.w"], back["mismatch"]], [0.0, 0.0])
    run.close(math.tan(math.atan2(back["icr.y"], back["icr.x"])), -vx / vy)


def test_sensed_velocity(on: Callable[[str], Run]) -> None:
    run = on("KE-sense")
    run.write(ONE_WHEEL % ("steered", 0.0, run.given["r"]))
    result = run.call("forward_world", w__spin=run.given["omega_wheel"], w__steer=run.given["gamma"])
    run.close([result["x_rate"], result["y_rate"]], run.expect["v_xy"])
    run.close(math.hypot(result["x_rate"], result["y_rate"]), run.expect["v"])


def test_roller_and_rim_speed(on: Callable[[str], Run]) -> None:
    run = on("T-2.71")
    g = run.given
    run.write(ONE_WHEEL % ("swedish", g["beta"], 1.0))
    result = run.call("projections", vx=g["v_h"] * math.cos(g["gamma"]), vy=g["v_h"] * math.sin(g["gamma"]))
    run.close([result["w.along"], abs(result["w.across"])], [run.expect["v_i"], run.expect["v_roller_abs"]])


def omni(directions: list[float]) -> str:
    """Omni wheels at 0.2 m that drive in these directions [deg]."""
    wheels = "".join(
        f"  - {{name: w{k}, type: swedish, l: 0.2, alpha: {b - 90:g} deg, beta: pi, gamma: 0, r: 0.05}}\n"
        for k, b in enumerate(directions)
    )
    return f"wmrgen: 1\nname: omni\nwheels:\n{wheels}"


def test_velocity_augmentation_of_three(on: Callable[[str], Run]) -> None:
    run = on("T-VAF3")
    run.write(omni([run.given["beta_deg"], 180.0, 300.0]))
    result = run.call("vaf", direction=math.radians(run.given["gamma_deg"]))
    run.close(result["vaf"], run.expect["VAF"])


def test_augmentation_extremes(tmp_path: Path) -> None:
    """The polygon of translations is nearest across an edge, along a wheel, and farthest in a corner, between two."""
    for directions, largest in (
        ([60.0, 180.0, 300.0], 2 / math.sqrt(3)),
        ([45.0, 135.0, 225.0, 315.0], math.sqrt(2)),
    ):
        path = tmp_path / "omni.yaml"
        path.write_text(omni(directions), encoding="utf-8")
        d = wmrgen.derive(wmrgen.load(path), ["vaf"])
        factors = d.numpy().vaf(np.radians(np.arange(360)))["vaf"]
        assert max(factors) == pytest.approx(largest, abs=1e-12)
        assert min(factors) == pytest.approx(1, abs=1e-12)


def test_generalized_bicycle_stack(tmp_path: Path) -> None:
    run = Run("KE-genbike-H", tmp_path)
    run.write(four_steered(run.given["wheels"]))
    H = np.array(wmrgen.derive(wmrgen.load(run.path), []).H.evalf(), float)
    run.close(H, run.expect["value"])
    run.close(np.linalg.pinv(H), run.expect["pinv"])
    box = Run("KE-box42-gram", tmp_path)
    box.close(np.linalg.det(H.T @ H), box.expect["det_HtH"])
    assert (np.linalg.matrix_rank(H) == 3) == box.expect["invertible"]


def test_four_wheel_steer_stacks(tmp_path: Path) -> None:
    run = Run("KE-4ws-HQ", tmp_path)
    model = Model(run.path)
    run.close(model.evaluate(model.derivation.H, run.steer), run.expect["H"])
    run.close(model.evaluate(model.derivation.Q, run.steer), run.expect["Q"])


@pytest.mark.parametrize("name", ["KE-4ws-vc", "KE-speed"])
def test_contact_velocities(on: Callable[[str], Run], name: str) -> None:
    run = on(name)
    values = {f"{k}__steer": v for k, v in run.steer.items()}
    rates = np.atleast_1d(run.given["gamma_dot"])
    values |= {f"{n}__steer_rate": float(v) for n, v in zip(run.wheels, rates, strict=True)}
    result = run.call("contact_velocity", **named(run.given["twist_body"]), **values)
    run.close([result[f"{n}.{k}"] for n in run.wheels for k in ("vx", "vy")], run.expect["v_c"])


def test_generalized_bicycle_contacts(on: Callable[[str], Run]) -> None:
    run = on("KE-genbike-ik")
    result = run.call("contact_velocity", **named(run.given["twist_body"]))
    run.close([result[f"{n}.{k}"] for n in run.wheels for k in ("vx", "vy")], run.expect["v_c"])


def test_car_with_parallel_front_wheels_warns(tmp_path: Path) -> None:
    """S-car-incompatible: rank C1 = 3, mobility 0 at these angles."""
    run = Run("S-car-incompatible", tmp_path)
    words = [f"{k}.steer={v!r}" for k, v in run.steer.items()]
    out, err = run_cli("icr", str(run.path), *words, "--json")
    result = json.loads(out)
    assert result["rank"] == run.expect["rank_C1"]
    assert result["mobility"] == 0 and not result["consistent"]
    assert "incompatible steering" in err
    assert result["wheels"]["fr"]["error"] * result["wheels"]["fl"]["error"] < 0


def test_figure_3_15(tmp_path: Path) -> None:
    run = Run("S-F3.15", tmp_path)
    file = tmp_path / "segments.json"
    keys = ("x_rate", "y_rate", "theta_rate")
    file.write_text(
        json.dumps(
            [
                dict(zip(keys, s["twist_world"], strict=True)) | {"dt": s["duration"]}
                for s in run.given["segments"]
            ]
        )
    )
    out, _ = run_cli("motion", str(run.path), "--segments", str(file), "--json")
    phases = json.loads(out)["phases"]
    assert [p["action"] for p in phases] == ["drive"] * 3
    run.close([[p["pose"][k] for k in ("x", "y", "theta")] for p in phases], run.expect["poses"][1:])
    run.close([[p["commands"][f"{w}.spin"] for w in run.wheels] for p in phases], run.expect["wheel_rates"])


def test_figure_3_16(tmp_path: Path) -> None:
    """Five phases: drive, steer to -50 and 50 degrees, turn, steer back, drive."""
    run = Run("S-F3.16", tmp_path)
    run.write(run.path.read_text() + "limits: {steer_rate: 50 deg/s}\n")
    file = tmp_path / "segments.json"
    file.write_text('[{"x_rate": 1, "dt": 1}, {"theta_rate": "pi/2", "dt": 1}, {"y_rate": 1, "dt": 1}]')
    out, _ = run_cli("motion", str(run.path), "--segments", str(file), "--json")
    phases = json.loads(out)["phases"]
    assert [p["action"] for p in phases] == ["drive", "steer", "drive", "steer", "drive"]
    run.close([p["dt"] for p in phases], np.ones(5))
    turned = phases[2]["commands"]
    headings = [math.degrees(turned[f"{w}.steer"]) for w in run.wheels]
    run.close(headings, run.expect["spin_headings_deg"])
    radius = run.case["layout"]["wheels"][0]["r"]
    speeds = [abs(turned[f"{w}.spin"]) * radius / (math.pi / 2) for w in run.wheels]
    run.close(speeds, [run.expect["wheel_speed_abs_for_omega1"]] * 2)
    run.close([phases[-1]["pose"][k] for k in ("x", "y", "theta")], [1, 1, math.pi / 2])


def test_world_and_robot_rates(on: Callable[[str], Run]) -> None:
    """S-3.5: the contact of a wheel at P moves in the world as P does."""
    run = on("S-3.5")
    run.write(ONE_WHEEL % ("steered", 0.0, 0.1))
    result = run.call("projections", theta=run.given["theta"], **named(run.expect["rate_robot"]))
    run.close([result["w.x_rate"], result["w.y_rate"]], run.given["rate_world"][:2])
