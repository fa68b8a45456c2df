"""Independent rows of C1, and their null space with readable entries: polynomials, cleared of common factors.

A rank-1 matrix is an axle: its null space is motion along the wheel and rotation about the axle.
The null space of a rank-2 matrix is one cross product.
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

INDEPENDENT = 1e-3  # smallest singular value of rows taken for clearly independent
MOST_CANDIDATES = 16  # steered wheels among which the independent ones are sought
NEGLIGIBLE = 1e-9
_ZERO, _ONE = Poly({}), Poly.of(1)
IDENTITY: tuple[Row, ...] = ((_ONE, _ZERO, _ZERO), (_ZERO, _ONE, _ZERO), (_ZERO, _ZERO, _ONE))

Polys = TypeVar("Polys", bound=tuple[Poly, ...])


class BasisRow(NamedTuple):
    """A row of C1 in any view of the geometry, twists in SI units; ``steered``: the wheels that it stands for."""

    row: Callable[[View], Row]
    steered: tuple[Wheel, ...] = ()


def basis(robot: Robot, at: Configuration) -> tuple[BasisRow, ...]:
    """Constant rows first, then the coupling's own row, then as many steered wheels as the rank needs.

    A coupling's ban on turning is a constant. The row of any other plane that it leaves has lengths in it, as numbers:
    rows of steered wheels, which have them as symbols, replace it if their angles are free.
    """
    normal = at.admissible.normal
    if normal is not None and (normal[0] or normal[1]):
        rows = _spanning(robot, at, None)
        angles = {robot.steer_group[w.index] for w in deciding(rows)}
        if len(angles) <= at.steerability:
            return rows
    return _spanning(robot, at, normal)


def _spanning(robot: Robot, at: Configuration, normal: Row | None) -> tuple[BasisRow, ...]:
    """Rows that span C1, ``normal`` among them where it is given."""
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
    """The steered wheels that give a row: they decide where the ICR lies."""
    return tuple({w.index: w for row in rows for w in row.steered}.values())


def _constant(robot: Robot, row: Row, index: int | None) -> BasisRow:
    """A constant row: of the wheel ``index``, or of a coupling."""
    if index is None:
        alone = each(row, partial(led, robot))
        return BasisRow(lambda _: alone)
    w = robot.wheels[index]
    return BasisRow(lambda view: sliding_row(w, view(w)).row)


def _slides(robot: Robot, w: Wheel) -> BasisRow:
    return BasisRow(lambda view: each(sliding_row(w, view(w)).row, partial(led, robot)), (w,))


def _turns_alike(robot: Robot, a: Wheel, b: Wheel) -> BasisRow:
    """r_b e_a - r_a e_b: the rolling rows of two wheels that turn alike, r per turn of what turns both."""

    def row(view: View) -> Row:
        p, q = view(a), view(b)
        pairs = zip(rolling_row(a, p).row, rolling_row(b, q).row, strict=True)
        return triple(led(robot, u * robot.per_turn(b, q) - v * robot.per_turn(a, p)) for u, v in pairs)

    return BasisRow(row, tuple(w for w in (a, b) if w.kind.steers))


def led(robot: Robot, p: Poly) -> Poly:
    """A polynomial in the joint angles of the wheels that couplings follow."""

    def value(gen: Gen) -> Poly | None:
        if gen.kind not in ("cos", "sin"):
            return None
        w = robot.wheel(gen.name)
        angle = Poly.gen(gen.kind, robot.wheels[robot.steer_group[w.index]].name)
        return angle.scale(Exact(w.steer_sign)) if gen.kind == "sin" else angle

    return p.substitute(value)


def _chosen(rows: Array, head: int, steered: list[Wheel], at: Configuration) -> list[int]:
    """Rows that span: all independent ones of the first ``head``, and the steered wheels that stay independent longest.

    Rows of equal spins (those after the steered wheels) come where the steered wheels do not suffice.
    Of several choices the one is taken whose axles differ most with every wheel at its zero angle, then with
    every wheel turned by 90 degrees: the posture model is singular where they fall into one line.
    """
    rank = at.rank.value
    constant = independent(rows[:head], min(rank, head))
    candidates = range(head, head + min(len(steered), MOST_CANDIDATES))
    best: tuple[tuple[float, float], list[int]] | None = None
    for group in combinations(candidates, rank - len(constant)):
        picked = [*constant, *group]
        if not picked or singular_values(rows[picked])[-1] < INDEPENDENT:
            continue
        wheels = [steered[i - head] for i in group]
        score = _apart(rows[constant], wheels, 1), _apart(rows[constant], wheels, 1j)
        if best is None or score > best[0]:
            best = (score, picked)
    return best[1] if best is not None else independent(rows, rank)


def _apart(constant: Array, wheels: list[Wheel], turned: complex) -> float:
    """The smallest singular value of the rows with every steered wheel at its zero angle, or ``turned`` from it."""
    angles = [turned if w.steer_sign > 0 else turned.conjugate() for w in wheels]
    axles = [along(w, 1j * t * w.zero_heading)[None, :] for w, t in zip(wheels, angles, strict=True)]
    return round(singular_values(np.vstack([constant, *axles]))[-1], 6)


def null_columns(rows: Sequence[Row]) -> tuple[Row, ...]:
    """A basis (as columns) of the null space of up to three independent rows."""
    if not rows:
        return IDENTITY
    if len(rows) == 1:
        return _axle(rows[0])
    if len(rows) == 2:
        return (_cleared(cross(rows[0], rows[1])),)
    return ()


def scaled(columns: tuple[Row, ...], steered: tuple[Wheel, ...], robot: Robot) -> tuple[Row, ...]:
    """The columns so that their coordinates eta are speeds: [rad/s] where a column turns the robot at a rate that no
    angle changes, else [m/s]. ``steered``: the wheels that decide where the ICR lies.

    A column that steering changes moves their pivots at 1 m/s, on average, where they all stand straight; or at a right
    angle to that, where their axles are one line. A robot that steers one angle moves that pivot so at any.
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
    """Speed of the pivot of a wheel that rolls, along its heading."""
    (x, y, turn), g = twist, w.symbolic
    sine *= w.steer_sign
    c, s = g.ch.scale(cosine) - g.sh.scale(sine), g.sh.scale(cosine) + g.ch.scale(sine)
    return c * (x - turn * g.y) + s * (y + turn * g.x)


def _over(row: Row, divisor: Poly) -> Row:
    """row / divisor, which no angle changes; what is a multiple of it cancels."""
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
    """The mean of the speeds ``rims``, of P where there are none; None of a standstill."""
    size = [p * p for p in twist[:2] if p]
    speeds = rims or ([p for p in twist[:2] if p] if len(size) == 1 else [sqrt_poly(Poly.sum(size))])
    forward = [p.scale(Exact(1 if number(p, values).sign >= 0 else -1)) for p in speeds]
    if all(abs(float(number(p, values))) < NEGLIGIBLE for p in forward):
        return None
    return mean(forward)


def _axle(row: Row) -> tuple[Row, ...]:
    nx, ny, k = row
    if not nx and not ny:  # a pure ban on rotation
        return IDENTITY[:2]
    size = nx * nx + ny * ny
    forward = primitive((ny, -nx, _ZERO))
    if not k:
        return forward, (_ZERO, _ZERO, _ONE)
    return forward, primitive((-(nx * k), -(ny * k), size))


def _cleared(row: Row) -> Row:
    """A null vector without common factors, also without a polynomial that no angle changes."""
    first = next((p for p in row if p), _ZERO)
    if first and not has_angles([first]):
        numbers = _over(row, first)
        row = numbers if all(p.constant is not None for p in numbers) else row
    return primitive(row)


def primitive(row: Polys) -> Polys:
    """The row without common factors: no common monomial, leading coefficient 1."""
    if not any(row):
        return row
    shift, factor = common_powers(row), _leading(row)
    return cast(Polys, tuple(_shifted(p, shift, factor) for p in row))


def _leading(row: tuple[Poly, ...]) -> Exact:
    """The first coefficient of the first entry that is not negligible beside the largest."""
    ordered = [c for p in row for _, c in p.ordered]
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
