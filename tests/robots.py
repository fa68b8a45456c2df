"""Derivations: of robots of the gallery, each made once for all tests of a process, and of robot files as text."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import wmrgen
from tests.conftest import GALLERY
from wmrgen.derivation.facade import Derivation
from wmrgen.robotfile.load import read_text

ROBOTS = {path.stem: path for path in GALLERY}


@cache
def of_gallery(name: str, *functions: str) -> Derivation:
    """A robot of the gallery; with ``functions``, those alone."""
    return (
        with_functions(of_gallery(name), functions) if functions else wmrgen.derive(wmrgen.load(ROBOTS[name]))
    )


def with_functions(derivation: Derivation, functions: Sequence[str]) -> Derivation:
    """The robot of a derivation with other functions, which change neither its mobility nor formulas that are known."""
    other = wmrgen.derive(derivation.robot, functions)
    other.mobility = derivation.mobility
    other._formulas.update(derivation._formulas)
    return other


def of_text(text: str, functions: Sequence[str] | None = None) -> Derivation:
    """The robot of a robot file with this text."""
    return wmrgen.derive(wmrgen.robot_of(read_text(text, "robot.yaml")), functions)
