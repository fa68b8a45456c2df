"""The figures of a robot as SVG: the top view with its dimensions, the symbols at its wheels, a motion with the ICR and
the arc of odometry, singular configurations, twists that the limits allow."""

from __future__ import annotations

from wmrgen.codegen.registry import Facts
from wmrgen.derivation.facade import Derivation
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
    """The SVG files."""
    return {file: svg.encode() for file, (_, svg) in derivation.figures.items()}


def figures(derivation: Derivation) -> list[Figure]:
    """Those figures that say something about this robot."""
    drawn = (
        top_view(derivation), wheel_symbols(derivation.robot), motion(derivation), singular(derivation),
        reach(derivation), wiring(derivation),
    )  # fmt: skip
    return [figure for figure in drawn if figure]
