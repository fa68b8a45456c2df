"""Least squares at derivation time: inverses of constant normal matrices, norms of residuals, the nearest twist.

Each connected block of a normal matrix is inverted exactly, by cofactors, so that with tunable geometry prepare() needs
one reciprocal for each block. A rank-deficient matrix gets its Moore-Penrose inverse, for its rank at nominal values of
the tunable parameters.

If a commanded twist is not admissible, the robot drives the nearest admissible twist. If the fixed wheels are on one
axle line, the component of the velocity along the axle is removed. If coupled steering keeps all axles parallel, the
rotation is removed, and the centroid of the wheels keeps its velocity. The distance between twists is measured in
velocities of contact points [m/s], so that it does not depend on the frame or the unit of length. A degenerate robot
(skid-steer) has few admissible twists. It therefore keeps the commanded twist, its wheels follow by least squares, and
the sliding is reported.

slip is the norm of the speeds at which wheels slide, like the residual of `forward`. A mean would hide a single wheel
that slides fast, and a maximum would differ from the residual that `forward` measures for the same motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import sympy

from wmrgen.analysis.mobility.ranks import independent, numeric_rank, to_array
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.geometry.constraints import XI, rolling_row, sliding_row, working_view
from wmrgen.geometry.exact.evaluate import fix, sqrt_poly
from wmrgen.geometry.exact.linalg import inverse, mean, symmetric
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly, Row, dot, has_angles, triple
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.geometry.symbolic import Expr, absolute, add, expression, number, root, square, times

Matrix = list[list[Poly]]
Numbers = list[list[Exact]]
Measured = tuple[Row, Poly, Exact]  # row, value and weight of the equation row . xi = value [m/s]


def normal_equations(rows: Sequence[Measured]) -> tuple[Matrix, list[Poly]]:
    """Return H^T W H and H^T W z."""

    def moment(i: int) -> Poly:
        return Poly.sum((r[i] * z).scale(w) for r, z, w in rows)

    normal = symmetric(lambda i, j: Poly.sum((r[i] * r[j]).scale(w) for r, _, w in rows))
    return normal, [moment(i) for i in range(3)]


def named_normal(normal: Matrix, name: Callable[[str, Poly, str], Poly]) -> Matrix:
    """Return H^T W H with names for its entries."""
    return symmetric(lambda i, j: name(f"n{i}{j}", normal[i][j], f"HtH[{i}][{j}]"))


def pseudo_inverse(normal: Matrix, nominal: Numbers | None) -> Matrix:
    """Return the inverse of a symmetric positive semidefinite 3x3 matrix H^T H of constants.

    ``nominal`` has its values at nominal parameters, which determine the rank of the Moore-Penrose inverse. It is None
    if H has rank 3.
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
    """Return the sets of indices that are connected by non-zero entries."""
    blocks: list[list[int]] = []
    for i in range(3):
        merged, others = [i], []
        for block in blocks:
            if any(m[i][j] for j in block):
                merged += block
            else:
                others.append(block)
        blocks = [*others, sorted(merged)]
    return sorted(blocks)


def _invert(part: Matrix, numbers: Numbers | None) -> Matrix:
    """Return the inverse of a block m, or B^T (B m B^T)^-1 B if m is singular; the rows B span the range of m."""
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
    middle = inverse(_congruent(rows, part))
    return _congruent(columns, middle)


def _congruent(rows: list[list[Poly]], m: Matrix) -> Matrix:
    """Return R m R^T for the rows R."""
    products = [[_dot(row, b) for row in m] for b in rows]  # the columns of m R^T
    return [[_dot(a, column) for column in products] for a in rows]


def _dot(a: Sequence[Poly], b: Sequence[Poly]) -> Poly:
    return Poly.sum(x * y for x, y in zip(a, b, strict=True))


NEGLIGIBLE = 1e-12  # relative: smaller coefficients are rounding errors of exact zeros


def norm(forms: Sequence[Poly], weight: Exact = ONE, weights: Sequence[Exact] | None = None) -> Expr:
    """Return the weighted norm of several forms, sqrt(weight * sum(weights[i] * forms[i]**2)).

    Proportional forms are merged, so that a single form needs no square root.

    Args:
        forms: The forms, usually residuals [m/s].
        weight: A common weight.
        weights: The weights of the forms, by default 1.

    Returns:
        The norm, without forms that are 0 up to rounding.
    """
    groups: list[tuple[Poly, Exact]] = []
    for form, own in zip(forms, weights or [ONE] * len(forms), strict=True):
        if not form or max(abs(float(c)) for c in form.terms.values()) < NEGLIGIBLE:
            continue
        for i, (base, total) in enumerate(groups):
            ratio = ratio_of(form, base)
            if ratio is not None:
                groups[i] = (base, total + ratio * ratio * own)
                break
        else:
            groups.append((form, own))
    if not groups:
        return sympy.S.Zero
    if len(groups) == 1:
        base, total = groups[0]
        factor = fix(sqrt_poly(Poly.of(total * weight)), {})
        return absolute(expression(base * factor))
    return root(add(*(times(number(t * weight), square(expression(b))) for b, t in groups)))


def ratio_of(a: Poly, b: Poly, negligible: float = 0.0) -> Exact | None:
    """Divide two proportional polynomials.

    Args:
        a: The numerator, not 0.
        b: The denominator, not 0.
        negligible: The largest relative error of a coefficient that is ignored.

    Returns:
        The number a / b, or None if they are not proportional.
    """
    if a.terms.keys() != b.terms.keys():
        return None
    m = next(iter(b.terms))
    ratio = a.terms[m] / b.terms[m]
    off = ((c, c - ratio * b.terms[k]) for k, c in a.terms.items())
    return ratio if all(abs(float(rest)) <= negligible * abs(float(c)) for c, rest in off) else None


class Projection(NamedTuple):
    """The twist that is driven for a commanded twist. slip = sqrt(weight * sum of residuals**2)."""

    twist: Row
    residuals: tuple[Poly, ...]  # [m/s]
    weight: Exact

    def named(self, name: Callable[[str, Poly], Poly]) -> Row:
        """Return the twist, with components that differ from the commanded ones replaced by ``name(name, value)``."""
        each = zip(self.twist, XI, TWIST_NAMES, strict=True)
        return triple(p if p == q or not p else name(f"{n}_driven", p) for p, q, n in each)


def project(robot: Robot, mobility: Mobility) -> Projection:
    """Return the driven twist for a commanded twist, and the residuals of the difference."""
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    picked = mobility.admissible
    if len(picked.chosen) == 1 and mobility.rank_C1f.value == 1:
        nx, ny, k = sliding_row(fixed[0], working_view(fixed[0])).row
        lateral = dot((nx, ny, k), XI)
        return Projection((XI[0] - nx * lateral, XI[1] - ny * lateral, XI[2]), (lateral,), Exact(len(fixed)))
    if picked.normal is not None and not picked.normal[0] and not picked.normal[1]:
        return _translate(robot)
    if len(picked.chosen) == 1 and not mobility.degenerate and not has_angles(mobility.basis_rows[0]):
        return _nearest(robot, mobility.basis_rows[0])
    residuals = [dot(sliding_row(w, working_view(w)).row, XI) for w in fixed]
    residuals += _spin_residuals(robot)
    return Projection(XI, tuple(residuals), ONE)


def _nearest(robot: Robot, row: Row) -> Projection:
    """Return the nearest twist with row . xi = 0, in the mean square velocity of all wheel pivots.

    It is xi - M^-1 row^T (row . xi) / (row M^-1 row^T), with M the mean of [1 0 -y; 0 1 x]^T [1 0 -y; 0 1 x].
    """
    wheels = [working_view(w) for w in robot.wheels]
    one, zero = Poly.of(1), Poly({})
    gx, gy = mean([g.x for g in wheels]), mean([g.y for g in wheels])
    spread = mean([g.x * g.x + g.y * g.y for g in wheels])
    inverse = pseudo_inverse([[one, zero, -gy], [zero, one, gx], [-gy, gx, spread]], None)
    direction = [dot(r, row) for r in inverse]
    size = dot(direction, row)
    violation = dot(row, XI)
    factor = violation * size.inverse()
    twist = triple(t - d * factor for t, d in zip(XI, direction, strict=True))
    return Projection(twist, (violation * fix(sqrt_poly(size.inverse()), {}),), Exact(len(wheels)))


def _spin_residuals(robot: Robot) -> list[Poly]:
    """Return the rim speeds at which wheels with coupled spins slide, for sets without steered wheels and castors."""
    residuals: list[Poly] = []
    for members in robot.together("spin", (w for w in robot.wheels if w.has_spin)):
        if len(members) == 1 or any(w.turns for w in members):
            continue
        radii = [robot.per_turn(w, working_view(w)) for w in members]
        rims = [dot(rolling_row(w, working_view(w)).row, XI) for w in members]
        total = Poly.sum(r * r for r in radii).inverse()
        speed = Poly.sum(r * z for r, z in zip(radii, rims, strict=True)) * total
        residuals += [z - r * speed for r, z in zip(radii, rims, strict=True)]
    return residuals


def _translate(robot: Robot) -> Projection:
    """Return the twist without rotation in which the centroid of the steered wheels has the commanded velocity."""
    wheels = [working_view(w) for w in robot.wheels if w.kind.steers]
    gx, gy = mean([g.x for g in wheels]), mean([g.y for g in wheels])
    spread = Poly.sum((g.x - gx) ** 2 + (g.y - gy) ** 2 for g in wheels)
    root = fix(sqrt_poly(spread), {})
    omega = XI[2]
    return Projection((XI[0] - omega * gy, XI[1] + omega * gx, Poly({})), (omega * root,), ONE)
