"""Packages of the C of a robot, one record for each kind, and the C++ header that stands in all of them."""

from __future__ import annotations

from wmrgen.codegen.packages.kinds import PACKAGES, SOURCES, Package, of_kinds, packaged

__all__ = ["PACKAGES", "SOURCES", "Package", "of_kinds", "packaged"]
