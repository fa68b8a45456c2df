"""`steer_toward`: a wheel turns no faster than its limit, and arrives."""

from __future__ import annotations

import random
from fractions import Fraction
from pathlib import Path

import pytest

from tests.functions.control.corners import CORNERS, FLOAT32, SWERVE, call, derived, robot_text
from wmrgen.backends.c99.driver import evaluate_c
from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import Exact
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.rounding import nearest_float32

RATE, DT = 2.5, 0.01


def fleet(folder: Path, limits: str = f"limits: {{steer_rate: {RATE}}}") -> str:
    return robot_text(SWERVE, limits)


def angles(values: list[float], joint: str) -> dict[str, float]:
    return {f"{n}.{joint}": v for n, v in zip(CORNERS, values, strict=True)}


def test_each_step_keeps_the_limit_and_the_wheel_arrives(tmp_path: Path) -> None:
    d = derived(tmp_path, fleet(tmp_path), "steer_toward")
    wanted = [nearest_float32(v) for v in (1.2, -0.7, 0.004, 3.0)]
    now = [0.0, 0.5, 0.0, -3.0]
    steps = 0
    while now != wanted:
        after = call(d, "steer_toward", angles(now, "steer") | angles(wanted, "wanted") | {"dt": DT}, FLOAT32)
        turned = [b - a for a, b in zip(now, after.values(), strict=True)]
        for turn, a, w in zip(turned, now, wanted, strict=True):
            assert abs(turn) == pytest.approx(min(RATE * DT, abs(w - a)), abs=3e-7)
            assert turn * (w - a) >= 0
        now, steps = list(after.values()), steps + 1
        assert steps <= 241
    assert steps == 240  # 6 rad at 2.5 rad/s


def test_each_side_and_each_wheel_has_its_own_limit(tmp_path: Path) -> None:
    wheels = SWERVE.replace("r: 0.05}", "r: 0.05, limits: {steer_rate: [-1, 3]}}", 1)
    d = derived(tmp_path, robot_text(wheels, "limits: {steer_rate: 2}"), "steer_toward")
    for side, turns in ((1, [3, 2, 2, 2]), (-1, [-1, -2, -2, -2])):
        values = {f"{n}.wanted": Exact(9 * side) for n in CORNERS} | {"dt": Exact(Fraction(1, 2))}
        assert [float(v) for v in d.evaluate("steer_toward", values).values()] == [t / 2 for t in turns]


def test_a_wheel_without_limit_goes_there_at_once(tmp_path: Path) -> None:
    wheels = SWERVE.replace("r: 0.05}", "r: 0.05, limits: {steer_rate: 1}}", 1)
    d = derived(tmp_path, robot_text(wheels), "steer_toward")
    values = {"fl.steer": 0.0, "dt": 0.5} | angles([1.0, 1.0, 1.0, 1.0], "wanted")
    assert call(d, "steer_toward", values) == angles([0.5, 1.0, 1.0, 1.0], "steer")


def test_no_angle_beyond_the_stops_is_commanded(tmp_path: Path) -> None:
    d = derived(tmp_path, fleet(tmp_path, "limits: {steer_rate: 2, steer: [-1, 1.5]}"), "steer_toward")
    values = angles([1.6, 1.6, -1.2, 1.4], "steer") | angles([9.0, 0.0, -2.0, 3.0], "wanted") | {"dt": 0.25}
    assert call(d, "steer_toward", values) == angles([1.5, 1.0, -1.0, 1.5], "steer")


@pytest.mark.parametrize("dt", [0.0, -1.0])
def test_without_time_nothing_turns(tmp_path: Path, dt: float) -> None:
    d = derived(tmp_path, fleet(tmp_path), "steer_toward")
    now = angles([0.3, -0.2, 0.1, 0.0], "steer")
    assert call(d, "steer_toward", now | angles([1.0, -1.0, 0.0, 9.0], "wanted") | {"dt": dt}) == now


def test_in_c(tmp_path: Path) -> None:
    d = derived(tmp_path, fleet(tmp_path), "steer_toward")
    source = random.Random(2)
    cases = [
        {p.name: nearest_float32(source.uniform(-3, 3) * (0.01 if p.name == "dt" else 1.0)) for p in f.inputs}
        for f in [d.formula("steer_toward")]
        for _ in range(50)
    ]
    got = evaluate_c(d.c_module, "steer_toward", cases, Choice())
    for case, result in zip(cases, got, strict=True):
        for n in CORNERS:
            now, wanted = case[f"{n}.steer"], case[f"{n}.wanted"]
            turn = RATE * max(case["dt"], 0.0)
            assert result[f"{n}.steer"] == pytest.approx(min(max(wanted, now - turn), now + turn), abs=1e-6)


def test_it_is_proved_for_what_inverse_commands(tmp_path: Path) -> None:
    text = robot_text(
        SWERVE, "functions: [steer_toward]", "limits: {vx: 1, omega: 1, steer: 1.5, steer_rate: 2}"
    )
    bounds = derived(tmp_path, text, "steer_toward").bounds
    (bound,) = (f for f in bounds.functions if f.name == "steer_toward")
    assert bound.proved and bound.inputs["fl.wanted"] == pytest.approx((-1.5, 1.5), abs=1e-4)
    assert all(o.high == pytest.approx(1.5, abs=1e-4) or o.high < 1.71 for o in bound.outputs)


@pytest.mark.parametrize(
    ("wheels", "limits", "why"),
    [
        (SWERVE, "", "write limits: {steer_rate: 2}"),
        (SWERVE, "limits: {steer_rate: [0.1, 2]}", "do not let the wheel hold its angle"),
        (
            "  - {name: a, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}",
            "limits: {steer_rate: 1}",
            "is steered",
        ),
    ],
)
def test_what_is_missing_is_named(tmp_path: Path, wheels: str, limits: str, why: str) -> None:
    with pytest.raises(NotDerivableError, match=why):
        _ = derived(tmp_path, robot_text(wheels, limits), "steer_toward").program
