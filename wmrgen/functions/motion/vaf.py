"""Velocity augmentation factor: speed of the robot over the largest rim speed of its wheels (Tzafestas 2.4.1).

    VAF(direction) = 1 / max_i |e_i . direction| / cos gamma_i

e_i: rolling row of driven wheel i, gamma its rollers. The translations that keep every rim within 1 m/s form a
polygon; VAF is its extent in a direction, largest in a corner and smallest across an edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import sympy

from wmrgen.constraints import nominal_view, rolling_row, working_view
from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import ONE, Exact
from wmrgen.exact.poly import Poly
from wmrgen.functions.motion.compose import over
from wmrgen.functions.registry import function
from wmrgen.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.ranks import numeric_rank, to_array
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    expression,
    maximum,
    number,
    root,
    signal,
    times,
)

INSIDE = 1 + 1e-9  # rim speed of a corner of the polygon, beside 1


@dataclass(frozen=True, slots=True)
class Extremes:
    """Exact factors and one direction [rad] in which each is reached."""

    smallest: Expr
    smallest_direction: Expr
    largest: Expr
    largest_direction: Expr


def _driven(robot: Robot, mobility: Mobility) -> list[Wheel]:
    """The wheels that drive. NotDerivableError where they do not fix every translation by constant rows."""
    if mobility.degree_of_mobility != 3:
        raise NotDerivableError(
            f"{robot.name} has no vaf: it cannot translate in every direction "
            f"(mobility {mobility.degree_of_mobility}, not 3)"
        )
    driven = [w for w in robot.wheels if "spin" in w.actuated]
    turning = [w.name for w in driven if w.turns]
    if turning:
        raise NotDerivableError(
            f"{robot.name} has no vaf: the rim speed of {turning[0]} changes with its steering angle"
        )
    rows = [[*_rim_numbers(w), Exact(0)] for w in driven]
    if numeric_rank(to_array(rows))[0] < 2:
        raise NotDerivableError(f"{robot.name} has no vaf: along some direction no driven wheel turns")
    return driven


def _rim(w: Wheel) -> tuple[Poly, Poly]:
    """Rim speed per velocity along x and y."""
    g = working_view(w)
    row, over_cg = rolling_row(w, g).row, g.cg.inverse()
    return row[0] * over_cg, row[1] * over_cg


def _rim_numbers(w: Wheel) -> tuple[Exact, Exact]:
    g = nominal_view(w)
    row, over_cg = rolling_row(w, g).row, g.cg.inverse()
    a, b = ((p * over_cg).constant for p in row[:2])
    return a or Exact(0), b or Exact(0)


@function("Tzafestas 2.4.1, (2.71)")
def vaf(robot: Robot, mobility: Mobility) -> Formula:
    """Direction of a translation in the robot frame to the velocity augmentation factor."""
    names = Locals()
    c = names.define("cos_direction", sympy.cos(signal("direction")))
    s = names.define("sin_direction", sympy.sin(signal("direction")))
    largest: Expr = sympy.Rational(1, 10**9)
    for w in _driven(robot, mobility):
        a, b = _rim(w)
        speed = names.define(f"{w.name}_rim", add(times(expression(a), c), times(expression(b), s)))
        largest = maximum(absolute(speed), largest)
    inputs = (
        Port("direction", Role.COMMAND, "rad", "direction of motion, from x of the robot"),
        *tunable_ports(robot),
    )
    port = Port("vaf", Role.COMMAND, "", "speed of P over the largest rim speed of a driven wheel")
    text = "velocity augmentation factor of a translation"
    return Formula("vaf", inputs, tuple(names.items), ((port, over(sympy.S.One, largest)),), text)


def extremes(robot: Robot, mobility: Mobility) -> Extremes:
    """The smallest and the largest factor over all directions, at nominal parameters, exact."""
    rows = [_rim_numbers(w) for w in _driven(robot, mobility)]
    longest = max(rows, key=_size)
    corner = max((p for a, b in combinations(rows, 2) for p in _corners(a, b) if _kept(p, rows)), key=_size)
    smallest = root(number(ONE / _square(longest)))
    return Extremes(
        smallest.doit(), _direction(longest), root(number(_square(corner))).doit(), _direction(corner)
    )


def _square(p: tuple[Exact, Exact]) -> Exact:
    return p[0] * p[0] + p[1] * p[1]


def _size(p: tuple[Exact, Exact]) -> float:
    return float(_square(p))


def _direction(p: tuple[Exact, Exact]) -> Expr:
    return angle_of(number(p[1]), number(p[0])).doit()


def _corners(a: tuple[Exact, Exact], b: tuple[Exact, Exact]) -> list[tuple[Exact, Exact]]:
    """Velocities at which both rims run at 1 m/s, forward or one of them backward."""
    det = a[0] * b[1] - a[1] * b[0]
    if abs(float(det)) < 1e-12:
        return []
    return [((b[1] * u - a[1]) / det, (a[0] - b[0] * u) / det) for u in (ONE, -ONE)]


def _kept(p: tuple[Exact, Exact], rows: list[tuple[Exact, Exact]]) -> bool:
    return all(abs(float(a * p[0] + b * p[1])) <= INSIDE for a, b in rows)
