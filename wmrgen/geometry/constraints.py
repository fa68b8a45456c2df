"""Rolling and sliding constraints: one row per wheel, and the matrices of all rows.

With e the rolling direction and n = z x e, a contact at B = A + d e + o n gives (Siegwart (3.12)-(3.19))

    rolling  [ e_x,  e_y,  x e_y - y e_x - o ] xi - o steer_rate = r spin
    sliding  [ n_x,  n_y,  x n_y - y n_x + d ] xi + d steer_rate = 0

A Swedish wheel rolls along e rotated by gamma, with r cos gamma in place of r, and has no sliding row. For any other
wheel gamma is 0; d and o are 0 if the contact is under the pivot. One form of each row serves every wheel type.

xi = (vx, vy, omega) in the robot frame [m/s, m/s, rad/s]. Rows are in m/s.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple, TypeVar

from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly, Row, dot
from wmrgen.geometry.layout.records import Geometry, Robot, Wheel
from wmrgen.geometry.ports import TWIST_NAMES

T = TypeVar("T", Poly, Exact)
View = Callable[[Wheel], Geometry[Poly]]
XI: Row = (
    Poly.gen("input", "vx"),
    Poly.gen("input", "vy"),
    Poly.gen("input", "omega"),
)  # the commanded twist


class ConstraintRow(NamedTuple):
    """One constraint: row . xi + rates . (joint rates) = 0 [m/s]."""

    wheel: Wheel
    kind: str  # rolling or sliding
    row: Row  # coefficients of vx, vy and omega
    # (wheel index, joint) and the coefficient of the rate of that joint.
    rates: tuple[tuple[tuple[int, str], Poly], ...]


class Constraints(NamedTuple):
    """All rows of the robot, in the order of the wheels in the file."""

    robot: Robot
    rolling: tuple[ConstraintRow, ...]
    sliding: tuple[ConstraintRow, ...]

    @property
    def sliding_fixed(self) -> tuple[ConstraintRow, ...]:
        """C1f: the sliding rows of wheels whose axles are fixed in the body."""
        return tuple(c for c in self.sliding if c.wheel.kind.fixed_axle)

    @property
    def sliding_steered(self) -> tuple[ConstraintRow, ...]:
        """C1s: the sliding rows of steered wheels."""
        return tuple(c for c in self.sliding if c.wheel.kind.steers)

    @property
    def joints(self) -> tuple[tuple[int, str], ...]:
        """The joints whose rates occur: spins, then steering rates, in wheel order."""
        present = {key for c in (*self.rolling, *self.sliding) for key, k in c.rates if k}
        return tuple(sorted(present, key=lambda key: (key[1] != "spin", key[0])))


def symbolic_view(wheel: Wheel) -> Geometry[Poly]:
    """Return the geometry with every named parameter as a symbol."""
    return wheel.symbolic


def working_view(wheel: Wheel) -> Geometry[Poly]:
    """Return the geometry with only the tunable parameters as symbols."""
    return wheel.working


def nominal_view(wheel: Wheel) -> Geometry[Poly]:
    """Return the geometry with numbers only."""
    return wheel.nominal.mapped(Poly.of)


def seen(robot: Robot, view: View) -> Robot:
    """Return the robot with ``view`` of its geometry as the working one."""
    return replace(robot, wheels=tuple(replace(w, working=view(w)) for w in robot.wheels))


def steer_gens(wheel: Wheel) -> tuple[Poly, Poly]:
    """Return (cos, sin) of the wheel's joint angle ``<wheel>.steer``."""
    return Poly.gen("cos", wheel.name), Poly.gen("sin", wheel.name)


def heading(wheel: Wheel, g: Geometry[Poly]) -> tuple[Poly, Poly]:
    """Return (cos, sin) of the rolling direction e, which the steering joint rotates if there is one."""
    if not wheel.turns:
        return g.ch, g.sh
    c, s = steer_gens(wheel)
    return g.ch * c - g.sh * s, g.sh * c + g.ch * s


def arm(g: Geometry[T], c: T, s: T) -> tuple[T, T]:
    """Return the vector from the pivot A to the contact B, B - A = d e + o n.

    Args:
        g: The constants of the wheel.
        c: The cosine of the rolling direction e.
        s: The sine of the rolling direction e.

    Returns:
        x and y [m] in the frame of e.
    """
    return g.d * c - g.o * s, g.d * s + g.o * c


def along(direction: tuple[Poly, Poly], g: Geometry[Poly]) -> Row:
    """Return the row of the pivot's velocity component along ``direction``: [d_x, d_y, x d_y - y d_x]."""
    dx, dy = direction
    return dx, dy, g.x * dy - g.y * dx


def _plus(row: Row, third: Poly) -> Row:
    return row[0], row[1], row[2] + third


def rolling_direction(wheel: Wheel, g: Geometry[Poly]) -> tuple[Poly, Poly]:
    """Return (cos, sin) of the direction that the rolling row measures: e rotated by gamma."""
    c, s = heading(wheel, g)
    return c * g.cg - s * g.sg, s * g.cg + c * g.sg


def rolling_row(wheel: Wheel, g: Geometry[Poly]) -> ConstraintRow:
    """Return the rolling row: Siegwart (3.12), (3.15), (3.17) and, for a Swedish wheel, (3.19)."""
    rates = [((wheel.index, "spin"), -g.rolling_radius)]
    if wheel.turns and g.steer_arm:
        rates.append(((wheel.index, "steer"), -g.steer_arm))
    return ConstraintRow(wheel, "rolling", _plus(along(rolling_direction(wheel, g), g), -g.o), tuple(rates))


def sliding_row(wheel: Wheel, g: Geometry[Poly]) -> ConstraintRow:
    """Return the sliding row: Siegwart (3.13), (3.16) and, for a castor, (3.18)."""
    c, s = heading(wheel, g)
    rates = (((wheel.index, "steer"), g.d),) if wheel.kind.swivels else ()
    return ConstraintRow(wheel, "sliding", _plus(along((-s, c), g), g.d), rates)


def castor_rate(wheel: Wheel, g: Geometry[Poly], twist: Row) -> Poly:
    """Return the steering rate at which a castor does not slide: -(sliding row . xi) / d, Siegwart (3.18).

    Args:
        wheel: A castor.
        g: The constants of the castor in the wanted view.
        twist: vx, vy [m/s] and omega [rad/s] as polynomials.

    Returns:
        The rate [rad/s].
    """
    return -(dot(sliding_row(wheel, g).row, twist) * g.d.inverse())


def driving_row(wheel: Wheel, g: Geometry[Poly]) -> Row:
    """Return the row of the rim speed [m/s] as a function of the twist alone.

    A castor's steering rate is eliminated with its sliding row.
    """
    row = rolling_row(wheel, g).row
    if not wheel.kind.swivels or not g.steer_arm:
        return row
    slide, share = sliding_row(wheel, g).row, g.steer_arm * g.d.inverse()
    return row[0] + share * slide[0], row[1] + share * slide[1], row[2] + share * slide[2]


def constrain(robot: Robot, view: View) -> Constraints:
    """Return all rows of the robot in one view of its geometry."""
    rolling = tuple(rolling_row(w, view(w)) for w in robot.wheels if w.has_spin)
    sliding = tuple(sliding_row(w, view(w)) for w in robot.wheels if w.kind.sliding_row)
    return Constraints(robot, rolling, sliding)


def pfaffian_rates(c: Constraints) -> tuple[str, ...]:
    """Return the names of the columns of the Pfaffian matrix: twist, joint rates and, if wheels slip, their slips."""
    rates = {"spin": "spin", "steer": "steer_rate"}
    joints = (f"{c.robot.wheels[i].name}.{rates[joint]}" for i, joint in c.joints)
    slipping = (*c.rolling, *c.sliding) if c.robot.slip else ()
    slips = (f"{row.wheel.name}.slip_{'x' if row.kind == 'rolling' else 'y'}" for row in slipping)
    return (*TWIST_NAMES, *joints, *slips)


def pfaffian(c: Constraints, slip: bool) -> list[list[Poly]]:
    """Return the Pfaffian matrix over (vx, vy, omega, joint rates): rolling rows, then sliding rows.

    With ``slip`` each row has a column of its own: e . v + slip_x = r spin, n . v - slip_y = 0 (Tzafestas Ex. 2.2).
    """
    every = (*c.rolling, *c.sliding)
    rows: list[list[Poly]] = []
    for i, row in enumerate(every):
        rates = dict(row.rates)
        sign = 1 if row.kind == "rolling" else -1
        slips = [Poly.of(sign * int(i == k)) for k in range(len(every))] if slip else []
        rows.append([*row.row, *(rates.get(j, Poly({})) for j in c.joints), *slips])
    return rows
