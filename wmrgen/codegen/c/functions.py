"""Functions as C: their structs, prototypes, comments and bodies; the kernels that they call, and calls of them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import NamedTuple

from wmrgen.codegen.c.text import block_comment, literal, prototype, struct
from wmrgen.codegen.expression import Body, Results, Style, body, results_of, written_out
from wmrgen.codegen.signature import IN, PARAMS, PREPARED, Signature, members, signatures
from wmrgen.codegen.unit import Kernel, Parameter, Step, Struct, parameter
from wmrgen.ir.calls import called
from wmrgen.ir.nodes import Cost, Function, Module, Op, places, pruned

_SHORT = 12  # statements: a body that short is repeated, because a call would save no flash
_MANY = 4  # outputs that a comment lists; it ends in "..." if there are more
_PLACE = re.compile(r"[\w.]+(?:->[\w.]+)*")  # a variable or a member

_SHARED_TEXTS = {
    "pose": "Position of P and heading of the robot, in the world frame.",
    "twist": "Velocity of P and yaw rate, in the robot frame.",
    "pose_covariance": "Covariance of a pose: the upper triangle of a symmetric matrix.",
    "twist_covariance": "Covariance of a twist: the upper triangle of a symmetric matrix.",
    "wheels": "Joints that are driven or sensed. Commands, measurements and the present state have this type.",
}


# ---- parameters and calls


def declared(parameters: Sequence[Parameter]) -> list[str]:
    """Return the parameters as a prototype declares them."""
    return [_declared(p) for p in parameters] or ["void"]


def _declared(p: Parameter) -> str:
    if p.by_value:
        return f"{p.type} {p.name}"
    return f"{'' if p.writes else 'const '}{p.type} *{p.name}"


def access(p: Parameter, member: str) -> str:
    """Return a member of a parameter as the body of the function writes it: ``twist->vx``."""
    if member:
        return f"{p.name}->{member}"
    return p.name if p.by_value else f"*{p.name}"


def call(step: Step, variables: Mapping[str, str] | None = None, suffix: str = "") -> str:
    """Return a call of ``step``.

    Args:
        step: The function.
        variables: Name of a parameter -> variable, for those with another name than the parameter.
        suffix: Appended to the name of the function: ``_checked``.
    """
    names = variables or {}
    passed = (("" if p.by_value else "&") + names.get(p.name, p.name) for p in step.parameters)
    return f"{step.name}{suffix}({', '.join(passed)})"


# ---- structs


def shared_structs(module: Module) -> dict[str, Struct]:
    """Return the types that all functions share, by the names of `wmrgen.codegen.signature`."""
    return {
        kind: struct(f"{module.name}_{kind}", ports, _SHARED_TEXTS[kind])
        for kind, ports in members(module).items()
    }


def _own_structs(signature: Signature, name: str) -> dict[str, Struct]:
    """Return the structs of the inputs and outputs that only one function has."""
    return {
        kind: struct(f"{name}_{kind}", ports, f"{'Input' if kind == IN else 'Output'} of {name}().")
        for kind, ports in signature.own_types.items()
    }


def _structs_of_prepare(signature: Signature, module: Module) -> dict[str, Struct]:
    """Return the structs of the tunable parameters, if there are any, and of what `prepare` computes."""
    robot, structs = module.name, {}
    ports = dict(signature.own_types)
    if PARAMS in ports:
        text = f"Tunable parameters. After a change call {robot}_prepare()."
        structs[PARAMS] = struct(f"{robot}_params", ports[PARAMS], text)
    texts, used = written_out(signature.function), _used(module)
    outputs = []
    for port, result in zip(ports[PREPARED], signature.function.results, strict=True):
        outputs.append(replace(port, text=port.text or texts[result] or used.get(port.name, "")))
    text = f"Values that {robot}_prepare() computes once from the parameters. The other functions only read them."
    structs[PREPARED] = struct(f"{robot}_prepared", outputs, text)
    return structs


def _used(module: Module) -> dict[str, str]:
    """Return for each prepared number its factor in the first function that reads it, and the outputs that need it."""
    used: dict[str, str] = {}
    for function in map(pruned, module.functions):
        nodes, texts = function.nodes, written_out(function)
        needs = []
        for port, result in zip(function.outputs, function.results, strict=True):
            needs.append((port.name, places(nodes, [result])))
        products = [node.args[:2] for node in nodes if node.op in (Op.MUL, Op.FMA)]
        for k, node in enumerate(nodes):
            if node.op is not Op.INPUT or not node.name:
                continue
            names = [name for name, needed in needs if k in needed]
            listed = ", ".join(names[:_MANY]) + ", ..." * (len(names) > _MANY)
            purpose = f"for {listed} in {function.name}"
            factors = {texts[a] for pair in products if k in pair for a in pair if a != k}
            factor = factors.pop() if len(factors) == 1 else ""
            used.setdefault(node.name, f"factor of {factor} {purpose}" if factor else purpose)
    return used


# ---- steps


def steps_of(
    module: Module, scalar: str, costs: Mapping[str, Cost], shared: Mapping[str, Struct]
) -> tuple[Step, ...]:
    """Return the C functions of a robot.

    Args:
        module: Its functions.
        scalar: ``float`` or ``double``.
        costs: Operations of the formula of each function, for comments.
        shared: Types that the functions share.

    Returns:
        params_default and prepare if a parameter is tunable, then every function that has outputs.
    """
    printer = _Printer(scalar, results_of(module.kernels, scalar, "wmrgen_{}".format))
    types, steps = dict(shared), list[Step]()
    for signature in signatures(module):
        function = signature.function
        name = f"{module.name}_{function.name}"
        if function is module.prepare:
            own = _structs_of_prepare(signature, module)
            types |= own
            function = replace(function, text=_text_of_prepare(function, module.name))
            if PARAMS in own:
                steps.append(_params_default(module.name, own[PARAMS], scalar))
        else:
            own = _own_structs(signature, name)
        found = types | own
        parameters = [parameter(a, a.name, found.get(a.kind), scalar) for a in signature.arguments]
        steps.append(printer.step(function, name, parameters, own.values(), costs[function.name]))
    return _with_small_bodies(module, steps)


def _text_of_prepare(prepare: Function, robot: str) -> str:
    advice = "Call it once, and again after every change of a parameter."
    if prepare.inputs:
        advice += f" {robot}_prepare_checked() rejects parameters that are far from nominal."
    return f"{_sentence(prepare.text)} {advice}" if prepare.text else advice


def _params_default(robot: str, params: Struct, scalar: str) -> Step:
    """Return the function that sets the tunable parameters to their nominal values."""
    name = f"{robot}_params_default"
    target = Parameter(PARAMS, params.name, {}, params.members, params)
    lines = [
        f"{access(target, params.members[port.name])} = {literal(port.default, scalar)};"
        for port in params.ports
        if port.default is not None
    ]
    comment = ("/** Sets the parameters to the nominal values of the robot file. */",)
    head = (prototype(f"void {name}", declared([target])),)
    return Step("params_default", name, (target,), comment, head, tuple(lines))


def _with_small_bodies(module: Module, steps: Sequence[Step]) -> tuple[Step, ...]:
    """Add a second body, for least flash, to long steps whose results a variant computes too: a call of the variant."""
    by_function = {step.function: step for step in steps}
    for variant in module.functions:
        part, whole = by_function.get(variant.variant_of), by_function.get(variant.name)
        if part is None or whole is None or not _computes(whole, part):
            continue
        if sum(not line.startswith("/*") for line in part.lines) > _SHORT:
            by_function[part.function] = part._replace(small=_taken_from(whole, part))
    return tuple(by_function.values())


def _computes(whole: Step, part: Step) -> bool:
    """Return whether ``whole`` gives all outputs of ``part`` from the same inputs.

    They are equal bit for bit, because one function is a variant of the other.
    """
    return whole.inputs == part.inputs and part.outputs.items() <= whole.outputs.items()


def _taken_from(whole: Step, part: Step) -> tuple[str, ...]:
    """Return the statements that compute the results of ``part`` by a call of ``whole``."""
    own = {p.name for p in part.parameters}
    unused = [p for p in whole.parameters if p.name not in own]
    passed = ", ".join(f"{'' if p.name in own else '&'}{p.name}" for p in whole.parameters)
    variables = (f"{p.type} {p.name};" for p in unused)
    return (*variables, f"{whole.name}({passed});")


class _Printer(NamedTuple):
    scalar: str
    kernels: Mapping[str, Results]  # kernels that may be called, by name

    def step(
        self,
        function: Function,
        name: str,
        parameters: Sequence[Parameter],
        structs: Iterable[Struct],
        cost: Cost,
    ) -> Step:
        """Return ``function`` as the C function ``name``, for which ``structs`` are declared."""
        function = pruned(function)
        reads = {port: access(p, member) for p in parameters for port, member in p.reads.items()}
        writes = {port: access(p, member) for p in parameters for port, member in p.writes.items()}
        code = self.body(function, reads, parameters)
        early = _overwritten(parameters, code.results, [port.name for port in function.outputs])
        if early:
            copies = {port: f"{port.replace('.', '_')}_before" for port in early}
            code = self.body(function, {**reads, **copies}, parameters)
        read = {node.name for node in function.nodes if node.op is Op.INPUT}
        lines = [f"(void){p.name};" for p in parameters if not p.writes and not read & set(p.reads)]
        lines += [f"const {self.scalar} {port.replace('.', '_')}_before = {reads[port]};" for port in early]
        lines += code.statements
        lines += [""] if lines else []
        for port, text in zip(function.outputs, code.results, strict=True):
            lines.append(f"{writes[port.name]} = {text};")
        paragraphs = [_sentence(function.text)]
        if str(cost) != "none":
            paragraphs.append(f"Operations of the formula: {cost}.")
        return Step(
            function.name,
            name,
            tuple(parameters),
            tuple(block_comment(paragraphs, doxygen=True)),
            (prototype(f"void {name}", declared(parameters)),),
            tuple(lines),
            tuple(structs),
            code.ops,
        )

    def body(self, function: Function, reads: Mapping[str, str], parameters: Sequence[Parameter]) -> Body:
        """Return the statements of ``function``; ``reads``: contract name of an input -> the C that reads it."""
        names = {p.name for p in parameters}
        notes = _quantities(function)
        return body(function, reads.__getitem__, _style(self.scalar), notes, self.kernels, reserved=names)


def _quantities(function: Function) -> dict[int, str]:
    """Return comments with the names that the report gives to intermediate results, by node."""
    quantities: dict[int, list[str]] = {}
    for each in function.named:
        if each.quantity:
            quantities.setdefault(each.node, []).append(each.quantity)
    notes = {node: ", ".join(texts) for node, texts in quantities.items()}
    # A comment of more than 60 characters would not fit on the line of a statement.
    return {node: f"/* {note} */" for node, note in notes.items() if len(note) <= 60}


def _overwritten(
    parameters: Sequence[Parameter], results: Sequence[str], outputs: Sequence[str]
) -> list[str]:
    """Return the inputs that must be copied before results are stored.

    A caller may pass one variable for several parameters of a type. A result that reads such an input after another
    result was stored in its place would then be wrong.
    """
    stored = {name: (p.type, member) for p in parameters for name, member in p.writes.items() if member}
    inputs = [(name, p, member) for p in parameters for name, member in p.reads.items() if member]
    early: dict[str, None] = {}
    overwritten: set[tuple[str, str]] = set()
    for output, text in zip(outputs, results, strict=True):
        read = set(_PLACE.findall(text))
        for name, p, member in inputs:
            if (p.type, member) in overwritten and access(p, member) in read:
                early[name] = None
        if output in stored:
            overwritten.add(stored[output])
    return list(early)


@cache
def _style(scalar: str) -> Style:
    """Return how C writes operations in ``scalar``: ``float`` (names of libm end in f) or ``double``."""
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
    """Return ``text`` with a capital and a full stop."""
    if not text:
        return "Straight-line code."
    return text[:1].upper() + text[1:] + ("" if text.endswith(".") else ".")


# ---- kernels


def printed_kernels(module: Module, scalar: str) -> tuple[Kernel, ...]:
    """Return the kernels of ``module``; a kernel comes before those that call it.

    A kernel that is called in one place only is always inlined, because a call would cost time and save no flash.
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
    return Kernel(own.function, comment, (head,), tuple(lines), code.ops, several)


def _shared(kernel: Function) -> set[int]:
    """Return the magnitudes and signs of inputs, which get their own statements.

    Several calls have inputs in common. A compiler shares what they compute only if it does not depend on a choice.
    """
    nodes = kernel.nodes
    given = {k for k, node in enumerate(nodes) if node.op in (Op.INPUT, Op.CONST)}
    return {
        k
        for k, node in enumerate(nodes)
        if node.op in (Op.ABS, Op.WITH_SIGN_OF) and given.issuperset(node.args)
    }
