"""Functions of polynomials, and the numbers that polynomials are worth when parameters have their values.

A sine or a root is exact where it can be. The sine of a multiple of pi/12 lies in Q(sqrt2, sqrt3). Any other angle
that is a number becomes a rational point of the unit circle through the half-angle parametrisation, so that
c**2 + s**2 = 1 holds exactly; any other root, direction or tangent has 40 digits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache, reduce

import mpmath

from wmrgen.geometry.exact.number import ONE, SQRT2, SQRT3, ZERO, Exact, exact_sqrt
from wmrgen.geometry.exact.poly import Gen, Poly

PRECISION = 60
_SQRT6 = SQRT2 * SQRT3
_SIN = (  # of k pi/12, k = 0..6
    ZERO, (_SQRT6 - SQRT2) / 4, ONE / 2, SQRT2 / 2, SQRT3 / 2, (_SQRT6 + SQRT2) / 4, ONE,
)  # fmt: skip
_DIGITS = 40
_HALF_ANGLE_DIGITS = 20  # two of them multiply to the 40 digits of the point
_TIMES = range(-4, 5)  # multiples of an angle for which the addition theorem is worth its terms
_ROUNDED = 1e-18  # a difference of rounded numbers that is smaller, relative to them, is zero; a root halves the digits

_TANGENTS = {Fraction(k, 12): _SIN[k] / _SIN[6 - k] for k in range(6)}
_TANGENTS |= {Fraction(1, 8): SQRT2 - 1, Fraction(3, 8): SQRT2 + 1}  # of q pi, as far as the field has them
_DIRECTIONS = {t * sign: q * sign for q, t in _TANGENTS.items() for sign in (1, -1)}
_PI_SIZE = (
    10**30
)  # denominators of multiples of pi are larger, those of what they are multiplied with smaller

CosSin = tuple[Poly, Poly]


def twelfths(k: int) -> tuple[Exact, Exact]:
    """(cos, sin) of k pi/12, exactly."""

    def sine(j: int) -> Exact:
        j %= 24
        if j > 12:
            return -sine(j - 12)
        return _SIN[j] if j <= 6 else _SIN[12 - j]

    return sine(k + 6), sine(k)


def direction_over_pi(y: Exact, x: Exact) -> Fraction | None:
    """q where the vector (x, y) points along q pi, -1 < q <= 1, for multiples of 1/12 and odd ones of 1/8.

    None of another direction, and of no vector.
    """
    if not x:
        return Fraction(y.sign, 2) if y else None
    q = _DIRECTIONS.get(y / x)
    if q is None or x.sign > 0:
        return q
    return q - 1 if y.sign < 0 else q + 1


@cache
def pi_rational() -> Fraction:
    """pi to 60 digits."""
    with mpmath.workdps(PRECISION + 5):
        return to_fraction(mpmath.pi)


def over_pi(value: Exact) -> Fraction | None:
    """q where ``value`` is q times `pi_rational`: numbers that were written with pi or in degrees, and their sums."""
    if value.den < _PI_SIZE and value:
        return None  # nearly every number that occurs
    q = value.parts[0] / pi_rational() if value.is_rational else None
    return q if q is not None and q.denominator < _PI_SIZE else None


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
        c, s = circle(Fraction(int(mpmath.nint(t * q)), q))
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
    """(cos, sin) of a parameter or of a direction."""
    if gen.kind == "param":
        return Poly.gen("cosf", "", gen.alone), Poly.gen("sinf", "", gen.alone)
    y, x = gen.args
    hypotenuse = sqrt_poly(x * x + y * y).inverse()
    return x * hypotenuse, y * hypotenuse


def multiple(base: CosSin, k: int) -> CosSin:
    """(cos, sin) of k times an angle."""
    step: CosSin = base if k > 0 else (base[0], -base[1])
    return reduce(add_angles, [step] * abs(k), (Poly.of(1), Poly.of(0)))


def sqrt_poly(value: Poly) -> Poly:
    """sqrt of a polynomial: in the field where possible, else the generator sqrt(value)."""
    number = value.constant
    root = None if number is None else exact_sqrt(number)
    return Poly.gen("sqrt", "", value) if root is None else Poly.of(root)


def function(kind: str, name: str, args: tuple[Poly, ...]) -> Poly:
    """A function of polynomials, in the simplest form that is exact."""
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
    """Names of the parameters that occur, inside functions too."""
    names: set[str] = set()
    for gen in poly.generators:
        names |= {gen.name} if gen.kind == "param" else set()
        for arg in gen.args:
            names |= parameters_in(arg)
    return frozenset(names)


def substituted(poly: Poly, values: Mapping[str, Poly]) -> Poly:
    """``poly`` with the parameters in ``values`` replaced, inside functions too; pi and numbers stay exact."""

    def value(gen: Gen) -> Poly | None:
        if gen.kind == "param":
            return values.get(gen.name)
        if not gen.args or values.keys().isdisjoint(parameters_in(gen.alone)):
            return None
        return function(gen.kind, gen.name, tuple(substituted(a, values) for a in gen.args))

    return poly.substitute(value)


def fix(poly: Poly, values: Mapping[str, Poly]) -> Poly:
    """``poly`` with the parameters in ``values`` replaced and every function of numbers evaluated.

    Parameters that are not in ``values`` (the tunable ones) and joint angles stay.
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
        numbers = [n for a in args if (n := a.constant) is not None]
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
                return _rounded(mpmath.sqrt(values[0]))
            case "atan2":
                return _rounded(mpmath.atan2(*values))
            case "tan":
                return _rounded(mpmath.tan(values[0]))
    raise ValueError(f"no value for {gen.kind}")


def _rounded(value: mpmath.mpf) -> Exact:
    """A real number as a 40-digit fraction."""
    with mpmath.workdps(PRECISION):
        if not value:
            return ZERO
        scale = _DIGITS - int(mpmath.floor(mpmath.log10(abs(value)))) - 1
        return Exact(Fraction(int(mpmath.nint(value * mpmath.mpf(10) ** scale))) * Fraction(10) ** -scale)


def _cancels(poly: Poly, result: Poly, value: Callable[[Gen], Poly | None]) -> bool:
    """Whether a number is what rounded roots leave of zero: sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2)."""
    total = result.constant
    if not total or len(poly.terms) < 2 or not any(g.args for g in poly.generators):
        return False
    terms = (Poly({m: c}).substitute(value).constant for m, c in poly.terms.items())
    return abs(float(total)) <= _ROUNDED * max(abs(float(t)) for t in terms if t is not None)


def angle_value(angle: Poly, values: Mapping[str, Poly]) -> Poly:
    """An angle with the parameters in ``values`` replaced and pi kept, so that its sine can be exact."""

    def parameter(gen: Gen) -> Poly | None:
        own = values.get(gen.name) if gen.kind == "param" else None
        return None if own is None else angle_value(own, values)

    # Functions come last: the quotient by a parameter that holds pi is one of them.
    return angle.substitute(parameter).substitute(lambda gen: fix(gen.alone, values) if gen.args else None)


def number(poly: Poly, values: Mapping[str, Poly]) -> Exact:
    """The number that ``poly`` is worth. ValueError when something stays unknown."""
    value = fix(poly, values).constant
    if value is None:
        raise ValueError(f"not a number: {poly.key}")
    return value
