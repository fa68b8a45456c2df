"""The parts of ``--size``: functions of the C file alone, which its other functions call."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from wmrgen.backends.c99.comment import WIDTH, block_comment
from wmrgen.backends.c99.style import style
from wmrgen.backends.expression import body
from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.outline.undo import calls


@dataclass(frozen=True, slots=True)
class Part:
    """A static function, ready to print. ``struct``: of what it hands back; empty when that is one scalar."""

    comment: tuple[str, ...]
    struct: tuple[str, ...]
    prototype: str
    lines: tuple[str, ...]
    ops: frozenset[Op]


def parts(
    functions: Sequence[Function], made: Sequence[Function], robot: str, scalar: str
) -> tuple[Part, ...]:
    """``made``: what `wmrgen.ir.outline` made of ``functions``, those that are called before those that call."""
    callers: dict[str, Counter[str]] = {}
    for function in (*functions, *made):
        for part, count in calls(function.nodes).items():
            callers.setdefault(part, Counter())[function.name.removeprefix(f"{robot}_")] += count
    return tuple(_part(part, callers[part.name], scalar) for part in made)


def _part(part: Function, callers: Counter[str], scalar: str) -> Part:
    code = body(part, str, style(scalar))
    count = sum(node.op is Op.INPUT for node in part.nodes)
    parameters = [f"{scalar} x{k}" for k in range(count)]
    several = len(code.results) > 1
    kind = f"{part.name}_out" if several else scalar
    struct = ("typedef struct {", *(f"    {scalar} y{n};" for n in range(len(code.results))), f"}} {kind};")
    last = (
        [f"const {kind} y = {{{', '.join(code.results)}}};", "return y;"]
        if several
        else [f"return {code.results[0]};"]
    )
    used = ", ".join(f"{name} ({count}x)" if count > 1 else name for name, count in callers.items())
    return Part(
        tuple(block_comment([f"Called by {used}."])),
        struct if several else (),
        _prototype(kind, part.name, parameters),
        (*code.statements, *([""] if code.statements else []), *last),
        code.ops,
    )


def _prototype(kind: str, name: str, parameters: Sequence[str]) -> str:
    head = f"static WMRGEN_NOINLINE {kind} {name}("
    line = f"{head}{', '.join(parameters)})"
    return line if len(line) < WIDTH else head + "\n    " + ", ".join(parameters) + ")"
