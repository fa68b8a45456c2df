"""The order of the passes, the check of their result, and `hoist`, which moves geometry to `prepare`."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from itertools import count

from wmrgen.ir.build import Builder
from wmrgen.ir.calls import inlined_calls
from wmrgen.ir.geometry import geometry_only
from wmrgen.ir.linear_forms import share_linear_forms
from wmrgen.ir.nodes import Function, Module, Op, Port, Role, pruned, rebuilt, schedule
from wmrgen.ir.simplify import factor, prefer_positive_constants, reduce_strength, regroup_products
from wmrgen.ir.verify import check_module

# ---- dead code


def drop_dead_code(function: Function) -> Function:
    """Return ``function`` without nodes that no result needs and without unused geometry inputs.

    Unused inputs of other roles remain, because callers pass them.
    """
    needed = pruned(function)
    read = {node.name for node in needed.nodes if node.op is Op.INPUT}
    inputs = tuple(
        port
        for port in function.inputs
        if port.name in read or port.role not in (Role.GEOMETRY, Role.PREPARED)
    )
    return replace(needed, inputs=inputs)


# ---- geometry moves to prepare()


def hoist(functions: tuple[Function, ...], name: str) -> Module:
    """Return a module whose `prepare` computes all values that depend on tunable parameters alone.

    Its outputs are called k0, k1, ..., except for names that inputs have. Functions share equal values. Without
    geometry inputs there is no `prepare`.
    """
    builder = Builder()
    ports: dict[str, Port] = {}
    names = {port.name for function in functions for port in function.inputs}
    free = (name for name in map("k{}".format, count()) if name not in names)
    # Node of prepare -> its output; made when it is first needed.
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
    """Return ``function`` with prepared inputs; add its geometry to ``builder``, ``ports`` and ``prepared``."""
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
    built: list[int] = []
    used: dict[str, Port] = {}
    for i, node in enumerate(function.nodes):
        if not early[i]:
            args = [built[arg] for arg in node.args]
            built.append(own.again(node, args))
            continue
        _move(function, i, moved, builder)
        built.append(_reference(own, builder, moved[i], prepared, used) if i in wanted else -1)
    inputs = tuple(port for port in function.inputs if port.role is not Role.GEOMETRY)
    step = replace(function, inputs=inputs + tuple(used.values()))
    return pruned(rebuilt(step, own.nodes, {i: k for i, k in enumerate(built) if k >= 0}))


def _tunable(function: Function, names: set[str]) -> list[bool]:
    """Return by node whether it depends on tunable parameters, and on no other input."""
    early = geometry_only(function)
    touched: list[bool] = []
    for i, node in enumerate(function.nodes):
        reads = node.name in names if node.op is Op.INPUT else any(touched[arg] for arg in node.args)
        touched.append(early[i] and reads)
    return touched


def _move(function: Function, i: int, moved: dict[int, int], builder: Builder) -> int:
    """Return the node of `prepare` for node ``i``, which is tunable or a constant expression."""
    if i not in moved:
        node = function.nodes[i]
        moved[i] = builder.copy(node, [_move(function, arg, moved, builder) for arg in node.args])
    return moved[i]


def _reference(
    own: Builder, builder: Builder, node: int, prepared: dict[int, Port], used: dict[str, Port]
) -> int:
    """Return the input of the step function that receives ``node`` of `prepare`, or a constant."""
    constant = builder.value(node)
    if constant is not None:
        return own.const(constant)
    port = prepared[node]
    used[port.name] = port
    return own.input(port.name)


# ---- the order of passes

Pass = Callable[[Function], Function]

BEFORE_HOIST: tuple[Pass, ...] = (
    reduce_strength, factor, share_linear_forms, prefer_positive_constants, regroup_products,
)  # fmt: skip
AFTER_HOIST: tuple[Pass, ...] = (drop_dead_code, schedule)


def optimise(
    functions: tuple[Function, ...],
    name: str,
    kernels: tuple[Function, ...] = (),
    meaning: tuple[Function, ...] | None = None,
) -> Module:
    """Run all passes, and check the result at one point modulo a prime.

    Args:
        functions: the functions, which may call ``kernels``.
        name: the name of the module.
        kernels: the kernels, in the order in which they call each other.
        meaning: the functions in base operations, against which the result is checked; ``functions`` by default.

    Returns:
        The module, in as few operations as the passes find.
    """
    steps = tuple(_run(function, BEFORE_HOIST) for function in functions)
    module = replace(hoist(steps, name), kernels=kernels)
    steps = tuple(_run(function, AFTER_HOIST) for function in module.functions)
    prepare = None if module.prepare is None else simplified(module.prepare)
    module = Module(name, steps, prepare, kernels)
    check_module(functions if meaning is None else meaning, inlined_calls(module))
    return module


def _run(function: Function, passes: tuple[Pass, ...]) -> Function:
    for step in passes:
        function = step(function)
    return function


def simplified(prepare: Function) -> Function:
    """Return `prepare` after the same passes, in which its parameters count as ordinary inputs."""
    roles = {port.name: port for port in prepare.inputs}
    ordinary = replace(prepare, inputs=tuple(replace(p, role=Role.STATE) for p in prepare.inputs))
    run = _run(ordinary, BEFORE_HOIST + AFTER_HOIST)
    return replace(run, inputs=tuple(roles[port.name] for port in run.inputs))
