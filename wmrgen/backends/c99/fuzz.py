"""``<robot>_fuzz.c``: a libFuzzer harness of the checked functions, written with ``--fuzz``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from wmrgen.backends.c99.checked import checked_steps
from wmrgen.backends.c99.comment import comment_lines
from wmrgen.backends.c99.ranges import Range, Safe, ranges, safe
from wmrgen.backends.c99.step import Step
from wmrgen.ir.nodes import Module
from wmrgen.ir.site import Site
from wmrgen.render import render

ABOUT = (
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
        about=[line for text in ABOUT for line in comment_lines(text.format(module.name))],
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
        tuple(_accepted(outputs, members["out"])),
        tuple(_refused(outputs, members)),
    )


def _accepted(outputs: Sequence[Safe], members: Mapping[str, str]) -> Iterator[str]:
    for output in outputs:
        read = f"out.{members[output.port.name]}"
        yield f"must(is_number({read}));"
        if output.limit:
            yield f"must(({read} >= {output.limit[0]}) && ({read} <= {output.limit[1]}));"


def _refused(outputs: Sequence[Safe], members: Mapping[str, Mapping[str, str]]) -> Iterator[str]:
    for output in outputs:
        read = f"out.{members['out'][output.port.name]}"
        if output.limit:
            yield f"must(({read} >= {output.limit[0]}) && ({read} <= {output.limit[1]}));"
        elif output.held:
            given = f"in.{members['in'][output.port.name]}"
            yield f"must(is_number({given}) ? ({read} == {given}) : ({read} == 0));"
        else:
            yield f"must({read} == 0);"
