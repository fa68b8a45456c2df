"""The smallest eigenvector of a 3 x 3 mean of squares G, in closed form and defined for every input.

The smallest eigenvalue is q + 2 p cos(phi + 2 pi / 3) with q = tr G / 3, p**2 = tr (G - q I)**2 / 6 and
cos 3 phi = det(G - q I) / 2 p**3. Its cosine loses half the digits where two eigenvalues meet, which Newton steps on
the characteristic polynomial give back. The adjugate of G - lambda I is then a multiple of the eigenvector's square;
its largest column is the eigenvector.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import sympy

from wmrgen.exact.number import Exact
from wmrgen.kinematics.records import Locals
from wmrgen.symbolic import (
    Expr,
    add,
    angle_of,
    maximum,
    minimum,
    number,
    over,
    root,
    select,
    square,
    subtract,
    times,
)

STEPS = 2
FLOOR = Exact(Fraction(1, 10**12))  # a slope or an eigenvector's square below is no information
Vector = tuple[Expr, Expr, Expr]


def smallest_eigenvector(rows: Sequence[Sequence[Expr]], fallback: Vector, names: Locals) -> Vector:
    """The unit vector v with the least sum of (row . v)**2; ``fallback`` where the rows are all parallel."""
    share = sympy.Rational(1, len(rows))
    gram = {
        (i, j): names.define(f"g{i}{j}", times(share, add(*(times(r[i], r[j]) for r in rows))))
        for i in range(3)
        for j in range(i, 3)
    }
    eigenvalue = _smallest(gram, names)
    for i in range(3):
        gram[i, i] = names.define(f"m{i}{i}", subtract(gram[i, i], eigenvalue))
    adjugate = _adjugate(gram, names, "k")
    column = _largest_column(adjugate, names)
    size = names.define("vector_size", root(add(*(square(v) for v in column))))
    kept = names.define("vector_kept", maximum(size, number(FLOOR)))
    a, b, c = (
        names.define(f"vector{i}", select(number(FLOOR), size, over(v, kept), f))
        for i, (v, f) in enumerate(zip(column, fallback, strict=True))
    )
    return a, b, c


def _smallest(gram: dict[tuple[int, int], Expr], names: Locals) -> Expr:
    """The smallest eigenvalue, between 0 and a third of the trace."""
    adjugate = _adjugate(gram, names, "adj")
    trace = names.define("trace", add(*(gram[i, i] for i in range(3))))
    second = names.define("second", add(*(adjugate[i, i] for i in range(3))))
    third = names.define("third", add(*(times(gram[0, j], adjugate[0, j]) for j in range(3))))
    mean = names.define("mean", times(sympy.Rational(1, 3), trace))
    value = names.define("eigenvalue0", _kept(_cosine_root(trace, second, third, mean, names), mean))
    for k in range(STEPS):
        rest = add(third, times(value, subtract(times(value, subtract(trace, value)), second)))
        slope = add(second, times(value, subtract(times(3, value), times(2, trace))))
        step = over(rest, maximum(slope, number(FLOOR)))
        value = names.define(f"eigenvalue{k + 1}", _kept(add(value, step), mean))
    return value


def _kept(value: Expr, mean: Expr) -> Expr:
    return maximum(minimum(value, mean), sympy.S.Zero)


def _cosine_root(trace: Expr, second: Expr, third: Expr, mean: Expr, names: Locals) -> Expr:
    """q + 2 p cos(phi + 2 pi / 3) from the invariants: p**2 = (tr**2 - 3 second) / 9, and with x = lambda - q

    det(G - q I) = third - q second + 2 q**3.
    """
    zero, one = sympy.S.Zero, sympy.S.One
    spread = times(sympy.Rational(1, 9), subtract(square(trace), times(3, second)))
    p = names.define("half_range", root(maximum(spread, zero)))
    cube = maximum(times(2, p, p, p), number(FLOOR))
    shifted = add(third, times(mean, subtract(times(2, mean, mean), second)))
    ratio = names.define("ratio", maximum(minimum(over(shifted, cube), one), times(-1, one)))
    height = root(maximum(subtract(one, square(ratio)), zero))
    angle = add(times(sympy.Rational(1, 3), angle_of(height, ratio)), times(sympy.Rational(2, 3), sympy.pi))
    return add(mean, times(2, p, sympy.cos(names.define("angle", angle))))


def _adjugate(m: dict[tuple[int, int], Expr], names: Locals, name: str) -> dict[tuple[int, int], Expr]:
    """Adjugate of a symmetric matrix given by its upper half; upper half, entries named."""

    def entry(i: int, j: int) -> Expr:
        return m[min(i, j), max(i, j)]

    def minor(i: int, j: int) -> Expr:
        p, q = [k for k in range(3) if k != i]
        r, s = [k for k in range(3) if k != j]
        value = subtract(times(entry(p, r), entry(q, s)), times(entry(p, s), entry(q, r)))
        return value if (i + j) % 2 == 0 else times(-1, value)

    return {(i, j): names.define(f"{name}{i}{j}", minor(i, j)) for i in range(3) for j in range(i, 3)}


def _largest_column(k: dict[tuple[int, int], Expr], names: Locals) -> list[Expr]:
    """The column of a positive semidefinite matrix with the largest diagonal entry."""
    best = names.define("k_best", maximum(k[0, 0], k[1, 1]))
    column = []
    for i in range(3):
        one, two, three = (k[min(i, j), max(i, j)] for j in range(3))
        value = select(best, k[2, 2], three, select(k[0, 0], k[1, 1], two, one))
        column.append(names.define(f"column{i}", value))
    return column
