"""Part of a module: some of its functions, and the part of prepare() that they use."""

from __future__ import annotations

from dataclasses import replace

from wmrgen.ir.nodes import Function, Module, Op
from wmrgen.ir.prune import prune


def select(module: Module, names: dict[str, str]) -> Module:
    """The functions called by the keys of ``names``, renamed to its values, in that order."""
    functions = tuple(replace(module.function(old), name=new) for old, new in names.items())
    if module.prepare is None:
        return Module(module.name, functions)
    used = {node.name for f in functions for node in f.nodes if node.op is Op.INPUT}
    return Module(module.name, functions, _outputs(module.prepare, used))


def _outputs(prepare: Function, used: set[str | None]) -> Function | None:
    """prepare() with the outputs in ``used`` only; None when nothing is left."""
    kept = [i for i, port in enumerate(prepare.outputs) if port.name in used]
    if not kept:
        return None
    nodes, results = prune(prepare.nodes, [prepare.results[i] for i in kept])
    return replace(prepare, nodes=nodes, outputs=tuple(prepare.outputs[i] for i in kept), results=results)
