"""Ranks, null spaces and the Lie algebra of twists, in a frame and a unit of length that fit the robot.

The degrees of a robot must not depend on the unit of length in the file or on the position of P. Ranks are therefore
determined in a frame whose origin is near the centre of the wheels, and in a unit that is about as large as the robot.
With the centre c and the unit L, the twist (v, omega) of P becomes (v + omega z x c, L omega), all in m/s.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from math import copysign, hypot, log, sqrt
from operator import mul
from typing import NamedTuple, TypeVar

import numpy as np

from wmrgen.analysis.mobility.records import TOLERANCE, Array, Rank
from wmrgen.geometry.constraints import View
from wmrgen.geometry.exact.evaluate import circle, number
from wmrgen.geometry.exact.linalg import rank as exact_rank
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Gen, Poly, Row
from wmrgen.geometry.layout.records import Robot

T = TypeVar("T", Poly, Exact)
Angles = Callable[[str], tuple[Exact, Exact]]  # wheel -> cosine and sine of its steering angle
NEAR = 32  # units: spacing of a grid for the centre, so that the centre is P unless P is far from the wheels
GRID = (
    1e12  # singular values are rounded to the largest one divided by this, so that the last bits do not show
)
_SPAN_TOLERANCE = 1e-8  # relative to the largest singular value: above the rounding of repeated brackets
# Generic angles have tan(angle/2) = k/1009, which no lengths that people write give by chance.
_PRIME = 1009


class Unit(NamedTuple):
    """A frame and a unit of length."""

    centre: tuple[Fraction, Fraction]  # origin of the frame [m]
    length: Fraction  # unit of length [m]

    def robot(self, robot: Robot) -> Robot:
        """Return the robot with its nominal geometry in this unit."""
        wheels = []
        for w in robot.wheels:
            wheels.append(replace(w, nominal=w.nominal.seen_from(*self.centre, self.length)))
        return replace(robot, wheels=tuple(wheels))

    def view(self, view: View) -> View:
        """Return a view of a robot in metres as a view in this unit."""
        return lambda wheel: view(wheel).seen_from(*self.centre, self.length)

    def twists(self, rows: Array) -> Array:
        """Convert twists in this unit to twists of P in SI units; the last axis has the three components."""
        omega = rows[..., 2] / float(self.length)
        x, y = (float(v) for v in self.centre)
        return np.stack([rows[..., 0] + y * omega, rows[..., 1] - x * omega, omega], axis=-1)

    def own_row(self, row: Row) -> Row:
        """Convert a row on twists of P in SI units to a row on twists in this unit."""
        a, b, k = row
        x, y = self.centre
        return a, b, (k - b.scale(x) + a.scale(y)).scale(1 / self.length)

    def row(self, row: Row) -> Row:
        """Convert a row on twists in this unit to a row on twists of P in SI units."""
        a, b, k = row
        x, y = self.centre
        return a, b, k.scale(self.length) + b.scale(x) - a.scale(y)


def unit_of(robot: Robot) -> Unit:
    """Return the unit of a robot: millimetre, metre or kilometre, whichever is closest to its size."""
    places = np.array([(float(w.nominal.x), float(w.nominal.y)) for w in robot.wheels])
    middle = places.mean(axis=0)
    reach = max(hypot(float(x), float(y)) for x, y in places - middle)
    length = Fraction(1000) ** round(log(reach, 1000)) if reach else Fraction(1)
    grid = NEAR * length
    x, y = (grid * round(Fraction(float(v)) / grid) for v in middle)
    return Unit((x, y), length)


def straight(_: str) -> tuple[Exact, Exact]:
    """Return (cos, sin) of a steering angle of zero, for any wheel."""
    return Exact(1), Exact(0)


def generic(robot: Robot) -> Angles:
    """Return generic steering angles, different for each wheel."""
    names = [w.name for w in robot.wheels] + [v.name for v in robot.virtual]
    place = {name: k for k, name in enumerate(names, 1)}

    def angle(name: str) -> tuple[Exact, Exact]:
        return circle(Fraction(618 * place[name] % _PRIME, _PRIME))

    return angle


def nominal_at(poly: Poly, robot: Robot, angles: Angles) -> float:
    """Return the value of a polynomial at nominal parameters and given steering angles.

    Args:
        poly: A polynomial in parameters and in cosines and sines of steering angles.
        robot: The robot, for the nominal parameters.
        angles: Returns cosine and sine of the steering angle of a wheel.

    Returns:
        The value.
    """

    def value(gen: Gen) -> Poly | None:
        if gen.kind in ("cos", "sin"):
            return Poly.of(angles(gen.name)[gen.kind == "sin"])
        if gen.args:
            return Poly.gen(gen.kind, gen.name, *(a.substitute(value) for a in gen.args))
        return None

    return float(number(poly.substitute(value), {p.name: p.value for p in robot.parameters}))


def to_array(rows: Sequence[Sequence[Exact]]) -> Array:
    """Return rows of exact numbers as an (N, 3) array; N may be 0."""
    return np.array([[float(v) for v in row] for row in rows], dtype=np.float64).reshape(-1, 3)


def unit_rows(rows: Array) -> Array:
    """Scale each row to a direction of unit length, so that every row is a speed; rows of pure rotation to 1."""
    size = np.hypot(rows[:, 0], rows[:, 1])
    size = np.where(size > TOLERANCE * np.abs(rows[:, 2]), size, np.abs(rows[:, 2]))
    return np.asarray(rows / np.where(size > 0, size, 1.0)[:, None])


def numeric_rank(rows: Array) -> tuple[int, tuple[float, ...]]:
    """Return the rank at TOLERANCE, and the singular values rounded for printing."""
    singular = singular_values(rows)
    top = singular[0] if singular else 0.0
    rank = sum(s > TOLERANCE * top for s in singular)
    return rank, tuple(round(s / top * GRID) / GRID * top if top else 0.0 for s in singular)


def singular_values(rows: Array) -> list[float]:
    """Return the singular values of an (N, 3) array, largest first, by one-sided Jacobi rotations.

    This is plain arithmetic, so it gives the same bits on every machine. It is accurate for small values too.
    """
    columns = [[float(v) for v in column] for column in rows.T]
    for _ in range(12):
        rotated = False
        for i, j in ((0, 1), (0, 2), (1, 2)):
            a, b = columns[i], columns[j]
            p, q, r = _product(a, a), _product(b, b), _product(a, b)
            if abs(r) <= 1e-16 * sqrt(p * q):
                continue
            rotated = True
            zeta = (q - p) / (2 * r)
            t = copysign(1.0, zeta) / (abs(zeta) + hypot(1.0, zeta))
            c = 1 / hypot(1.0, t)
            columns[i] = [c * (x - t * y) for x, y in zip(a, b, strict=True)]
            columns[j] = [c * (t * x + y) for x, y in zip(a, b, strict=True)]
        if not rotated:
            break
    sizes = sorted((sqrt(_product(column, column)) for column in columns), reverse=True)
    return sizes[: min(len(rows), 3)]


def _product(a: Sequence[float], b: Sequence[float]) -> float:
    return float(sum(map(mul, a, b)))


def decide(rows: Sequence[Sequence[Exact]]) -> Rank:
    """Return the numerical and the exact rank of rows of exact numbers."""
    value, singular = numeric_rank(unit_rows(to_array(rows)))
    return Rank(value, exact_rank(rows) if rows else 0, singular)


def independent(rows: Array, wanted: int) -> list[int]:
    """Return the indices of ``wanted`` independent rows, preferring early rows that are clearly independent."""
    chosen: list[int] = []
    for threshold in (1e-3, 1e-6, TOLERANCE):
        for i in range(len(rows)):
            if len(chosen) == wanted:
                return sorted(chosen)
            if i in chosen:
                continue
            singular = singular_values(rows[[*chosen, i]])
            if singular[-1] > threshold * singular[0] > 0:
                chosen.append(i)
    return sorted(chosen)


def null_basis(rows: Array) -> Array:
    """Return orthonormal rows that span {xi: rows xi = 0} at TOLERANCE, with the same bits on every machine."""
    rank, _ = numeric_rank(rows)
    picked = rows[independent(rows, rank)]
    if rank == 0:
        return np.eye(3)
    if rank == 3:
        return np.zeros((0, 3))
    if rank == 2:
        return _unit(np.cross(picked[0], picked[1]))[None, :]
    first = _unit(picked[0])
    rotation_only = abs(first[2]) >= 1 - TOLERANCE
    along = _unit(np.array([1.0, 0.0, 0.0] if rotation_only else [first[1], -first[0], 0.0]))
    return np.array([along, np.cross(first, along)])


def _unit(v: Array) -> Array:
    return np.asarray(v / hypot(*(float(c) for c in v)))


def bracket(a: Array, b: Array) -> Array:
    """Return the Lie bracket of two twists in se(2)."""
    return np.array([-a[2] * b[1] + b[2] * a[1], a[2] * b[0] - b[2] * a[0], 0.0])


def span(rows: Array) -> Array:
    """Return orthonormal rows with the same span."""
    if not rows.size:
        return np.zeros((0, 3))
    _, singular, vt = np.linalg.svd(rows, full_matrices=False)
    return np.asarray(vt[singular > _SPAN_TOLERANCE * max(singular[0], 1e-300)])


def grown(inputs: Array, reached: Array) -> Array:
    """Return the span of ``reached`` and of its brackets with ``inputs``."""
    brackets = [bracket(a, b) for a in inputs for b in reached]
    return span(np.vstack([reached, *brackets])) if brackets else reached


def closure(twists: Array) -> int:
    """Return the dimension of the Lie algebra that the rows of ``twists`` generate."""
    reached = span(twists)
    larger = grown(reached, reached)
    while len(larger) > len(reached):
        reached, larger = larger, grown(larger, larger)
    return len(reached)
