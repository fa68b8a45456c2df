"""Integrals of the wheel angles: what the only motions of a robot reach."""

from __future__ import annotations

import math

import pytest

from tests.robots import of_text
from wmrgen.functions.models.integrals import Integral

WHEEL = "  - {{name: {}, type: fixed, x: {}, y: {}, heading: '{}', r: 0.5}}\n"


def integrals(*wheels: str) -> tuple[Integral, ...]:
    return of_text("wmrgen: 1\nname: sample\nwheels:\n" + "".join(wheels)).integrability.integrals


def test_a_wheel_rolls_along_the_only_line() -> None:
    """Two fixed wheels at atan2(4, 3) leave one line: (3, 4)/5. The angle is the distance along it over r."""
    heading = "atan2(4, 3)"
    found = integrals(WHEEL.format("a", 0, 0, heading), WHEEL.format("b", 1, 0, heading))
    turning, line, *angles = (dict(i.coefficients) for i in found)
    assert turning == {"theta": 1.0}
    assert line["y_body"] / line["x_body"] == pytest.approx(-3 / 4)
    for name, angle in zip("ab", angles, strict=True):
        assert angle == pytest.approx({f"{name}.angle": -1.0, "x_body": 0.6 / 0.5, "y_body": 0.8 / 0.5})


def test_an_omni_wheel_counts_only_the_part_along_the_line() -> None:
    """Its row is along x, the line along (3, 4)/5: of 1/r per metre along x, 3/5 is left along the line."""
    heading = "atan2(4, 3)"
    omni = "  - {name: c, type: swedish, x: 2, y: 0, heading: 0, r: 0.5, gamma: 0}\n"
    found = integrals(WHEEL.format("a", 0, 0, heading), WHEEL.format("b", 1, 0, heading), omni)
    angle = next(d for d in (dict(i.coefficients) for i in found) if "c.angle" in d)
    share = 0.6 / 0.5  # of the distance along the line
    assert angle == pytest.approx({"c.angle": -1.0, "x_body": share * 0.6, "y_body": share * 0.8})
    assert math.hypot(angle["x_body"], angle["y_body"]) == pytest.approx(share)


def test_two_translations_keep_the_whole_gradient() -> None:
    """Omni wheels that are coupled so that the robot cannot turn: angles are x/r and y/r."""
    wheels = (
        "  - {name: a, type: swedish, x: 0, y: 1, heading: 0, r: 0.5, gamma: 0}\n",
        "  - {name: b, type: swedish, x: 0, y: -1, heading: 0, r: 0.5, gamma: 0}\n",
        "  - {name: c, type: swedish, x: 0, y: 0, heading: pi/2, r: 0.5, gamma: 0}\n",
        "couplings: [{equal: [a.spin, b.spin]}]\n",
    )
    found = [dict(i.coefficients) for i in integrals(*wheels)]
    assert {"theta": 1.0} in found
    gradients = {name: d for d in found for name in d if name.endswith(".angle")}
    assert gradients["a.angle"] == pytest.approx({"a.angle": -1.0, "x_body": 2.0})
    assert gradients["c.angle"] == pytest.approx({"c.angle": -1.0, "y_body": 2.0})
