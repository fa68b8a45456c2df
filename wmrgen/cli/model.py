"""``wmrgen model``: the models of a robot, written down."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import wmrgen
from wmrgen.cli import console

if TYPE_CHECKING:
    from wmrgen.functions.models.sheet import Sheet
    from wmrgen.robot import Derivation


def run(path: Path, form: str, *, as_json: bool, as_latex: bool) -> int:
    """Print one form of the model of a robot."""
    from wmrgen.functions.models.sheet import data, latex, lines

    with console.progress() as step:
        step(f"deriving {path}")
        robot = wmrgen.load(path)
        for text in robot.notes:
            console.note(f"{robot.name}: note: {text}")
        sheets = _sheets(wmrgen.derive(robot), form)
        if as_json:
            found = [data(sheet) for sheet in sheets]
            console.data(found[0] if len(found) == 1 else found)
            return 0
        written = [latex(sheet) if as_latex else "\n".join(lines(sheet)) for sheet in sheets]
    console.result("\n\n".join(written))
    return 0


def _sheets(derivation: Derivation, form: str) -> list[Sheet]:
    """The chained form is a transformation of state and inputs; any other form a system."""
    from wmrgen.functions.models.sheet import sheet_of
    from wmrgen.functions.trailers.chained_sheet import chained_sheet

    if form == "chained":
        return [chained_sheet(derivation.robot, derivation.mobility)]
    return [sheet_of(form, derivation.system(form, symbolic=True))]
