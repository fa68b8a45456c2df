"""The layout of a robot: exact positions, headings and radii of its wheels."""

from wmrgen.geometry.layout.build import build
from wmrgen.geometry.layout.records import Geometry, Robot, Wheel

__all__ = ["Geometry", "Robot", "Wheel", "build"]
