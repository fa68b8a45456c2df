"""Functions of polynomials, and the values of polynomials for given parameter values.

Sines and roots are exact if possible: the sine of a multiple of pi/12 is in Q(sqrt2, sqrt3). Any other angle that is
a number becomes a rational point of the unit circle by the half-angle parametrisation, so that c**2 + s**2 = 1 holds
exactly. Any other root, direction or tangent is rounded to 40 digits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache, reduce

import mpmath

from wmrgen.geometry.exact.number import ONE, SQRT2, SQRT3, ZERO, Exact, exact_sqrt
from wmrgen.geometry.exact.poly import Gen, Poly

PRECISION = 60  # decimal digits of mpmath, 20 more than a result keeps
_SQRT6 = SQRT2 * SQRT3
_SIN = (  # of k pi/12, k = 0..6
    ZERO, (_SQRT6 - SQRT2) / 4, ONE / 2, SQRT2 / 2, SQRT3 / 2, (_SQRT6 + SQRT2) / 4, ONE,
)  # fmt: skip
_DIGITS = 40  # significant decimal digits of roots, directions and tangents that are not in the field
_HALF_ANGLE_DIGITS = 20  # digits of tan(angle/2): cosine and sine are quadratic in it, so they have 40
# Multiples of an angle that the addition theorem expands; more would give too many terms.
_TIMES = range(-4, 5)
_ROUNDED = 1e-18  # relative: a smaller difference of rounded numbers is 0; a root halves the 40 digits

_TANGENTS = {Fraction(k, 12): _SIN[k] / _SIN[6 - k] for k in range(6)}
_TANGENTS |= {
    Fraction(1, 8): SQRT2 - 1,
    Fraction(3, 8): SQRT2 + 1,
}  # q -> tan(q pi), where it is in the field
_DIRECTIONS = {t * sign: q * sign for q, t in _TANGENTS.items() for sign in (1, -1)}
# Separates multiples of the 60-digit pi, whose denominators are larger, from ordinary numbers.
_PI_SIZE = 10**30

CosSin = tuple[Poly, Poly]


def twelfths(k: int) -> tuple[Exact, Exact]:
    """Return (cos, sin) of k pi/12, exactly."""

    def sine(j: int) -> Exact:
        j %= 24
        if j > 12:
            return -sine(j - 12)
        return _SIN[j] if j <= 6 else _SIN[12 - j]

    return sine(k + 6), sine(k)


def direction_over_pi(y: Exact, x: Exact) -> Fraction | None:
    """Return q, -1 < q <= 1, if the vector (x, y) points along q pi and q is a multiple of 1/12 or an odd one of 1/8.

    Return None for any other direction, and for the zero vector.
    """
    if not x:
        return Fraction(y.sign, 2) if y else None
    q = _DIRECTIONS.get(y / x)
    if q is None or x.sign > 0:
        return q
    return q - 1 if y.sign < 0 else q + 1


@cache
def pi_rational() -> Fraction:
    """Return pi to 60 digits."""
    with mpmath.workdps(PRECISION + 5):
        return to_fraction(mpmath.pi)


def over_pi(value: Exact) -> Fraction | None:
    """Return q if ``value`` is q times `pi_rational`, else None.

    Such values come from numbers that were written with pi or in degrees, and from their sums.
    """
    if value.den < _PI_SIZE and value:
        return None  # the usual case
    q = value.parts[0] / pi_rational() if value.is_rational else None
    return q if q is not None and q.denominator < _PI_SIZE else None


def to_fraction(value: mpmath.mpf) -> Fraction:
    """Return the exact value of an mpf."""
    sign, man, exp, _ = mpmath.mpf(value)._mpf_
    f = Fraction(int(man)) * Fraction(2) ** int(exp)
    return -f if sign else f


def to_mpf(value: Fraction) -> mpmath.mpf:
    """Return a fraction at the current mpmath precision."""
    return mpmath.mpf(value.numerator) / value.denominator


def circle(half: Fraction) -> tuple[Exact, Exact]:
    """Return (cos, sin) of the angle whose half has the tangent ``half``."""
    square = half * half
    return Exact((1 - square) / (1 + square)), Exact(2 * half / (1 + square))


def circle_point(angle: Fraction) -> tuple[Exact, Exact]:
    """Return (cos, sin) of ``angle`` [rad] within 1e-19, as a rational point of the unit circle."""
    with mpmath.workdps(PRECISION):
        a = to_mpf(angle)
        quarter = int(mpmath.nint(a / (mpmath.pi / 2)))
        t = mpmath.tan((a - quarter * mpmath.pi / 2) / 2)
        q = 10**_HALF_ANGLE_DIGITS
        c, s = circle(Fraction(int(mpmath.nint(t * q)), q))
    for _ in range(quarter % 4):
        c, s = -s, c
    return c, s


def add_angles(a: CosSin, b: CosSin) -> CosSin:
    """Return (cos, sin) of the sum of two angles."""
    return a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]


def pi_multiple(angle: Poly) -> Fraction | None:
    """Return q if the angle is exactly q pi, else None."""
    if not angle:
        return Fraction(0)
    if len(angle.terms) != 1:
        return None
    ((monomial, coefficient),) = angle.terms.items()
    single = len(monomial) == 1 and monomial[0][0].kind == "pi" and monomial[0][1] == 1
    return coefficient.parts[0] if single and coefficient.is_rational else None


def cos_sin(angle: Poly) -> CosSin:
    """Return (cos, sin) of an angle [rad], a polynomial in pi, numbers, parameters and functions of them."""
    number, turns = Fraction(0), Fraction(0)
    rest = Poly({})
    result: CosSin = (Poly.of(1), Poly.of(0))
    for monomial, coefficient in angle.ordered:
        gen = monomial[0][0] if len(monomial) == 1 and monomial[0][1] == 1 else None
        times = coefficient.parts[0] if coefficient.is_rational else None
        if all(g.kind == "pi" for g, _ in monomial):
            if gen is not None and times is not None:
                turns += times
            else:
                power = monomial[0][1] if monomial else 0
                number += coefficient.rational() * pi_rational() ** power
        elif gen and gen.kind in ("param", "atan2") and times in _TIMES:
            result = add_angles(result, multiple(_base(gen), int(coefficient.parts[0])))
        else:
            rest = rest + Poly({monomial: coefficient})
    if rest:
        result = add_angles(result, (Poly.gen("cosf", "", rest), Poly.gen("sinf", "", rest)))
    twelve = turns * 12
    if twelve.denominator == 1:
        result = add_angles(_constant(twelfths(int(twelve))), result)
        turns = Fraction(0)
    if number or turns:
        result = add_angles(_constant(circle_point(number + turns * pi_rational())), result)
    return result


def _constant(point: tuple[Exact, Exact]) -> CosSin:
    return Poly.of(point[0]), Poly.of(point[1])


def _base(gen: Gen) -> CosSin:
    """Return (cos, sin) of a parameter or of a direction, atan2(y, x)."""
    if gen.kind == "param":
        return Poly.gen("cosf", "", gen.alone), Poly.gen("sinf", "", gen.alone)
    y, x = gen.args
    hypotenuse = sqrt_poly(x * x + y * y).inverse()
    return x * hypotenuse, y * hypotenuse


def multiple(base: CosSin, k: int) -> CosSin:
    """Return (cos, sin) of k times the angle whose (cos, sin) is ``base``."""
    step: CosSin = base if k > 0 else (base[0], -base[1])
    return reduce(add_angles, [step] * abs(k), (Poly.of(1), Poly.of(0)))


def sqrt_poly(value: Poly) -> Poly:
    """Return the square root of a polynomial: a number of the field if possible, else the generator sqrt(value)."""
    number = value.constant
    root = None if number is None else exact_sqrt(number)
    return Poly.gen("sqrt", "", value) if root is None else Poly.of(root)


def function(kind: str, name: str, args: tuple[Poly, ...]) -> Poly:
    """Return a function of polynomials in its simplest exact form.

    Args:
        kind: The kind of the generator, see `Gen`.
        name: The name of the generator; "" for the usual functions.
        args: The arguments of the function.

    Returns:
        A polynomial: a number if the function has an exact value, else one with the generator.
    """
    match kind:
        case "inv":
            return args[0].inverse()
        case "sqrt":
            return sqrt_poly(args[0])
        case "cosf":
            return cos_sin(args[0])[0]
        case "sinf":
            return cos_sin(args[0])[1]
    return Poly.gen(kind, name, *args)


def parameters_in(poly: Poly) -> frozenset[str]:
    """Return the names of the parameters that occur, inside functions too."""
    names: set[str] = set()
    for gen in poly.generators:
        names |= {gen.name} if gen.kind == "param" else set()
        for arg in gen.args:
            names |= parameters_in(arg)
    return frozenset(names)


def substituted(poly: Poly, values: Mapping[str, Poly]) -> Poly:
    """Return ``poly`` with the parameters in ``values`` replaced, inside functions too; pi remains a symbol."""

    def value(gen: Gen) -> Poly | None:
        if gen.kind == "param":
            return values.get(gen.name)
        if not gen.args or values.keys().isdisjoint(parameters_in(gen.alone)):
            return None
        return function(gen.kind, gen.name, tuple(substituted(a, values) for a in gen.args))

    return poly.substitute(value)


def fix(poly: Poly, values: Mapping[str, Poly]) -> Poly:
    """Return ``poly`` with the parameters in ``values`` replaced and every function of numbers evaluated.

    Parameters that are not in ``values`` (the tunable ones) and joint angles remain symbols.
    """

    def value(gen: Gen) -> Poly | None:
        if gen.kind == "param":
            own = values.get(gen.name)
            return None if own is None else fix(own, values)
        if gen.kind == "pi":
            return Poly.of(pi_rational())
        if not gen.args:
            return None
        if gen.kind in ("cosf", "sinf"):
            return function(gen.kind, "", (angle_value(gen.args[0], values),))
        args = tuple(fix(a, values) for a in gen.args)
        result = function(gen.kind, gen.name, args)
        constants = [a.constant for a in args]
        numbers = [n for n in constants if n is not None]
        if result.constant is not None or len(numbers) < len(args):
            return result
        return Poly.of(_function_value(gen, tuple(n.rational() for n in numbers)))

    result = poly.substitute(value)
    return Poly({}) if _cancels(poly, result, value) else result


def _function_value(gen: Gen, args: tuple[Fraction, ...]) -> Exact:
    with mpmath.workdps(PRECISION):
        values = [to_mpf(a) for a in args]
        match gen.kind:
            case "sqrt" if values[0] < 0:
                raise ValueError("square root of a negative number")
            case "sqrt":
                return rounded(mpmath.sqrt(values[0]))
            case "atan2":
                return rounded(mpmath.atan2(*values))
            case "tan":
                return rounded(mpmath.tan(values[0]))
    raise ValueError(f"no value for {gen.kind}")


def rounded(value: mpmath.mpf) -> Exact:
    """Return a real number rounded to a fraction of 40 digits."""
    with mpmath.workdps(PRECISION):
        if not value:
            return ZERO
        scale = _DIGITS - int(mpmath.floor(mpmath.log10(abs(value)))) - 1
        return Exact(Fraction(int(mpmath.nint(value * mpmath.mpf(10) ** scale))) * Fraction(10) ** -scale)


def _cancels(poly: Poly, result: Poly, value: Callable[[Gen], Poly | None]) -> bool:
    """Return whether a value is zero up to the rounding of its roots, as in sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2).

    ``result`` is the value of ``poly`` with the generators replaced by ``value``.
    """
    total = result.constant
    if not total or len(poly.terms) < 2 or not any(g.args for g in poly.generators):
        return False
    terms = (Poly({m: c}).substitute(value).constant for m, c in poly.terms.items())
    return abs(float(total)) <= _ROUNDED * max(abs(float(t)) for t in terms if t is not None)


def angle_value(angle: Poly, values: Mapping[str, Poly]) -> Poly:
    """Return an angle with the parameters in ``values`` replaced; pi remains a symbol, so its sine can be exact."""

    def parameter(gen: Gen) -> Poly | None:
        own = values.get(gen.name) if gen.kind == "param" else None
        return None if own is None else angle_value(own, values)

    # Functions come last, because a quotient by a parameter that contains pi is a function.
    return angle.substitute(parameter).substitute(lambda gen: fix(gen.alone, values) if gen.args else None)


def number(poly: Poly, values: Mapping[str, Poly]) -> Exact:
    """Return the value of ``poly`` for these parameter values. Raise ValueError if a symbol remains."""
    value = fix(poly, values).constant
    if value is None:
        raise ValueError(f"not a number: {poly.key}")
    return value
