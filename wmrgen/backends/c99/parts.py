"""The parts of ``--size``: functions of the C file alone, which its other functions call."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from wmrgen.backends.c99.comment import WIDTH, block_comment
from wmrgen.backends.c99.style import style
from wmrgen.backends.expression import body
from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.outline.undo import calls


@dataclass(frozen=True, slots=True)
class Part:
    """A static function, ready to print."""

    comment: tuple[str, ...]
    prototype: str
    lines: tuple[str, ...]
    ops: frozenset[Op]


def parts(
    functions: Sequence[Function],
    made: Sequence[Function],
    robot: str,
    scalar: str,
    several: Mapping[str, int],
) -> tuple[Part, ...]:
    """``made``: what `wmrgen.ir.outline` made of ``functions``, those that are called before those that call.

    ``several``: how many results each of them has; more than one are written through pointers.
    """
    callers: dict[str, Counter[str]] = {}
    for function in (*functions, *made):
        for part, count in calls(function.nodes).items():
            callers.setdefault(part, Counter())[function.name.removeprefix(f"{robot}_")] += count
    return tuple(_part(part, callers[part.name], scalar, several) for part in made)


def _part(part: Function, callers: Counter[str], scalar: str, several: Mapping[str, int]) -> Part:
    places = [f"*y{n}" for n in range(len(part.results))] if len(part.results) > 1 else []
    code = body(part, str, style(scalar), None, places, several)
    count = sum(node.op is Op.INPUT for node in part.nodes)
    parameters = [f"{scalar} x{k}" for k in range(count)] + [f"{scalar} {place}" for place in places]
    last = () if places else (*([""] if code.statements else []), f"return {code.results[0]};")
    used = ", ".join(f"{name} ({count}x)" if count > 1 else name for name, count in callers.items())
    return Part(
        tuple(block_comment([f"Called by {used}."])),
        _prototype("void" if places else scalar, part.name, parameters),
        (*code.statements, *last),
        code.ops,
    )


def _prototype(kind: str, name: str, parameters: Sequence[str]) -> str:
    head = f"static WMRGEN_NOINLINE {kind} {name}("
    line = f"{head}{', '.join(parameters)})"
    return line if len(line) < WIDTH else head + "\n    " + ", ".join(parameters) + ")"
