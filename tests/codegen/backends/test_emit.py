"""Numbers of the legend of wheels, in headers and reports."""

from __future__ import annotations

import pytest

from wmrgen.derivation.emit import _number


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.1234567, "0.123457"),
        (-0.5, "-0.5"),
        (4e-12, "4e-12"),
        (4e-13, "0"),
        (-4e-13, "0"),
        (-0.0, "0"),
        (12345678.0, "1.23457e+07"),
    ],
)
def test_lengths_have_six_digits_and_noise_is_zero_without_a_sign(value: float, text: str) -> None:
    assert _number(value) == text
