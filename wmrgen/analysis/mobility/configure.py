"""Find a generic admissible configuration of a robot, and determine the ranks there.

At an admissible twist every steered wheel points along the velocity (a, b) of its pivot. Its sliding row, scaled by the
speed of the pivot, is then [-b, a, x a + y b], which is exact if the twist is exact.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from wmrgen.analysis.mobility.admissible import (
    along,
    components,
    constant_rows,
    coupled_steering,
    geared,
    quadrics,
)
from wmrgen.analysis.mobility.ranks import (
    Unit,
    closure,
    decide,
    independent,
    null_basis,
    numeric_rank,
    to_array,
    unit_of,
    unit_rows,
)
from wmrgen.analysis.mobility.records import CAMPION, Admissible, Array, Rank
from wmrgen.geometry.constraints import constrain, nominal_view
from wmrgen.geometry.exact.evaluate import circle
from wmrgen.geometry.exact.linalg import null_space
from wmrgen.geometry.exact.linalg import rank as exact_rank
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Gen, Poly, Row, triple
from wmrgen.geometry.layout.records import Robot, Wheel

ExactRow = tuple[Exact, Exact, Exact]
Constant = tuple[Row, int | None]  # a row on xi, and the index of the fixed wheel that it comes from
AGAINST = (
    1e-3  # residual relative to the twist; wheels that roll against one another have one of twice their speed
)
_WEIGHTS = ((7, -5, 3), (-4, 9, 5), (11, 2, -6))  # of basis vectors, for three generic twists: any would do


class Configuration(NamedTuple):
    """A generic admissible configuration of a robot, and the ranks there."""

    robot: Robot  # with nominal geometry in `unit`
    unit: Unit
    constant: tuple[Constant, ...]  # independent rows that do not depend on a steered wheel
    admissible: Admissible  # in `unit`
    rank_fixed: Rank  # of C1f
    rank: Rank  # of C1
    C1: Array  # rows of C1, the constant ones first

    @property
    def mobility(self) -> int:
        """The degree of mobility, Siegwart (3.40)."""
        return 3 - self.rank.value

    @property
    def steerability(self) -> int:
        """The degree of steerability, Siegwart (3.41)."""
        return max(self.admissible.dimension - self.mobility, 0) if self.mobility else 0

    @property
    def degenerate(self) -> bool:
        """Whether the type is none of Campion's five."""
        return (self.mobility, self.steerability) not in CAMPION


def configuration(robot: Robot) -> Configuration:
    """Return the admissible twists of a robot, and the ranks at a generic one."""
    unit = unit_of(robot)
    own = unit.robot(robot)
    c = constrain(own, nominal_view)
    constant = constant_rows(c)
    rows = [row for row, _ in constant]
    picked, numbers = _admissible(own, rows)
    rank, at = _rank_C1(own, numbers, _numbers(own, rows), picked)
    return Configuration(
        own, unit, tuple(constant[i] for i in picked.chosen), picked,
        decide(_numbers(own, [r.row for r in c.sliding_fixed])), rank, at,
    )  # fmt: skip


def in_metres(picked: Admissible, unit: Unit) -> Admissible:
    """Return the admissible twists as twists of P in SI units."""
    normal = None if picked.normal is None else unit.row(picked.normal)
    basis, sample, tangent = (unit.twists(rows) for rows in (picked.basis, picked.sample, picked.tangent))
    return picked._replace(normal=normal, basis=basis, sample=sample, tangent=tangent)


def _numbers(robot: Robot, rows: Sequence[Row]) -> list[ExactRow]:
    """Return constant rows as numbers, at generic castor angles, which are rational points of the unit circle."""
    angles: dict[Gen, Poly] = {}
    for w in (w for w in robot.wheels if w.kind.swivels):
        t = Fraction(2 + 3 * robot.steer_group[w.index], 7)  # coupled castors have one angle
        for function, value in zip(("cos", "sin"), circle(t), strict=True):
            angles[Gen(function, w.name)] = Poly.of(value)
    numbers: list[ExactRow] = []
    for row in rows:
        a, b, k = (p.substitute(angles.get).constant or ZERO for p in row)
        numbers.append((a, b, k))
    return numbers


def _admissible(robot: Robot, rows: Sequence[Row]) -> tuple[Admissible, list[ExactRow]]:
    """Return the admissible twists and the independent rows among ``rows``, as numbers."""
    numbers = _numbers(robot, rows)
    array = unit_rows(to_array(numbers))
    chosen = independent(array, numeric_rank(array)[0])
    best = _most_mobile(robot, array[chosen], components(array[chosen], quadrics(robot)))
    picked = best._replace(chosen=tuple(chosen), normal=_normal(best, array[chosen]))
    return picked, [numbers[i] for i in chosen]


def _most_mobile(robot: Robot, constant: Array, candidates: list[Admissible]) -> Admissible:
    """Return the component with the largest steerability, then mobility, then the least rotation.

    It is empty if the robot cannot move. The quadratic forms determine speeds only up to their sign, so components are
    skipped in which coupled wheels would roll in opposite directions.
    """
    empty = Admissible(np.zeros((0, 3)), np.zeros(3), True, np.zeros((0, 3)))
    best, score = empty, (-1, 0, 0, 0.0)
    for component in candidates:
        rows = unit_rows(_rows_at(robot, component.sample, constant))
        if np.abs(rows @ component.sample).max(initial=0.0) > AGAINST * np.linalg.norm(component.sample):
            continue
        mobility = 3 - numeric_rank(rows)[0]
        turning = round(abs(float(component.sample[2])) / float(np.linalg.norm(component.sample)), 9)
        new = (component.dimension - mobility, mobility, closure(component.basis), -turning)
        if new > score:
            best, score = component, new
    return best


def _normal(best: Admissible, constant: Array) -> Row | None:
    """Return the row of the constraint that coupled steering adds, orthogonal to the admissible twists, or None."""
    if not best.linear or best.dimension == 0 or len(constant) + best.dimension != 2:
        return None
    n = null_basis(np.vstack([best.basis, constant]))[0]
    n = n / n[np.argmax(np.abs(n))]
    n = np.where(np.abs(n) < 1e-12, 0, n)  # rounding errors of entries that are 0
    return triple(Poly.of(Fraction(float(v)).limit_denominator(10**9)) for v in n)


def pivot_velocity(w: Wheel, twist: Array | tuple[float, float, float]) -> complex:
    """Return the velocity of the pivot [m/s], x + iy."""
    x, y = float(w.nominal.x), float(w.nominal.y)
    return complex(twist[0] - y * twist[2], twist[1] + x * twist[2])


def steering_for(w: Wheel, twist: Array) -> complex:
    """Return the heading at which the wheel rolls under ``twist``, or its zero heading if its pivot does not move."""
    v = pivot_velocity(w, twist)
    return v / abs(v) if abs(v) > 1e-12 else w.zero_heading


def _rows_at(robot: Robot, twist: Array, constant: Array) -> Array:
    """Return all rows on xi at the steering for ``twist``, with couplings eliminated, shape (N, 3)."""
    headings = _steering(robot, twist)
    rows = [along(robot.wheels[i], 1j * e)[None, :] for i, e in headings.items()]
    for i, k in geared(robot):
        rows.append((spin_row(robot, i, headings) - spin_row(robot, k, headings))[None, :])
    return np.vstack([constant, *rows])


def _steering(robot: Robot, twist: Array) -> dict[int, complex]:
    """Return the headings at which all steered wheels roll under ``twist``, by wheel index.

    Wheels with coupled steering have one angle, and wheels with coupled spins roll in the same direction.
    """
    headings: dict[int, complex] = {}
    for members in robot.together("steer", (w for w in robot.wheels if w.kind.steers)):
        fastest = max(members, key=lambda w: abs(pivot_velocity(w, twist)))
        joint = steering_for(fastest, twist) / fastest.zero_heading
        for w in members:
            own = joint if w.steer_sign == fastest.steer_sign else joint.conjugate()
            headings[w.index] = steering_for(w, twist) if w is fastest else own * w.zero_heading
    # Decide forwards or backwards along the chains of coupled spins, starting at wheels that do not steer, so that no
    # set of wheels is reversed twice.
    pairs, lead, decided = geared(robot), robot.steer_group, set[int]()
    while pairs:
        i, k = next(
            (p for p in pairs if p[0] not in headings or decided & {lead[p[0]], lead[p[1]]}), pairs[0]
        )
        pairs.remove((i, k))
        if spin_row(robot, i, headings) @ twist * (spin_row(robot, k, headings) @ twist) < 0:
            reversed_set = lead[i] if lead[k] in decided else lead[k]
            headings |= {j: -e for j, e in headings.items() if lead[j] == reversed_set}
        decided |= {lead[i], lead[k]}
    return dict(sorted(headings.items()))


def spin_row(robot: Robot, i: int, headings: dict[int, complex]) -> Array:
    """Return the row of a wheel's spin on the twist, as the spin of the first wheel that it is coupled to.

    Args:
        robot: The robot.
        i: The index of the wheel.
        headings: The headings of steered wheels by index, points of the unit circle.

    Returns:
        The row, shape (3,): its product with the twist is a spin [rad/s].
    """
    w = robot.wheels[i]
    g = w.nominal
    direction = headings[i] if i in headings else w.zero_heading * complex(float(g.cg), float(g.sg))
    return along(w, direction) / float(robot.per_turn(w, g))


def _rank_C1(
    robot: Robot, numbers: list[ExactRow], every: list[ExactRow], picked: Admissible
) -> tuple[Rank, Array]:
    """Return the rank of C1 at the sample of the admissible twists, and its rows.

    The rank is determined with ``numbers``, the independent constant rows. The reported singular values are those of
    all rows, with ``every`` constant row.
    """
    at = _rows_at(robot, picked.sample, to_array(numbers))
    value, _ = numeric_rank(unit_rows(at))
    _, singular = numeric_rank(unit_rows(_rows_at(robot, picked.sample, to_array(every))))
    exact = None if coupled_steering(robot) else _exact_rank(robot, numbers)
    return Rank(value if picked.dimension else 3, exact, singular), at


def _exact_rank(robot: Robot, numbers: list[ExactRow]) -> int:
    """Return the largest exact rank of C1 at generic exact twists in the null space of the constant rows."""
    basis = null_space(numbers or [(ZERO, ZERO, ZERO)], 3)
    best = 0
    for weights in _WEIGHTS:
        twist = [ZERO, ZERO, ZERO]
        for weight, vector in zip(weights[: len(basis)], basis, strict=True):
            twist = [t + v * weight for t, v in zip(twist, vector, strict=True)]
        rows: list[ExactRow] = list(numbers)
        for w in robot.wheels:
            if w.kind.steers:
                a = twist[0] - w.nominal.y * twist[2]
                b = twist[1] + w.nominal.x * twist[2]
                rows.append((-b, a, w.nominal.x * a + w.nominal.y * b))
        best = max(best, exact_rank(rows))
    return best
