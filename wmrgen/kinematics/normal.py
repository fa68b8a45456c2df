"""The inverse of a constant normal matrix, at derivation time.

Exact numbers are inverted exactly; with tunable geometry each connected block is inverted by cofactors, so
that prepare() is left with one reciprocal per block. A rank-deficient matrix gets its Moore-Penrose inverse, of the
rank that it has where tunable parameters are nominal.
"""

from __future__ import annotations

from collections.abc import Mapping

from wmrgen.exact.evaluate import fix
from wmrgen.exact.linalg import inverse3
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly
from wmrgen.mobility.ranks import independent, numeric_rank, to_array
from wmrgen.mobility.records import Array

Matrix = list[list[Poly]]


def pseudo_inverse(normal: Matrix, regular: bool, nominal: Mapping[str, Poly]) -> Matrix:
    """The inverse of a symmetric positive semidefinite 3x3 matrix H^T H of constants.

    ``regular``: H has rank 3 at the tolerance; otherwise the Moore-Penrose inverse is taken. ``nominal``: values of
    the tunable parameters.
    """
    result = [[Poly({}) for _ in range(3)] for _ in range(3)]
    for block in _blocks(normal):
        part = [[normal[i][j] for j in block] for i in block]
        for i, row in zip(block, _invert(part, regular, nominal), strict=True):
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


def _invert(part: Matrix, regular: bool, nominal: Mapping[str, Poly]) -> Matrix:
    exact = [[v for p in row if (v := fix(p, nominal).constant) is not None] for row in part]
    if any(p.constant is None for row in part for p in row):
        return _cofactors(part) if regular else _tunable(part, exact)
    return [[Poly.of(v) for v in row] for row in (inverse3(exact) if regular else _exact(exact))]


def _tunable(part: Matrix, nominal: list[list[Exact]]) -> Matrix:
    """`_exact` for a block with tunable parameters, which has the values ``nominal``."""
    size = len(part)
    padded = _padded(nominal)
    rank, _ = numeric_rank(padded)
    if rank == size:
        return _cofactors(part)
    if not rank:
        return [[Poly({}) for _ in part] for _ in part]
    rows = [part[i] for i in independent(padded, rank)]
    core = [[_sum(a, [_sum(row, b) for row in part]) for b in rows] for a in rows]
    left = _cofactors(core)
    turned = [[_sum(row, [r[j] for r in rows]) for j in range(size)] for row in left]
    return [
        [_sum([r[i] for r in rows], [row[j] for row in turned]) for j in range(size)] for i in range(size)
    ]


def _sum(a: list[Poly], b: list[Poly]) -> Poly:
    return Poly.sum(x * y for x, y in zip(a, b, strict=True))


def _padded(m: list[list[Exact]]) -> Array:
    return to_array([[*row, *[Exact(0)] * (3 - len(m))] for row in m])


def _exact(m: list[list[Exact]]) -> list[list[Exact]]:
    """Moore-Penrose inverse over the field: B^T (B m B^T)^-1 B, the rows B spanning range(m) at tolerance."""
    size = len(m)
    padded = _padded(m)
    rank, _ = numeric_rank(padded)
    if rank == size:
        return inverse3(m)
    if not rank:
        return [[Exact(0)] * size for _ in range(size)]
    rows = [m[i] for i in independent(padded, rank)]  # m = m^T: rows span its range
    core = [[_dot(a, _times(m, b)) for b in rows] for a in rows]  # B m B^T
    left = inverse3(core)
    return [
        [
            sum((rows[p][i] * left[p][q] * rows[q][j] for p in range(rank) for q in range(rank)), Exact(0))
            for j in range(size)
        ]
        for i in range(size)
    ]


def _dot(a: list[Exact], b: list[Exact]) -> Exact:
    return sum((x * y for x, y in zip(a, b, strict=True)), Exact(0))


def _times(m: list[list[Exact]], v: list[Exact]) -> list[Exact]:
    return [_dot(row, v) for row in m]


def _cofactors(part: Matrix) -> Matrix:
    """The inverse of a block that contains tunable parameters."""
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
