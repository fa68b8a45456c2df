"""The least-squares twist of rows with symbolic geometry, in the exact form that needs the fewest operations.

With H the rows, W their weights and z their values, the twist is (H^T W H)^-1 H^T W z. It can be written in several
exact forms:

* for three rows, H^-1 z, so that the residual is 0 and the condition number is not squared;
* written out, with each component as one fraction in lowest terms;
* step by step, with names for the entries of H^T W H, which `prepare` computes once.

The residual of four rows has one degree of freedom. With w the null vector of H^T it is |w . z| / |w|. For a mecanum
base this is a number times the difference of two sums of spins. The residual of more rows is the norm of z - H xi.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.least_squares import Measured, norm, normal_equations, ratio_of
from wmrgen.analysis.kinematics.records import Locals
from wmrgen.geometry.exact.evaluate import fix, sqrt_poly
from wmrgen.geometry.exact.linalg import adjugate, cofactor, determinant
from wmrgen.geometry.exact.lowest import (
    Product,
    common_divisor,
    divided,
    quotient,
    related,
    shorter,
    unrelated,
)
from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.geometry.exact.poly import Poly, Row, dot, triple
from wmrgen.geometry.symbolic import Expr, Input, expression, times

Twist = tuple[Expr, Expr, Expr]
# The most terms of a component that is written out. Four omni wheels with a length each have 64 terms. Six have 216:
# written out they take 610 operations, step by step 130, and the common divisors of their parameters took 4 seconds.
MOST_TERMS = 100
_ONE = Poly.of(1)


class Solution(NamedTuple):
    """A twist and the norm of its residual."""

    twist: Twist
    slip: Expr  # norm of the residual [m/s]
    names: Locals  # intermediate results of both


class Merged(NamedTuple):
    """Rows without proportional pairs."""

    rows: list[Measured]
    # Differences between the values of proportional rows, and their weights.
    differences: list[tuple[Poly, Exact]]


def solve_symbolic(rows: Sequence[Measured], names: Locals, most_terms: int = MOST_TERMS) -> Solution:
    """Return the least-squares twist of rows that have rank 3 for nominal parameters.

    Args:
        rows: Measured rows [m/s over m/s, m/s, rad/s], geometry in symbols, no joint angle.
        names: Intermediate results that the values of the rows refer to.
        most_terms: The most terms of a component that is written out.

    Returns:
        The exact form with the fewest operations.
    """
    merged = merge(rows)
    solve, own = _square_steps if len(merged.rows) == 3 else _steps, names.copy()
    twists = [(solve(merged.rows, own), own)]
    products = written_out(rows, most_terms)
    if products is not None:
        twists.append(([_expression(p) for p in products], names.copy()))
    forms = [form for form, _ in merged.differences]
    weights = [weight for _, weight in merged.differences]
    solutions = []
    for twist, own in twists:
        if len(merged.rows) > 3:
            other = own.copy()
            slip, fitted = _norm_of_errors(rows, twist, other)
            solutions.append(Solution(fitted, slip, other))
        if len(merged.rows) == 4:
            slip = norm([*forms, _one_relation(merged.rows, own)], weights=[*weights, ONE])
            solutions.append(Solution(triple(twist), slip, own))
        if len(merged.rows) == 3:
            solutions.append(Solution(triple(twist), norm(forms, weights=weights), own))
    return min(solutions, key=lambda s: operations(s.names, (*s.twist, s.slip)))


def merge(rows: Sequence[Measured]) -> Merged:
    """Merge proportional rows into one row with the weighted mean of their values and the sum of their weights."""
    own: list[Measured] = []
    differences: list[tuple[Poly, Exact]] = []
    for row, value, weight in rows:
        for i, (other, mean, total) in enumerate(own):
            k = _proportion(row, other)
            if k is None:
                continue
            value, weight = value.scale(k.inverse()), weight * k * k
            differences.append((value - mean, weight * total / (weight + total)))
            mean = (mean.scale(total) + value.scale(weight)).scale((weight + total).inverse())
            own[i] = (other, mean, weight + total)
            break
        else:
            own.append((row, value, weight))
    return Merged(own, [(form, weight) for form, weight in differences if form])


def _proportion(row: Row, other: Row) -> Exact | None:
    """Return k if row = k other, else None."""
    if any(bool(a) != bool(b) for a, b in zip(row, other, strict=True)):
        return None
    ratios = {ratio_of(a, b) for a, b in zip(row, other, strict=True) if a}
    return ratios.pop() if len(ratios) == 1 else None


# ---- the twist


def written_out(rows: Sequence[Measured], most_terms: int = MOST_TERMS) -> list[Product] | None:
    """Return the least-squares twist of rows of rank 3, each component as one product in lowest terms.

    Args:
        rows: Measured rows [m/s over m/s, m/s, rad/s], geometry in symbols, no joint angle in a row.
        most_terms: The most terms of a component.

    Returns:
        vx, vy [m/s] and omega [rad/s]; None if a component has more terms.
    """
    plain = [(triple(map(unrelated, row)), unrelated(z), weight) for row, z, weight in merge(rows).rows]
    if len(plain) == 3:
        matrix, values = [list(row) for row, _, _ in plain], [z for _, z, _ in plain]
    else:
        normal, values = normal_equations(plain)
        matrix = [[shorter(p) for p in row] for row in normal]
    # An entry of the adjugate has T**2 terms for T terms in an entry of the matrix.
    entry = max(len(p.terms) for p in chain(*matrix))
    value = max(len(p.terms) for p in values)
    return _by_cramer(matrix, values) if entry**2 * value <= most_terms else None


def _by_cramer(matrix: Sequence[Sequence[Poly]], values: Sequence[Poly]) -> list[Product]:
    """Return matrix^-1 values by Cramer's rule, each component as geometry times a sum in lowest terms."""
    det = shorter(determinant(matrix))
    results = []
    for row in adjugate(matrix):
        above = Poly.sum(shorter(p) * v for p, v in zip(row, values, strict=True))
        results.append(_related(quotient(above, det)))
    return results


def _related(p: Product) -> Product:
    return Product(related(p.factor), related(p.rest))


def _expression(p: Product) -> Expr:
    return times(expression(p.factor), expression(p.rest))


def _square_steps(rows: Sequence[Measured], names: Locals) -> list[Expr]:
    """Return adj(H) z / det(H) with names for entries, cofactors and determinant."""
    named = _named(rows, names)
    matrix = [list(row) for row, _, _ in named]
    adj: list[list[Poly]] = [[], [], []]
    for j in range(3):
        for i in range(3):
            adj[j].append(names.short(f"adj{j}{i}", cofactor(matrix, i, j), f"adj(H)[{j}][{i}]"))
    det = dot(matrix[0], [row[0] for row in adj])
    factor = names.short("det", det, "det(H)").inverse()
    values = [z for _, z, _ in named]
    return [times(expression(factor), expression(dot(row, values))) for row in adj]


def _steps(rows: Sequence[Measured], names: Locals) -> list[Expr]:
    """Return the twist by elimination, H^T W H = L D L^T, with constant pivots first because they need no division."""
    normal, moment = normal_equations(_named(rows, names))
    n: dict[tuple[int, int], Poly] = {}
    for i in range(3):
        for j in range(i, 3):
            n[i, j] = n[j, i] = names.short(f"n{i}{j}", normal[i][j], f"HtH[{i}][{j}]")
    b = [names.short(f"b{i}", p, f"Htz[{i}]") for i, p in enumerate(moment)]
    left = [0, 1, 2]
    order: list[int] = []
    reciprocals: list[Poly] = []
    while left:
        i = next((i for i in left if n[i, i].constant is not None), left[0])
        left.remove(i)
        order.append(i)
        reciprocals.append(n[i, i].inverse())
        for j in left:
            if not n[i, j]:
                continue
            share = names.short(f"share{j}{i}", n[i, j] * reciprocals[-1])
            b[j] = names.short(f"b{j}", b[j] - share * b[i])
            for k in [k for k in left if k >= j and n[i, k]]:
                n[j, k] = n[k, j] = names.short(f"n{j}{k}", n[j, k] - share * n[i, k])
    twist: dict[int, Poly] = {}
    for i, reciprocal in zip(reversed(order), reversed(reciprocals), strict=True):
        rest = Poly.sum([b[i], *(-(n[i, k] * value) for k, value in twist.items())])
        twist[i] = names.poly(f"{('vx', 'vy', 'omega')[i]}_fit", rest * reciprocal)
    return [expression(twist[i]) for i in range(3)]


def _named(rows: Sequence[Measured], names: Locals) -> list[Measured]:
    """Return the rows with names for entries that are sums."""
    named: list[Measured] = []
    for i, (row, z, weight) in enumerate(rows):
        entries = triple(names.short(f"row{i}_{k}", p) for k, p in zip("xyw", row, strict=True))
        named.append((entries, _value(i, z, names), weight))
    return named


def _value(i: int, z: Poly, names: Locals) -> Poly:
    """Return a measured value [m/s], with a name unless it is a number or a signal."""
    plain = len(z.terms) < 2 and all(len(m) < 2 and abs(c) == ONE for m, c in z.terms.items())
    return z if plain else names.poly(f"z{i}", z)


# ---- the residual


def _norm_of_errors(rows: Sequence[Measured], twist: list[Expr], names: Locals) -> tuple[Expr, Twist]:
    """Return the norm of z - H xi over all rows, and the twist with names for its components."""
    fitted = []
    for name, e in zip(("vx_fit", "vy_fit", "omega_fit"), twist, strict=True):
        fitted.append(Poly.gen("local", e.name) if e.is_Symbol else names.poly(name, e))
    errors = [_value(i, z, names) - dot(row, fitted) for i, (row, z, _) in enumerate(rows)]
    return norm(errors, weights=[weight for _, _, weight in rows]), triple(map(expression, fitted))


def _one_relation(rows: Sequence[Measured], names: Locals) -> Poly:
    """Return (w . z) / sqrt(w W^-1 w) for four rows, where w H = 0: w has the 3x3 minors of H in lowest terms."""
    matrix = [[unrelated(p) for p in row] for row, _, _ in rows]
    minors = []
    for i in range(4):
        others = [row for k, row in enumerate(matrix) if k != i]
        minors.append(determinant(others))
    signed = [-p if i % 2 else p for i, p in enumerate(map(shorter, minors))]
    divisor = common_divisor(signed)
    null = [names.short(f"null{i}", related(divided(p, divisor))) for i, p in enumerate(signed)]
    factor, form = quotient(Poly.sum(w * z for w, (_, z, _) in zip(null, rows, strict=True)), _ONE)
    size = Poly.sum((w * w).scale(weight.inverse()) for w, (_, _, weight) in zip(null, rows, strict=True))
    scale = fix(sqrt_poly(size), {}) if size.constant else Poly.gen("sqrt", "", size)
    return names.poly("relation", _expression(_related(Product(factor * scale.inverse(), form))))


# ---- the choice


def operations(names: Locals, results: Sequence[Expr]) -> int:
    """Return a cost of these results: the number of distinct operations.

    Operations that depend on a signal, which the robot computes at every step, count twice. A product with a negative
    sign counts as one operation.
    """
    values = dict(names.items)
    moves: dict[Expr, bool] = {}  # whether an expression depends on a signal
    count = 0

    def visit(e: Expr) -> bool:
        nonlocal count
        if e in moves:
            return moves[e]
        if e in values:
            moves[e] = visit(values[e])
        elif e.is_Mul and e.args[0].is_Number:
            moves[e] = visit(sympy.Mul(*e.args[1:], evaluate=False) if len(e.args) > 2 else e.args[1])
            count += (abs(e.args[0]) != 1) * (1 + moves[e])
        else:
            # A sum visits all arguments; any() would stop at the first one.
            moves[e] = sum(visit(a) for a in e.args) > 0 or isinstance(e, Input)
            if e.args and not e.is_Number:
                count += max(1, len(e.args) - 1) * (1 + moves[e])
        return moves[e]

    for result in results:
        visit(result)
    return count
