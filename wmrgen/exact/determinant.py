"""Determinants, adjugates and inverses of small matrices of polynomials, by cofactors."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.exact.poly import Poly

Matrix = Sequence[Sequence[Poly]]


def determinant(m: Matrix) -> Poly:
    """det m, expanded by its first row; 1 of a matrix without rows."""
    if not m:
        return Poly.of(1)
    return Poly.sum(p * cofactor(m, 0, j) for j, p in enumerate(m[0]) if p)


def cofactor(m: Matrix, i: int, j: int) -> Poly:
    """(-1)^(i + j) times the determinant of ``m`` without row i and column j."""
    minor = determinant([[*row[:j], *row[j + 1 :]] for k, row in enumerate(m) if k != i])
    return -minor if (i + j) % 2 else minor


def adjugate(m: Matrix) -> list[list[Poly]]:
    """adj m, with m adj m = det m: the transposed cofactors."""
    size = range(len(m))
    return [[cofactor(m, i, j) for i in size] for j in size]


def inverse(m: Matrix) -> list[list[Poly]]:
    """adj m / det m, with one reciprocal."""
    adj = adjugate(m)
    over = Poly.sum(p * row[0] for p, row in zip(m[0], adj, strict=True)).inverse()
    return [[p * over for p in row] for row in adj]
