"""No bound is below the effect that single roundings can have at a point (`tests.ir.bounds.perturbed`)."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from tests.ir.bounds import perturbed
from tests.ir.bounds.gallery import NAMES, proved
from tests.ir.bounds.observe import draw, lengths, run
from tests.ir.bounds.vectors import CASES, RANGES, function, points
from wmrgen.ir.bounds.analysis import analysed
from wmrgen.ir.bounds.assumptions import LIBM
from wmrgen.ir.bounds.patterns import SMALL_ANGLE
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Op

SECOND_ORDER = 1.03  # what the sum over single roundings may be above what they do together


@pytest.mark.parametrize("name", NAMES)
def test_no_bound_is_below_what_roundings_can_do(name: str) -> None:
    for f, bound in proved(name).pairs:
        if not bound.inputs:
            continue
        inputs = draw(bound.inputs, 300, 11)
        able, both = perturbed.worst(f, inputs), run(f, inputs)
        for row, (o, k) in enumerate(zip(bound.outputs, f.results, strict=True)):
            h = lengths(f, both, k) if o.from_length else np.full(300, np.inf)
            counts = h >= o.from_length
            assert (able[row] <= (o.error + o.per_length / h) * SECOND_ORDER)[counts].all(), (
                f"{f.name}: {o.name}"
            )


@pytest.mark.parametrize("name", CASES)
def test_no_bound_in_terms_of_a_length_is_below_what_roundings_can_do(name: str) -> None:
    f = function(CASES[name])
    for ranges, inputs in ((RANGES, points(1, 3000)), far(2, 3000)):
        claims = analysed(f, ranges, LIBM).claims
        able, both = perturbed.worst(f, inputs), run(f, inputs)
        for row, (claim, k) in enumerate(zip(claims, f.results, strict=True)):
            h = lengths(f, both, k)
            counts = h >= SMALL_ANGLE * claim.length_error
            assert counts.sum() > 300
            with np.errstate(all="ignore"):
                allowed = claim.error + claim.per_length / h
            assert (able[row] <= allowed * SECOND_ORDER)[counts].all()
            assert (able[row] >= allowed / 50)[counts].any(), (
                "a bound far above all that can be hides what it lacks"
            )


SMALL: dict[str, Callable[[Builder, int, int, int], int]] = {
    "length": lambda b, x, y, z: b.sqrt(b.add(b.square(x), b.mul(b.const(Fraction(17, 10)), b.square(y)))),
    "length of what errs": lambda b, x, y, z: b.sqrt(
        b.add(b.mul(b.const(9), b.square(b.mul(x, z))), b.square(b.mul(x, b.mul(y, z))))
    ),
    "product in two sums": lambda b, x, y, z: b.make(
        Op.SUB, [b.make(Op.ADD, [b.mul(x, y), z]), b.make(Op.ADD, [b.mul(x, y), b.const(100)])]
    ),
    "product with a whole number": lambda b, x, y, z: b.mul(b.rint(b.mul(b.const(Fraction(11, 5)), x)), y),
    "square": lambda b, x, y, z: b.square(b.mul(x, z)),
    "quotient": lambda b, x, y, z: b.div(b.mul(x, z), b.add(b.const(3), b.mul(b.const(Fraction(2, 7)), y))),
    "waves": lambda b, x, y, z: b.mul(b.sin(b.mul(x, z)), b.cos(b.mul(y, z))),
    "arctangent": lambda b, x, y, z: b.atan(b.mul(x, b.mul(y, z))),
    "root": lambda b, x, y, z: b.sqrt(b.add(b.const(5), b.mul(x, z))),
}


@pytest.mark.parametrize("name", SMALL)
def test_small_functions_are_bounded_closely(name: str) -> None:
    """At the points of small boxes bounds are within a factor 2.5 of what roundings can do: nothing hides."""
    f = function(lambda b, x, y, z: [SMALL[name](b, x, y, z)])
    rng = np.random.default_rng(5)
    for _ in range(6):
        centre = {n: rng.uniform(-1.3, 1.3) for n in RANGES}
        ranges = {n: (c, c + 1e-3) for n, c in centre.items()}
        inputs = {n: rng.uniform(lo, hi, 200).astype(np.float32) for n, (lo, hi) in ranges.items()}
        able = perturbed.worst(f, inputs)[0]
        (claim,) = analysed(f, ranges, LIBM).claims
        assert able.max() <= claim.error * 1.001 <= 2.5 * able.max() * 1.001 + 1e-12


def far(seed: int, count: int) -> tuple[dict[str, tuple[float, float]], dict[str, np.ndarray]]:
    """A vector that is the small difference of large numbers: all its error is that of its components."""
    rng = np.random.default_rng(seed)
    z = rng.uniform(100, 101, count)
    v, w = rng.uniform(0.5, 1, count), rng.uniform(-0.05, 0.05, count)
    ranges = {"x": (30.5, 31.3), "y": (-70.75, -69.95), "z": (100.0, 101.0)}
    values = {"x": 0.3 * z + v, "y": -0.7 * z + w, "z": z}
    return ranges, {n: np.clip(u, *ranges[n]).astype(np.float32) for n, u in values.items()}
