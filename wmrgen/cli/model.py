"""``wmrgen model``: the models of a robot, written down."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wmrgen.cli import console
from wmrgen.cli.loading import derived

if TYPE_CHECKING:
    from wmrgen.functions.models.sheet import Sheet
    from wmrgen.robot import Derivation


def run(path: Path, form: str, *, as_json: bool, as_latex: bool) -> int:
    """Print one form of the model of a robot."""
    from wmrgen.functions.models.sheet import data, latex, lines

    with derived(path) as derivation:
        sheet = _sheet(derivation, form)
        if as_json:
            console.data(data(sheet))
            return 0
        text = latex(sheet) if as_latex else "\n".join(lines(sheet))
    console.result(text)
    return 0


def _sheet(derivation: Derivation, form: str) -> Sheet:
    """The chained form is a transformation of state and inputs; any other form a system."""
    from wmrgen.functions.models.sheet import sheet_of
    from wmrgen.functions.trailers.chained_sheet import chained_sheet

    if form == "chained":
        return chained_sheet(derivation.robot, derivation.mobility)
    return sheet_of(form, derivation.system(form, symbolic=True))
