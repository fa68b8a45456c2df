"""CasADi: one SX function per IR function, node by node, with inputs and outputs by contract name.

Dots are legal in CasADi's names, so ``f(**{"left.spin": 1.0})["vx"]`` works as everywhere else.
Tunable parameters are the last inputs and default to their nominal values.

SX evaluates both branches of every choice, and its derivative of a branch that is not taken is 0 times
that branch's derivative: NaN where that is infinite. So sqrt and atan2 get harmless arguments at the
points where they have no derivative; there the derivative given is 0.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache

import casadi as ca

from wmrgen.backends.registry import Facts
from wmrgen.ir.inline import complete, defaults, inlined
from wmrgen.ir.nodes import Function, Module, Op
from wmrgen.ir.rounding import to_float64

# SX.binary and SX.unary are six times as fast as the operators, which try several conversions first.
_binary: Callable[[int, ca.SX, ca.SX], ca.SX] = ca.SX.binary
_unary: Callable[[int, ca.SX], ca.SX] = ca.SX.unary
_BINARY: dict[Op, int] = {
    Op.ADD: ca.OP_ADD, Op.SUB: ca.OP_SUB, Op.MUL: ca.OP_MUL, Op.DIV: ca.OP_DIV,
    Op.MIN: ca.OP_FMIN, Op.MAX: ca.OP_FMAX,
}  # fmt: skip
_UNARY: dict[Op, int] = {
    Op.NEG: ca.OP_NEG,
    Op.ABS: ca.OP_FABS,
    Op.SIN: ca.OP_SIN,
    Op.COS: ca.OP_COS,
    Op.ATAN: ca.OP_ATAN,
}


@cache
def _zero() -> ca.SX:
    return ca.SX(0.0)


def _sqrt(x: ca.SX) -> ca.SX:
    """sqrt(x) for x >= 0, with derivative 0 at 0."""
    positive = _binary(ca.OP_LT, _zero(), x)
    safe = _binary(ca.OP_ADD, x, _unary(ca.OP_NOT, positive))
    return _binary(ca.OP_MUL, _unary(ca.OP_SQRT, safe), positive)


def _atan2(y: ca.SX, x: ca.SX) -> ca.SX:
    """atan2(y, x), 0 with derivative 0 where x*x + y*y is 0 in float64 (both below 1e-162)."""
    square = _binary(ca.OP_ADD, _binary(ca.OP_MUL, x, x), _binary(ca.OP_MUL, y, y))
    away = _binary(ca.OP_LT, _zero(), square)
    safe = _binary(ca.OP_ADD, x, _unary(ca.OP_NOT, away))
    return _binary(ca.OP_MUL, _binary(ca.OP_ATAN2, y, safe), away)


def _select(a: ca.SX, b: ca.SX, x: ca.SX, y: ca.SX) -> ca.SX:
    chosen = _binary(ca.OP_LT, a, b)
    first = _binary(ca.OP_IF_ELSE_ZERO, chosen, x)
    return _binary(ca.OP_ADD, first, _binary(ca.OP_IF_ELSE_ZERO, _unary(ca.OP_NOT, chosen), y))


def _rint(x: ca.SX) -> ca.SX:
    """The nearest whole number; ties to the larger, where the IR has them to even. Derivative 0."""
    return _unary(ca.OP_FLOOR, _binary(ca.OP_ADD, x, ca.SX(0.5)))


def _flip(a: ca.SX, n: ca.SX) -> ca.SX:
    """a, or -a where n is odd: a (1 - 2 |n - 2 floor(n/2 + 1/2)|)."""
    half = _binary(ca.OP_ADD, _binary(ca.OP_MUL, n, ca.SX(0.5)), ca.SX(0.5))
    even = _binary(ca.OP_MUL, ca.SX(2.0), _unary(ca.OP_FLOOR, half))
    odd = _unary(ca.OP_FABS, _binary(ca.OP_SUB, n, even))
    return _binary(ca.OP_MUL, a, _binary(ca.OP_SUB, ca.SX(1.0), _binary(ca.OP_MUL, ca.SX(2.0), odd)))


_GUARDED: dict[Op, Callable[..., ca.SX]] = {
    Op.SQRT: _sqrt,
    Op.ATAN2: _atan2,
    Op.SELECT: _select,
    Op.RINT: _rint,
    Op.FLIP: _flip,
}


def _apply(op: Op, args: list[ca.SX]) -> ca.SX:
    if op in _BINARY:
        return _binary(_BINARY[op], *args)
    if op in _UNARY:
        return _unary(_UNARY[op], *args)
    return _GUARDED[op](*args)


def to_casadi(function: Function, name: str) -> ca.Function:
    """``function`` (without PREPARED inputs) as SX function ``name``."""
    symbols = {port.name: ca.SX.sym(port.name) for port in function.inputs}
    values: list[ca.SX] = []
    for node in function.nodes:
        if node.value is not None:
            values.append(ca.SX(to_float64(node.value)))
        elif node.op is Op.INPUT:
            values.append(symbols[node.name or ""])
        else:
            values.append(_apply(node.op, [values[a] for a in node.args]))
    nominal = defaults(function)
    return ca.Function(
        name,
        list(symbols.values()),
        [values[r] for r in function.results],
        list(symbols),
        [port.name for port in function.outputs],
        {
            "allow_duplicate_io_names": True
        }  # steering angles are inputs and outputs; CasADi keeps the two apart
        | ({"default_in": [nominal.get(key, 0.0) for key in symbols]} if symbols else {}),
    )


def functions(module: Module) -> dict[str, ca.Function]:
    """``<robot>_<function>`` by function name; `prepare` is part of each."""
    return {f.name: to_casadi(f, ca.Function.fix_name(f"{module.name}_{f.name}")) for f in inlined(module)}


def emit(module: Module, facts: Facts) -> dict[str, bytes]:
    """``<robot>_<function>.casadi`` for ``casadi.Function.load``; the bytes `Function.save` would write."""
    del facts  # the format has no place for it
    files = {}
    for name, function in functions(module).items():
        serializer = ca.StringSerializer()
        serializer.pack(function)
        files[f"{module.name}_{name}.casadi"] = serializer.encode().encode("ascii")
    return files


def evaluate(module: Module, function: str, cases: Sequence[Mapping[str, float]]) -> list[dict[str, float]]:
    """Outputs by contract name for each case, in float64."""
    wanted = next(f for f in inlined(module) if f.name == function)
    call = to_casadi(wanted, "f")
    results = []
    for case in cases:
        values = call.call([ca.DM(value) for value in complete(wanted, case)])
        results.append({port.name: float(v) for port, v in zip(wanted.outputs, values, strict=True)})
    return results
