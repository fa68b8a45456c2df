"""Where every wheel is: exact positions, headings and radii."""

from wmrgen.layout.build import build
from wmrgen.layout.records import Geometry, Robot, Wheel

__all__ = ["Geometry", "Robot", "Wheel", "build"]
