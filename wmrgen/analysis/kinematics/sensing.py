"""Measurements of the twist by joints and gyro, and their least-squares solution in the general case.

A wheel with a sliding row measures it, and a wheel with a sensed spin measures its rolling row. Both together measure
the velocity of the contact point B: v_B = (r spin + o steer_rate) e - d steer_rate n. One row measures one component.
The twist minimises the sum of weight (row . xi - value)**2, whose root is the residual. Weights are relative to the
largest weight of a wheel. A gyro adds the row [0 0 1].

In general the normal matrix N = H^T W H of the rows depends on the steering, and is inverted at run time with one
division. N is symmetric and may be singular. With its invariants c1, c2, det and its adjugate adj, the Moore-Penrose
inverse is

    rank 3   adj / det
    rank 2   (c1 (I - adj / c2) - N) / c2
    rank 1   I / c1                          (if b is in the range of N)

At run time the rank is reduced if an invariant is below EDGE relative to the invariants before it. This corresponds to
a singular value below a thousandth of the largest, far above the rounding of a float. For this decision lengths are
relative to the distance of the contacts, so that it does not depend on the unit. Denominators are limited to a floor
far below any value of a real robot, so that no input causes a division by zero.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from wmrgen.analysis.kinematics.least_squares import Matrix, Measured, named_normal, normal_equations
from wmrgen.analysis.kinematics.ranges import range_of, ranges_of
from wmrgen.analysis.kinematics.records import Locals, joint_port, signal_poly
from wmrgen.analysis.mobility.ranks import generic, independent, nominal_at, numeric_rank
from wmrgen.geometry.constraints import arm, heading, rolling_row, sliding_row, working_view
from wmrgen.geometry.exact.interval import smallest
from wmrgen.geometry.exact.linalg import cofactor, determinant, symmetric
from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.geometry.exact.poly import Poly, Row, dot, has_angles, triple
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import GYRO, Port, Role
from wmrgen.geometry.symbolic import (
    Expr,
    Local,
    add,
    expression,
    maximum,
    number,
    root,
    select,
    square,
    subtract,
    times,
)

FLOOR = Exact(Fraction(1, 10**12))  # least divisor, SI units: far below the invariants of any robot
# Relative invariant at which the rank drops: the square of a singular value of 1/1000.
EDGE = Exact(Fraction(1, 10**6))
JOINT_ROLE = {"spin": Role.COMMAND, "steer": Role.STATE, "steer_rate": Role.COMMAND}
Twist = tuple[Expr, Expr, Expr]


class Contact(NamedTuple):
    """A measured contact velocity: v + omega z x (bx, by) = (wx, wy) in the robot frame."""

    wheel: Wheel
    bx: Poly  # contact point [m]
    by: Poly
    wx: Poly  # velocity [m/s]
    wy: Poly
    weight: Exact  # of both rows

    @property
    def rows(self) -> list[Measured]:
        """One row for each component of the velocity."""
        return contact_rows(self.bx, self.by, self.wx, self.wy, self.weight)


class Component(NamedTuple):
    """A measured component of a velocity: row . xi = value [m/s]."""

    wheel: Wheel
    row: Row
    value: Poly
    weight: Exact

    @property
    def rows(self) -> list[Measured]:
        """The row, in a list."""
        return [(self.row, self.value, self.weight)]


class YawRate(NamedTuple):
    """A measured yaw rate: omega = value."""

    value: Poly  # [rad/s]
    weight: Exact  # [m**2], because rows of wheels are in m/s

    @property
    def rows(self) -> list[Measured]:
        """The row [0 0 1]."""
        return [((Poly({}), Poly({}), Poly.of(1)), self.value, self.weight)]


class Measurements(NamedTuple):
    """All measurements of the twist by the joints and the gyro of a robot."""

    robot: Robot
    contacts: tuple[Contact, ...]
    components: tuple[Component, ...]
    gyro: YawRate | None = None

    @property
    def wheels(self) -> tuple[Wheel, ...]:
        """The wheels that measure something."""
        return tuple(c.wheel for c in self.of_wheels)

    @property
    def of_wheels(self) -> tuple[Contact | Component, ...]:
        """The measurements of wheels: contacts, then components."""
        return (*self.contacts, *self.components)

    @property
    def all(self) -> tuple[Contact | Component | YawRate, ...]:
        """All measurements in the order of the rows: contacts, components, gyro."""
        return (*self.of_wheels, *(() if self.gyro is None else (self.gyro,)))

    @property
    def rigid(self) -> bool:
        """Whether every measurement is the velocity of a contact point."""
        return not self.components and self.gyro is None

    @property
    def rows(self) -> list[Measured]:
        """All measured rows, with their values [m/s] and weights."""
        return [row for c in self.all for row in c.rows]

    @property
    def weighted(self) -> bool:
        """Whether some weights differ from 1."""
        return any(weight != ONE for _, _, weight in self.rows)

    @property
    def constant_normal(self) -> bool:
        """Whether the normal matrix does not depend on joint angles."""
        return not any(has_angles(row) for row, _, _ in self.rows)


def contact_rows(bx: Poly, by: Poly, wx: Poly, wy: Poly, weight: Exact) -> list[Measured]:
    """Return the rows of a measured velocity.

    Args:
        bx: The x coordinate of the point [m].
        by: The y coordinate of the point [m].
        wx: The x component of its velocity [m/s].
        wy: The y component of its velocity [m/s].
        weight: The weight of both rows.

    Returns:
        One row for each component.
    """
    one, zero = Poly.of(1), Poly({})
    return [((one, zero, -by), wx, weight), ((zero, one, bx), wy, weight)]


def sensed_joints(w: Wheel) -> tuple[str, ...]:
    """Return the joints of a wheel that are inputs of ``forward``."""
    joints: list[str] = [j for j in ("spin", "steer") if j in w.sensed]
    if "steer" in joints and (w.kind.swivels or w.nominal.steer_arm):
        joints.append("steer_rate")
    return tuple(joints)


def measurements(robot: Robot, names: Locals | None = None) -> Measurements:
    """Return the measurements of the twist by the sensed joints and the gyro.

    Castors and spheres without sensors measure nothing. With ``names``, the rolling velocities of steered wheels become
    intermediate results. Weights are scaled so that the largest weight of a wheel is 1.
    """
    contacts: list[Contact] = []
    components: list[Component] = []
    for w in robot.wheels:
        g = working_view(w)
        joints = sensed_joints(w)
        if w.turns and "steer" not in joints:
            continue
        rate = signal_poly(f"{w.name}.steer_rate") if "steer_rate" in joints else Poly({})
        spin = signal_poly(f"{w.name}.spin") if "spin" in joints else None
        if spin is not None and w.kind.sliding_row:
            contacts.append(_contact(w, spin, rate, names))
        elif spin is not None:
            speed = g.rolling_radius * spin + g.steer_arm * rate
            components.append(Component(w, rolling_row(w, g).row, speed, w.weight))
        elif w.kind.sliding_row:
            components.append(Component(w, sliding_row(w, g).row, -(g.d * rate), w.weight))
    largest = max((*(c.weight for c in contacts), *(c.weight for c in components)), default=ONE)
    measured = Measurements(
        robot,
        tuple(c._replace(weight=c.weight / largest) for c in contacts),
        tuple(c._replace(weight=c.weight / largest) for c in components),
    )
    return measured._replace(gyro=yaw_rate(robot, measured.wheels))


def yaw_rate(robot: Robot, wheels: Sequence[Wheel]) -> YawRate | None:
    """Return the measurement of the gyro, or None if the robot has no gyro.

    Its weight is multiplied by the mean square distance of the measured ``wheels`` from their centre, so that a gyro of
    weight 1 has the influence of a wheel at that distance.
    """
    if robot.gyro is None:
        return None
    return YawRate(signal_poly(GYRO.name), robot.gyro.weight * _spread(wheels))


def _spread(wheels: Sequence[Wheel]) -> Exact:
    """Return the mean square distance [m**2] of wheels from their centre, offsets included, or 1 if it is 0.

    It does not depend on the position of P, so the fitted motion does not depend on it either.
    """
    shapes = [w.nominal for w in wheels]
    if not shapes:
        return ONE
    x = sum((g.x for g in shapes), Exact(0)) / len(shapes)
    y = sum((g.y for g in shapes), Exact(0)) / len(shapes)
    total = sum(((g.x - x) ** 2 + (g.y - y) ** 2 + g.d * g.d + g.o * g.o for g in shapes), Exact(0))
    return total / len(shapes) if total else ONE


def sensed_ports(robot: Robot) -> tuple[Port, ...]:
    """Return the inputs of `forward` that are measured: joints in the order of the file, then the gyro."""
    joints = (joint_port(w, j, JOINT_ROLE[j]) for w in robot.wheels for j in sensed_joints(w))
    return (*joints, *(() if robot.gyro is None else (GYRO,)))


def _contact(w: Wheel, spin: Poly, rate: Poly, names: Locals | None) -> Contact:
    """Return the velocity of a wheel's contact point from its rolling and its sliding row."""
    g = working_view(w)
    c, s = heading(w, g)
    if names is not None and w.turns and not g.d and not g.steer_arm:
        wx, wy = _rolled(w, names)
        return Contact(w, g.x, g.y, g.r * wx, g.r * wy, w.weight)
    (bx, by), along, across = arm(g, c, s), g.r * spin + g.steer_arm * rate, -(g.d * rate)
    return Contact(w, g.x + bx, g.y + by, along * c - across * s, along * s + across * c, w.weight)


def _rolled(w: Wheel, names: Locals) -> tuple[Poly, Poly]:
    """Return the spin [rad/s] times the rolling direction in the robot frame, with names for the components."""
    g = working_view(w)
    spin, steer = (expression(signal_poly(f"{w.name}.{joint}")) for joint in ("spin", "steer"))
    at_joint = names.vector_at(f"{w.name}_roll", spin, steer)
    u, v = (Poly.gen("local", component.name) for component in at_joint)
    return g.ch * u - g.sh * v, g.sh * u + g.ch * v


def solve_general(measured: Measurements, names: Locals) -> tuple[Twist, Expr]:
    """Return twist and residual norm for any measurements, by cofactors of the 3x3 normal matrix N.

    If the rows do not determine the twist, as for a rear-driven bicycle that is steered by 90 degrees, the result is
    the smallest twist. The generic rank of the rows determines at derivation time which formulas are needed.
    """
    rows = _named_rows(measured, names)
    normal, moment = normal_equations(rows)
    n = named_normal(normal, names.poly)
    b = [names.poly(f"b{i}", p, f"Htz[{i}]") for i, p in enumerate(moment)]
    twist = smallest_twist(n, b, measured, names)
    fitted = [names.poly(k, e) for k, e in zip(("vx_fit", "vy_fit", "omega_fit"), twist, strict=True)]
    errors = [(names.poly(f"error_{i}", z - dot(r, fitted)), weight) for i, (r, z, weight) in enumerate(rows)]
    slip = root(add(*(times(number(weight), square(expression(e))) for e, weight in errors)))
    return triple(map(expression, fitted)), slip


def named_contacts(contacts: Sequence[Contact], names: Locals) -> list[tuple[Poly, Poly, Poly, Poly]]:
    """Return contact points and velocities with names, so that each is computed once."""
    named = []
    for c in contacts:
        wheel = c.wheel.name
        bx = _named(names, f"{wheel}_bx", c.bx, f"B_x of {wheel}")
        by = _named(names, f"{wheel}_by", c.by, f"B_y of {wheel}")
        wx = _named(names, f"{wheel}_wx", c.wx, f"w_x of {wheel}")
        wy = _named(names, f"{wheel}_wy", c.wy, f"w_y of {wheel}")
        named.append((bx, by, wx, wy))
    return named


def _named(names: Locals, name: str, value: Poly, quantity: str) -> Poly:
    return names.poly(name, value, quantity) if value.generators else value


def _named_rows(measured: Measurements, names: Locals) -> list[Measured]:
    """Return the measured rows with names for their entries."""
    rows: list[Measured] = []
    points = named_contacts(measured.contacts, names)
    for (bx, by, wx, wy), contact in zip(points, measured.contacts, strict=True):
        rows += contact_rows(bx, by, wx, wy, contact.weight)
    for c in measured.components:
        wheel, (vx, vy, omega) = c.wheel.name, c.row
        x = _named(names, f"{wheel}_rx", vx, f"vx in H, row of {wheel}")
        y = _named(names, f"{wheel}_ry", vy, f"vy in H, row of {wheel}")
        w = _named(names, f"{wheel}_rw", omega, f"omega in H, row of {wheel}")
        rows.append(((x, y, w), c.value, c.weight))
    return rows if measured.gyro is None else [*rows, *measured.gyro.rows]


def reach_of(wheels: Sequence[Wheel]) -> Exact:
    """Return the mean square distance [m**2] of the measured wheels from P, offsets included; 1 if all are at P."""
    shapes = [w.nominal for w in wheels]
    total = sum((g.x * g.x + g.y * g.y + g.d * g.d + g.o * g.o for g in shapes), Exact(0))
    return total / len(wheels) if total else ONE


def generic_rank(measured: Measurements) -> int:
    """Return the rank of the measured rows at nominal parameters and generic joint angles."""
    robot, angles = measured.robot, generic(measured.robot)
    numbers = [[nominal_at(p, robot, angles) for p in row] for row, _, _ in measured.rows]
    return _rank(numbers, measured.wheels)


def _rank(rows: list[list[float]], wheels: Sequence[Wheel]) -> int:
    """Return the rank of rows with lengths relative to `reach_of`, so that it does not depend on the unit."""
    return numeric_rank(np.array(rows).reshape(-1, 3) / [1.0, 1.0, float(reach_of(wheels)) ** 0.5])[0]


def lower_bound(measured: Measurements) -> float:
    """Return a lower bound of det N from the constant rows; 0 if they do not have rank 3 for all parameters."""
    rows = []
    for row, _, weight in measured.rows:
        constants = [p.constant for p in row]
        values = [v for v in constants if v is not None]
        if len(values) == 3:
            size = math.sqrt(float(weight))
            rows.append([size * float(v) for v in values])
    if _rank(rows, measured.wheels) < 3:
        return _bound_of_three(measured)

    def entry(i: int, j: int) -> float:
        return sum(r[i] * r[j] for r in rows)

    a, b, c = [[entry(i, j) for j in range(3)] for i in range(3)]  # N
    return float(sum(x * y for x, y in zip(a, np.cross(b, c), strict=True)))


def _bound_of_three(measured: Measurements) -> float:
    """Return a lower bound of det(H3)**2 for three constant rows H3 over the ranges of tunable parameters.

    It is also a lower bound of det N, because N is a sum over rows and each row can only increase det N. It is 0 if
    there is no positive bound. The bound is rounded down to a power of two, because the last bits of sines may differ
    between machines.
    """
    constant = [(row, weight) for row, _, weight in measured.rows if not has_angles(row)]
    values = [[nominal_at(p, measured.robot, generic(measured.robot)) for p in row] for row, _ in constant]
    if _rank(values, measured.wheels) < 3:
        return 0.0
    chosen = [constant[i] for i in independent(np.array(values), 3)]
    minor = range_of(determinant([list(row) for row, _ in chosen]), ranges_of(measured.robot))
    least = float(smallest(minor)[0]) ** 2 * math.prod(float(weight) for _, weight in chosen)
    return 2.0 ** math.floor(math.log2(least)) if least else 0.0


def adjugate(n: Matrix, names: Locals) -> tuple[Matrix, Expr]:
    """Return adjugate and determinant of H^T H, with names for their entries."""
    adj = symmetric(lambda i, j: names.poly(f"adj{i}{j}", cofactor(n, i, j), f"adj(HtH)[{i}][{j}]"))
    return adj, names.define("det", dot(n[0], adj[0]), "det(HtH)")


def smallest_twist(n: Matrix, b: list[Poly], measured: Measurements, names: Locals) -> list[Expr]:
    """Return the smallest least-squares twist N^+ b, see the module docstring.

    If det N has a positive lower bound the rank is always 3, and no case distinction is needed.

    Args:
        n: The normal matrix N = H^T W H.
        b: The right side H^T W z.
        measured: The measurements.
        names: Collects intermediate results.

    Returns:
        vx, vy [m/s] and omega [rad/s].
    """
    rank = generic_rank(measured)
    bound = lower_bound(measured) if rank == 3 else 0.0
    if bound > 0:
        adj, det = adjugate(n, names)
        below = maximum(det, number(Exact(Fraction(bound / 2).limit_denominator(10**9)) or FLOOR))
        return [times(p, 1 / below) for p in _projections(adj, b, names)]
    c1 = names.define("c1", n[0][0] + n[1][1] + n[2][2])
    low = [times(expression(v), _over(c1, names, "c1")) for v in b]
    if rank == 1:
        return low
    adj, det = adjugate(n, names)
    projected = _projections(adj, b, names)
    c2 = names.define("c2", adj[0][0] + adj[1][1] + adj[2][2])
    over_c2 = _over(c2, names, "c2")
    middle = []
    for i in range(3):
        seen = expression(Poly.sum(n[i][j] * b[j] for j in range(3)))
        rest = subtract(expression(b[i]), times(projected[i], over_c2))
        middle.append(times(subtract(times(c1, rest), seen), over_c2))
    s = reach_of(measured.wheels)
    size1 = names.define("size1", n[0][0] + n[1][1] + n[2][2].scale(s.inverse()))
    size2 = names.define("size2", (adj[0][0] + adj[1][1]).scale(s.inverse()) + adj[2][2])
    edge2 = names.define("edge2", times(number(EDGE), size1, size1))
    high = middle
    if rank == 3:
        over_det = _over(det, names, "det")
        edge3 = names.define("edge3", times(number(EDGE * s), size1, size2))
        high = [select(edge3, det, times(p, over_det), m) for p, m in zip(projected, middle, strict=True)]
    return [select(edge2, size2, h, v) for h, v in zip(high, low, strict=True)]


def _projections(adj: Matrix, b: list[Poly], names: Locals) -> list[Local]:
    """Return adj(H^T H) H^T z, with names for its entries."""
    projections = []
    for i in range(3):
        entry = Poly.sum(adj[i][j] * b[j] for j in range(3))
        projections.append(names.define(f"p{i}", entry, f"(adj(HtH) Htz)[{i}]"))
    return projections


def _over(value: Expr, names: Locals, name: str) -> Expr:
    """Return 1 / ``value``, with a name, for a value that may be as small as 0."""
    return names.define(f"over_{name}", 1 / maximum(value, number(FLOOR)))
