"""Calls of kernels, and `prepare`: replacing them by what they compute, and selecting parts of a module.

A CALL node names a kernel of its module (`Module.kernels`), which is a function of base operations and other calls.
`inlined_calls` replaces calls by the operations of the kernel, for code that only knows base operations.
`inline_prepare` makes a step function self-contained: it then computes the values that `prepare` would have passed.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import ONE
from wmrgen.ir.nodes import Function, Module, Node, Op, Port, Role, contract, pruned, rebuilt, renumbered

Kernels = Mapping[str, Function]


def inlined_calls(module: Module) -> Module:
    """Return ``module`` in base operations: every call is replaced by the operations of its kernel."""
    if not module.kernels:
        return module
    kernels = by_name(module.kernels)
    return replace(module, functions=tuple(inlined(f, kernels) for f in module.functions), kernels=())


def by_name(kernels: Sequence[Function]) -> Kernels:
    """Return kernels by name, each without calls."""
    bodies: dict[str, Function] = {}
    for kernel in kernels:
        bodies[kernel.name] = inlined(kernel, bodies)
    return bodies


def called(functions: Sequence[Function]) -> frozenset[str]:
    """Return the names of the kernels that ``functions`` call directly."""
    return frozenset(node.name or "" for f in functions for node in f.nodes if node.op is Op.CALL)


def inlined(function: Function, kernels: Kernels) -> Function:
    """Return ``function`` without calls; ``kernels`` are free of calls. Equal operations are shared."""
    return with_places(function, kernels)[0]


def with_places(function: Function, kernels: Kernels) -> tuple[Function, Sequence[int]]:
    """Return `inlined`, and the new index of each node; for a call that of its first result."""
    if not any(node.op is Op.CALL for node in function.nodes):
        return function, range(len(function.nodes))
    nodes: list[Node] = []
    index: dict[Node, int] = {}
    place: list[int] = []
    results: dict[int, tuple[int, ...]] = {}  # a call -> the new indices of its results
    one = Node(Op.CONST, value=ONE)

    def put(node: Node, args: tuple[int, ...]) -> int:
        factor = index.get(one)
        if node.op is Op.MUL and factor in args:
            return args[args[0] == factor]  # 1 x is x, to the bit
        new = node.over(args)
        position = index.setdefault(new, len(nodes))
        if position == len(nodes):
            nodes.append(new)
        return position

    for k, node in enumerate(function.nodes):
        if node.op is Op.CALL:
            kernel = kernels[node.name or ""]
            arguments = dict(zip((p.name for p in kernel.inputs), (place[a] for a in node.args), strict=True))
            inner: list[int] = []
            for step in kernel.nodes:
                name = step.name if step.op is Op.INPUT else None
                inner.append(arguments[name] if name else put(step, tuple(map(inner.__getitem__, step.args))))
            results[k] = tuple(inner[r] for r in kernel.results)
            place.append(results[k][0])
        elif node.op is Op.RESULT:
            place.append(results[node.args[0]][int(node.name or 0)])
        else:
            place.append(put(node, tuple(map(place.__getitem__, node.args))))
    named = renumbered(function.named, dict(enumerate(place)))
    at = tuple(place[r] for r in function.results)
    return replace(function, nodes=tuple(nodes), results=at, named=named), place


def select(module: Module, names: dict[str, str]) -> Module:
    """Return a module with some functions of ``module``, and with the parts of `prepare` and of the kernels they need.

    ``names`` has the new name by old name, in the order of the new module.
    """
    functions = tuple(replace(module.function(old), name=new) for old, new in names.items())
    used = frozenset(node.name or "" for f in functions for node in f.nodes if node.op is Op.INPUT)
    prepare = module.prepare and keep_outputs(module.prepare, used, module.prepare.name)
    wanted = called(functions)
    kernels = tuple(kernel for kernel in module.kernels if kernel.name in wanted)
    prepare = prepare if prepare and prepare.outputs else None
    prepared = {port.name for port in prepare.outputs} if prepare else set()
    complete = tuple(_without_missing(f, prepared) for f in functions)
    return replace(module, functions=complete, prepare=prepare, kernels=kernels)


def _without_missing(function: Function, prepared: Collection[str]) -> Function:
    """Return a function without inputs from `prepare` that are not among ``prepared``; no node reads them."""
    inputs = tuple(
        port for port in function.inputs if port.role is not Role.PREPARED or port.name in prepared
    )
    return replace(function, inputs=inputs)


def keep_outputs(function: Function, names: frozenset[str], name: str) -> Function:
    """Return a function with some of its outputs.

    Args:
        function: the function.
        names: the outputs to keep.
        name: the name of the new function.

    Returns:
        The function, without nodes that these outputs do not need.
    """
    kept = [i for i, port in enumerate(function.outputs) if port.name in names]
    outputs = tuple(function.outputs[i] for i in kept)
    results = tuple(function.results[i] for i in kept)
    return pruned(replace(function, name=name, outputs=outputs, results=results))


def inline_prepare(function: Function, prepare: Function | None) -> Function:
    """Return ``function`` without PREPARED inputs: it takes its other inputs, then the tunable parameters it needs."""
    wanted = {port.name for port in function.inputs if port.role is Role.PREPARED}
    own = tuple(port for port in function.inputs if port.role is Role.GEOMETRY)
    asked = contract(function)
    if prepare is None or not wanted:
        return replace(function, inputs=asked + own)
    nodes = list(prepare.nodes)
    prepared = dict(zip((port.name for port in prepare.outputs), prepare.results, strict=True))
    place: list[int] = []
    for node in function.nodes:
        if node.op is Op.INPUT and node.name in prepared:
            place.append(prepared[node.name])
            continue
        nodes.append(node.over(tuple(place[a] for a in node.args)))
        place.append(len(nodes) - 1)
    known = {port.name for port in prepare.inputs}
    tunables = prepare.inputs + tuple(port for port in own if port.name not in known)
    return pruned(rebuilt(replace(function, inputs=asked + tunables), nodes, dict(enumerate(place))))


def self_contained(module: Module) -> tuple[Function, ...]:
    """Return every function of ``module`` without PREPARED inputs."""
    return tuple(inline_prepare(function, module.prepare) for function in module.functions)


def defaults(function: Function) -> dict[str, float]:
    """Return the nominal values of the tunable inputs."""
    return {port.name: float(port.default) for port in function.inputs if port.default is not None}


def nominal(module: Module) -> dict[str, float]:
    """Return the nominal values of the tunable parameters of ``module``."""
    return {name: value for f in module.every for name, value in defaults(f).items()}


def complete(function: Function, case: Mapping[str, float]) -> list[float]:
    """Return the values of ``case`` in the order of the inputs; tunable inputs may be left out. See `in_order`."""
    return in_order(function.name, [port.name for port in function.inputs], {**defaults(function), **case})


def in_order(function: str, inputs: Sequence[str], values: Mapping[str, float]) -> list[float]:
    """Return the values of inputs in their order.

    Args:
        function: the name of the function, for the error.
        inputs: the names of its inputs.
        values: values by name, possibly of other inputs too.

    Raises:
        UsageError: an input has no value.
    """
    missing = [name for name in inputs if name not in values]
    if missing:
        raise UsageError(f"{function} needs a value for {', '.join(missing)}")
    return [float(values[name]) for name in inputs]


def pass_geometry_through_prepare(module: Module) -> Module:
    """Return ``module`` with tunable parameters passed through `prepare`: step functions read no geometry directly."""
    direct: dict[str, Port] = {}
    for function in module.functions:
        direct |= {port.name: port for port in function.inputs if port.role is Role.GEOMETRY}
    if not direct:
        return module
    prepare = module.prepare or Function("prepare", (), (), (), ())
    names = {port.name for port in prepare.inputs}
    inputs = prepare.inputs + tuple(port for name, port in direct.items() if name not in names)
    nodes = prepare.nodes + tuple(Node(Op.INPUT, name=name) for name in direct)
    passed = {name: replace(port, role=Role.PREPARED, default=None) for name, port in direct.items()}
    start = len(prepare.nodes)
    prepare = replace(
        prepare,
        inputs=inputs,
        nodes=nodes,
        outputs=prepare.outputs + tuple(passed.values()),
        results=prepare.results + tuple(range(start, start + len(direct))),
    )
    functions = []
    for function in module.functions:
        ports = [passed.get(p.name, p) if p.role is Role.GEOMETRY else p for p in function.inputs]
        functions.append(replace(function, inputs=tuple(ports)))
    return replace(module, functions=tuple(functions), prepare=prepare)
