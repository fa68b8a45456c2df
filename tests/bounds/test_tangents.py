"""Ranges of functions of angles from their tangents hold every value and are narrower than plain intervals."""

from __future__ import annotations

import numpy as np

from wmrgen.bounds import tangents as ta
from wmrgen.ir.nodes import Op


def test_a_tangent_holds_every_value_on_its_box() -> None:
    rng = np.random.default_rng(1)
    boxes = 500
    low = rng.uniform(-4, 4, (2, boxes))
    high = low + 10.0 ** rng.uniform(-9, 0, (2, boxes))
    x, y = (ta.angle(j, 2, (low[j], high[j])) for j in range(2))
    sx, cy = ta.wave(Op.SIN, x), ta.wave(Op.COS, ta.plus(x, y, -1))
    found = ta.plus(ta.times(sx, cy), ta.negative(ta.times(cy, cy)), 1).range()
    for _ in range(200):
        a, b = rng.uniform(low, high)
        value = np.sin(a) * np.cos(a - b) - np.cos(a - b) ** 2
        assert ((found[0] <= value) & (value <= found[1])).all()


def test_what_stands_twice_counts_once() -> None:
    x = ta.angle(0, 1, (np.array([0.5]), np.array([0.51])))
    s, c = ta.wave(Op.SIN, x), ta.wave(Op.COS, x)
    low, high = ta.plus(ta.times(s, s), ta.times(c, c), 1).range()
    assert 1 - 1e-3 < low[0] <= 1 <= high[0] < 1 + 1e-3
