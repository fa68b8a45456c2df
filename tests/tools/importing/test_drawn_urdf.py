"""Robots that are drawn, in trees of links that stand anywhere: import finds each wheel, and takes nothing else for
one."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Outcome
from tests.depth import DEEP
from tests.tools.importing.drawn_urdf import unsnapped

Cli = Callable[..., Outcome]


@pytest.mark.parametrize("seed", range(200 if DEEP else 6))
def test_drawn_wheels_are_found_where_they_are(wmrgen_cli: Cli, tmp_path: Path, seed: int) -> None:
    text, truth = unsnapped(seed)
    (tmp_path / "drawn.urdf").write_text(text, encoding="utf-8")
    done = wmrgen_cli("import", tmp_path / "drawn.urdf", "--json")
    assert done.code == 0, done.err
    found = {w["joint"]: w for w in json.loads(done.out)["wheels"]}
    assert set(found) == set(truth)
    for name, true in truth.items():
        w = found[name]
        assert w["type"] == true.type, name
        assert (w["x"], w["y"], w["r"]) == pytest.approx((true.x, true.y, true.r), abs=1e-9), name
        assert abs(math.remainder(w["heading"] - true.heading, 2 * math.pi)) < 1e-9, name
        assert (w["d"] or 0.0, w["offset_y"] or 0.0) == pytest.approx((true.d, true.offset_y), abs=1e-9), name
        if true.gamma is not None:
            assert abs(math.remainder(w["gamma"] - true.gamma, math.pi)) < 1e-9, name
