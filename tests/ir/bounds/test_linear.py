"""One rate at a time: the lemma holds, it is used only where it applies, and it gives smaller bounds."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.ir.bounds.gallery import proved
from tests.ir.bounds.observe import draw
from tests.ir.bounds.small import OUT
from wmrgen.ir.bounds.analysis import boxed, errors_one_by_one
from wmrgen.ir.bounds.assumptions import LIBM, SINGLE
from wmrgen.ir.bounds.walk import Walk
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Op, Port, Role


@pytest.mark.parametrize("name", ["ackermann_car", "bicycle", "f1tenth", "tidybot2"])
def test_it_is_no_less_than_the_analysis_at_points_and_near_it(name: str) -> None:
    """At a point, errors are the sum of |derivative| times rounding error, with no range to overestimate them."""
    for f, b in proved(name).pairs:
        if f.name == "forward":
            points = {n: (v.astype(float), v.astype(float)) for n, v in draw(b.inputs, 400, 4).items()}
            at_points = Walk(f, points, SINGLE, LIBM).run().errors(f.results).plain
            angles = {n: points[n] if n.endswith("steer") else _whole(b.inputs[n], 400) for n in points}
            known = errors_one_by_one(f, angles, LIBM)
            for k, error in zip(f.results, at_points, strict=True):
                if error.any():
                    assert (error <= known[k] * (1 + 1e-9)).all()
                    assert known[k].max() <= 25 * error.max()


def _whole(ends: tuple[float, float], count: int) -> tuple[np.ndarray, np.ndarray]:
    return np.full(count, ends[0]), np.full(count, ends[1])


def test_what_cancels_is_seen_to_cancel() -> None:
    """x a - x (a + b): what a is off by counts nothing."""
    known = _known(lambda b, x, a, c: b.sub(b.mul(x, b.sin(a)), b.mul(x, b.add(b.sin(a), c))))
    ranges = {"x": (-1.0, 1.0), "a": (0.0, 1.0), "c": (0.0, 1e-3)}
    f = _function(lambda b, x, a, c: b.sub(b.mul(x, b.sin(a)), b.mul(x, b.add(b.sin(a), c))))
    plain = Walk(f, boxed(ranges, [], 1), SINGLE, LIBM).run().errors(f.results).plain
    assert known and known[f.results[0]][0] < 0.8 * plain[0, 0]


def _function(make: Callable[[Builder, int, int, int], int]) -> Function:
    b = Builder()
    x, a, c = (b.input(n) for n in "xac")
    roles = (Role.COMMAND, Role.STATE, Role.GEOMETRY)
    ports = tuple(Port(n, role, "1", "an input") for n, role in zip("xac", roles, strict=True))
    return b.function("control", ports, OUT, [make(b, x, a, c)])


def _known(make: Callable[[Builder, int, int, int], int]) -> dict[int, np.ndarray]:
    ranges = {"x": (-1.0, 1.0), "a": (0.0, 1.0), "c": (0.0, 1e-3)}
    return errors_one_by_one(_function(make), boxed(ranges, [], 1), LIBM)


NOT_LINEAR: dict[str, Callable[[Builder, int, int, int], int]] = {
    "a square": lambda b, x, a, c: b.mul(b.square(x), b.sin(a)),
    "a sum with a number": lambda b, x, a, c: b.add(b.mul(x, b.sin(a)), b.const(1)),
    "a choice by a rate": lambda b, x, a, c: b.select(x, b.sin(a), x, b.mul(x, b.cos(a))),
    "a quotient by a rate": lambda b, x, a, c: b.div(b.sin(a), b.max(b.abs(x), b.const(1))),
    "a limited rate": lambda b, x, a, c: b.mul(b.min(x, b.const(1)), b.sin(a)),
    "a choice of a rate or -1": lambda b, x, a, c: b.select(b.sin(a), c, b.mul(x, b.cos(a)), b.const(-1)),
    "a choice of 1 or a rate": lambda b, x, a, c: b.select(b.sin(a), c, b.const(1), b.mul(x, b.cos(a))),
}
LINEAR: dict[str, Callable[[Builder, int, int, int], int]] = {
    "a product": lambda b, x, a, c: b.mul(x, b.sin(a)),
    "an opposite": lambda b, x, a, c: b.neg(b.mul(x, b.sin(a))),
    "a difference": lambda b, x, a, c: b.sub(b.mul(x, b.sin(a)), b.mul(x, c)),
    "a quotient": lambda b, x, a, c: b.div(b.mul(x, b.sin(a)), b.add(c, b.const(2))),
    "a choice of rates": lambda b, x, a, c: b.select(b.sin(a), c, b.mul(x, b.cos(a)), x),
    "a choice of a rate or 0": lambda b, x, a, c: b.select(b.sin(a), c, b.mul(x, b.cos(a)), b.const(0)),
    "a choice of 0 or a rate": lambda b, x, a, c: b.select(b.sin(a), c, b.const(0), b.mul(x, b.cos(a))),
}


@pytest.mark.parametrize("what", NOT_LINEAR)
def test_what_is_not_linear_is_left_alone(what: str) -> None:
    assert not _known(NOT_LINEAR[what])


@pytest.mark.parametrize("what", LINEAR)
def test_what_is_linear_is_known(what: str) -> None:
    assert _known(LINEAR[what])


def test_roundings_of_a_sum_are_those_of_its_parts() -> None:
    """x + x + x errs as 5.7 does, by half a unit of [4, 8): more than three times that of 1.9."""
    b = Builder()
    at = [b.input(n) for n in "xyz"]
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in "xyz")
    third = b.make(Op.ADD, [b.make(Op.ADD, at[:2]), at[2]])
    f = b.function("control", ports, OUT, [third])
    boxes = boxed(dict.fromkeys("xyz", (-1.9, 1.9)), [], 1)
    assert errors_one_by_one(f, boxes, LIBM)[third][0] >= 2.0**-22


def test_a_length_of_linear_parts_is_known_by_its_parts() -> None:
    known = _known(
        lambda b, x, a, c: b.sqrt(b.add(b.square(b.mul(x, b.sin(a))), b.square(b.mul(x, b.cos(a)))))
    )
    assert len(known) == 2
