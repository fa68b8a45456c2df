"""CasADi: one SX function per IR function, node by node, with inputs and outputs by contract name.

Dots are legal in CasADi's names, so ``f(**{"left.spin": 1.0})["vx"]`` works as everywhere else.
Tunable parameters are the last inputs and default to their nominal values.

SX evaluates both branches of every choice, and its derivative of a branch that is not taken is 0 times
that branch's derivative: NaN where that is infinite. So sqrt and atan2 get harmless arguments at the
points where they have no derivative; there the derivative given is 0.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from wmrgen.backends.registry import Facts
from wmrgen.ir.calls import complete, defaults, self_contained
from wmrgen.ir.nodes import Function, Module, Op
from wmrgen.ir.rounding import to_float64


def _apply(op: Op, args: list[ca.SX]) -> ca.SX:
    """SX.binary and SX.unary are six times as fast as the operators, which try several conversions first."""
    if callable(op.casadi):
        result: ca.SX = op.casadi(ca, *args)
    elif op.arity == 2:
        result = ca.SX.binary(getattr(ca, op.casadi), *args)
    else:
        result = ca.SX.unary(getattr(ca, op.casadi), *args)
    return result


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
    options: dict[str, Any] = {"allow_duplicate_io_names": True}  # a steering angle goes in and comes out
    if symbols:
        options["default_in"] = [nominal.get(key, 0.0) for key in symbols]
    return ca.Function(
        name,
        list(symbols.values()),
        [values[r] for r in function.results],
        list(symbols),
        [port.name for port in function.outputs],
        options,
    )


def functions(module: Module) -> dict[str, ca.Function]:
    """``<robot>_<function>`` by function name; `prepare` is part of each."""
    return {
        f.name: to_casadi(f, ca.Function.fix_name(f"{module.name}_{f.name}")) for f in self_contained(module)
    }


def sensitivity(
    function: Function, outputs: Sequence[str], inputs: Sequence[str], parameters: Sequence[str]
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """``outputs`` of ``function`` and their exact derivatives by ``parameters``, (outputs x (1 + parameters), N) by
    parameter, of columns of ``inputs`` and ``parameters``, (inputs + parameters, N)."""
    whole = to_casadi(function, "whole")
    names = [*inputs, *parameters]
    symbols = ca.SX.sym("columns", len(names))
    results = whole(**{name: symbols[i] for i, name in enumerate(names)})
    values = ca.vertcat(*(results[name] for name in outputs))
    by = ca.jacobian(values, symbols[len(inputs) :])
    both = ca.Function("sensitivity", [symbols], [ca.densify(ca.vertcat(values, ca.vec(by)))])
    return lambda columns: np.asarray(both(columns))


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
    wanted = next(f for f in self_contained(module) if f.name == function)
    call = to_casadi(wanted, "f")
    results = []
    for case in cases:
        values = call.call([ca.DM(value) for value in complete(wanted, case)])
        results.append({port.name: float(v) for port, v in zip(wanted.outputs, values, strict=True)})
    return results
