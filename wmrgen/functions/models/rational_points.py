"""Formulas and their derivatives at rational points of circles: identities checked without rounding.

An angle is given by a rational point (cos, sin) of the unit circle. Formulas see angles only through sines and
cosines of sums of them, so that every value is a number of the field, and its derivative along a vector field too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction

import sympy

from wmrgen.exact.number import ONE, ZERO, Exact, exact_sqrt
from wmrgen.kinematics.records import Formula
from wmrgen.symbolic import Expr


@dataclass(frozen=True, slots=True)
class Dual:
    """A value and its rate."""

    value: Exact
    rate: Exact = ZERO

    def __add__(self, other: Dual) -> Dual:
        return Dual(self.value + other.value, self.rate + other.rate)

    def __mul__(self, other: Dual) -> Dual:
        return Dual(self.value * other.value, self.value * other.rate + self.rate * other.value)

    def __pow__(self, n: int) -> Dual:
        if n < 0:
            inverse = self.value.inverse()
            return Dual(inverse, -(self.rate * inverse * inverse)) ** -n
        result = Dual(ONE)
        for _ in range(n):
            result = result * self
        return result

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.rate)


Circle = tuple[Exact, Exact]


@dataclass(frozen=True, slots=True)
class Place:
    """Where to evaluate, and how fast it moves. ``angles``: symbol -> circle point; ``numbers``: other symbols."""

    angles: Mapping[Expr, Circle]
    numbers: Mapping[Expr, Exact]
    rates: Mapping[Expr, Exact]


class Evaluator:
    """Values and rates of expressions at a place, each distinct expression once.

    ValueError for an expression that the field does not hold.
    """

    def __init__(self, place: Place, formula: Formula | None = None) -> None:
        self.place = place
        self.memo: dict[Expr, Dual] = {}
        for symbol, expr in formula.locals if formula is not None else ():
            self.memo[symbol] = self(expr)

    def __call__(self, expr: Expr) -> Dual:
        """The value and the rate of an expression."""
        found = self.memo.get(expr)
        if found is None:
            found = self.memo[expr] = self._of(expr)
        return found

    def _of(self, expr: Expr) -> Dual:
        if isinstance(expr, sympy.Rational):
            return Dual(Exact(Fraction(int(expr.p), int(expr.q))))
        if expr in self.place.numbers:
            return Dual(self.place.numbers[expr], self.place.rates.get(expr, ZERO))
        rule = self._rules().get(type(expr))
        if rule is None:
            raise ValueError(f"no exact value for {expr}")
        return rule(expr)

    def _rules(self) -> dict[type, Callable[[Expr], Dual]]:
        return {
            sympy.Add: self._add, sympy.Mul: self._mul, sympy.Pow: self._pow, sympy.Abs: self._abs,
            sympy.cos: lambda e: self._turn(e.args[0])[0], sympy.sin: lambda e: self._turn(e.args[0])[1],
            sympy.tan: self._tan, sympy.Piecewise: self._select,
        }  # fmt: skip

    def _add(self, expr: Expr) -> Dual:
        total = Dual(ZERO)
        for a in expr.args:
            total = total + self(a)
        return total

    def _mul(self, expr: Expr) -> Dual:
        total = Dual(ONE)
        for a in expr.args:
            total = total * self(a)
        return total

    def _pow(self, expr: Expr) -> Dual:
        if expr.exp.is_Integer:
            return self(expr.base) ** int(expr.exp)
        base = self(expr.base)
        root = exact_sqrt(base.value) if expr.exp.is_Rational and expr.exp.q == 2 else None
        if root is None or base.rate:
            raise ValueError(f"no exact value for {expr}")
        return Dual(root) ** int(expr.exp.p)

    def _abs(self, expr: Expr) -> Dual:
        inside = self(expr.args[0])
        return -inside if inside.value.sign < 0 else inside

    def _select(self, expr: Expr) -> Dual:
        (then, condition), (otherwise, _) = expr.args
        return self(then) if self(condition.lts).value < self(condition.gts).value else self(otherwise)

    def _tan(self, expr: Expr) -> Dual:
        c, s = self._turn(expr.args[0])
        return s * c**-1

    def _turn(self, angle: Expr) -> tuple[Dual, Dual]:
        """Cosine and sine of a whole-numbered sum of angles."""
        c, s, rate = ONE, ZERO, ZERO
        for symbol, count in _counts(angle).items():
            point = self.place.angles.get(symbol)
            if point is None:
                raise ValueError(f"no exact sine of {angle}")
            rate = rate + self.place.rates.get(symbol, ZERO) * count
            step = point if count > 0 else (point[0], -point[1])
            for _ in range(abs(count)):
                c, s = c * step[0] - s * step[1], s * step[0] + c * step[1]
        return Dual(c, -(s * rate)), Dual(s, c * rate)


def _counts(angle: Expr) -> dict[Expr, int]:
    """Symbol -> how often it is added in a sum of angles."""
    found: dict[Expr, int] = {}
    stack = [(angle, 1)]
    while stack:
        term, factor = stack.pop()
        if isinstance(term, sympy.Add):
            stack += [(a, factor) for a in term.args]
        elif isinstance(term, sympy.Mul) and len(term.args) == 2 and term.args[0].is_Integer:
            stack.append((term.args[1], factor * int(term.args[0])))
        elif isinstance(term, sympy.Symbol):
            found[term] = found.get(term, 0) + factor
        else:
            raise ValueError(f"no exact sine of {angle}")
    return {symbol: count for symbol, count in found.items() if count}
