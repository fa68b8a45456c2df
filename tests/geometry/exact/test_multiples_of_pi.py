"""Angles that are written with pi or in degrees have the sines that they have, and come out as they went in."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import pytest

from wmrgen.geometry.exact.evaluate import direction_over_pi, over_pi, pi_rational
from wmrgen.geometry.exact.number import SQRT2, SQRT3, Exact
from wmrgen.ir.nodes import Op

ROOTS = {0: Exact(0), 2: Exact(1) / 2, 3: SQRT2 / 2, 4: SQRT3 / 2, 6: Exact(1), 12: Exact(0), -6: Exact(-1)}


def angle(q: Fraction) -> Exact:
    return Exact(pi_rational() * q)


@pytest.mark.parametrize("k", [*range(-30, 31), 24 * 10**9 + 5, -(10**12)])
def test_twelfths_of_pi_have_exact_sines(k: int) -> None:
    sine, cosine = (op.exact(angle(Fraction(k, 12))) for op in (Op.SIN, Op.COS))
    assert sine * sine + cosine * cosine == Exact(1)
    with mpmath.workdps(60):
        assert abs(float(sine) - float(mpmath.sin(mpmath.pi * k / 12))) < 1e-15
        assert abs(float(cosine) - float(mpmath.cos(mpmath.pi * k / 12))) < 1e-15
    assert ROOTS.get(k, sine) == sine


def test_sums_of_multiples_are_multiples() -> None:
    third, sixth = angle(Fraction(1, 3)), angle(Fraction(1, 6))
    assert over_pi(third + sixth) == Fraction(1, 2) and Op.COS.exact(third + sixth) == Exact(0)
    assert over_pi(third - angle(Fraction(7, 3))) == -2
    assert over_pi(Exact(0)) == 0


@pytest.mark.parametrize(
    "value", [Fraction(1), Fraction(355, 113), Fraction(1.5707963267948966), Fraction(2, 10**40)]
)
def test_other_numbers_are_no_multiples(value: Fraction) -> None:
    """The double next to pi/2 is another number than pi/2: its cosine is 6e-17."""
    assert over_pi(Exact(value)) is None
    with mpmath.workdps(60):
        wanted = mpmath.cos(mpmath.mpf(value.numerator) / value.denominator)
        assert float(Op.COS.exact(Exact(value))) == pytest.approx(float(wanted), rel=1e-15)


@pytest.mark.parametrize("k", range(-11, 13))
def test_directions_along_twelfths_come_back(k: int) -> None:
    q, length = Fraction(k, 12), Exact(Fraction(7, 3), Fraction(1, 5))
    x, y = (op.exact(angle(q)) * length for op in (Op.COS, Op.SIN))
    assert direction_over_pi(y, x) == q and Op.ATAN2.exact(y, x) == angle(q)
    if abs(k) < 6:
        assert Op.ATAN.exact(y / x) == angle(q)


@pytest.mark.parametrize(
    ("y", "x", "q"), [(SQRT2 - 1, 1, "1/8"), (1, SQRT2 - 1, "3/8"), (1 - SQRT2, -1, "-7/8")]
)
def test_eighths_of_pi(y: Exact | int, x: Exact | int, q: str) -> None:
    assert direction_over_pi(Exact.of(y), Exact.of(x)) == Fraction(q)


def test_no_vector_has_no_direction() -> None:
    assert direction_over_pi(Exact(0), Exact(0)) is None and Op.ATAN2.exact(Exact(0), Exact(0)) == Exact(0)
    assert direction_over_pi(Exact(3), Exact(4)) is None
