"""``<robot>_checked.h`` and ``.c``: variants of all functions that check their inputs and return a status.

If an input is rejected, they give safe outputs. With ``--fuzz`` there is a libFuzzer harness for them,
``test/<robot>_fuzz.c``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from wmrgen.codegen.c.functions import access, call, declared
from wmrgen.codegen.c.text import block_comment, comment_lines, literal, prototype
from wmrgen.codegen.render import render
from wmrgen.codegen.signature import PARAMS
from wmrgen.codegen.unit import Step, Unit
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import (
    OVERSHOOT,
    POSE_COVARIANCE,
    SPAN,
    SPREAD,
    TWIST_NAMES,
    Site,
    overshot,
    without_time_suffix,
)
from wmrgen.ir.calls import pass_geometry_through_prepare
from wmrgen.ir.nodes import Function, Limits, Module, Port, contract
from wmrgen.ir.rounding import tuned
from wmrgen.ir.selftest.rounding_bounds import LARGEST_ANGLE

LARGEST = {"float": 1e9, "double": 1e100}  # of an input without a limit: its square is still finite
# Largest omega [rad/s] and dt [s]: odometry then turns by an angle that the kernels accept (2000 rad in float).
_TURNING = {"float": {"omega": 200.0, "dt": 10.0}, "double": {"omega": 1e6, "dt": 1e2}}
ABOUT = (
    "The functions of {0}.h for inputs that may be invalid: from a failed sensor, or from a network. Each function "
    "returns {1}_OK and the same outputs as {0}.h, bit for bit, or another status and safe outputs. Safe outputs are: "
    "joint rates, twists and slips 0; steering angles and poses unchanged, or 0 if they are not finite; steering "
    "angles within their limits. Check the status before you command a motor.",
    "A commanded twist must be within the limits of the robot file. A measured joint may be "
    f"{OVERSHOOT:g} times as far from the middle of its limits, because joints overshoot. A measured twist may be any "
    "result of {0}_forward() for such joints. Inputs without limits must be small enough for finite results. These "
    "ranges are wider than those for which {0}.h states bounds. Angles are not wrapped: wrap theta yourself.",
)
ABOUT_TUNABLE = (
    "{0}_prepare_checked() checks the tunable parameters against their range in the robot file. A parameter without a "
    f"range must be within {float(SPREAD) * 100:g} % of its nominal value, or within {float(SPAN):g} (m, rad) if that "
    "is 0. If any parameter is rejected, for example because memory was erased, all of them are: the robot is then "
    "prepared with its nominal parameters. The other functions do not check parameters.",
)
ABOUT_FUZZ = (
    "Fuzzing harness for libFuzzer: clang -g -O1 -fsanitize=fuzzer,address,undefined,float-divide-by-zero "
    "test/{0}_fuzz.c {0}_checked.c {0}.c -lm. Every function gets inputs with random bit patterns and inputs from its "
    "accepted range. If the inputs are accepted, outputs must be finite, and commanded steering angles must be within "
    "their limits. If they are rejected, outputs must be the safe ones.",
)


class Range(NamedTuple):
    """The accepted range of an input."""

    port: Port
    low: str  # as C writes it
    high: str


class Safe(NamedTuple):
    """The safe value of an output, for inputs that are rejected."""

    port: Port
    held: bool  # whether it is the input of the same name; otherwise it is 0
    limit: tuple[str, str] | None  # the value is limited to this range


class Guarded(NamedTuple):
    """A function with the inputs that it accepts, and its outputs if it rejects them."""

    step: Step
    ranges: tuple[Range, ...]
    outputs: tuple[Safe, ...]  # none for `prepare`, which then uses the nominal parameters
    keeps: (
        bool  # whether steering angles that it gives are within their limits, even if measured angles are not
    )
    needs: tuple[str, ...] = ()  # outputs that must not be negative

    @property
    def prepares(self) -> bool:
        """Whether its inputs are the tunable parameters."""
        return PARAMS in self.step.variables

    def read(self, port: Port) -> str:
        """Return an input as the body of the function reads it."""
        return next(access(p, p.reads[port.name]) for p in self.step.parameters if port.name in p.reads)

    def written(self, port: Port) -> str:
        """Return an output as the body of the function writes it."""
        return next(access(p, p.writes[port.name]) for p in self.step.parameters if port.name in p.writes)


def guarded(module: Module, unit: Unit, site: Site) -> Iterator[Guarded]:
    """Return `prepare`, if a parameter is tunable, and every function that has inputs.

    Args:
        module: The functions of the robot.
        unit: Its C functions.
        site: What the robot file says about inputs.
    """
    scalar, steps = unit.choice.scalar, unit.contract
    prepare = _prepare(module, unit)
    if prepare is not None:
        yield prepare
    for function in module.functions:
        accepted = ranges(function, scalar, site)
        if accepted and function.name in steps:
            keeps = function.limits is Limits.COMMANDED
            yield Guarded(steps[function.name], accepted, safe(function, scalar, site), keeps)


def _prepare(module: Module, unit: Unit) -> Guarded | None:
    """Return `prepare` with the ranges of parameters for which bounds are proved; None if no parameter is tunable."""
    prepare = pass_geometry_through_prepare(module).prepare
    if prepare is None or not prepare.inputs:
        return None
    step = next(step for step in unit.steps if step.function == "prepare")
    scalar, accepted = unit.choice.scalar, []
    for port in prepare.inputs:
        low, high = tuned(port, scalar)
        accepted.append(Range(port, _number(low, scalar), _number(high, scalar)))
    return Guarded(step, tuple(accepted), (), keeps=False, needs=module.needs)


def ranges(function: Function, scalar: str, site: Site) -> tuple[Range, ...]:
    """Return the accepted range of every input of ``function`` that a caller sets.

    A commanded twist must be within its limits, a measured twist within the reach of `forward`, and a joint within its
    `overshot` limits. All other inputs must be small enough for finite results.

    Args:
        function: A function of the robot.
        scalar: ``float`` or ``double``.
        site: What the robot file says about inputs.
    """
    return tuple(_range(port, function.limits, scalar, site) for port in contract(function))


def _range(port: Port, limits: Limits, scalar: str, site: Site) -> Range:
    name = without_time_suffix(port.name)
    size = _TURNING[scalar].get(name) or (LARGEST_ANGLE if port.unit == "rad" else LARGEST)[scalar]
    low, high = -size, size
    if name in TWIST_NAMES and limits is Limits.COMMANDED:
        low, high = site.limits.get(name, (low, high))
    elif name in TWIST_NAMES and limits is Limits.MEASURED:
        reach = site.reach.get(name, (low, high))
        low, high = max(low, reach[0]), min(high, reach[1])
    elif name in site.limits and name not in TWIST_NAMES and limits is not Limits.ASKED:
        low, high = overshot(*site.limits[name])
    return Range(port, _number(low, scalar), _number(high, scalar))


def safe(function: Function, scalar: str, site: Site) -> tuple[Safe, ...]:
    """Return the safe value of each output: positions, angles and covariances are held, all others are 0.

    Args:
        function: A function of the robot.
        scalar: ``float`` or ``double``.
        site: What the robot file says about outputs.
    """
    positions = {p.name for p in function.inputs if p.unit in ("m", "rad") or p in POSE_COVARIANCE}
    outputs = []
    for port in function.outputs:
        limit = site.limits.get(port.name) if port.unit == "rad" else None
        text = (_number(limit[0], scalar), _number(limit[1], scalar)) if limit else None
        outputs.append(Safe(port, port.name in positions, text))
    return tuple(outputs)


def _number(value: float, scalar: str) -> str:
    """Return ``value`` as a C literal; a negative one has no parentheses, and a large one looks like 1e9."""
    power = f"{value:.0e}".replace("e+0", "e").replace("e+", "e")
    end = "f" if scalar == "float" else ""
    if abs(value) >= 1e4 and float(power) == value:
        return power + end
    return literal(Exact(Fraction(value)), scalar).strip("()") if value else "0.0" + end


# ---- the checked functions


def checked(module: Module, unit: Unit, site: Site, common: Mapping[str, object]) -> tuple[str, str]:
    """Return the text of header and source.

    Args:
        module: The functions of the robot.
        unit: Its C functions.
        site: What the robot file says about inputs and outputs.
        common: Variables of every template.
    """
    accepting = [*guarded(module, unit, site)]
    functions = [_checked(unit, g) for g in accepting]
    stores = " ".join(line for f in functions for line in f["safe"])
    texts = (*ABOUT, *ABOUT_TUNABLE) if any(g.prepares for g in accepting) else ABOUT
    context: dict[str, object] = {
        **common,
        "largest": "FLT_MAX" if unit.choice.scalar == "float" else "DBL_MAX",
        "zero": _number(0.0, unit.choice.scalar),
        "about": _about(texts, unit.robot),
        "functions": functions,
        "holds": "_held(" in stores,
        "limits": "_between(" in stores,
    }
    return render("c99/checked.h.j2", **context), render("c99/checked.c.j2", **context)


def _about(texts: Sequence[str], robot: str) -> list[str]:
    """Return the comment lines of ``texts``, in which {0} is the robot and {1} its name in capitals."""
    return [line for text in texts for line in comment_lines(text.format(robot, robot.upper()))]


def _checked(unit: Unit, guarded: Guarded) -> dict[str, Any]:
    """Return a checked function, ready to print."""
    step, accepted, robot = guarded.step, guarded.ranges, unit.robot
    reads = [(guarded.read(r.port), r) for r in accepted]
    stores = [_store(unit, guarded, output) for output in guarded.outputs]
    text = f"{step.name}() with a check of its inputs. Accepted: {_accepted_ranges(accepted)}."
    if guarded.prepares:
        text += " Otherwise the robot is prepared with its nominal parameters."
    return {
        "comment": block_comment([text], doxygen=True),
        "prototype": prototype(f"{robot}_status {step.name}_checked", declared(step.parameters)),
        "numbers": _all_of([f"{robot}_is_number({read})" for read, _ in reads]),
        "inside": _all_of([f"{robot}_is_within({read}, {r.low}, {r.high})" for read, r in reads]),
        "call": f"{step.name}({', '.join(step.variables)});",
        "computed": _all_of(_computed(unit, guarded)) if guarded.needs else [],
        "safe": _nominal(robot) if guarded.prepares else stores,
    }


def _accepted_ranges(ranges: Sequence[Range]) -> str:
    """Return the accepted ranges as text; inputs with the same range share an entry."""
    names: dict[str, list[str]] = {}
    for r in ranges:
        unit = f" {r.port.unit}" if r.port.unit else ""
        names.setdefault(f"{_plain(r.low)} to {_plain(r.high)}{unit}", []).append(r.port.name)
    return "; ".join(f"{', '.join(inputs)} {span}" for span, inputs in names.items())


def _nominal(robot: str) -> list[str]:
    """Return the statements that prepare a robot with its nominal parameters."""
    return [
        f"{robot}_params nominal;",
        "",
        f"{robot}_params_default(&nominal);",
        f"{robot}_prepare(&nominal, prepared);",
    ]


def _computed(unit: Unit, guarded: Guarded) -> list[str]:
    """Return tests of what was prepared: all values are finite, and `Guarded.needs` are not negative."""
    (prepared,) = (p for p in guarded.step.parameters if p.writes)
    places = {name: access(prepared, member) for name, member in prepared.writes.items()}
    least = _number(0.0, unit.choice.scalar)
    return [
        f"({place} >= {least})" if name in guarded.needs else f"{unit.robot}_is_number({place})"
        for name, place in places.items()
    ]


def _all_of(tests: Sequence[str]) -> list[str]:
    """Return the tests, joined by &&, one on each line."""
    return [*(f"{test} &&" for test in tests[:-1]), tests[-1]]


def _plain(literal: str) -> str:
    return literal.removesuffix("f").removesuffix(".0")


def _store(unit: Unit, guarded: Guarded, output: Safe) -> str:
    """Return the statement that stores the safe value of an output."""
    value = _number(0.0, unit.choice.scalar)
    if output.held:
        value = f"{unit.robot}_held({guarded.read(output.port)})"
    if output.limit:
        value = f"{unit.robot}_between({value}, {output.limit[0]}, {output.limit[1]})"
    return f"{guarded.written(output.port)} = {value};"


# ---- the fuzzing harness


def fuzz(module: Module, unit: Unit, site: Site, common: Mapping[str, object]) -> str:
    """Return the text of the fuzzing harness.

    Args:
        module: The functions of the robot.
        unit: Its C functions.
        site: What the robot file says about inputs and outputs.
        common: Variables of every template.
    """
    accepting = [*guarded(module, unit, site)]
    prepare = next((g for g in accepting if g.prepares), None)
    tried = [_tried(unit, g, prepare) for g in accepting]
    return render("c99/fuzz.c.j2", **common, about=_about(ABOUT_FUZZ, unit.robot), functions=tried)


def _tried(unit: Unit, guarded: Guarded, prepare: Guarded | None) -> dict[str, Any]:
    """Return the test of a function, ready to print; ``prepare`` checks random parameters first, if it needs any."""
    step = guarded.step
    variables = unit.variables(step)
    changed = {variable for output in guarded.outputs if (variable := _changed(guarded, output))}
    before = [p for p in step.parameters if p.name in changed]
    fill = _any(guarded)
    if guarded.prepares:
        variables |= {"nominal": variables["params"], "expected": variables["prepared"]}
    elif prepare is not None and "prepared" in variables:
        fill = [*_any(prepare), f"(void){_call_checked(prepare)};", *fill]
    else:
        fill = [*(f"{call(called)};" for called in unit.before([step])), *fill]
    return {
        "name": step.name.removeprefix(f"{unit.robot}_"),
        "declare": [f"{kind} {name};" for name, kind in variables.items()]
        + [f"{p.type} {p.name}_before;" for p in before],
        "poisoned": [p.name for p in step.parameters if p.writes and not p.reads],
        "fill": [*fill, *(f"{p.name}_before = {p.name};" for p in before)],
        "call": _call_checked(guarded),
        "accepted": _accepted(guarded),
        "refused": _refused(guarded, unit.robot),
    }


def _call_checked(guarded: Guarded) -> str:
    return call(guarded.step, suffix="_checked")


def _any(guarded: Guarded) -> list[str]:
    """Return the statements that set the inputs to random values."""
    inputs = guarded.step.inputs
    return [f"{inputs[r.port.name]} = any(&bytes, {r.low}, {r.high});" for r in guarded.ranges]


def _accepted(guarded: Guarded) -> list[str]:
    """Return the assertions after inputs were accepted."""
    if guarded.prepares:
        reads = [(guarded.step.inputs[r.port.name], r) for r in guarded.ranges]
        near = [f"must(({read} >= {r.low}) && ({read} <= {r.high}));" for read, r in reads]
        return [*near, f"{call(guarded.step, {'prepared': 'expected'})};", *_as_expected(guarded)]
    return [f"must({test});" for output in guarded.outputs for test in _numbers(guarded, output)]


def _refused(guarded: Guarded, robot: str) -> list[str]:
    """Return the assertions after inputs were rejected."""
    if guarded.prepares:
        nominal = {"params": "nominal", "prepared": "expected"}
        calls = [f"{robot}_params_default(&nominal);", f"{call(guarded.step, nominal)};"]
        return [*calls, *_as_expected(guarded)]
    return [f"must({_is_safe(guarded, output)});" for output in guarded.outputs]


def _as_expected(guarded: Guarded) -> Iterator[str]:
    """Yield the assertions that what was prepared equals ``expected``."""
    for member in guarded.step.outputs.values():
        expected = member.replace("prepared.", "expected.")
        yield f"must(is_number({member}) && ({member} == {expected}));"


def _numbers(guarded: Guarded, output: Safe) -> Iterator[str]:
    """Yield the tests of an output after inputs were accepted."""
    read = guarded.step.outputs[output.port.name]
    yield f"is_number({read})"
    if output.limit and guarded.keeps:
        yield f"({read} >= {output.limit[0]}) && ({read} <= {output.limit[1]})"


def _changed(guarded: Guarded, output: Safe) -> str:
    """Return the variable that a held output overwrites, or "" if it overwrites none."""
    present = guarded.step.inputs[output.port.name] if output.held and not output.limit else ""
    return present.partition(".")[0] if present == guarded.step.outputs[output.port.name] else ""


def _is_safe(guarded: Guarded, output: Safe) -> str:
    """Return the test that an output has its safe value."""
    read = guarded.step.outputs[output.port.name]
    if output.limit:
        return f"({read} >= {output.limit[0]}) && ({read} <= {output.limit[1]})"
    if output.held:
        present = guarded.step.inputs[output.port.name]
        if variable := _changed(guarded, output):
            present = f"{variable}_before{present.removeprefix(variable)}"
        return f"is_number({present}) ? ({read} == {present}) : ({read} == 0)"
    return f"{read} == 0"
