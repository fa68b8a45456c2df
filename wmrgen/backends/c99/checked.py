"""``<robot>_checked.h`` and ``.c``: every function behind a check of its inputs, with a status and safe outputs.

With ``--fuzz`` also ``<robot>_fuzz.c``: a libFuzzer harness of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from wmrgen.backends.c99.functions import Step
from wmrgen.backends.c99.text import WIDTH, block_comment, comment_lines, literal
from wmrgen.exact.number import Exact
from wmrgen.ir.nodes import Function, Limits, Module, Port, Role
from wmrgen.render import render
from wmrgen.selftest.points import Site
from wmrgen.selftest.rounding_bounds import LARGEST_ANGLE

OVERSHOOT = 1.25  # of what is measured: a joint that stands at its limit must not stop the robot
LARGEST = {"float": 1e9, "double": 1e100}
# A step of odometry turns by no more than an angle that the kernels take: omega dt <= 2000 rad.
_TURNING = {"float": {"omega": 200.0, "dt": 10.0}, "double": {"omega": 1e6, "dt": 1e2}}
_TWIST = ("vx", "vy", "omega")


@dataclass(frozen=True, slots=True)
class Range:
    """An input: accepted from ``low`` to ``high``, as C writes them."""

    port: Port
    low: str
    high: str


@dataclass(frozen=True, slots=True)
class Safe:
    """An output where nothing was accepted: the input of the same name where ``held``, else 0, inside ``limit``."""

    port: Port
    held: bool
    limit: tuple[str, str] | None


def ranges(function: Function, scalar: str, site: Site) -> tuple[Range, ...]:
    """The accepted range of every contract input of ``function``.

    A commanded twist keeps its declared limits, what is measured may be `OVERSHOOT` as far from their middle;
    everything else, and what has no limits, only has to be of a size that gives finite results.
    """
    ports = (port for port in function.inputs if port.role in (Role.STATE, Role.COMMAND))
    return tuple(_range(port, function.limits, scalar, site) for port in ports)


def _range(port: Port, limits: Limits, scalar: str, site: Site) -> Range:
    size = _TURNING[scalar].get(port.name) or (LARGEST_ANGLE if port.unit == "rad" else LARGEST)[scalar]
    low, high = -size, size
    if port.name in site.limits and limits is not Limits.NONE:
        low, high = site.limits[port.name]
        if port.name not in _TWIST or limits is Limits.MEASURED:
            middle, half = (low + high) / 2, OVERSHOOT * (high - low) / 2
            low, high = middle - half, middle + half
    return Range(port, _number(low, scalar), _number(high, scalar))


def safe(function: Function, scalar: str, site: Site) -> tuple[Safe, ...]:
    """What each output is when an input is refused: positions and angles are held, everything else is 0."""
    given = {port.name for port in function.inputs if port.unit in ("m", "rad")}
    found = []
    for port in function.outputs:
        limit = site.limits.get(port.name) if port.unit == "rad" else None
        text = (_number(limit[0], scalar), _number(limit[1], scalar)) if limit else None
        found.append(Safe(port, port.name in given, text))
    return tuple(found)


def _number(value: float, scalar: str) -> str:
    """``value`` as a C literal, negative ones without parentheses; large sizes as 1e9."""
    power = f"{value:.0e}".replace("e+0", "e").replace("e+", "e")
    end = "f" if scalar == "float" else ""
    if abs(value) >= 1e4 and float(power) == value:
        return power + end
    return literal(Exact(Fraction(value)), scalar).strip("()") if value else "0.0" + end


ABOUT = (
    "The functions of {0}.h for inputs that nobody vouches for: a sensor that failed, a command from a network. "
    "Each returns {1}_OK and the outputs of the function, to the last bit, or a status and safe outputs: joint rates, "
    "twists and slips 0, steering angles and poses as they were (0 where that is no number either: look at the status "
    "before a motor follows), steering inside its limits. Parameters are not checked.",
    "A commanded twist must keep the limits of the robot file; what is measured may lie "
    f"{OVERSHOOT:g} times as far from the middle of its limits, for a joint at its stop overshoots. An input without "
    "limits has to be of a size that gives finite results. That is wider than the ranges for which {0}.h states "
    "bounds. Angles are not wrapped here: wrap theta.",
)


@dataclass(frozen=True, slots=True)
class Checked:
    """A checked function, ready to print."""

    name: str
    comment: tuple[str, ...]
    prototype: str
    numbers: tuple[str, ...]
    inside: tuple[str, ...]
    call: str
    safe: tuple[str, ...]


def checked_steps(module: Module, steps: Sequence[Step], scalar: str, site: Site) -> list[Checked]:
    """One for every function that has inputs."""
    by_name = {step.name: step for step in steps}
    found = []
    for function in module.functions:
        step = by_name.get(f"{module.name}_{function.name}")
        accepted = ranges(function, scalar, site)
        if step is not None and accepted:
            found.append(_checked(module.name, step, accepted, safe(function, scalar, site)))
    return found


def _checked(robot: str, step: Step, accepted: Sequence[Range], outputs: Sequence[Safe]) -> Checked:
    members = {p: s.members for s, p in step.arguments}
    name = f"{step.name}_checked"
    reads = [(f"in->{members['in'][r.port.name]}", r) for r in accepted]
    grouped: dict[str, list[str]] = {}
    for r in accepted:
        unit = f" {r.port.unit}" if r.port.unit else ""
        grouped.setdefault(f"{_plain(r.low)} to {_plain(r.high)}{unit}", []).append(r.port.name)
    text = "; ".join(f"{', '.join(names)} {span}" for span, names in grouped.items())
    return Checked(
        name,
        tuple(block_comment([f"{step.name}() with its inputs checked. Accepted: {text}."])),
        _prototype(f"{robot}_status {name}", step),
        tuple(_joined(f"is_number({read})" for read, _ in reads)),
        tuple(_joined(f"is_within({read}, {r.low}, {r.high})" for read, r in reads)),
        f"{step.name}({', '.join(p for _, p in step.arguments)});",
        tuple(_stores(outputs, members)),
    )


def _plain(literal: str) -> str:
    return literal.removesuffix("f").removesuffix(".0")


def _joined(tests: Iterator[str]) -> Iterator[str]:
    """One test a line, joined by &&."""
    every = list(tests)
    for k, test in enumerate(every):
        yield test + (" &&" if k + 1 < len(every) else "")


def _stores(outputs: Sequence[Safe], members: Mapping[str, Mapping[str, str]]) -> Iterator[str]:
    for output in outputs:
        member = members["out"][output.port.name]
        value = f"held(in->{members['in'][output.port.name]})" if output.held else "ZERO"
        if output.limit:
            value = f"between({value}, {output.limit[0]}, {output.limit[1]})"
        yield f"out->{member} = {value};"


def _prototype(head: str, step: Step) -> str:
    parts = [f"{'' if p == 'out' else 'const '}{s.name} *{p}" for s, p in step.arguments]
    line = f"{head}({', '.join(parts)})"
    return line if len(line) < WIDTH else f"{head}(\n    " + ",\n    ".join(parts) + ")"


def checked(
    module: Module, steps: Sequence[Step], scalar: str, site: Site, banner: Sequence[str], pair: str
) -> tuple[str, str]:
    """The text of the two files; ``steps`` are the C functions of ``module``."""
    made = checked_steps(module, steps, scalar, site)
    zero = "0.0f" if scalar == "float" else "0.0"
    functions = [Checked(c.name, c.comment, c.prototype, c.numbers, c.inside, c.call,
                         tuple(line.replace("ZERO", zero) for line in c.safe)) for c in made]  # fmt: skip
    stores = " ".join(line for c in functions for line in c.safe)
    context: dict[str, object] = {
        "robot": module.name,
        "upper": module.name.upper(),
        "scalar": scalar,
        "largest": "FLT_MAX" if scalar == "float" else "DBL_MAX",
        "zero": zero,
        "banner": banner,
        "about": [
            line for text in ABOUT for line in comment_lines(text.format(module.name, module.name.upper()))
        ],
        "pair": pair,
        "functions": functions,
        "holds": "held(" in stores,
        "limits": "between(" in stores,
    }
    return render("c99/checked.h.j2", **context), render("c99/checked.c.j2", **context)


ABOUT_FUZZ = (
    "Fuzzing harness for libFuzzer: clang -g -O1 -fsanitize=fuzzer,address,undefined,float-divide-by-zero "
    "{0}_fuzz.c {0}_checked.c {0}.c -lm. Every function gets inputs of any bit pattern and inputs spread over their "
    "range. What was accepted must give numbers, and steering angles inside their limits; what was refused must give "
    "the safe outputs.",
)


@dataclass(frozen=True, slots=True)
class Tried:
    """A function, ready to print."""

    name: str
    declare: tuple[str, ...]
    fill: tuple[str, ...]
    call: str
    accepted: tuple[str, ...]
    refused: tuple[str, ...]


def fuzz(
    module: Module, steps: Sequence[Step], scalar: str, site: Site, banner: Sequence[str], pair: str
) -> str:
    """The text of the file; ``steps`` are the C functions of ``module``."""
    by_name = {step.name: step for step in steps}
    functions = {f"{module.name}_{f.name}": f for f in module.functions}
    tried = [
        _tried(
            module.name,
            by_name,
            name,
            ranges(functions[name], scalar, site),
            safe(functions[name], scalar, site),
        )
        for name in (c.name.removesuffix("_checked") for c in checked_steps(module, steps, scalar, site))
    ]
    return render(
        "c99/fuzz.c.j2",
        robot=module.name,
        upper=module.name.upper(),
        scalar=scalar,
        banner=banner,
        about=[line for text in ABOUT_FUZZ for line in comment_lines(text.format(module.name))],
        pair=pair,
        functions=tried,
    )


def _tried(
    robot: str, steps: dict[str, Step], name: str, accepted: Sequence[Range], outputs: Sequence[Safe]
) -> Tried:
    step = steps[name]
    members = {p: s.members for s, p in step.arguments}
    declare = [f"{s.name} {p};" for s, p in step.arguments]
    fill = []
    if any(p == "prepared" for _, p in step.arguments):
        prepare = steps[f"{robot}_prepare"]
        declare += [f"{s.name} {p};" for s, p in prepare.arguments if p == "params"]
        for first in (f"{robot}_params_default", prepare.name):
            if first in steps:
                fill.append(f"{first}({', '.join(f'&{p}' for _, p in steps[first].arguments)});")
    fill += [f"in.{members['in'][r.port.name]} = any(&bytes, {r.low}, {r.high});" for r in accepted]
    call = f"{name}_checked({', '.join(f'&{p}' for _, p in step.arguments)})"
    return Tried(
        name.removeprefix(f"{robot}_"),
        tuple(declare),
        tuple(fill),
        call,
        tuple(_holds_accepted(outputs, members["out"])),
        tuple(_holds_refused(outputs, members)),
    )


def _holds_accepted(outputs: Sequence[Safe], members: Mapping[str, str]) -> Iterator[str]:
    for output in outputs:
        read = f"out.{members[output.port.name]}"
        yield f"must(is_number({read}));"
        if output.limit:
            yield f"must(({read} >= {output.limit[0]}) && ({read} <= {output.limit[1]}));"


def _holds_refused(outputs: Sequence[Safe], members: Mapping[str, Mapping[str, str]]) -> Iterator[str]:
    for output in outputs:
        read = f"out.{members['out'][output.port.name]}"
        if output.limit:
            yield f"must(({read} >= {output.limit[0]}) && ({read} <= {output.limit[1]}));"
        elif output.held:
            given = f"in.{members['in'][output.port.name]}"
            yield f"must(is_number({given}) ? ({read} == {given}) : ({read} == 0));"
        else:
            yield f"must({read} == 0);"
