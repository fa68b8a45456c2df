"""The admissible twists: those for which some steering lets every wheel roll without sliding.

In general the left null space of the joint-rate columns, couplings applied, times the xi columns constrains the twist.
An uncoupled wheel needs no elimination: its spin satisfies the rolling row, and a castor's steering rate satisfies the
sliding row. Only coupled sets of wheels need elimination. Without couplings the admissible twists are the null space of
the constant rows, because each steered wheel can point along the velocity of its pivot. Each pair of wheels whose
steering or spins are coupled adds a quadratic equation in the twist. The common zeros of these equations are planes,
cones or lines through the origin.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wmrgen.analysis.mobility.ranks import null_basis
from wmrgen.analysis.mobility.records import Admissible, Array
from wmrgen.geometry.constraints import ConstraintRow, Constraints
from wmrgen.geometry.exact.linalg import left_null_space
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Row, sum_of_rows
from wmrgen.geometry.layout.records import Robot, Wheel

SMALL = 1e-9  # relative to rows and forms of size 1: smaller ones are zero up to rounding
NOISE = 1e-15  # relative to a unit twist: smaller components are rounding errors and set to 0
_WEIGHTS = (
    0.83,
    -0.41,
    0.57,
)  # weights of basis vectors for a generic twist; any values without a pattern would do


def along(w: Wheel, direction: complex) -> Array:
    """Return the row of the pivot's velocity component along ``direction``: [d_x, d_y, x d_y - y d_x]."""
    return np.array([direction.real, direction.imag, (w.pivot.conjugate() * direction).imag])


def coupled_sets(robot: Robot) -> list[frozenset[int]]:
    """Return the connected sets of two or more wheels with coupled joints, without steered wheels."""
    sets: list[set[int]] = []
    for group in (robot.spin_group, robot.steer_group):
        for leader in dict.fromkeys(group):
            members = {i for i, g in enumerate(group) if g == leader and not robot.wheels[i].kind.steers}
            if len(members) < 2:
                continue
            touching = [s for s in sets if s & members]
            sets = [s for s in sets if not s & members]
            sets.append(members.union(*touching))
    return [frozenset(s) for s in sets]


def constant_rows(c: Constraints) -> list[tuple[Row, int | None]]:
    """Return the rows on xi that do not depend on a steered wheel, each with the index of its fixed wheel.

    The index is None for a row that results from a coupling. Such a row may contain castor angles, if one motor turns
    two castors. Couplings with steered wheels are not included here: see `quadrics`.
    """
    rows: list[tuple[Row, int | None]] = []
    sets = coupled_sets(c.robot)
    for s in sets:
        members = [r for r in (*c.rolling, *c.sliding) if r.wheel.index in s]
        rows += [(r.row, r.wheel.index) for r in members if _without_rates(r)]
        with_rates = [r for r in members if not _without_rates(r)]
        rows += [(row, None) for row in _eliminate(c.robot, with_rates)]
    inside = frozenset[int]().union(*sets)
    rows += [(r.row, r.wheel.index) for r in c.sliding_fixed if r.wheel.index not in inside]
    return [(row, wheel) for row, wheel in rows if any(row)]


def _without_rates(row: ConstraintRow) -> bool:
    return row.kind == "sliding" and not row.rates


def _eliminate(robot: Robot, rows: Sequence[ConstraintRow]) -> list[Row]:
    """Return the linear combinations of ``rows`` in which no joint rate occurs.

    The coefficients of joint rates are numbers. Coupled joints have one rate, that of the leading wheel.
    """
    groups = {"spin": robot.spin_group, "steer": robot.steer_group}
    ratios = {"spin": robot.spin_ratios, "steer": (ONE,) * len(robot.wheels)}
    coefficients: list[dict[tuple[str, int], Exact]] = []
    for c in rows:
        of_row: dict[tuple[str, int], Exact] = {}
        for (wheel, joint), k in c.rates:
            key = joint, groups[joint][wheel]
            of_row[key] = of_row.get(key, ZERO) + (k.scale(ratios[joint][wheel]).constant or ZERO)
        coefficients.append(of_row)
    columns = sorted({key for of_row in coefficients for key in of_row})
    table = [[of_row.get(key, ZERO) for key in columns] for of_row in coefficients]
    combined: list[Row] = []
    for weights in left_null_space(table):
        weighted = [[p.scale(w) for p in c.row] for w, c in zip(weights, rows, strict=True) if w]
        combined.append(sum_of_rows(weighted))
    return [row for row in combined if any(row)]


def geared(robot: Robot) -> list[tuple[int, int]]:
    """Return pairs of wheel indices with coupled spins, in which the second wheel steers.

    Each steered wheel of a coupled set, except a reference wheel, is the second of one pair. The first of the pair is
    the reference: a wheel that does not steer, if the set has one. For wheels whose steering is coupled too, the first
    of them is the reference of the others.
    """
    pairs: list[tuple[int, int]] = []
    for members in robot.together("spin", robot.wheels):
        first = min(members, key=lambda w: (w.kind.steers, w.index))
        for unit in robot.together("steer", (w for w in members if w.kind.steers)):
            if unit[0] is not first:
                pairs.append((first.index, unit[0].index))
            pairs += [(unit[0].index, w.index) for w in unit[1:]]
    return pairs


def coupled_steering(robot: Robot) -> bool:
    """Return whether the steering of some wheel is coupled to another joint, directly or through coupled spins."""
    steered = [w.index for w in robot.wheels if w.kind.steers]
    return len({robot.steer_group[i] for i in steered}) < len(steered) or bool(geared(robot))


def quadrics(robot: Robot) -> list[Array]:
    """Return symmetric 3x3 forms Q with xi^T Q xi = 0 for all twists that the couplings of steered wheels allow."""
    forms: list[Array] = []
    for i, leader in enumerate(robot.steer_group):
        a, b = robot.wheels[leader], robot.wheels[i]
        if i != leader and a.kind.steers and b.kind.steers:
            p, q = _pivot(a), _pivot(b)
            forms.append(np.outer(p[0], q[1]) - np.outer(p[1], q[0]))
    for i, k in geared(robot):
        a, b = robot.wheels[i], robot.wheels[k]
        ratio = float(robot.per_turn(a, a.nominal) / robot.per_turn(b, b.nominal))
        if robot.steer_group[i] == robot.steer_group[k]:
            # With a common angle the velocities are proportional as vectors in the joint frames, not only in size.
            both = _pivot(a) - _pivot(b) * ratio
            forms += [np.outer(row, row) / (row @ row) for row in both if np.abs(row).max() > SMALL]
        else:
            forms.append((_speed_form(a) - _speed_form(b) * ratio**2) / max(1.0, ratio**2))
    forms = [(f + f.T) / 2 for f in forms]
    return [f for f in forms if np.abs(f).max() > SMALL]


def _pivot(w: Wheel) -> Array:
    """Return the 2x3 matrix from the twist to the pivot velocity, in the joint frame at zero steering.

    It is mirrored for a wheel that steers opposite to its leading wheel, so that coupled wheels have one angle.
    """
    return np.array([along(w, w.zero_heading), along(w, 1j * w.zero_heading) * w.steer_sign])


def _speed_form(w: Wheel) -> Array:
    """Return the quadratic form of the squared rim speed."""
    p = _pivot(w)
    if w.kind.steers:
        return p.T @ p
    rolling = float(w.nominal.cg) * p[0] + float(w.nominal.sg) * p[1]
    return np.outer(rolling, rolling)


def components(rows: Array, forms: Sequence[Array], tolerance: float = SMALL) -> list[Admissible]:
    """Return the linear or conic components of the set {xi: rows xi = 0, and every form vanishes}.

    Args:
        rows: Linear equations on the twist, shape (N, 3).
        forms: Quadratic equations on the twist, each a symmetric matrix of shape (3, 3).
        tolerance: A form that is relatively smaller than this on the null space of the rows is treated as zero.

    Returns:
        The components; none if only the zero twist is in the set.
    """
    space = null_basis(rows)
    if not len(space):
        return []
    if len(space) == 1:
        space = _oriented(space[0])[None, :]
    space = np.where(np.abs(space) < NOISE, 0.0, space)
    seen = [space @ f @ space.T for f in forms]
    reduced = [f for f, g in zip(seen, forms, strict=True) if np.abs(f).max() > tolerance * np.abs(g).max()]
    if not reduced:
        return [Admissible(space, np.array(_WEIGHTS[: len(space)]) @ space, True, space)]
    first = reduced[0]
    normals = _normals(first)
    if normals is None:
        other = next((f for f in reduced if not _proportional(f, first)), None)
        if other is None:
            return _conic(first, space)
        # The common zeros of two forms are zeros of the degenerate forms in their pencil.
        normals = []
        for value in np.roots(np.poly(np.linalg.solve(first, other))):
            if abs(value.imag) < 1e-9:
                normals += _normals(other - value.real * first) or []
    found: list[Admissible] = []
    for n in normals:
        found += components(np.vstack([rows, n @ space]), forms, 10 * tolerance)
    return found


def _normals(form: Array) -> list[Array] | None:
    """Return the normals (rows) of each space on which a degenerate form is zero: two planes, one plane or one line.

    Return None for a form that is not degenerate.
    """
    values, vectors = np.linalg.eigh(form)
    live = np.abs(values) > 1e-9 * np.abs(values).max()
    axes = np.array([_oriented(v) for v in vectors[:, live].T])
    if len(axes) == 3:
        return None
    if len(axes) == 1 or (values[live] > 0).all() or (values[live] < 0).all():
        return [axes]
    p, q = np.sqrt(np.abs(values[live]))[:, None] * vectors[:, live].T
    return [_oriented(n / np.linalg.norm(n))[None, :] for n in (p + q, p - q)]


def _proportional(f: Array, g: Array) -> bool:
    """Return whether one form is a multiple of the other."""
    f, g = f / np.linalg.norm(f), g / np.linalg.norm(g)
    return bool(min(np.abs(f - g).max(), np.abs(f + g).max()) < 1e-9)


def _oriented(v: Array) -> Array:
    """Return the vector or its opposite, so that the first clearly non-zero entry is positive."""
    lead = next(float(c) for c in v if abs(c) > 1e-6)
    return v if lead > 0 else -v


def _conic(form: Array, space: Array) -> list[Admissible]:
    """Return the cone of zeros of a non-degenerate form, of dimension 2; none if the form is definite."""
    values, vectors = np.linalg.eigh(form)
    if (values > 0).all() or (values < 0).all():
        return []
    odd = 0 if values[0] * values[1] < 0 else 2
    others = [k for k in range(3) if k != odd]
    z = np.zeros(3)
    z[others] = (0.6, 0.8)
    z[odd] = np.sqrt(-sum(values[k] * z[k] ** 2 for k in others) / values[odd])
    point = _oriented(vectors @ z)
    tangent = null_basis((form @ point)[None, :])
    return [Admissible(space, point @ space, False, tangent @ space)]
