"""Write an exercise as Markdown, LaTeX or HTML, with its figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from wmrgen.derivation.facade import Derivation
from wmrgen.report.pages.document import REPORT, Report, page
from wmrgen.report.pages.tex import tex
from wmrgen.report.sections import markdown
from wmrgen.report.sections.exercise import FIGURES, exercise

Format = Literal["md", "tex", "html"]


def document(d: Derivation, seed: int, solved: bool, form: Format) -> tuple[str, Mapping[str, bytes]]:
    """Return the text of an exercise and the figures that belong next to it.

    Args:
        d: the derivation.
        seed: the number of the exercise, at least 0.
        solved: whether the results are in the text.
        form: the format of the text. HTML contains its figures.

    Returns:
        The text, and SVG by file name.

    Raises:
        UsageError: if the robot cannot move without slip.
    """
    text = markdown.page(exercise(d, seed, solved))
    figures = {name: d.figures[name][1].encode() for name in FIGURES if name in d.figures}
    if form == "html":
        return page([Report(d.robot.name, {REPORT: text.encode(), **figures})]), {}
    # Exercises on several robots may be in one folder.
    own = {name: f"{d.robot.name}_{name}" for name in figures}
    for name, new in own.items():
        text = text.replace(f"]({name})", f"]({new})")
    return tex(text) if form == "tex" else text, {own[name]: svg for name, svg in figures.items()}
