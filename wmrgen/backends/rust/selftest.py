"""``tests/selftest.rs``: test vectors, and tests that call every function with them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from wmrgen.backends.rust.records import Unit
from wmrgen.backends.rust.types import crate, doc, number
from wmrgen.ir.nodes import Module
from wmrgen.ports import Site
from wmrgen.render import render
from wmrgen.selftest.vectors import Table, Vector, tables

_MARGIN = 1.01  # of tolerances, which are printed with three digits


def selftest(module: Module, unit: Unit, site: Site) -> str:
    """The text of the file; ``unit``: the Rust functions of ``module``."""
    printed = [_table(table, unit) for table in tables(module, unit.choice.scalar, site)]
    return render(
        "rust/selftest.rs.j2",
        crate=crate(unit.robot),
        scalar=unit.scalar,
        joints=unit.joints,
        tables=printed,
    )


def _table(table: Table, unit: Unit) -> dict[str, Any]:
    """A table, ready to print."""
    about = "{1} after {0}" if table.law else "{}" + " and {}" * (len(table.functions) - 1)
    return {
        "name": "law_of_" * table.law + f"rows_of_{table.functions[0]}",
        "doc": doc(
            f"{about.format(*table.functions)}. Columns: {', '.join((*table.inputs, *table.outputs))}."
        ),
        "width": len(table.inputs) + 2 * len(table.outputs),
        "rows": [_row(vector, unit.scalar) for vector in table.vectors],
        "lines": _checks(table, unit),
    }


def _row(vector: Vector, scalar: str) -> list[str]:
    numbers = [number(x, scalar) for x in vector.inputs]
    for expected, tolerance in zip(vector.expected, vector.tolerance, strict=True):
        numbers += (number(expected + 0.0, scalar), f"{tolerance * _MARGIN:.2e}")
    return numbers


def _checks(table: Table, unit: Unit) -> list[str]:
    """The statements that run one row; the inputs of a law's second function are the outputs of its first."""
    columns = {name: len(table.inputs) + 2 * k for k, name in enumerate(table.outputs)}
    values = {name: f"row[{k}]" for k, name in enumerate(table.inputs)}
    lines: list[str] = []

    def checked(outputs: Mapping[str, str]) -> str:
        pairs = (f"({columns[name]}, {place})" for name, place in outputs.items() if name in columns)
        return f"check(row, &[{', '.join(pairs)}]);"

    for number_, name in enumerate(table.functions):
        step = unit.step(name)
        if step is None:
            continue
        if table.law and number_ == 0:
            block = unit.block(step, values, lambda outputs: f"[{', '.join(outputs.values())}]")
            lines += [f"let first = {block[0]}", *block[1:-1], "};"]
            values |= {output: f"first[{k}]" for k, output in enumerate(step.outputs)}
        else:
            lines += unit.block(step, values, checked)
    return lines
