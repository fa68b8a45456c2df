"""IR functions as C functions: their structs, prototypes, comments and bodies; and the kernels that they call."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache, partial

from wmrgen.codegen.c.records import Kernel, Parameter, Step
from wmrgen.codegen.c.text import Struct, block_comment, literal, prototype, struct
from wmrgen.codegen.expression import Body, Results, Style, body, results_of, written_out
from wmrgen.codegen.signature import IN, OUT, Argument, arguments, members
from wmrgen.ir.calls import called
from wmrgen.ir.nodes import Cost, Function, Module, Op, Role, places, pruned

_SHORT = 12  # statements: so few are repeated, not called
_NOTE = 60  # characters of a comment behind a statement
_MANY = 4  # outputs that are listed
_PLACE = re.compile(r"[\w.]+(?:->[\w.]+)*")  # a variable or a member


def _prepare_steps(module: Module, scalar: str, costs: Mapping[str, Cost]) -> tuple[Step, ...]:
    """``params_default`` and ``prepare``; nothing when nothing is tunable."""
    prepare = module.prepare
    if prepare is None or not prepare.outputs:
        return ()
    robot, cost = module.name, costs[prepare.name]
    advice = "Call once, and again after every change of a parameter."
    if prepare.inputs:
        advice += f" {robot}_prepare_checked() refuses parameters that are far from nominal."
    prepare = replace(prepare, text=f"{_sentence(prepare.text)} {advice}" if prepare.text else advice)
    note = f"What {robot}_prepare() works out once from the parameters; the steps only read it."
    texts, used = written_out(prepare), _used(module)
    formulas = zip(prepare.outputs, prepare.results, strict=True)
    outputs = tuple(replace(p, text=p.text or texts[r] or used.get(p.name, "")) for p, r in formulas)
    prepared = struct(f"{robot}_prepared", outputs, scalar, note)
    if not prepare.inputs:
        return (
            _step(prepare, f"{robot}_prepare", (_filled("prepared", prepared),), (prepared,), scalar, cost),
        )
    params = struct(f"{robot}_params", prepare.inputs, scalar, "Tunable parameters: calibrate, then prepare.")
    nominal = Step(
        f"{robot}_params_default",
        (params,),
        ("/** Sets the parameters to the nominal values of the robot file. */",),
        tuple(
            f"params->{params.members[port.name]} = {literal(port.default, scalar)};"
            for port in prepare.inputs
            if port.default is not None
        ),
        (_filled("params", params),),
    )
    parameters = (Parameter("params", params.name, params.members, {}), _filled("prepared", prepared))
    return nominal, _step(prepare, f"{robot}_prepare", parameters, (prepared,), scalar, cost)


def _used(module: Module) -> dict[str, str]:
    """Of each prepared number what the first function that reads it multiplies with it, and for which outputs."""
    used: dict[str, str] = {}
    for function in map(pruned, module.functions):
        nodes, texts = function.nodes, written_out(function)
        needs = [
            (p.name, places(nodes, [r])) for p, r in zip(function.outputs, function.results, strict=True)
        ]
        products = [node.args[:2] for node in nodes if node.op in (Op.MUL, Op.FMA)]
        for k, node in enumerate(nodes):
            if node.op is Op.INPUT and node.name:
                factors = {texts[a] for pair in products if k in pair for a in pair if a != k}
                one = factors.pop() if len(factors) == 1 else ""
                names = [name for name, needed in needs if k in needed]
                for_what = (
                    f"for {', '.join(names[:_MANY])}{', ...' * (len(names) > _MANY)} in {function.name}"
                )
                used.setdefault(node.name, f"factor of {one} {for_what}" if one else for_what)
    return used


def _filled(name: str, struct: Struct) -> Parameter:
    return Parameter(name, struct.name, {}, struct.members)


def shared_structs(module: Module, scalar: str) -> dict[str, Struct]:
    """The types that all functions share, by what `wmrgen.codegen.signature` calls them."""
    notes = {
        "pose": "Where P is and where the robot heads, in the world frame.",
        "twist": "How the robot moves: the velocity of P in the robot frame.",
        "pose_covariance": "Covariance of a pose: the upper triangle of a symmetric matrix.",
        "twist_covariance": "Covariance of a twist: the upper triangle of a symmetric matrix.",
        "wheels": "The joints that are driven or sensed: commands, measurements and present state alike.",
    }
    return {
        name: struct(f"{module.name}_{name}", ports, scalar, notes[name])
        for name, ports in members(module).items()
    }


def steps_of(
    module: Module, scalar: str, costs: Mapping[str, Cost], shared: Mapping[str, Struct]
) -> tuple[Step, ...]:
    """params_default and prepare where a parameter is tunable, then every function that has outputs."""
    steps = list(_prepare_steps(module, scalar, costs))
    prepared = steps[-1].structs[-1] if steps else None
    kernels = results_of(module.kernels, scalar, "wmrgen_{}".format)
    for function in (f for f in module.functions if f.outputs):
        name = f"{module.name}_{function.name}"
        parameters: list[Parameter] = []
        own: list[Struct] = []
        if prepared is not None and any(port.role is Role.PREPARED for port in function.inputs):
            parameters.append(Parameter("prepared", prepared.name, prepared.members, {}))
        for argument in arguments(function, module.joints):
            if argument.kind in (IN, OUT):
                own.append(_own_struct(function, name, argument.kind, argument, scalar))
            parameters.append(
                _parameter(argument, shared.get(argument.kind) or (own[-1] if own else None), scalar)
            )
        steps.append(_step(function, name, parameters, own, scalar, costs[function.name], kernels))
    by_name = {step.name: step for step in steps}
    for variant in module.functions:
        part, whole = (by_name.get(f"{module.name}_{name}") for name in (variant.variant_of, variant.name))
        if part is None or whole is None or not _computes(whole, part):
            continue
        if sum(not line.startswith("/*") for line in part.lines) > _SHORT:
            by_name[part.name] = part._replace(small=_taken_from(whole, part))
    return tuple(by_name.values())


def _computes(whole: Step, part: Step) -> bool:
    """Whether ``whole`` gives all that ``part`` gives, from the same inputs: to the bit, for one is a variant of the
    other."""
    return whole.inputs == part.inputs and part.outputs.items() <= whole.outputs.items()


def _taken_from(whole: Step, part: Step) -> tuple[str, ...]:
    """The statements of ``part`` that take its results from ``whole``; the others are read by nobody."""
    own = {p.name for p in part.parameters}
    others = [p for p in whole.parameters if p.name not in own]
    passed = ", ".join(f"{'' if p.name in own else '&'}{p.name}" for p in whole.parameters)
    declared = (f"{p.type} {p.name};" for p in others)
    return (*declared, f"{whole.name}({passed});")


def _own_struct(function: Function, name: str, kind: str, argument: Argument, scalar: str) -> Struct:
    """What one function alone takes or gives."""
    ports = function.inputs if kind == IN else function.outputs
    carried = argument.reads if kind == IN else argument.writes
    note = f"{'Input' if kind == IN else 'Output'} of {name}()."
    return struct(f"{name}_{kind}", tuple(port for port in ports if port.name in carried), scalar, note)


def _parameter(argument: Argument, struct: Struct | None, scalar: str) -> Parameter:
    """``struct``: the type of ``argument`` where it is no scalar."""
    if not argument.kind or struct is None:
        return Parameter(
            argument.name, scalar, dict.fromkeys(argument.reads, ""), dict.fromkeys(argument.writes, "")
        )
    reads, writes = (
        {name: struct.members[member] for name, member in ports.items()}
        for ports in (argument.reads, argument.writes)
    )
    return Parameter(argument.name, struct.name, reads, writes)


def _step(
    function: Function,
    name: str,
    parameters: Sequence[Parameter],
    own: Sequence[Struct],
    scalar: str,
    cost: Cost,
    kernels: Mapping[str, Results] | None = None,
) -> Step:
    """``own``: the structs that are declared for it. ``kernels``: what it may call."""
    function = pruned(function)
    reads = {port: p.within(member) for p in parameters for port, member in p.reads.items()}
    writes = {port: p.within(member) for p in parameters for port, member in p.writes.items()}
    quantities: dict[int, list[str]] = {}
    for each in function.named:
        if each.quantity:
            quantities.setdefault(each.node, []).append(each.quantity)
    notes = {k: ", ".join(texts) for k, texts in quantities.items()}
    notes = {k: f"/* {note} */" for k, note in notes.items() if len(note) <= _NOTE}
    parameters_of = {p.name for p in parameters}

    def printed(access: Mapping[str, str]) -> Body:
        return body(function, access.__getitem__, _style(scalar), notes, kernels, reserved=parameters_of)

    code = printed(reads)
    early = _overwritten(parameters, code.results, [port.name for port in function.outputs])
    if early:
        copies = {port: f"{port.replace('.', '_')}_before" for port in early}
        code = printed({**reads, **copies})
    read = {node.name for node in function.nodes if node.op is Op.INPUT}
    lines = [f"(void){p.name};" for p in parameters if not p.writes and not read & set(p.reads)]
    lines += [f"const {scalar} {port.replace('.', '_')}_before = {reads[port]};" for port in early]
    lines += code.statements
    lines += [""] if lines else []
    lines += [
        f"{writes[port.name]} = {text};" for port, text in zip(function.outputs, code.results, strict=True)
    ]
    spent = [f"Operations of the formula: {cost}."] if str(cost) != "none" else []
    comment = block_comment([_sentence(function.text), *spent], doxygen=True)
    return Step(name, tuple(own), tuple(comment), tuple(lines), tuple(parameters), code.ops)


def _overwritten(
    parameters: Sequence[Parameter], results: Sequence[str], outputs: Sequence[str]
) -> list[str]:
    """The inputs that a result reads after another has been stored in their place, where a caller passes one variable
    for several parameters of a type."""
    stored = {name: (p.type, member) for p in parameters for name, member in p.writes.items() if member}
    inputs = [(name, p, member) for p in parameters for name, member in p.reads.items() if member]
    early: dict[str, None] = {}
    overwritten: set[tuple[str, str]] = set()
    for output, text in zip(outputs, results, strict=True):
        read = set(_PLACE.findall(text))
        for name, p, member in inputs:
            if (p.type, member) in overwritten and p.within(member) in read:
                early[name] = None
        if output in stored:
            overwritten.add(stored[output])
    return list(early)


@cache
def _style(scalar: str) -> Style:
    """How C writes operations in ``scalar``: ``float`` (libm names end in f) or ``double``."""
    suffix = "f" if scalar == "float" else ""
    return Style(
        literal=partial(literal, scalar=scalar),
        form=lambda op: type(op.c)(op.c.replace("{f}", suffix)),
        declare="const {2} {0} = {1};",
        temporary="t{0}",
        grouped=True,
        scalar=scalar,
    )


def _sentence(text: str) -> str:
    """``text`` with a capital and a full stop."""
    if not text:
        return "Straight-line code."
    return text[:1].upper() + text[1:] + ("" if text.endswith(".") else ".")


# ---- kernels


def printed_kernels(module: Module, scalar: str) -> tuple[Kernel, ...]:
    """The kernels of ``module``, those that are called before those that call.

    One that a single function calls, at one place, stands there whatever the user's build asks for: a call only costs.
    """
    results = results_of(module.kernels, scalar, "wmrgen_{}".format)
    calls = Counter(n.name for f in module.functions for n in f.nodes if n.op is Op.CALL)
    inner = called(module.kernels)
    once = {name for name, count in calls.items() if count == 1 and name not in inner}
    return tuple(_kernel(kernel, scalar, results, kernel.name in once) for kernel in module.kernels)


def _kernel(kernel: Function, scalar: str, results: Mapping[str, Results], once: bool) -> Kernel:
    reserved = {"result", *(port.name for port in kernel.inputs)}
    code = body(kernel, str, _style(scalar), kernels=results, apart=_shared(kernel), reserved=reserved)
    own = results[kernel.name]
    lines = [*code.statements, *([""] if code.statements else [])]
    several = None
    if len(own.members) == 1:
        lines.append(f"return {code.results[0]};")
    else:
        several = own.type, own.members
        lines = [f"{own.type} result;", *lines]
        lines += [f"result.{m} = {text};" for m, text in zip(own.members, code.results, strict=True)]
        lines.append("return result;")
    parameters = [f"{scalar} {port.name}" for port in kernel.inputs]
    linkage = "WMRGEN_ONCE" if once else "WMRGEN_KERNEL"
    head = prototype(f"{linkage} {own.type} {own.function}", parameters, ", ")
    comment = tuple(block_comment([kernel.text]))
    return Kernel(own.function.upper(), comment, head, tuple(lines), code.ops, several)


def _shared(kernel: Function) -> set[int]:
    """Sizes and signs of inputs: calls have inputs in common, and a compiler shares what no choice depends on."""
    nodes = kernel.nodes
    return {
        k
        for k, node in enumerate(nodes)
        if node.op in (Op.ABS, Op.WITH_SIGN_OF)
        and all(nodes[a].op in (Op.INPUT, Op.CONST) for a in node.args)
    }
