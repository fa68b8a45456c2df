"""The top view of a robot as an SVG picture: wheels to scale, axle lines, rollers at the ground, the ICR."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wmrgen.backends.drawing.scene import picture
from wmrgen.backends.registry import Facts

if TYPE_CHECKING:
    from wmrgen.robot import Derivation

FILE = "layout.svg"


def emit(derivation: Derivation, facts: Facts) -> dict[str, bytes]:
    """``layout.svg``"""
    return {FILE: picture(derivation).encode()}
