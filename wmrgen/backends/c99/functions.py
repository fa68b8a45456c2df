"""IR functions as C functions: their structs, prototypes, comments and bodies; and the kernels that they call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from wmrgen.backends.c99.style import style
from wmrgen.backends.c99.text import WIDTH, Struct, alias, block_comment, literal, struct
from wmrgen.backends.expression import Results, body
from wmrgen.backends.quantities import quantity
from wmrgen.ir.cost import Cost
from wmrgen.ir.nodes import Function, Module, Op, Port, Role
from wmrgen.ir.prune import places, prune

_RESERVED = ("in", "out", "params", "prepared")  # parameters of the functions
_NOTE = 60  # characters of a comment behind a statement


@dataclass(frozen=True, slots=True)
class Step:
    """A C function, ready to print. ``arguments``: (struct, parameter name) in order of the prototype."""

    name: str
    structs: tuple[Struct, ...]
    comment: tuple[str, ...]
    prototype: str
    lines: tuple[str, ...]
    arguments: tuple[tuple[Struct, str], ...]
    ops: frozenset[Op] = frozenset()


def _prototype(name: str, arguments: tuple[tuple[Struct, str], ...], out: str) -> str:
    parts = [f"{'' if p == out else 'const '}{s.name} *{p}" for s, p in arguments]
    line = f"void {name}({', '.join(parts)})"
    if len(line) < WIDTH:
        return line
    return f"void {name}(\n    " + ",\n    ".join(parts) + ")"


def _sentence(text: str) -> str:
    """``text`` with a capital and a full stop."""
    return (
        text[:1].upper() + text[1:] + ("" if text.endswith(".") else ".") if text else "Straight-line code."
    )


def _pruned(function: Function) -> Function:
    nodes, results = prune(function.nodes, function.results)
    place = places(function.nodes, function.results)
    named = tuple((name, place[k]) for name, k in function.named if k in place)
    return replace(function, nodes=nodes, results=results, named=named)


def _names(function: Function) -> dict[int, str]:
    """What nodes are called: as the formula calls them; what a kernel gives for a wheel, as the wheel."""
    nodes, found, taken = function.nodes, dict[int, str](), set(_RESERVED)

    def call(k: int, name: str) -> None:
        if k not in found and name not in taken:
            found[k] = name
            taken.add(name)

    for label, k in function.named:
        call(k, label)
    several = {node.args[0] for node in nodes if node.op is Op.RESULT}
    for k, node in enumerate(nodes):
        joints = (nodes[a].name or "" for a in node.args) if k in several else ()
        for wheel, dot, _ in (joint.partition(".") for joint in joints):
            if dot:
                call(k, wheel)
                call(k, f"{wheel}_{node.name}")
    return found


def _build(
    function: Function,
    name: str,
    inputs: tuple[tuple[Struct, str], ...],
    output: tuple[Struct, str],
    own: tuple[Struct, ...],
    scalar: str,
    cost: Cost,
    kernels: Mapping[str, Results] | None = None,
) -> Step:
    function = _pruned(function)
    reads = {key: f"{par}->{member}" for s, par in inputs for key, member in s.members.items()}
    notes: dict[int, str] = {}
    for label, k in function.named:
        notes[k] = f"{notes[k]}, {quantity(label)}" if k in notes else quantity(label)
    out_struct, out = output
    places = [f"{out}->{out_struct.members[port.name]}" for port in function.outputs]
    code = body(
        function,
        reads.__getitem__,
        style(scalar),
        {k: f"/* {note} */" for k, note in notes.items() if len(note) <= _NOTE},
        kernels,
        _names(function),
    )
    read = {node.name for node in function.nodes if node.op is Op.INPUT}
    unread = [f"(void){par};" for s, par in inputs if not read & set(s.members)]
    lines = unread + list(code.statements)
    stores = [f"{place} = {text};" for place, text in zip(places, code.results, strict=True)]
    lines += ([""] if lines else []) + stores
    arguments = (*inputs, output)
    comment = tuple(block_comment([_sentence(function.text), f"Operations of the formula: {cost}."]))
    return Step(
        name,
        own,
        comment,
        _prototype(name, arguments, out),
        tuple(lines),
        arguments,
        code.ops,
    )


def prepare_steps(
    module: Module, scalar: str, costs: Mapping[str, Cost]
) -> tuple[tuple[Step, ...], Struct | None]:
    """``params_default`` and ``prepare``, and the struct they fill; nothing when nothing is tunable."""
    prepare = module.prepare
    if prepare is None or not prepare.outputs:
        return (), None
    robot = module.name
    advice = "Call once, and again after every change of a parameter."
    prepare = replace(prepare, text=f"{_sentence(prepare.text)} {advice}" if prepare.text else advice)
    prepared = struct(
        f"{robot}_prepared",
        prepare.outputs,
        scalar,
        f"What {robot}_prepare() works out once from the parameters; the steps only read it.",
    )
    if not prepare.inputs:
        step = _build(
            prepare, f"{robot}_prepare", (), (prepared, "prepared"), (prepared,), scalar, costs[prepare.name]
        )
        return (step,), prepared
    params = struct(f"{robot}_params", prepare.inputs, scalar, "Tunable parameters: calibrate, then prepare.")
    nominal = tuple(
        f"params->{params.members[port.name]} = {literal(port.default, scalar)};"
        for port in prepare.inputs
        if port.default is not None
    )
    first = Step(
        f"{robot}_params_default",
        (params,),
        ("/* Sets the parameters to the nominal values of the robot file. */",),
        f"void {robot}_params_default({params.name} *params)",
        nominal,
        ((params, "params"),),
    )
    second = _build(
        prepare,
        f"{robot}_prepare",
        ((params, "params"),),
        (prepared, "prepared"),
        (prepared,),
        scalar,
        costs[prepare.name],
    )
    return (first, second), prepared


def step(
    function: Function,
    robot: str,
    prepared: Struct | None,
    scalar: str,
    cost: Cost,
    inputs_of: dict[tuple[Port, ...], Struct],
    kernels: Mapping[str, Results],
) -> Step | None:
    """``<robot>_<function>``; None for a function without outputs.

    ``inputs_of``: the input structs so far. What gives the slip of another function takes that one's input.
    ``kernels``: what it may call.
    """
    if not function.outputs:
        return None
    name = f"{robot}_{function.name}"
    inputs: list[tuple[Struct, str]] = []
    if prepared is not None and any(port.role is Role.PREPARED for port in function.inputs):
        inputs.append((prepared, "prepared"))
    contract = tuple(port for port in function.inputs if port.role in (Role.STATE, Role.COMMAND))
    own: list[Struct] = []
    if contract:
        same = inputs_of.get(contract) if function.variant_of else None
        if same is None:
            own.append(struct(f"{name}_in", contract, scalar, f"Input of {name}()."))
            inputs_of.setdefault(contract, own[-1])
        else:
            own.append(alias(f"{name}_in", same))
        inputs.append((own[-1], "in"))
    own.append(struct(f"{name}_out", function.outputs, scalar, f"Output of {name}()."))
    return _build(function, name, tuple(inputs), (own[-1], "out"), tuple(own), scalar, cost, kernels)


PREFIX = "wmrgen_"
_TYPES: dict[tuple[str, ...], str] = {
    ("x", "y"): "vector",
    ("spin", "steer"): "wheel",
}  # of results; other kernels have one that is called as they are


@dataclass(frozen=True, slots=True)
class Kernel:
    """A static function, ready to print. ``struct``: (type, members) of its results where there are several."""

    guard: str
    comment: tuple[str, ...]
    prototype: str
    lines: tuple[str, ...]
    ops: frozenset[Op]
    struct: tuple[str, tuple[str, ...]] | None = None


def results_of(kernels: Sequence[Function], scalar: str) -> dict[str, Results]:
    """How the results of each kernel are named in C."""
    found = {}
    for kernel in kernels:
        members = tuple(port.name for port in kernel.outputs)
        kind = scalar if len(members) == 1 else _type(kernel)
        found[kernel.name] = Results(PREFIX + kernel.name, kind, members)
    return found


def printed_kernels(kernels: Sequence[Function], scalar: str) -> tuple[Kernel, ...]:
    """``kernels``, those that are called before those that call."""
    results = results_of(kernels, scalar)
    return tuple(_kernel(kernel, scalar, results) for kernel in kernels)


def _type(kernel: Function) -> str:
    members = tuple(port.name for port in kernel.outputs)
    return PREFIX + _TYPES.get(members, f"{kernel.name}_result")


def _kernel(kernel: Function, scalar: str, results: Mapping[str, Results]) -> Kernel:
    code = body(
        kernel, str, style(scalar), kernels=results, names=_kernel_names(kernel), apart=_shared(kernel)
    )
    own = results[kernel.name]
    lines = [*code.statements, *([""] if code.statements else [])]
    struct = None
    if len(own.members) == 1:
        lines.append(f"return {code.results[0]};")
    else:
        struct = own.type, own.members
        lines = [f"{own.type} result;", *lines]
        lines += [f"result.{m} = {text};" for m, text in zip(own.members, code.results, strict=True)]
        lines.append("return result;")
    parameters = [f"{scalar} {port.name}" for port in kernel.inputs]
    return Kernel(
        own.function.upper(),
        tuple(block_comment([kernel.text])),
        _kernel_prototype(own.type, own.function, parameters),
        tuple(lines),
        code.ops,
        struct,
    )


def _kernel_names(kernel: Function) -> dict[int, str]:
    """Nodes as the formula calls them, but for names of parameters."""
    taken = {"result", *(port.name for port in kernel.inputs)}
    names = {k: name for name, k in reversed(kernel.named) if name not in taken}
    return names if len(set(names.values())) == len(names) else {}


def _shared(kernel: Function) -> set[int]:
    """Sizes and signs of inputs: calls have inputs in common, and a compiler shares what no choice depends on."""
    nodes = kernel.nodes
    return {
        k
        for k, node in enumerate(nodes)
        if node.op in (Op.ABS, Op.WITH_SIGN_OF)
        and all(nodes[a].op in (Op.INPUT, Op.CONST) for a in node.args)
    }


def _kernel_prototype(kind: str, name: str, parameters: Sequence[str]) -> str:
    head = f"WMRGEN_KERNEL {kind} {name}("
    line = f"{head}{', '.join(parameters)})"
    return line if len(line) < WIDTH else head + "\n    " + ", ".join(parameters) + ")"
