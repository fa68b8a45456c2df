"""``<robot>_checked.h`` and ``.c``: every function behind a check of its inputs, with a status and safe outputs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from wmrgen.backends.c99.comment import WIDTH, block_comment, comment_lines
from wmrgen.backends.c99.ranges import OVERSHOOT, Range, Safe, ranges, safe
from wmrgen.backends.c99.step import Step
from wmrgen.ir.nodes import Module
from wmrgen.ir.site import Site
from wmrgen.render import render

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
