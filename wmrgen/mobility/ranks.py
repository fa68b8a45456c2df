"""Ranks of N x 3 matrices, decided on values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wmrgen.exact.linalg import rank as exact_rank
from wmrgen.exact.number import Exact
from wmrgen.mobility.records import TOLERANCE, Array, Rank


def to_array(rows: Sequence[Sequence[Exact]]) -> Array:
    """Rows of exact numbers as an (N, 3) array; N may be 0."""
    return np.array([[float(v) for v in row] for row in rows], dtype=np.float64).reshape(-1, 3)


def unit_rows(rows: Array) -> Array:
    """Each row scaled to a unit direction part, so that every row is in m/s; pure rotation rows to 1."""
    size = np.hypot(rows[:, 0], rows[:, 1])
    size = np.where(size > TOLERANCE * np.abs(rows[:, 2]), size, np.abs(rows[:, 2]))
    return np.asarray(rows / np.where(size > 0, size, 1.0)[:, None])


def numeric_rank(rows: Array) -> tuple[int, tuple[float, ...]]:
    """Rank at TOLERANCE, and the singular values."""
    if not rows.size:
        return 0, ()
    singular = np.linalg.svd(rows, compute_uv=False)
    return int(np.sum(singular > TOLERANCE * singular[0])) if singular[0] > 0 else 0, tuple(
        float(s) for s in singular
    )


def decide(rows: Sequence[Sequence[Exact]]) -> Rank:
    """Both ranks of rows of exact numbers."""
    value, singular = numeric_rank(unit_rows(to_array(rows)))
    return Rank(value, exact_rank(rows) if rows else 0, singular)


def independent(rows: Array, wanted: int) -> list[int]:
    """Indices of ``wanted`` rows that span, taken in order as long as each is clearly new."""
    chosen: list[int] = []
    for threshold in (1e-3, 1e-6, TOLERANCE):
        for i in range(len(rows)):
            if len(chosen) == wanted:
                return sorted(chosen)
            if i in chosen:
                continue
            singular = np.linalg.svd(rows[[*chosen, i]], compute_uv=False)
            if singular[-1] > threshold * singular[0] > 0:
                chosen.append(i)
    return sorted(chosen)


def null_basis(rows: Array) -> Array:
    """Orthonormal rows spanning {xi: rows xi = 0} at TOLERANCE."""
    if not rows.size:
        return np.eye(3)
    _, singular, vt = np.linalg.svd(rows, full_matrices=True)
    r = int(np.sum(singular > TOLERANCE * singular[0])) if singular[0] > 0 else 0
    return np.asarray(vt[r:])
