"""Where every wheel is: exact positions, headings and radii."""

from wmrgen.geometry.layout.build import build
from wmrgen.geometry.layout.records import Geometry, Robot, Wheel

__all__ = ["Geometry", "Robot", "Wheel", "build"]
