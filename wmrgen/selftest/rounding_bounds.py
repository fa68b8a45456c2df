"""Running error bounds: a function at many points at once, each value with a bound of its rounding error.

Values are computed in float64. Two bounds go along: how far code in the target's arithmetic (rounding unit ``unit``,
library functions within ``CIRCLE`` and ``LIBRARY``) may be from the float64 value, and how far that value may be from
the exact formula: Higham, Accuracy and Stability of Numerical Algorithms, 3.3. Contraction to fused multiply-add only
leaves roundings out, so the bounds hold with it. A comparison that rounding may turn counts both branches. The last
bits of a value may depend on the processor's sine; no result that is printed does, for those are rounded where the
second bound leaves no doubt.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from wmrgen.exact.number import Exact
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.rounding import to_float32, to_float64

Array = Any  # numpy array of float64, one value per point
UNITS = {"float": 2.0**-24, "double": 2.0**-53}
LARGEST_ANGLE = {"float": 1e4, "double": 1e9}  # rad: own kernels promise nothing beyond
CIRCLE = (
    4.0  # units of rounding that sines and cosines may be off, more than our kernels and any libm in use need
)
LIBRARY = 6.0  # the same of arctangents, in ulp
_HALF = 2.0**-53  # of the float64 values themselves


@dataclass(frozen=True, slots=True)
class Bounded:
    """``value`` per point; ``error``: two rows, of code in the target's arithmetic and of ``value`` itself.

    ``taken``: for choices, +1 and -1 where the outcome is sure, else 0, in the rows of ``error``.
    """

    value: Array
    error: Array
    taken: Array | None = None


@lru_cache(maxsize=4096)
def _constant(value: Exact, scalar: str) -> tuple[float, Array]:
    near = to_float64(value)
    single = to_float32(value)
    if value == Exact(Fraction(single)):
        return near, np.zeros((2, 1))
    return near, rounding_of(near, single if scalar == "float" else near)


def rounding_of(near: float, printed: float) -> Array:
    """Errors of a constant: of its printed value, and of the float64 ``near`` it."""
    own = _HALF * abs(near)
    return np.array([[abs(printed - near) + own], [own]])


def bounds(function: Function, inputs: Mapping[str, Bounded], scalar: str, count: int) -> list[Bounded]:
    """Every node of ``function`` at ``count`` points; ``inputs`` by name."""
    unit = np.array([[UNITS[scalar] + _HALF], [_HALF]])
    largest = LARGEST_ANGLE[scalar]
    known: list[Bounded] = []
    with np.errstate(all="ignore"):
        for node in function.nodes:
            if node.value is not None:
                value, error = _constant(node.value, scalar)
                known.append(Bounded(np.full(count, value), np.broadcast_to(error, (2, count))))
            elif node.op is Op.INPUT:
                known.append(inputs[node.name or ""])
            else:
                args = [known[a] for a in node.args]
                known.append(_apply(node, args, unit))
                if node.op in (Op.SIN, Op.COS):
                    known[-1] = _within(known[-1], args[0], largest)
    return known


def outputs(function: Function, known: list[Bounded]) -> dict[str, Bounded]:
    """The outputs by name."""
    return {port.name: known[i] for port, i in zip(function.outputs, function.results, strict=True)}


def _within(made: Bounded, angle: Bounded, largest: float) -> Bounded:
    """No bound where the angle is beyond ``largest``."""
    return Bounded(made.value, np.where(np.abs(angle.value) <= largest, made.error, np.inf))


def _apply(node: Node, args: list[Bounded], unit: Array) -> Bounded:
    if node.op is Op.MUL and node.args[0] == node.args[1]:
        return _square(args[0], unit)
    return _RULES[node.op](unit, *args)


def _rounded(value: Array, error: Array, unit: Array) -> Bounded:
    """One rounding on top of ``error``; none where exact operands give a number that every type holds."""
    exact = (error == 0) & (value.astype(np.float32) == value)
    return Bounded(value, np.where(exact, 0.0, error + unit * (np.abs(value) + error)))


def _add(unit: Array, a: Bounded, b: Bounded) -> Bounded:
    return _rounded(a.value + b.value, a.error + b.error, unit)


def _sub(unit: Array, a: Bounded, b: Bounded) -> Bounded:
    return _rounded(a.value - b.value, a.error + b.error, unit)


def _mul(unit: Array, a: Bounded, b: Bounded) -> Bounded:
    error = np.abs(a.value) * b.error + np.abs(b.value) * a.error + a.error * b.error
    return _rounded(a.value * b.value, error, unit)


def _square(a: Bounded, unit: Array) -> Bounded:
    return _rounded(a.value * a.value, (2 * np.abs(a.value) + a.error) * a.error, unit)


def _div(unit: Array, a: Bounded, b: Bounded) -> Bounded:
    value = a.value / b.value
    room = np.abs(b.value) - b.error
    error = np.where(room > 0, (a.error + np.abs(value) * b.error) / room, np.inf)
    return _rounded(value, error, unit)


def _sqrt(unit: Array, a: Bounded) -> Bounded:
    value = np.sqrt(a.value)
    lower = np.sqrt(np.maximum(a.value - a.error, 0.0))
    error = np.where(a.error > 0, a.error / np.maximum(value + lower, 1e-300), 0.0)
    return _rounded(value, np.minimum(error, np.sqrt(a.value + a.error)), unit)


def _circular(unit: Array, a: Bounded, name: str) -> Bounded:
    sine, cosine = np.sin(a.value), np.cos(a.value)
    value, slope = (sine, cosine) if name == "sin" else (cosine, sine)
    error = np.minimum(np.abs(slope) * a.error + a.error**2 / 2, 2.0)
    known = (a.value == 0) & (a.error == 0)
    return Bounded(value, np.where(known, 0.0, error + CIRCLE * unit))


def _atan2(unit: Array, y: Bounded, x: Bounded) -> Bounded:
    value = np.arctan2(y.value + 0.0, x.value + 0.0)  # the formula knows one zero
    radius = np.hypot(x.value, y.value)
    shift = np.hypot(x.error, y.error)
    first = np.abs(x.value) * y.error + np.abs(y.value) * x.error
    error = np.where(shift < radius / 64, 1.05 * first / np.maximum(radius**2, 1e-300), np.pi)
    error = np.where((shift == 0) & (radius == 0), 0.0, error)
    left = (x.value - x.error < 0) | np.signbit(x.value)  # a libm counts -0 as negative
    cut = left & (np.abs(y.value) <= y.error)  # the sign of y decides between +pi and -pi
    return Bounded(value, np.where(cut, 2 * np.pi, error) + 2 * LIBRARY * unit * np.abs(value))


def _atan(unit: Array, a: Bounded) -> Bounded:
    value = np.arctan(a.value)
    return Bounded(value, a.error + 2 * LIBRARY * unit * np.abs(value))


def _rint(unit: Array, a: Bounded) -> Bounded:
    del unit
    value = np.rint(a.value)
    sure = (np.abs(a.value - value) + a.error < 0.5) | (a.error == 0)
    return Bounded(value, np.where(sure, 0.0, 1.0 + a.error))


def _flip(unit: float, a: Bounded, n: Bounded) -> Bounded:
    del unit
    value = np.where(n.value % 2 == 1, -a.value, a.value)
    return Bounded(value, np.where(n.error < 1, a.error, 2 * np.abs(a.value) + a.error))


def _less(a: Bounded, b: Bounded) -> Array:
    """+1 where a < b for sure, -1 where a >= b for sure, 0 where rounding decides or code may read the sign of a 0."""
    gap, slack = b.value - a.value, a.error + b.error
    zeros = (gap == 0) & (np.signbit(a.value) != np.signbit(b.value))
    sure = (np.abs(gap) > slack) | ((slack == 0) & ~zeros)
    return sure * np.where(gap > 0, 1, -1)


def _select(unit: Array, a: Bounded, b: Bounded, x: Bounded, y: Bounded) -> Bounded:
    del unit
    taken = _less(a, b)
    first = a.value < b.value
    value = np.where(first, x.value, y.value)
    apart = np.abs(x.value - y.value)
    either = np.where(first, np.maximum(x.error, apart + y.error), np.maximum(y.error, apart + x.error))
    error = np.where(taken == 1, x.error, np.where(taken == -1, y.error, either))
    return Bounded(value, error, taken)


def _extreme(a: Bounded, b: Bounded, value: Array) -> Bounded:
    taken = _less(a, b)
    low, high = a.error, b.error
    return Bounded(value, np.maximum(low, high), taken)


_RULES: dict[str, Callable[..., Bounded]] = {
    Op.ADD: _add, Op.SUB: _sub, Op.MUL: _mul, Op.DIV: _div, Op.SQRT: _sqrt, Op.ATAN2: _atan2, Op.SELECT: _select,
    Op.ATAN: _atan, Op.RINT: _rint, Op.FLIP: _flip,
    Op.NEG: lambda unit, a: Bounded(-a.value, a.error),
    Op.ABS: lambda unit, a: Bounded(np.abs(a.value), a.error),
    Op.SIN: lambda unit, a: _circular(unit, a, "sin"),
    Op.COS: lambda unit, a: _circular(unit, a, "cos"),
    Op.MIN: lambda unit, a, b: _extreme(a, b, np.where(a.value < b.value, a.value, b.value)),
    Op.MAX: lambda unit, a, b: _extreme(a, b, np.where(b.value < a.value, a.value, b.value)),
}  # fmt: skip
