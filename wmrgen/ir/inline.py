"""Make a step function self-contained: compute what `prepare` would have handed it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from wmrgen.errors import UsageError
from wmrgen.ir.nodes import Function, Module, Node, Op, Port, Role, prune


def inline_prepare(function: Function, prepare: Function | None) -> Function:
    """``function`` without PREPARED inputs: contract inputs first, then every tunable parameter it needs."""
    wanted = {port.name for port in function.inputs if port.role is Role.PREPARED}
    own = tuple(port for port in function.inputs if port.role is Role.GEOMETRY)
    contract = tuple(port for port in function.inputs if port.role in (Role.STATE, Role.COMMAND))
    if prepare is None or not wanted:
        return replace(function, inputs=contract + own)
    nodes = list(prepare.nodes)
    made = dict(zip((port.name for port in prepare.outputs), prepare.results, strict=True))
    place: list[int] = []
    for node in function.nodes:
        if node.op is Op.INPUT and node.name in made:
            place.append(made[node.name])
            continue
        nodes.append(Node(node.op, tuple(place[a] for a in node.args), node.value, node.name))
        place.append(len(nodes) - 1)
    tunables = prepare.inputs + tuple(p for p in own if p.name not in {q.name for q in prepare.inputs})
    kept, results = prune(nodes, [place[r] for r in function.results])
    return replace(function, inputs=contract + tunables, nodes=kept, results=results)


def inlined(module: Module) -> tuple[Function, ...]:
    """Every function of ``module``, self-contained."""
    return tuple(inline_prepare(function, module.prepare) for function in module.functions)


def defaults(function: Function) -> dict[str, float]:
    """Nominal values of the tunable inputs."""
    return {port.name: float(port.default) for port in function.inputs if port.default is not None}


def complete(function: Function, case: Mapping[str, float]) -> list[float]:
    """The values of ``case`` in order of the inputs, tunables left out nominal. UsageError for a gap."""
    known = {**defaults(function), **case}
    missing = [port.name for port in function.inputs if port.name not in known]
    if missing:
        raise UsageError(f"{function.name} needs a value for {', '.join(missing)}")
    return [float(known[port.name]) for port in function.inputs]


def hand_through(module: Module) -> Module:
    """``module`` whose step functions read geometry only from `prepare`, which hands raw values through."""
    direct: dict[str, Port] = {}
    for function in module.functions:
        direct |= {port.name: port for port in function.inputs if port.role is Role.GEOMETRY}
    if not direct:
        return module
    prepare = module.prepare or Function("prepare", (), (), (), ())
    known = {port.name for port in prepare.inputs}
    inputs = prepare.inputs + tuple(port for name, port in direct.items() if name not in known)
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
