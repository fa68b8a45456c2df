"""Spins in a ratio: a wheel that turns k times as fast as the shaft rolls as one of k times its radius that turns with
it, and one that turns against it as one that points backwards. Each robot is held to that one, whose spins are equal.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from wmrgen import derive, load
from wmrgen.analysis.mobility.ranks import generic, nominal_at
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import RobotFileError
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.lower import lower

# Name -> x, y [m], heading [deg], r [m], type and what else the wheel has.
PLACES: dict[str, tuple[float, float, int, float, str]] = {
    "a": (0.0, 0.3, 0, 0.1, "type: fixed"),
    "b": (0.0, -0.25, 0, 0.08, "type: fixed"),
    "c": (0.4, 0.1, 20, 0.1, "type: steered"),
    "d": (-0.3, -0.2, -30, 0.12, "type: steered"),
    "i": (0.4, 0.1, 20, 0.1, "type: steered"),
    "e": (0.4, 0.3, 0, 0.1, "type: swedish, gamma: 45 deg"),
    "f": (0.4, -0.3, 0, 0.1, "type: swedish, gamma: -45 deg"),
    "g": (-0.4, 0.3, 0, 0.1, "type: swedish, gamma: -45 deg"),
    "h": (-0.4, -0.3, 0, 0.1, "type: swedish, gamma: 45 deg"),
    "p": (0.2, 0.3, 0, 0.1, "type: castor, d: -0.04, actuated: [spin, steer]"),
    "q": (-0.2, -0.3, 40, 0.05, "type: castor, d: -0.03, actuated: [spin, steer]"),
}
CASES = {  # the wheels of a robot -> sets of turns per turn of a shaft
    "ab": [{"a": 1.0, "b": 2.0}],
    "abpq": [{"a": 1.0, "b": -1.0}],
    "cd": [{"c": 2.0, "d": -3.0}],
    "acd": [{"a": -2.0, "c": 1.0}, {"c": 4.0, "d": 0.5}],
    "cda": [{"c": 1.0, "a": -2.0}],
    "ci": [{"c": 1.0, "i": 2.0}],
    "ec": [{"e": 1.0, "c": 2.0}],
    "efgh": [{"e": 3.0, "h": 0.5}, {"g": 1.0, "f": -1.0}],
    "pqef": [{"p": 1.0, "q": 1.5}, {"q": 3.0, "e": 1.0}],
}
STEERED = {"ci": ", {equal: [c.steer, i.steer]}"}  # couplings of some beside
WORDS = ("degree_of_mobility", "degree_of_steerability", "robot_type", "omnidirectional", "dof", "ddof")


def robot(
    wheels: Mapping[str, tuple[float, float, int, float, str]], couplings: str, limits: str = ""
) -> Derivation:
    lines = [
        f"  - {{name: {n}, x: {x}, y: {y}, heading: {h} deg, r: {r!r}, {more}}}"
        for n, (x, y, h, r, more) in wheels.items()
    ]
    text = "\n".join(["wmrgen: 1", "name: sample", "wheels:", *lines, f"couplings: [{couplings}]", limits])
    with TemporaryDirectory() as folder:
        path = Path(folder) / "sample.yaml"
        path.write_text(text + "\n", encoding="utf-8")
        return derive(load(path))


@cache
def pair(names: str) -> tuple[Derivation, Derivation, dict[str, float]]:
    """The robot with ratios; the one with other radii and equal spins; the turns of each wheel for one turn there."""
    turns: dict[str, float] = {}
    for ratios in CASES[names]:
        shaft = next((turns[n] / k for n, k in ratios.items() if n in turns), 1.0)
        turns |= {n: shaft * k for n, k in ratios.items()}
    turns = {n: turns.get(n, 1.0) for n in names}
    sets = [(f"equal: [{', '.join(f'{n}.spin' for n in r)}]", list(r.values())) for r in CASES[names]]
    geared = ", ".join(f"{{{equal}, ratios: {ratios}}}" for equal, ratios in sets)
    equal = ", ".join(f"{{{equal}}}" for equal, _ in sets)
    geared, equal = (text + STEERED.get(names, "") for text in (geared, equal))
    own = {n: PLACES[n] for n in names}
    others = {
        n: (x, y, h, turns[n] * r, more)
        if turns[n] > 0
        else (x, y, h + 180, -turns[n] * r, more.replace("-0", "0"))
        for n, (x, y, h, r, more) in own.items()
    }
    return robot(own, geared), robot(others, equal), turns


def seen(values: Mapping[str, float], turns: Mapping[str, float]) -> dict[str, float]:
    """Spins and their rates of one robot as those of the other."""
    share = {f"{n}.{joint}": k for n, k in turns.items() for joint in ("spin", "spin_rate")}
    return {name: float(value) / share.get(name, 1.0) for name, value in values.items()}


@pytest.mark.parametrize("names", CASES)
def test_degrees_are_those_of_the_robot_with_equal_spins(names: str) -> None:
    geared, equal, _ = pair(names)
    assert [getattr(geared.mobility, w) for w in WORDS] == [getattr(equal.mobility, w) for w in WORDS]


@pytest.mark.parametrize("names", CASES)
def test_the_null_space_is_that_of_the_robot_with_equal_spins(names: str) -> None:
    planes = []
    for d in pair(names)[:2]:
        at = generic(d.robot)
        columns = [[nominal_at(p, d.robot, at) for p in column] for column in d.mobility.null_space]
        matrix = np.array(columns).reshape(-1, 3).T
        planes.append(matrix @ np.linalg.pinv(matrix))
    assert planes[0] == pytest.approx(planes[1], abs=1e-9)


@pytest.mark.parametrize("function", ["inverse", "forward", "accelerations"])
@pytest.mark.parametrize("names", CASES)
def test_functions_are_those_of_the_robot_with_equal_spins(names: str, function: str) -> None:
    geared, equal, turns = pair(names)
    chance = random.Random(names)
    backwards = {n: 1.0 / k for n, k in turns.items()}
    one, other = (lower(d.formula(function)) for d in (geared, equal))
    for _ in range(20):
        at = {port.name: chance.uniform(-1, 1) for port in one.inputs}
        out, expected = evaluate(one, at, FLOAT64), evaluate(other, seen(at, turns), FLOAT64)
        assert {k: float(v) for k, v in out.items()} == pytest.approx(seen(expected, backwards), abs=1e-9)


def test_two_wheels_in_a_ratio_drive_a_circle_alone() -> None:
    """The left one rolls 0.1 a turn at y = 0.3 and the right one 0.16 at y = -0.25: v(y) = 0 at 0.3 + 0.55 / 0.6."""
    m = pair("ab")[0].mobility
    assert (m.degree_of_mobility, m.degree_of_steerability) == (1, 0)
    (column,) = m.null_space
    vx, _, omega = (float(p.constant or 0) for p in column)
    assert vx / omega == pytest.approx(0.3 + 0.55 * 0.1 / 0.06)
    assert "1 : 2" in next(reason.text for reason in m.explanation if reason.key == "coupled")


def test_limits_hold_for_each_in_its_ratio() -> None:
    limits = "limits: {spin: [-4, 6]}"
    d = robot({n: PLACES[n] for n in "ab"}, "{equal: [a.spin, b.spin], ratios: [1, -2]}", limits)
    a, b = (d.robot.limit(w, "spin") for w in d.robot.wheels)
    assert a is not None and b is not None
    assert [float(v) for v in (a.low, a.high, b.low, b.high)] == [-3, 2, -4, 6]


@pytest.mark.parametrize(
    ("couplings", "code", "at", "named"),
    [
        ("{equal: [a.spin, b.spin], ratios: [1, 0]}", "WMR109", "0]}", ["0"]),
        ("{equal: [a.spin, b.spin], ratios: [1]}", "WMR104", "", ["1", "2"]),
        ("{equal: [a.spin, b.spin], ratios: [1, 2, 3]}", "WMR104", "", ["3", "2"]),
        ("{equal: [a.spin, b.spin], ratios: [1, 90 deg]}", "WMR104", "90 deg", ["90 deg"]),
        ("{equal: [a.spin, b.spin], ratios: 2}", "WMR104", "2}", ["ratios"]),
        ("{equal: [c.steer, d.steer], ratios: [1, 2]}", "WMR109", "2]}", ["1", "2"]),
        *(
            (
                f"{{equal: [a.spin, b.spin]}}, {{equal: [b.spin, c.spin]}}, {{equal: [a.spin, c.spin], ratios: {k}}}",
                "WMR109", "", ["c.spin"],
            )
            for k in ([1, 2], [2, 1])
        ),
    ],
)  # fmt: skip
def test_what_is_no_ratio_is_refused(couplings: str, code: str, at: str, named: list[str]) -> None:
    with pytest.raises(RobotFileError) as caught:
        robot({n: PLACES[n] for n in "abcd"}, couplings)
    mark = caught.value.mark
    assert caught.value.code == code and mark is not None and mark.text.startswith("couplings:")
    assert mark.text[mark.column - 1 :].startswith(at)
    assert all(name in caught.value.what for name in named)
