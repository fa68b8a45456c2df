"""What section 6 says of steered wheels on one motor or on one chain."""

from __future__ import annotations

import pytest

from tests.report.sections.common import sentence
from tests.robots import of_text
from wmrgen.report.sections.inverse import inverse
from wmrgen.report.sections.markdown import keys

PLACES = {"a": (0.4, 0.3), "b": (-0.5, 0.2), "c": (0.1, -0.6), "d": (-0.2, -0.3), "e": (0.2, 0.5)}
CHOOSES = "inverse.same_direction"


def section(names: str, *couplings: str, fixed: str = "") -> str:
    lines = [
        f"  - {{name: {n}, type: {'fixed' if n in fixed else 'steered'}, x: {PLACES[n][0]}, y: {PLACES[n][1]}, "
        f"heading: {15 * k if n not in fixed else 0} deg, r: 0.1}}"
        for k, n in enumerate(names)
    ]
    text = "\n".join(["wmrgen: 1", "name: sample", "wheels:", *lines, "couplings:" if couplings else ""])
    return "\n".join(inverse(of_text(text + "".join(f"\n  - equal: [{c}]" for c in couplings) + "\n")))


def spins(names: str) -> str:
    return ", ".join(f"{n}.spin" for n in names)


def steers(names: str) -> str:
    return ", ".join(f"{n}.steer" for n in names)


@pytest.mark.parametrize("names", ["ab", "abc"])
def test_a_chain_is_one_speed_and_a_choice_of_headings(names: str) -> None:
    chained = keys(section(names, spins(names)))
    assert CHOOSES in chained and "inverse.one_speed" in chained
    assert "inverse.one_speed" not in keys(section(names))


@pytest.mark.parametrize(
    ("names", "motor", "chooses"),
    [
        ("ab", "ab", False),
        ("abc", "abc", False),
        ("abc", "ab", True),
        ("abc", "bc", True),
        ("abc", "ac", True),
    ],
)
def test_wheels_of_one_motor_have_no_choice_among_themselves(names: str, motor: str, chooses: bool) -> None:
    text = section(names, spins(names), steers(motor))
    assert (CHOOSES in keys(text)) == chooses
    assert "inverse.compromise_angle" in keys(text)


@pytest.mark.parametrize(("names", "fixed"), [("ad", "d"), ("da", "d"), ("abd", "d")])
def test_a_wheel_that_does_not_steer_is_one_of_the_others(names: str, fixed: str) -> None:
    text = section(names, spins(names), fixed=fixed)
    said = sentence(text, CHOOSES)
    assert ("`a` and `b` " if len(names) == 3 else " `a` ") in said and "`d`" not in said


def test_a_chain_of_wheels_that_do_not_steer_chooses_nothing() -> None:
    text = section("da", "d.spin, a.spin", fixed="da")
    assert "inverse.one_speed" in keys(text) and CHOOSES not in keys(text)


def test_wheels_that_turn_and_roll_alike_share_nothing_that_differs() -> None:
    """A synchro drive: on one motor and one chain each wheel's own speed is the common one."""
    shared = "inverse.mean_rate"
    text = """wmrgen: 1
name: sample
wheels:
  - {name: a, type: steered, x: 0.3, y: 0, heading: 0, r: 0.1}
  - {name: b, type: steered, x: -0.3, y: 0.2, heading: 0, r: RADIUS}
couplings: [{equal: [a.steer, b.steer]}, {equal: [a.spin, b.spin]}]
"""
    assert shared not in keys("\n".join(inverse(of_text(text.replace("RADIUS", "0.1")))))
    assert shared in keys("\n".join(inverse(of_text(text.replace("RADIUS", "0.12")))))
