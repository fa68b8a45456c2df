"""Pursuit (Tzafestas (2.57)) and the input sets of cars (AA274; Tzafestas 2.3.4)."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
import sympy

from tests.depth import BACKENDS
from tests.functions.common import (
    CASES,
    PAIR,
    ROBOTS,
    SKEWED,
    TRICYCLE,
    call,
    derived,
    driven,
    write,
)
from tests.functions.refusals import refused
from wmrgen.functions.registry import Reason
from wmrgen.geometry.symbolic import signal

ACKERMANN = next(p for p in ROBOTS if p.stem == "ackermann_car")


def limited(base: float, u1: float, zeta: float) -> str:
    """A tricycle whose front wheel (r = 0.1) runs at most at u1 [m/s] and steers by zeta."""
    text = TRICYCLE.format(base=base)
    return f"{text}limits: {{spin: {u1 / 0.1!r}, steer: {zeta!r}}}\n"


@pytest.mark.parametrize("backend", BACKENDS)
def test_tzafestas_2_57_case(backend: str, tmp_path: Path) -> None:
    given, expect = CASES["T-2.57b"]["given"], CASES["T-2.57b"]["expect"]
    path = write(tmp_path, TRICYCLE.format(base=given["D"]))
    x, y = given["L"] * math.cos(given["epsilon"]), given["L"] * math.sin(given["epsilon"])
    result = call(path, "pursuit", {"goal_x": x, "goal_y": y, "v": 0.7}, backend)
    assert result["psi"] == pytest.approx(expect["psi"], abs=1e-9)
    assert result["front.steer"] == pytest.approx(expect["psi"], abs=1e-9)
    assert result["curvature"] == pytest.approx(expect["curvature"], abs=1e-9)
    assert result["curvature"] / y == pytest.approx(expect["gain"], abs=1e-9) and y == pytest.approx(
        expect["d"]
    )
    assert result["omega"] == pytest.approx(0.7 * expect["curvature"], abs=1e-9)


def test_tzafestas_2_57_in_symbols(tmp_path: Path) -> None:
    """psi = atan(2 D sin eps / L) and curvature = 2 sin eps / L for every goal away from the robot."""
    formula = derived(write(tmp_path, TRICYCLE.format(base=1.5)), "pursuit").formula("pursuit")
    length, eps = sympy.Symbol("L", positive=True), sympy.Symbol("epsilon", real=True)
    at = {signal("goal_x"): length * sympy.cos(eps), signal("goal_y"): length * sympy.sin(eps)}
    result = {k: e.xreplace(at) for k, e in formula.closed().items() if k in ("psi", "curvature")}
    psi = result["psi"]
    assert psi.func is sympy.atan2
    printed = 2 * sympy.Rational(3, 2) * sympy.sin(eps) / length
    assert sympy.simplify(psi.args[0] / psi.args[1] - printed) == 0
    bend = result["curvature"].replace(lambda e: isinstance(e, sympy.Piecewise), lambda e: e.args[0][0])
    assert sympy.simplify(bend - 2 * sympy.sin(eps) / length) == 0


@pytest.mark.parametrize(
    "stem", ["tricycle", "skewed", "pair", "ackermann_car", "kuka_youbot", "wpilib_swervebot"]
)
def test_the_arc_meets_the_goal(stem: str, tmp_path: Path) -> None:
    """Commands held for the time of the arc, eps L / sin eps, bring the axle centre to the goal (case T-2.57-arc)."""
    texts = {"tricycle": TRICYCLE.format(base=1.4), "skewed": SKEWED, "pair": PAIR}
    path = write(tmp_path, texts[stem]) if stem in texts else next(p for p in ROBOTS if p.stem == stem)
    centre, heading = (np.array([-0.3, 0.1]), math.pi / 6) if stem == "skewed" else (np.zeros(2), 0.0)
    limit = 0.5 if stem == "ackermann_car" else 2.5
    for far, eps, v in itertools.product((9.0, 12.0), (-limit, -0.2, 0.5), (1.0, 0.4)):
        goal = centre + far * np.array([math.cos(heading + eps), math.sin(heading + eps)])
        result = call(path, "pursuit", {"goal_x": goal[0], "goal_y": goal[1], "v": v})
        settled = {k: result[k] for k in result if k.endswith(".steer")}
        result = call(path, "pursuit", {"goal_x": goal[0], "goal_y": goal[1], "v": v} | settled)
        twist = driven(path, result | settled)
        assert twist["slip"] < 1e-9
        time = far * eps / math.sin(eps) / v
        end = call(path, "odometry", {k: twist[k] for k in ("vx", "vy", "omega")} | {"dt": time})
        c, s = math.cos(end["theta"]), math.sin(end["theta"])
        at = np.array([end["x"], end["y"]]) + np.array([[c, -s], [s, c]]) @ centre
        assert at == pytest.approx(goal, abs=1e-8)


def test_case_t_2_57_arc(tmp_path: Path) -> None:
    given, expect = CASES["T-2.57-arc"]["given"], CASES["T-2.57-arc"]["expect"]
    x, y, theta, psi = given["state0"]
    path = write(tmp_path, TRICYCLE.format(base=given["D"]))
    goal = np.array(expect["position"]) - [x, y]
    c, s = math.cos(theta), math.sin(theta)
    local = {
        "goal_x": c * goal[0] + s * goal[1],
        "goal_y": c * goal[1] - s * goal[0],
        "v": given["input"]["v1"],
    }
    result = call(path, "pursuit", local)
    assert result["psi"] == pytest.approx(psi, abs=1e-8)
    twist = driven(path, result)
    start = {"x": x, "y": y, "theta": theta, "dt": given["t"]}
    end = call(path, "odometry", start | {k: twist[k] for k in ("vx", "vy", "omega")})
    assert [end["x"], end["y"]] == pytest.approx(expect["position"], abs=1e-8)
    assert end["theta"] == pytest.approx(expect["heading"], abs=1e-8)


@pytest.mark.parametrize("backend", BACKENDS)
def test_at_the_goal_the_robot_drives_straight(backend: str) -> None:
    result = call(ACKERMANN, "pursuit", {"v": 1.0}, backend)
    assert result["omega"] == result["curvature"] == result["psi"] == 0 and result["front_left.steer"] == 0
    assert result["rear_left.spin"] == pytest.approx(1 / 0.3)


@pytest.mark.parametrize("backend", BACKENDS)
def test_case_a_bounds(backend: str, tmp_path: Path) -> None:
    given, expect = CASES["A-bounds"]["given"], CASES["A-bounds"]["expect"]
    path = write(tmp_path, limited(1.0, given["u1_max"], given["zeta_max"]))
    result = call(path, "input_limits", {"v": given["v"]}, backend)
    assert result["v_max"] == pytest.approx(expect["v_max"], abs=1e-9)
    assert result["v_max"] == pytest.approx(expect["reeds_shepp_abs_v"], abs=1e-9)
    assert result["omega_max"] == pytest.approx(expect["omega_max"], abs=1e-9)


def test_case_a_reduction(tmp_path: Path) -> None:
    """v = u1 cos xi, omega = u1 sin xi / L of the front wheel's speed and angle, by forward kinematics (L = 1)."""
    given, expect = CASES["A-reduction"]["given"], CASES["A-reduction"]["expect"]
    path = write(tmp_path, TRICYCLE.format(base=1.0))
    steer = {"front.steer": given["xi"]}
    joints = call(path, "inverse", {"vx": expect["v"], "omega": expect["omega"]} | steer)
    assert joints["front.steer"] == pytest.approx(given["xi"]) and joints["front.spin"] == pytest.approx(
        given["u1"] / 0.1
    )
    twist = driven(path, joints)
    assert [twist["vx"], twist["omega"]] == pytest.approx([expect["v"], expect["omega"]], abs=1e-9)


@pytest.mark.parametrize("base", (0.7, 1.0, 2.3))
def test_projections_are_the_nearest_points(base: float, tmp_path: Path) -> None:
    """Against a fine grid of each set, in (v, L omega); margins by sign and at the projections."""
    top, zeta = 1.7, 0.6
    path = write(tmp_path, limited(base, top, zeta))
    u, angle = np.meshgrid(np.linspace(-top, top, 801), np.linspace(-zeta, zeta, 401))
    exact = np.stack([u * np.cos(angle), u * np.sin(angle)], -1).reshape(-1, 2)
    v, share = np.meshgrid(np.linspace(-1, 1, 801) * top * math.cos(zeta), np.linspace(-1, 1, 401))
    inner = np.stack([v, np.abs(v) * math.tan(zeta) * share], -1).reshape(-1, 2)
    generator = np.random.default_rng(5)
    for speed, turn in generator.uniform(-2.5, 2.5, (60, 2)):
        result = call(path, "input_limits", {"v": speed, "omega": turn / base})
        for name, points in (("exact", exact), ("inner", inner)):
            point = np.array([result[f"{name}.v"], base * result[f"{name}.omega"]])
            here = np.array([speed, turn])
            least = np.hypot(*(points - here).T).min()
            assert np.hypot(*(point - here)) == pytest.approx(least, abs=6e-3)
            inside = least < 6e-3
            assert (result[f"{name}.margin"] > -6e-3) == inside or abs(result[f"{name}.margin"]) < 6e-3
            again = call(path, "input_limits", {"v": point[0], "omega": point[1] / base})
            assert again[f"{name}.margin"] > -1e-9
            assert [again[f"{name}.v"], base * again[f"{name}.omega"]] == pytest.approx(point, abs=1e-9)
            assert again["exact.margin"] > -1e-9  # the inner set lies inside the exact one


def test_an_ackermann_pair_keeps_both_wheels_within_their_limits() -> None:
    """The centre wheel's bound is where the inner wheel reaches its 40 degrees."""
    result = call(ACKERMANN, "input_limits", {"v": 1.0})
    commands = call(ACKERMANN, "inverse", {"vx": 1.0, "omega": result["omega_max"]})
    assert commands["front_left.steer"] == pytest.approx(math.radians(40)) and commands["slip"] < 1e-9
    more = call(ACKERMANN, "inverse", {"vx": 1.0, "omega": 1.01 * result["omega_max"]})
    assert more["slip"] > 1e-4


@pytest.mark.parametrize(
    ("text", "reason", "names"),
    [
        (PAIR, Reason.NOT_A_CAR, ()),
        (TRICYCLE.format(base=1.0) + "limits: {vx: 1}\n", Reason.NO_LIMIT, ("front", "steer")),
        (TRICYCLE.format(base=1.0) + "limits: {steer: 0.5}\n", Reason.NO_LIMIT, ("vx", "spin")),
        (
            TRICYCLE.format(base=1.0) + "limits: {vx: 1, steer: 1.6}\n",
            Reason.LIMIT_TOO_WIDE,
            ("front", "1.6 rad", "90 deg"),
        ),
    ],
)
def test_limits_that_are_needed_are_named(
    text: str, reason: Reason, names: tuple[str, ...], tmp_path: Path
) -> None:
    with refused(reason, *names):
        derived(write(tmp_path, text), "input_limits").formula("input_limits")
