"""sympy's ccode after cse, printed for float32."""

from __future__ import annotations

import sympy
from sympy.codegen.ast import float32, real
from sympy.printing.c import C99CodePrinter

from benchmarks.others.decimals import decimals, with_plain_functions
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.symbolic import signal


def source(
    derivation: Derivation, function: str, outputs: tuple[str, ...]
) -> tuple[str, str, tuple[str, ...]]:
    """C of some outputs, the name of its function and the inputs. The formula's own intermediate results stay."""
    formula = derivation.formula(function)
    results = {port.name: value for port, value in formula.outputs}
    inputs = tuple(port.name for port in formula.inputs)
    plain = {signal(name): sympy.Symbol(f"x[{k}]", real=True) for k, name in enumerate(inputs)}
    own = [sympy.Symbol(f"own{k}", real=True) for k in range(len(formula.locals))]
    plain |= {symbol: mine for (symbol, _), mine in zip(formula.locals, own, strict=True)}
    values = [
        with_plain_functions(value)
        for value in (*(v for _, v in formula.locals), *(results[name] for name in outputs))
    ]
    plain |= decimals(values)
    shared, reduced = sympy.cse([value.xreplace(plain) for value in values])
    settings = {"type_aliases": {real: float32}, "user_functions": {"Nearest": "rintf"}, "math_macros": {}}
    printer = C99CodePrinter(settings)
    name = f"sympy_{derivation.robot.name}_{function}"
    lines = ["#include <math.h>", f"void {name}(const float *x, float *y)", "{"]
    lines += [
        f"    const float {symbol} = {printer.doprint(value)};"
        for symbol, value in _in_order([*shared, *zip(own, reduced, strict=False)])
    ]
    lines += [f"    y[{k}] = {printer.doprint(value)};" for k, value in enumerate(reduced[len(own) :])]
    return "\n".join([*lines, "}", ""]), name, inputs


def _in_order(items: list[tuple[sympy.Symbol, sympy.Expr]]) -> list[tuple[sympy.Symbol, sympy.Expr]]:
    """Each definition after those that it uses."""
    values = dict(items)
    done: dict[sympy.Symbol, sympy.Expr] = {}

    def visit(symbol: sympy.Symbol) -> None:
        if symbol in values and symbol not in done:
            for used in sorted(values[symbol].free_symbols, key=str):
                visit(used)
            done[symbol] = values[symbol]

    for symbol, _ in items:
        visit(symbol)
    return list(done.items())
