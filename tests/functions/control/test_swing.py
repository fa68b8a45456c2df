"""`steer_toward`: no faster than the limit, and to the end. `compensate_steering`: it rolls as its pivot moves."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import pytest

from tests.functions.control.corners import (
    CORNERS,
    FLOAT32,
    SWERVE,
    call,
    derived,
    robot_text,
    steers,
    twists,
)
from tests.functions.refusals import refused
from wmrgen.codegen.c.checked import ranges
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.registry import Reason
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Site
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.rounding import nearest_float32

RATE, DT = 2.5, 0.01


def fleet(limits: str = f"limits: {{steer_rate: {RATE}}}") -> str:
    return robot_text(SWERVE, limits)


def angles(values: list[float], joint: str) -> dict[str, float]:
    return {f"{n}.{joint}": v for n, v in zip(CORNERS, values, strict=True)}


def test_each_step_keeps_the_limit_and_the_wheel_arrives() -> None:
    d = derived(fleet(), "steer_toward")
    wanted = [nearest_float32(v) for v in (1.2, -0.7, 0.004, 3.0)]
    now = [0.0, 0.5, 0.0, -3.0]
    steps = 0
    while now != wanted:
        after = call(
            d, "steer_toward", angles(now, "steer") | angles(wanted, "steer_wanted") | {"dt": DT}, FLOAT32
        )
        turned = [b - a for a, b in zip(now, after.values(), strict=True)]
        for turn, a, w in zip(turned, now, wanted, strict=True):
            assert abs(turn) == pytest.approx(min(RATE * DT, abs(w - a)), abs=3e-7)
            assert turn * (w - a) >= 0
        now, steps = list(after.values()), steps + 1
        assert steps <= 241
    assert steps == 240  # 6 rad at 2.5 rad/s


def test_each_side_and_each_wheel_has_its_own_limit() -> None:
    wheels = SWERVE.replace("r: 0.05}", "r: 0.05, limits: {steer_rate: [-1, 3]}}", 1)
    d = derived(robot_text(wheels, "limits: {steer_rate: 2}"), "steer_toward")
    for side, turns in ((1, [3, 2, 2, 2]), (-1, [-1, -2, -2, -2])):
        values = {f"{n}.steer_wanted": Exact(9 * side) for n in CORNERS} | {"dt": Exact(Fraction(1, 2))}
        assert [float(v) for v in d.evaluate("steer_toward", values).values()] == [t / 2 for t in turns]


def test_a_wheel_without_limit_goes_there_at_once() -> None:
    wheels = SWERVE.replace("r: 0.05}", "r: 0.05, limits: {steer_rate: 1}}", 1)
    d = derived(robot_text(wheels), "steer_toward")
    values = {"fl.steer": 0.0, "dt": 0.5} | angles([1.0, 1.0, 1.0, 1.0], "steer_wanted")
    assert call(d, "steer_toward", values) == angles([0.5, 1.0, 1.0, 1.0], "steer")


def test_no_angle_beyond_the_stops_is_commanded() -> None:
    d = derived(fleet("limits: {steer_rate: 2, steer: [-1, 1.5]}"), "steer_toward")
    values = (
        angles([1.6, 1.6, -1.2, 1.4], "steer") | angles([9.0, 0.0, -2.0, 3.0], "steer_wanted") | {"dt": 0.25}
    )
    assert call(d, "steer_toward", values) == angles([1.5, 1.0, -1.0, 1.5], "steer")


@pytest.mark.parametrize("dt", [0.0, -1.0])
def test_without_time_nothing_turns(dt: float) -> None:
    d = derived(fleet(), "steer_toward")
    now = angles([0.3, -0.2, 0.1, 0.0], "steer")
    assert call(d, "steer_toward", now | angles([1.0, -1.0, 0.0, 9.0], "steer_wanted") | {"dt": dt}) == now


def test_in_c() -> None:
    d = derived(fleet(), "steer_toward")
    source = random.Random(2)
    cases = [
        {p.name: nearest_float32(source.uniform(-3, 3) * (0.01 if p.name == "dt" else 1.0)) for p in f.inputs}
        for f in [d.formula("steer_toward")]
        for _ in range(50)
    ]
    got = evaluate_c(d.c_module, [("steer_toward", case) for case in cases], Choice())
    for case, result in zip(cases, got, strict=True):
        for n in CORNERS:
            now, wanted = case[f"{n}.steer"], case[f"{n}.steer_wanted"]
            turn = RATE * max(case["dt"], 0.0)
            assert result[f"{n}.steer"] == pytest.approx(min(max(wanted, now - turn), now + turn), abs=1e-6)


def test_it_is_proved_for_what_inverse_commands() -> None:
    text = robot_text(
        SWERVE, "functions: [steer_toward]", "limits: {vx: 1, omega: 1, steer: 1.5, steer_rate: 2}"
    )
    bounds = derived(text, "steer_toward").bounds
    (bound,) = (f for f in bounds.functions if f.name == "steer_toward")
    assert bound.proved and bound.inputs["fl.steer_wanted"] == pytest.approx((-1.5, 1.5), abs=1e-4)
    assert all(o.high == pytest.approx(1.5, abs=1e-4) or o.high < 1.71 for o in bound.outputs)


@pytest.mark.parametrize(
    ("wheels", "limits", "reason", "names"),
    [
        (SWERVE, "", Reason.NO_LIMIT, ("steer_rate: 2",)),
        (SWERVE, "limits: {steer_rate: [0.1, 2]}", Reason.ONE_SIDED_LIMIT, ("fl.steer_rate",)),
        (
            "  - {name: a, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}",
            "limits: {steer_rate: 1}",
            Reason.NOT_STEERED,
            ("steer_toward",),
        ),
    ],
)
def test_what_is_missing_is_named(wheels: str, limits: str, reason: Reason, names: tuple[str, ...]) -> None:
    with refused(reason, *names):
        _ = derived(robot_text(wheels, limits), "steer_toward").program


# ---- compensate_steering


def compensated(wheels: str = SWERVE, *lines: str) -> Derivation:
    return derived(robot_text(wheels, *lines), "compensate_steering")


def test_wheels_roll_with_their_pivots_while_they_swing() -> None:
    """Along the present angle a pivot moves at (vx - y omega) cos + (vy + x omega) sin, whatever is commanded."""
    d, source, backwards = compensated(), random.Random(4), 0
    for twist in twists(40):
        asked = call(d, "inverse", twist | steers([source.uniform(-4, 4) for _ in CORNERS]))
        now = [source.uniform(-4, 4) for _ in CORNERS]
        result = call(d, "compensate_steering", asked | angles(now, "steer_now"))
        assert list(result) == [f"{n}.spin" for n in CORNERS]
        for (n, (a, b)), angle in zip(CORNERS.items(), now, strict=True):
            x, y = 0.3 * a, 0.25 * b
            vx, vy = twist["vx"] - y * twist["omega"], twist["vy"] + x * twist["omega"]
            speed = vx * math.cos(angle) + vy * math.sin(angle)
            assert result[f"{n}.spin"] == pytest.approx(speed / 0.05, abs=1e-12)
            backwards += result[f"{n}.spin"] * asked[f"{n}.spin"] < 0
    assert backwards > 20  # which are the wheels more than a quarter turn off


def test_a_wheel_beside_its_axis_rolls_as_its_contact_moves() -> None:
    """The contact is o to the left of the pivot, so that it moves o omega slower along the wheel."""
    d, source = compensated(SWERVE.replace("}", ", offset_y: 0.02}")), random.Random(7)
    for twist in twists(20):
        asked = call(d, "inverse", twist | steers([source.uniform(-4, 4) for _ in CORNERS]))
        asked = {k: v for k, v in asked.items() if k.endswith((".spin", ".steer"))}
        now = [source.uniform(-4, 4) for _ in CORNERS]
        result = call(d, "compensate_steering", asked | angles(now, "steer_now") | {"omega": twist["omega"]})
        for (n, (a, b)), angle in zip(CORNERS.items(), now, strict=True):
            x, y = 0.3 * a, 0.25 * b
            vx, vy = twist["vx"] - y * twist["omega"], twist["vy"] + x * twist["omega"]
            speed = vx * math.cos(angle) + vy * math.sin(angle) - 0.02 * twist["omega"]
            assert result[f"{n}.spin"] == pytest.approx(speed / 0.05, abs=1e-12)


def test_a_wheel_that_points_where_it_should_keeps_its_speed() -> None:
    d = compensated()
    spins = angles([3.0, -7.5, 0.0, 1e6], "spin")
    there = [0.3, -2.0, 0.0, 3.1]
    values = spins | angles(there, "steer") | angles(there, "steer_now")
    assert call(d, "compensate_steering", values, FLOAT32) == spins


def test_the_wheels_of_one_motor_are_seen_as_one() -> None:
    """In a synchro drive all wheels steer as one and turn as one: the angles of the first count for all."""
    names = list(CORNERS)[:3]
    synchro = "\n".join(SWERVE.splitlines()[:3])
    couplings = [
        f"  - {{equal: [{', '.join(f'{n}.{joint}' for n in names)}]}}" for joint in ("steer", "spin")
    ]
    d = compensated(synchro, "couplings:", *couplings)
    inputs = [p.name for p in d.formula("compensate_steering").inputs]
    assert inputs == ["fl.spin", "fl.steer", "fl.steer_now", "fr.spin", "bl.spin"]
    values = {"fl.steer": math.pi / 3, "fl.steer_now": 0.0} | dict.fromkeys((f"{n}.spin" for n in names), 8.0)
    assert [*call(d, "compensate_steering", values).values()] == pytest.approx([4.0] * 3)


@pytest.mark.parametrize(
    ("wheels", "lines", "reason", "names"),
    [
        (SWERVE.replace("}", ", actuated: [steer]}"), (), Reason.NOT_STEERED, ()),
        (SWERVE, ("couplings:", "  - {equal: [fl.spin, br.spin]}"), Reason.SHARED_MOTOR, ("fl", "br")),
    ],
)
def test_what_no_factor_makes_right_is_refused(
    wheels: str, lines: tuple[str, ...], reason: Reason, names: tuple[str, ...]
) -> None:
    with refused(reason, *names):
        _ = compensated(wheels, *lines).program


def test_bounds_and_checks_take_what_inverse_gives() -> None:
    """Also beyond the limits of joints, for `desaturate` comes later; no wheel is made faster."""
    d = compensated(SWERVE, "functions: [compensate_steering]", "limits: {vx: 1, omega: 1, spin: 8}")
    inverse, scaling = (
        next(f for f in d.bounds.functions if f.name == n) for n in ("inverse", "compensate_steering")
    )
    asked = {o.name: (o.low, o.high) for o in inverse.outputs}
    assert asked["fl.spin"][1] > 20 and scaling.inputs["fl.spin"] == asked["fl.spin"]
    assert scaling.inputs["fl.steer_now"] == scaling.inputs["fl.steer"]
    assert scaling.outputs[0].high == pytest.approx(asked["fl.spin"][1], rel=1e-4)
    (function,) = (f for f in d.c_module.functions if f.name == "compensate_steering")
    accepted = {r.port.name: r.high for r in ranges(function, "float", Site({"fl.spin": (-8.0, 8.0)}))}
    assert accepted["fl.spin"] == "1e9f" and accepted["fl.steer_now"] == accepted["fl.steer"]
