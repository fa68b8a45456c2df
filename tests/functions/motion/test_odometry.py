"""Odometry over many steps in float: increments to be added in double, and sums that carry what roundings lose; from
angles that wheels turned."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import sympy

from tests.codegen.c.harness import COMPILERS
from tests.depth import everyday
from tests.oracle import oracle, weighted
from tests.oracle.harness import robot_text
from tests.oracle.weighted import LAYOUTS
from wmrgen import derive, load
from wmrgen.codegen.c import sources
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.codegen.compiler import compile_program, run_program
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.symbolic import RoundingError
from wmrgen.ir.interpret import FLOAT32, FLOAT64, evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import DEFAULT, Choice
from wmrgen.ir.nodes import Module, Op
from wmrgen.ir.rounding import nearest_float32

UNICYCLE = Path(__file__).resolve().parents[3] / "robots" / "unicycle.yaml"
POSE, TWIST = ("x", "y", "theta"), ("vx", "vy", "omega")


def printed(*names: str) -> Module:
    """The operations of the C."""
    return expand(derive(load(UNICYCLE), names).c_module, DEFAULT.scalar, DEFAULT.math, DEFAULT.target)


def test_increments_are_what_odometry_adds() -> None:
    d = derive(load(UNICYCLE), ["odometry", "odometry_increment"])
    source = random.Random(1)
    for _ in range(20):
        case = {n: Exact(source.randint(-999, 999)) / 1000 for n in (*POSE, *TWIST, "dt")}
        after = d.evaluate("odometry", case)
        step = d.evaluate("odometry_increment", {n: case[n] for n in ("theta", *TWIST, "dt")})
        added = {
            n: float(after[n] - case[n] - step[f"{n}_step"]) / (math.tau if n == "theta" else 1) for n in POSE
        }
        assert added == {n: round(value) if n == "theta" else 0 for n, value in added.items()}


@pytest.mark.parametrize(("speed", "rate"), [(0.003, 0.0), (0.003, 0.001), (0.2, 1.0)])
def test_increments_added_in_double(speed: float, rate: float) -> None:
    """A thousand steps 100 m out: the pose is that of one long arc, where `odometry` in float stands or drifts."""
    module = printed("odometry", "odometry_increment")
    twist = {
        "vx": nearest_float32(speed),
        "vy": 0.0,
        "omega": nearest_float32(rate),
        "dt": nearest_float32(0.001),
    }
    start = {"x": 100.0, "y": -100.0, "theta": 0.5}
    plain, pose = dict(start), dict(start)
    for _ in range(1000):
        plain = evaluate_module(module, "odometry", plain | twist, FLOAT32)
        theta = nearest_float32(math.remainder(pose["theta"], math.tau))
        step = evaluate_module(module, "odometry_increment", {"theta": theta} | twist, FLOAT32)
        pose = {n: v + step[f"{n}_step"] for n, v in pose.items()}
    d = derive(load(UNICYCLE), ["odometry"])
    arc = twist | {"dt": 1000 * twist["dt"]}
    true = d.evaluate("odometry", {n: _exact(v) for n, v in (start | arc).items()})
    for n in POSE:
        assert pose[n] == pytest.approx(float(true[n]), abs=1e-6 * max(speed, rate))
    lost = max(abs(plain[n] - float(true[n])) for n in POSE)
    assert lost > 100 * max(abs(pose[n] - float(true[n])) for n in POSE)


def _exact(value: float) -> Exact:
    numerator, denominator = value.as_integer_ratio()
    return Exact(numerator) / denominator


LONG = """\
#include <math.h>
#include <stdio.h>
#include "unicycle.h"
int main(void)
{{
    const unicycle_twist twist = {{.vx = {vx}f, .omega = {omega}f}};
    unicycle_pose plain = {{.x = {x}f, .y = {x}f}}, pose = plain, rest = {{0.0f, 0.0f, 0.0f}};
    float widest = 0.0f;
    for (long k = 0; k < {steps}; k++) {{
        unicycle_odometry(&plain, &twist, 0.001f);
        unicycle_odometry_compensated(&pose, &rest, &twist, 0.001f);
        widest = fmaxf(widest, fabsf(pose.theta));
    }}
    printf("%.9g %.9g %.9g %.9g\\n", plain.x, plain.y, plain.theta, widest);
    printf("%.17g %.17g ", (double)pose.x + rest.x, (double)pose.y + rest.y);
    printf("%.17g\\n", (double)pose.theta + rest.theta);
    return 0;
}}
"""


@pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
@pytest.mark.parametrize(
    "choice",
    everyday([DEFAULT, Choice(target="host"), Choice(target="m0")], [DEFAULT]),
    ids=lambda c: c.target,
)
@pytest.mark.parametrize(
    ("speed", "rate", "steps"), [(0.003, 0.0, 10**6), (0.003, 0.001, 10**6), (0.2, 1.0, 2 * 10**6)]
)
def test_a_long_way_in_c(tmp_path: Path, choice: Choice, speed: float, rate: float, steps: int) -> None:
    """Half an hour at 1 kHz, 100 m out: as the closed form has it, where `odometry` stands still."""
    module = derive(load(UNICYCLE), ["odometry", "odometry_compensated"]).c_module
    files = dict(zip(("unicycle.h", "unicycle.c"), sources(module, choice), strict=True))
    files["main.c"] = LONG.format(x=100.0, vx=speed, omega=rate, steps=steps)
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    flags = ("-std=c99", "-O2", "-ffp-contract=off")
    answer = run_program(compile_program(tmp_path, ["unicycle.c", "main.c"], COMPILERS[0], flags), "")
    plain, pose = ([float(v) for v in line.split()] for line in answer.splitlines())
    vx, omega, dt = (nearest_float32(v) for v in (speed, rate, 0.001))
    turn, way = omega * dt * steps, vx * dt * steps
    chord = way * math.sin(turn / 2) / (turn / 2) if turn else way
    true = [100.0 + chord * math.cos(turn / 2), 100.0 + chord * math.sin(turn / 2), turn]
    assert abs(math.remainder(pose[2] - true[2], math.tau)) <= 2e-7 * turn
    assert math.dist(pose[:2], true[:2]) <= 1e-6 * way
    assert plain[3] <= nearest_float32(math.pi)
    if rate < 1:
        assert math.dist(plain[:2], true[:2]) > 0.02 * way


def test_in_exact_numbers_nothing_is_lost() -> None:
    """The pose is that of `odometry`, which takes off all turns and not one alone; the remainders are 0."""
    d = derive(load(UNICYCLE), ["odometry", "odometry_compensated"])
    source = random.Random(2)
    turned = set()
    for _ in range(40):
        case = {n: Exact(source.randint(-999, 999)) / 300 for n in (*POSE, *TWIST, "dt")}
        rests = {f"{n}_rest": Exact(0) for n in POSE}
        after, kept = d.evaluate("odometry", case), d.evaluate("odometry_compensated", case | rests)
        assert [kept[n] for n in ("x", "y")] == [after[n] for n in ("x", "y")]
        assert all(not kept[n] for n in rests)
        whole = float(case["theta"] + case["omega"] * case["dt"])
        kept_off, off = (round((whole - float(v["theta"])) / math.tau, 9) for v in (kept, after))
        assert (kept_off, off) == (max(min(round(whole / math.tau), 1), -1), round(whole / math.tau))
        turned.add(off)
    assert {-1, 0, 1} < turned


@pytest.mark.parametrize("choice", [DEFAULT, Choice(target="m0"), Choice("double", "libm")], ids=str)
def test_c_has_the_bits_of_the_interpreter(choice: Choice) -> None:
    module = derive(load(UNICYCLE), ["odometry", "odometry_compensated"]).c_module
    operations = expand(module, choice.scalar, choice.math, choice.target)
    source = random.Random(3)
    sizes = dict.fromkeys(("x", "y"), 100.0) | {"theta": 4.0, "dt": 0.1}
    sizes |= {f"{n}_rest": 1e-6 for n in POSE} | dict.fromkeys(TWIST, 1.0)
    cases = [{n: nearest_float32(source.uniform(-s, s)) for n, s in sizes.items()} for _ in range(60)]
    arithmetic = FLOAT32 if choice.scalar == "float" else FLOAT64
    expected = [evaluate_module(operations, "odometry_compensated", case, arithmetic) for case in cases]
    assert any(abs(e["x_rest"]) > 0 for e in expected)
    requests = [("odometry_compensated", case) for case in cases]
    got = evaluate_c(module, requests, choice, None, ("-std=c99", "-O2", "-ffp-contract=off"))
    if choice.scalar == "float":
        assert got == expected
    else:
        assert all(
            g[n] == pytest.approx(e[n], abs=1e-12) for g, e in zip(got, expected, strict=True) for n in e
        )


def test_the_error_of_a_sum_is_a_float() -> None:
    """TwoSum: sum and error are the exact sum, whichever is larger; to sympy's numbers it is 0."""
    source = random.Random(4)
    for _ in range(500):
        a, b = (nearest_float32(source.uniform(-1, 1) * 10.0 ** source.randint(-9, 9)) for _ in range(2))
        total, error = Op.ADD.float32(a, b), Op.ROUNDING_ERROR.float32(a, b)
        assert Fraction(total) + Fraction(error) == Fraction(a) + Fraction(b)
        wide = Op.ADD.float64(a / 3, b / 7)
        assert Fraction(wide) + Fraction(Op.ROUNDING_ERROR.float64(a / 3, b / 7)) == Fraction(
            a / 3
        ) + Fraction(b / 7)
    assert RoundingError(sympy.Rational(1, 3), sympy.Rational(2, 7)) == 0


def test_doubles_of_numpy_carry_remainders() -> None:
    d = derive(load(UNICYCLE), ["odometry_compensated"])
    step = d.numpy().odometry_compensated
    pose = dict.fromkeys(("theta", "x_rest", "y_rest", "theta_rest"), 0.0) | {"x": 1e9, "y": 0.0}
    for _ in range(1000):
        pose = {n: float(v) for n, v in step(**pose, vx=1e-8, vy=0.0, omega=0.0, dt=1.0).items()}
    assert pose["x"] + pose["x_rest"] == pytest.approx(1e9 + 1e-5, abs=2e-7)
    assert 1e9 + 1e-8 == 1e9


@pytest.mark.parametrize("name", ["differential", "swerve", "mecanum", "wide castors", "offset"])
def test_angles_that_wheels_turned(name: str, tmp_path: Path) -> None:
    """The arc of the twist that numpy fits to rates, in a quarter of a second, at the middle of the steering angles."""
    layout, source = LAYOUTS[name], random.Random(name)
    (tmp_path / "sample.yaml").write_text(robot_text(layout), encoding="utf-8")
    d = derive(load(tmp_path / "sample.yaml"), ["forward", "odometry_from_angles"])
    dt = 0.25
    for turns in (0.0, 1.0, 3.0):
        rates = {p.name: source.uniform(-4, 4) * turns for p in d.formula("forward").inputs}
        steps: dict[str, float] = {}
        for n, v in rates.items():
            if n.endswith(".steer"):
                swing = rates.get(f"{n}_rate", 2.0) * dt
                wraps = source.choice((-math.tau, 0.0, math.tau))
                steps |= {f"{n}_last": v - swing / 2, n: v + swing / 2 + wraps}
            elif n.endswith(".spin"):
                steps[f"{n}_step"] = v * dt
        pose = np.array([source.uniform(-2, 2) for _ in POSE])
        wanted = oracle.step(pose, weighted.forward(layout, rates)[0], dt)
        after = d.numpy().odometry_from_angles(**dict(zip(POSE, pose, strict=True)), **steps)
        assert [after[n] for n in ("x", "y")] == pytest.approx(list(wanted[:2]), abs=1e-9)
        assert math.remainder(after["theta"] - wanted[2], math.tau) == pytest.approx(0, abs=1e-9)


def test_modules_that_swing_during_a_step(tmp_path: Path) -> None:
    """A swerve drive whose direction of travel turns at 1.5 rad/s: steps of 0.1 s with both angles are twenty times as
    near to the integral as those that see the last angle alone."""
    layout, dt = LAYOUTS["swerve"], 0.1
    (tmp_path / "sample.yaml").write_text(robot_text(layout), encoding="utf-8")
    d = derive(load(tmp_path / "sample.yaml"), ["inverse", "odometry_from_angles"])
    call = d.numpy()
    still = {p.name: 0.0 for p in d.formula("inverse").inputs}

    def joints(t: float) -> dict[str, float]:
        direction = 0.3 + 1.5 * t
        twist = {"vx": 0.5 * math.cos(direction), "vy": 0.5 * math.sin(direction), "omega": 0.0}
        return {
            n: float(v)
            for n, v in call.inverse(**(still | {f"{w}.steer": direction for w in wheels} | twist)).items()
        }

    wheels = [n.removesuffix(".steer") for n in still if n.endswith(".steer")]
    ends: list[float] = []
    for both in (True, False):
        pose = dict.fromkeys(POSE, 0.0)
        for k in range(50):
            last, now = joints(k * dt), joints((k + 1) * dt)
            angles = {f"{w}.steer": now[f"{w}.steer"] for w in wheels}
            angles |= {f"{w}.steer_last": (last if both else now)[f"{w}.steer"] for w in wheels}
            spins = {f"{w}.spin_step": dt * last[f"{w}.spin"] for w in wheels}
            pose = call.odometry_from_angles(**pose, **angles, **spins)
        arc = [0.5 / 1.5 * (math.sin(7.8) - math.sin(0.3)), 0.5 / 1.5 * (math.cos(0.3) - math.cos(7.8))]
        ends.append(math.dist([float(pose[n]) for n in ("x", "y")], arc))
    assert ends[0] < 1.5e-3 and ends[1] > 20 * ends[0]


def test_the_heading_stays_within_half_a_turn() -> None:
    """However far the robot turns, in one step or in many; up to half a turn it has the bits of the sum."""
    d = derive(load(UNICYCLE), ["odometry"])
    odometry = d.numpy().odometry
    still = {"x": 0.0, "y": 0.0, "vx": 0.0, "vy": 0.0}
    for theta, turn in ((3.0, 0.2), (-3.0, -0.2), (0.5, 100.0), (-1e4, 0.1), (2.0, 1.0), (0.0, -1e-300)):
        found = float(odometry(**still, theta=theta, omega=turn, dt=1.0)["theta"])
        assert abs(found) <= math.pi
        assert math.remainder(found - (theta + turn), math.tau) == pytest.approx(0, abs=1e-11)
        assert abs(theta + turn) > math.pi or found == theta + turn


def test_a_turn_of_both_wheels_is_a_circumference() -> None:
    d = derive(load(UNICYCLE.with_name("pioneer3dx.yaml")), ["odometry_from_angles"])
    steps = {"left.spin_step": math.tau, "right.spin_step": math.tau}
    pose = d.numpy().odometry_from_angles(x=1.0, y=2.0, theta=math.pi / 2, **steps)
    assert [pose[n] for n in POSE] == pytest.approx([1.0, 2.0 + math.tau * 0.0975, math.pi / 2])
