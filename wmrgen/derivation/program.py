"""The functions of a robot: which ones it has, in symbols, in operations, and as the C needs them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wmrgen.analysis.kinematics.records import Formula
from wmrgen.analysis.mobility.analyse import driving
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.codegen.registry import VectorForm
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import Kind, declaration
from wmrgen.functions.registry import standard as standard_functions
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import Limits, Port, Role
from wmrgen.ir.calls import keep_outputs, select, self_contained
from wmrgen.ir.geometry import unguarded
from wmrgen.ir.lower import kernels_of, lower
from wmrgen.ir.nodes import Function, Module, Op
from wmrgen.ir.pipeline import optimise
from wmrgen.robotfile.reserved_words import why_reserved

if TYPE_CHECKING:
    from wmrgen.functions.models.state_space import StateSpace


class Program(NamedTuple):
    """The formulas of a robot, in the order in which they are generated."""

    name: str  # of the robot
    formulas: tuple[Formula, ...]

    def formula(self, name: str) -> Formula:
        """Return the formula called ``name``. KeyError if there is none."""
        return {f.name: f for f in self.formulas}[name]

    def in_c(self, asked: Collection[str]) -> tuple[str, ...]:
        """Return the names of the functions in C: those that firmware runs, and those that the robot file requests."""
        names = (f.name for f in self.formulas)
        return tuple(n for n in names if n in asked or declaration(n).kind is Kind.FIRMWARE)


def formula(robot: Robot, mobility: Mobility, name: str) -> Formula:
    """Build one function of a robot.

    Args:
        robot: The robot.
        mobility: Its mobility.
        name: The function.

    Returns:
        The function in symbols.

    Raises:
        RobotFileError: There is no function of this name.
        NotDerivableError: The robot cannot have it.
    """
    declared = declaration(name)
    built = declared.build(*((robot, mobility) if declared.contacts else driving(robot, mobility)))
    if not isinstance(built, Formula):
        raise TypeError(f"the builder of {name} returns {built!r}, which is no Formula")
    built = replace(built, source=declared.source, limits=declared.limits, in_place=declared.in_place)
    _refuse_shared_names(robot, built)
    _refuse_malformed(name, built)
    return built


def _refuse_malformed(name: str, built: Formula) -> None:
    """Raise ValueError if no code can be generated from what the builder of ``name`` returned."""
    if built.name != name:
        raise ValueError(
            f"the builder of {name} calls its formula {built.name}; a formula has the name of its builder"
        )
    for what, ports in (("input", built.inputs), ("output", [port for port, _ in built.outputs])):
        names = [port.name.replace(".", "_") for port in ports]
        for word in sorted({part for port in ports for part in port.name.split(".")}):
            if why := why_reserved(word):
                raise ValueError(f"{name} has an {what} called {word}: {why}")
        for called in names:
            if not (called.isidentifier() and called.isascii()):
                raise ValueError(f"{name} has an {what} called {called!r}: a name has a-z, A-Z, 0-9 and _")
            if names.count(called) > 1:
                raise ValueError(f"{name} has two {what}s called {called}")


def _refuse_shared_names(robot: Robot, built: Formula) -> None:
    """Raise NotDerivableError if a tunable parameter has the name of another input of the function."""
    names = [p.name.replace(".", "_") for p in built.inputs]
    shared = [p.name for p in robot.tunable if names.count(p.name) > 1]
    if shared:
        raise NotDerivableError(
            f"{robot.name} cannot have the function {built.name}: {shared[0]} is an input of it and a "
            "tunable parameter.\n"
            f"  Give the parameter another name, such as {shared[0]}_0, or delete its tunable: true."
        )


def standard(robot: Robot) -> tuple[str, ...]:
    """Return the functions generated for a robot: the standard ones that it has, then those that its file requests."""
    has = [d.name for d in standard_functions() if d.exists(robot)]
    return (*has, *(name for name in asked(robot) if name not in has))


def asked(robot: Robot) -> tuple[str, ...]:
    """Return the functions that a robot file requests; ``slip: true`` requests slip_inverse."""
    slip = ("slip_inverse",) if robot.slip and "slip_inverse" not in robot.functions else ()
    return (*robot.functions, *slip)


def with_calls(program: Program, plain: Module) -> Module:
    """Return the functions in operations with calls of kernels; ``plain`` has the same functions without calls."""
    pairs = zip(program.formulas, plain.functions, strict=True)
    functions = tuple(lower(f, calls=True) if f.calls else function for f, function in pairs)
    return Module(program.name, functions, kernels=kernels_of(program.formulas))


def optimised(module: Module, meaning: Module) -> Module:
    """Optimise every function of a module, and add the parts of `forward` and `inverse` that C and Python use.

    `forward` exists also without its residual; `inverse` also as two functions, joints and slip.

    Args:
        module: The functions.
        meaning: The same functions without calls of kernels; every pass is verified against them.

    Returns:
        The optimised functions and the parts.
    """
    whole = optimise(module.functions, module.name, module.kernels, meaning.functions)
    parts: list[Function] = []
    for f in whole.functions:
        results = frozenset(port.name for port in f.outputs if port.name != "slip")
        if f.name == "forward":
            text = f"{f.text}, with its residual"
            residual = replace(f, name="forward_residual", text=text, variant_of=f.name)
            parts += [keep_outputs(f, results, "forward_twist"), residual]
        elif f.name == "inverse":
            text = "sliding that the ground must give when this twist is driven"
            slip = keep_outputs(f, frozenset({"slip"}), "inverse_residual")
            parts += [keep_outputs(f, results, "inverse_joints"), replace(slip, text=text, variant_of=f.name)]
    return replace(whole, functions=(*whole.functions, *parts))


# The Python names of functions without their output slip.
WITHOUT_SLIP = {"forward": "forward_twist", "inverse": "inverse_joints"}
_IN_C = {
    "forward": {"forward_twist": "forward", "forward_residual": "forward_slip"},
    "inverse": {"inverse_joints": "inverse", "inverse_residual": "inverse_slip"},
}


def for_c(module: Module, robot: Robot, functions: Iterable[str], passive: bool) -> Module:
    """Return the functions for C: `forward` with and without the residual, `inverse` and its slip separately.

    Functions that command joints have no outputs for joints that are neither driven nor sensed.

    Args:
        module: The result of `optimised`.
        robot: The robot.
        functions: Names of the functions to generate.
        passive: Add a function ``<function>_passive`` for the joints that are left out.

    Returns:
        The functions, and the names of the joints that the structs of C have.
    """
    chosen = [_IN_C.get(name, {name: name}) for name in functions]
    whole = select(module, {part: name for names in chosen for part, name in names.items()})
    scaled = {port.name for f in whole.functions if f.limits is Limits.ASKED for port in f.inputs}
    joints = _joints(robot, scaled)
    absent = frozenset(_joints(robot, every=True)) - set(joints)
    steps = tuple(part for f in _useful(whole) for part in _parts(f, absent, passive))
    kept = select(replace(whole, functions=steps), {f.name: f.name for f in steps})
    named = {port.name for f in kept.functions for port in (*f.inputs, *f.outputs)}
    return replace(kept, joints=tuple(name for name in joints if name in named))


def _useful(module: Module) -> Iterator[Function]:
    """Yield the functions, except an `inverse_slip` that is 0 for every twist; `inverse` then lists slip as a zero."""
    always_zero = {f.name for f in module.functions if f.name == "inverse_slip" and _is_zero(f)}
    for f in module.functions:
        if f.name == "inverse" and always_zero:
            yield replace(f, zeros=("slip",))
        elif f.name not in always_zero:
            yield f


def _is_zero(function: Function) -> bool:
    nodes = (function.nodes[k] for k in function.results)
    return all(node.op is Op.CONST and not node.value for node in nodes)


def _joints(robot: Robot, scaled: Collection[str] = (), every: bool = False) -> tuple[str, ...]:
    """Return the names of the joints that C commands or reads, in the order of the file.

    These are the joints that are driven, sensed, have an encoder, or have a limit and are among ``scaled``. They also
    include the steering angles of wheels with one of these joints, or coupled to one, because `inverse` reads them.

    Args:
        robot: The robot.
        scaled: Joint rates that some function reduces to their limits.
        every: Return all spins and steering angles.

    Returns:
        Names, as ``left.spin``.
    """
    own: list[set[str]] = []  # for each wheel, those of spin and steer that C has
    for w in robot.wheels:
        limited = {name.partition("_")[0] for name in w.limits if f"{w.name}.{name}" in scaled}
        own.append({"spin", "steer"} if every else {*w.actuated, *w.sensed, *w.encoders, *limited})
    steered = {lead for w, lead in zip(robot.wheels, robot.steer_group, strict=True) if own[w.index]}
    names = []
    for w in robot.wheels:
        steers = robot.steer_group[w.index] in steered if w.kind.steers else "spin" in own[w.index]
        wanted = own[w.index] | ({"steer"} if steers and (w.kind.steers or w.kind.swivels) else set())
        names += [
            f"{w.name}.{j}" for j in ("spin", "steer", "steer_rate") if j.removesuffix("_rate") in wanted
        ]
    return tuple(names)


def _parts(function: Function, absent: frozenset[str], passive: bool) -> list[Function]:
    """Return a function without the outputs for ``absent`` joints, and as a second part these outputs alone."""
    if function.limits not in (Limits.COMMANDED, Limits.ASKED):
        return [function]
    names = frozenset(port.name for port in function.outputs)
    parts = [_with_read_inputs(keep_outputs(function, names - absent, function.name), absent)]
    if passive and names & absent:
        own = keep_outputs(function, names & absent, f"{function.name}_passive")
        parts.append(replace(own, variant_of=function.variant_of or function.name))
    return parts


def _with_read_inputs(function: Function, absent: frozenset[str]) -> Function:
    """Return a function without those of the ``absent`` joints among its inputs that it does not read."""
    read = {node.name for node in function.nodes if node.op is Op.INPUT}
    unread = tuple(name for name in absent if name not in read)
    inputs = tuple(port for port in function.inputs if port.name in read or not port.name.startswith(unread))
    return replace(function, inputs=inputs)


def vector_forms(robot: Robot, space: StateSpace | None) -> tuple[VectorForm, ...]:
    """Return every `vector_form` of a state space; none without a state space."""
    forms = [vector_form(robot, space, name) for name in ("ode", "rolling", "limits")] if space else []
    return tuple(form for form in forms if form)


def vector_form(robot: Robot, space: StateSpace, name: str) -> VectorForm | None:
    """Return a function of the vectors x, u and p, optimised.

    Args:
        robot: The robot.
        space: Its state space.
        name: ode: the rates of x. rolling: the constraints, which are 0. limits: limited quantities that are neither
            states nor inputs.

    Returns:
        The function; None if the robot has no such constraints or limits.
    """
    result, formula = {
        "ode": ("xdot", space.rates),
        "rolling": ("g", space.constraints),
        "limits": ("h", space.limited.formula),
    }[name]
    if formula is None:
        return None
    function, *others = _equivalents(formula, robot.name)
    vectors = _names(space.state), _names(space.inputs), _names(space.geometry)
    nominal = tuple(float(p.default) for p in space.geometry if p.default is not None)
    bounds = []
    for ports in (space.state, space.inputs, space.limits):
        for end in (0, 1):
            bounds.append(tuple(space.limited.bounds[p.name][end] for p in ports))
    return VectorForm(name, function, vectors, result, nominal, tuple(bounds), tuple(others))


def _names(ports: Iterable[Port]) -> tuple[str, ...]:
    return tuple(port.name for port in ports)


def _equivalents(formula: Formula, name: str) -> Iterator[Function]:
    """Yield a formula in operations, without checks of geometry, in up to three equivalent forms.

    The first is optimised for constant geometry, the second for geometry that varies like other inputs, the last one is
    as the formula is written.
    """
    plain = unguarded(lower(formula))
    yield from self_contained(optimise((plain,), name))
    roles = {port.name: port for port in plain.inputs}
    if any(port.role is Role.GEOMETRY for port in plain.inputs):
        varying = tuple(replace(p, role=Role.STATE) if p.role is Role.GEOMETRY else p for p in plain.inputs)
        (varied,) = optimise((replace(plain, inputs=varying),), name).functions
        yield replace(varied, inputs=tuple(roles[port.name] for port in varied.inputs))
    yield unguarded(lower(formula, as_written=True))
