"""`lint` is never greener than `derive`: what `derive` calls degenerate has a finding, whatever the layout is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wmrgen
from tests.tools.lint.test_rules import HEAD
from wmrgen.tools.lint import Subject, findings

LAYOUTS = {"WMR030", "WMR031", "WMR034", "WMR035"}
PLACES = (0.0, 0.2, -0.2, 0.35, -0.35)
HEADINGS = ("0", "pi/2", "pi", "30 deg")


def layout(rng: np.random.Generator) -> str:
    """One to four wheels at places and headings that are often on one line, as those of real files are."""
    lines = []
    for k in range(int(rng.integers(1, 5))):
        kind = str(rng.choice(["fixed", "fixed", "fixed", "steered", "castor"]))
        x, y, heading = rng.choice(PLACES), rng.choice(PLACES), rng.choice(HEADINGS)
        trail = ", d: -0.05" if kind == "castor" else ""
        lines.append(
            f"  - {{name: w{k}, type: {kind}, x: {x}, y: {y}, heading: {heading}, r: 0.05{trail}}}\n"
        )
    return f"{HEAD}wheels:\n{''.join(lines)}"


@pytest.mark.parametrize("seed", range(80))
def test_a_degenerate_layout_has_a_finding(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text(layout(np.random.default_rng(seed)), encoding="utf-8")
    spec, robot = wmrgen.read(path)
    mobility = wmrgen.derive(robot).mobility
    codes = {finding.code for finding in findings(Subject(spec, robot, mobility))}
    assert bool(codes & {"WMR030", "WMR031", "WMR035"}) <= mobility.degenerate, codes
    assert mobility.degenerate <= bool(codes & LAYOUTS), path.read_text(encoding="utf-8")
