"""Every reading of a log undoes the mistake that its words name: a table of units that shares nothing with the code."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from wmrgen.tools.calibrating.logs import Drive, Truth
from wmrgen.tools.calibrating.readings import counts, readings

RANDOM = np.random.default_rng(31337)
T = np.cumsum(RANDOM.uniform(0.1, 0.2, 9))
K = np.arange(8)
NAMES = "a.spin a.steer a.steer_rate b.spin b.steer b.steer_rate".split()
RIGHT = Drive(
    "run", T, {n: RANDOM.normal(size=8) for n in NAMES}, Truth(T[2:6] + 0.05, *RANDOM.normal(size=(3, 4)))
)
IN_UNIT = {
    "millimetres": 1000.0, "centimetres": 100.0, "inches": 1 / 0.0254, "feet": 1 / 0.3048,
    "degrees": 180 / np.pi, "turns": 0.5 / np.pi, "rpm": 30 / np.pi, "other": -1.0,
}  # fmt: skip
WHAT = {
    "speeds of the wheels|angles of the wheels|every wheel": r".*\.spin",
    "angles of the joints": r".*\.(spin|steer|steer_rate)",
    "steering angles|every steering angle": r".*\.(steer|steer_rate)",
    "a.spin": r"a\.spin", "b.spin": r"b\.spin", "a.steer": r"a\.steer.*", "b.steer": r"b\.steer.*",
    "theta of the truth": "theta", "x and y of the truth": "x|y", "y and theta of the truth": "y|theta",
}  # fmt: skip


def values(drive: Drive) -> dict[str, np.ndarray]:
    truth = drive.truth
    return {**drive.columns, "t": drive.t, "at": truth.t, "x": truth.x, "y": truth.y, "theta": truth.theta}


def of(numbers: dict[str, np.ndarray]) -> Drive:
    truth = Truth(*(numbers[name] for name in ("at", "x", "y", "theta")))
    return Drive("run", numbers["t"], {name: numbers[name] for name in NAMES}, truth)


def exchanged(a: str, b: str) -> dict[str, np.ndarray]:
    right, other = values(RIGHT), {a: b, b: a}
    return {n: right[re.sub(f"^({a}|{b})(?=$|_)", lambda m: other[m[0]], n)] for n in right}


def mistaken(text: str) -> dict[str, np.ndarray]:
    """The numbers of somebody who made the mistake that ``text`` names."""
    right = values(RIGHT)
    if pair := re.match(r"the columns of (\S+) and (\S+) exchanged|(x) and (y) of the truth exchanged", text):
        return exchanged(*(name for name in pair.groups() if name))
    if "should be <wheel>.angle" in text:  # what is taken for a speed is multiplied by the time that it lasts
        angles = {n: np.cumsum(right[n]) * np.diff(T) for n in NAMES if n.endswith(".spin")}
        return {**right, **angles}
    if (
        "should be <wheel>.spin" in text
    ):  # what is taken for an increment is that of a speed, which is 0 at first
        middles = {n: right[n] / np.diff(T) for n in NAMES if n.endswith(".spin")}
        speeds = {n: 2 * np.cumsum(m * (-1.0) ** K) * (-1.0) ** K for n, m in middles.items()}
        return {**right, **{n: np.diff(speed, prepend=0.0) for n, speed in speeds.items()}}
    if "should be summed up" in text:  # what is taken for a speed is multiplied by the time that it lasts
        return {**right, **{n: right[n] * np.diff(T) for n in NAMES if n.endswith(".spin")}}
    if "clockwise" in text and "degrees" in text:
        turned = {**right, "theta": -right["theta"] * IN_UNIT["degrees"]}
        return {**turned, "y": -right["y"]} if text.startswith("y ") else turned
    if "of each step alone" in text:
        return {**right, **{n: np.diff(right[n], prepend=0.0) for n in NAMES if n.endswith(".spin")}}
    whose = next(names for words, names in WHAT.items() if re.match(words + r"\b", text))
    unit = re.search(rf"(?:seems? to be in |counted the )({'|'.join(IN_UNIT)})\b", text)
    assert unit, text
    return {n: v * (IN_UNIT[unit[1]] if re.fullmatch(whose, n) else 1.0) for n, v in right.items()}


READINGS = dict(readings(RIGHT, 0.0))
AS_LONG = next(text for text in READINGS if text.startswith("times of the truth"))


@pytest.mark.parametrize("text", [text for text in READINGS if text != AS_LONG])
def test_a_reading_undoes_its_mistake(text: str) -> None:
    numbers = mistaken(text)
    assert any(not np.array_equal(v, numbers[n]) for n, v in values(RIGHT).items())
    undone = values(READINGS[text](of(numbers)))
    for name, right in values(RIGHT).items():
        assert undone[name] == pytest.approx(right), name


def test_times_that_last_as_long_and_wheels_that_turn_farther() -> None:
    """The truth begins and ends with the log; counts to a turn are 2 pi by how much farther the wheels turn."""
    at = READINGS[AS_LONG](RIGHT).truth.t
    assert (at[0], at[-1]) == pytest.approx((T[0], T[-1]))
    assert np.diff(at) / np.diff(RIGHT.truth.t) == pytest.approx(
        np.full(3, np.ptp(T) / np.ptp(RIGHT.truth.t))
    )
    text, change = counts(RIGHT, 2 * np.pi / 512)
    assert "about 512 to a turn" in text
    farther = replace(
        RIGHT, columns={n: v * (512 / (2 * np.pi) if "spin" in n else 1) for n, v in RIGHT.columns.items()}
    )
    for name, column in change(farther).columns.items():
        assert column == pytest.approx(RIGHT.columns[name])
