"""What the functions of a module call and are handed: kernels, `prepare`; a part of a module has what it needs of both.

A node CALL names a kernel of its module (`Module.kernels`), which is a function over base operations and other calls.
`inlined_calls` puts the meaning in their place, for everything that knows base operations alone. `inline_prepare` makes
a step function self-contained: it computes what `prepare` would have handed it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import ONE
from wmrgen.ir.nodes import Function, Module, Node, Op, Port, Role, contract, pruned, rebuilt, renumbered

Kernels = Mapping[str, Function]


def inlined_calls(module: Module) -> Module:
    """``module`` in base operations: every call replaced by what its kernel computes."""
    if not module.kernels:
        return module
    kernels = by_name(module.kernels)
    return replace(module, functions=tuple(inlined(f, kernels) for f in module.functions), kernels=())


def by_name(kernels: Sequence[Function]) -> Kernels:
    """Kernels by name, each without calls."""
    bodies: dict[str, Function] = {}
    for kernel in kernels:
        bodies[kernel.name] = inlined(kernel, bodies)
    return bodies


def called(functions: Sequence[Function]) -> frozenset[str]:
    """The kernels that ``functions`` call themselves."""
    return frozenset(node.name or "" for f in functions for node in f.nodes if node.op is Op.CALL)


def inlined(function: Function, kernels: Kernels) -> Function:
    """``function`` without calls of ``kernels``, which have none themselves; equal operations once."""
    return with_places(function, kernels)[0]


def with_places(function: Function, kernels: Kernels) -> tuple[Function, Sequence[int]]:
    """As `inlined`, and where the value of each node is then; of a call that of its first result."""
    if not any(node.op is Op.CALL for node in function.nodes):
        return function, range(len(function.nodes))
    nodes: list[Node] = []
    index: dict[Node, int] = {}
    place: list[int] = []
    results: dict[int, tuple[int, ...]] = {}  # a call -> where its results are

    one = Node(Op.CONST, value=ONE)

    def put(node: Node, args: tuple[int, ...]) -> int:
        if node.op is Op.MUL and (factor := index.get(one)) in args:
            return args[args[0] == factor]  # to the bit
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
    """The functions called by the keys of ``names``, renamed to its values, in that order; with what they need of
    `prepare` and of the kernels."""
    functions = tuple(replace(module.function(old), name=new) for old, new in names.items())
    used = frozenset(node.name or "" for f in functions for node in f.nodes if node.op is Op.INPUT)
    prepare = module.prepare and keep_outputs(module.prepare, used, module.prepare.name)
    wanted = called(functions)
    kernels = tuple(kernel for kernel in module.kernels if kernel.name in wanted)
    prepare = prepare if prepare and prepare.outputs else None
    return replace(module, functions=functions, prepare=prepare, kernels=kernels)


def keep_outputs(function: Function, names: frozenset[str], name: str) -> Function:
    """The function with the outputs in ``names`` only, under another name."""
    kept = [i for i, port in enumerate(function.outputs) if port.name in names]
    outputs = tuple(function.outputs[i] for i in kept)
    results = tuple(function.results[i] for i in kept)
    return pruned(replace(function, name=name, outputs=outputs, results=results))


def inline_prepare(function: Function, prepare: Function | None) -> Function:
    """``function`` without PREPARED inputs: contract inputs first, then every tunable parameter it needs."""
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
    tunables = prepare.inputs + tuple(p for p in own if p.name not in {q.name for q in prepare.inputs})
    return pruned(rebuilt(replace(function, inputs=asked + tunables), nodes, dict(enumerate(place))))


def self_contained(module: Module) -> tuple[Function, ...]:
    """Every function of ``module``, self-contained."""
    return tuple(inline_prepare(function, module.prepare) for function in module.functions)


def defaults(function: Function) -> dict[str, float]:
    """Nominal values of the tunable inputs."""
    return {port.name: float(port.default) for port in function.inputs if port.default is not None}


def nominal(module: Module) -> dict[str, float]:
    """Nominal values of the tunable parameters of ``module``."""
    return {name: value for f in module.every for name, value in defaults(f).items()}


def complete(function: Function, case: Mapping[str, float]) -> list[float]:
    """The values of ``case`` in order of the inputs, tunables left out nominal. UsageError for a gap."""
    return in_order(function.name, [port.name for port in function.inputs], {**defaults(function), **case})


def in_order(function: str, inputs: Sequence[str], values: Mapping[str, float]) -> list[float]:
    """Of ``values`` those of ``inputs``. UsageError where the ``function`` needs one that is not there."""
    missing = [name for name in inputs if name not in values]
    if missing:
        raise UsageError(f"{function} needs a value for {', '.join(missing)}")
    return [float(values[name]) for name in inputs]


def hand_through(module: Module) -> Module:
    """``module`` whose step functions read geometry only from `prepare`, which hands raw values through."""
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
    functions = tuple(
        replace(f, inputs=tuple(passed.get(p.name, p) if p.role is Role.GEOMETRY else p for p in f.inputs))
        for f in module.functions
    )
    return replace(module, functions=functions, prepare=prepare)
