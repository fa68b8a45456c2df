"""``test/<robot>_selftest.c``: test vectors, and a function that runs every function with them on host or target."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import ceil, floor, log10
from typing import Any

import numpy as np

from wmrgen.codegen.c.functions import call
from wmrgen.codegen.c.text import WIDTH, block_comment, comment_text
from wmrgen.codegen.render import render
from wmrgen.codegen.unit import Step, Unit
from wmrgen.geometry.ports import Site
from wmrgen.ir.nodes import Module
from wmrgen.ir.selftest.vectors import Table, Vector, tables

FEWER = 4  # rows: SELFTEST_FEW keeps one of them, which still covers every function
ABOUT = (
    "Self-test of {0}.c, to run on the target machine. Each row has the inputs, then the expected value and the "
    "tolerance of every output. Expected values are those of the exact formula (60 digits, rounded once; below 1e-12: "
    "0). A tolerance bounds the rounding errors of all operations of a correct build, with sines and cosines within 4 "
    "units of rounding ({2}) and arctangents within 6 ulp. It covers contraction to fused multiply-add. NaN fails.",
    "int {0}_selftest(void) returns 0, or the number of the first row that fails; rows are counted over all tables of "
    "this file. Call it from your program, or compile with -D{1}_SELFTEST_MAIN: then this file has a main(), which "
    "returns 0 or 1. With -D{1}_SELFTEST_FEW only a quarter of the rows is compiled and counted, for small flash. On "
    "an AVR the rows are stored in flash.",
)


def selftest(module: Module, unit: Unit, site: Site, common: Mapping[str, object]) -> str:
    """Return the text of the self-test.

    Args:
        module: The functions of the robot.
        unit: Its C functions.
        site: What the robot file says about inputs.
        common: Variables of every template.
    """
    scalar, robot = unit.choice.scalar, unit.robot
    about = [text.format(robot, robot.upper(), "2**-24" if scalar == "float" else "2**-53") for text in ABOUT]
    return render(
        "c99/selftest.c.j2",
        **common,
        about=[line.lstrip(" */").rstrip(" */") for line in block_comment(about)],
        tables=[_table(table, unit) for table in tables(module, scalar, site)],
    )


def _table(table: Table, unit: Unit) -> dict[str, Any]:
    """Return a table, ready to print; ``lines`` are the body of the function that checks one row."""
    steps = [unit.contract[name] for name in table.functions]
    names = [f"{step.name}()" for step in steps]
    title = f"{names[1]} after {names[0]}" if table.law else " and ".join(names)
    columns = ", ".join(table.inputs) + "; " if table.inputs else ""
    few = table.vectors[::FEWER]
    more = [vector for k, vector in enumerate(table.vectors) if k % FEWER]
    comment = f"{title}. Columns: {columns}expected and tolerance of {', '.join(table.outputs)}."
    return {
        "name": f"law_of_{table.functions[0]}" if table.law else table.functions[0],
        "comment": block_comment([comment]),
        "width": len(table.inputs) + 2 * len(table.outputs),
        "few": list(_rows(few, unit.choice.scalar)),
        "more": list(_rows(more, unit.choice.scalar)),
        "lines": _check(table, steps, unit.before(steps)),
    }


def _check(table: Table, steps: Sequence[Step], before: Sequence[Step]) -> list[str]:
    """Return the statements that run one row through ``steps``: declarations, calls and comparisons.

    In the table of a law, the second function gets the outputs of the first as inputs, if they have the same name.
    """
    prepared = {name: kind for step in before for name, kind in step.variables.items()}
    declared = [f"{kind} {name};" for name, kind in prepared.items()]
    calls = [f"{call(step)};" for step in before]
    values = {name: f"row[{k}]" for k, name in enumerate(table.inputs)}
    for number, step in enumerate(steps):
        own = {p: f"{p}{number}" for p in step.variables if p not in prepared}
        declared += [f"{step.variables[p]} {variable};" for p, variable in own.items()]
        calls += [f"{_numbered(place, number)} = {values[name]};" for name, place in step.inputs.items()]
        calls.append(f"{call(step, own)};")
        outputs = {name: _numbered(place, number) for name, place in step.outputs.items()}
        if table.law and number == 0:
            values |= outputs
            continue
        for k, name in enumerate(table.outputs):
            if name in outputs:
                expected = len(table.inputs) + 2 * k
                calls.append(f"misses += miss({outputs[name]}, &row[{expected}]);")
    return [*declared, "int misses = 0;", "", *calls, "return misses;"]


def _numbered(place: str, number: int) -> str:
    """Return ``twist0.vx`` for ``twist.vx`` and the number 0."""
    variable, dot, member = place.partition(".")
    return f"{variable}{number}{dot}{member}"


# ---- numbers


def _rows(vectors: Sequence[Vector], scalar: str) -> Iterator[str]:
    """Yield the lines of an array of rows, with a comment before a row if its text differs from the last row's."""
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
    """Yield the lines of a row."""
    line = "    {"
    for text in numbers:
        if len(line) + len(text) + 2 > WIDTH:
            yield line.rstrip()
            line = "    "
        line += f"{text}, "
    yield line[:-2] + "},"


def _literal(value: float, scalar: str) -> str:
    """Return the shortest decimal that reads back as ``value``, a float32 if ``scalar`` is float."""
    if scalar == "double":
        return repr(value)
    return f"{np.float32(value)!s}f"


def _upwards(value: float, scalar: str) -> str:
    """Return ``value``, rounded up to at most two digits."""
    power = floor(log10(value)) - 1
    # A value of two digits stays, whatever the division rounds.
    digits = ceil(value / 10.0**power * (1 - 1e-9))
    if digits % 10 == 0:
        digits, power = digits // 10, power + 1
    return f"{digits}e{power}" + ("f" if scalar == "float" else "")
