"""Ranks of N x 3 matrices, decided on values."""

from __future__ import annotations

from collections.abc import Sequence
from math import copysign, hypot, sqrt

import numpy as np

from wmrgen.exact.linalg import rank as exact_rank
from wmrgen.exact.number import Exact
from wmrgen.mobility.records import TOLERANCE, Array, Rank

GRID = 1e12  # singular values are kept to this fraction of the largest


def to_array(rows: Sequence[Sequence[Exact]]) -> Array:
    """Rows of exact numbers as an (N, 3) array; N may be 0."""
    return np.array([[float(v) for v in row] for row in rows], dtype=np.float64).reshape(-1, 3)


def unit_rows(rows: Array) -> Array:
    """Each row scaled to a unit direction part, so that every row is a speed; pure rotation rows to 1."""
    size = np.hypot(rows[:, 0], rows[:, 1])
    size = np.where(size > TOLERANCE * np.abs(rows[:, 2]), size, np.abs(rows[:, 2]))
    return np.asarray(rows / np.where(size > 0, size, 1.0)[:, None])


def numeric_rank(rows: Array) -> tuple[int, tuple[float, ...]]:
    """Rank at TOLERANCE, and the singular values."""
    singular = singular_values(rows)
    top = singular[0] if singular else 0.0
    rank = sum(s > TOLERANCE * top for s in singular)
    # What is printed must not depend on how the last bit was rounded.
    return rank, tuple(round(s / top * GRID) / GRID * top if top else 0.0 for s in singular)


def singular_values(rows: Array) -> list[float]:
    """Singular values of an (N, 3) array, largest first, by one-sided Jacobi rotations.

    Plain arithmetic, the same bits on every machine, and accurate for small values too.
    """
    columns = [[float(v) for v in column] for column in rows.T]
    for _ in range(12):
        rotated = False
        for i, j in ((0, 1), (0, 2), (1, 2)):
            a, b = columns[i], columns[j]
            p, q, r = _product(a, a), _product(b, b), _product(a, b)
            if abs(r) <= 1e-16 * sqrt(p * q):
                continue
            rotated = True
            zeta = (q - p) / (2 * r)
            t = copysign(1.0, zeta) / (abs(zeta) + hypot(1.0, zeta))
            c = 1 / hypot(1.0, t)
            columns[i] = [c * (x - t * y) for x, y in zip(a, b, strict=True)]
            columns[j] = [c * (t * x + y) for x, y in zip(a, b, strict=True)]
        if not rotated:
            break
    sizes = sorted((sqrt(_product(column, column)) for column in columns), reverse=True)
    return sizes[: min(len(rows), 3)]


def _product(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


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
            singular = singular_values(rows[[*chosen, i]])
            if singular[-1] > threshold * singular[0] > 0:
                chosen.append(i)
    return sorted(chosen)


def null_basis(rows: Array) -> Array:
    """Orthonormal rows spanning {xi: rows xi = 0} at TOLERANCE, the same on every machine."""
    rank, _ = numeric_rank(rows)
    picked = rows[independent(rows, rank)]
    if rank == 0:
        return np.eye(3)
    if rank == 3:
        return np.zeros((0, 3))
    if rank == 2:
        return _unit(np.cross(picked[0], picked[1]))[None, :]
    first = _unit(picked[0])
    along = (
        np.array([first[1], -first[0], 0.0]) if abs(first[2]) < 1 - TOLERANCE else np.array([1.0, 0.0, 0.0])
    )
    along = _unit(along)
    return np.array([along, np.cross(first, along)])


def _unit(v: Array) -> Array:
    return np.asarray(v / hypot(*(float(c) for c in v)))
