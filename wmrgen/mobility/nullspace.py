"""Null spaces with readable entries: polynomials, cleared of common factors.

A rank-1 matrix is an axle: its null space is motion along the wheel and rotation about the axle.
The null space of a rank-2 matrix is one cross product.
"""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Gen, Poly, Row, cross

NEGLIGIBLE = 1e-9
ZERO, ONE = Poly({}), Poly.of(1)
IDENTITY: tuple[Row, ...] = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))


def null_columns(rows: Sequence[Row]) -> tuple[Row, ...]:
    """A basis (as columns) of the null space of up to three independent rows."""
    if not rows:
        return IDENTITY
    if len(rows) == 1:
        return _axle(rows[0])
    if len(rows) == 2:
        return (primitive(cross(rows[0], rows[1])),)
    return ()


def _axle(row: Row) -> tuple[Row, ...]:
    nx, ny, k = row
    if not nx and not ny:  # a pure ban on rotation
        return IDENTITY[:2]
    size = nx * nx + ny * ny
    along = primitive((ny, -nx, ZERO))
    if not k:
        return along, (ZERO, ZERO, ONE)
    return along, primitive((-(nx * k), -(ny * k), size))


def primitive(row: Row) -> Row:
    """The row without common factors: no common monomial, leading coefficient 1."""
    terms = [(m, c) for p in row for m, c in p.terms.items()]
    if not terms:
        return row
    common: dict[Gen, int] = dict(terms[0][0])
    for m, _ in terms:
        powers = dict(m)
        common = {g: min(e, powers.get(g, 0)) for g, e in common.items()}
        common.update({g: min(e, 0) for g, e in powers.items() if e < 0 and g not in common})
    shift = {g: e for g, e in common.items() if e}
    factor = _leading(row)
    return _shifted(row[0], shift, factor), _shifted(row[1], shift, factor), _shifted(row[2], shift, factor)


def _leading(row: Row) -> Exact:
    """The first coefficient of the first entry that is not negligible beside the largest."""
    ordered = [
        c for p in row for _, c in sorted(p.terms.items(), key=lambda item: [(g.key, e) for g, e in item[0]])
    ]
    largest = max(abs(float(c)) for c in ordered)
    return next(c for c in ordered if abs(float(c)) > NEGLIGIBLE * largest)


def _shifted(p: Poly, shift: dict[Gen, int], factor: Exact) -> Poly:
    inverse = factor.inverse()
    terms = {}
    for m, c in p.terms.items():
        powers = dict(m)
        for g, e in shift.items():
            powers[g] = powers.get(g, 0) - e
        terms[tuple(sorted((g, e) for g, e in powers.items() if e))] = c * inverse
    return Poly(terms)
