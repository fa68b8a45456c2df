"""Which limits of the robot file bound a car, and which leave it none."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.functions.common import TRICYCLE, call, derived, write
from tests.functions.refusals import refused
from wmrgen.functions.registry import Reason


def limited(limits: str, front: str = "heading: 0", base: str = "1.2") -> str:
    return (
        TRICYCLE.format(base=base).replace(f"x: {base}, y: 0, heading: 0", f"x: {base}, y: 0, {front}")
        + limits
    )


def test_of_limits_to_two_sides_the_nearer_one_counts(tmp_path: Path) -> None:
    base = write(tmp_path, limited("limits: {vx: 1.5, steer: 0.5}\n"))
    for text in (
        "limits: {vx: 1.5, steer: [-0.5, 0.8]}\n", "limits: {vx: 1.5, steer: [-0.8, 0.5]}\n",
        "limits: {vx: [-1.5, 2], steer: 0.5}\n", "limits: {vx: [-2, 1.5], steer: 0.5}\n",
    ):  # fmt: skip
        values = {"v": 0.7, "omega": 0.4}
        path = write(tmp_path, limited(text))
        assert call(path, "input_limits", values) == pytest.approx(call(base, "input_limits", values))
    other = write(tmp_path, limited("limits: {vx: 1.5, steer: 0.5}\n", "heading: pi"))
    assert call(other, "input_limits", values) == pytest.approx(call(base, "input_limits", values))


@pytest.mark.parametrize(
    ("text", "reason", "names"),
    [
        (limited("limits: {vx: 1, steer: 0.5}\n", "heading: pi/6"), Reason.SKEWED_WHEEL, ("front",)),
        (limited("limits: {vx: 1, steer: 0.5}\n", "heading: pi/2"), Reason.SKEWED_WHEEL, ("front",)),
        (limited("limits: {vx: 1, steer: [0.1, 0.5]}\n"), Reason.ONE_SIDED_LIMIT, ("front", "-0.1 rad")),
        (limited("limits: {vx: 1, steer: [0, 0.5]}\n"), Reason.ONE_SIDED_LIMIT, ("front", "0 rad")),
        (limited("limits: {vx: 1, steer: 1.57}\n"), Reason.LIMIT_TOO_WIDE, ("front", "1.57 rad")),
        (limited("limits: {vx: [0, 1], steer: 0.5}\n"), Reason.ONE_SIDED_LIMIT, ("vx",)),
        (limited("limits: {spin: [-1, 0], steer: 0.5}\n"), Reason.ONE_SIDED_LIMIT, ("spin",)),
    ],
)
def test_limits_that_leave_nothing_are_named(
    text: str, reason: Reason, names: tuple[str, ...], tmp_path: Path
) -> None:
    with refused(reason, *names):
        derived(write(tmp_path, text), "input_limits").formula("input_limits")


def test_limits_just_short_of_that_are_taken(tmp_path: Path) -> None:
    for steer, vx in (("1.569", "1"), ("[-0.001, 0.5]", "1"), ("0.5", "[-0.001, 1]")):
        path = write(tmp_path, limited(f"limits: {{vx: {vx}, steer: {steer}}}\n"))
        assert derived(path, "input_limits").formula("input_limits").outputs


@pytest.mark.parametrize(
    ("heading", "straight"), [("pi/6", True), ("-5*pi/6", True), ("-pi/6", False), ("0", False)]
)
def test_straight_ahead_is_along_the_axle_s_forward_direction(
    heading: str, straight: bool, tmp_path: Path
) -> None:
    """A bicycle at 30 degrees in its frame."""
    text = (
        "wmrgen: 1\nname: bicycle\nlimits: {vx: 1.5, steer: 0.5}\nwheels:\n"
        "  - {name: rear, type: fixed, x: 0.1, y: 0.2, heading: pi/6, r: 0.1}\n"
        f"  - {{name: front, type: steered, x: 0.1 + 1.2*cos(pi/6), y: 0.2 + 0.6, heading: {heading}, r: 0.1}}\n"
    )
    path = write(tmp_path, text)
    if not straight:
        with refused(Reason.SKEWED_WHEEL, "front"):
            derived(path, "input_limits").formula("input_limits")
        return
    values = {"v": 0.7, "omega": 0.4}
    ahead = write(tmp_path, limited("limits: {vx: 1.5, steer: 0.5}\n"))
    assert call(path, "input_limits", values) == pytest.approx(call(ahead, "input_limits", values), abs=1e-12)
