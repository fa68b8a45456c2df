"""Choose independent rows of C1, and write their null space in short polynomials without common factors.

A matrix of rank 1 is the row of an axle: its null space is motion along the wheel and rotation about a point of the
axle. The null space of a matrix of rank 2 is the cross product of its rows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import combinations
from typing import NamedTuple, TypeVar, cast

import numpy as np

from wmrgen.analysis.mobility.admissible import along, geared
from wmrgen.analysis.mobility.configure import Configuration
from wmrgen.analysis.mobility.ranks import independent, singular_values, to_array, unit_rows
from wmrgen.analysis.mobility.records import Array
from wmrgen.geometry.constraints import View, rolling_row, sliding_row
from wmrgen.geometry.exact.evaluate import number, sqrt_poly
from wmrgen.geometry.exact.linalg import mean
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import (
    Gen,
    Monomial,
    Poly,
    Row,
    at_angle,
    common_powers,
    cross,
    each,
    has_angles,
    triple,
)
from wmrgen.geometry.layout.records import Robot, Wheel

INDEPENDENT = 1e-3  # smallest singular value of unit rows that are clearly independent
MOST_CANDIDATES = 16  # steered wheels that are combined in all ways: at most 560 combinations
NEGLIGIBLE = 1e-9  # relative to the largest coefficient, or m/s: smaller values are rounding errors
_CLEAR = 0.5  # share of the largest singular value from which the place of wheels decides (jpl_osr: 0.88)
_ZERO, _ONE = Poly({}), Poly.of(1)
IDENTITY: tuple[Row, ...] = ((_ONE, _ZERO, _ZERO), (_ZERO, _ONE, _ZERO), (_ZERO, _ZERO, _ONE))

Polys = TypeVar("Polys", bound=tuple[Poly, ...])


class BasisRow(NamedTuple):
    """A row of C1."""

    row: Callable[[View], Row]  # the row in a view of the geometry, for twists in SI units
    steered: tuple[Wheel, ...] = ()  # the steered wheels that it comes from


def basis(robot: Robot, at: Configuration) -> tuple[BasisRow, ...]:
    """Return independent rows that span C1: constant rows first, then the row of couplings, then steered wheels.

    The row of couplings contains lengths as numbers, except if it only forbids rotation. It is therefore replaced by
    rows of steered wheels, which contain the lengths as symbols, if the angles of these wheels are free.
    """
    normal = at.admissible.normal
    if normal is not None and (normal[0] or normal[1]):
        rows = _spanning(robot, at, None)
        angles = {robot.steer_group[w.index] for w in deciding(rows)}
        if len(angles) <= at.steerability:
            return rows
    return _spanning(robot, at, normal)


def _spanning(robot: Robot, at: Configuration, normal: Row | None) -> tuple[BasisRow, ...]:
    """Return rows that span C1, including ``normal``, the row of couplings, if it is given."""
    fixed = [_constant(robot, at.unit.row(row), index) for row, index in at.constant]
    numbers = [at.C1[: len(fixed)]]
    if normal is not None:
        fixed.append(_constant(robot, at.unit.row(normal), None))
        numbers.append(to_array([[p.constant or ZERO for p in normal]]))
    numbers.append(at.C1[len(at.constant) :])
    steered = [w for w in robot.wheels if w.kind.steers]
    candidates = [*fixed, *(_slides(robot, w) for w in steered)]
    candidates += [_turns_alike(robot, robot.wheels[i], robot.wheels[k]) for i, k in geared(robot)]
    chosen = _chosen(
        unit_rows(np.vstack(numbers)), len(fixed), [at.robot.wheels[w.index] for w in steered], at
    )
    return tuple(candidates[i] for i in chosen)


def deciding(rows: Sequence[BasisRow]) -> tuple[Wheel, ...]:
    """Return the steered wheels that give a row. Their angles determine the ICR."""
    return tuple({w.index: w for row in rows for w in row.steered}.values())


def _constant(robot: Robot, row: Row, index: int | None) -> BasisRow:
    """Return a constant row: the sliding row of the wheel ``index``, or ``row`` itself if it comes from a coupling."""
    if index is None:
        alone = each(row, partial(led, robot))
        return BasisRow(lambda _: alone)
    w = robot.wheels[index]
    return BasisRow(lambda view: sliding_row(w, view(w)).row)


def _slides(robot: Robot, w: Wheel) -> BasisRow:
    return BasisRow(lambda view: each(sliding_row(w, view(w)).row, partial(led, robot)), (w,))


def _turns_alike(robot: Robot, a: Wheel, b: Wheel) -> BasisRow:
    """Return r_b e_a - r_a e_b, where e are the rolling rows of two wheels with coupled spins.

    r is the distance that a wheel rolls per radian of their common shaft.
    """

    def row(view: View) -> Row:
        p, q = view(a), view(b)
        pairs = zip(rolling_row(a, p).row, rolling_row(b, q).row, strict=True)
        return triple(led(robot, u * robot.per_turn(b, q) - v * robot.per_turn(a, p)) for u, v in pairs)

    return BasisRow(row, tuple(w for w in (a, b) if w.kind.steers))


def led(robot: Robot, p: Poly) -> Poly:
    """Return a polynomial with each coupled steering angle replaced by the angle of its leading wheel."""

    def value(gen: Gen) -> Poly | None:
        if gen.kind not in ("cos", "sin"):
            return None
        w = robot.wheel(gen.name)
        angle = Poly.gen(gen.kind, robot.wheels[robot.steer_group[w.index]].name)
        return angle.scale(Exact(w.steer_sign)) if gen.kind == "sin" else angle

    return p.substitute(value)


class _Choice(NamedTuple):
    """Rows that span C1, and how far the axles of their wheels are from one line."""

    at_zero: float  # smallest singular value at angle zero
    at_quarter: float  # and with every steered wheel turned by 90 degrees
    ahead: int  # number of its wheels that are ahead of P
    picked: list[int]  # indices of the rows


def _chosen(rows: Array, head: int, steered: list[Wheel], at: Configuration) -> list[int]:
    """Return the indices of rows that span C1.

    These are all independent rows among the first ``head``, then rows of steered wheels, and rows of coupled spins only
    if the steered wheels do not suffice. The posture model is singular if the axles of the chosen wheels are on one
    line. Among several choices the function therefore keeps those whose axles differ clearly at angle zero, then at
    90 degrees. Among these it takes the one with most wheels ahead of P, as textbooks do (jpl_osr steers all corners,
    and its back wheels are a little farther from the fixed axle), and of several the one whose axles differ most.
    """
    rank = at.rank.value
    constant = independent(rows[:head], min(rank, head))
    candidates = range(head, head + min(len(steered), MOST_CANDIDATES))
    choices: list[_Choice] = []
    for group in combinations(candidates, rank - len(constant)):
        picked = [*constant, *group]
        if not picked or singular_values(rows[picked])[-1] < INDEPENDENT:
            continue
        wheels = [steered[i - head] for i in group]
        ahead = sum(w.nominal.x.sign > 0 for w in wheels)
        choices.append(
            _Choice(_apart(rows[constant], wheels, 1), _apart(rows[constant], wheels, 1j), ahead, picked)
        )
    if not choices:
        return independent(rows, rank)
    best = max(choices, key=lambda c: (c.at_zero, c.at_quarter))
    clear = [
        c for c in choices if c.at_zero >= _CLEAR * best.at_zero and c.at_quarter >= _CLEAR * best.at_quarter
    ]
    return max(clear, key=lambda c: (c.ahead, c.at_zero, c.at_quarter)).picked  # the first of equal ones


def _apart(constant: Array, wheels: list[Wheel], turned: complex) -> float:
    """Return the smallest singular value of the rows with every steered wheel turned by the angle of ``turned``."""
    axles = []
    for w in wheels:
        own = turned if w.steer_sign > 0 else turned.conjugate()
        axles.append(along(w, 1j * own * w.zero_heading)[None, :])
    return round(singular_values(np.vstack([constant, *axles]))[-1], 6)  # so that rounding decides no choice


def null_columns(rows: Sequence[Row]) -> tuple[Row, ...]:
    """Return a basis, as columns, of the null space of up to three independent rows."""
    if not rows:
        return IDENTITY
    if len(rows) == 1:
        return _axle(rows[0])
    if len(rows) == 2:
        return (_cleared(cross(rows[0], rows[1])),)
    return ()


def scaled(columns: tuple[Row, ...], steered: tuple[Wheel, ...], robot: Robot) -> tuple[Row, ...]:
    """Scale null space columns so that their coordinates eta are speeds.

    eta is a yaw rate [rad/s] if the column has a yaw rate that does not depend on steering. Otherwise it is a speed
    [m/s]. At eta = 1 and steering angles of 0, the pivots of the steered wheels then move at 1 m/s on average. If their
    speed is 0 there, steering angles of 90 degrees are used. If only one angle is steered, its pivot has that speed at
    any angle.

    Args:
        columns: The columns of the null space.
        steered: The steered wheels that determine the ICR.
        robot: The robot.

    Returns:
        The columns, each divided by a polynomial without joint angles.
    """
    return tuple(_per_speed(column, steered, robot) for column in columns)


def _per_speed(column: Row, steered: tuple[Wheel, ...], robot: Robot) -> Row:
    turn, values = column[2], {p.name: p.value for p in robot.parameters}
    if not has_angles([turn]) and abs(float(number(turn, values))) > NEGLIGIBLE:
        return _over(column, turn)
    for cosine, sine in ((1, 0), (0, 1)):
        twist = triple(at_angle(p, Poly.of(cosine), Poly.of(sine)) for p in column)
        speed = _speed(twist, [_rim(w, twist, cosine, sine) for w in steered] if twist[2] else [], values)
        if speed is not None:
            return _over(column, speed)
    return column


def _rim(w: Wheel, twist: Row, cosine: int, sine: int) -> Poly:
    """Return the speed [m/s] of a wheel's pivot along its heading, at the steering angle of this cosine and sine."""
    (x, y, turn), g = twist, w.symbolic
    sine *= w.steer_sign
    c, s = g.ch.scale(cosine) - g.sh.scale(sine), g.sh.scale(cosine) + g.ch.scale(sine)
    return c * (x - turn * g.y) + s * (y + turn * g.x)


def _over(row: Row, divisor: Poly) -> Row:
    """Return row / divisor for a divisor without joint angles, and cancel multiples of it."""
    inverse = divisor.inverse()

    def quotient(p: Poly) -> Poly:
        by_angle: dict[Monomial, dict[Monomial, Exact]] = {}
        for monomial, c in p.terms.items():
            angles = tuple(part for part in monomial if part[0].kind in ("cos", "sin"))
            rest = tuple(part for part in monomial if part not in angles)
            by_angle.setdefault(angles, {})[rest] = c
        return Poly.sum(Poly({angles: ONE}) * share(Poly(terms)) for angles, terms in by_angle.items())

    def share(p: Poly) -> Poly:
        monomial, c = divisor.ordered[0]
        times = p.terms.get(monomial, ZERO) / c
        return Poly.of(times) if p == divisor.scale(times) else p * inverse

    return each(row, quotient)


def _speed(twist: Row, rims: Sequence[Poly], values: Mapping[str, Poly]) -> Poly | None:
    """Return the mean of the speeds ``rims``, or the speed of P if there are none; None if all are 0."""
    speeds = list(rims)
    if not speeds:
        components = [p for p in twist[:2] if p]
        one = len(components) == 1
        speeds = components if one else [sqrt_poly(Poly.sum(p * p for p in components))]
    forward = [p.scale(Exact(1 if number(p, values).sign >= 0 else -1)) for p in speeds]
    if all(abs(float(number(p, values))) < NEGLIGIBLE for p in forward):
        return None
    return mean(forward)


def _axle(row: Row) -> tuple[Row, ...]:
    """Return the null space of one row: motion along the wheel, and rotation about a point of the axle."""
    nx, ny, k = row
    if not nx and not ny:  # the row forbids only rotation
        return IDENTITY[:2]
    size = nx * nx + ny * ny
    forward = primitive((ny, -nx, _ZERO))
    if not k:
        return forward, (_ZERO, _ZERO, _ONE)
    return forward, primitive((-(nx * k), -(ny * k), size))


def _cleared(row: Row) -> Row:
    """Return a null vector without common factors, also without a common polynomial in lengths."""
    first = next((p for p in row if p), _ZERO)
    if first and not has_angles([first]):
        numbers = _over(row, first)
        row = numbers if all(p.constant is not None for p in numbers) else row
    return primitive(row)


def primitive(row: Polys) -> Polys:
    """Return the row without common monomials, and with a leading coefficient of 1."""
    if not any(row):
        return row
    shift, factor = common_powers(row), _leading(row)
    return cast(Polys, tuple(_shifted(p, shift, factor) for p in row))


def _leading(row: tuple[Poly, ...]) -> Exact:
    """Return the first coefficient that is not negligible compared to the largest."""
    ordered = [c for p in row for _, c in p.ordered]
    largest = max(abs(float(c)) for c in ordered)
    return next(c for c in ordered if abs(float(c)) > NEGLIGIBLE * largest)


def _shifted(p: Poly, shift: dict[Gen, int], factor: Exact) -> Poly:
    """Return ``p`` divided by the monomial ``shift`` and by ``factor``."""
    inverse = factor.inverse()
    terms = {}
    for m, c in p.terms.items():
        powers = dict(m)
        for g, e in shift.items():
            powers[g] = powers.get(g, 0) - e
        terms[tuple(sorted((g, e) for g, e in powers.items() if e))] = c * inverse
    return Poly(terms)
