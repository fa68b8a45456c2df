"""Functions as Rust: their signatures and bodies; the kernels that they call, and calls of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from wmrgen.codegen.expression import Results, Style, body, expanded, results_of
from wmrgen.codegen.rust.text import (
    SCALARS,
    doc,
    identifier,
    literal,
    sentence,
    signature,
    struct,
    type_name,
    value,
    wrapped,
)
from wmrgen.codegen.signature import IN, OUT, PARAMS, PREPARED, Signature, members, signatures
from wmrgen.codegen.unit import Kernel, Parameter, Step, Struct, Unit, parameter
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.kernels.trigonometry import SOFT
from wmrgen.ir.nodes import Function, Module, Node, Op, Port, pruned

# C computes in integers on processors without floating point. Rust's arithmetic of floats gives the same bits.
_HARD = {soft: op for op, soft in SOFT.items()}
_TEXTS = {
    "pose": "Position of P and heading of the robot, in the world frame.",
    "pose_covariance": "The covariance of a pose: the upper triangle of a symmetric matrix.",
    "twist": "Velocity of P and yaw rate, in the robot frame.",
    "twist_covariance": "The covariance of a twist: the upper triangle of a symmetric matrix.",
    "wheels": "The joints that are commanded or sensed: for commands, measurements and the present state.",
    PARAMS: "Tunable parameters. After a change call [`prepare`].",
    PREPARED: "Values that [`prepare`] computes from the parameters for the other functions.",
    IN: "Inputs of [`{}`].",
    OUT: "Outputs of [`{}`].",
}


def unit(module: Module, choice: Choice) -> Unit:
    """Return the Rust functions of ``module``; `prepare` is the first, if a parameter is tunable."""
    module, costs = expanded(module, choice)
    scalar = SCALARS[choice.scalar]
    shared = {kind: struct(type_name(kind), ports, _TEXTS[kind]) for kind, ports in members(module).items()}
    types, steps = dict(shared), list[Step]()
    printer = _Printer(scalar, _style(scalar), results_of(module.kernels, scalar, type_name))
    for each in signatures(module):
        function = each.function
        own = _own_structs(each)
        if function is module.prepare:
            types |= own
            cost = ""
        else:
            cost = f"Operations of the formula: {costs[function.name]}."
        found = types | own
        parameters = [parameter(a, _name(a.name), found.get(a.kind), scalar) for a in each.arguments]
        steps.append(printer.step(function, parameters, own.values(), cost))
    kernels = tuple(map(printer.kernel, module.kernels))
    return Unit(module.name, choice, tuple(shared.values()), tuple(steps), kernels)


def _own_structs(signature: Signature) -> dict[str, Struct]:
    """Return the structs that only one function has, by kind."""
    function, structs = signature.function, {}
    for kind, ports in signature.own_types.items():
        name = type_name(function.name, kind) if kind in (IN, OUT) else type_name(kind)
        structs[kind] = struct(name, ports, _TEXTS[kind].format(identifier(function.name)))
    return structs


def _name(argument: str) -> str:
    return "input" if argument == IN else identifier(argument)


def scalar_of(unit: Unit) -> str:
    """Return the scalar type of a crate: ``f32`` or ``f64``."""
    return SCALARS[unit.choice.scalar]


def step_of(unit: Unit, function: str) -> Step | None:
    """Return the Rust function of a function of the robot; None if it has no outputs."""
    return next((step for step in unit.steps if step.function == function), None)


# ---- parameters and calls


def returned(p: Parameter) -> bool:
    """Return whether the function returns ``p``: it writes all members and reads none. Other parameters are changed."""
    return not p.reads and (p.struct is None or len(p.writes) == len(p.struct.members))


def _declared(p: Parameter) -> str:
    if p.struct is None:
        return f"{p.name}: {p.type}"
    return f"{p.name}: &{'mut ' if p.writes else ''}{p.type}"


def _port(p: Parameter) -> str:
    """Return the contract name of a scalar."""
    return next(iter(p.reads or p.writes))


def _together(names: Sequence[str]) -> str:
    """Return one name or type, or a tuple of several."""
    return names[0] if len(names) == 1 else f"({', '.join(names)})"


def _calling(step: Step, values: Mapping[str, str]) -> list[str]:
    """Return statements that call ``step``; ``values``: contract name of an input -> expression.

    The variable `prepared` exists already. Parameters that ``values`` lacks are nominal.
    """
    lines, passed, results = [], [], []
    for p in step.parameters:
        if returned(p):
            results.append(p.name)
        elif p.struct is None:
            passed.append(values[_port(p)])
        else:
            passed.append(f"&{'mut ' if p.writes else ''}{p.name}")
            stored = []
            for port, member in p.reads.items():
                if port in values:
                    stored.append(f"{p.place(member)} = {values[port]};")
            if p.name != PREPARED:
                mutable = "mut " if stored or p.writes else ""
                lines += [f"let {mutable}{p.name} = {p.type}::default();", *stored]
    bound = f"let {_together(results)} = " if results else ""
    return [*lines, f"{bound}{step.name}({', '.join(passed)});"]


def block(
    unit: Unit, step: Step, values: Mapping[str, str], result: Callable[[Mapping[str, str]], str]
) -> list[str]:
    """Return the lines of a block that calls ``step``, after `prepare` if it needs that.

    Args:
        unit: The functions of the robot.
        step: The function.
        values: Contract name of an input -> expression.
        result: Returns the value of the block from the outputs: contract name -> place.
    """
    lines = []
    for each in (*unit.before([step]), step):
        lines += _calling(each, values)
    lines.append(result(outputs_of(step)))
    return ["{", *(f"    {line}" for line in lines), "}"]


def outputs_of(step: Step) -> dict[str, str]:
    """Return the places of outputs by contract name: first those that are changed, then those that are returned."""
    parameters = sorted(step.parameters, key=returned)
    return {port: p.place(member) for p in parameters for port, member in p.writes.items()}


# ---- steps and kernels


def _style(scalar: str) -> Style:
    """Return how Rust writes operations in ``scalar``."""
    suffix = "f" if scalar == "f32" else ""

    def form(op: Op) -> str:
        text = op.rust or op.c
        return type(text)(text.replace("{f}", suffix))

    literals = partial(literal, scalar=scalar)
    return Style(literals, form, "let {0}: {2} = {1};", "t{0}", scalar=scalar, named=identifier)


def _with_floats(function: Function) -> Function:
    """Return ``function`` with operations of floats in the place of integers, without nodes that no result needs."""
    nodes = tuple(Node(_HARD[n.op], n.args) if n.op in _HARD else n for n in function.nodes)
    return pruned(replace(function, nodes=nodes))


class _Printer(NamedTuple):
    scalar: str
    style: Style
    kernels: Mapping[str, Results]  # kernels that may be called, by name

    def step(
        self, function: Function, parameters: Sequence[Parameter], structs: Iterable[Struct], cost: str
    ) -> Step:
        """Return ``function`` with ``parameters``; ``structs`` are declared for it alone."""
        function = _with_floats(function)
        reads = {port: p.place(member) for p in parameters for port, member in p.reads.items()}
        names = {p.name for p in parameters}
        code = body(function, reads.__getitem__, self.style, kernels=self.kernels, reserved=names)
        texts = dict(zip((port.name for port in function.outputs), code.results, strict=True))
        results = [p for p in parameters if returned(p)]
        passed = [p for p in parameters if not returned(p)]
        arrow = f" -> {_together([p.type for p in results])}" if results else ""
        name = identifier(function.name)
        head = signature(f"pub fn {name}", [_declared(p) for p in passed], arrow)
        lines = (*code.statements, *_stored(passed, results, texts))
        docs = _docs(function, parameters, cost)
        return Step(function.name, name, tuple(parameters), docs, head, lines, tuple(structs), code.ops)

    def kernel(self, kernel: Function) -> Kernel:
        """Return a private function of numbers."""
        kernel = _with_floats(kernel)
        names = {port.name for port in kernel.inputs}
        code = body(kernel, identifier, self.style, kernels=self.kernels, reserved=names)
        own = self.kernels[kernel.name]
        if len(own.members) == 1:
            several, result = None, code.results[0]
        else:
            several = own.type, own.members
            pairs = zip(own.members, code.results, strict=True)
            fields = [member if member == text else f"{member}: {text}" for member, text in pairs]
            result = f"{own.type} {{ {', '.join(fields)} }}"
        parameters = [f"{identifier(port.name)}: {self.scalar}" for port in kernel.inputs]
        head = signature(f"fn {own.function}", parameters, f" -> {own.type}")
        comment = (doc(kernel.text),) if kernel.text else ()
        return Kernel(own.function, comment, head, (*code.statements, result), code.ops, several)


def _stored(passed: Sequence[Parameter], results: Sequence[Parameter], texts: Mapping[str, str]) -> list[str]:
    """Return the statements that change parameters and return results.

    Args:
        passed: Parameters of the function.
        results: What it returns.
        texts: Contract name of an output -> expression.

    Returns:
        Statements that compute every value before they change a parameter.
    """

    def value_of(p: Parameter) -> list[str]:
        if p.struct is None:
            return [texts[_port(p)]]
        return value(p.struct, {member: texts[port] for port, member in p.writes.items()}, p.name)

    changed = [p for p in passed if p.writes]
    values = _tuple_of([value_of(p) for p in results])
    if not changed:
        return values
    places = _tuple_of([[f"*{p.name}"] for p in changed])
    new = _tuple_of([value_of(p) for p in changed])
    assigned = [f"{''.join(places)} = {new[0]}", *new[1:]]
    assigned[-1] += ";"
    if not results:
        return assigned
    values[-1] += ";"
    return [f"let result = {values[0]}", *values[1:], *assigned, "result"]


def _tuple_of(values: Sequence[list[str]]) -> list[str]:
    """Return the lines of one value, or of a tuple of several."""
    if len(values) < 2:
        return values[0] if values else []
    if all(len(value) == 1 for value in values):
        return [f"({', '.join(value[0] for value in values)})"]
    lines = [line for value in values for line in (*value[:-1], f"{value[-1]},")]
    return ["(", *(f"    {line}" for line in lines), ")"]


def _docs(function: Function, parameters: Sequence[Parameter], cost: str) -> tuple[str, ...]:
    """Return the documentation: what ``function`` does, its scalars, and the members that it changes."""
    ports: dict[str, Port] = {port.name: port for port in (*function.inputs, *function.outputs)}
    items = []
    for p in parameters:
        if p.struct is None:
            port = ports[_port(p)]
            how, unit = "returned: " if returned(p) else "", f", {doc(port.unit)}" if port.unit else ""
            items.append(f"`{port.name}`: {how}{doc(port.text)}{unit}")
        elif p.writes and not returned(p):
            changed = ", ".join(f"`{member}`" for member in p.writes.values())
            items.append(f"`{p.name}`: changed in {changed}")
    paragraphs = [wrapped(text) for text in (sentence(function.text), cost) if text]
    paragraphs.insert(1, [line for item in items for line in wrapped(item, "* ")])
    return tuple(line for lines in paragraphs if lines for line in (*lines, ""))[:-1]
