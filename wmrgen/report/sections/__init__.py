"""The derivation report: one robot as a worked textbook example, in Markdown that GitHub renders.

Each section is a function from the derivation to blocks of Markdown; the result stands first. What computing it costs,
and how exact that is, is a page of its own, `numerics.md`.
"""

from __future__ import annotations

from wmrgen.codegen.registry import Facts
from wmrgen.derivation.facade import Derivation
from wmrgen.report.sections import numerics, wiring
from wmrgen.report.sections.forward import forward
from wmrgen.report.sections.inverse import inverse
from wmrgen.report.sections.markdown import foot, page
from wmrgen.report.sections.mobility import analysis, singular, skid
from wmrgen.report.sections.motion import motion, regular
from wmrgen.report.sections.overview import layout, opening
from wmrgen.report.sections.result import result
from wmrgen.report.sections.rows import matrices, null_space, wheel_rows
from wmrgen.report.sections.texts import texts

FILE = "report.md"
_LAYOUT = (opening, result, layout, wheel_rows, matrices, null_space, analysis, skid)
_MOTION = (inverse, forward, motion)  # of the drive that turns as the robot does, where it skids
_WHOLE = (regular, singular, texts)


def emit(derivation: Derivation, facts: Facts) -> dict[str, bytes]:
    """``report.md``, whose pictures are another backend's, ``numerics.md`` and ``wiring.md``."""
    blocks = [block for section in _LAYOUT for block in section(derivation)]
    blocks += [block for section in _MOTION for block in section(derivation.driven)]
    blocks += [block for section in _WHOLE for block in section(derivation)]
    return {
        FILE: page([*blocks, *foot(facts)]).encode(),
        numerics.FILE: numerics.numerics(derivation, facts).encode(),
        wiring.FILE: wiring.wiring(derivation, facts).encode(),
    }
