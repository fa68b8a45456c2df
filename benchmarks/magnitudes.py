"""What a formula adds up, signs aside: the measure of its rounding errors, for many inputs at once in float64."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.rounding import to_float64

Array = NDArray[np.float64]
_PLAIN = {
    Op.ADD: np.add, Op.SUB: np.subtract, Op.MUL: np.multiply, Op.DIV: np.divide, Op.NEG: np.negative, Op.ABS: np.abs,
    Op.SQRT: np.sqrt, Op.MIN: np.minimum, Op.MAX: np.maximum, Op.SIN: np.sin, Op.COS: np.cos, Op.ATAN: np.arctan,
    Op.ATAN2: np.arctan2, Op.RINT: np.rint,
}  # fmt: skip


def magnitudes(function: Function, cases: Sequence[Mapping[str, float]]) -> list[Array]:
    """For each result the sum of what it adds up, without signs, per case. A sine or cosine counts 1."""
    values: list[Array] = []
    sizes: list[Array] = []
    defaults = {p.name: to_float64(p.default) for p in function.inputs if p.default is not None}
    with np.errstate(all="ignore"):
        for node in function.nodes:
            args = [values[k] for k in node.args]
            if node.value is not None:
                value = np.full(len(cases), to_float64(node.value))
            elif node.op is Op.INPUT:
                name = node.name or ""
                value = np.array([case.get(name, defaults.get(name)) for case in cases], dtype=np.float64)
            elif node.op is Op.SELECT:
                value = np.where(args[0] < args[1], args[2], args[3])
            elif node.op is Op.FLIP:
                value = np.where(args[1] % 2 == 1, -args[0], args[0])
            else:
                value = _PLAIN[node.op](*args)
            values.append(value)
            sizes.append(_size(node, value, [sizes[k] for k in node.args], args))
    return [sizes[k] for k in function.results]


def _size(node: Node, value: Array, known: list[Array], args: list[Array]) -> Array:
    match node.op:
        case Op.ADD | Op.SUB:
            return np.asarray(known[0] + known[1])
        case Op.MUL:
            return np.asarray(known[0] * known[1])
        case Op.DIV:
            return np.asarray(known[0] / np.abs(args[1]))
        case Op.NEG | Op.ABS | Op.FLIP:
            return known[0]
        case Op.SQRT:
            return np.asarray(np.sqrt(known[0]))
        case Op.SIN | Op.COS:
            return np.ones_like(value)
        case Op.SELECT:
            return np.where(args[0] < args[1], known[2], known[3])
        case Op.MIN | Op.MAX:
            return np.maximum(*known)
        case _:
            return np.asarray(np.abs(value))


def ulps(sizes: Array) -> Array:
    """The unit in the last place of a float of each size."""
    _, exponents = np.frexp(sizes)
    return np.asarray(np.ldexp(1.0, np.maximum(exponents, -125) - 24))
