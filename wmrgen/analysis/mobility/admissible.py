"""The admissible twists: those for which steering exists that lets every wheel roll.

In general the left null space of the joint-rate columns, couplings applied, times the xi columns constrains the twist.
An uncoupled wheel needs no elimination: its spin takes the rolling row, a castor's steering rate takes the sliding
row. Only coupled sets of wheels are worked out. Without couplings the admissible twists are the null space of the
constant rows: any twist in it tells each steered wheel where to point. Wheels that must steer alike, or turn alike,
each add a quadratic equation in the twist; their common zeros are planes, cones or lines through the origin.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wmrgen.analysis.mobility.ranks import null_basis
from wmrgen.analysis.mobility.records import Admissible, Array
from wmrgen.geometry.constraints import ConstraintRow, Constraints
from wmrgen.geometry.exact.linalg import left_null_space
from wmrgen.geometry.exact.number import ONE, ZERO
from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.layout.records import Robot, Wheel

SMALL = 1e-9
NOISE = 1e-15  # of a unit twist, of rounding alone
_WEIGHTS = (0.83, -0.41, 0.57)  # of a generic twist


def along(w: Wheel, direction: complex) -> Array:
    """The row of the pivot's velocity component along ``direction``: [d_x, d_y, x d_y - y d_x]."""
    return np.array([direction.real, direction.imag, (w.pivot.conjugate() * direction).imag])


def coupled_sets(robot: Robot) -> list[frozenset[int]]:
    """Connected sets of wheels that share a coupled joint, each of two wheels or more; steered wheels left out."""
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
    """Rows on xi that do not depend on a steered wheel, each with the fixed wheel it comes from.

    The wheel is None for a combination that a coupling produced. A castor's angle may remain in a row (two
    castors turned by one motor). Couplings with steered wheels are treated with the steering.
    """
    rows: list[tuple[Row, int | None]] = []
    sets = coupled_sets(c.robot)
    for s in sets:
        members = [r for r in (*c.rolling, *c.sliding) if r.wheel.index in s]
        rows += [(r.row, r.wheel.index) for r in members if _without_rates(r)]
        rows += [(row, None) for row in _eliminate(c.robot, [r for r in members if not _without_rates(r)])]
    inside = frozenset[int]().union(*sets)
    rows += [(r.row, r.wheel.index) for r in c.sliding_fixed if r.wheel.index not in inside]
    return [(row, wheel) for row, wheel in rows if any(row)]


def _without_rates(row: ConstraintRow) -> bool:
    return row.kind == "sliding" and not row.rates


def _eliminate(robot: Robot, rows: Sequence[ConstraintRow]) -> list[Row]:
    """The combinations of ``rows`` (numeric joint coefficients) in which no joint rate occurs."""
    groups = {"spin": robot.spin_group, "steer": robot.steer_group}
    turns = {"spin": robot.spin_ratios, "steer": (ONE,) * len(robot.wheels)}
    rates = [
        [((joint, groups[joint][wheel]), k.scale(turns[joint][wheel])) for (wheel, joint), k in c.rates]
        for c in rows
    ]
    columns = sorted({key for row in rates for key, _ in row})
    table = [
        [sum((k.constant or ZERO for key, k in row if key == c), ZERO) for c in columns] for row in rates
    ]
    combined: list[Row] = []
    for weights in left_null_space(table):
        x, y, k = (
            Poly.sum(c.row[i].scale(w) for w, c in zip(weights, rows, strict=True) if w) for i in range(3)
        )
        combined.append((x, y, k))
    return [row for row in combined if any(row)]


def geared(robot: Robot) -> list[tuple[int, int]]:
    """Pairs of wheels with coupled spins, of which the second steers; each wheel of a group once, after the first.

    The first of a pair does not steer where the group has such a wheel. Wheels that steer together follow the first
    of them.
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
    """Whether the steering of wheels is tied to other joints."""
    steered = [w.index for w in robot.wheels if w.kind.steers]
    return len({robot.steer_group[i] for i in steered}) < len(steered) or bool(geared(robot))


def quadrics(robot: Robot) -> list[Array]:
    """Symmetric 3x3 forms that vanish on twists allowed by the couplings of steered wheels."""
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
            # One angle for both: not only the sizes of the velocities are in proportion, seen from the wheels.
            both = _pivot(a) - _pivot(b) * ratio
            forms += [np.outer(row, row) / (row @ row) for row in both if np.abs(row).max() > SMALL]
        else:
            forms.append((_speed_form(a) - _speed_form(b) * ratio**2) / max(1.0, ratio**2))
    forms = [(f + f.T) / 2 for f in forms]
    return [f for f in forms if np.abs(f).max() > SMALL]


def _pivot(w: Wheel) -> Array:
    """2x3: twist to pivot velocity, in the joint frame at zero steering; mirrored for a wheel that turns against the
    one that leads it, so that coupled wheels have one angle."""
    return np.array([along(w, w.zero_heading), along(w, 1j * w.zero_heading) * w.steer_sign])


def _speed_form(w: Wheel) -> Array:
    """The form of the squared rim speed."""
    p = _pivot(w)
    if w.kind.steers:
        return p.T @ p
    rolling = float(w.nominal.cg) * p[0] + float(w.nominal.sg) * p[1]
    return np.outer(rolling, rolling)


def components(rows: Array, forms: Sequence[Array], tolerance: float = SMALL) -> list[Admissible]:
    """Components of {xi: rows xi = 0 and every form vanishes}; forms on that space below ``tolerance`` are none."""
    space = null_basis(rows)
    if not len(space):
        return []
    space = np.where(np.abs(space) < NOISE, 0.0, _oriented(space[0])[None, :] if len(space) == 1 else space)
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
        # Common zeros of two forms are zeros of the degenerate ones of their pencil.
        roots = np.roots(np.poly(np.linalg.solve(first, other)))
        pencil = [_normals(other - r.real * first) for r in roots if abs(r.imag) < 1e-9]
        normals = [n for normals in pencil for n in normals or []]
    return [c for n in normals for c in components(np.vstack([rows, n @ space]), forms, 10 * tolerance)]


def _normals(form: Array) -> list[Array] | None:
    """Normals (rows) of each space on which a degenerate form is zero: two planes, one, or a line. None of another."""
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
    """Whether one is a multiple of the other."""
    f, g = f / np.linalg.norm(f), g / np.linalg.norm(g)
    return bool(min(np.abs(f - g).max(), np.abs(f + g).max()) < 1e-9)


def _oriented(v: Array) -> Array:
    """The vector or its opposite: the first clearly non-zero entry is positive."""
    lead = next(float(c) for c in v if abs(c) > 1e-6)
    return v if lead > 0 else -v


def _conic(form: Array, space: Array) -> list[Admissible]:
    """A real, non-degenerate cone of twists: dimension 2, not linear."""
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
