"""Part of a module: some of its functions, and the part of prepare() that they use."""

from __future__ import annotations

from dataclasses import replace

from wmrgen.ir.calls import called
from wmrgen.ir.nodes import Function, Module, Op, prune


def select(module: Module, names: dict[str, str]) -> Module:
    """The functions called by the keys of ``names``, renamed to its values, in that order."""
    functions = tuple(replace(module.function(old), name=new) for old, new in names.items())
    if module.prepare is None:
        return _with_called(Module(module.name, functions), module.kernels)
    used = {node.name for f in functions for node in f.nodes if node.op is Op.INPUT}
    return _with_called(Module(module.name, functions, _outputs(module.prepare, used)), module.kernels)


def _with_called(module: Module, kernels: tuple[Function, ...]) -> Module:
    """``module`` with those of ``kernels`` that it calls."""
    wanted = called(module.functions)
    return replace(module, kernels=tuple(k for k in kernels if k.name in wanted))


def _outputs(prepare: Function, used: set[str | None]) -> Function | None:
    """prepare() with the outputs in ``used`` only; None when nothing is left."""
    names = frozenset(name for name in used if name is not None)
    kept = keep_outputs(prepare, names, prepare.name)
    return kept if kept.outputs else None


def keep_outputs(function: Function, names: frozenset[str], name: str) -> Function:
    """The function with the outputs in ``names`` only, under another name."""
    kept = [i for i, port in enumerate(function.outputs) if port.name in names]
    nodes, results = prune(function.nodes, [function.results[i] for i in kept])
    outputs = tuple(function.outputs[i] for i in kept)
    return replace(function, name=name, nodes=nodes, outputs=outputs, results=results)
