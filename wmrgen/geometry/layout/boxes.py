"""Decide whether an expression keeps its sign on a box of parameters, by branch and bound.

Interval arithmetic proves that the sign is kept. If the value is monotonic in a parameter, only one end of that
parameter's range is examined. Boxes that remain undecided are halved. A point with the wrong sign is evaluated exactly
before it is reported.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, nextafter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.interval import Interval
from wmrgen.geometry.exact.number import Exact
from wmrgen.robotfile.records import Binary, Call, Expr, Neg, Num, Param, Pi

_MOST = 4096  # boxes of one expression, which take a fraction of a second
_EXACT = 200  # exact evaluations of one expression in a round, which are slow
_PI = (nextafter(np.pi, 0.0), nextafter(np.pi, 4.0))
Box = Mapping[str, tuple[Exact, Exact]]
Point = Mapping[str, Exact]
Floats = NDArray[np.float64]


class Verdict(NamedTuple):
    """The result of a search: proved, refuted by a point, or undecided if neither is set."""

    proved: bool  # the condition holds on the whole box
    point: Point | None = None  # a point where it does not hold


HOLDS, OPEN = Verdict(True), Verdict(False)


@dataclass(frozen=True, slots=True)
class _Dual:
    """The intervals of a value and of its derivatives on each box."""

    value: Interval
    slopes: tuple[Interval, ...]  # one for each parameter in `_Boxes.by`


class _Boxes(NamedTuple):
    """Boxes of tunable parameters, on which expressions are evaluated."""

    names: Sequence[str]  # the tunable parameters
    ends: Sequence[Interval]  # for each of them its interval, with one entry for each box
    trees: Mapping[str, Expr]  # expressions of the other parameters
    by: Sequence[str] = ()  # parameters for which derivatives are wanted: all of `names` or none

    def of(self, expr: Expr) -> _Dual:
        """Evaluate an expression on every box. Roots of negative numbers are 0, because a separate check finds them."""
        zero = self._constant(0.0, 0.0)
        match expr:
            case Num(value):
                return _Dual(self._constant(*_around(value)), (zero,) * len(self.by))
            case Pi():
                return _Dual(self._constant(*_PI), (zero,) * len(self.by))
            case Param(name) if name in self.names:
                one = self._constant(1.0, 1.0)
                k = self.names.index(name)
                return _Dual(self.ends[k], tuple(one if j == k else zero for j in range(len(self.by))))
            case Param(name):
                return self.of(self.trees[name])
            case Neg(arg):
                return self._map(self.of(arg), iv.negative, lambda _: self._constant(-1.0, -1.0))
            case Binary("**", base, Num(power)):
                return self._power(self.of(base), int(power))
            case Binary("*", left, right) if left == right:
                return self._power(self.of(left), 2)
            case Binary(op, left, right):
                return self._binary(op, self.of(left), self.of(right))
            case Call("atan2", (y, x)):
                return self._direction(self.of(y), self.of(x))
            case Call(name, (arg,)):
                return self._call(name, self.of(arg))
        raise TypeError(f"not an expression: {expr!r}")

    def _constant(self, low: float, high: float) -> Interval:
        count = len(self.ends[0][0])
        return np.full(count, low), np.full(count, high)

    def _map(
        self, a: _Dual, function: Callable[[Interval], Interval], slope: Callable[[Interval], Interval]
    ) -> _Dual:
        by = slope(a.value)
        return _Dual(function(a.value), tuple(iv.times(by, s) for s in a.slopes))

    def _power(self, a: _Dual, power: int) -> _Dual:
        if not power:
            return _Dual(self._constant(1.0, 1.0), (self._constant(0.0, 0.0),) * len(self.by))

        def raised(value: Interval, n: int) -> Interval:
            if n < 0:
                return iv.reciprocal(raised(value, -n))
            square = iv.square(value)
            return (self._constant(1.0, 1.0), value, square, iv.times(square, value), iv.square(square))[n]

        def slope(value: Interval) -> Interval:
            below = power - 1
            # `raised` knows exponents from -4 to 4.
            lower = iv.times(raised(value, -4), raised(value, -1)) if below == -5 else raised(value, below)
            return iv.times(self._constant(float(power), float(power)), lower)

        return self._map(a, lambda value: raised(value, power), slope)

    def _binary(self, op: str, a: _Dual, b: _Dual) -> _Dual:
        if op in "+-":
            combine = iv.plus if op == "+" else iv.minus
            slopes = [combine(s, t) for s, t in zip(a.slopes, b.slopes, strict=True)]
            return _Dual(combine(a.value, b.value), tuple(slopes))
        if op == "/":
            b = self._power(b, -1)
        slopes = []
        for s, t in zip(a.slopes, b.slopes, strict=True):
            slopes.append(iv.plus(iv.times(s, b.value), iv.times(t, a.value)))
        return _Dual(iv.times(a.value, b.value), tuple(slopes))

    def _call(self, name: str, a: _Dual) -> _Dual:
        match name:
            case "sqrt":
                half = self._constant(0.5, 0.5)
                positive = lambda value: iv.times(half, iv.reciprocal(iv.root(value)))  # noqa: E731
                return self._map(a, iv.root, positive)
            case "sin":
                return self._map(a, iv.sine, iv.cosine)
            case "cos":
                return self._map(a, iv.cosine, lambda value: iv.negative(iv.sine(value)))
            case "tan":
                return self._binary("/", self._call("sin", a), self._call("cos", a))
        raise ValueError(name)

    def _direction(self, y: _Dual, x: _Dual) -> _Dual:
        per = iv.reciprocal(iv.plus(iv.square(x.value), iv.square(y.value)))
        across, along = iv.times(x.value, per), iv.times(y.value, per)
        slopes = []
        for s, t in zip(y.slopes, x.slopes, strict=True):
            slopes.append(iv.minus(iv.times(across, s), iv.times(along, t)))
        return _Dual(iv.arctangent(y.value, x.value), tuple(slopes))


def _around(value: Fraction | Exact) -> tuple[float, float]:
    """Return floats below and above a number, or the equal float twice if there is one."""
    near = float(value)
    if Exact.of(Fraction(near)) == value:
        return near, near
    return nextafter(near, -inf), nextafter(near, inf)


@dataclass(frozen=True, slots=True)
class Search:
    """The question whether ``sign`` times an expression is positive, or not negative, on a box."""

    expr: Expr
    sign: int  # 1 or -1
    strict: bool  # positive; else not negative
    wrong: Callable[[Point], bool]  # whether the exact value at a point violates the condition
    names: Sequence[str]  # parameters that span the box
    box: Box  # their ranges
    trees: Mapping[str, Expr]  # expressions of the other parameters

    def run(self, rounds: int) -> Verdict:
        """Search with at most ``rounds`` halvings."""
        low, high = _corners(self.names, self.box)
        width = high - low
        for _ in range(rounds):
            rest = ~self._fine(self._at(low, high).value[0])
            low, high = low[:, rest], high[:, rest]
            if not low.shape[1]:
                return HOLDS
            self._to_worst_ends(low, high, self._at(low, high, self.names).slopes)
            # A box in which the value is monotonic in every parameter is now a corner, which is decided exactly.
            rest = ~self._fine(self._at(low, high).value[0])
            low, high = low[:, rest], high[:, rest]
            alone = (low == high).all(axis=0)
            corners, low, high = low[:, alone], low[:, ~alone], high[:, ~alone]
            middle = (low + high) / 2
            likely = middle[:, self._at(middle, middle).value[1] < 0]
            tried = np.hstack([corners, likely[:, :4]])
            if tried.shape[1] > _EXACT:
                return OPEN
            if (point := self._wrong_among(tried)) is not None:
                return Verdict(False, point)
            if not low.shape[1]:
                return HOLDS
            low, high = _halved(low, high, width)
            if low.shape[1] > _MOST:
                break
        return OPEN

    def _at(self, low: Floats, high: Floats, by: Sequence[str] = ()) -> _Dual:
        dual = _Boxes(self.names, [*zip(low, high, strict=True)], self.trees, by).of(self.expr)
        return dual if self.sign > 0 else _Dual(iv.negative(dual.value), tuple(map(iv.negative, dual.slopes)))

    def _fine(self, least: Floats) -> NDArray[np.bool_]:
        return np.asarray(least > 0 if self.strict else least >= 0)

    def _to_worst_ends(self, low: Floats, high: Floats, slopes: Sequence[Interval]) -> None:
        """Replace the range of each monotonic parameter by the end with the least value, in place."""
        for k, (down, up) in enumerate(slopes):
            rises, falls = down >= 0, (up <= 0) & ~(down >= 0)
            high[k] = np.where(rises, low[k], high[k])
            low[k] = np.where(falls, high[k], low[k])

    def _wrong_among(self, points: Floats) -> Point | None:
        """Return the first of the points at which the exact value is wrong, or None."""
        for column in points.T.tolist():
            point = {name: _exactly(x, self.box[name]) for name, x in zip(self.names, column, strict=True)}
            if self.wrong(point):
                return point
        return None


def _corners(names: Sequence[str], box: Box) -> tuple[Floats, Floats]:
    """Return the lower and upper ends of the box in floats, rounded outward, each of shape (parameters, 1)."""
    low = np.array([[_around(box[name][0])[0]] for name in names])
    high = np.array([[_around(box[name][1])[1]] for name in names])
    return low, high


def _exactly(x: float, ends: tuple[Exact, Exact]) -> Exact:
    """Return a coordinate exactly, clamped to its range."""
    value = Exact(Fraction(x))
    return min(max(value, ends[0]), ends[1])


def _halved(low: Floats, high: Floats, width: Floats) -> tuple[Floats, Floats]:
    """Halve each box along its longest side relative to ``width``, the ranges of the parameters."""
    widest = np.argmax((high - low) / width, axis=0)
    each = np.arange(low.shape[1])
    middle = (low + high)[widest, each] / 2
    below, above = high.copy(), low.copy()
    below[widest, each] = middle
    above[widest, each] = middle
    return np.hstack([low, above]), np.hstack([below, high])


def apart(one: Expr, other: Expr, box: Box, trees: Mapping[str, Expr], rounds: int) -> Verdict:
    """Return whether two values are proved never to be 0 at the same point of a box.

    Args:
        one: The first expression.
        other: The second expression.
        box: The ranges of the parameters in both.
        trees: Expressions of parameters that are not tunable.
        rounds: The most halvings of the box.

    Returns:
        `HOLDS` if it is proved, else `OPEN`.
    """
    names = [*box]
    low, high = _corners(names, box)
    width = high - low
    for _ in range(rounds):
        boxes = _Boxes(names, [*zip(low, high, strict=True)], trees)
        rest = (iv.smallest(boxes.of(one).value) <= 0) & (iv.smallest(boxes.of(other).value) <= 0)
        low, high = low[:, rest], high[:, rest]
        if not low.shape[1]:
            return HOLDS
        low, high = _halved(low, high, width)
        if low.shape[1] > _MOST:
            break
    return OPEN
