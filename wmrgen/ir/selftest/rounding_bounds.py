"""Running error bounds: a function at many points at once, each value with a bound of its rounding error.

Values are computed in float64. Two bounds go with them: how far code in the target's arithmetic may be from the float64
value, and how far that value may be from the exact formula (Higham, Accuracy and Stability of Numerical Algorithms,
3.3). Fused multiply-adds only leave out roundings, so the bounds hold for them too. If rounding may change the outcome
of a comparison, both branches count. The last bits of a value may depend on the processor's sine. Printed results do
not: they are rounded where the second bound leaves no doubt.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np

from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.ops.analysis import Bounded
from wmrgen.ir.rounding import to_float32, to_float64

Array = Any  # numpy array of float64, one value per point
UNITS = {"float": 2.0**-24, "double": 2.0**-53}  # unit roundoff: largest relative error of a rounding [1]
LARGEST_ANGLE = {"float": 1e4, "double": 1e9}  # sines of larger angles have no bound [rad]
_HALF = 2.0**-53  # unit roundoff of the float64 values themselves [1]


@lru_cache(maxsize=4096)
def _constant(value: Exact, scalar: str) -> tuple[float, Array]:
    """Return the float64 value of a constant, and its errors as in `Bounded.error`."""
    near = to_float64(value)
    single = to_float32(value)
    if value == Exact(Fraction(single)):
        return near, np.zeros((2, 1))
    return near, rounding_of(near, single if scalar == "float" else near)


def rounding_of(near: float, printed: float) -> Array:
    """Return the errors of a constant: of its printed value, and of the float64 value ``near``."""
    own = _HALF * abs(near)
    return np.array([[abs(printed - near) + own], [own]])


def bounds(function: Function, inputs: Mapping[str, Bounded], scalar: str, count: int) -> list[Bounded]:
    """Return every node with its error bounds.

    Args:
        function: the function, without calls.
        inputs: values and errors by input name.
        scalar: "float" or "double", the type of the code.
        count: the number of points.

    Returns:
        By node, values and errors at all points.
    """
    unit = np.array([[UNITS[scalar] + _HALF], [_HALF]])
    largest = LARGEST_ANGLE[scalar]
    nodes: list[Bounded] = []
    with np.errstate(all="ignore"):
        for node in function.nodes:
            if node.value is not None:
                value, error = _constant(node.value, scalar)
                nodes.append(Bounded(np.full(count, value), np.broadcast_to(error, (2, count))))
            elif node.op is Op.INPUT:
                nodes.append(inputs[node.name or ""])
            else:
                op, args = node.meaning
                assert op.running is not None
                nodes.append(op.running(unit, *(nodes[a] for a in args)))
                if op in (Op.SIN, Op.COS):
                    nodes[-1] = _within(nodes[-1], nodes[args[0]], largest)
    return nodes


def _within(wave: Bounded, angle: Bounded, largest: float) -> Bounded:
    """Return a sine or cosine without a bound (infinite error) where the angle is larger than ``largest``."""
    return Bounded(wave.value, np.where(np.abs(angle.value) <= largest, wave.error, np.inf))
