"""Small exact linear algebra: ranks and null spaces of matrices of numbers, determinants of polynomials."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly

Vector = tuple[Exact, ...]


def reduce_rows(rows: Sequence[Sequence[Exact]]) -> tuple[list[list[Exact]], list[int]]:
    """Return the reduced row echelon form and its pivot columns."""
    work = [list(r) for r in rows]
    pivots: list[int] = []
    width = len(work[0]) if work else 0
    top = 0
    for column in range(width):
        pivot = next((i for i in range(top, len(work)) if work[i][column]), None)
        if pivot is None:
            continue
        work[top], work[pivot] = work[pivot], work[top]
        inverse = work[top][column].inverse()
        work[top] = [v * inverse for v in work[top]]
        for i, row in enumerate(work):
            if i != top and row[column]:
                k = row[column]
                work[i] = [a - k * b for a, b in zip(row, work[top], strict=True)]
        pivots.append(column)
        top += 1
    return work[:top], pivots


def rank(rows: Sequence[Sequence[Exact]]) -> int:
    """Return the exact rank."""
    return len(reduce_rows(rows)[1])


def null_space(rows: Sequence[Sequence[Exact]], width: int) -> list[Vector]:
    """Return a basis of {v: rows v = 0} for a matrix of ``width`` columns, which may have no rows."""
    reduced, pivots = reduce_rows(rows)
    basis = []
    for free in (c for c in range(width) if c not in pivots):
        v = [ZERO] * width
        v[free] = ONE
        for row, pivot in zip(reduced, pivots, strict=True):
            v[pivot] = -row[free]
        basis.append(tuple(v))
    return basis


def left_null_space(columns: Sequence[Sequence[Exact]]) -> list[Vector]:
    """Return a basis of {w: w M = 0} for the matrix M, which is given by its rows."""
    if not columns:
        return []
    transposed = [list(c) for c in zip(*columns, strict=True)]
    return null_space(transposed, len(columns))


Matrix = Sequence[Sequence[Poly]]


def mean(values: Sequence[Poly]) -> Poly:
    """Return the arithmetic mean."""
    return Poly.sum(values).scale(Fraction(1, len(values)))


def determinant(m: Matrix) -> Poly:
    """Return det m, expanded by the first row; 1 for a matrix without rows."""
    if not m:
        return Poly.of(1)
    return Poly.sum(p * cofactor(m, 0, j) for j, p in enumerate(m[0]) if p)


def cofactor(m: Matrix, i: int, j: int) -> Poly:
    """Return a cofactor of a matrix.

    Args:
        m: A square matrix.
        i: The row to remove.
        j: The column to remove.

    Returns:
        (-1)^(i + j) times the determinant of the rest.
    """
    minor = determinant([[*row[:j], *row[j + 1 :]] for k, row in enumerate(m) if k != i])
    return -minor if (i + j) % 2 else minor


def symmetric(entry: Callable[[int, int], Poly], size: int = 3) -> list[list[Poly]]:
    """Return the symmetric matrix whose upper triangle is ``entry(i, j)``, called once for each, row by row."""
    upper = {(i, j): entry(i, j) for i in range(size) for j in range(i, size)}
    return [[upper[min(i, j), max(i, j)] for j in range(size)] for i in range(size)]


def adjugate(m: Matrix) -> list[list[Poly]]:
    """Return adj m, the transposed cofactors: m adj m = det m."""
    size = range(len(m))
    return [[cofactor(m, i, j) for i in size] for j in size]


def inverse(m: Matrix) -> list[list[Poly]]:
    """Return adj m / det m, with one reciprocal."""
    adj = adjugate(m)
    over = Poly.sum(p * row[0] for p, row in zip(m[0], adj, strict=True)).inverse()
    return [[p * over for p in row] for row in adj]
