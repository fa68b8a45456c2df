"""Numbers for generators: what a polynomial is worth when parameters have their nominal values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

import mpmath

from wmrgen.exact.angles import PRECISION, cos_sin, pi_rational, sqrt_poly, to_mpf
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Gen, Poly

_DIGITS = 40
_ROUNDED = 1e-18  # a difference of rounded numbers that is smaller, relative to them, is zero; a root halves the digits


def _rounded(value: mpmath.mpf) -> Exact:
    """A real number as a 40-digit fraction."""
    with mpmath.workdps(PRECISION):
        if not value:
            return Exact(0)
        scale = _DIGITS - int(mpmath.floor(mpmath.log10(abs(value)))) - 1
        return Exact(Fraction(int(mpmath.nint(value * mpmath.mpf(10) ** scale))) * Fraction(10) ** -scale)


def _function_value(gen: Gen, args: tuple[Fraction, ...]) -> Exact:
    with mpmath.workdps(PRECISION):
        values = [to_mpf(a) for a in args]
        match gen.kind:
            case "sqrt":
                return _rounded(mpmath.sqrt(values[0]))
            case "atan2":
                return _rounded(mpmath.atan2(*values))
            case "tan":
                return _rounded(mpmath.tan(values[0]))
    raise ValueError(f"no value for {gen.kind}")


def parameters_in(poly: Poly) -> frozenset[str]:
    """Names of the parameters that occur, inside functions too."""
    found: set[str] = set()
    for gen in poly.generators:
        found |= {gen.name} if gen.kind == "param" else set()
        for arg in gen.args:
            found |= parameters_in(arg)
    return frozenset(found)


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


def substituted(poly: Poly, values: Mapping[str, Poly]) -> Poly:
    """``poly`` with the parameters in ``values`` replaced, inside functions too; pi and numbers stay exact."""

    def value(gen: Gen) -> Poly | None:
        if gen.kind == "param":
            return values.get(gen.name)
        if not gen.args or values.keys().isdisjoint(parameters_in(Poly({((gen, 1),): Exact(1)}))):
            return None
        return function(gen.kind, gen.name, tuple(substituted(a, values) for a in gen.args))

    return poly.substitute(value)


def fix(poly: Poly, values: Mapping[str, Poly]) -> Poly:
    """``poly`` with the parameters in ``values`` replaced and every function of numbers evaluated.

    Parameters that are not in ``values`` (the tunable ones) and joint angles stay.
    """

    def value(gen: Gen) -> Poly | None:
        if gen.kind == "param":
            known = values.get(gen.name)
            return None if known is None else fix(known, values)
        if gen.kind == "pi":
            return Poly.of(pi_rational())
        if not gen.args:
            return None
        if gen.kind in ("cosf", "sinf"):
            return function(gen.kind, "", (_keep_pi(gen.args[0], values),))
        args = tuple(fix(a, values) for a in gen.args)
        result = function(gen.kind, gen.name, args)
        numbers = [n for a in args if (n := a.constant) is not None]
        if result.constant is not None or len(numbers) < len(args):
            return result
        return Poly.of(_function_value(gen, tuple(n.rational() for n in numbers)))

    result = poly.substitute(value)
    return Poly({}) if _cancels(poly, result, value) else result


def _cancels(poly: Poly, result: Poly, value: Callable[[Gen], Poly | None]) -> bool:
    """Whether a number is what rounded roots leave of zero: sqrt(3 + 2*sqrt(2)) - 1 - sqrt(2)."""
    total = result.constant
    if not total or len(poly.terms) < 2 or not any(g.args for g in poly.generators):
        return False
    terms = (Poly({m: c}).substitute(value).constant for m, c in poly.terms.items())
    return abs(float(total)) <= _ROUNDED * max(abs(float(t)) for t in terms if t is not None)


def _keep_pi(angle: Poly, values: Mapping[str, Poly]) -> Poly:
    """An angle with parameters replaced and pi kept, so that its sine can be exact."""

    def value(gen: Gen) -> Poly | None:
        if gen.kind == "param":
            known = values.get(gen.name)
            return None if known is None else _keep_pi(known, values)
        return fix(Poly({((gen, 1),): Exact(1)}), values) if gen.args else None

    return angle.substitute(value)


def angle_value(angle: Poly, values: Mapping[str, Poly]) -> Poly:
    """An angle with every parameter of ``values`` replaced, pi kept as a generator."""
    return _keep_pi(angle, values)


def number(poly: Poly, values: Mapping[str, Poly]) -> Exact:
    """The number that ``poly`` is worth. ValueError when something stays unknown."""
    value = fix(poly, values).constant
    if value is None:
        raise ValueError(f"not a number: {poly.key}")
    return value
