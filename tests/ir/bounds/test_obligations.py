"""What must be shown before anything is claimed: beyond each threshold there is an alarm, before it there is none."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from tests.ir.bounds.oracle import Runs
from tests.ir.bounds.programs import points
from tests.ir.bounds.small import function, walked
from tests.ir.bounds.vectors import function as of_three
from tests.ir.bounds.vectors import heading_of
from wmrgen.ir.bounds.analysis import Outcome, Outcomes, analysed, boxed
from wmrgen.ir.bounds.assumptions import LIBM, SINGLE, Library, library
from wmrgen.ir.bounds.patterns import SMALL_ANGLE
from wmrgen.ir.build import Builder
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Function, Op, Port, Role

LEAST = 2.0**-149  # the least float32
KERNELS = library(Choice("float", "inline", "m4f"))
REACH = float(KERNELS.reach)
Range = tuple[float, float]
One = Callable[[Builder, int], int]


def above(x: float) -> float:
    """The next float32."""
    return float(np.nextafter(np.float32(x), np.float32(np.inf)))


def reciprocal_of_more(b: Builder, x: int) -> int:
    return b.div(b.const(Fraction(1, 10**30)), x)


# What is made of x, ranges at which nothing is amiss, ranges just beyond, and the operation of the alarm.
THRESHOLDS: dict[str, tuple[One, list[Range], list[Range], Op, Library]] = {
    "a divisor": (
        reciprocal_of_more,
        [(1e-20, 1.0), (-1.0, -1e-20)],
        [(0.0, 1.0), (-1.0, 0.0), (-1.0, -0.0), (-LEAST, 1.0), (0.0, 0.0)],
        Op.DIV,
        LIBM,
    ),
    "a root": (lambda b, x: b.sqrt(x), [(0.0, 1.0), (-0.0, 1.0)], [(-LEAST, 1.0), (-1.0, 0.0)], Op.SQRT, LIBM),
    "the largest float": (
        lambda b, x: b.add(x, x),
        [(0.0, 0.999 * SINGLE.largest / 2), (-0.999 * SINGLE.largest / 2, 0.0)],
        [(0.0, 1.001 * SINGLE.largest / 2), (-1.001 * SINGLE.largest / 2, 0.0)],
        Op.ADD,
        LIBM,
    ),
    "an angle of our own sines": (
        lambda b, x: b.sin(x), [(-REACH, REACH)], [(0.0, above(REACH)), (-above(REACH), 0.0)], Op.SIN, KERNELS
    ),
    "an angle of our own cosines": (
        lambda b, x: b.cos(x), [(-REACH, REACH)], [(0.0, above(REACH)), (-above(REACH), 0.0)], Op.COS, KERNELS
    ),
    "a slope of our own arctangent": (lambda b, x: b.atan(x), [(-1.0, 1.0)], [(0.0, above(1.0))], Op.ATAN, KERNELS),
    # Adding 1.5 * 2**23 rounds numbers of up to 2**22 to whole ones.
    "a whole number": (lambda b, x: b.rint(x), [(-(2.0**22), 2.0**22)], [(0.0, above(2.0**22))], Op.RINT, LIBM),
}  # fmt: skip


@pytest.mark.parametrize("name", THRESHOLDS)
def test_alarms_begin_at_the_threshold(name: str) -> None:
    make, good, bad, op, assumed = THRESHOLDS[name]
    made = function(make)
    for ranges in good:
        assert not analysed(made, {"vx": ranges}, assumed).alarms, ranges
    for ranges in bad:
        found = {made.nodes[i].op for i, _ in analysed(made, {"vx": ranges}, assumed).alarms}
        assert op in found, ranges


@pytest.mark.parametrize("sign", [1, -1])
def test_a_divisor_close_to_zero_has_no_bound_of_its_quotient(sign: int) -> None:
    made = function(lambda b, x: b.div(b.const(1), x))
    for least, singular in ((1e-5, False), (1e-7, True)):
        ends = sorted((sign * least, sign * 1.0))
        (claim,) = analysed(made, {"vx": (ends[0], ends[1])}, LIBM).claims
        assert claim.singular is singular


def test_the_least_size_is_one_of_the_float_result() -> None:
    """c at_least(x, m) is at least c m, but its float may be half a unit below that."""
    c, m = Fraction(2**23 + 5, 2**23), Fraction(2**23 + 9, 2**23)  # floats whose product is none
    made = function(lambda b, x: b.make(Op.MUL, [b.const(c), b.apply(Op.AT_LEAST, (x, b.const(m)))]))
    w = walked(made, {"vx": (-1.5, 1.5)})
    (k,) = made.results
    half = 2.0**-24
    assert float(c * m) - 2.1 * half < w.away[k][0] <= float(c * m) - 0.99 * half


def test_a_choice_knows_its_comparison_up_to_the_errors_of_what_is_compared() -> None:
    """x / 3 if it is more than 1 / 3 as a float: the exact quotient may be below 1 / 3 by the errors of both."""

    def make(b: Builder, x: int) -> int:
        large, limit = b.make(Op.MUL, [b.const(Fraction(1, 3)), x]), b.const(Fraction(1, 3))
        return b.select(limit, large, large, b.const(1))

    made = function(make)
    w = walked(made, {"vx": (-3.0, 3.0)})
    (k,) = made.results
    small, large = made.nodes[k].args[:2]
    slack = float(w.errors([small, large]).plain[:, 0].sum())
    assert slack > 1e-8
    assert float(w.ranges[k][0][0]) <= float(w.ranges[small][0][0]) - 0.9 * slack


@pytest.mark.parametrize("last", [False, True])
def test_slack_of_either_factor_widens_a_product(last: bool) -> None:
    """(cos a + x - rint x) sin a + sin a cos a: x - rint x is as far as 1/2 from the 0 that its form has.

    The sine is made before or after the first factor: nodes have their arguments in the order of their ids.
    """

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        if not last:
            b.sin(y)
        c, rest = b.cos(y), b.sub(x, b.rint(x))
        first = b.make(Op.ADD, [c, rest])
        s = b.sin(y)
        assert (s > first) is last
        return [b.make(Op.ADD, [b.make(Op.MUL, [first, s]), b.make(Op.MUL, [s, c])])]

    made = of_three(make)
    ranges = {"x": (-2.0, 2.0), "y": (-3.0, 3.0), "z": (0.0, 0.0)}
    single = Runs.of(made, points(ranges, 20000, 3)).single[made.results[0]].astype(np.float64)
    (claim,) = analysed(made, ranges, LIBM).claims
    assert claim.low <= single.min() < -1.2 and 1.2 < single.max() <= claim.high


# ---- vectors that may vanish


def test_the_error_of_a_length_is_that_of_the_longest_error() -> None:
    """Of two headings, one of a vector without errors, one of a vector with large ones."""

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        far = b.make(Op.ADD, [z, b.const(Fraction(1, 3))])
        near, _ = heading_of(b, x, y)
        off, _ = heading_of(b, b.make(Op.SUB, [x, far]), b.make(Op.ADD, [y, far]))
        return [b.make(Op.ADD, [near, off]), b.make(Op.ADD, [off, near])]

    claims = analysed(
        of_three(make), {"x": (-200.0, 200.0), "y": (-200.0, 200.0), "z": (100.0, 101.0)}, LIBM
    ).claims
    for claim in claims:
        assert claim.length_error >= np.spacing(np.float32(200)) / 2


def test_an_error_over_a_length_counts_in_products_with_parts_of_the_vector() -> None:
    """v heading(v, w), the heading chosen: w is off by what a rounding of 101 brings, v by nothing.

    Along w = 0 the heading is off by that over h = |v|, so the product is off by it whatever h is.
    """

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        w = b.make(Op.ADD, [y, b.make(Op.ADD, [z, b.const(Fraction(1, 3))])])
        heading, _ = heading_of(b, x, w)
        other = b.make(Op.MUL, [b.const(Fraction(1, 2)), heading])
        return [b.make(Op.MUL, [x, b.select(z, b.const(Fraction(201, 2)), heading, other)])]

    ranges = {"x": (-0.5, 0.5), "y": (-102.0, -100.0), "z": (100.0, 101.0)}
    (claim,) = analysed(of_three(make), ranges, LIBM).claims
    made, count = of_three(make), 4000
    rng = np.random.default_rng(2)
    z = rng.uniform(100, 100.4, count).astype(np.float32)
    near = {"x": rng.uniform(0.05, 0.5, count), "y": -(z + 1 / 3), "z": z}
    runs = Runs.of(made, {n: v.astype(np.float32) for n, v in near.items()})
    (k,) = made.results
    exact, (alike, injected) = runs.wide(), runs.injected(k)
    h = np.hypot(near["x"], 1e-6)
    allowed = claim.error + claim.per_length / h
    for values in injected:
        off = np.abs(values[k] - exact[k])
        assert (off <= allowed)[alike & (h >= SMALL_ANGLE * claim.length_error)].all()
        assert off[alike].max() > 1e-6
    # Where h is long, per_length / h is small, so that the error of w must be in the part without h.
    assert claim.error > 0.9 * float(np.spacing(np.float32(101))) / 2


# ---- boxes, and claims of other functions


@pytest.mark.parametrize("parts", [1, 7, 128])
def test_a_grid_covers_its_ranges(parts: int) -> None:
    ranges = {"p": (-3.1416, 3.1416), "q": (0.25, 1.0), "r": (-1.0, 2.0)}
    grid = boxed(ranges, ["q", "p"], parts)
    assert len({len(end) for both in grid.values() for end in both}) == 1
    cells = set(zip(*(tuple(end.tolist()) for name in ("q", "p") for end in grid[name]), strict=True))
    assert len(cells) == parts**2
    for name in ("q", "p"):
        low, high = (np.unique(end) for end in grid[name])
        assert (low[0], high[-1]) == ranges[name]
        assert (low[1:] == high[:-1]).all(), "each part begins where the last ends"
    assert {*grid["r"][0]} == {-1.0} and {*grid["r"][1]} == {2.0}


def _shared(divided_by: Range) -> tuple[Outcome, Outcome, Outcome]:
    """Of 1 + x, of (1 + x, 1 / y), and of the first by way of the second, for y in a range."""
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in "xy")

    def made(name: str, more: bool) -> Function:
        b = Builder()
        x, y = b.input("x"), b.input("y")
        results = [b.add(x, b.const(1)), *([b.div(b.const(1), y)] if more else [])]
        outputs = tuple(Port(f"{name}{k}", Role.COMMAND, "1", "an output") for k in range(len(results)))
        return b.function(name, ports, outputs, results)

    few, many = made("few", False), made("many", True)
    ranges = {"x": (-1.0, 2.0), "y": divided_by}
    return (
        analysed(few, ranges, LIBM),
        analysed(many, ranges, LIBM),
        Outcomes([few, many], LIBM).of(few, ranges),
    )


def test_claims_of_a_larger_function_are_used_only_without_alarms() -> None:
    own, larger, used = _shared((1.0, 2.0))
    assert used.claims == larger.claims[:1] == own.claims and not used.alarms
    own, larger, used = _shared((-1.0, 2.0))
    assert larger.alarms and used == own and not own.alarms


def test_an_alarm_is_not_lost_where_a_larger_function_raises_it_too() -> None:
    ports = (Port("x", Role.COMMAND, "1", "an input"),)

    def made(name: str, more: bool) -> Function:
        b = Builder()
        x = b.input("x")
        results = [b.div(b.const(1), x), *([b.add(x, b.const(1))] if more else [])]
        outputs = tuple(Port(f"o{k}", Role.COMMAND, "1", "an output") for k in range(len(results)))
        return b.function(name, ports, outputs, results)

    few, many = made("few", False), made("many", True)
    assert Outcomes([few, many], LIBM).of(few, {"x": (-1.0, 1.0)}).alarms


def test_claims_of_a_larger_function_are_those_of_equal_operations() -> None:
    """x + y and x - y are different, x + y of two functions is one."""
    ports = tuple(Port(n, Role.COMMAND, "1", "an input") for n in "xy")

    def made(name: str, ops: list[Op]) -> Function:
        b = Builder()
        at = [b.input("x"), b.input("y")]
        outputs = tuple(Port(f"o{k}", Role.COMMAND, "1", "an output") for k in range(len(ops)))
        return b.function(name, ports, outputs, [b.make(op, at) for op in ops])

    few, many = made("few", [Op.MUL]), made("many", [Op.SUB, Op.MUL])
    ranges = {"x": (2.0, 3.0), "y": (4.0, 5.0)}
    (claim,) = Outcomes([few, many], LIBM).of(few, ranges).claims
    assert claim == analysed(few, ranges, LIBM).claims[0]
    assert claim.low == pytest.approx(8) and claim.high == pytest.approx(15)


def test_a_step_of_a_walk_that_is_no_result_is_checked_as_well() -> None:
    """1 / x within a result that a limit makes harmless: the alarm is there all the same."""
    made = function(lambda b, x: b.min(b.max(b.div(b.const(1), x), b.const(-1)), b.const(1)))
    assert analysed(made, {"vx": (-1.0, 1.0)}, LIBM).alarms


# ---- faults that random functions found


def test_a_limit_that_is_no_float_is_in_the_range_of_what_it_limits() -> None:
    """clamp(x, 7 / 5) of x from 100 on: 7 / 5, and the float nearest to it, which is smaller."""
    limit = Fraction(7, 5)
    made = function(lambda b, x: b.apply(Op.CLAMP, (x, b.const(limit))))
    for low, high, sign in ((100.0, 101.0, 1), (-101.0, -100.0, -1)):
        (claim,) = analysed(made, {"vx": (low, high)}, LIBM).claims
        for value in (sign * float(np.float32(1.4)), sign * limit):
            assert claim.low <= value <= claim.high


def test_a_limit_beyond_the_rounding_of_a_sum_does_not_make_it_smaller() -> None:
    """The rounding of x + y, both near 9, limited to 1.4: half a unit of 18, not of 1.4."""

    def make(b: Builder, x: int, y: int, z: int) -> list[int]:
        return [b.apply(Op.CLAMP, (b.apply(Op.ROUNDING_ERROR, (x, y)), b.const(Fraction(7, 5))))]

    (claim,) = analysed(of_three(make), {"x": (8.0, 9.0), "y": (8.0, 9.0), "z": (0.0, 0.0)}, LIBM).claims
    half = float(np.spacing(np.float32(17))) / 2
    assert claim.high >= half and claim.error >= half
