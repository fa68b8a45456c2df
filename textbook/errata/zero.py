"""Is an expression 0? Decided exactly: a rational point where it is not, or a proof that it is.

After the addition theorems an expression is a rational function of symbols and of sines and cosines of symbols;
it vanishes identically exactly if its numerator is a multiple of the relations sin^2 + cos^2 = 1.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import sympy

from wmrgen.geometry.symbolic import Expr

_DIGITS, _SMALL = 40, sympy.Rational(1, 10**25)


@dataclass(frozen=True, slots=True)
class Point:
    """Where an expression is not 0: values by symbol, and what it is worth there."""

    values: tuple[tuple[Expr, Expr], ...]
    value: Expr


def symbols_of(exprs: Iterable[Expr]) -> list[Expr]:
    """The symbols of some expressions, in the order of their names."""
    return sorted({s for e in exprs for s in e.free_symbols}, key=lambda s: str(s.name))


def sample(symbols: Iterable[Expr], k: int = 0) -> dict[Expr, Expr]:
    """A rational point: 0.3, 0.7, 1.1 and so on, or the same with another step."""
    return {s: sympy.Rational(3 + 4 * i + 2 * k * (i + 1), 10) for i, s in enumerate(symbols)}


def counterexample(expr: Expr, tries: int = 2) -> Point | None:
    """A rational point at which the expression is not 0; None where it is 0 at the points tried."""
    symbols = symbols_of([expr])
    for k in range(tries):
        point = sample(symbols, k)
        value = sympy.N(expr.xreplace(point), _DIGITS)
        if abs(value) > _SMALL:
            return Point(tuple(point.items()), value)
    return None


def is_zero(expr: Expr) -> bool:
    """True exactly if the expression vanishes identically. ValueError where neither can be shown."""
    if expr.is_zero:
        return True
    if counterexample(expr, 1) is not None:
        return False
    if _proved(expr):
        return True
    if counterexample(expr) is not None:
        return False
    if sympy.simplify(expr) == 0:
        return True
    raise ValueError(f"0 at the points tried, but not proved to be 0: {expr}")


def _proved(expr: Expr) -> bool:
    """The numerator modulo sin^2 + cos^2 = 1 is 0."""
    flat = sympy.expand_trig(expr)
    angles = sorted({f.args[0] for f in flat.atoms(sympy.sin, sympy.cos, sympy.tan)}, key=lambda a: str(a))
    pairs = {a: (sympy.Dummy(f"c{i}"), sympy.Dummy(f"s{i}")) for i, a in enumerate(angles)}
    swap: dict[Expr, Expr] = {}
    for a, (c, s) in pairs.items():
        swap |= {sympy.cos(a): c, sympy.sin(a): s, sympy.tan(a): s / c}
    numerator = sympy.expand(sympy.numer(sympy.together(flat.xreplace(swap))))
    for c, s in pairs.values():
        numerator = sympy.rem(numerator, s**2 + c**2 - 1, s) if numerator.has(s) else numerator
    return bool(sympy.expand(numerator) == 0)
