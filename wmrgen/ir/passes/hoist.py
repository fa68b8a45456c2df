"""Geometry-only work moved out of the step functions into `prepare`."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from itertools import count

from wmrgen.ir.build import Builder
from wmrgen.ir.geometry import geometry_only
from wmrgen.ir.nodes import Function, Module, Op, Port, Role


def hoist(functions: tuple[Function, ...], name: str) -> Module:
    """A module whose step functions read geometry only as outputs k0, k1, ... of `prepare`, parameters' names left out.

    Equal values of different functions are prepared once. Without geometry inputs nothing changes.
    """
    builder = Builder()
    ports: dict[str, Port] = {}
    taken = {port.name for function in functions for port in function.inputs}
    free = (k for i in count() if (k := f"k{i}") not in taken)
    # Node of prepare -> its output, which is made when first asked for.
    prepared: dict[int, Port] = defaultdict(lambda: Port(next(free), Role.PREPARED, "", ""))
    steps = tuple(_hoist_one(function, builder, ports, prepared) for function in functions)
    if not prepared:
        return Module(name, steps)
    text = "Values that depend on the tunable parameters alone."
    outputs = tuple(prepared.values())
    prepare = builder.function("prepare", tuple(ports.values()), outputs, list(prepared), text)
    read = {node.name for node in prepare.nodes}
    inputs = tuple(port for port in prepare.inputs if port.name in read)
    return Module(name, steps, replace(prepare, inputs=inputs))


def _hoist_one(
    function: Function, builder: Builder, ports: dict[str, Port], prepared: dict[int, Port]
) -> Function:
    """``function`` over prepared inputs; its geometry goes to ``builder``, ``ports`` and ``prepared``."""
    geometry = [port for port in function.inputs if port.role is Role.GEOMETRY]
    if not geometry:
        return function
    for port in geometry:
        ports.setdefault(port.name, port)
    early = _tunable(function, {port.name for port in geometry})
    wanted = {arg for i, node in enumerate(function.nodes) if not early[i] for arg in node.args}
    wanted.update(function.results)
    moved: dict[int, int] = {}
    own = Builder()
    made: list[int] = []
    used: dict[str, Port] = {}
    for i, node in enumerate(function.nodes):
        if not early[i]:
            args = [made[arg] for arg in node.args]
            made.append(own.again(node, args))
            continue
        _move(function, i, moved, builder)
        made.append(_reference(own, builder, moved[i], prepared, used) if i in wanted else -1)
    results = [made[result] for result in function.results]
    inputs = tuple(port for port in function.inputs if port.role is not Role.GEOMETRY)
    return own.function(
        function.name, inputs + tuple(used.values()), function.outputs, results, function.text
    )


def _tunable(function: Function, names: set[str]) -> list[bool]:
    """Nodes that depend on tunable parameters, and on nothing else that changes."""
    known = geometry_only(function)
    touched: list[bool] = []
    for i, node in enumerate(function.nodes):
        reads = node.name in names if node.op is Op.INPUT else any(touched[arg] for arg in node.args)
        touched.append(known[i] and reads)
    return touched


def _move(function: Function, i: int, moved: dict[int, int], builder: Builder) -> int:
    """The node of `prepare` for node ``i``, which is tunable or a constant expression."""
    if i not in moved:
        node = function.nodes[i]
        moved[i] = builder.copy(node, [_move(function, arg, moved, builder) for arg in node.args])
    return moved[i]


def _reference(
    own: Builder, builder: Builder, node: int, prepared: dict[int, Port], used: dict[str, Port]
) -> int:
    """The input of the step function that stands for ``node`` of `prepare`."""
    constant = builder.value(node)
    if constant is not None:
        return own.const(constant)
    port = prepared[node]
    used[port.name] = port
    return own.input(port.name)
