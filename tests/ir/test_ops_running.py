"""Running errors and facts of every operation: they hold for all arguments, and are not much too large."""

from __future__ import annotations

import random
from collections.abc import Iterator
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from tests.ir.defined import RULES, Fact
from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.ir.interpret import EXACT
from wmrgen.ir.ops import OPERATIONS, Op
from wmrgen.ir.ops.analysis import Bounded, from_slopes

Array = np.ndarray
COUNT, MOVES = 400, 40
RUNNING = [op for op in OPERATIONS.values() if op.running]
CHOICES = {Op.MIN, Op.MAX, Op.SELECT, Op.CLAMP, Op.AT_LEAST}  # say what they take
SIGNS = {Op.WITH_SIGN_OF, Op.FLIP}
JUMPS = {*CHOICES, *SIGNS, Op.RINT}
NO_UNIT = np.full((2, 1), 1e-300)  # an error that is infinite stays so
SINGLE = np.array([[2.0**-24], [2.0**-53]])


def compute(op: Op, *args: Array) -> Array:
    if op is Op.SQUARE:
        return args[0] ** 2
    if op is Op.ROUNDING_ERROR:  # of exact numbers; TwoSum of doubles gives what these are off by
        return np.zeros_like(args[0])
    assert op.many is not None
    return np.asarray(op.many(*args), float)


def arguments(op: Op, size: float, seed: int = 1) -> tuple[list[Array], list[Array]]:
    """Values and errors up to ``size``: each argument of either sign, zeros and equal ones among them."""
    chance = np.random.default_rng(seed)
    values = [chance.uniform(-3, 3, COUNT) for _ in range(op.arity)]
    errors = [
        size * chance.uniform(0, 1, COUNT) * (chance.uniform(0, 1, COUNT) < 0.8) for _ in range(op.arity)
    ]
    if op.arity > 1:
        values[1][:40] = values[0][:40] * (1 + size * chance.uniform(-1, 1, 40))
    for k in range(op.arity):
        values[k][40 + 20 * k : 60 + 20 * k] *= size
    if op is Op.SQRT:
        values[0] = np.abs(values[0])
    if op is Op.RINT:
        values[0][:40] = np.floor(values[0][:40]) + 0.5 + size * chance.uniform(-2, 2, 40)
    if op in (Op.CLAMP, Op.AT_LEAST):
        values[1] = np.abs(values[1]) + size
    if op is Op.FLIP:  # whole numbers, which are off by whole ones
        values[1], errors[1] = np.round(values[1] * 2), np.round(chance.uniform(0, 1, COUNT))
    return values, errors


def moved(op: Op, values: list[Array], errors: list[Array]) -> Iterator[list[Array]]:
    """Arguments within the errors, corners first."""
    chance = np.random.default_rng(2)
    for k in range(MOVES):
        at = [
            v
            + e * (np.sign(chance.uniform(-1, 1, COUNT)) if k < MOVES // 2 else chance.uniform(-1, 1, COUNT))
            for v, e in zip(values, errors, strict=True)
        ]
        if op is Op.SQRT:
            at[0] = np.maximum(at[0], 0.0)
        if op in (Op.CLAMP, Op.AT_LEAST):
            at[1] = np.maximum(at[1], 0.0)
        if op is Op.FLIP:
            at[1] = np.round(at[1])
        yield at


def running(op: Op, values: list[Array], errors: list[Array], unit: Array = NO_UNIT) -> Bounded:
    assert op.running is not None
    with np.errstate(all="ignore"):
        result: Bounded = op.running(
            unit, *(Bounded(v, np.stack([e, e])) for v, e in zip(values, errors, strict=True))
        )
    return result


@pytest.mark.parametrize("size", [1e-6, 0.8])
@pytest.mark.parametrize("op", RUNNING, ids=str)
def test_no_arguments_within_their_errors_lead_further(op: Op, size: float) -> None:
    values, errors = arguments(op, size)
    result = running(op, values, errors)
    assert result.value == pytest.approx(compute(op, *values), rel=1e-15, abs=1e-300)
    most = np.zeros(COUNT)
    for at in moved(op, values, errors):
        with np.errstate(all="ignore"):
            off = np.abs(compute(op, *at) - result.value)
        assert (off <= result.error[0] * (1 + 1e-12) + 1e-14).all()
        most = np.maximum(most, off)
    assert (result.error[0] == result.error[1]).all()
    if op in JUMPS or size > 1e-4:
        return
    slack = {Op.ATAN: 11.0, Op.ATAN2: 2.0}.get(op, 1.2)
    clear = np.all([np.abs(v) > 1e-3 for v in values], axis=0)
    assert (result.error[0][clear] <= slack * most[clear] + 1e-11).all()


@pytest.mark.parametrize("op", sorted(JUMPS - {Op.RINT}, key=str), ids=str)
def test_of_a_choice_that_is_sure_the_error_is_that_of_what_is_taken(op: Op) -> None:
    values, errors = arguments(op, 1e-6)
    error = running(op, values, errors).error[0]
    if op is Op.SELECT:
        a, b, x, y = range(4)
        sure = np.abs(values[a] - values[b]) > errors[a] + errors[b]
        wanted = np.where(values[a] < values[b], errors[x], errors[y])
    elif op in SIGNS:
        sure = np.abs(values[1]) > errors[1] if op is Op.WITH_SIGN_OF else errors[1] < 1
        wanted = errors[0]
    else:
        sure, wanted = np.full(COUNT, True), np.maximum(*errors)
        if op is Op.AT_LEAST:  # its sign is sure
            sure = np.abs(values[0]) > errors[0]
    assert sure.sum() > COUNT / 3
    assert error[sure] == pytest.approx(wanted[sure], rel=1e-12)


@pytest.mark.parametrize("size", [1e-6, 0.8])
@pytest.mark.parametrize("op", sorted(CHOICES, key=str), ids=str)
def test_what_is_taken_for_sure_is_taken_everywhere(op: Op, size: float) -> None:
    """By a comparison of the first two arguments, of the size of the first where the second is a limit of it."""
    values, errors = arguments(op, size)
    taken = running(op, values, errors).outcome
    assert taken is not None and taken.shape == (2, COUNT)
    smaller = np.zeros(COUNT)
    for at in moved(op, values, errors):
        first = np.abs(at[0]) if op in (Op.CLAMP, Op.AT_LEAST) else at[0]
        assert (first < at[1])[taken[0] == 1].all() and (first >= at[1])[taken[0] == -1].all()
        smaller += first < at[1]
    doubtful = (smaller > 0) & (smaller < MOVES)
    assert (taken[0][doubtful] == 0).all() and doubtful.any()
    assert (taken[0] == 0).sum() < 2 * doubtful.sum() + COUNT / 8


def test_the_sign_of_a_zero_may_be_read() -> None:
    zero, minus, none = np.array([0.0]), np.array([-0.0]), np.zeros((2, 1))
    one = Bounded(np.array([1.0]), none)
    for a, b, sure in ((zero, zero, True), (minus, minus, True), (zero, minus, False), (minus, zero, False)):
        result = Op.SELECT.running(
            NO_UNIT, Bounded(a, none), Bounded(b, none), one, Bounded(np.array([3.0]), none)
        )
        assert result.value == 3.0 and result.error == pytest.approx(np.full((2, 1), 0.0 if sure else 2.0))
        assert (result.outcome == (-1 if sure else 0)).all()


def test_behind_the_robot_a_direction_may_be_off_by_a_full_turn() -> None:
    """y decides between pi and -pi where x may be negative, or is a zero that is."""
    for x, y, ex, ey, turn in (
        (-1.0, 1e-4, 0.0, 1e-3, True), (-1.0, 1e-2, 0.0, 1e-3, False), (1.0, 0.0, 0.0, 1e-3, False),
        (1e-4, 5e-4, 1e-3, 1e-3, True), (2e-3, 0.0, 1e-3, 1e-3, False), (-0.0, 0.0, 0.0, 0.0, True),
        (0.0, 0.0, 0.0, 0.0, False), (-2.0, 0.0, 0.0, 0.0, True), (1e-3, 0.0, 1e-3, 1e-3, False),
    ):  # fmt: skip
        args = [np.array([v]) for v in (y, x)], [np.array([v]) for v in (ey, ex)]
        error = running(Op.ATAN2, *args).error[0, 0]
        assert (error == 2 * np.pi) == turn, (x, y, ex, ey)
        assert turn or error <= np.pi


def test_near_its_centre_a_direction_is_off_by_half_a_turn() -> None:
    """Nothing is proved where the errors are no small part of the length, 64 times less."""
    for share, small in ((1 / 65, True), (1 / 63, False)):
        error = running(
            Op.ATAN2, [np.array([1.0]), np.array([0.0])], [np.array([0.0]), np.array([share])]
        ).error[0, 0]
        assert error == pytest.approx(1.05 * share if small else np.pi)
    for shift, most in ((0.0, 0.0), (1e-9, np.pi)):
        zero, off = np.array([0.0]), np.array([shift])
        assert running(Op.ATAN2, [zero, zero], [off, zero]).error[0, 0] == pytest.approx(most)


@pytest.mark.parametrize(("op", "top"), [(Op.SIN, np.pi / 2), (Op.COS, np.pi)], ids=str)
def test_waves_at_their_turning_points_err_by_squares(op: Op, top: float) -> None:
    for off, wanted in ((1e-3, 0.5e-6), (0.1, 0.005), (1.0, 0.5), (2.0, 2.0), (30.0, 2.0)):
        error = running(op, [np.array([top])], [np.array([off])]).error[0, 0]
        assert error == pytest.approx(wanted, rel=1e-6)
    steep = running(op, [np.array([top - np.pi / 2])], [np.array([1e-3])]).error[0, 0]
    assert steep == pytest.approx(1e-3 + 0.5e-6, rel=1e-9)


@pytest.mark.parametrize("op", RUNNING, ids=str)
def test_the_rounding_of_the_result_counts(op: Op) -> None:
    values, _ = arguments(op, 1e-3)
    none = [np.zeros(COUNT) for _ in values]
    plain, result = running(op, values, none), running(op, values, none, SINGLE)
    rounds = (result.error - plain.error) / SINGLE
    if not op.rounds:
        assert (rounds == 0).all()
        return
    size = 1.0 if op in (Op.SIN, Op.COS) else np.abs(result.value)
    if op is Op.ROUNDING_ERROR:
        size = np.abs(values[0] + values[1])
    times = {Op.SIN: 4.0, Op.COS: 4.0, Op.ATAN: 12.0, Op.ATAN2: 12.0, Op.COMPENSATED: 2.0}.get(op, 1.0)
    finite = np.isfinite(plain.error).all(axis=0)
    assert rounds[:, finite] == pytest.approx(np.broadcast_to(times * size, (2, COUNT))[:, finite], rel=1e-6)


ONES = (np.ones(1), np.ones(1))
SLOPES = {  # of what does not round, rounds, and is a library's
    Op.NEG: lambda a: ((-ONES[0], -ONES[1]),),
    Op.SUB: lambda a, b: (ONES, (-ONES[0], -ONES[1])),
    Op.MUL: lambda a, b: (b, a),
    Op.SIN: lambda a: ((-ONES[0], ONES[1]),),
    Op.ATAN: lambda a: (((1 + iv.magnitude(a) ** 2) ** -1, ONES[1]),),
}


@pytest.mark.parametrize("op", SLOPES, ids=str)
def test_what_follows_from_derivatives_holds_as_well(op: Op) -> None:
    """It is what an operation from outside has that says no more. The rounding of the result counts in it."""
    rule = from_slopes(SimpleNamespace(many=op.many, slopes=SLOPES[op], ulps=op.ulps, rounds=op.rounds))
    values, errors = arguments(op, 1e-3)
    args = [Bounded(v, np.stack([e, e])) for v, e in zip(values, errors, strict=True)]
    plain, result = rule(NO_UNIT, *args), rule(SINGLE, *args)
    for at in moved(op, values, errors):
        assert (np.abs(compute(op, *at) - result.value) <= plain.error[0] * (1 + 1e-9) + 1e-14).all()
    rounding, size = (2 * op.ulps or op.rounds) * SINGLE, np.abs(result.value)
    assert (result.error >= plain.error + rounding * size * (1 - 1e-9)).all()
    assert (result.error <= (plain.error + rounding * (size + plain.error)) * (1 + 1e-9)).all()


# ---- facts


NUMBERS = [
    Exact(Fraction(n, d)) for n, d in ((-5, 2), (-1, 1), (-1, 3), (0, 1), (1, 4), (1, 1), (2, 1), (7, 2))
]
BOUNDS = [None, Exact(-1), ZERO, Exact(Fraction(1, 4)), Exact(2)]
FACTS = [
    Fact.between(lo, hi, nonzero=nonzero)
    for lo in BOUNDS
    for hi in BOUNDS
    if lo is None or hi is None or lo < hi
    for nonzero in (False, True)
] + [Fact(away=Exact(1), nonzero=True), Fact(Exact(-3), Exact(3), Exact(1), True)]


def satisfies(value: Exact, fact: Fact) -> bool:
    return (
        (fact.lo is None or value >= fact.lo)
        and (fact.hi is None or value <= fact.hi)
        and abs(value) >= fact.away
        and (bool(value) or not fact.nonzero)
    )


@pytest.mark.parametrize("op", [op for op in OPERATIONS.values() if op.exact and op.cost], ids=str)
def test_facts_hold_of_results(op: Op) -> None:
    chance = random.Random(5)
    told = 0
    for _ in range(200):
        facts = [chance.choice(FACTS) for _ in range(op.arity)]
        if op in (Op.CLAMP, Op.AT_LEAST):
            facts[1] = Fact.between(Exact(Fraction(1, 4)), Exact(2))
        if op is Op.SQRT:
            facts[0] = Fact.between(
                ZERO if facts[0].lo is None else max(facts[0].lo, ZERO), None, nonzero=facts[0].nonzero
            )
        if op is Op.DIV:
            facts[1] = Fact(facts[1].lo, facts[1].hi, facts[1].away, True)
        result = RULES[op](*facts) if op in RULES else Fact()
        told += result != Fact()
        options = [[n for n in NUMBERS if satisfies(n, f)] for f in facts]
        if op is Op.FLIP:
            options[1] = [Exact(-3), Exact(-2), ZERO, Exact(1), Exact(4)]
        for _ in range(8 if all(options) else 0):
            args = [chance.choice(o) for o in options]
            assert satisfies(EXACT.of(op)(*args), result), (op, args, facts)
    assert told > 20 or op is Op.ROUNDING_ERROR  # 0 it is of exact numbers alone, so that it says nothing
