"""Vectors that may vanish: errors in terms of their length hold for short vectors, and are not too large."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from tests.ir.bounds.observe import run
from tests.ir.bounds.small import walked
from tests.ir.bounds.vectors import CASES, RANGES, STILL, function, heading_of, points
from wmrgen.ir.bounds.analysis import analysed
from wmrgen.ir.bounds.assumptions import LIBM
from wmrgen.ir.bounds.patterns import SMALL_ANGLE, facts, lengths
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Op


@pytest.mark.parametrize("name", CASES)
def test_errors_hold_at_every_length(name: str) -> None:
    f = function(CASES[name])
    found = analysed(f, RANGES, LIBM)
    assert not found.alarms
    ((_, vector),) = lengths(f.nodes).items()
    for seed in range(6):
        both = run(f, points(seed))
        h = vector.value(both.exact)
        for claim, k in zip(found.claims, f.results, strict=True):
            single, exact = both.single[k].astype(np.float64), both.exact[k]
            assert claim.low <= single.min() and single.max() <= claim.high
            counts = h >= SMALL_ANGLE * claim.length_error
            assert (
                not claim.length_error
                or np.abs(vector.value(_wide(both.single)) - h).max() <= claim.length_error
            )
            with np.errstate(all="ignore"):
                allowed = claim.error + claim.per_length / h
            assert counts.sum() > 1000
            assert (np.abs(single - exact) <= allowed)[counts].all()


@pytest.mark.parametrize("name", ["steered", "leaning", "quadrant"])
def test_what_is_multiplied_by_the_vector_has_a_bound_of_its_own(name: str) -> None:
    """The error of the angle has a part in 1 / h; the error of a component of the vector has none."""
    angle, component = analysed(function(CASES[name]), RANGES, LIBM).claims
    assert 1e-7 < angle.per_length < 2e-5 and angle.error < 1e-5
    assert component.per_length < 1e-20 and component.error < 3e-5


@pytest.mark.parametrize("factor", [Fraction(1, 4), Fraction(-3)])
def test_a_part_of_a_vector_says_what_is_multiplied(factor: Fraction) -> None:
    b = Builder()
    y = b.input("y")
    x = b.mul(b.const(factor), y)
    said = dict(facts(b.nodes, x, 2.0))
    assert (
        said[x] == 2.0
        and said[y] == pytest.approx(2.0 / abs(factor), rel=1e-4)
        and said[y] >= 2.0 / abs(factor)
    )


def test_another_value_does_not_cancel_the_length() -> None:
    """The error of x cos(heading of another vector) keeps a part in 1 / h."""

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        heading, _ = heading_of(b, b.sub(x, z), b.add(y, z))
        return [b.mul(x, b.cos(heading))]

    (claim,) = analysed(function(make), RANGES, LIBM).claims
    assert claim.per_length > 1e-7


def test_an_angle_of_an_angle_has_no_bound() -> None:
    """The direction of (heading, z) has 1 / h twice: nothing is claimed."""

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        heading, _ = heading_of(b, b.sub(x, z), b.add(y, z))
        return [heading_of(b, heading, z)[0]]

    (claim,) = analysed(function(make), RANGES, LIBM).claims
    assert claim.singular


def test_an_angle_of_a_chosen_angle_has_no_bound() -> None:
    """The same if the angle is the result of a choice."""

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        heading, _ = heading_of(b, b.sub(x, z), b.add(y, z))
        chosen = b.select(x, y, heading, b.add(heading, z))
        return [heading_of(b, chosen, z)[0]]

    (claim,) = analysed(function(make), RANGES, LIBM).claims
    assert claim.singular


@pytest.mark.parametrize("chosen", [False, True])
def test_what_errs_across_a_vector_counts_in_its_length_times_its_angle(chosen: bool) -> None:
    """If the angle is nearly zero, its error times the length is the error of the component across."""

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        v = b.sub(x, b.mul(b.const(Fraction(3, 10)), z))
        w = b.add(y, b.mul(b.const(Fraction(7, 10)), z))
        heading, size = heading_of(b, v, w)
        if chosen:
            heading = b.select(
                b.const(1), heading, b.sub(heading, b.mul(b.const(Fraction(1, 3)), x)), heading
            )
        return [b.mul(size, heading), w]

    ranges = {"x": (30.5, 31.3), "y": (-70.75, -69.95), "z": (100.0, 101.0)}
    f = function(make)
    both, across = analysed(f, ranges, LIBM).claims
    size = walked(f, ranges).errors([i for i, n in enumerate(f.nodes) if n.op is Op.SQRT]).plain[0, 0]
    assert both.error > np.pi * size + across.error


def test_an_angle_may_be_off_by_a_turn_beside_half_a_turn() -> None:
    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        return [b.atan2(b.mul(x, y), z)]

    (claim,) = analysed(function(make), RANGES, LIBM).claims
    assert claim.error > 2 * np.pi


NO_LENGTH: dict[str, Callable[[Builder, int, int], int]] = {
    "kept above less than underflow takes": lambda b, x, y: b.max(
        b.sqrt(b.add(b.square(x), b.square(y))), b.const(Fraction(1, 10**30))
    ),
    "kept below": lambda b, x, y: b.min(b.abs(x), b.const(1)),
    "a product": lambda b, x, y: b.max(b.mul(x, y), b.const(STILL)),
}


@pytest.mark.parametrize("what", NO_LENGTH)
def test_other_divisors_are_no_lengths(what: str) -> None:
    assert not lengths(function(lambda b, x, y, z: [b.div(z, NO_LENGTH[what](b, x, y))]).nodes)


def test_without_the_small_number_there_is_no_length() -> None:
    """A sum of absolute values that may be zero is not kept away from zero."""

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        return [b.div(y, b.add(b.sqrt(b.add(b.square(x), b.square(y))), b.abs(x)))]

    f = function(make)
    assert not lengths(f.nodes)
    assert analysed(f, RANGES, LIBM).alarms


def _wide(values: list[np.ndarray]) -> list[np.ndarray]:
    return [v.astype(np.float64) for v in values]


def test_shares_hold_where_a_limit_does_not_take_the_place_of_a_slope() -> None:
    """Components of (v, w), h = |v|: where |w| is below |v|, it is at most h, and z half of that."""
    f = function(CASES["leaning"])
    w = walked(f, RANGES)
    ((at, length),) = w.lengths.items()
    both = run(f, points(9))
    inside, known = np.abs(both.exact[at]) <= 0.5, 0  # the quotient of z
    h = length.value(both.exact)[inside]
    for i in range(len(f.nodes)):
        bound = w.share_of_length(length, i)
        if bound is not None:
            known += 1
            assert (np.abs(both.exact[i])[inside] <= bound[0] * h + bound[1] + 1e-30).all()
    (z,) = (i for i, n in enumerate(f.nodes) if n.name == "z")
    known_of_z = w.share_of_length(length, z)
    assert known >= 6 and known_of_z is not None and known_of_z[0] == pytest.approx(0.5, rel=1e-3)


def test_shares_hold() -> None:
    """Values are at most s h + a, as claimed."""
    f = function(CASES["steered"])
    w = walked(f, RANGES)
    ((_, length),) = w.lengths.items()
    both = run(f, points(9))
    h, known = length.value(both.exact), 0
    for i in range(len(f.nodes)):
        bound = w.share_of_length(length, i)
        if bound is not None:
            known += 1
            assert (np.abs(both.exact[i]) <= bound[0] * h + bound[1] + 1e-30).all()
    assert known >= 6
