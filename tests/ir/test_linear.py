"""Programs of linear maps: exact, and as short as by hand."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.depth import examples
from tests.ir.common import CONSTANTS, Matrix, port, pseudo_inverse, transposed
from tests.work import calls
from wmrgen.geometry.exact.number import SQRT2, SQRT3, Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.interpret import EXACT, evaluate
from wmrgen.ir.linear_program import Coefficient, Emitter
from wmrgen.ir.linear_search import cheapest
from wmrgen.ir.nodes import Cost, Function, count

R, HALF_TRACK, ARM = Fraction(1, 20), Fraction(1, 5), Fraction(3, 25)
A, B = Fraction(1, 3), Fraction(1, 4)


def exact(rows: list[list[Exact | Fraction | int]]) -> Matrix:
    return [[Exact.of(value) for value in row] for row in rows]


def program(matrix: Matrix) -> Function:
    """y = M t as a function of t0, t1, ...; checked against the product at one point."""
    builder = Builder()
    names = [f"t{j}" for j in range(len(matrix[0]))]
    terms = [builder.input(name) for name in names]
    rows = tuple(tuple((j, Coefficient(value)) for j, value in enumerate(row) if value) for row in matrix)
    emitter = Emitter(
        *cheapest(rows, len(names)), builder, lambda c, node: builder.mul(builder.const(c.value), node)
    )
    results = [emitter.output(i, terms.__getitem__) for i in range(len(rows))]
    outputs = tuple(port(f"y{i}") for i in range(len(matrix)))
    f = builder.function("f", tuple(port(name) for name in names), outputs, results)
    point = {name: Fraction((7 * j * j + 3 * j) % 23 - 9, 5) for j, name in enumerate(names)}
    got = evaluate(f, point, EXACT)
    for i, row in enumerate(matrix):
        assert got[f"y{i}"] == sum((c * v for c, v in zip(row, point.values(), strict=True)), Exact(0))
    return f


def differential() -> Matrix:
    return exact([[1 / R, 0, -HALF_TRACK / R], [1 / R, 0, HALF_TRACK / R]])


def differential_forward() -> Matrix:
    return exact([[R / 2, R / 2], [0, 0], [-R / 2 / HALF_TRACK, R / 2 / HALF_TRACK]])


def mecanum() -> Matrix:
    return exact([[1 / R, -s / R, t * HALF_TRACK / R] for s, t in ((1, -1), (-1, 1), (-1, -1), (1, 1))])


def omni(*degrees: int) -> Matrix:
    half, root = Fraction(1, 2), SQRT3 / 2
    points = {
        0: (1, 0), 60: (half, root), 120: (-half, root),
        180: (-1, 0), 240: (-half, -root), 300: (half, -root),
    }  # fmt: skip
    return exact([[-points[t][1] / R, points[t][0] / R, ARM / R] for t in degrees])


def swerve(*pivots: tuple[Exact | Fraction | int, Exact | Fraction | int]) -> Matrix:
    """(vx, vy, omega) over p_i = spin_i cos_i, then q_i = spin_i sin_i."""
    n = len(pivots)
    size = sum((Exact.of(x) * x + Exact.of(y) * y for x, y in pivots), Exact(0))
    return exact([
        [R / n] * n + [0] * n,
        [0] * n + [R / n] * n,
        [-Exact.of(y) * R / size for _, y in pivots] + [Exact.of(x) * R / size for x, _ in pivots],
    ])  # fmt: skip


def rectangle(a: Fraction, b: Fraction) -> list[tuple[Fraction, Fraction]]:
    return [(a, b), (a, -b), (-a, b), (-a, -b)]


H = SQRT2 / 2
RING = [(1, 0), (H, H), (0, 1), (-H, H), (-1, 0), (-H, -H), (0, -1), (H, -H)]
TARGETS = {
    "differential inverse": (differential(), 4),
    "differential forward": (differential_forward(), 4),
    "mecanum inverse": (mecanum(), 9),
    "mecanum forward": (pseudo_inverse(mecanum()), 10),
    "omni 0 120 240 inverse": (omni(0, 120, 240), 8),
    "omni 0 120 240 forward": (pseudo_inverse(omni(0, 120, 240)), 8),
    "omni 60 180 300 inverse": (omni(60, 180, 300), 8),
    "omni 60 180 300 forward": (pseudo_inverse(omni(60, 180, 300)), 8),
    "swerve of four forward": (swerve(*rectangle(A, B)), 13),
    "swerve of eight, two rectangles": (
        swerve(*rectangle(A, B), *rectangle(Fraction(1, 2), Fraction(2, 7))),
        27,
    ),
    "swerve of eight, two by four": (swerve(*rectangle(Fraction(3, 4), B), *rectangle(A, B)), 24),
    "swerve of eight, octagon": (swerve(*RING), 25),
}


@pytest.mark.parametrize("case", TARGETS)
def test_operation_counts_of_known_robots(case: str) -> None:
    matrix, target = TARGETS[case]
    cost = count(program(matrix))
    assert cost.flops <= target, str(cost)
    assert cost.signs == 0
    assert cost.divisions == 0


def test_a_wheel_that_turns_backwards_needs_no_negation() -> None:
    first, second = differential()
    cost = count(program([first, [-value for value in second]]))
    assert (cost.flops, cost.signs) == (4, 0)
    assert count(program(exact([[-1, 1, -2], [-2, 1, -1], [-1, -1, -2]]))).signs == 0


def test_mecanum_takes_six_additions_and_three_multiplications() -> None:
    assert count(program(mecanum())) == Cost(additions=6, multiplications=3)


ENTRIES = st.sampled_from(CONSTANTS)


@st.composite
def matrices(draw: st.DrawFn) -> Matrix:
    rows, columns = draw(st.integers(1, 6)), draw(st.integers(1, 6))
    return [[draw(ENTRIES) for _ in range(columns)] for _ in range(rows)]


@given(matrices())
@settings(max_examples=examples(150))
def test_programs_are_exact_and_no_worse_than_the_product(matrix: Matrix) -> None:
    cost = count(program(matrix))
    terms = [sum(1 for value in row if value) for row in matrix]
    multiplications = sum(1 for row in matrix for value in row if value and abs(value) != 1)
    assert cost.flops <= multiplications + sum(max(n - 1, 0) for n in terms)


@given(matrices())
@settings(max_examples=examples(50))
def test_proportional_rows_are_computed_once(matrix: Matrix) -> None:
    single = count(program(matrix))
    double = count(program([*matrix, [-2 * value for value in matrix[0]]]))
    assert double.flops <= single.flops + 1


@pytest.mark.parametrize(("rows", "columns"), [(3, 4), (64, 3), (3, 128)])
def test_the_search_is_short(rows: int, columns: int) -> None:
    matrix = exact([[Fraction(1 + (i * 31 + j * 17) % 97, 7) for j in range(columns)] for i in range(rows)])
    calls(lambda: program(matrix), 20_000 if rows * columns < 20 else 300_000)


def test_transposition_changes_additions_only() -> None:
    for matrix in (mecanum(), omni(0, 120, 240), swerve(*rectangle(A, B))):
        straight, across = count(program(matrix)), count(program(transposed(matrix)))
        assert straight.multiplications == across.multiplications
        assert straight.additions - across.additions == len(matrix[0]) - len(matrix)
