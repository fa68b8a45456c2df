"""Packages around the C of a robot, a record for each kind, and the C++ header that all of them contain.

In come the finished C files and the functions of the robot; out go the files of a package. A package must not change
the C.
"""

from __future__ import annotations

from wmrgen.codegen.packages.kinds import PACKAGES, SOURCES, Package, of_kinds, packaged

__all__ = ["PACKAGES", "SOURCES", "Package", "of_kinds", "packaged"]
