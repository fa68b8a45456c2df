"""One interpreter over three arithmetics (`wmrgen.ir.arithmetic`), in list order.

In float32 and float64 it predicts generated C compiled with ``-ffp-contract=off`` bit for bit,
library functions aside. MIN is ``a < b ? a : b`` and MAX is ``b < a ? a : b``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wmrgen.errors import UsageError
from wmrgen.ir.arithmetic import EXACT, FLOAT32, FLOAT64, Arithmetic, Number
from wmrgen.ir.calls import by_name, inlined
from wmrgen.ir.nodes import Function, Module, Op, Role

__all__ = ["EXACT", "FLOAT32", "FLOAT64", "Arithmetic", "evaluate", "evaluate_module", "evaluate_nodes"]


def evaluate_nodes(function: Function, inputs: Mapping[str, Number], arithmetic: Arithmetic) -> list[Any]:
    """The value of every node, in list order. Inputs left out take the default of their port.

    UsageError where an input has neither value nor default; ZeroDivisionError and ValueError
    (exact arithmetic only) where a quotient or a square root is undefined.
    """
    defaults = {port.name: port.default for port in function.inputs}
    apply, enter = arithmetic.apply, arithmetic.enter
    values: list[Any] = []
    for i, node in enumerate(function.nodes):
        if node.value is not None:
            values.append(enter(node.value))
        elif node.op is Op.INPUT:
            name = node.name or ""
            given = inputs.get(name, defaults.get(name))
            if given is None:
                raise UsageError(f"{function.name} needs a value for {name}")
            values.append(enter(given))
        else:
            try:
                values.append(apply[node.op](*(values[arg] for arg in node.args)))
            except (ZeroDivisionError, ValueError) as error:
                raise type(error)(f"{function.name}, node {i}: {error}") from None
    return values


def evaluate(function: Function, inputs: Mapping[str, Number], arithmetic: Arithmetic) -> dict[str, Any]:
    """Output name to value: `Exact` in exact arithmetic, float (a float32 as float) otherwise."""
    values = evaluate_nodes(function, inputs, arithmetic)
    return {port.name: values[i] for port, i in zip(function.outputs, function.results, strict=True)}


def evaluate_module(
    module: Module, name: str, inputs: Mapping[str, Number], arithmetic: Arithmetic
) -> dict[str, Any]:
    """`evaluate` of the function called ``name``, without calls, after ``prepare`` where the module has one."""
    function = inlined(module.function(name), by_name(module.kernels))
    known: dict[str, Number] = dict(inputs)
    if module.prepare is not None and any(port.role is Role.PREPARED for port in function.inputs):
        known.update(evaluate(module.prepare, inputs, arithmetic))
    return evaluate(function, known, arithmetic)
