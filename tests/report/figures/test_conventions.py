"""The figures of docs/conventions.md are those of today, and of each wheel type there is one."""

from __future__ import annotations

from tests.conftest import ROOT
from tests.report.figures.conventions import FOLDER, WHEELS, figures
from tests.report.figures.test_drawing import well_set


def test_the_figures_are_fresh_and_shown() -> None:
    page = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8")
    drawn = {shown.file: shown for shown in figures()}
    assert {path.name for path in FOLDER.glob("*.svg")} == drawn.keys()
    for file, shown in drawn.items():
        assert (FOLDER / file).read_text(encoding="utf-8") == shown.svg, (
            "python -m tests.report.figures.conventions"
        )
        assert f"](figures/{file})" in page
    well_set({file: (shown.alt, shown.svg) for file, shown in drawn.items()})
    assert all(f"type: {name}," in WHEELS for name in ("fixed", "steered", "castor", "swedish", "spherical"))
