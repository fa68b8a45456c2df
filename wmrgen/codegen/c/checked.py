"""``<robot>_checked.h`` and ``.c``: every function behind a check of its inputs, with a status and safe outputs.

With ``--fuzz`` also ``test/<robot>_fuzz.c``: a libFuzzer harness of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from wmrgen.codegen.c.records import Step, Unit
from wmrgen.codegen.c.text import block_comment, comment_lines, literal, prototype
from wmrgen.codegen.render import render
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import (
    OVERSHOOT,
    POSE_COVARIANCE,
    SPAN,
    SPREAD,
    TWIST_NAMES,
    Site,
    overshot,
    timeless,
)
from wmrgen.ir.calls import hand_through
from wmrgen.ir.nodes import Function, Limits, Module, Port, contract
from wmrgen.ir.rounding import tuned
from wmrgen.ir.selftest.rounding_bounds import LARGEST_ANGLE

LARGEST = {"float": 1e9, "double": 1e100}
# A step of odometry turns by no more than an angle that the kernels take: omega dt <= 2000 rad.
_TURNING = {"float": {"omega": 200.0, "dt": 10.0}, "double": {"omega": 1e6, "dt": 1e2}}
ABOUT = (
    "The functions of {0}.h for inputs that nobody vouches for: a sensor that failed, a command from a network. "
    "Each returns {1}_OK and the outputs of the function, to the last bit, or a status and safe outputs: joint rates, "
    "twists and slips 0, steering angles and poses as they were (0 where that is no number either: look at the status "
    "before a motor follows), steering inside its limits.",
    "A commanded twist must keep the limits of the robot file. A joint may be measured "
    f"{OVERSHOOT:g} times as far from the middle of its limits, for one at its stop overshoots, and a measured twist "
    "may be whatever {0}_forward() gives of such joints. What has no limits by that must be of a size that gives "
    "finite results. That is wider than the ranges for which {0}.h states bounds. Angles are not wrapped here: wrap "
    "theta.",
)
ABOUT_TUNABLE = (
    "Tunable parameters are checked by {0}_prepare_checked(), which takes the range that the robot file states; "
    f"without one, what lies within {float(SPREAD) * 100:g} % of the nominal value, within {float(SPAN):g} (m, rad) "
    "where that is 0. A block of parameters with "
    "anything else in it, one that was erased say, is refused as a whole: then the robot is prepared for its nominal "
    "parameters. What {0}_prepare() makes of parameters that nobody checked is not checked later.",
)


class Range(NamedTuple):
    """An input: accepted from ``low`` to ``high``, as C writes them."""

    port: Port
    low: str
    high: str


class Safe(NamedTuple):
    """An output where nothing was accepted: the input of the same name where ``held``, else 0, inside ``limit``."""

    port: Port
    held: bool
    limit: tuple[str, str] | None


class Guarded(NamedTuple):
    """A function with what it accepts, and what its outputs are where it accepts nothing.

    `prepare` has no ``outputs`` of that kind: it works with the nominal parameters then. ``keeps``: the steering angles
    that it gives keep their limits, be it measurements that do not. ``needs``: results that must not be negative.
    """

    step: Step
    ranges: tuple[Range, ...]
    outputs: tuple[Safe, ...]
    keeps: bool
    needs: tuple[str, ...] = ()

    @property
    def prepares(self) -> bool:
        """Whether its inputs are parameters."""
        return "params" in self.step.variables

    def read(self, port: Port) -> str:
        """An input, as the function itself has it."""
        return next(p.within(p.reads[port.name]) for p in self.step.parameters if port.name in p.reads)

    def written(self, port: Port) -> str:
        """An output, as the function itself has it."""
        return next(p.within(p.writes[port.name]) for p in self.step.parameters if port.name in p.writes)


def guarded(module: Module, unit: Unit, site: Site) -> Iterator[Guarded]:
    """`prepare`, where a parameter is tunable, and every function that has inputs."""
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
    """`prepare` with the parameters that it accepts, where one is tunable: no more than bounds are about."""
    prepare = hand_through(module).prepare
    if prepare is None or not prepare.inputs:
        return None
    step = next(step for step in unit.steps if step.name == f"{unit.robot}_prepare")
    scalar, accepted = unit.choice.scalar, []
    for port in prepare.inputs:
        low, high = tuned(port, scalar)
        accepted.append(Range(port, _number(low, scalar), _number(high, scalar)))
    return Guarded(step, tuple(accepted), (), keeps=False, needs=module.needs)


def ranges(function: Function, scalar: str, site: Site) -> tuple[Range, ...]:
    """The accepted range of every contract input of ``function``.

    A commanded twist keeps its declared limits, a measured one what `forward` can give, a joint its `overshot`
    limits, whatever the function; everything else, and what has no limits, only has to be of a size that gives finite
    results.
    """
    return tuple(_range(port, function.limits, scalar, site) for port in contract(function))


def _range(port: Port, limits: Limits, scalar: str, site: Site) -> Range:
    name = timeless(port.name)
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
    """What each output is when an input is refused: positions, angles, covariances are held, the rest is 0."""
    positions = {p.name for p in function.inputs if p.unit in ("m", "rad") or p in POSE_COVARIANCE}
    outputs = []
    for port in function.outputs:
        limit = site.limits.get(port.name) if port.unit == "rad" else None
        text = (_number(limit[0], scalar), _number(limit[1], scalar)) if limit else None
        outputs.append(Safe(port, port.name in positions, text))
    return tuple(outputs)


def _number(value: float, scalar: str) -> str:
    """``value`` as a C literal, negative ones without parentheses; large sizes as 1e9."""
    power = f"{value:.0e}".replace("e+0", "e").replace("e+", "e")
    end = "f" if scalar == "float" else ""
    if abs(value) >= 1e4 and float(power) == value:
        return power + end
    return literal(Exact(Fraction(value)), scalar).strip("()") if value else "0.0" + end


# ---- the checked functions


def checked(module: Module, unit: Unit, site: Site, common: Mapping[str, object]) -> tuple[str, str]:
    """Header and source; ``unit``: the C functions of ``module``, ``common``: what every template is told."""
    accepting = [*guarded(module, unit, site)]
    functions = [_checked(unit, g) for g in accepting]
    stores = " ".join(line for f in functions for line in f["safe"])
    context: dict[str, object] = {
        **common,
        "largest": "FLT_MAX" if unit.choice.scalar == "float" else "DBL_MAX",
        "zero": _number(0.0, unit.choice.scalar),
        "about": about((*ABOUT, *ABOUT_TUNABLE) if any(g.prepares for g in accepting) else ABOUT, unit.robot),
        "functions": functions,
        "holds": "_held(" in stores,
        "limits": "_between(" in stores,
    }
    return render("c99/checked.h.j2", **context), render("c99/checked.c.j2", **context)


def about(texts: Sequence[str], robot: str) -> list[str]:
    """The comment lines of ``texts``, in which {0} is the robot and {1} its name in capitals."""
    return [line for text in texts for line in comment_lines(text.format(robot, robot.upper()))]


def _checked(unit: Unit, guarded: Guarded) -> dict[str, Any]:
    """A checked function, ready to print."""
    step, accepted = guarded.step, guarded.ranges
    reads = [(guarded.read(r.port), r) for r in accepted]
    spans: dict[str, list[str]] = {}
    for r in accepted:
        unit_of = f" {r.port.unit}" if r.port.unit else ""
        spans.setdefault(f"{_plain(r.low)} to {_plain(r.high)}{unit_of}", []).append(r.port.name)
    text = "; ".join(f"{', '.join(names)} {span}" for span, names in spans.items())
    otherwise = " Else prepared is that of the nominal parameters." if guarded.prepares else ""
    return {
        "comment": block_comment(
            [f"{step.name}() with its inputs checked. Accepted: {text}.{otherwise}"], doxygen=True
        ),
        "prototype": prototype(f"{unit.robot}_status {step.name}_checked", step.declared),
        "numbers": _all_of([f"{unit.robot}_is_number({read})" for read, _ in reads]),
        "inside": _all_of([f"{unit.robot}_is_within({read}, {r.low}, {r.high})" for read, r in reads]),
        "call": f"{step.name}({', '.join(step.variables)});",
        "computed": _all_of(_computed(unit, guarded)) if guarded.needs else [],
        "safe": _nominal(unit.robot)
        if guarded.prepares
        else [_store(unit, guarded, output) for output in guarded.outputs],
    }


def _nominal(robot: str) -> list[str]:
    """The statements that prepare a robot with its nominal parameters."""
    return [
        f"{robot}_params nominal;",
        "",
        f"{robot}_params_default(&nominal);",
        f"{robot}_prepare(&nominal, prepared);",
    ]


def _computed(unit: Unit, guarded: Guarded) -> list[str]:
    """Tests of what was prepared: everything is a number, and what must not be negative is not."""
    (writes,) = (p for p in guarded.step.parameters if p.writes)
    places = {name: writes.within(place) for name, place in writes.writes.items()}
    least = _number(0.0, unit.choice.scalar)
    return [
        f"({place} >= {least})" if name in guarded.needs else f"{unit.robot}_is_number({place})"
        for name, place in places.items()
    ]


def _all_of(tests: Sequence[str]) -> list[str]:
    """One test a line, joined by &&."""
    return [*(f"{test} &&" for test in tests[:-1]), tests[-1]]


def _plain(literal: str) -> str:
    return literal.removesuffix("f").removesuffix(".0")


def _store(unit: Unit, guarded: Guarded, output: Safe) -> str:
    value = _number(0.0, unit.choice.scalar)
    if output.held:
        value = f"{unit.robot}_held({guarded.read(output.port)})"
    if output.limit:
        value = f"{unit.robot}_between({value}, {output.limit[0]}, {output.limit[1]})"
    return f"{guarded.written(output.port)} = {value};"
