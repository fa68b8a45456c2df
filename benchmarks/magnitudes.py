"""What a formula adds up, signs aside: the measure of its rounding errors, for many inputs at once in float64."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from wmrgen.ir.interpret import values_of
from wmrgen.ir.nodes import Function, Node, Op

Array = NDArray[np.float64]


def magnitudes(function: Function, cases: Sequence[Mapping[str, float]]) -> list[Array]:
    """For each result the sum of what it adds up, without signs, per case. A sine or cosine counts 1."""
    inputs = {}
    for p in function.inputs:
        default = None if p.default is None else float(p.default)
        inputs[p.name] = np.array([case.get(p.name, default) for case in cases], dtype=np.float64)
    with np.errstate(all="ignore"):
        values = values_of(function, inputs, np.float64)
    sizes: list[Array] = []
    with np.errstate(all="ignore"):
        for node, value in zip(function.nodes, values, strict=True):
            sizes.append(_size(node, value, [sizes[k] for k in node.args], [values[k] for k in node.args]))
    return [np.broadcast_to(sizes[k], len(cases)) for k in function.results]


def _size(node: Node, value: Array, sizes: list[Array], args: list[Array]) -> Array:
    match node.op:
        case Op.ADD | Op.SUB | Op.COMPENSATED:
            return np.asarray(sizes[0] + sizes[1])
        case Op.MUL:
            return np.asarray(sizes[0] * sizes[1])
        case Op.DIV:
            return np.asarray(sizes[0] / np.abs(args[1]))
        case Op.NEG | Op.ABS | Op.FLIP | Op.WITH_SIGN_OF:
            return sizes[0]
        case Op.SQRT:
            return np.asarray(np.sqrt(sizes[0]))
        case Op.SIN | Op.COS:
            return np.ones_like(value)
        case Op.SELECT:
            return np.where(args[0] < args[1], sizes[2], sizes[3])
        case Op.MIN | Op.MAX | Op.CLAMP | Op.AT_LEAST:
            return np.maximum(*sizes)
        case _:
            return np.asarray(np.abs(value))


def ulps(sizes: Array) -> Array:
    """Return the unit in the last place of floats of these sizes."""
    _, exponents = np.frexp(sizes)
    return np.asarray(np.ldexp(1.0, np.maximum(exponents, -125) - 24))
