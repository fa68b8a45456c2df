"""The functions of a robot as modules: as they are written, optimised, and cut for C."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from wmrgen.ir.nodes import Function, Module
from wmrgen.ir.pipeline import optimise
from wmrgen.ir.select import keep_outputs, select
from wmrgen.lower import kernels_of, lower
from wmrgen.program import Program

_TWIST = frozenset({"vx", "vy", "omega"})


def written(program: Program) -> Module:
    """Not optimised: what the exact backend evaluates."""
    return Module(program.name, tuple(lower(f) for f in program.formulas))


def with_calls(program: Program) -> Module:
    """As `written`, with calls of the kernels that the formulas name."""
    functions = tuple(lower(f, calls=True) for f in program.formulas)
    return Module(program.name, functions, kernels=kernels_of(program.formulas))


def optimised(module: Module, meaning: Module | None = None) -> Module:
    """Every function once; forward also without its residual, inverse also in two: joints, and slip alone.

    ``meaning``: ``module`` in base operations, where it calls kernels.
    """
    whole = optimise(
        module.functions, module.name, kernels=module.kernels, meaning=(meaning or module).functions
    )
    parts: list[Function] = []
    for f in whole.functions:
        if f.name == "forward":
            residual = replace(
                f, name="forward_residual", text=f"{f.text}, with its residual", variant_of="forward"
            )
            parts += [keep_outputs(f, _TWIST, "forward_twist"), residual]
        elif f.name == "inverse":
            joints = frozenset(port.name for port in f.outputs if port.name != "slip")
            slip = keep_outputs(f, frozenset({"slip"}), "inverse_residual")
            text = "sliding that the ground must give when this twist is driven"
            parts += [
                keep_outputs(f, joints, "inverse_joints"),
                replace(slip, text=text, variant_of="inverse"),
            ]
    return replace(whole, functions=(*whole.functions, *parts))


def for_c(module: Module, functions: Iterable[str]) -> Module:
    """Of an `optimised` module: forward with and without the residual, inverse without slip, which has a function
    of its own."""
    names: dict[str, str] = {}
    for name in functions:
        if name == "forward":
            names |= {"forward_twist": "forward", "forward_residual": "forward_slip"}
        elif name == "inverse":
            names |= {"inverse_joints": "inverse", "inverse_residual": "inverse_slip"}
        else:
            names[name] = name
    return select(module, names)
