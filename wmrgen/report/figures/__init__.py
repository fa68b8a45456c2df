"""Draw the figures of a robot as SVG: top view, symbols, a motion, singular configurations, allowed twists, wiring."""

from __future__ import annotations

from wmrgen.codegen.registry import Facts
from wmrgen.derivation.facade import Derivation
from wmrgen.report.figures.contact import contact
from wmrgen.report.figures.figure import Figure
from wmrgen.report.figures.instant import singular
from wmrgen.report.figures.motion import motion
from wmrgen.report.figures.reach import reach
from wmrgen.report.figures.sketch import sketch
from wmrgen.report.figures.symbols import wheel_symbols
from wmrgen.report.figures.top import top_view
from wmrgen.report.figures.wiring import wiring

__all__ = ["emit", "figures", "sketch"]


def emit(derivation: Derivation, facts: Facts) -> dict[str, bytes]:
    """Return the SVG files, by name."""
    return {file: svg.encode() for file, (_, svg) in derivation.figures.items()}


def figures(derivation: Derivation) -> list[Figure]:
    """Return the figures that apply to this robot."""
    drawn = (
        top_view(derivation), wheel_symbols(derivation.robot), contact(derivation.robot), motion(derivation),
        singular(derivation), reach(derivation), wiring(derivation),
    )  # fmt: skip
    return [figure for figure in drawn if figure]
