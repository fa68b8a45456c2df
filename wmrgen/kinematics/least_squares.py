"""What least squares needs at derivation time: inverses of constant normal matrices, and norms of residuals.

Each connected block of a normal matrix is inverted exactly, by cofactors, so that with tunable geometry prepare() is
left with one reciprocal per block. A rank-deficient matrix gets its Moore-Penrose inverse, of the rank that it has
where tunable parameters are nominal.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy

from wmrgen.exact.evaluate import fix, sqrt_poly
from wmrgen.exact.linalg import inverse
from wmrgen.exact.number import ONE, ZERO, Exact
from wmrgen.exact.poly import Poly
from wmrgen.mobility.ranks import independent, numeric_rank, to_array
from wmrgen.symbolic import Expr, absolute, add, expression, number, root, square, times

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
        return inverse(part)
    padded = to_array([[*row, *[ZERO] * (3 - size)] for row in numbers])
    rank, _ = numeric_rank(padded)
    if rank == size:
        return inverse(part)
    if not rank:
        return [[Poly({}) for _ in part] for _ in part]
    rows = [part[i] for i in independent(padded, rank)]  # m = m^T: rows span its range
    columns = [list(column) for column in zip(*rows, strict=True)]
    core = [[_sum(a, [_sum(row, b) for row in part]) for b in rows] for a in rows]
    middle = inverse(core)
    return [[_sum(a, [_sum(row, b) for row in middle]) for b in columns] for a in columns]


def _sum(a: list[Poly], b: list[Poly]) -> Poly:
    return Poly.sum(x * y for x, y in zip(a, b, strict=True))


NEGLIGIBLE = 1e-12


def norm(forms: Sequence[Poly], weight: Exact = ONE) -> Expr:
    """sqrt(weight * sum of squares). Proportional forms are merged: one form needs no square root."""
    groups: list[tuple[Poly, Exact]] = []
    for form in forms:
        if not form or _size(form) < NEGLIGIBLE:
            continue
        for i, (base, total) in enumerate(groups):
            ratio = _ratio(form, base)
            if ratio is not None:
                groups[i] = (base, total + ratio * ratio)
                break
        else:
            groups.append((form, ONE))
    if not groups:
        return sympy.S.Zero
    if len(groups) == 1:
        base, total = groups[0]
        factor = fix(sqrt_poly(Poly.of(total * weight)), {})
        return absolute(expression(base * factor))
    return root(add(*(times(number(t * weight), square(expression(b))) for b, t in groups)))


def _size(form: Poly) -> float:
    return max(abs(float(c)) for c in form.terms.values())


def _ratio(a: Poly, b: Poly) -> Exact | None:
    """a / b when it is a number."""
    if a.terms.keys() != b.terms.keys():
        return None
    m = next(iter(a.terms))
    ratio = a.terms[m] / b.terms[m]
    return ratio if all(c == ratio * b.terms[k] for k, c in a.terms.items()) else None
