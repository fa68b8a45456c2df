"""Motion against independent oracles: integration, finite differences, eigenvalues, brute force."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.functions.motion.common import CAR, FOUR_WS, MECANUM_T, OMNI_K, SKEWED, derived
from tests.oracle.harness import Array, named, turn
from tests.robots import of_gallery, with_functions
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError

ROBOTS = sorted((Path(__file__).parents[3] / "robots").glob("*.yaml"))
NAMES = [p.stem for p in ROBOTS]
RANDOM = np.random.default_rng(7)


@cache
def with_function(name: str, function: str) -> Derivation | None:
    """The derivation of that function alone; None where the robot does not have it."""
    derivation = with_functions(derived(TEXTS[name]) if name in TEXTS else of_gallery(name), [function])
    try:
        _ = derivation.program
    except NotDerivableError:
        return None
    return derivation


@cache
def in_casadi(name: str, function: str) -> Any:
    derivation = with_function(name, function)
    assert derivation is not None
    return derivation.casadi()[function]


TEXTS = {"car": CAR, "skewed": SKEWED, "four_ws": FOUR_WS, "omni_k": OMNI_K, "mecanum": MECANUM_T}


def call(name: str, function: str, values: dict[str, float]) -> dict[str, float]:
    """A function through CasADi; inputs not given are 0, parameters nominal."""
    derivation = with_function(name, function)
    assert derivation is not None
    f = in_casadi(name, function)
    nominal = {p.name: float(p.nominal) for p in derivation.robot.parameters}
    assert values.keys() <= set(f.name_in()), sorted(values.keys() - set(f.name_in()))
    result = f.call([values.get(n, nominal.get(n, 0.0)) for n in f.name_in()])
    return {n: float(v) for n, v in zip(f.name_out(), result, strict=True)}


def inputs(name: str, function: str, scale: float = 1.0) -> dict[str, float]:
    """Random values of the inputs that are not parameters."""
    derivation = with_function(name, function)
    assert derivation is not None
    ports = [p for p in derivation.formula(function).inputs if p.default is None]
    return {p.name: float(v) for p, v in zip(ports, scale * RANDOM.uniform(-1, 1, len(ports)), strict=True)}


def close(result: Any, wanted: Any, tol: float = 1e-9) -> None:
    np.testing.assert_allclose(np.asarray(result, float), np.asarray(wanted, float), rtol=tol, atol=tol)


EVERY = [*NAMES, *TEXTS]
# Which robots have a function that not all have. Written down: finding out takes seconds.
HAVING = {
    "axles": (
        "ackermann_car agilex_ranger bicycle car_with_trailers care_o_bot_4 clearpath_a200 f1tenth jpl_osr kelly_4ws "
        "locked_bicycle neobotix_mpo_700 pr2 synchro_drive textbook_tricycle textbook_two_steer wpilib_swervebot car "
        "skewed four_ws"
    ).split(),
    "vaf": (
        "clearpath_do100 clearpath_r100 festo_robotino kuka_youbot lekiwi nexus_4wd ssl_parsian "
        "textbook_omnidirectional textbook_tribolo textbook_two_spheres omni_k mecanum"
    ).split(),
    "compatibility": (
        "ackermann_car agilex_ranger car_with_trailers care_o_bot_4 clearpath_a200 clearpath_do100 clearpath_r100 "
        "jpl_osr kelly_4ws kuka_youbot locked_bicycle neobotix_mpo_700 nexus_4wd nomad_xr4000 pr2 ssl_parsian "
        "synchro_drive textbook_two_spheres textbook_two_steer tidybot2 wpilib_swervebot car skewed four_ws mecanum"
    ).split(),
    "heading": (
        "andino clearpath_a200 clearpath_do100 clearpath_r100 festo_robotino kuka_youbot lekiwi locked_bicycle mir_100 "
        "neobotix_mp_400 nexus_4wd pioneer3dx ssl_parsian textbook_differential textbook_omnidirectional "
        "textbook_tribolo textbook_two_spheres tractor_off_axle turtlebot3_burger omni_k mecanum"
    ).split(),
}


@pytest.mark.slow
@pytest.mark.parametrize("function", HAVING)
def test_who_has_a_function(function: str) -> None:
    assert HAVING[function] == [n for n in EVERY if with_function(n, function) is not None]


def twist_world(name: str, joints: dict[str, float], theta: float) -> Array:
    result = call(name, "forward_world", joints | {"theta": theta})
    return np.array([result["x_rate"], result["y_rate"], result["theta_rate"]])


@pytest.mark.parametrize("name", EVERY)
def test_motion_is_the_integral_of_forward(name: str) -> None:
    """Runge-Kutta of the world velocity, steering held."""
    values = inputs(name, "motion", 2.0)
    values["dt"] = 1.3
    joints = {k: v for k, v in values.items() if k not in ("x", "y", "theta", "dt")}
    pose, steps = np.array([values["x"], values["y"], values["theta"]]), 60
    h = values["dt"] / steps
    rate = call(name, "forward", joints)
    if abs(rate["omega"]) > 20:
        joints = {k: v if k.endswith(".steer") else v / 10 for k, v in joints.items()}
        values |= joints
        rate = call(name, "forward", joints)
    body = np.array([rate["vx"], rate["vy"], rate["omega"]])
    for _ in range(steps):
        k1 = turn(pose[2]) @ body
        k2 = turn(pose[2] + h / 2 * k1[2]) @ body
        k4 = turn(pose[2] + h * k1[2]) @ body
        pose = pose + h / 6 * (k1 + 4 * k2 + k4)
    end = call(name, "motion", values)
    close([end["x"], end["y"], end["theta"]], pose, 1e-6)
    close(twist_world(name, joints, 0.7), turn(0.7) @ body)


@pytest.mark.parametrize("name", EVERY)
def test_the_path_lies_on_the_circle(name: str) -> None:
    values = inputs(name, "motion", 2.0)
    held = {k: v for k, v in values.items() if k != "dt"}
    circle = call(name, "circle", held)
    for dt in (0.0, 0.4, 1.1):
        end = call(name, "motion", held | {"dt": dt})
        if circle["turns"]:
            distance = math.hypot(end["x"] - circle["x_centre"], end["y"] - circle["y_centre"])
            close(distance, circle["radius"], 1e-7)
            close(end["theta"] - held["theta"], circle["turns"] * 2 * math.pi * dt / circle["period"], 1e-8)
        else:
            along = held["theta"] + circle["direction"]
            close(end["x"] - held["x"], circle["speed"] * dt * math.cos(along), 1e-8)
            close(end["y"] - held["y"], circle["speed"] * dt * math.sin(along), 1e-8)
    if circle["turns"]:
        once = call(name, "motion", held | {"dt": circle["period"]})
        close([once["x"], once["y"]], [held["x"], held["y"]], 1e-7)


@pytest.mark.parametrize("name", NAMES)
def test_straight_where_opposite_twists_cancel(name: str) -> None:
    """At rest nothing moves, and the path is finite."""
    circle = call(name, "circle", {"x": 3.0, "y": -2.0, "theta": 0.4})
    assert circle["turns"] == 0 and circle["speed"] == 0 and circle["radius"] == 0
    close([circle["x_centre"], circle["y_centre"]], [3.0, -2.0])


def contact(w: Any, steer: float) -> Array:
    g = w.nominal
    ch, sh = float(g.ch), float(g.sh)
    c, s = ch * math.cos(steer) - sh * math.sin(steer), sh * math.cos(steer) + ch * math.sin(steer)
    return np.array(
        [float(g.x) + float(g.d) * c - float(g.o) * s, float(g.y) + float(g.d) * s + float(g.o) * c]
    )


@pytest.mark.parametrize("name", EVERY)
def test_contact_velocities_by_finite_differences(name: str) -> None:
    values = inputs(name, "contact_velocity")
    result = call(name, "contact_velocity", values)
    twist = np.array([values["vx"], values["vy"], values["omega"]])
    derivation = with_function(name, "contact_velocity")
    assert derivation is not None
    h = 1e-6
    for w in derivation.robot.wheels:
        steer, rate = values.get(f"{w.name}.steer", 0.0), values.get(f"{w.name}.steer_rate", 0.0)
        ends = []
        for dt in (-h, h):
            ends.append(twist[:2] * dt + turn(twist[2] * dt)[:2, :2] @ contact(w, steer + rate * dt))
        close([result[f"{w.name}.vx"], result[f"{w.name}.vy"]], (ends[1] - ends[0]) / (2 * h), 1e-8)


@pytest.mark.parametrize("name", EVERY)
def test_projections_are_contact_velocities(name: str) -> None:
    values = inputs(name, "projections")
    result = call(name, "projections", values)
    derivation = with_function(name, "contact_velocity")
    assert derivation is not None
    have = {p.name for p in derivation.formula("contact_velocity").inputs}
    velocity = call(name, "contact_velocity", {k: v for k, v in values.items() if k in have})
    for w in derivation.robot.wheels:
        v = np.array([velocity[f"{w.name}.vx"], velocity[f"{w.name}.vy"]])
        close([result[f"{w.name}.x_rate"], result[f"{w.name}.y_rate"]], turn(values["theta"])[:2, :2] @ v)
        if w.kind.directed:
            h = w.heading + values.get(f"{w.name}.steer", 0.0)
            e = np.array([math.cos(h), math.sin(h)])
            close([result[f"{w.name}.along"], result[f"{w.name}.across"]], [e @ v, e[0] * v[1] - e[1] * v[0]])


@pytest.mark.parametrize("name", EVERY)
def test_world_functions_are_the_robot_ones_turned(name: str) -> None:
    values = inputs(name, "inverse_world")
    body = turn(-values["theta"]) @ np.array([values.pop(k) for k in ("x_rate", "y_rate", "theta_rate")])
    theta = values.pop("theta")
    wanted = call(name, "inverse", values | named(body))
    rates = dict(zip(("x_rate", "y_rate", "theta_rate"), turn(theta) @ body, strict=True))
    result = call(name, "inverse_world", values | rates | {"theta": theta})
    for k, v in wanted.items():
        close(result[k], v, 1e-7)


@pytest.mark.parametrize(
    "x", [(0.3, -0.2, 0.0), (0.3, -0.2, 1e-9), (1.0, 2.0, 3.1), (-0.5, 0.1, -3.1), (0.0, 0.0, 1.0)]
)
def test_reach_is_the_inverse_of_odometry(x: tuple[float, float, float]) -> None:
    twist = call("unicycle", "reach", dict(zip(("x", "y", "theta"), x, strict=True)) | {"dt": 0.7})
    end = call("unicycle", "odometry", twist | {"dt": 0.7})
    close([end["x"], end["y"], end["theta"]], x)


def sliding(derivation: Derivation, steer: dict[str, float]) -> tuple[Array, Array, Array]:
    """(rows of the steered wheels, velocity rows of all wheels with an axle, null space of the fixed rows)."""
    steered: list[list[float]] = []
    fixed: list[list[float]] = []
    speeds: list[list[float]] = []
    for w in derivation.robot.wheels:
        if w.type not in ("fixed", "steered"):
            continue
        x, y = float(w.nominal.x), float(w.nominal.y)
        h = w.heading + steer.get(f"{w.name}.steer", 0.0)
        c, s = math.cos(h), math.sin(h)
        (steered if w.type == "steered" else fixed).append([-s, c, x * c + y * s])
        speeds += [[1.0, 0.0, -y], [0.0, 1.0, x]]
    basis = np.eye(3)
    if fixed:
        u, sv, vt = np.linalg.svd(np.array(fixed))
        basis = vt[int((sv > 1e-9 * sv[0]).sum()) :].T
        del u
    return np.array(steered).reshape(-1, 3), np.array(speeds), basis


@pytest.mark.parametrize("name", HAVING["axles"])
def test_axles_against_eigenvalues(name: str) -> None:
    """The motion of least lateral velocity is the smallest generalised eigenvector."""
    derivation = with_function(name, "axles")
    assert derivation is not None
    for scale in (0.0, 0.05, 0.5):
        steer = inputs(name, "axles", scale)
        rows, speeds, basis = sliding(derivation, steer)
        count = len(speeds) / 2
        metric = basis.T @ speeds.T @ speeds @ basis / count
        root = np.linalg.inv(np.linalg.cholesky(metric))
        values, vectors = np.linalg.eigh(root @ basis.T @ rows.T @ rows @ basis @ root.T / count)
        result = call(name, "axles", steer)
        twist = np.array([result["icr.y"], -result["icr.x"], result["icr.w"]])
        close(twist @ speeds.T @ speeds @ twist / count, 1.0, 1e-7)
        close(result["mismatch"], math.sqrt(max(values[0], 0.0)), 1e-6)
        if len(values) == 1 or values[1] > 1e-3 + 2 * values[0]:
            best = basis @ root.T @ vectors[:, 0]
            sign = np.sign(best @ speeds.T @ speeds @ twist)
            close(sign * best, twist, 1e-5)


@pytest.mark.parametrize("name", HAVING["axles"])
def test_steering_to_a_centre_meets_there(name: str) -> None:
    """Angles from steer_to: no mismatch, no error, and the ICR comes back (on the fixed wheels' axle line)."""
    if with_function(name, "steer_to") is None:
        return
    derivation = with_function(name, "axles")
    assert derivation is not None
    if derivation.robot.couplings or derivation.mobility.rank_C1f.value > 1:
        return
    for x, y in ((-0.3, 9.0), (0.2, -11.0)):
        to = call(name, "steer_to", {"icr.x": x, "icr.y": y, "icr.w": 1.0})
        result = call(name, "axles", to)
        close(result["mismatch"], 0.0, 1e-9)
        close([v for k, v in result.items() if k.endswith(".error")], 0.0, 1e-9)
        centre = np.array([result["icr.x"], result["icr.y"]]) / result["icr.w"]
        fixed = sliding(derivation, to)[2].shape[1] < 3
        if not fixed:
            close(centre, [x, y], 1e-6)


@pytest.mark.parametrize("name", HAVING["axles"])
def test_a_wheel_that_is_half_turned_has_the_same_axle(name: str) -> None:
    """A wheel that drives backward needs the same turn; the errors of the others stay, too."""
    steer = inputs(name, "axles", 0.5)
    result = call(name, "axles", steer)
    for port in steer:
        turned = call(name, "axles", steer | {port: steer[port] + math.pi})
        for k in ("mismatch", *(k for k in result if k.endswith(".error"))):
            close(turned[k], result[k], 1e-6)


def test_axles_do_not_depend_on_the_origin() -> None:
    """The same wheels seen from another origin: same mismatch and errors, the ICR shifted."""
    shift = (0.7, -1.3)
    lines = []
    for line in SKEWED.splitlines():
        if "x: " in line:
            x, y = (float(line.split(f"{k}: ")[1].split(",")[0]) for k in "xy")
            line = line.replace(f"x: {x:g}, y: {y:g}", f"x: {x + shift[0]:.6g}, y: {y + shift[1]:.6g}")
        lines.append(line)
    TEXTS["shifted"] = "\n".join(lines) + "\n"
    steer = {"one.steer": 0.4, "two.steer": -0.9, "three.steer": 0.2}
    a, b = call("skewed", "axles", steer), call("shifted", "axles", steer)
    for k in ("mismatch", "one.error", "two.error", "three.error", "icr.w"):
        close(a[k], b[k], 1e-7)
    for k, d in zip(("icr.x", "icr.y"), shift, strict=True):
        close(a[k] / a["icr.w"] + d, b[k] / b["icr.w"], 1e-6)


@pytest.mark.parametrize("name", HAVING["vaf"])
def test_vaf_by_brute_force(name: str) -> None:
    derivation = with_function(name, "vaf")
    assert derivation is not None
    driven = [w for w in derivation.robot.wheels if "spin" in w.actuated]
    for direction in np.linspace(-math.pi, math.pi, 181):
        joints = call(name, "inverse", {"vx": math.cos(direction), "vy": math.sin(direction)})
        rim = max(abs(joints[f"{w.name}.spin"]) * float(w.nominal.r) for w in driven)
        close(call(name, "vaf", {"direction": direction})["vaf"], 1 / rim, 1e-8)


@pytest.mark.parametrize("name", HAVING["compatibility"])
def test_inverse_obeys_the_compatibility_rows(name: str) -> None:
    derivation = with_function(name, "compatibility")
    assert derivation is not None
    ports = {p.name for p in derivation.formula("compatibility").inputs}
    driven = [w for w in derivation.robot.wheels if "spin" in w.actuated]
    rows = derivation.compatibility.rows
    speeds = []
    for _ in range(4):
        twist = RANDOM.uniform(-1, 1, 3)
        joints = call(name, "inverse", named(twist))
        speeds.append([joints[f"{w.name}.spin"] for w in driven])
        if derivation.mobility.degree_of_steerability == 0 and not any(w.turns for w in driven):
            residuals = call(name, "compatibility", {k: v for k, v in joints.items() if k in ports})
            close(list(residuals.values()), 0.0, 1e-8)
    if derivation.mobility.degree_of_steerability == 0 and not any(w.turns for w in driven):
        assert rows == len(driven) - np.linalg.matrix_rank(np.array(speeds), tol=1e-8)


def test_compatibility_of_driven_castors() -> None:
    """Four powered castors obey five relations less their steering: checked on rates that the inverse gives."""
    name = "nomad_xr4000"
    derivation = with_function(name, "compatibility")
    assert derivation is not None
    ports = {p.name for p in derivation.formula("compatibility").inputs}
    steer = {p: 0.3 * k - 0.4 for k, p in enumerate(sorted(n for n in ports if n.endswith(".steer")))}
    joints = call(name, "inverse", {"vx": 0.3, "vy": -0.2, "omega": 0.5} | steer)
    residuals = call(name, "compatibility", {k: v for k, v in (joints | steer).items() if k in ports})
    close(list(residuals.values()), 0.0, 1e-9)
    joints["castor1.spin"] += 1.0
    residuals = call(name, "compatibility", {k: v for k, v in (joints | steer).items() if k in ports})
    assert max(map(abs, residuals.values())) > 1e-3


@pytest.mark.parametrize("name", HAVING["heading"])
def test_heading_is_the_integral_of_the_yaw_rate(name: str) -> None:
    """Wheel speeds that change on the way: only the angles count."""
    angles, theta = inputs(name, "heading", 0.0), 0.3
    for dt in (0.4, 0.2, 0.9):
        spins = inputs(name, "motion", 3.0)
        values = {k: v for k, v in spins.items() if k not in ("x", "y")} | {"theta": theta, "dt": dt}
        theta = call(name, "motion", values)["theta"]
        for k in angles:
            if k.endswith(".angle"):
                angles[k] += spins[k.replace(".angle", ".spin")] * dt
    close(call(name, "heading", angles | {"theta": 0.3})["theta"], theta)
