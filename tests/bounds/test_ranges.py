"""Ranges that plain intervals do not have: arms of one angle in a sum, angles that limits allow."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from tests.bounds.gallery import proved
from tests.bounds.observe import draw, run
from tests.bounds.small import ONE_INPUT, OUT, walked
from wmrgen.bounds.pieces import turns
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Port, Role

TURN = (-3.2, 3.2)
LIMITS = {
    "uneven": (-2, 1),
    "half a turn but for 0.0016": (Fraction(-157, 100), Fraction(157, 100)),
    "one radian": (0, 1),
}


@pytest.mark.parametrize("seed", range(8))
def test_arms_of_one_angle_count_together(seed: int) -> None:
    """Sums of p cos a, p sin a, q cos a, q sin a and of another angle: all that occurs, and little more."""
    rng = np.random.default_rng(seed)
    weights = [Fraction(int(w), 4) for w in rng.integers(-9, 10, 6)]
    ranges = {"p": (-2.0, 2.0), "q": (-1.0, 3.0), "a": TURN, "b": TURN}
    b = Builder()
    at = {n: b.input(n) for n in ranges}
    waves = [(b.cos(at[x]), b.sin(at[x])) for x in ("a", "b")]
    products = [b.mul(at[p], w) for p in ("p", "q") for w in waves[0]] + [b.mul(at["p"], w) for w in waves[1]]
    terms = [b.mul(b.const(w), x) for w, x in zip(weights, products, strict=True)]
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in ranges)
    f = b.function("sum", ports, OUT, [b.sum(terms)])
    lo, hi = (float(end[0]) for end in walked(f, ranges).range(f.results[0]))
    found = run(f, draw(ranges, 200000, seed))
    for values in (found.single[f.results[0]], found.exact[f.results[0]]):
        assert lo <= values.min() and values.max() <= hi
        assert np.abs(values).max() >= 0.7 * max(-lo, hi)


def _to_the_limit(low: Fraction | int, high: Fraction | int) -> Function:
    """sin(x - h), x the heading h, or the opposite one, or the nearest limit."""
    b = Builder()
    h, least, most = b.mul(b.const(3), b.input("vx")), b.const(low), b.const(high)
    half = b.const(Fraction(355, 113))
    opposite = b.select(most, h, b.sub(h, half), b.add(h, half))
    inside = b.select(opposite, least, h, b.select(most, opposite, h, opposite))
    best = b.select(h, least, inside, b.select(most, h, inside, h))
    x = b.max(least, b.min(most, best))
    return b.function("control", ONE_INPUT, OUT, [b.sin(b.sub(x, h))])


@pytest.mark.parametrize("limits", LIMITS)
def test_turns_within_limits_are_known_piece_by_piece(limits: str) -> None:
    low, high = LIMITS[limits]
    f = _to_the_limit(low, high)
    ranges = {"vx": (-1.05, 1.05)}
    walk, points = walked(f, ranges), draw(ranges, 100000, 1)
    found, (angle,) = run(f, points), f.nodes[f.results[0]].args
    pieces = turns(walk, angle)
    assert pieces is not None
    for values in (found.single[angle].astype(np.float64), found.exact[angle]):
        inside = [(float(lo[0]) <= values) & (values <= float(hi[0])) for lo, hi in pieces]
        assert np.any(inside, axis=0).all()
    sine = np.abs(found.exact[f.results[0]]).max()
    most = float(walk.range(f.results[0])[1][0])
    assert sine <= most <= sine + 2e-3


def test_another_angle_has_no_pieces() -> None:
    f = _to_the_limit(-1, 1)
    nodes = list(f.nodes)
    (angle,) = nodes[f.results[0]].args
    walk = walked(f, {"vx": (-1.05, 1.05)})
    assert turns(walk, nodes[angle].args[0]) is None  # no difference
    b = Builder()
    x = b.input("vx")
    g = b.function("g", ONE_INPUT, OUT, [b.sub(b.square(x), x)])
    assert turns(walked(g, {"vx": (-1.0, 1.0)}), g.results[0]) is None  # x x is no piece of x


def test_a_slip_at_a_limit_is_small() -> None:
    """Limits half a turn apart but for 0.0016 rad: 4.2 m/s slide by 7 mm/s. At standstill headings are 1/64 rad off."""
    (bound,) = [b for f, b in proved("agilex_ranger").pairs if f.name == "inverse_slip"]
    assert 4.2 / 64 < bound.outputs[0].high < 0.08
