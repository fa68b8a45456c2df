"""The inverse of a constant normal matrix, at derivation time.

Each connected block is inverted exactly, by cofactors, so that with tunable geometry prepare() is left with one
reciprocal per block. A rank-deficient matrix gets its Moore-Penrose inverse, of the rank that it has where tunable
parameters are nominal.
"""

from __future__ import annotations

from wmrgen.exact.number import ZERO, Exact
from wmrgen.exact.poly import Poly
from wmrgen.mobility.ranks import independent, numeric_rank, to_array

Matrix = list[list[Poly]]
Numbers = list[list[Exact]]


def pseudo_inverse(normal: Matrix, nominal: Numbers | None) -> Matrix:
    """The inverse of a symmetric positive semidefinite 3x3 matrix H^T H of constants.

    ``nominal``: its values at nominal parameters, for the rank of the Moore-Penrose inverse; None where H has rank 3.
    """
    result = [[Poly({}) for _ in range(3)] for _ in range(3)]
    for block in _blocks(normal):
        part = [[normal[i][j] for j in block] for i in block]
        numbers = None if nominal is None else [[nominal[i][j] for j in block] for i in block]
        for i, row in zip(block, _invert(part, numbers), strict=True):
            for j, value in zip(block, row, strict=True):
                result[i][j] = value
    return result


def _blocks(m: Matrix) -> list[list[int]]:
    """Indices that are connected by non-zero entries."""
    blocks: list[list[int]] = []
    for i in range(3):
        linked = [b for b in blocks if any(m[i][j] for j in b)]
        blocks = [b for b in blocks if b not in linked] + [sorted([*(j for b in linked for j in b), i])]
    return sorted(blocks)


def _invert(part: Matrix, numbers: Numbers | None) -> Matrix:
    """B^T (B m B^T)^-1 B, the rows B spanning the range of m at the tolerance; plainly m^-1 where that is all."""
    size = len(part)
    if numbers is None:
        return _cofactors(part)
    padded = to_array([[*row, *[ZERO] * (3 - size)] for row in numbers])
    rank, _ = numeric_rank(padded)
    if rank == size:
        return _cofactors(part)
    if not rank:
        return [[Poly({}) for _ in part] for _ in part]
    rows = [part[i] for i in independent(padded, rank)]  # m = m^T: rows span its range
    columns = [list(column) for column in zip(*rows, strict=True)]
    core = [[_sum(a, [_sum(row, b) for row in part]) for b in rows] for a in rows]
    left = _cofactors(core)
    return [[_sum(a, [_sum(row, b) for row in left]) for b in columns] for a in columns]


def _sum(a: list[Poly], b: list[Poly]) -> Poly:
    return Poly.sum(x * y for x, y in zip(a, b, strict=True))


def _cofactors(part: Matrix) -> Matrix:
    """The inverse by cofactors, with one reciprocal."""
    if len(part) == 1:
        return [[part[0][0].inverse()]]
    if len(part) == 2:
        (a, b), (c, d) = part
        over = (a * d - b * c).inverse()
        return [[d * over, -b * over], [-c * over, a * over]]
    m = part
    cof = [
        [
            m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3]
            - m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3]
            for j in range(3)
        ]
        for i in range(3)
    ]
    over = (m[0][0] * cof[0][0] + m[0][1] * cof[0][1] + m[0][2] * cof[0][2]).inverse()
    return [[cof[j][i] * over for j in range(3)] for i in range(3)]
