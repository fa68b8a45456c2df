"""Derivatives backwards, multiples of inputs and lengths from both sides: enclosures, and what they gain."""

from __future__ import annotations

import numpy as np
import pytest

from tests.bounds.gallery import proved
from tests.bounds.observe import draw, run
from wmrgen.bounds import multiples as mu
from wmrgen.bounds.adjoint import Adjoint
from wmrgen.bounds.analysis import Pass
from wmrgen.bounds.boxes import analysed
from wmrgen.bounds.interval import Interval
from wmrgen.bounds.outcomes import Outcomes
from wmrgen.bounds.precision import LIBM, SINGLE
from wmrgen.ir.nodes import Op

BOXES = 60


def _multiple(rng: np.random.Generator, rows: int) -> Interval:
    ends = rng.normal(0, 1, (2, rows, BOXES))
    return ends.min(axis=0), ends.max(axis=0)


def _value(a: Interval, share: np.ndarray, inputs: np.ndarray) -> np.ndarray:
    coefficients = a[0] + (a[1] - a[0]) * share
    return np.asarray(coefficients[0] + (coefficients[1:] * inputs[: len(coefficients) - 1]).sum(axis=0))


@pytest.mark.parametrize("rows", [(3, 3), (3, 1), (1, 3), (1, 1)])
def test_multiples_enclose(rows: tuple[int, int]) -> None:
    rng = np.random.default_rng(sum(rows))
    ends = rng.normal(0, 2, (2, 2, BOXES))
    scales = ends.min(axis=0), ends.max(axis=0)
    a, b = (_multiple(rng, n) for n in rows)
    found = {
        "sum": mu.hull(mu.plus(a, b), scales),
        "difference": mu.hull(mu.plus(a, b, -1), scales),
        "product": mu.hull(mu.times(a, b, scales), scales),
    }
    even = -np.maximum(-scales[0], scales[1]), np.maximum(-scales[0], scales[1])
    most, more = mu.size(a, scales), mu.size(a, even)
    for _ in range(300):
        inputs = scales[0] + (scales[1] - scales[0]) * rng.integers(0, 2, (2, BOXES))
        x, y = (_value(m, rng.integers(0, 2, m[0].shape), inputs) for m in (a, b))
        for name, exact in (("sum", x + y), ("difference", x - y), ("product", x * y)):
            lo, hi = found[name]
            assert ((lo <= exact + 1e-12) & (exact - 1e-12 <= hi)).all(), name
        assert (np.abs(x) <= most + 1e-12).all() and (most <= more + 1e-12).all()


def test_a_rate_that_stands_twice_counts_once() -> None:
    x = mu.unit(0, 1, 1)
    scales = np.full((1, 1), -2.0), np.full((1, 1), 2.0)
    lo, hi = mu.hull(
        mu.plus(x, mu.times(x, mu.plain((np.full(1, 0.5), np.full(1, 0.5))), scales), -1), scales
    )
    assert lo[0] == pytest.approx(-1.0) and hi[0] == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["ackermann_car", "bicycle", "f1tenth", "tidybot2"])
def test_backwards_and_forwards_agree_at_points(name: str) -> None:
    """On boxes that are points, both are the sum of |derivative| times rounding error."""
    for f, b in proved(name).pairs:
        if f.name == "forward":
            points = {n: (v.astype(float), v.astype(float)) for n, v in draw(b.inputs, 200, 4).items()}
            forwards = Pass(f, points, SINGLE, LIBM).run()
            walk = Adjoint(f, points, SINGLE, LIBM)
            walk.run()
            backwards = walk.errors(f.results)
            for k, error in zip(f.results, backwards, strict=True):
                assert error == pytest.approx(forwards.error(k), rel=2e-2, abs=1e-30)


@pytest.mark.parametrize("name", ["kelly_4ws", "tidybot2", "pr2"])
def test_lengths_enclose_the_divisor(name: str) -> None:
    """The divisor of castors is a sum of squares that share the mean: its range is within a tenth of what occurs."""
    for f, b in proved(name).pairs:
        if f.name == "forward":
            (divisor,) = {n.args[1] for n in f.nodes if n.op is Op.DIV}
            whole = {n: (np.array([lo]), np.array([hi])) for n, (lo, hi) in b.inputs.items()}
            lo, hi = Pass(f, whole, SINGLE, LIBM).run().ranges[divisor]
            seen = run(f, draw(b.inputs, 5000, 2)).exact[divisor]
            assert lo[0] <= seen.min() <= 1.1 * lo[0]
            assert seen.max() <= hi[0] <= 1.1 * seen.max()


def test_forward_has_what_its_slip_computes() -> None:
    """One analysis serves both; the one of forward alone claims the same within a fifth."""
    robot = proved("ackermann_car")
    both = [robot.functions[n] for n in ("forward", "forward_slip")]
    ranges = {b.name: b.inputs for _, b in robot.pairs}["forward"]
    shared = Outcomes(both, LIBM).of(both[0], ranges)
    alone = analysed(both[0], ranges, SINGLE, LIBM)
    for one, other in zip(shared.claims, alone.claims, strict=True):
        assert one.error == pytest.approx(other.error, rel=0.2)
    assert Outcomes(both[:1], LIBM).of(both[0], ranges) == alone
