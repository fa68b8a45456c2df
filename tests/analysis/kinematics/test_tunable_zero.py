"""A steering zero that is tunable: a steered wheel tells as much of the twist as with a zero that is a number."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from wmrgen import derive, load


def test_a_bicycle_turns(tmp_path: Path) -> None:
    """omega = vx tan(steer + zero) / wheelbase, from rear spin and front angle, front spin not being measured."""
    path = tmp_path / "bicycle.yaml"
    path.write_text(
        """
wmrgen: 1
name: bicycle
parameters: {wheelbase: {value: 1.25, tunable: true}, zero: {value: 0, tunable: true}}
wheels:
  - {name: rear, type: fixed, x: 0, y: 0, heading: 0, r: 0.3}
  - {name: front, type: steered, x: wheelbase, y: 0, heading: zero, r: 0.3, actuated: [steer]}
""",
        encoding="utf-8",
    )
    twist = (
        derive(load(path))
        .numpy()
        .forward(**{"rear.spin": 2.0, "front.steer": 0.4, "wheelbase": 1.1, "zero": 0.03})
    )
    assert twist["vx"] == pytest.approx(0.6)
    assert twist["vy"] == pytest.approx(0, abs=1e-15)
    assert twist["omega"] == pytest.approx(0.6 * math.tan(0.43) / 1.1)
    assert twist["slip"] == pytest.approx(0, abs=1e-15)
