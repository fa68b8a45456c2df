"""IR functions as Rust functions: signatures and bodies, and the kernels that they call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from wmrgen.codegen.expression import Results, Style, body, expanded, results_of
from wmrgen.codegen.rust.records import Kernel, Parameter, Step, Unit
from wmrgen.codegen.rust.types import (
    SCALARS,
    Struct,
    doc,
    identifier,
    literal,
    sentence,
    signature,
    struct,
    type_name,
    wrapped,
)
from wmrgen.codegen.signature import IN, OUT, Argument, arguments, members
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.kernels.trigonometry import SOFT
from wmrgen.ir.nodes import Function, Module, Node, Op, Port, Role, pruned

# In Rust the arithmetic of floats has the bits that C gets from integers on processors without floating point.
_HARD = {soft: op for op, soft in SOFT.items()}
_ABOUT = {
    "pose": "Where P is in the world frame, and the heading.",
    "pose_covariance": "The covariance of a pose: its upper triangle.",
    "twist": "The velocity of P and the yaw rate, in the robot frame.",
    "twist_covariance": "The covariance of a twist: its upper triangle.",
    "wheels": "The joints that are commanded or sensed: commands, measurements, present state.",
    IN: "What [`{}`] takes.",
    OUT: "What [`{}`] gives.",
}


def unit(module: Module, choice: Choice) -> Unit:
    """The Rust functions of ``module``: `prepare` first where a parameter is tunable."""
    module, costs = expanded(module, choice)
    scalar = SCALARS[choice.scalar]
    shared = {
        kind: struct(type_name(kind), ports, scalar, _ABOUT[kind]) for kind, ports in members(module).items()
    }
    printer = _Printer(scalar, _style(scalar), results_of(module.kernels, scalar, type_name))
    structs, steps, nominal = [*shared.values()], list[Step](), dict[str, str]()
    prepare = module.prepare
    if prepare is not None and prepare.outputs:
        parameters = _of_prepare(prepare, scalar)
        own = {p.name: p.struct for p in parameters if p.struct}
        structs += own.values()
        if prepare.inputs:
            ports = ((p.name, p.default) for p in prepare.inputs if p.default is not None)
            nominal = {name: literal(value, scalar) for name, value in ports}
        shared |= own
        steps.append(printer.step(prepare, parameters, ""))
    for function in (f for f in module.functions if f.outputs):
        of = arguments(function, module.joints)
        own = {a.kind: _own(function, a, scalar) for a in of if a.kind in (IN, OUT)}
        structs += own.values()
        types = shared | own
        called = {a.name: "input" if a.name == IN else identifier(a.name) for a in of}
        parameters = [Parameter(called[a.name], types.get(a.kind), a.reads, a.writes) for a in of]
        handed = {p.name: p.name for p in function.inputs if p.role is Role.PREPARED}
        if handed:
            parameters.insert(0, Parameter("prepared", shared["prepared"], handed, {}))
        cost = f"Operations of the formula: {costs[function.name]}."
        steps.append(printer.step(function, parameters, cost))
    kernels = tuple(map(printer.kernel, module.kernels))
    return Unit(module.name, choice, tuple(structs), nominal, tuple(steps), kernels)


def _of_prepare(prepare: Function, scalar: str) -> list[Parameter]:
    """What `prepare` takes, where it takes anything, and gives."""
    params = struct("Params", prepare.inputs, scalar, "Tunable parameters: calibrate, then [`prepare`].")
    prepared = struct("Prepared", prepare.outputs, scalar, "What [`prepare`] works out for the functions.")
    reads, writes = ({port.name: port.name for port in ports} for ports in (prepare.inputs, prepare.outputs))
    own = [Parameter("params", params, reads, {})] if reads else []
    return [*own, Parameter("prepared", prepared, {}, writes)]


def _own(function: Function, argument: Argument, scalar: str) -> Struct:
    """The struct that ``function`` alone takes or gives."""
    ports = function.inputs if argument.kind == IN else function.outputs
    carried = argument.reads or argument.writes
    text = _ABOUT[argument.kind].format(identifier(function.name))
    name = type_name(function.name, argument.kind)
    return struct(name, [port for port in ports if port.name in carried], scalar, text)


def _style(scalar: str) -> Style:
    """How Rust writes operations in ``scalar``."""
    suffix = "f" if scalar == "f32" else ""

    def form(op: Op) -> str:
        text = op.rust or op.c
        return type(text)(text.replace("{f}", suffix))

    literals = partial(literal, scalar=scalar)
    return Style(literals, form, "let {0}: {2} = {1};", "t{0}", scalar=scalar, named=identifier)


def _hard(function: Function) -> Function:
    """``function`` with the arithmetic of floats, without what its results do not need."""
    nodes = tuple(Node(_HARD[n.op], n.args) if n.op in _HARD else n for n in function.nodes)
    return pruned(replace(function, nodes=nodes))


class _Printer(NamedTuple):
    scalar: str
    style: Style
    kernels: Mapping[str, Results]

    def step(self, function: Function, parameters: Sequence[Parameter], cost: str) -> Step:
        """``function`` with ``parameters`` in the order of its interface."""
        function = _hard(function)
        reads = {port: p.member(member) for p in parameters for port, member in p.reads.items()}
        names = {p.name for p in parameters}
        code = body(function, reads.__getitem__, self.style, kernels=self.kernels, reserved=names)
        texts = dict(zip((port.name for port in function.outputs), code.results, strict=True))
        results = tuple(p for p in parameters if p.returned)
        arguments = tuple(p for p in parameters if not p.returned)
        types = [p.struct.name if p.struct else self.scalar for p in results]
        arrow = f" -> {types[0] if len(types) == 1 else '(' + ', '.join(types) + ')'}" if types else ""
        head = signature(
            f"pub fn {identifier(function.name)}", [p.declared(self.scalar) for p in arguments], arrow
        )
        lines = (*code.statements, *_stored(arguments, results, texts))
        docs = _docs(function, parameters, cost)
        return Step(identifier(function.name), docs, head, lines, arguments, results, code.ops)

    def kernel(self, kernel: Function) -> Kernel:
        """A private function whose arguments are numbers."""
        kernel = _hard(kernel)
        names = {port.name for port in kernel.inputs}
        code = body(kernel, identifier, self.style, kernels=self.kernels, reserved=names)
        own = self.kernels[kernel.name]
        collector = None if len(own.members) == 1 else (own.type, own.members)
        texts = zip(own.members, code.results, strict=True)
        result = (
            f"{own.type} {{ {', '.join(m if m == t else f'{m}: {t}' for m, t in texts)} }}"
            if collector
            else code.results[0]
        )
        arguments = [f"{identifier(port.name)}: {self.scalar}" for port in kernel.inputs]
        head = signature(f"fn {own.function}", arguments, f" -> {own.type}")
        return Kernel(doc(kernel.text), head, (*code.statements, result), code.ops, collector)


def _stored(
    arguments: Sequence[Parameter], results: Sequence[Parameter], texts: Mapping[str, str]
) -> list[str]:
    """What changes arguments and returns results. Every value is computed before anything changes."""

    def value(p: Parameter) -> list[str]:
        if p.struct is None:
            return [texts[p.port]]
        return p.struct.value({member: texts[port] for port, member in p.writes.items()}, p.name)

    changed = [p for p in arguments if p.writes]
    returned = _together([value(p) for p in results])
    if not changed:
        return returned
    places = _together([[f"*{p.name}"] for p in changed])
    values = _together([value(p) for p in changed])
    assigned = [f"{''.join(places)} = {values[0]}", *values[1:]]
    assigned[-1] += ";"
    if not results:
        return assigned
    returned[-1] += ";"
    return [f"let result = {returned[0]}", *returned[1:], *assigned, "result"]


def _together(values: Sequence[list[str]]) -> list[str]:
    """One value, or a tuple of collector."""
    if len(values) < 2:
        return values[0] if values else []
    if all(len(value) == 1 for value in values):
        return [f"({', '.join(value[0] for value in values)})"]
    lines = [line for value in values for line in (*value[:-1], f"{value[-1]},")]
    return ["(", *(f"    {line}" for line in lines), ")"]


def _docs(function: Function, parameters: Sequence[Parameter], cost: str) -> tuple[str, ...]:
    """What ``function`` does, what its numbers are and which members change."""
    ports: dict[str, Port] = {port.name: port for port in (*function.inputs, *function.outputs)}
    items = []
    for p in parameters:
        if p.struct is None:
            port = ports[p.port]
            how, unit = "returned: " if p.returned else "", f", {doc(port.unit)}" if port.unit else ""
            items.append(f"`{port.name}`: {how}{doc(port.text)}{unit}")
        elif p.writes and not p.returned:
            members = (p.struct.paths[member] for member in p.writes.values())
            items.append(f"`{p.name}`: changed in {', '.join(f'`{member}`' for member in members)}")
    paragraphs = [wrapped(text) for text in (sentence(function.text), cost) if text]
    paragraphs.insert(1, [line for item in items for line in wrapped(item, "* ")])
    return tuple(line for lines in paragraphs if lines for line in (*lines, ""))[:-1]
