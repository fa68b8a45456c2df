"""Which steering angles formulas use: of a front wheel if there is one, and of wheels whose axles differ."""

from __future__ import annotations

import pytest

from tests.robots import of_text

HEAD = """wmrgen: 1
name: sample
wheels:
  - {name: left, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.3, heading: 0, r: 0.1}
"""
WHEEL = "  - {name: %s, type: steered, x: %s, y: %s, heading: 0, r: 0.1}\n"


def deciding(head: str, *wheels: tuple[str, float, float]) -> tuple[str, ...]:
    text = head + "".join(WHEEL % wheel for wheel in wheels)
    return of_text(text).mobility.basis_wheels


@pytest.mark.parametrize("rear", [-0.5, -0.7, -0.4])
@pytest.mark.parametrize("first", ["front", "rear"])
def test_the_front_wheel_of_a_rover_that_steers_both_ends(rear: float, first: str) -> None:
    """In any order of the file, also if the rear wheel is somewhat farther from the fixed axle."""
    wheels = sorted([("front", 0.5, 0.2), ("rear", rear, 0.2)], key=lambda w: w[0] != first)
    assert deciding(HEAD, *wheels) == ("front",)


def test_a_wheel_next_to_the_fixed_axle_does_not_decide() -> None:
    """Its angle hardly moves along the axle: the model would be nearly singular."""
    assert deciding(HEAD, ("close", 0.05, 0.0), ("rear", -0.6, 0.0)) == ("rear",)


def test_two_wheels_that_share_no_line() -> None:
    """Of four corners, those of a diagonal: axles of a side or an end coincide at 0 or 90 degrees."""
    corners = [("fl", 0.4, 0.3), ("fr", 0.4, -0.3), ("bl", -0.4, 0.3), ("br", -0.4, -0.3)]
    assert deciding("wmrgen: 1\nname: sample\nwheels:\n", *corners) == ("fl", "br")
