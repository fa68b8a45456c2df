"""The polar feedback law: Siegwart (3.50)-(3.65), derived, judged and driven."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from itertools import product
from pathlib import Path

import mpmath
import numpy as np
import pytest
import sympy
from numpy.typing import NDArray

from tests.conftest import Outcome
from tests.depth import BACKENDS, everyday
from tests.functions.common import (
    CASES,
    PAIR,
    ROBOTS,
    SKEWED,
    TRICYCLE,
    call,
    calls,
    derived,
    driven,
    write,
)
from tests.functions.control import polar
from tests.functions.refusals import refused
from wmrgen.functions.control.gains import exceeds, judge
from wmrgen.functions.registry import Reason
from wmrgen.geometry.exact.number import Exact

Array = NDArray[np.float64]
rho, alpha, beta = polar.STATE
v, omega = polar.V, polar.OMEGA
kr, ka, kb = polar.K_RHO, polar.K_ALPHA, polar.K_BETA
sin, cos = sympy.sin, sympy.cos
NO_LAW = {"locked_bicycle": Reason.AXLES, "synchro_drive": Reason.COUPLINGS}
DRIVEN = [p for p in ROBOTS if p.stem not in NO_LAW]


def vanishes(result: object, printed: object) -> bool:
    return all(sympy.simplify(a - b) == 0 for a, b in zip(result, printed, strict=True))  # type: ignore[call-overload]


def test_siegwart_3_53_rates_driving_forward() -> None:
    assert vanishes(polar.rates(), (-cos(alpha) * v, sin(alpha) / rho * v - omega, -sin(alpha) / rho * v))


def test_siegwart_3_55_corrected_rates_driving_backwards() -> None:
    printed = (cos(alpha) * v, -sin(alpha) / rho * v - omega, sin(alpha) / rho * v)
    assert vanishes(polar.rates(reverse=True), printed)


def test_siegwart_3_58_closed_loop() -> None:
    printed = (-kr * rho * cos(alpha), kr * sin(alpha) - ka * alpha - kb * beta, -kr * sin(alpha))
    assert vanishes(polar.closed_loop(), printed)


@pytest.mark.parametrize(
    "name", [n for n in CASES if CASES[n]["kind"] == "stability" and n.startswith("S-3.6")]
)
def test_case_of_gains(name: str, wmrgen_cli: Callable[..., Outcome]) -> None:
    import json

    given, expect = CASES[name]["given"], CASES[name]["expect"]
    words = [f"{k}={g!r}" for k, g in zip(("k_rho", "k_alpha", "k_beta"), given["k"], strict=True)]
    done = wmrgen_cli("gains", *words, "--json")
    assert done.code == 0
    result = json.loads(done.out)
    gains = dict(zip((kr, ka, kb), (sympy.Rational(str(g)) for g in given["k"]), strict=True))
    A = polar.linearisation().xreplace(gains)
    assert result["linearisation"] == np.array(A, float).tolist()
    s = sympy.Symbol("s")
    assert result["polynomial"] == [
        float(c) for c in sympy.Poly((s * sympy.eye(3) - A).det(), s).all_coeffs()
    ]
    for key in ("stable", "strong_3_65", "strong_all_beta"):
        if key in expect:
            assert result[key] is expect[key]


def test_hurwitz_conditions_are_the_eigenvalues() -> None:
    matrix = sympy.lambdify((kr, ka, kb), polar.linearisation())
    grid = [Fraction(k, 3) for k in (-5, -2, -1, 1, 2, 4, 9)]
    for p in grid:
        for q in grid:
            for r in grid:
                verdict = judge(Exact(p), Exact(q), Exact(r))
                values = np.linalg.eigvals(np.array(matrix(float(p), float(q), float(r)), float))
                assert np.allclose(
                    np.sort_complex(values), np.sort_complex(np.array(verdict.eigenvalues)), atol=1e-7
                )
                if abs(values.real.max()) > 1e-9:
                    assert verdict.stable == (values.real.max() < 0)
    assert not judge(Exact(2), Exact(2), Exact(-1)).stable  # on the border: not Hurwitz


def test_a_slow_mode_is_not_lost_in_the_fast_ones(wmrgen_cli: Callable[..., Outcome]) -> None:
    """Roots of s^2 + 9e30 s + 1 that digits would cancel; and gains whose cubes are no numbers are refused."""
    verdict = judge(Exact(10**30), Exact(10**31), Exact(Fraction(-1, 10**30)))
    assert verdict.eigenvalues[1] == pytest.approx(-1 / 9e30) and verdict.stable
    done = wmrgen_cli("gains", "k_rho=1e200", "k_alpha=1e201")
    assert done.code == 2 and "beyond 1e+50" in done.err


def test_comparison_with_pi_is_exact() -> None:
    with mpmath.workdps(220):
        for digits in (10, 59, 61, 150):
            near = Fraction(int(mpmath.floor(2 / mpmath.pi * 10**digits)), 10**digits)
            assert not exceeds(Exact(near), Exact(1)) and exceeds(
                Exact(near + Fraction(1, 10**digits)), Exact(1)
            )
    assert not exceeds(Exact(0), Exact(0)) and exceeds(Exact(0), Exact(-1))


def leaves_i1(gains: tuple[float, float, float], start: tuple[float, float], seconds: float = 4.0) -> bool:
    """True when alpha leaves (-pi/2, pi/2] on the way, by RK4 of the closed loop."""
    rate = sympy.lambdify((rho, alpha, beta, kr, ka, kb), polar.closed_loop())
    y = np.array([1.0, *start])
    for _ in range(int(seconds / 2e-3)):
        y = step(lambda q: np.array(rate(*q, *gains)), y, 2e-3)
        if abs(y[1]) > math.pi / 2:
            return True
    return False


def step(f: Callable[[Array], Array], y: Array, h: float) -> Array:
    k1 = f(y)
    k2 = f(y + h / 2 * k1)
    k3 = f(y + h / 2 * k2)
    k4 = f(y + h * k3)
    return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def test_siegwart_3_65_does_not_cover_every_beta_and_the_correction_does() -> None:
    gains = (0.5, 10.5, -6.0)
    verdict = judge(*(Exact(Fraction(g)) for g in gains))
    assert verdict.strong and not verdict.strong_all_beta
    assert leaves_i1(gains, (1.55, 3.1))
    assert not any(leaves_i1(gains, (1.55, b)) for b in (-2.6, 2.6))  # |beta| <= 5 pi / 6 is covered
    assert not any(leaves_i1((3.0, 8.0, -1.5), (a, b)) for a in (-1.57, 1.57) for b in (-3.14, 0.0, 3.14))


@pytest.mark.parametrize("backend", BACKENDS)
def test_goto_pose_is_the_law(backend: str, tmp_path: Path) -> None:
    """v, omega, rho, alpha, beta of Siegwart (3.50)-(3.57) on both branches, and the wheels of that twist."""
    path = write(tmp_path, PAIR)
    for x, y, theta, way in (
        (-1.2, 0.4, 0.3, 1),
        (0.9, -0.7, 2.0, 1),
        (0.9, 0.2, 0.4, -1),
        (0.3, 1.5, -2.2, -1),
    ):
        result = call(path, "goto_pose", {"x": x, "y": y, "theta": theta, "direction": way}, backend)
        r = math.hypot(x, y)
        toward = math.atan2(-y, -x) if way > 0 else math.atan2(y, x)
        a, b = math.remainder(toward - theta, math.tau), math.remainder(-toward, math.tau)
        speed, turn = way * 3 * r, 8 * a - 1.5 * b
        expected = {"rho": r, "alpha": a, "beta": b, "v": speed, "omega": turn, "direction": way}
        expected |= {
            "left.spin": (speed - 0.2 * turn) / 0.1,
            "right.spin": (speed + 0.2 * turn) / 0.1,
            "slip": 0,
        }
        assert result.keys() == expected.keys()
        for key, value in expected.items():
            assert result[key] == pytest.approx(value, abs=1e-12), key


@pytest.mark.parametrize("backend", BACKENDS)
def test_direction_is_decided_by_the_bearing(backend: str, tmp_path: Path) -> None:
    """|alpha| <= pi/2 forward (Siegwart (3.54)), rounding included; bearings of 180 degrees are +pi everywhere."""
    path = write(tmp_path, PAIR)
    for x, y, way in (
        (-1.0, 0.0, 1),
        (0.0, -1.0, 1),
        (0.0, 1.0, 1),
        (6e-17, -1.0, 1),
        (1e-3, 1.0, -1),
        (1.0, 0.0, -1),
    ):
        result = call(path, "goto_pose", {"x": x, "y": y}, backend)
        assert result["direction"] == way
        assert abs(result["alpha"]) <= math.pi / 2 + 1e-6
    for way, x in ((1, 1.0), (-1, -1.0)):
        result = call(path, "goto_pose", {"x": x, "direction": way}, backend)
        assert result["alpha"] == pytest.approx(math.pi) and result["beta"] == pytest.approx(math.pi)


COMPILED = ("ackermann_car", "kuka_youbot", "pioneer3dx")  # in C, one of each kind is enough
RESTING = [
    *((p, "casadi") for p in DRIVEN),
    *((p, "c") for p in DRIVEN if p.stem in COMPILED),
    *(pytest.param(p, "exact", marks=pytest.mark.slow) for p in DRIVEN),
]


@pytest.mark.parametrize(("robot", "backend"), RESTING, ids=lambda v: getattr(v, "stem", v))
def test_every_wheel_rests_at_the_goal(robot: Path, backend: str) -> None:
    """On the goal, and where its direction is no longer known: driving on would leave it again."""
    for x, direction in product((0.0, 1e-10), (-1.0, 0.0, 1.0)):
        result = call(robot, "goto_pose", {"x": x, "direction": direction}, backend)
        moving = {
            k: x
            for k, x in result.items()
            if k.endswith((".spin", "_rate", ".steer")) or k in "v omega slip".split()
        }
        assert not any(moving.values())


@pytest.mark.parametrize("name", [n for n in CASES if n.startswith("S-F3.20")])
def test_figure_3_20_by_wheel_commands(name: str, tmp_path: Path) -> None:
    """Pose after t: wheel commands of goto_pose, the twist that forward finds in them, integrated by RK4."""
    path = write(tmp_path, PAIR)
    given, expect = CASES[name]["given"], CASES[name]["expect"]
    x, y, theta = given["start_xytheta"]
    first = call(path, "goto_pose", {"x": x, "y": y, "theta": theta})
    assert (first["direction"] < 0) is given["reverse"]
    assert [first[k] for k in ("rho", "alpha", "beta")] == pytest.approx(given["state0"], abs=1e-12)

    def rate(pose: Array) -> Array:
        at = dict(zip(("x", "y", "theta"), map(float, pose), strict=True))
        twist = driven(path, call(path, "goto_pose", at | {"direction": first["direction"]}))
        c, s = math.cos(pose[2]), math.sin(pose[2])
        return np.array(
            [c * twist["vx"] - s * twist["vy"], s * twist["vx"] + c * twist["vy"], twist["omega"]]
        )

    pose, h = np.array([x, y, theta]), 2e-3
    for _ in range(round(given["t"] / h)):
        pose = step(rate, pose, h)
    assert pose == pytest.approx(expect["pose"], abs=CASES[name]["tol"])
    last = dict(zip(("x", "y", "theta"), map(float, pose), strict=True)) | {"direction": first["direction"]}
    result = call(path, "goto_pose", last)
    assert [result[k] for k in ("rho", "alpha", "beta")] == pytest.approx(expect["state"], abs=2e-6)


FREE = {"pair": PAIR, "skewed": SKEWED, "tricycle": TRICYCLE.format(base=0.8)}
ON_THE_ROAD = [
    "pair",
    "skewed",
    "tricycle",
    "kuka_youbot",
    "wpilib_swervebot",
    "textbook_two_steer",
    "nomad_xr4000",
]


@pytest.mark.parametrize("name", everyday(ON_THE_ROAD, ["tricycle"]))
def test_every_start_on_the_unit_circle_converges(name: str, tmp_path: Path) -> None:
    """Figure 3.20 on robots of several types: goto_pose, forward and odometry in a loop, castors included."""
    path = write(tmp_path, FREE[name]) if name in FREE else next(p for p in ROBOTS if p.stem == name)
    turning = [w for w in derived(path, "goto_pose").robot.wheels if w.turns]
    dt, around = 0.01, np.arange(8) * math.pi / 4
    pose = {"x": np.cos(around), "y": np.sin(around), "theta": np.zeros(8)}
    steer = {f"{w.name}.steer": np.zeros(8) for w in turning}
    direction = np.zeros(8)
    for _ in range(700):
        result = calls(path, "goto_pose", pose | steer | {"direction": direction})
        direction = result["direction"]
        twist = driven(path, steer | {j: x for j, x in result.items() if "." in j})
        assert (twist["slip"] < 1e-6).all()
        pose = calls(path, "odometry", pose | {j: twist[j] for j in ("vx", "vy", "omega")} | {"dt": dt})
        for w in turning:
            j = f"{w.name}.steer"
            steer[j] = result[j] if w.type == "steered" else steer[j] + dt * result[f"{j}_rate"]
    assert (np.hypot(pose["x"], pose["y"]) < 2e-3).all()
    assert all(abs(math.remainder(theta, math.tau)) < 5e-3 for theta in pose["theta"])


def test_gains_of_the_file_are_taken_and_tunable(tmp_path: Path) -> None:
    text = PAIR.replace(
        "wheels:", "parameters: {k: {value: 2, tunable: true}}\ngains: {k_rho: k, k_alpha: 4*k}\nwheels:"
    )
    path = write(tmp_path, text)
    result = call(path, "goto_pose", {"x": -1.0})
    assert result["v"] == pytest.approx(2.0)
    assert call(path, "goto_pose", {"x": -1.0, "k": 2.5})["v"] == pytest.approx(2.5)
    assert "k" in [p.name for p in derived(path, "goto_pose").formula("goto_pose").inputs]


@pytest.mark.parametrize(
    ("gains", "condition"),
    [("k_alpha: 2", "k_alpha - k_rho > 0"), ("k_beta: 1.5", "k_beta < 0"), ("k_rho: -1", "k_rho > 0")],
)
def test_gains_that_do_not_stabilise_are_refused_by_name(
    gains: str, condition: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    path = write(tmp_path, PAIR.replace("wheels:", f"gains: {{{gains}}}\nwheels:"))
    done = wmrgen_cli("eval", path, "goto_pose", "x=-1")
    assert done.code == 3 and done.err.count(condition) == 1
    done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
    assert done.code == 0 and "warning" in done.err and condition in done.err
    path.write_text(path.read_text().replace("wheels:", "functions: [goto_pose]\nwheels:"))
    done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
    assert done.code == 3 and done.err.count(condition) == 1


def test_gains_that_are_only_locally_good_get_a_note(
    tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    path = write(tmp_path, PAIR.replace("wheels:", "gains: {k_rho: 0.5, k_alpha: 10.5, k_beta: -6}\nwheels:"))
    done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
    assert done.code == 0 and "k_alpha + 2 k_beta - 2/pi k_rho > 0" in done.err
    done = wmrgen_cli("eval", path, "goto_pose", "x=-1")
    assert done.code == 0 and "k_alpha + 2 k_beta - 2/pi k_rho > 0" in done.err


@pytest.mark.parametrize("stem", sorted(NO_LAW))
@pytest.mark.parametrize("function", ("goto_pose", "pursuit"))
def test_robots_that_cannot_turn_and_drive_are_refused(stem: str, function: str) -> None:
    path = next(p for p in ROBOTS if p.stem == stem)
    with refused(NO_LAW[stem], function):
        derived(path, function).formula(function)


def test_unstable_gains_swing_out_of_i1() -> None:
    """k_alpha + 2 k_beta - 2/pi k_rho > 0 does not keep alpha where k_alpha < k_rho: beta winds up."""
    gains = (5.0, 3.3, -0.05)
    verdict = judge(*(Exact(Fraction(str(g))) for g in gains))
    assert exceeds(Exact(Fraction("3.2")), Exact(5)) and not (verdict.stable or verdict.strong_all_beta)
    assert leaves_i1(gains, (-1.0, 0.0), 7.6)
