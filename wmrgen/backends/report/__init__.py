"""The derivation report: one robot as a worked textbook example, in Markdown that GitHub renders."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wmrgen.backends.registry import Facts
from wmrgen.backends.report.analysis import analysis
from wmrgen.backends.report.closing import cost, singular
from wmrgen.backends.report.forward import forward
from wmrgen.backends.report.functions import functions
from wmrgen.backends.report.inverse import inverse
from wmrgen.backends.report.markdown import page
from wmrgen.backends.report.matrices import matrices, null_space
from wmrgen.backends.report.motion import motion
from wmrgen.backends.report.overview import layout, opening
from wmrgen.backends.report.subject import subject
from wmrgen.backends.report.texts import texts
from wmrgen.backends.report.wheelrows import wheel_rows

if TYPE_CHECKING:
    from wmrgen.robot import Derivation

FILE = "report.md"
_PARTS = (
    opening, layout, wheel_rows, matrices, null_space, analysis, inverse, forward, motion, singular, texts,
)  # fmt: skip


def emit(derivation: Derivation, facts: Facts) -> dict[str, bytes]:
    """``report.md``; its picture, ``layout.svg``, is another backend's."""
    s = subject(derivation)
    blocks = [block for part in _PARTS for block in part(s)]
    further = functions(s)
    blocks += further + cost(s, facts, 12 if further else 11)
    return {FILE: page(blocks).encode()}
