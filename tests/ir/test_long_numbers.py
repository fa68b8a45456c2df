"""Exact arithmetic on formulas whose numbers grow: consistent axles of sixteen steered wheels."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import wmrgen
from tests.work import ends
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.interpret import EXACT, FLOAT64, evaluate
from wmrgen.ir.lower import lower


@pytest.mark.slow
def test_axles_of_sixteen_wheels(tmp_path: Path) -> None:
    """It ends, and gives what float64 gives."""
    random = np.random.default_rng(5)
    place = np.round(random.uniform(-0.5, 0.5, (16, 3)), 2)
    path = tmp_path / "robot.yaml"
    path.write_text(
        "wmrgen: 1\nname: robot\nwheels:\n"
        + "".join(
            f"  - {{name: w{i}, type: steered, x: {x}, y: {y}, heading: {h}, r: 0.1}}\n"
            for i, (x, y, h) in enumerate(place.tolist())
        ),
        encoding="utf-8",
    )
    function = lower(wmrgen.derive(wmrgen.load(path)).formula("axles"))
    given = {p.name: Exact(Fraction(int(random.integers(-(10**9), 10**9)), 10**9)) for p in function.inputs}
    with ends():
        found = evaluate(function, given, EXACT)
    wanted = evaluate(function, {name: float(value) for name, value in given.items()}, FLOAT64)
    assert {name: float(value) for name, value in found.items()} == pytest.approx(wanted, rel=1e-6, abs=1e-6)
