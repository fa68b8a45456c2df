"""What the sensed joint rates say about the twist, and the twist that explains them best.

A wheel with a sliding row measures it, and a wheel whose spin is sensed its rolling row. Both together measure the
velocity of the contact point B: v_B = (r spin + o steer_rate) e - d steer_rate n. One row measures one component.
Rows count as their wheel's ``weight`` says, the largest taken for 1: the twist has the least sum of weight
(row . xi - value)**2, whose root is the residual. A gyro is one more row, see `kinematics.gyro`.

In general the normal matrix N = H^T W H of the rows moves with the steering, and one division at run time solves it. N
is symmetric and perhaps singular. With c1, c2, det its invariants and adj its adjugate, the Moore-Penrose inverse is

    rank 3   adj / det
    rank 2   (c1 (I - adj / c2) - N) / c2
    rank 1   I / c1                          (b lies in the range of N)

A rank is lost at run time where an invariant falls under EDGE of what the ones before it allow: a singular value
under a thousandth of the largest, far above the rounding of a float. Lengths are measured in the reach of the
contacts for that decision, so that it does not depend on the unit. Denominators are kept above a floor far below any
value that a real robot takes, so that no input divides by zero.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from wmrgen.analysis.kinematics.gyro import YawRate, yaw_rate
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

FLOOR = Exact(Fraction(1, 10**12))
EDGE = Exact(Fraction(1, 10**6))
JOINT_ROLE = {"spin": Role.COMMAND, "steer": Role.STATE, "steer_rate": Role.COMMAND}
Twist = tuple[Expr, Expr, Expr]


class Contact(NamedTuple):
    """A measured contact velocity: v + omega z x (bx, by) = (wx, wy), robot frame; ``weight``: of both rows."""

    wheel: Wheel
    bx: Poly
    by: Poly
    wx: Poly
    wy: Poly
    weight: Exact

    @property
    def rows(self) -> list[Measured]:
        """A row for each component of the velocity."""
        return contact_rows(self.bx, self.by, self.wx, self.wy, self.weight)


class Component(NamedTuple):
    """A measured component: row . xi = value [m/s], which counts ``weight``."""

    wheel: Wheel
    row: Row
    value: Poly
    weight: Exact

    @property
    def rows(self) -> list[Measured]:
        """The one row."""
        return [(self.row, self.value, self.weight)]


class Measurements(NamedTuple):
    """All that the sensed joints of ``robot`` measure, and its gyro."""

    robot: Robot
    contacts: tuple[Contact, ...]
    components: tuple[Component, ...]
    gyro: YawRate | None = None

    @property
    def wheels(self) -> tuple[Wheel, ...]:
        """Those that measure something."""
        return tuple(c.wheel for c in self.of_wheels)

    @property
    def of_wheels(self) -> tuple[Contact | Component, ...]:
        """Contacts, then components."""
        return (*self.contacts, *self.components)

    @property
    def all(self) -> tuple[Contact | Component | YawRate, ...]:
        """Contacts, components, the gyro: the order of the rows."""
        return (*self.of_wheels, *(() if self.gyro is None else (self.gyro,)))

    @property
    def rigid(self) -> bool:
        """Whether every measurement is the velocity of a contact point."""
        return not self.components and self.gyro is None

    @property
    def rows(self) -> list[Measured]:
        """Every measured row over the twist, with its value [m/s] and its weight."""
        return [row for c in self.all for row in c.rows]

    @property
    def weighted(self) -> bool:
        """Whether some rows count more than others."""
        return any(weight != ONE for _, _, weight in self.rows)

    @property
    def constant_normal(self) -> bool:
        """Whether the normal matrix depends on no joint angle."""
        return not any(has_angles(row) for row, _, _ in self.rows)


def contact_rows(bx: Poly, by: Poly, wx: Poly, wy: Poly, weight: Exact) -> list[Measured]:
    """The velocity (wx, wy) of a point B, a row for each component."""
    one, zero = Poly.of(1), Poly({})
    return [((one, zero, -by), wx, weight), ((zero, one, bx), wy, weight)]


def sensed_joints(w: Wheel) -> tuple[str, ...]:
    """The joints of a wheel that are inputs of ``forward``."""
    joints: list[str] = [j for j in ("spin", "steer") if j in w.sensed]
    if "steer" in joints and (w.kind.swivels or w.nominal.steer_arm):
        joints.append("steer_rate")
    return tuple(joints)


def measurements(robot: Robot, names: Locals | None = None) -> Measurements:
    """What the sensed joints and the gyro measure of the twist. Passive castors and spheres measure nothing.

    With ``names`` the velocities that wheels roll at their angles are intermediate results. The largest weight is 1.
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


def sensed_ports(robot: Robot) -> tuple[Port, ...]:
    """The inputs of `forward` that sensors show: joints in the order of the file, then the gyro."""
    joints = (joint_port(w, j, JOINT_ROLE[j]) for w in robot.wheels for j in sensed_joints(w))
    return (*joints, *(() if robot.gyro is None else (GYRO,)))


def _contact(w: Wheel, spin: Poly, rate: Poly, names: Locals | None) -> Contact:
    """Both rows of a wheel, solved for the velocity of its contact point."""
    g = working_view(w)
    c, s = heading(w, g)
    if names is not None and w.turns and not g.d and not g.steer_arm:
        wx, wy = _rolled(w, names)
        return Contact(w, g.x, g.y, g.r * wx, g.r * wy, w.weight)
    (bx, by), along, across = arm(g, c, s), g.r * spin + g.steer_arm * rate, -(g.d * rate)
    return Contact(w, g.x + bx, g.y + by, along * c - across * s, along * s + across * c, w.weight)


def _rolled(w: Wheel, names: Locals) -> tuple[Poly, Poly]:
    """The spin of a wheel along its rolling direction [rad/s], robot frame; its components at the joint have names."""
    g = working_view(w)
    spin, steer = (expression(signal_poly(f"{w.name}.{joint}")) for joint in ("spin", "steer"))
    at_joint = names.vector_at(f"{w.name}_roll", spin, steer)
    u, v = (Poly.gen("local", component.name) for component in at_joint)
    return g.ch * u - g.sh * v, g.sh * u + g.ch * v


def solve_general(measured: Measurements, names: Locals) -> tuple[Twist, Expr]:
    """Any mix of contact velocities and single rows, by cofactors of the 3x3 normal matrix N.

    Where the rows leave a direction unseen (a rear-driven bicycle steered by 90 degrees) the smallest twist
    is taken. The rank that the rows have in general decides at derivation time which formulas are needed.
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
    """Contact points and velocities with names, so that each is computed once."""
    named = []
    for c in contacts:
        parts = (("B_x", c.bx), ("B_y", c.by), ("w_x", c.wx), ("w_y", c.wy))
        bx, by, wx, wy = (
            _named(names, f"{c.wheel.name}_{k.replace('_', '').lower()}", p, f"{k} of {c.wheel.name}")
            for k, p in parts
        )
        named.append((bx, by, wx, wy))
    return named


def _named(names: Locals, name: str, value: Poly, quantity: str) -> Poly:
    return names.poly(name, value, quantity) if value.generators else value


def _named_rows(measured: Measurements, names: Locals) -> list[Measured]:
    points = zip(named_contacts(measured.contacts, names), measured.contacts, strict=True)
    rows = [row for parts, c in points for row in contact_rows(*parts, c.weight)]
    for c in measured.components:
        x, y, w = (
            _named(names, f"{c.wheel.name}_r{k}", p, f"{column} in H, row of {c.wheel.name}")
            for k, column, p in zip("xyw", ("vx", "vy", "omega"), c.row, strict=True)
        )
        rows.append(((x, y, w), c.value, c.weight))
    return [*rows, *(() if measured.gyro is None else measured.gyro.rows)]


def reach_of(wheels: Sequence[Wheel]) -> Exact:
    """The mean square distance of the measured wheels from P, offsets included; 1 when all stand at P."""
    shapes = [w.nominal for w in wheels]
    total = sum((g.x * g.x + g.y * g.y + g.d * g.d + g.o * g.o for g in shapes), Exact(0))
    return total / len(wheels) if total else ONE


def generic_rank(measured: Measurements) -> int:
    """The rank of the measured rows at nominal parameters and general joint angles."""
    robot, angles = measured.robot, generic(measured.robot)
    numbers = [[nominal_at(p, robot, angles) for p in row] for row, _, _ in measured.rows]
    return _rank(numbers, measured.wheels)


def _rank(rows: list[list[float]], wheels: Sequence[Wheel]) -> int:
    """The rank of rows with lengths in the reach of the wheels, so that it does not depend on the unit."""
    return numeric_rank(np.array(rows).reshape(-1, 3) / [1.0, 1.0, float(reach_of(wheels)) ** 0.5])[0]


def lower_bound(measured: Measurements) -> float:
    """A bound under det N from the rows that do not move; 0 when they alone do not have rank 3 for all parameters."""
    numbers = [([p.constant for p in row], math.sqrt(float(weight))) for row, _, weight in measured.rows]
    rows = [[size * float(v) for v in row if v is not None] for row, size in numbers if None not in row]
    if _rank(rows, measured.wheels) < 3:
        return _bound_of_three(measured)
    a, b, c = ([sum(r[i] * r[j] for r in rows) for j in range(3)] for i in range(3))
    return float(sum(x * y for x, y in zip(a, np.cross(b, c), strict=True)))


def _bound_of_three(measured: Measurements) -> float:
    """A bound under det(H3)**2 of three rows that do not move, whatever tunable parameters are; 0 if there is none.

    N is a sum over rows, each of which can only add to det N. The bound is a power of two, because the last bits of
    sines may differ between machines.
    """
    still = [(row, weight) for row, _, weight in measured.rows if not has_angles(row)]
    values = [[nominal_at(p, measured.robot, generic(measured.robot)) for p in row] for row, _ in still]
    if _rank(values, measured.wheels) < 3:
        return 0.0
    chosen = [still[i] for i in independent(np.array(values), 3)]
    minor = range_of(determinant([list(row) for row, _ in chosen]), ranges_of(measured.robot))
    least = float(smallest(minor)[0]) ** 2 * math.prod(float(weight) for _, weight in chosen)
    return 2.0 ** math.floor(math.log2(least)) if least else 0.0


def adjugate(n: Matrix, names: Locals) -> tuple[Matrix, Expr]:
    """Adjugate and determinant of H^T H, named."""
    adj = symmetric(lambda i, j: names.poly(f"adj{i}{j}", cofactor(n, i, j), f"adj(HtH)[{i}][{j}]"))
    return adj, names.define("det", dot(n[0], adj[0]), "det(HtH)")


def smallest_twist(n: Matrix, b: list[Poly], measured: Measurements, names: Locals) -> list[Expr]:
    """N^+ b, entries named. Where det N has a lower bound above 0 nothing can be lost."""
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
    """adj(H^T H) H^T z, named."""
    return [
        names.define(f"p{i}", Poly.sum(adj[i][j] * b[j] for j in range(3)), f"(adj(HtH) Htz)[{i}]")
        for i in range(3)
    ]


def _over(value: Expr, names: Locals, name: str) -> Expr:
    return names.define(f"over_{name}", 1 / maximum(value, number(FLOOR)))
