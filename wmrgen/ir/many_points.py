"""A function at many points at once, in the arithmetic of NumPy, for what may be off in the last place."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.rounding import to_float64

Array = Any

APPLY: dict[str, Any] = {
    Op.ADD: np.add, Op.SUB: np.subtract, Op.MUL: np.multiply, Op.DIV: np.divide, Op.NEG: np.negative,
    Op.ABS: np.abs, Op.SQRT: np.sqrt, Op.SIN: np.sin, Op.COS: np.cos, Op.ATAN: np.arctan, Op.RINT: np.rint,
    Op.ATAN2: np.arctan2, Op.MIN: np.minimum, Op.MAX: np.maximum,
    Op.SELECT: lambda a, b, x, y: np.where(a < b, x, y), Op.FMA: lambda a, b, c: a * b + c,
    Op.FLIP: lambda a, n: np.where(n % 2 == 1, -a, a),
    Op.NEGATE_IF_ODD: lambda a, n: np.where(np.asarray(n, np.float32).view(np.uint32) & 1, -a, a),
    Op.CLAMP: lambda a, m: np.clip(a, -m, m),
    Op.AT_LEAST: lambda a, m: np.where(np.abs(a) < m, np.copysign(m, a), a),
    Op.WITH_SIGN_OF: lambda a, b: np.where(np.signbit(b), -a, a),
    Op.IMUL: np.multiply, Op.IDIV: np.divide, Op.ISQRT: np.sqrt,
    Op.ISIN: np.sin, Op.ICOS: np.cos, Op.IATAN: np.arctan,
}  # fmt: skip


def values_of(function: Function, given: Mapping[str, Array], kind: Any) -> list[Array]:
    """Every node, in arithmetic of ``kind``, which float kernels need."""
    values: list[Array] = []
    with np.errstate(all="ignore"):
        for node in function.nodes:
            if node.value is not None:
                values.append(kind(to_float64(node.value)))
            elif node.op is Op.INPUT:
                values.append(given[node.name or ""].astype(kind))
            else:
                values.append(APPLY[node.op](*(values[a] for a in node.args)))
    return values
