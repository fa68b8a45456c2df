"""Coordinates of the admissible twists are speeds: of the steered wheels' pivots, where they stand straight."""

from __future__ import annotations

import pytest

from tests.robots import of_text
from wmrgen.symbolic import signal


@pytest.mark.parametrize("heading", ["0", "pi/2"])
@pytest.mark.parametrize("rear", ["0", "-0.3", "0.2"])
def test_a_bicycle_moves_its_pivot_at_eta(heading: str, rear: str) -> None:
    """Along its heading, also where P stands or moves at another speed."""
    (vx, vy, omega) = of_text(f"""
wmrgen: 1
name: bicycle
wheels:
  - {{name: rear, type: fixed, x: {rear}, y: 0, heading: 0, r: 0.1}}
  - {{name: front, type: steered, x: 0.8, y: 0, heading: {heading}, r: 0.1}}
""").null_space.subs(signal("front.steer"), 0)
    assert abs(vx) + abs(vy + omega * 0.8) == pytest.approx(1)
    assert (vx == 0) == (heading == "pi/2")
