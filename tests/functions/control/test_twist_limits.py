"""`limit_twist` and `limit_acceleration`: limits kept, direction kept, nothing changed that need not be."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from tests.functions.control.corners import FLOAT32, MECANUM, SWERVE, call, derived, robot_text, steers
from tests.functions.refusals import refused
from wmrgen.codegen.c.checked import ranges
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.registry import Reason
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Site
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.rounding import nearest_float32

Twist = dict[str, float]
LIMITS = "limits: {vx: [-0.7, 1.3], vy: 0.9, omega: 2.1}"
LOW, HIGH = (-0.7, -0.9, -2.1), (1.3, 0.9, 2.1)
RATES = "limits: {vx_rate: [-3, 2], vy_rate: 1.5, omega_rate: 7}"
BRAKING, FASTER = [*map(Fraction, (3, 1.5, 7))], [*map(Fraction, (2, 1.5, 7))]


def twist(vx: float, vy: float, omega: float, when: str = "") -> Twist:
    return dict(zip((f"vx{when}", f"vy{when}", f"omega{when}"), (vx, vy, omega), strict=True))


def drawn(source: random.Random, size: float = 3.0) -> list[float]:
    return [nearest_float32(source.uniform(-size, size)) for _ in range(3)]


def limited(*lines: str, wheels: str = MECANUM) -> Derivation:
    return derived(robot_text(wheels, *lines), "limit_twist")


def accelerated(limits: str = RATES) -> Derivation:
    return derived(robot_text(MECANUM, limits), "limit_acceleration")


def allowed(last: Any, change: Any, dt: Any) -> list[Any]:
    """How far each component may change in dt: it brakes until it stands, if it goes there, then it speeds up."""
    found = []
    for v, c, brake, speed in zip(last, change, BRAKING, FASTER, strict=True):
        braking = min(dt, abs(v) / brake) if v * c < 0 else 0
        found.append(brake * braking + speed * (dt - braking))
    return found


def exactly(d: Derivation, name: str, values: Twist) -> list[Fraction]:
    exact = {k: Exact(Fraction(v)) for k, v in values.items()}
    return [v.rational() for v in d.evaluate(name, exact).values()]


# ---- limit_twist


def test_the_path_is_kept_and_a_limit_reached() -> None:
    """In exact numbers: the twist times k in (0, 1], and k < 1 where one component stands at its limit."""
    d, source, slower = limited(LIMITS), random.Random(1), 0
    low, high = ([Fraction(str(v)) for v in ends] for ends in (LOW, HIGH))
    for _ in range(60):
        asked = drawn(source)
        kept = exactly(d, "limit_twist", twist(*asked))
        k = kept[0] / Fraction(asked[0])
        assert 0 < k <= 1 and all(a * k == b for a, b in zip(map(Fraction, asked), kept, strict=True))
        assert all(a <= b <= c for a, b, c in zip(low, kept, high, strict=True))
        assert k == 1 or any(b in ends for b, *ends in zip(kept, low, high, strict=True))
        slower += k < 1
    assert 30 < slower < 60


def test_limits_hold_to_the_last_bit_in_float() -> None:
    d, source, reached = limited(LIMITS), random.Random(2), 0
    low, high = ([nearest_float32(v) for v in ends] for ends in (LOW, HIGH))
    for _ in range(400):
        asked = drawn(source, 10.0 ** source.uniform(-1, 8))
        kept = [*call(d, "limit_twist", twist(*asked), FLOAT32).values()]
        assert all(a <= b <= c for a, b, c in zip(low, kept, high, strict=True))
        reached += any(b in ends for b, *ends in zip(kept, low, high, strict=True))
    assert reached > 200


def test_nothing_changes_inside_the_limits() -> None:
    d = limited(LIMITS)
    for asked in ((1.3, -0.9, 2.1), (-0.7, 0.0, -0.0), (1e-30, 0.3, -2.0)):
        asked = tuple(map(nearest_float32, asked))
        kept = call(d, "limit_twist", twist(*asked), FLOAT32)
        assert [math.copysign(1, v) for v in kept.values()] == [math.copysign(1, v) for v in asked]
        assert kept == twist(*asked)


def test_vy_has_the_limit_of_vx_where_it_has_none() -> None:
    d = limited("limits: {vx: 0.5, omega: 9}")
    assert call(d, "limit_twist", twist(0.0, -2.0, 4.0)) == twist(0.0, -0.5, 1.0)
    alone = limited("limits: {omega: 1}")
    assert call(alone, "limit_twist", twist(8.0, 6.0, -4.0)) == twist(2.0, 1.5, -1.0)


PAIR = """\
  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}"""


def test_what_the_robot_cannot_drive_is_nothing_and_slows_nothing_down() -> None:
    """A differential drive has no vy, unless P lies before its axle; a synchro drive has no omega."""
    limits = "limits: {vx: 1, omega: 2, vx_rate: 1, omega_rate: 2}"
    asked, wanted = twist(0.5, 8.0, 1.0), twist(0.5, 8.0, 1.0, "_wanted")
    pair = derived(robot_text(PAIR, limits), "limit_twist", "limit_acceleration")
    assert call(pair, "limit_twist", asked) == twist(0.5, 0.0, 1.0)
    half = call(pair, "limit_acceleration", twist(0.0, -8.0, 0.0) | wanted | {"dt": 0.25})
    assert [*half.values()] == pytest.approx([0.25, 0.0, 0.5], rel=1e-6)
    before = limited(limits, wheels=PAIR.replace("x: 0,", "x: -0.5,"))
    assert call(before, "limit_twist", asked) == twist(0.0625, 1.0, 0.125)
    names = ("fl", "fr", "bl", "br")
    couplings = [
        f"  - {{equal: [{', '.join(f'{n}.{joint}' for n in names)}]}}" for joint in ("steer", "spin")
    ]
    synchro = limited(limits, "couplings:", *couplings, wheels=SWERVE)
    assert call(synchro, "limit_twist", twist(0.5, 0.5, 8.0)) == twist(0.5, 0.5, 0.0)


BAND = ("limits: {vx: [-0.5, 1], omega: 4}", "deadband: 0.0625")


@pytest.mark.parametrize(
    "at", [(0.0625, 0, 0), (-0.03125, 0, 0), (0, 0.0625, 0), (0, -0.03125, 0), (0, 0, 0.25), (0, 0, -0.25)]
)
def test_below_the_deadband_the_robot_stands(at: tuple[float, ...]) -> None:
    """A share of the limit of its side; at the deadband the robot moves, and the other components are kept then."""
    d = limited(*BAND)
    rest = [v or 0.015 for v in at]
    assert call(d, "limit_twist", twist(*rest), FLOAT32) == {
        k: nearest_float32(v) for k, v in twist(*rest).items()
    }
    below = [v * (1 - 2.0**-23) if v in at else v for v in rest]
    assert call(d, "limit_twist", twist(*below), FLOAT32) == twist(0.0, 0.0, 0.0)
    assert call(d, "limit_twist", twist(*(1e3 * v for v in at)), FLOAT32) != twist(0.0, 0.0, 0.0)


def test_steering_holds_below_the_deadband() -> None:
    """The noise of a joystick at rest swings no wheel, and turns none."""
    d, source = limited(*BAND, wheels=SWERVE), random.Random(3)
    now = steers([0.3, -1.2, 2.0, -0.1])
    noise = twist(*(v * 0.01 for v in drawn(source)))
    swung = call(d, "inverse", noise | now)
    held = call(d, "inverse", call(d, "limit_twist", noise) | now)
    assert {k: v for k, v in held.items() if k.endswith("steer")} == now != {k: swung[k] for k in now}
    assert all(v == 0 for k, v in held.items() if k.endswith("spin"))


def test_it_is_looked_at_beyond_the_limits() -> None:
    """Bounds are about four times the limits; checked code takes any twist, for that is what the function is for."""
    d = limited("functions: [limit_twist]", LIMITS, "deadband: 0.01")
    (bound,) = (f for f in d.bounds.functions if f.name == "limit_twist")
    assert bound.proved and bound.inputs["vx"] == pytest.approx((-2.8, 5.2), rel=1e-6)
    for output, low, high in zip(bound.outputs, LOW, HIGH, strict=True):
        assert (output.low, output.high) == pytest.approx((low, high), abs=1e-4) and output.error < 1e-4
    (function,) = (f for f in d.c_module.functions if f.name == "limit_twist")
    accepted = ranges(function, "float", Site({"vx": (-0.7, 1.3), "omega": (-2.1, 2.1)}))
    assert [r.high for r in accepted] == ["1e9f", "1e9f", "200.0f"]


@pytest.mark.parametrize(
    ("lines", "reason", "names"),
    [
        ((), Reason.NO_LIMIT, ("vx: 1", "omega: 2")),
        (("limits: {vx: [0, 1], omega: 1}",), Reason.ONE_SIDED_LIMIT, ("vx",)),
        (("limits: {vx: 1, omega: [-2, -1]}",), Reason.ONE_SIDED_LIMIT, ("omega",)),
        (("limits: {vx: 1}", "deadband: 0.01"), Reason.NO_LIMIT, ("deadband", "omega")),
        (("limits: {omega: 1, vy: 1}", "deadband: 0.01"), Reason.NO_LIMIT, ("deadband", "vx")),
    ],
)
def test_what_is_missing_is_named(lines: tuple[str, ...], reason: Reason, names: tuple[str, ...]) -> None:
    with refused(reason, *names):
        _ = limited(*lines).program


# ---- limit_acceleration


def test_the_change_keeps_its_direction_and_its_limits() -> None:
    """In exact numbers: k times the change, k = 1 or next to the largest that the limits allow."""
    d, source, short = accelerated(), random.Random(4), 0
    for _ in range(60):
        last, wanted, dt = drawn(source), drawn(source), Fraction(source.choice((1, 40, 90)), 100)
        values = twist(*wanted, "_wanted") | twist(*last) | {"dt": float(dt)}
        result = exactly(d, "limit_acceleration", values)
        change = [Fraction(w) - Fraction(v) for w, v in zip(wanted, last, strict=True)]
        k = (result[0] - Fraction(last[0])) / change[0]
        assert 0 < k <= 1
        assert all(Fraction(v) + k * c == r for v, c, r in zip(last, change, result, strict=True))
        step = Fraction(values["dt"])
        way = allowed([Fraction(v) for v in last], change, step)
        most = max(abs(c) / d for c, d in zip(change, way, strict=True))
        assert k == (1 if most <= 1 else (1 - Fraction(1, 2**21)) / most)
        short += k < 1
    assert 25 < short < 60


def test_in_float_it_lies_between_both_twists() -> None:
    """To the bit, so that what keeps the limits of twists keeps them; and inside the limits, but for one rounding."""
    d, source, short = accelerated(), random.Random(5), 0
    for _ in range(600):
        size = 10.0 ** source.uniform(-4, 4)
        last = drawn(source, size)
        wanted = (
            drawn(source, size)
            if source.random() < 0.5
            else [float(np.nextafter(np.float32(v), np.float32(source.choice((-1e9, 1e9))))) for v in last]
        )
        dt = nearest_float32(10.0 ** source.uniform(-6, 0))
        values = twist(*wanted, "_wanted") | twist(*last) | {"dt": dt}
        result = [*call(d, "limit_acceleration", values, FLOAT32).values()]
        way = allowed(last, [w - v for v, w in zip(last, wanted, strict=True)], dt)
        for v, w, r, far in zip(last, wanted, result, way, strict=True):
            assert min(v, w) <= r <= max(v, w)
            rounding = float(np.spacing(np.float32(max(abs(v), abs(w)))))
            assert abs(r - v) <= far * (1 + 1e-6) + rounding
        short += result != wanted
    assert 200 < short < 600


def test_the_wanted_twist_is_reached_to_the_bit() -> None:
    d = accelerated()
    wanted = [nearest_float32(v) for v in (0.3, -0.7, 1.1)]
    last, steps = twist(0.0, 0.0, -0.4), 0
    while last != twist(*wanted):
        values = last | twist(*wanted, "_wanted") | {"dt": 0.01}
        last, steps = call(d, "limit_acceleration", values, FLOAT32), steps + 1
        assert steps <= 48
    assert steps in (47, 48)  # 0.7 m/s at 1.5 m/s^2: 46.7 steps


def test_it_brakes_by_one_limit_and_speeds_up_by_the_other() -> None:
    """In both directions: 3 m/s^2 brakes and 2 speeds up, and so does a step through standstill."""
    d = accelerated("limits: {vx_rate: [-3, 2]}")
    for way in (1, -1):
        for last, wanted, after in ((0.0, 9.0, 1.0), (5.0, -9.0, 3.5), (0.75, -9.0, -0.5), (4.0, 3.0, 3.0)):
            values = twist(way * wanted, 0, 0, "_wanted") | twist(way * last, 0, 0) | {"dt": 0.5}
            assert call(d, "limit_acceleration", values)["vx"] == pytest.approx(way * after, rel=3e-6)


def test_what_can_be_reached_in_the_step_is() -> None:
    """vx may rise by 2 m/s^2: in 0.5 s by 1, and by a bit more it may not."""
    d = accelerated()
    still = twist(0.0, 0.0, 0.0) | {"dt": 0.5}
    assert call(d, "limit_acceleration", twist(1.0, 0.25, 0.0, "_wanted") | still, FLOAT32) == twist(
        1.0, 0.25, 0.0
    )
    short = call(d, "limit_acceleration", twist(1.0 + 2.0**-23, 0.25, 0.0, "_wanted") | still, FLOAT32)
    assert 1 - 1e-6 < short["vx"] < 1 and 0.25 * (1 - 1e-6) < short["vy"] < 0.25


@pytest.mark.parametrize("dt", [0.0, -0.0, -1.0])
def test_without_time_the_twist_is_held(dt: float) -> None:
    d = accelerated()
    for last in ((0.3, -2.0, 1e-30), (1e6, 0.0, -7.0)):
        last = tuple(map(nearest_float32, last))
        values = twist(1.0, 1e-9, -3.0, "_wanted") | twist(*last) | {"dt": dt}
        assert call(d, "limit_acceleration", values, FLOAT32) == twist(*last)
    still = twist(0.0, 0.0, 0.0)  # also where nothing that has a limit changes
    values = twist(0.0, 0.0, 1.0, "_wanted") | still | {"dt": dt}
    assert call(accelerated("limits: {vx_rate: 4}"), "limit_acceleration", values, FLOAT32) == still


def test_what_has_no_limit_goes_along() -> None:
    d = accelerated("limits: {vx_rate: 4}")
    values = twist(0.0, 2.0, 8.0, "_wanted") | twist(0.0, 0.0, 0.0) | {"dt": 0.25}
    assert [*call(d, "limit_acceleration", values).values()] == pytest.approx([0.0, 1.0, 4.0], rel=1e-6)
    turning = accelerated("limits: {omega_rate: 4}")
    assert [*call(turning, "limit_acceleration", values).values()] == pytest.approx(
        [0.0, 0.25, 1.0], rel=1e-6
    )


@pytest.mark.parametrize(
    ("limits", "reason", "names"),
    [
        (
            "limits: {vx: 1, omega: 1}",
            Reason.NO_LIMIT,
            ("vx_rate: 1", "omega_rate: 2"),
        ),
        ("limits: {vx_rate: [0, 1]}", Reason.ONE_SIDED_LIMIT, ("vx_rate",)),
    ],
)
def test_what_is_missing_for_it_is_named(limits: str, reason: Reason, names: tuple[str, ...]) -> None:
    with refused(reason, *names):
        _ = accelerated(limits).program


def test_bounds_know_what_the_last_command_was() -> None:
    text = "limits: {vx: [-0.7, 1.3], vy: 0.9, omega: 2.1, vx_rate: 1}"
    d = derived(robot_text(MECANUM, "functions: [limit_acceleration]", text), "limit_acceleration")
    (bound,) = (f for f in d.bounds.functions if f.name == "limit_acceleration")
    assert bound.proved and not bound.unknown
    assert bound.inputs["vx_wanted"] == bound.inputs["vx"] == pytest.approx((-0.7, 1.3), rel=1e-6)


def test_both_in_c() -> None:
    """As written down once more with NumPy."""
    rates = "vx_rate: [-3, 2], vy_rate: 1.5, omega_rate: 7}"
    text = robot_text(MECANUM, LIMITS.replace("}", f", {rates}"), "deadband: 0.25")
    d, source = derived(text, "limit_twist", "limit_acceleration"), random.Random(6)
    cases = [
        twist(*drawn(source, source.choice((0.3, 3.0))))
        | twist(*drawn(source), "_wanted")
        | {"dt": nearest_float32(source.uniform(-0.1, 1))}
        for _ in range(80)
    ]
    low, high = np.array(LOW), np.array(HIGH)
    for name in ("limit_twist", "limit_acceleration"):
        names = [p.name for p in d.formula(name).inputs]
        results = evaluate_c(d.c_module, [(name, {n: case[n] for n in names}) for case in cases], Choice())
        for case, result in zip(cases, results, strict=True):
            values = np.array(
                [[case[f"{n}{when}"] for n in ("vx", "vy", "omega")] for when in ("", "_wanted")]
            )
            if name == "limit_twist":
                load = np.max(values[0] / np.where(values[0] < 0, low, high))
                expected = values[0] * (0.0 if load < 0.25 else min(1.0, 1 / load))
            else:
                change = values[1] - values[0]
                way = allowed(values[0], change, max(case["dt"], 0.0))
                expected = values[0] + change * min(1.0, np.min(way / np.abs(change)))
            assert [*result.values()] == pytest.approx([*expected], abs=3e-6)
