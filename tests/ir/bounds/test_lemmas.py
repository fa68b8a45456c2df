"""Each lemma alone: derivatives are within its partials and fill them, float results are within its noise."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

import numpy as np
import pytest

from tests.ir.bounds.observe import draw, run
from tests.ir.bounds.small import OUT, walked
from wmrgen.ir.bounds.analysis import analysed
from wmrgen.ir.bounds.assumptions import LIBM, SINGLE
from wmrgen.ir.bounds.walk import Walk
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Op, Port, Role
from wmrgen.ir.ops import OPERATIONS

Ranges = Mapping[str, tuple[float, float]]
STEP = 1e-6

# Operation -> how to make it of x and y, and ranges of these.
CASES: dict[Op, tuple[Callable[[Builder, int, int], int], list[Ranges]]] = {
    Op.ADD: (lambda b, x, y: b.add(x, y), [{"x": (-3, 2), "y": (-1, 5)}]),
    Op.SUB: (lambda b, x, y: b.sub(x, y), [{"x": (-3, 2), "y": (-1, 5.5)}]),
    Op.COMPENSATED: (lambda b, x, y: b.apply(Op.COMPENSATED, (x, y)), [{"x": (-3, 2), "y": (-1, 5)}]),
    Op.ROUNDING_ERROR: (lambda b, x, y: b.apply(Op.ROUNDING_ERROR, (x, y)), [{"x": (-3, 2), "y": (-1, 5)}]),
    Op.MUL: (lambda b, x, y: b.mul(x, y), [{"x": (-3, 2), "y": (-1, 5)}, {"x": (2, 3), "y": (-5, -4)}]),
    Op.DIV: (lambda b, x, y: b.div(x, y), [{"x": (-3, 2), "y": (0.5, 5)}, {"x": (2, 3), "y": (-5, -4)}]),
    Op.NEG: (lambda b, x, y: b.neg(x), [{"x": (-3, 2), "y": (0, 1)}]),
    Op.ABS: (lambda b, x, y: b.abs(x), [{"x": (-3, 2), "y": (0, 1)}, {"x": (-3, -2), "y": (0, 1)}]),
    Op.MIN: (lambda b, x, y: b.min(x, y), [{"x": (-3, 2), "y": (-1, 5)}, {"x": (-3, -2), "y": (-1, 5)}]),
    Op.MAX: (lambda b, x, y: b.max(x, y), [{"x": (-3, 2), "y": (-1, 5)}, {"x": (-3, -2), "y": (-1, 5)}]),
    Op.SQRT: (lambda b, x, y: b.sqrt(x), [{"x": (0.1, 9), "y": (0, 1)}]),
    Op.SIN: (lambda b, x, y: b.sin(x), [{"x": (-4, 3), "y": (0, 1)}, {"x": (0.1, 1), "y": (0, 1)}]),
    Op.COS: (lambda b, x, y: b.cos(x), [{"x": (-4, 3), "y": (0, 1)}, {"x": (0.1, 1), "y": (0, 1)}]),
    Op.ATAN: (lambda b, x, y: b.atan(x), [{"x": (-4, 3), "y": (0, 1)}, {"x": (0.5, 1), "y": (0, 1)}]),
    Op.ATAN2: (lambda b, x, y: b.atan2(x, y), [{"x": (-3, 2), "y": (0.2, 5)}]),
    Op.SELECT: (lambda b, x, y: b.select(x, b.const(1), y, x), [{"x": (-3, 2), "y": (-1, 5)}]),
    Op.CLAMP: (lambda b, x, y: b.apply(Op.CLAMP, (b.mul(y, x), b.const(2))), [{"x": (-3, 2), "y": (0.1, 3)}]),
    Op.AT_LEAST: (lambda b, x, y: b.apply(Op.AT_LEAST, (b.mul(y, x), b.const(1))), [{"x": (-3, 2), "y": (0.1, 3)}]),
    Op.WITH_SIGN_OF: (lambda b, x, y: b.apply(Op.WITH_SIGN_OF, (b.mul(x, y), y)), [{"x": (-3, 2), "y": (-1, 5)}]),
}  # fmt: skip
CHOICES = (Op.MIN, Op.MAX, Op.SELECT, Op.CLAMP, Op.AT_LEAST, Op.WITH_SIGN_OF)
EXACT = {
    Op.CONST,
    Op.INPUT,
    Op.RINT,
    Op.FLIP,
}  # without derivatives and, except for constants, without rounding


def _made(op: Op) -> Function:
    b = Builder()
    x, y = b.input("x"), b.input("y")
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in "xy")
    return b.function("control", ports, OUT, [CASES[op][0](b, x, y)])


def test_every_operation_has_a_lemma_that_is_tested() -> None:
    assert {op for op in OPERATIONS.values() if op.lemma} == set(CASES) | EXACT | {Op.SQUARE}


def _allowed(w: Walk, f: Function, points: Mapping[str, np.ndarray]) -> Callable[[str], np.ndarray]:
    """Return how much the result may move per unit of an input, according to the analysis."""

    def of(name: str) -> np.ndarray:
        arg = next((i for i, n in enumerate(f.nodes) if n.name == name), None)
        partials = [p for p in w.partials[f.results[0]] if p.arg == arg]
        most = np.zeros(len(points[name]))
        for p in partials:
            if p.length is not None and p.steep is not None:
                length = w.lengths[p.length].value([points[n.name or ""] for n in f.nodes if n.name])
                most += float(p.steep.max()) / length
            elif isinstance(p.by, int):
                most += 1.0
            else:
                most += float(np.maximum(-p.by[0], p.by[1]).max())
        return most

    return of


def _signed(w: Walk, f: Function) -> Callable[[str], tuple[float, float]]:
    """Return the least and the largest derivative in an input, according to the analysis."""

    def of(name: str) -> tuple[float, float]:
        arg = next((i for i, n in enumerate(f.nodes) if n.name == name), None)
        low = high = 0.0
        for p in w.partials[f.results[0]]:
            if p.arg == arg:
                ends = (p.by, p.by) if isinstance(p.by, int) else (float(p.by[0].min()), float(p.by[1].max()))
                ends = (-np.inf, np.inf) if p.length is not None else ends
                low, high = low + ends[0], high + ends[1]
        return low, high

    return of


@pytest.mark.parametrize("op", [op for op in CASES if op not in CHOICES], ids=str)
def test_derivatives_fill_the_partials(op: Op) -> None:
    f = _made(op)
    for ranges in CASES[op][1]:
        w = walked(f, ranges)
        points = {n: v.astype(np.float64) for n, v in draw(ranges, 4000, 3).items()}
        allowed, signed = _allowed(w, f, points), _signed(w, f)
        here = run(f, points).exact[f.results[0]]
        for name in ranges:
            moved = points | {name: points[name] + STEP}
            change = (run(f, moved).exact[f.results[0]] - here) / STEP
            least, greatest = signed(name)  # unlimited for an angle, whose vector may vanish
            assert least <= change.min() + 1e-4 and change.max() - 1e-4 <= greatest
            ends = pytest.approx((change.min(), change.max()), rel=1e-4, abs=1e-4)
            assert op is Op.ATAN2 or (least, greatest) == ends
            change = np.abs(change)
            assert (change <= allowed(name) * (1 + 1e-4) + 1e-4).all(), f"{op} in {name}"


@pytest.mark.parametrize("op", [Op.MIN, Op.MAX, Op.SELECT], ids=str)
def test_a_choice_is_off_by_no_more_than_the_worse(op: Op) -> None:
    b = Builder()
    x, y = (b.mul(b.const(Fraction(1, d)), b.input(n)) for n, d in (("x", 3), ("y", 7)))
    made = b.select(b.input("x"), b.const(1), x, y) if op is Op.SELECT else b.make(op, [x, y])
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in "xy")
    f = b.function("control", ports, OUT, [made])
    ranges = {"x": (-3.0, 3.0), "y": (-9.0, 9.0)}
    w = walked(f, ranges)
    first, second, chosen = w.errors([x, y, made]).plain[:, 0]
    assert first > 0 < second and chosen == pytest.approx(max(first, second))
    if op is not Op.SELECT:  # the ends of the ranges alone decide nothing
        w = walked(f, {"x": (-6.0, 3.0), "y": (-9.0, 30.0)})
        first, second, chosen = w.errors([x, y, made]).plain[:, 0]
        assert chosen == pytest.approx(second) and second > first
    w = walked(f, {"x": (-3.0, -2.9), "y": (7.0, 9.0)})  # decided everywhere
    first, second, chosen = w.errors([x, y, made]).plain[:, 0]
    assert chosen == pytest.approx(second if op is Op.MAX else first)


@pytest.mark.parametrize("op", CASES, ids=str)
def test_float_results_are_within_the_error_and_near_it(op: Op) -> None:
    f = _made(op)
    for ranges in CASES[op][1]:
        w = walked(f, ranges)
        errors = w.errors(f.results)
        points = draw(ranges, 60000, 4)
        both = run(f, points)
        low, high = (float(end[0]) for end in w.ranges[f.results[0]])
        single, exact = both.single[f.results[0]].astype(np.float64), both.exact[f.results[0]]
        off = float(np.abs(single - exact).max())
        assert low <= min(single.min(), exact.min()) and max(single.max(), exact.max()) <= high
        assert off <= errors.plain[0, 0]
        assert errors.plain[0, 0] <= 4.1 * off, "a bound that far off would hide a wrong lemma"


def test_a_branch_reaches_as_far_as_the_comparison_lets_it() -> None:
    """x if 1 < x, else 5: the range starts at 1."""
    b = Builder()
    x = b.input("x")
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in "x")
    f = b.function("control", ports, OUT, [b.select(b.const(1), x, x, b.const(5))])
    low, high = walked(f, {"x": (-3.0, 3.0)}).ranges[f.results[0]]
    assert 0.99 < low[0] <= 1 and high[0] == pytest.approx(5)


def test_a_sum_that_is_rounded_twice_errs_twice() -> None:
    boxes = {"x": (1.0, 2.0), "y": (1.0, 1.5)}
    once, twice = (analysed(_made(op), boxes, LIBM).claims[0].error for op in (Op.ADD, Op.COMPENSATED))
    assert twice == pytest.approx(2 * once)


def test_known_errors_replace_larger_ones() -> None:
    f = _made(Op.MUL)
    (k,) = f.results
    boxes = {"x": (np.array([1.0]), np.array([2.0])), "y": (np.array([1.0]), np.array([1.5]))}
    plain = Walk(f, boxes, SINGLE, LIBM).run().errors([k, k]).plain[0, 0]
    for share in (0.25, 4.0):
        known = Walk(f, boxes, SINGLE, LIBM, upper={k: np.array([share * plain])}).run()
        known.singular.add(-1)  # nothing is taken on trust where a formula is singular
        assert known.errors([k]).plain[0, 0] == pytest.approx(min(share, 1.0) * plain)


@pytest.mark.parametrize(
    "op", [Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.SQRT, Op.SIN, Op.COS, Op.ATAN, Op.ATAN2], ids=str
)
def test_half_the_noise_is_seen_to_be_too_little(op: Op) -> None:
    """The negative control of the test above."""
    f = _made(op)
    ranges = CASES[op][1][0]
    both = run(f, draw(ranges, 60000, 4))
    off = np.abs(both.single[f.results[0]].astype(np.float64) - both.exact[f.results[0]]).max()
    assert off > walked(f, ranges).errors(f.results).plain[0, 0] / 2 / (2.0 if op is Op.ATAN2 else 1.0)
