"""Numbers in the table of wheels, in headers and reports."""

from __future__ import annotations

import pytest

from tests.robots import of_text
from wmrgen.derivation.emit import facts
from wmrgen.ir.kernels.choice import DEFAULT

ROBOT = """wmrgen: 1
name: pair
wheels:
  - {{name: left,  type: fixed, x: {0}, y: 0.2,  heading: 0, r: 0.1}}
  - {{name: right, type: fixed, x: {0}, y: -0.2, heading: 0, r: 0.1}}
"""


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("0.1234567", "0.123457"),
        ("-0.5", "-0.5"),
        ("4e-12", "4e-12"),
        ("4e-13", "0"),
        ("-4e-13", "0"),
        ("-0.0", "0"),
        ("0.100000049", "0.1"),
    ],
)
def test_lengths_have_six_digits_and_noise_is_zero_without_a_sign(value: str, text: str) -> None:
    lines = facts(of_text(ROBOT.format(value)), DEFAULT, b"").wheel_lines
    assert f", x {text} m," in lines[0] and f", x {text} m," in lines[1]
