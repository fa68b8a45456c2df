"""The figures of a robot as SVG: the top view with its dimensions, the symbols at its wheels, a motion with the ICR and
the arc of odometry, singular configurations, twists that the limits allow."""

from __future__ import annotations

from wmrgen.backends.drawing.figure import Figure
from wmrgen.backends.drawing.instant import singular
from wmrgen.backends.drawing.motion import motion
from wmrgen.backends.drawing.reach import reach
from wmrgen.backends.drawing.sketch import sketch
from wmrgen.backends.drawing.symbols import wheel_symbols
from wmrgen.backends.drawing.top import top_view
from wmrgen.backends.drawing.wiring import wiring
from wmrgen.backends.registry import Facts
from wmrgen.robot import Derivation

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
