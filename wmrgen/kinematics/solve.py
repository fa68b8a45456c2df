"""Least squares whose normal matrix moves with the steering: one division at run time.

Denominators are kept above a floor far below any value a real robot takes, so that no input divides by zero.
"""

from __future__ import annotations

from fractions import Fraction

import sympy

from wmrgen.exact.evaluate import fix
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.kinematics.records import Locals
from wmrgen.kinematics.sensing import Component, Contact
from wmrgen.symbolic import (
    Expr,
    add,
    expression,
    maximum,
    number,
    root,
    select,
    square,
    subtract,
)

FLOOR = Exact(Fraction(1, 10**12))
Twist = tuple[Expr, Expr, Expr]


def _total(values: list[Poly]) -> Poly:
    return Poly.sum(values)


def _named(contacts: list[Contact], names: Locals) -> list[tuple[Poly, Poly, Poly, Poly]]:
    """Contact points and velocities with names, so that each is computed once."""
    named = []
    for c in contacts:
        n = c.wheel.name
        parts = (("bx", c.bx), ("by", c.by), ("wx", c.wx), ("wy", c.wy))
        bx, by, wx, wy = (names.poly(f"{n}_{k}", p) if p.generators else p for k, p in parts)
        named.append((bx, by, wx, wy))
    return named


def fit_rigid(contacts: list[Contact], names: Locals) -> tuple[Twist, Expr]:
    """The rigid motion nearest to measured contact velocities.

    omega = sum of (B - mean B) x (w - mean w) over sum of |B - mean B|**2; v follows from the means.
    One contact alone: the smallest twist, omega = B x w / (1 + |B|**2).
    """
    points = _named(contacts, names)
    share = Fraction(1, len(points))
    mean = [
        names.poly(f"mean_{k}", _total([p[i] for p in points]).scale(share))
        for i, k in enumerate(("bx", "by", "wx", "wy"))
    ]
    if len(points) == 1:
        above, below = mean[0] * mean[3] - mean[1] * mean[2], 1 + mean[0] * mean[0] + mean[1] * mean[1]
        omega = names.poly("omega_fit", expression(above) / expression(below))
        slip: Expr = sympy.S.Zero
    else:
        shifted = [tuple(p[i] - mean[i] for i in range(4)) for p in points]
        local = [
            tuple(names.poly(f"{c.wheel.name}_{k}0", q[i]) for i, k in enumerate(("bx", "by", "wx", "wy")))
            for c, q in zip(contacts, shifted, strict=True)
        ]
        above = _total([q[0] * q[3] - q[1] * q[2] for q in local])
        below = _total([q[0] * q[0] + q[1] * q[1] for q in local])
        omega = names.poly("omega_fit", expression(above) / maximum(expression(below), number(FLOOR)))
        errors = [e for q in local for e in (q[2] + omega * q[1], q[3] - omega * q[0])]
        slip = root(add(*(square(names.define(f"error_{i}", e)) for i, e in enumerate(errors))))
    vx, vy = mean[2] + omega * mean[1], mean[3] - omega * mean[0]
    return (expression(vx), expression(vy), expression(omega)), slip


def solve_general(contacts: list[Contact], components: list[Component], names: Locals) -> tuple[Twist, Expr]:
    """Any mix of contact velocities and single rows, by cofactors of the 3x3 normal matrix.

    Where the rows leave a direction unseen (a rear-driven bicycle steered by 90 degrees) the smallest twist
    is taken: with c1, c2 the first two invariants of N, N^+ = (c1 (I - adj N / c2) - N) / c2.
    """
    rows = _all_rows(contacts, components, names)
    n = [
        [
            names.poly(f"n{i}{j}", _total([r[i] * r[j] for r, _ in rows])) if i <= j else Poly({})
            for j in range(3)
        ]
        for i in range(3)
    ]
    n = [[n[min(i, j)][max(i, j)] for j in range(3)] for i in range(3)]
    b = [names.poly(f"b{i}", _total([r[i] * z for r, z in rows])) for i in range(3)]
    cof = _cofactors(n, names)
    det = names.poly("det", n[0][0] * cof[0][0] + n[0][1] * cof[0][1] + n[0][2] * cof[0][2])
    c1 = names.poly("c1", n[0][0] + n[1][1] + n[2][2])
    c2 = names.poly("c2", cof[0][0] + cof[1][1] + cof[2][2])
    projected = [names.poly(f"p{i}", _total([cof[i][j] * b[j] for j in range(3)])) for i in range(3)]
    twist = _regular(det, projected, rows) or _either(n, b, projected, (det, c1, c2), names)
    fitted = [names.poly(k, e) for k, e in zip(("vx_fit", "vy_fit", "omega_fit"), twist, strict=True)]
    xi: Row = (fitted[0], fitted[1], fitted[2])
    errors = [names.poly(f"error_{i}", z - dot(r, xi)) for i, (r, z) in enumerate(rows)]
    slip = root(add(*(square(expression(e)) for e in errors)))
    return (expression(xi[0]), expression(xi[1]), expression(xi[2])), slip


def _all_rows(contacts: list[Contact], components: list[Component], names: Locals) -> list[tuple[Row, Poly]]:
    one, zero = Poly.of(1), Poly({})
    rows: list[tuple[Row, Poly]] = []
    for bx, by, wx, wy in _named(contacts, names):
        rows += [((one, zero, -by), wx), ((zero, one, bx), wy)]
    for c in components:
        parts = [
            names.poly(f"{c.wheel.name}_{k}", p) if p.generators else p
            for k, p in zip(("rx", "ry", "rw"), c.row, strict=True)
        ]
        rows.append(((parts[0], parts[1], parts[2]), c.value))
    return rows


def _cofactors(n: list[list[Poly]], names: Locals) -> list[list[Poly]]:
    """The adjugate of a symmetric matrix."""

    def minor(i: int, j: int) -> Poly:
        p, q = [k for k in range(3) if k != i]
        r, s = [k for k in range(3) if k != j]
        value = n[p][r] * n[q][s] - n[p][s] * n[q][r]
        return names.poly(f"adj{i}{j}", value if (i + j) % 2 == 0 else -value)

    upper = {(i, j): minor(i, j) for i in range(3) for j in range(i, 3)}
    return [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]


def _regular(det: Poly, projected: list[Poly], rows: list[tuple[Row, Poly]]) -> list[Expr] | None:
    """adj N b / det N when the constant rows alone have rank 3, so that det N has a positive lower bound."""
    fixed = [r for r, _ in rows if all(p.constant is not None for p in r)]
    normal = [[_total([r[i] * r[j] for r in fixed]) for j in range(3)] for i in range(3)]
    values = [[fix(p, {}).constant for p in row] for row in normal]
    numbers = [[float(v) if v is not None else 0.0 for v in row] for row in values]
    a, b, c = numbers
    bound = (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )
    if bound < 1e-9 * (a[0] + b[1] + c[2]) ** 3:
        return None
    below = maximum(expression(det), number(Exact(Fraction(bound / 2).limit_denominator(10**9))))
    return [expression(p) / below for p in projected]


def _either(
    n: list[list[Poly]],
    b: list[Poly],
    projected: list[Poly],
    invariants: tuple[Poly, Poly, Poly],
    names: Locals,
) -> list[Expr]:
    det, c1, c2 = (expression(p) for p in invariants)
    over_det = names.define("over_det", 1 / maximum(det, number(FLOOR)))
    over_c2 = names.define("over_c2", 1 / maximum(c2, number(FLOOR)))
    edge = names.define("edge", number(FLOOR) * c1 * c2)
    result = []
    for i in range(3):
        seen = expression(_total([n[i][j] * b[j] for j in range(3)]))
        p = expression(projected[i])
        small = subtract(c1 * subtract(expression(b[i]), p * over_c2), seen) * over_c2
        result.append(select(edge, det, p * over_det, small))
    return result
