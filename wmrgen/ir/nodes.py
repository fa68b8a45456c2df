"""The intermediate representation: a flat single-assignment list of scalar operations.

A function is a tuple of nodes; a node's arguments are indices of earlier nodes. Constants are
exact (`wmrgen.exact.Exact`, the field Q(sqrt2, sqrt3)), rounded once, by the backend that prints them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from wmrgen.exact.number import Exact
from wmrgen.ports import Limits, Port, Role

__all__ = ["ARITY", "Function", "Limits", "Module", "Node", "Op", "Port", "Role"]


class Op(StrEnum):
    """The scalar operations. Arity stands in `ARITY`."""

    CONST = "const"
    INPUT = "input"
    ADD = "add"
    SUB = "sub"
    MUL = "mul"
    DIV = "div"
    NEG = "neg"
    ABS = "abs"
    MIN = "min"
    MAX = "max"
    SQRT = "sqrt"
    SIN = "sin"
    COS = "cos"
    ATAN = "atan"
    ATAN2 = "atan2"  # atan2(y, x); atan2(0, 0) = 0
    RINT = "rint"  # the nearest whole number, ties to even
    FLIP = "flip"  # flip(a, n): a where the whole number n is even, else -a
    SELECT = "select"  # select(a, b, x, y): x where a < b, else y
    # What only the C of some processors has, see `wmrgen.ir.kernels`:
    FMA = "fma"  # a * b + c, rounded once
    ISIN = "isin"  # sine, cosine and arctangent (|q| <= 1) in integers: wmrgen.ir.kernels.integer
    ICOS = "icos"
    IATAN = "iatan"
    IMUL = "imul"  # MUL, DIV and SQRT to the last bit, in integers
    IDIV = "idiv"
    ISQRT = "isqrt"
    NEGATE_IF_ODD = (
        "negate_if_odd"  # negate_if_odd(a, b): -a where the last bit of the float b is set, else a
    )
    CLAMP = "clamp"  # clamp(a, m): m with the sign of a where |a| > m, else a; m of NaN; m > 0
    AT_LEAST = "at_least"  # at_least(a, m): m with the sign of a where |a| < m, else a; m > 0
    WITH_SIGN_OF = "with_sign_of"  # with_sign_of(a, b): -a where the sign bit of the float b is set, else a
    # Operations that keep their meaning, see `Module.kernels`:
    CALL = "call"  # of the kernel called ``name``, over its inputs
    RESULT = "result"  # the result number ``name`` of a call whose kernel has several


ARITY = {
    Op.CONST: 0, Op.INPUT: 0, Op.NEG: 1, Op.ABS: 1, Op.SQRT: 1, Op.SIN: 1, Op.COS: 1,
    Op.ATAN: 1, Op.RINT: 1, Op.ISIN: 1, Op.ICOS: 1, Op.IATAN: 1, Op.FLIP: 2, Op.FMA: 3, Op.NEGATE_IF_ODD: 2,
    Op.IMUL: 2, Op.IDIV: 2, Op.ISQRT: 1, Op.WITH_SIGN_OF: 2, Op.CLAMP: 2, Op.AT_LEAST: 2,
    Op.ADD: 2, Op.SUB: 2, Op.MUL: 2, Op.DIV: 2, Op.MIN: 2, Op.MAX: 2, Op.ATAN2: 2, Op.SELECT: 4,
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Node:
    """One operation. CONST carries ``value``; INPUT carries ``name`` (the name of an input port)."""

    op: Op
    args: tuple[int, ...] = ()
    value: Exact | None = None
    name: str | None = None


@dataclass(frozen=True, slots=True)
class Function:
    """Straight-line code: ``outputs[k]`` is computed by node ``results[k]``.

    ``named``: intermediate results of the formula and their nodes, of code as lowered and not optimised.
    ``variant_of``: the function whose inputs and intermediate results this one shares, where it gives other outputs
    of the same formula. ``limits``: which inputs the limits of the robot bound.
    """

    name: str
    inputs: tuple[Port, ...]
    nodes: tuple[Node, ...]
    outputs: tuple[Port, ...]
    results: tuple[int, ...]
    text: str = ""
    named: tuple[tuple[str, int], ...] = ()
    variant_of: str = ""
    limits: Limits = Limits.NONE


@dataclass(frozen=True, slots=True)
class Module:
    """All functions of a robot. ``prepare`` is None when no geometry is tunable.

    The outputs of ``prepare`` are the PREPARED inputs of the other functions, by name. ``kernels``: what the functions
    call, those that are called before those that call; a call gives their inputs in order.
    """

    name: str
    functions: tuple[Function, ...]
    prepare: Function | None = None
    kernels: tuple[Function, ...] = ()

    def function(self, name: str) -> Function:
        """The function called ``name``; KeyError when there is none."""
        return {f.name: f for f in self.functions}[name]
