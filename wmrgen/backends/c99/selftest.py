"""``<robot>_selftest.c``: test vectors and a ``main`` that calls every function with them, for host and target."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, log10

import numpy as np

from wmrgen.backends.c99.functions import Step
from wmrgen.backends.c99.text import WIDTH, block_comment, comment_text
from wmrgen.ir.nodes import Module
from wmrgen.render import render
from wmrgen.selftest.points import Site
from wmrgen.selftest.vectors import Table, Vector, tables

ABOUT = (
    "Self-test of {0}.c, for the machine it is to run on. A row holds inputs, then for every output what the exact "
    "formula gives there (60 digits, rounded once; below 1e-12: 0) and how far a correct build may be from it: a "
    "bound of the rounding errors of all operations, with sines and cosines within 4 units of rounding ({2}) and "
    "arctangents within 6 ulp; contraction to fused multiply-add is covered. A NaN fails.",
    "{0}_selftest() returns 0, or the number of the first row that fails, counted through this file. main() calls "
    "it and returns 0 or 1; define {1}_SELFTEST_NO_MAIN to call it from a program of your own.",
)


@dataclass(frozen=True, slots=True)
class Printed:
    """A table, ready to print. ``lines``: the body of the function that checks one row."""

    name: str
    comment: tuple[str, ...]
    count: int
    width: int
    rows: tuple[str, ...]
    lines: tuple[str, ...]


def selftest(
    module: Module, steps: Sequence[Step], scalar: str, site: Site, banner: Sequence[str], pair: str
) -> str:
    """The text of the file; ``steps`` are the C functions of ``module``."""
    by_name = {s.name: s for s in steps}
    robot, upper = module.name, module.name.upper()
    printed = [_printed(table, robot, by_name, scalar) for table in tables(module, scalar, site)]
    about = [text.format(robot, upper, "2**-24" if scalar == "float" else "2**-53") for text in ABOUT]
    return render(
        "c99/selftest.c.j2",
        robot=robot,
        upper=upper,
        scalar=scalar,
        banner=banner,
        about=[line.lstrip(" */").rstrip(" */") for line in block_comment(about)],
        pair=pair,
        tables=printed,
    )


def _printed(table: Table, robot: str, steps: dict[str, Step], scalar: str) -> Printed:
    used = [steps[f"{robot}_{name}"] for name in table.functions]
    title = (
        f"{used[1].name}() after {used[0].name}()" if table.law else " and ".join(f"{s.name}()" for s in used)
    )
    columns = ", ".join(table.inputs) + "; " if table.inputs else ""
    comment = f"{title}. Columns: {columns}expected and tolerance of {', '.join(table.outputs)}."
    lines = _Check(table, robot, steps).lines()
    rows = tuple(_rows(table.vectors, scalar))
    width = len(table.inputs) + 2 * len(table.outputs)
    name = f"law_of_{table.functions[0]}" if table.law else table.functions[0]
    return Printed(name, tuple(block_comment([comment])), len(table.vectors), width, rows, lines)


class _Check:
    """The statements that run one row of a table through its functions."""

    def __init__(self, table: Table, robot: str, steps: dict[str, Step]) -> None:
        self.table, self.robot, self.steps = table, robot, steps
        self.used = [steps[f"{robot}_{name}"] for name in table.functions]
        self.column = {name: f"row[{k}]" for k, name in enumerate(table.inputs)}

    def lines(self) -> tuple[str, ...]:
        """Declarations, then every function with its inputs, and its outputs compared."""
        declared = [*self._prepared_structs(), *_structs(self.used), "int misses = 0;"]
        done = self._prepare_calls()
        made: dict[str, str] = {}
        for number, step in enumerate(self.used):
            done += [f"in{number}.{m} = {made.get(n) or self.column[n]};" for n, m in _inputs(step)]
            done.append(_call(step, number))
            outputs = step.arguments[-1][0].members
            if self.table.law and number == 0:
                made = {name: f"out0.{member}" for name, member in outputs.items()}
            else:
                done += self._compared(outputs, number)
        return (*declared, "", *done, "return misses;")

    def _compared(self, members: Mapping[str, str], number: int) -> list[str]:
        first = len(self.table.inputs)
        return [
            f"misses += miss(out{number}.{members[name]}, &row[{first + 2 * k}]);"
            for k, name in enumerate(self.table.outputs)
            if name in members
        ]

    def _prepared_structs(self) -> list[str]:
        """Parameters and what prepare() makes of them, where a function reads that."""
        if not any(parameter == "prepared" for s in self.used for _, parameter in s.arguments):
            return []
        return [f"{s.name} {parameter};" for s, parameter in self.steps[f"{self.robot}_prepare"].arguments]

    def _prepare_calls(self) -> list[str]:
        """Parameters at their nominal values, and prepare()."""
        if not self._prepared_structs():
            return []
        first = [f"{self.robot}_{name}" for name in ("params_default", "prepare")]
        return [
            f"{name}({', '.join(f'&{parameter}' for _, parameter in self.steps[name].arguments)});"
            for name in first
            if name in self.steps
        ]


def _structs(used: Sequence[Step]) -> list[str]:
    return [
        f"{struct.name} {parameter}{number};"
        for number, step in enumerate(used)
        for struct, parameter in step.arguments
        if parameter in ("in", "out")
    ]


def _inputs(step: Step) -> list[tuple[str, str]]:
    """Contract name and member of every input."""
    return [
        item for struct, parameter in step.arguments if parameter == "in" for item in struct.members.items()
    ]


def _call(step: Step, number: int) -> str:
    numbered = {"in": f"&in{number}", "out": f"&out{number}"}
    return f"{step.name}({', '.join(numbered.get(p, f'&{p}') for _, p in step.arguments)});"


# ---- numbers


def _rows(vectors: Sequence[Vector], scalar: str) -> Iterator[str]:
    """The lines of an array of rows, what each is in front of it where that changes."""
    before = ""
    for vector in vectors:
        if vector.text != before:
            yield f"    /* {comment_text(vector.text)} */"
            before = vector.text
        numbers = [_literal(x, scalar) for x in vector.inputs]
        for expected, tolerance in zip(vector.expected, vector.tolerance, strict=True):
            numbers += (_literal(expected + 0.0, scalar), _upwards(tolerance, scalar))
        yield from _wrapped(numbers)


def _wrapped(numbers: Sequence[str]) -> Iterator[str]:
    line = "    {"
    for text in numbers:
        if len(line) + len(text) + 2 > WIDTH:
            yield line.rstrip()
            line = "     "
        line += f"{text}, "
    yield line[:-2] + "},"


def _literal(value: float, scalar: str) -> str:
    """The shortest decimal of ``value``, a float32 for ``float``."""
    if scalar == "double":
        return repr(value)
    return f"{np.float32(value)!s}f"


def _upwards(value: float, scalar: str) -> str:
    """Two digits at most, not below ``value``."""
    power = floor(log10(value)) - 1
    digits = ceil(value / 10.0**power * (1 - 1e-9))
    if digits % 10 == 0:
        digits, power = digits // 10, power + 1
    return f"{digits}e{power}" + ("f" if scalar == "float" else "")
