"""A generic admissible configuration, and the ranks there.

A twist of the admissible set tells every steered wheel where to point: along the velocity (a, b) of its
pivot. Its sliding row, scaled by the pivot's speed, is then [-b, a, x a + y b], which is exact when the
twist is.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from wmrgen.constraints import Constraints
from wmrgen.exact.linalg import null_space
from wmrgen.exact.number import ZERO, Exact
from wmrgen.exact.poly import Gen, Poly, Row
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.admissible import Component, components, quadrics
from wmrgen.mobility.coupled import coupled_steering, geared
from wmrgen.mobility.freedom import closure
from wmrgen.mobility.ranks import decide, independent, null_basis, numeric_rank, to_array, unit_rows
from wmrgen.mobility.records import Admissible, Array, Rank

ExactRow = tuple[Exact, Exact, Exact]
AGAINST = 1e-3  # of a twist: wheels that roll against one another miss by twice their speed
_WEIGHTS = ((7, -5, 3), (-4, 9, 5), (11, 2, -6))


def castor_angles(robot: Robot, seed: int) -> dict[Gen, Poly]:
    """Rational points of the circle for the castors' joint angles; coupled castors share one."""
    values: dict[Gen, Poly] = {}
    for w in robot.wheels:
        if not w.kind.swivels:
            continue
        t = Fraction(2 + 3 * robot.steer_group[w.index] + seed, 7 + 2 * seed)
        c, s = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        values[Gen("cos", w.name)] = Poly.of(c)
        values[Gen("sin", w.name)] = Poly.of(s)
    return values


def fixed_numbers(c: Constraints, rows: list[Row], seed: int = 0) -> list[ExactRow]:
    """Constant rows as numbers, at generic castor angles where those occur."""
    angles = castor_angles(c.robot, seed)
    numbers: list[ExactRow] = []
    for row in rows:
        values = [p.substitute(angles.get).constant for p in row]
        a, b, k = (v if v is not None else Exact(0) for v in values)
        numbers.append((a, b, k))
    return numbers


def admissible(c: Constraints, rows: list[Row], seed: int = 0) -> tuple[Admissible, list[ExactRow]]:
    """The admissible cone of the layout and its constant rows. ``c``, ``rows``: nominal; ``seed``: castors' angles."""
    robot = c.robot
    numbers = fixed_numbers(c, rows, seed)
    array = unit_rows(to_array(numbers))
    value, _ = numeric_rank(array)
    chosen = independent(array, value)
    found = components(null_basis(array[chosen]), quadrics(robot))
    best = _freest(robot, array[chosen], found)
    normal = _normal(best, array[chosen])
    picked = Admissible(
        chosen=tuple(chosen), normal=normal, dimension=best.dimension,
        basis=best.basis, sample=best.sample, linear=best.linear, tangent=best.tangent,
    )  # fmt: skip
    return picked, [numbers[i] for i in chosen]


def _freest(robot: Robot, constant: Array, found: list[Component]) -> Component:
    """The component with most freedom of steering, then of motion; none at all when no twist is admissible.

    The forms know speeds up to their sign: a component is dropped where wheels would roll against one another.
    """
    empty = Component(0, np.zeros((0, 3)), np.zeros(3), True, np.zeros((0, 3)))
    best, score = empty, (-1, 0, 0)
    for component in found:
        rows = unit_rows(rows_at(robot, component.sample, constant))
        if np.abs(rows @ component.sample).max(initial=0.0) > AGAINST * np.linalg.norm(component.sample):
            continue
        mobility = 3 - numeric_rank(rows)[0]
        new = (component.dimension - mobility, mobility, closure(component.basis))
        if new > score:
            best, score = component, new
    return best


def _normal(best: Component, constant: Array) -> Row | None:
    """The extra row that coupled steering imposes: orthogonal to the admissible plane or line."""
    if not best.linear or best.dimension == 0 or len(constant) + best.dimension != 2:
        return None
    n = null_basis(np.vstack([best.basis, constant]))[0]
    n = n / n[np.argmax(np.abs(n))]
    a, b, k = (
        Poly.of(Fraction(float(v)).limit_denominator(10**9)) for v in np.where(np.abs(n) < 1e-12, 0, n)
    )
    return a, b, k


def pivot_velocity(w: Wheel, twist: Array) -> tuple[float, float]:
    """Velocity of the pivot [m/s]."""
    x, y = float(w.nominal.x), float(w.nominal.y)
    return float(twist[0] - y * twist[2]), float(twist[1] + x * twist[2])


def steering_for(w: Wheel, twist: Array) -> tuple[float, float]:
    """(cos, sin) of the heading that lets the wheel roll under ``twist``; its zero heading when it stands still."""
    a, b = pivot_velocity(w, twist)
    size = float(np.hypot(a, b))
    return (a / size, b / size) if size > 1e-12 else (float(w.nominal.ch), float(w.nominal.sh))


def rows_at(robot: Robot, twist: Array, constant: Array) -> Array:
    """All rows on xi at the steering that ``twist`` asks for, couplings eliminated: (N, 3)."""
    rows = [constant]
    headings = steering(robot, twist)
    for i, (c, s) in headings.items():
        x, y = float(robot.wheels[i].nominal.x), float(robot.wheels[i].nominal.y)
        rows.append(np.array([[-s, c, x * c + y * s]]))
    rows += [(_speed(robot, i, headings) - _speed(robot, k, headings))[None, :] for i, k in geared(robot)]
    return np.vstack(rows)


def steering(robot: Robot, twist: Array) -> dict[int, tuple[float, float]]:
    """(cos, sin) of the headings of all steered wheels that let them roll under ``twist``, coupled ones together.

    Wheels that turn alike roll the same way round.
    """
    groups = robot.together("steer", (w for w in robot.wheels if w.kind.steers))
    headings: dict[int, tuple[float, float]] = {}
    for members in groups:
        fastest = max(members, key=lambda w: float(np.hypot(*pivot_velocity(w, twist))))
        joint = complex(*steering_for(fastest, twist)) / _zero(fastest)
        for w in members:
            turned = joint * _zero(w) if w is not fastest else complex(*steering_for(fastest, twist))
            headings[w.index] = (turned.real, turned.imag)
    pairs, lead, settled = geared(robot), robot.steer_group, set[int]()
    while pairs:  # from wheels that do not steer along the chains, so that no set of wheels turns about twice
        i, k = next(
            (p for p in pairs if p[0] not in headings or settled & {lead[p[0]], lead[p[1]]}), pairs[0]
        )
        pairs.remove((i, k))
        if _speed(robot, i, headings) @ twist * (_speed(robot, k, headings) @ twist) < 0:
            turned = lead[i] if lead[k] in settled else lead[k]
            headings |= {j: (-c, -s) for j, (c, s) in headings.items() if lead[j] == turned}
        settled |= {lead[i], lead[k]}
    return dict(sorted(headings.items()))


def _zero(w: Wheel) -> complex:
    """The heading at joint angle zero, as a point of the unit circle."""
    return complex(float(w.nominal.ch), float(w.nominal.sh))


def _speed(robot: Robot, i: int, headings: dict[int, tuple[float, float]]) -> Array:
    """The row that gives the spin [rad/s] of a twist; ``headings``: of steered wheels."""
    g = robot.wheels[i].nominal
    along = (
        complex(*headings[i]) if i in headings else _zero(robot.wheels[i]) * complex(float(g.cg), float(g.sg))
    )
    c, s, x, y = along.real, along.imag, float(g.x), float(g.y)
    return np.array([c, s, x * s - y * c]) / float(g.rolling_radius)


def rank_C1(robot: Robot, numbers: list[ExactRow], picked: Admissible) -> tuple[Rank, Array]:
    """Rank of C1 on the admissible set, with the float rows it was decided on."""
    at = rows_at(robot, picked.sample, to_array(numbers))
    value, singular = numeric_rank(unit_rows(at))
    if not picked.dimension:
        value = 3
    exact = None if coupled_steering(robot) else _exact_rank(robot, numbers)
    return Rank(value, exact, singular), at


def _exact_rank(robot: Robot, numbers: list[ExactRow]) -> int:
    """The exact rank at generic exact twists of null(C0)."""
    basis = null_space(numbers or [(ZERO, ZERO, ZERO)], 3)
    best = 0
    for weights in _WEIGHTS:
        twist = [sum((b[k] * w for b, w in zip(basis, weights, strict=False)), ZERO) for k in range(3)]
        rows: list[ExactRow] = list(numbers)
        for w in robot.wheels:
            if w.kind.steers:
                a = twist[0] - w.nominal.y * twist[2]
                b = twist[1] + w.nominal.x * twist[2]
                rows.append((-b, a, w.nominal.x * a + w.nominal.y * b))
        best = max(best, decide(rows).exact or 0) if rows else 0
    return best
