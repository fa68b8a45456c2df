"""Write the derivation report: one robot as a worked textbook example, in Markdown that GitHub renders.

Each section is a function from the derivation to blocks of Markdown. The result is the first section. Costs and
accuracy of the code have a page of their own, `numerics.md`, and so has the wiring check, `wiring.md`.
"""

from __future__ import annotations

from wmrgen.codegen.registry import Facts
from wmrgen.derivation.facade import Derivation
from wmrgen.report.sections import numerics, wiring
from wmrgen.report.sections.boxes import with_example
from wmrgen.report.sections.example import steps_of
from wmrgen.report.sections.forward import forward
from wmrgen.report.sections.inverse import inverse
from wmrgen.report.sections.markdown import citation, foot, in_symbols, page
from wmrgen.report.sections.mobility import analysis, singular, skid
from wmrgen.report.sections.motion import motion, regular
from wmrgen.report.sections.overview import layout, opening
from wmrgen.report.sections.result import result
from wmrgen.report.sections.rows import matrices, null_space, wheel_rows
from wmrgen.report.sections.texts import texts

FILE = "report.md"
_LAYOUT = (opening, result, layout, wheel_rows, matrices, null_space, analysis, skid)
_MOTION = (inverse, forward, motion)  # of the drive that models the robot, if it skids
_WHOLE = (regular, singular, texts)


@in_symbols
def blocks_of(derivation: Derivation) -> list[str]:
    """Return the blocks of ``report.md``, with the keys of their sentences (`markdown.keys`)."""
    blocks, steps = [], steps_of(derivation)
    for section in (*_LAYOUT, *_MOTION, *_WHOLE):
        own = derivation.driven if section in _MOTION else derivation
        blocks += with_example(section.__name__, own, steps, section(own))
    return blocks


def emit(derivation: Derivation, facts: Facts) -> dict[str, bytes]:
    """Return ``report.md``, ``numerics.md`` and ``wiring.md``; the back end `drawing` writes their figures."""
    rule, last = foot(facts)
    return {
        FILE: page([*blocks_of(derivation), rule, *citation(derivation.robot.name, facts), last]).encode(),
        numerics.FILE: page(numerics.numerics(derivation, facts)).encode(),
        wiring.FILE: page(wiring.wiring(derivation, facts)).encode(),
    }
