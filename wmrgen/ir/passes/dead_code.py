"""Nodes that no output needs."""

from __future__ import annotations

from dataclasses import replace

from wmrgen.ir.nodes import Function, Op, Role
from wmrgen.ir.prune import prune


def drop_dead_code(function: Function) -> Function:
    """``function`` without unneeded nodes and without geometry inputs that nothing reads.

    Contract inputs stay, read or not: callers rely on them.
    """
    nodes, results = prune(function.nodes, function.results)
    read = {node.name for node in nodes if node.op is Op.INPUT}
    inputs = tuple(
        port
        for port in function.inputs
        if port.name in read or port.role not in (Role.GEOMETRY, Role.PREPARED)
    )
    return replace(function, inputs=inputs, nodes=nodes, results=results)
