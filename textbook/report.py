"""The report of the library: every function with its equations, inputs and outputs."""

from __future__ import annotations

from textbook.canonical import CANONICAL, INPUT_SETS
from textbook.latex import equations
from textbook.library import CHAPTERS, Textbook
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.report.sections.markdown import aligned, code, escape, table

_INTRODUCTION = (
    "# Textbook formulas",
    "Formulas of the source texts that need no robot, in their corrected form (see [`errata.md`](../errata.md)). "
    "The same functions stand in `textbook.c`, `textbook.py` and the CasADi files of this folder; `wmrgen eval "
    "textbook FUNCTION NAME=VALUE…` computes them.",
    "SI units and radians. Vectors are written `v.x`, `v.y`, `v.z`; all vectors of a function are in one frame. A "
    "quotient whose divisor is at most 1e-12 in magnitude is given as 0, so every function is defined for every "
    "input.",
)


def report(book: Textbook) -> list[str]:
    """The blocks of report.md."""
    lines = list(_INTRODUCTION)
    formulas = {f.name: f for f in book.formulas}
    for number, chapter in enumerate(CHAPTERS, 1):
        lines += [f"## {number} {chapter.title}"]
        for name in chapter.functions:
            if name in formulas:
                lines += _function(formulas[name])
        if chapter is CANONICAL:
            lines += _input_sets()
    return lines


def _function(f: Formula) -> list[str]:
    rows = [
        (code(p.name), escape(p.unit), way, escape(p.text))
        for way, ports in (("in", f.inputs), ("out", tuple(p for p, _ in f.outputs)))
        for p in ports
    ]
    return [
        f"### `{f.name}`",
        f"{f.text[:1].upper()}{escape(f.text)[1:]}.",
        *aligned(equations(f)),
        "<details><summary>Inputs and outputs</summary>",
        *table(("name", "unit", "", ""), rows, "l"),
        "</details>",
    ]


def _input_sets() -> list[str]:
    """Tzafestas 2.3.4: a car as Reeds and Shepp or as Dubins drive it."""
    shown = {
        name: "{" + ", ".join(str(v).replace("-", "−") for v in values) + "}"
        for name, values in INPUT_SETS.items()
    }
    return [
        f"The speed v1 of a car takes the values {shown['reeds_shepp']} as Reeds and Shepp drive it and "
        f"{shown['dubins']} as Dubins does (Tzafestas 2.3.4, AA274)."
    ]
