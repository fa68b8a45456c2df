"""Cosines and sines of angles that are polynomials: exact where they can be, a point of the circle elsewhere.

The sine of a multiple of pi/12 lies in Q(sqrt2, sqrt3). Any other number becomes a rational point of the unit
circle through the half-angle parametrisation, so that c**2 + s**2 = 1 holds exactly.
"""

from __future__ import annotations

from fractions import Fraction

import mpmath

from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Gen, Poly

_SQRT2, _SQRT6 = Exact(0, 1), Exact(0, 0, 0, 1)
_SIN = (  # of k pi/12, k = 0..6
    Exact(0), (_SQRT6 - _SQRT2) / 4, Exact(Fraction(1, 2)), _SQRT2 / 2, Exact(0, 0, Fraction(1, 2)),
    (_SQRT6 + _SQRT2) / 4, Exact(1),
)  # fmt: skip
_HALF_ANGLE_DIGITS = 20  # two of them multiply to the 40 digits of the point
PRECISION = 60
_MOST_TIMES = 4

CosSin = tuple[Poly, Poly]


def twelfths(k: int) -> tuple[Exact, Exact]:
    """(cos, sin) of k pi/12, exactly."""

    def sine(j: int) -> Exact:
        j %= 24
        if j > 12:
            return -sine(j - 12)
        return _SIN[j] if j <= 6 else _SIN[12 - j]

    return sine(k + 6), sine(k)


def pi_rational() -> Fraction:
    """pi to 60 digits."""
    with mpmath.workdps(PRECISION + 5):
        return to_fraction(mpmath.pi)


def to_fraction(value: mpmath.mpf) -> Fraction:
    """The exact value of an mpf."""
    sign, man, exp, _ = mpmath.mpf(value)._mpf_
    f = Fraction(int(man)) * Fraction(2) ** int(exp)
    return -f if sign else f


def to_mpf(value: Fraction) -> mpmath.mpf:
    """A fraction at the working precision."""
    return mpmath.mpf(value.numerator) / value.denominator


def circle(half: Fraction) -> tuple[Exact, Exact]:
    """(cos, sin) of the angle with this tangent of its half."""
    square = half * half
    return Exact((1 - square) / (1 + square)), Exact(2 * half / (1 + square))


def circle_point(angle: Fraction) -> tuple[Exact, Exact]:
    """(cos, sin) of ``angle`` [rad] within 1e-19, as a rational point of the unit circle."""
    with mpmath.workdps(PRECISION):
        a = to_mpf(angle)
        quarter = int(mpmath.nint(a / (mpmath.pi / 2)))
        t = mpmath.tan((a - quarter * mpmath.pi / 2) / 2)
        q = 10**_HALF_ANGLE_DIGITS
        p = int(mpmath.nint(t * q))
    c, s = Exact(Fraction(q * q - p * p, q * q + p * p)), Exact(Fraction(2 * p * q, q * q + p * p))
    for _ in range(quarter % 4):
        c, s = -s, c
    return c, s


def add_angles(a: CosSin, b: CosSin) -> CosSin:
    """(cos, sin) of a sum."""
    return a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]


def pi_multiple(angle: Poly) -> Fraction | None:
    """q when the angle is exactly q pi, else None."""
    if not angle:
        return Fraction(0)
    if len(angle.terms) != 1:
        return None
    ((monomial, coefficient),) = angle.terms.items()
    single = len(monomial) == 1 and monomial[0][0].kind == "pi" and monomial[0][1] == 1
    return coefficient.parts[0] if single and coefficient.is_rational else None


def cos_sin(angle: Poly) -> CosSin:
    """(cos, sin) of an angle [rad] given as a polynomial in pi, numbers, parameters and functions of them."""
    number, turns = Fraction(0), Fraction(0)
    rest = Poly({})
    result: CosSin = (Poly.of(1), Poly.of(0))
    for monomial, coefficient in sorted(
        angle.terms.items(), key=lambda item: [(g.key, e) for g, e in item[0]]
    ):
        gen = monomial[0][0] if len(monomial) == 1 and monomial[0][1] == 1 else None
        if all(g.kind == "pi" for g, _ in monomial):
            if gen is not None and coefficient.is_rational:
                turns += coefficient.parts[0]
            else:
                power = monomial[0][1] if monomial else 0
                number += coefficient.rational() * pi_rational() ** power
        elif gen is not None and gen.kind in ("param", "atan2") and _is_small_integer(coefficient):
            result = add_angles(result, _multiple(_base(gen), int(coefficient.parts[0])))
        else:
            rest = rest + Poly({monomial: coefficient})
    if rest:
        result = add_angles(result, (Poly.gen("cosf", "", rest), Poly.gen("sinf", "", rest)))
    twelve = turns * 12
    if twelve.denominator == 1:
        exact = twelfths(int(twelve))
        result = add_angles((Poly.of(exact[0]), Poly.of(exact[1])), result)
        turns = Fraction(0)
    if number or turns:
        c, s = circle_point(number + turns * pi_rational())
        result = add_angles((Poly.of(c), Poly.of(s)), result)
    return result


def _is_small_integer(value: Exact) -> bool:
    """Whether the addition theorem is worth its terms."""
    return value.is_rational and value.den == 1 and abs(value.num[0]) <= _MOST_TIMES


def _base(gen: Gen) -> CosSin:
    if gen.kind == "param":
        own = Poly({((gen, 1),): Exact(1)})
        return Poly.gen("cosf", "", own), Poly.gen("sinf", "", own)
    y, x = gen.args
    hypotenuse = sqrt_poly(x * x + y * y).inverse()
    return x * hypotenuse, y * hypotenuse


def _multiple(base: CosSin, k: int) -> CosSin:
    step: CosSin = base if k > 0 else (base[0], -base[1])
    result: CosSin = (Poly.of(1), Poly.of(0))
    for _ in range(abs(k)):
        result = add_angles(result, step)
    return result


def sqrt_poly(value: Poly) -> Poly:
    """sqrt of a polynomial: in the field where possible, else the generator sqrt(value)."""
    from wmrgen.exact.number import exact_sqrt

    number = value.constant
    if number is not None:
        root = exact_sqrt(number)
        if root is not None:
            return Poly.of(root)
    return Poly.gen("sqrt", "", value)
