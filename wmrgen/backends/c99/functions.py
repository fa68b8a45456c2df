"""IR functions as C functions: their structs, prototypes, comments and bodies; and the kernels that they call."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial

from wmrgen.backends.c99.text import Struct, alias, block_comment, literal, prototype, struct
from wmrgen.backends.c99.trace import quantity
from wmrgen.backends.expression import Results, Style, body
from wmrgen.ir.calls import called
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Cost, Function, Module, Op, Port, Role, pruned

_RESERVED = ("in", "out", "params", "prepared")  # parameters of the functions
_NOTE = 60  # characters of a comment behind a statement
_PREFIX = "wmrgen_"  # of kernels and their types
# Types of results; a kernel with others has one that is called as it is.
_TYPES: dict[tuple[str, ...], str] = {("x", "y"): "vector", ("spin", "steer"): "wheel"}


@dataclass(frozen=True, slots=True)
class Step:
    """A C function, ready to print. ``arguments``: parameter -> its struct, in order; the last is filled."""

    name: str
    structs: tuple[Struct, ...]
    comment: tuple[str, ...]
    lines: tuple[str, ...]
    arguments: Mapping[str, Struct]
    ops: frozenset[Op] = frozenset()

    @property
    def parameters(self) -> list[str]:
        """As a prototype declares them."""
        *inputs, _ = self.arguments
        return [f"{'const ' if p in inputs else ''}{s.name} *{p}" for p, s in self.arguments.items()]

    @property
    def prototype(self) -> str:
        """Its declaration, without a semicolon."""
        return prototype(f"void {self.name}", self.parameters)

    def call(self, variables: Mapping[str, str] | None = None) -> str:
        """A call with variables that are called as the parameters, or as ``variables`` says."""
        passed = (f"&{(variables or {}).get(parameter, parameter)}" for parameter in self.arguments)
        return f"{self.name}({', '.join(passed)})"


@dataclass(frozen=True, slots=True)
class Kernel:
    """A static function, ready to print. ``struct``: (type, members) of its results where there are several."""

    guard: str
    comment: tuple[str, ...]
    prototype: str
    lines: tuple[str, ...]
    ops: frozenset[Op]
    struct: tuple[str, tuple[str, ...]] | None = None


@dataclass(frozen=True, slots=True)
class Unit:
    """All C functions of a robot, in the order they are printed.

    ``rounds``: they rely on the rounding of sums of magic numbers. ``written``: operations of the functions before
    kernels were put in.
    """

    robot: str
    choice: Choice
    steps: tuple[Step, ...]
    kernels: tuple[Kernel, ...]
    rounds: bool
    written: frozenset[Op]

    @property
    def ops(self) -> frozenset[Op]:
        """The operations that are printed."""
        return frozenset().union(*(step.ops for step in self.steps), *(kernel.ops for kernel in self.kernels))

    @property
    def contract(self) -> dict[str, Step]:
        """By name of the robot's function: all but params_default and prepare."""
        named = {step.name.removeprefix(f"{self.robot}_"): step for step in self.steps}
        return {name: step for name, step in named.items() if name not in ("params_default", "prepare")}

    def variables(self, step: Step) -> dict[str, Struct]:
        """The variables that a call of ``step`` takes, and what is called before it."""
        return {p: s for called in (step, *self.before([step])) for p, s in called.arguments.items()}

    def inputs(self, step: Step) -> dict[str, str]:
        """Contract name -> variable and member, of the inputs of ``step``; the tunables are the last."""
        variables = self.variables(step)
        parameters = (p for p in ("in", "params") if p in variables)
        return {name: f"{p}.{member}" for p in parameters for name, member in variables[p].members.items()}

    def before(self, steps: Iterable[Step]) -> tuple[Step, ...]:
        """What has to be called before ``steps``: params_default and prepare, where one reads what prepare gives."""
        if not any("prepared" in step.arguments for step in steps):
            return ()
        return tuple(step for step in self.steps if "out" not in step.arguments)


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
    prepared = struct(f"{robot}_prepared", prepare.outputs, scalar, note)
    if not prepare.inputs:
        return (_step(prepare, f"{robot}_prepare", {"prepared": prepared}, (prepared,), scalar, cost),)
    params = struct(f"{robot}_params", prepare.inputs, scalar, "Tunable parameters: calibrate, then prepare.")
    nominal = Step(
        f"{robot}_params_default",
        (params,),
        ("/* Sets the parameters to the nominal values of the robot file. */",),
        tuple(
            f"params->{params.members[port.name]} = {literal(port.default, scalar)};"
            for port in prepare.inputs
            if port.default is not None
        ),
        {"params": params},
    )
    arguments = {"params": params, "prepared": prepared}
    return nominal, _step(prepare, f"{robot}_prepare", arguments, (prepared,), scalar, cost)


def steps_of(module: Module, scalar: str, costs: Mapping[str, Cost]) -> tuple[Step, ...]:
    """params_default and prepare where a parameter is tunable, then every function that has outputs."""
    steps = list(_prepare_steps(module, scalar, costs))
    prepared = steps[-1].arguments["prepared"] if steps else None
    kernels = _results_of(module.kernels, scalar)
    inputs_of: dict[tuple[Port, ...], Struct] = {}  # what gives the slip of a function takes that one's input
    for function in (f for f in module.functions if f.outputs):
        name = f"{module.name}_{function.name}"
        arguments: dict[str, Struct] = {}
        own: list[Struct] = []
        if prepared is not None and any(port.role is Role.PREPARED for port in function.inputs):
            arguments["prepared"] = prepared
        ports = tuple(port for port in function.inputs if port.role in (Role.STATE, Role.COMMAND))
        if ports:
            same = inputs_of.get(ports) if function.variant_of else None
            if same is None:
                own.append(struct(f"{name}_in", ports, scalar, f"Input of {name}()."))
                inputs_of.setdefault(ports, own[-1])
            else:
                own.append(alias(f"{name}_in", same))
            arguments["in"] = own[-1]
        own.append(struct(f"{name}_out", function.outputs, scalar, f"Output of {name}()."))
        arguments["out"] = own[-1]
        steps.append(_step(function, name, arguments, own, scalar, costs[function.name], kernels))
    return tuple(steps)


def _step(
    function: Function,
    name: str,
    arguments: Mapping[str, Struct],
    own: Sequence[Struct],
    scalar: str,
    cost: Cost,
    kernels: Mapping[str, Results] | None = None,
) -> Step:
    """``own``: the structs that are declared for it. ``kernels``: what it may call."""
    function = pruned(function)
    *inputs, out = arguments
    reads = {key: f"{p}->{member}" for p in inputs for key, member in arguments[p].members.items()}
    quantities: dict[int, list[str]] = {}
    for label, k in function.named:
        quantities.setdefault(k, []).append(quantity(label))
    notes = {k: ", ".join(texts) for k, texts in quantities.items()}
    notes = {k: f"/* {note} */" for k, note in notes.items() if len(note) <= _NOTE}
    code = body(function, reads.__getitem__, _style(scalar), notes, kernels, _names(function))
    read = {node.name for node in function.nodes if node.op is Op.INPUT}
    lines = [f"(void){p};" for p in inputs if not read & set(arguments[p].members)]
    lines += code.statements
    lines += [""] if lines else []
    lines += [
        f"{out}->{arguments[out].members[port.name]} = {text};"
        for port, text in zip(function.outputs, code.results, strict=True)
    ]
    comment = block_comment([_sentence(function.text), f"Operations of the formula: {cost}."])
    return Step(name, tuple(own), tuple(comment), tuple(lines), arguments, code.ops)


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


def _names(function: Function) -> dict[int, str]:
    """What nodes are called: as the formula calls them; what a kernel gives for a wheel, as the wheel."""
    nodes, names, taken = function.nodes, dict[int, str](), set(_RESERVED)

    def call(k: int, name: str) -> None:
        if k not in names and name not in taken:
            names[k] = name
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
    return names


# ---- kernels


def _results_of(kernels: Sequence[Function], scalar: str) -> dict[str, Results]:
    """How the results of each kernel are named in C."""
    results = {}
    for kernel in kernels:
        members = tuple(port.name for port in kernel.outputs)
        several = _PREFIX + _TYPES.get(members, f"{kernel.name}_result")
        kind = scalar if len(members) == 1 else several
        results[kernel.name] = Results(_PREFIX + kernel.name, kind, members)
    return results


def printed_kernels(module: Module, scalar: str) -> tuple[Kernel, ...]:
    """The kernels of ``module``, those that are called before those that call.

    One that a single function calls, at one place, stands there whatever the user's build asks for: a call only costs.
    """
    results = _results_of(module.kernels, scalar)
    calls = Counter(n.name for f in module.functions for n in f.nodes if n.op is Op.CALL)
    inner = called(module.kernels)
    once = {name for name, count in calls.items() if count == 1 and name not in inner}
    return tuple(_kernel(kernel, scalar, results, kernel.name in once) for kernel in module.kernels)


def _kernel(kernel: Function, scalar: str, results: Mapping[str, Results], once: bool) -> Kernel:
    taken = {"result", *(port.name for port in kernel.inputs)}
    names = {k: name for name, k in reversed(kernel.named) if name not in taken}
    if len(set(names.values())) < len(names):
        names = {}
    code = body(kernel, str, _style(scalar), kernels=results, names=names, apart=_shared(kernel))
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
