"""Vectors that may vanish: errors in terms of their length hold however short they are, and say something."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from tests.bounds.observe import run
from tests.bounds.small import walked
from wmrgen.bounds.boxes import analysed
from wmrgen.bounds.lengths import SMALL_ANGLE, lengths, share
from wmrgen.bounds.precision import LIBM, SINGLE
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Port, Role

NAMES = ("x", "y", "z")
RANGES = {"x": (-2.0, 2.0), "y": (-2.0, 2.0), "z": (-3.0, 3.0)}
STILL = Fraction(1, 10**20)


def _function(make: Callable[[Builder, int, int, int], list[int]]) -> Function:
    b = Builder()
    at = [b.input(n) for n in NAMES]
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in NAMES)
    results = make(b, *at)
    outputs = tuple(Port(f"o{k}", Role.COMMAND, "1", "an output") for k in range(len(results)))
    return b.function("control", ports, outputs, results)


def _heading(b: Builder, v: int, w: int) -> tuple[int, int]:
    """Twice the arctangent of the slope of the line of (v, w), and the length."""
    size = b.sqrt(b.add(b.square(v), b.square(w)))
    above = b.select(v, b.const(0), b.neg(w), w)
    return b.mul(b.const(2), b.atan(b.div(above, b.max(b.add(size, b.abs(v)), b.const(STILL))))), size


def _steered(b: Builder, x: int, y: int, z: int) -> list[int]:
    """Heading and speed of a wheel off the centre, limited to 1 rad."""
    v, w = b.sub(x, b.mul(b.const(Fraction(3, 10)), z)), b.add(y, b.mul(b.const(Fraction(7, 10)), z))
    heading, size = _heading(b, v, w)
    limited = b.max(b.const(-1), b.min(b.const(1), heading))
    return [limited, b.mul(size, b.cos(b.sub(limited, heading)))]


def _leaning(b: Builder, x: int, y: int, z: int) -> list[int]:
    """A slope between limits, its angle, and what of the vector is along it."""
    v, w = b.sub(x, b.mul(b.const(Fraction(3, 10)), z)), b.mul(b.const(2), z)
    above = b.select(v, b.const(0), b.mul(b.const(-2), z), w)
    slope = b.div(above, b.max(b.abs(v), b.const(STILL)))
    t = b.max(b.const(-1), b.min(b.const(1), slope))
    return [b.atan(t), b.add(v, b.mul(w, t))]


def _quadrant(b: Builder, x: int, y: int, z: int) -> list[int]:
    v, w = b.abs(b.sub(x, b.mul(b.const(Fraction(3, 10)), z))), b.add(y, z)
    angle = b.atan2(w, v)
    return [angle, b.mul(v, b.cos(angle))]


CASES = {"steered": _steered, "leaning": _leaning, "quadrant": _quadrant}


def _points(seed: int, count: int = 40000) -> dict[str, np.ndarray]:
    """Points of which many have a vector of any length down to nothing."""
    rng = np.random.default_rng(seed)
    z = rng.uniform(-1, 1, count)
    short = 10.0 ** rng.uniform(-9, 0.3, count)
    angle = rng.uniform(-np.pi, np.pi, count)
    along = {"x": 0.3 * z + short * np.cos(angle), "y": -0.7 * z + short * np.sin(angle), "z": z}
    return {n: np.clip(v, *RANGES[n]).astype(np.float32) for n, v in along.items()}


@pytest.mark.parametrize("name", CASES)
def test_errors_hold_at_every_length(name: str) -> None:
    f = _function(CASES[name])
    found = analysed(f, RANGES, SINGLE, LIBM)
    assert not found.alarms
    ((_, vector),) = lengths(f.nodes).items()
    for seed in range(6):
        both = run(f, _points(seed))
        h = vector.value(both.exact)
        for claim, k in zip(found.claims, f.results, strict=True):
            single, exact = both.single[k].astype(np.float64), both.exact[k]
            assert claim.low <= single.min() and single.max() <= claim.high
            counts = h >= SMALL_ANGLE * claim.rho
            with np.errstate(all="ignore"):
                allowed = claim.error + claim.over / h
            assert counts.sum() > 1000
            assert (np.abs(single - exact) <= allowed)[counts].all()


@pytest.mark.parametrize("name", CASES)
def test_what_is_multiplied_by_the_vector_has_a_bound_of_its_own(name: str) -> None:
    """The angle is off by a part of 1 / h; what is a component of the vector is not."""
    angle, component = analysed(_function(CASES[name]), RANGES, SINGLE, LIBM).claims
    assert 1e-7 < angle.over < 2e-5 and angle.error < 1e-5
    assert component.over < 1e-20 and component.error < 3e-5


def test_another_value_does_not_cancel_the_length() -> None:
    """x cos(heading of another vector) keeps a part of 1 / h."""

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        heading, _ = _heading(b, b.sub(x, z), b.add(y, z))
        return [b.mul(x, b.cos(heading))]

    (claim,) = analysed(_function(make), RANGES, SINGLE, LIBM).claims
    assert claim.over > 1e-7


def test_an_angle_of_an_angle_has_no_bound() -> None:
    """The direction of (heading, z): 1 / h twice. Nothing is claimed."""

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        heading, _ = _heading(b, b.sub(x, z), b.add(y, z))
        return [_heading(b, heading, z)[0]]

    (claim,) = analysed(_function(make), RANGES, SINGLE, LIBM).claims
    assert claim.singular


def test_without_the_small_number_there_is_no_length() -> None:
    """A divisor that may be zero is one, a sum of sizes or not."""

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        return [b.div(y, b.add(b.sqrt(b.add(b.square(x), b.square(y))), b.abs(x)))]

    f = _function(make)
    assert not lengths(f.nodes)
    assert analysed(f, RANGES, SINGLE, LIBM).alarms


def test_shares_hold() -> None:
    """Whatever is said to be at most s h + a is."""
    f = _function(_steered)
    w = walked(f, RANGES)
    ((_, length),) = w.lengths.items()
    both = run(f, _points(9))
    h, known = length.value(both.exact), 0
    for i in range(len(f.nodes)):
        bound = share(w, length, i)
        if bound is not None:
            known += 1
            assert (np.abs(both.exact[i]) <= bound[0] * h + bound[1] + 1e-30).all()
    assert known >= 6
