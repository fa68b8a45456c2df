"""Sums in which a quantity occurs twice: forms enclose all values, and are not much larger."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from tests.ir.bounds.gallery import proved
from tests.ir.bounds.observe import draw, run
from tests.ir.bounds.small import OUT, walked
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Op, Port, Role

TURN = (-3.2, 3.2)
RANGES = {"p": (-2.0, 2.0), "q": (-1.0, 3.0), "a": TURN, "b": TURN}


def _function(make: Callable[[Builder, dict[str, int]], int]) -> Function:
    builder = Builder()
    at = {n: builder.input(n) for n in RANGES}
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in RANGES)
    return builder.function("control", ports, OUT, [make(builder, at)])


def _bounds(f: Function) -> tuple[float, float]:
    low, high = walked(f, RANGES).ranges[f.results[0]]
    return float(low[0]), float(high[0])


def _seen(f: Function, seed: int) -> tuple[float, float]:
    both = run(f, draw(RANGES, 100000, seed))
    values = np.concatenate([both.single[f.results[0]], both.exact[f.results[0]]])
    return float(values.min()), float(values.max())


@pytest.mark.parametrize("seed", range(8))
def test_products_with_points_of_one_circle_count_together(seed: int) -> None:
    """Sums of p cos a, p sin a, q cos a, q sin a and of another angle: the range is little more than the values."""
    weights = [Fraction(int(w), 4) for w in np.random.default_rng(seed).integers(-9, 10, 6)]

    def make(b: Builder, at: dict[str, int]) -> int:
        waves = [(b.cos(at[x]), b.sin(at[x])) for x in ("a", "b")]
        products = [b.mul(at[p], w) for p in ("p", "q") for w in waves[0]]
        products += [b.mul(at["p"], w) for w in waves[1]]
        return b.sum([b.mul(b.const(w), x) for w, x in zip(weights, products, strict=True)])

    f = _function(make)
    (lo, hi), (least, most) = _bounds(f), _seen(f, seed)
    assert lo <= least and most <= hi
    assert max(-least, most) >= 0.6 * max(-lo, hi)


@pytest.mark.parametrize("seed", range(12))
def test_products_of_points_on_circles_enclose(seed: int) -> None:
    """(linear in cos a, sin a, cos b, sin b) times another such, plus a third: squares, products, one angle or two."""
    rng = np.random.default_rng(seed)
    weights = [[Fraction(int(w), 3) for w in rng.integers(-9, 10, 5)] for _ in range(3)]

    def make(b: Builder, at: dict[str, int]) -> int:
        waves = [w for n in ("a", "b") for w in (b.cos(at[n]), b.sin(at[n]))]
        linear = [
            b.sum([b.const(c[0]), *(b.mul(b.const(w), x) for w, x in zip(c[1:], waves, strict=True))])
            for c in weights
        ]
        return b.add(b.mul(linear[0], linear[1]), linear[2])

    f = _function(make)
    (lo, hi), (least, most) = _bounds(f), _seen(f, seed)
    assert lo <= least and most <= hi
    assert hi - lo <= 2.5 * (most - least)


@pytest.mark.parametrize("name", ["kelly_4ws", "tidybot2", "pr2", "neobotix_mpo_700", "nomad_xr4000"])
def test_divisors_of_castors_are_seen_to_be_positive(name: str) -> None:
    """A Gram determinant of points on circles: between a third of the least that occurs and its largest."""
    for f, b in proved(name).pairs:
        if f.name == "forward":
            (divisor,) = {n.args[1] for n in f.nodes if n.op is Op.DIV}
            lo, hi = (float(end[0]) for end in walked(f, b.inputs).ranges[divisor])
            seen = run(f, draw(b.inputs, 5000, 2)).exact[divisor]
            assert seen.min() / 3 <= lo <= seen.min() and seen.max() <= hi <= 1.5 * seen.max()


def test_what_cancels_counts_nothing() -> None:
    f = _function(lambda b, at: b.make(Op.SUB, [b.make(Op.ADD, [at["p"], at["q"]]), at["p"]]))
    lo, hi = _bounds(f)
    assert lo == pytest.approx(-1, abs=1e-5) and hi == pytest.approx(3, abs=1e-5)


def test_a_rounding_to_a_whole_number_moves_by_half() -> None:
    """x - 2 rint(x / 2) is within 1 of 0, without a special rule."""
    f = _function(
        lambda b, at: b.sub(at["q"], b.mul(b.const(2), b.rint(b.mul(b.const(Fraction(1, 2)), at["q"]))))
    )
    lo, hi = _bounds(f)
    assert lo >= -1 - 1e-5 and hi <= 1 + 1e-5


def test_what_is_rounded_to_a_whole_number_may_be_off() -> None:
    """The float program decides by its own value: the exact one is up to half a step and its error away."""
    f = _function(lambda b, at: b.rint(b.mul(b.const(Fraction(10**5, 3)), at["q"])))
    w = walked(f, RANGES)
    (arg,) = f.nodes[f.results[0]].args
    slack = [w.forms.list[k].slack[0] for k in (arg, f.results[0])]
    assert slack[1] - slack[0] >= 0.5 + w.errors([arg]).plain[0, 0] > 0.503


def test_sines_that_repeat_are_counted_apart() -> None:
    """3 sin a + cos a + sin a, the sine twice in the list of nodes."""

    def make(b: Builder, at: dict[str, int]) -> int:
        s, c = b.sin(at["a"]), b.cos(at["a"])
        b.nodes.append(b.nodes[s])
        again = len(b.nodes) - 1
        return b.make(Op.ADD, [b.make(Op.ADD, [b.mul(b.const(3), s), c]), again])

    assert _bounds(_function(make))[1] >= 17**0.5
