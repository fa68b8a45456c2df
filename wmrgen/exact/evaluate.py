"""Numbers for generators: what a polynomial is worth when parameters have their nominal values."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import mpmath

from wmrgen.exact.angles import PRECISION, cos_sin, pi_rational, sqrt_poly, to_mpf
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Gen, Poly

_DIGITS = 40


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
        if gen.kind in ("cos", "sin"):
            return None
        if gen.kind in ("cosf", "sinf"):
            angle = _keep_pi(gen.args[0], values)
            pair = cos_sin(angle)
            return pair[0] if gen.kind == "cosf" else pair[1]
        args = tuple(fix(a, values) for a in gen.args)
        numbers = tuple(a.constant for a in args)
        if gen.kind == "inv":
            return args[0].inverse()
        if gen.kind == "sqrt" and numbers[0] is None:
            return sqrt_poly(args[0])
        found = [n for n in numbers if n is not None]
        if len(found) < len(args):
            return Poly.gen(gen.kind, gen.name, *args)
        if gen.kind == "sqrt":
            root = sqrt_poly(args[0]).constant
            if root is not None:
                return Poly.of(root)
        return Poly.of(_function_value(gen, tuple(n.rational() for n in found)))

    return poly.substitute(value)


def _keep_pi(angle: Poly, values: Mapping[str, Poly]) -> Poly:
    """An angle with parameters replaced and pi kept, so that its sine can be exact."""

    def value(gen: Gen) -> Poly | None:
        if gen.kind == "param":
            return values.get(gen.name)
        if gen.kind == "pi":
            return None
        return fix(Poly({((gen, 1),): Exact(1)}), values)

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
