"""``test/<robot>_selftest.c``: test vectors and a function that calls every function with them, for host and target."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import ceil, floor, log10
from typing import Any

import numpy as np

from wmrgen.codegen.c.records import Step, Unit
from wmrgen.codegen.c.text import WIDTH, block_comment, comment_text
from wmrgen.codegen.render import render
from wmrgen.geometry.ports import Site
from wmrgen.ir.nodes import Module
from wmrgen.ir.selftest.vectors import Table, Vector, tables

FEWER = 4  # one of so many rows is enough for who asks for few
ABOUT = (
    "Self-test of {0}.c, for the machine it is to run on. A row holds inputs, then for every output what the exact "
    "formula gives there (60 digits, rounded once; below 1e-12: 0) and how far a correct build may be from it: a "
    "bound of the rounding errors of all operations, with sines and cosines within 4 units of rounding ({2}) and "
    "arctangents within 6 ulp; contraction to fused multiply-add is covered. A NaN fails.",
    "int {0}_selftest(void) returns 0, or the number of the first row that fails, counted through the tables of this "
    "file. Call it from a program of your own; compiled with -D{1}_SELFTEST_MAIN this file has a main(), which "
    "returns 0 or 1. With -D{1}_SELFTEST_FEW a quarter of the rows is compiled, and counted, for small flash; on an "
    "AVR the rows stay there.",
)


def selftest(module: Module, unit: Unit, site: Site, common: Mapping[str, object]) -> str:
    """The text of the file; ``unit``: the C functions of ``module``, ``common``: what every template is told."""
    scalar, robot = unit.choice.scalar, unit.robot
    about = [text.format(robot, robot.upper(), "2**-24" if scalar == "float" else "2**-53") for text in ABOUT]
    return render(
        "c99/selftest.c.j2",
        **common,
        about=[line.lstrip(" */").rstrip(" */") for line in block_comment(about)],
        tables=[_table(table, unit) for table in tables(module, scalar, site)],
    )


def _table(table: Table, unit: Unit) -> dict[str, Any]:
    """A table, ready to print. ``lines``: the body of the function that checks one row."""
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
    """The statements that run one row through ``steps``: declarations, calls with their inputs, comparisons.

    The inputs of a law's second function are the outputs of its first, where those have the name.
    """
    prepared = {name: kind for step in before for name, kind in step.variables.items()}
    declared = [f"{kind} {name};" for name, kind in prepared.items()]
    calls = [f"{step.call()};" for step in before]
    values = {name: f"row[{k}]" for k, name in enumerate(table.inputs)}
    for number, step in enumerate(steps):
        own = {p: f"{p}{number}" for p in step.variables if p not in prepared}
        declared += [f"{step.variables[p]} {variable};" for p, variable in own.items()]
        calls += [f"{_numbered(place, number)} = {values[name]};" for name, place in step.inputs.items()]
        calls.append(f"{step.call(own)};")
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
    """``twist.vx`` of the variable ``twist0``."""
    variable, dot, member = place.partition(".")
    return f"{variable}{number}{dot}{member}"


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
            line = "    "
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
