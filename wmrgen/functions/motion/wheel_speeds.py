"""What the driven wheel speeds say together: their compatibility rows, and the velocity augmentation factor.

Where more wheels drive than the robot has freedoms, w . spin = 0 whatever it does, with w in the left null space of
J2^-1 J1 on the admissible twists: theta1 + theta2 = theta3 + theta4 of a mecanum base (Tzafestas (2.84)).

The velocity augmentation factor is the speed of the robot over the largest rim speed of its wheels (Tzafestas 2.4.1):

    VAF(direction) = 1 / max_i |e_i . direction| / cos gamma_i

e_i: rolling row of driven wheel i, gamma its rollers. The translations that keep every rim within 1 m/s form a
polygon; VAF is its extent in a direction, largest in a corner and smallest across an edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

import numpy as np
import sympy

from wmrgen.constraints import View, driving_row, nominal_view, rolling_row, symbolic_view, working_view
from wmrgen.errors import NotDerivableError
from wmrgen.exact.evaluate import circle, fix
from wmrgen.exact.linalg import determinant
from wmrgen.exact.number import ONE, Exact
from wmrgen.exact.poly import Gen, Poly, dot
from wmrgen.functions.registry import function
from wmrgen.kinematics.records import Formula, Locals, given, joint_port, tunable_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.basis import IDENTITY
from wmrgen.mobility.ranks import independent, numeric_rank, to_array, unit_rows
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    expression,
    matrix,
    maximum,
    number,
    over,
    root,
    signal,
    times,
)

NEGLIGIBLE = 1e-12
Relation = tuple[Poly, ...]  # one entry per driven wheel


def relations(
    robot: Robot, mobility: Mobility, view: View = working_view
) -> tuple[list[Wheel], list[Relation]]:
    """The driven wheels, and the independent rows w with w . spin = 0, steering held.

    A degenerate robot (skid-steer) keeps every twist, as its inverse does.
    """
    driven = [w for w in robot.wheels if "spin" in w.actuated]
    columns = mobility.null_space_symbolic if view is symbolic_view else mobility.null_space
    if mobility.degenerate:
        columns = IDENTITY
    if not driven or not columns:
        return driven, []
    rims = [tuple(dot(driving_row(w, view(w)), column) for column in columns) for w in driven]
    numbers = np.array([[_float(robot, p) for p in row] for row in rims]).reshape(len(driven), -1)
    numbers = np.hstack([numbers, np.zeros((len(driven), 3 - numbers.shape[1]))])
    rank, _ = numeric_rank(unit_rows(numbers))
    rows = independent(numbers, rank)
    keep = independent(np.pad(numbers[rows].T, ((0, 0), (0, 3 - rank))), rank) if rank else []
    found = []
    for other in (i for i in range(len(driven)) if i not in rows):
        entries = _relation([rims[i] for i in rows], rims[other], keep)
        full = dict(zip((*rows, other), entries, strict=True))
        row = [full.get(i, Poly({})) * view(w).rolling_radius for i, w in enumerate(driven)]
        found.append(_readable(row))
    return driven, found


def relation_matrix(robot: Robot, mobility: Mobility) -> sympy.Matrix:
    """The rows w, one column per driven wheel, every named parameter a symbol."""
    driven, rows = relations(robot, mobility, symbolic_view)
    return matrix(rows, len(driven))


def _float(robot: Robot, poly: Poly) -> float:
    """The value at nominal parameters and steering angles without meaning."""

    def value(gen: Gen) -> Poly | None:
        if gen.kind not in ("cos", "sin"):
            return None
        index = [w.name for w in robot.wheels].index(gen.name)
        return Poly.of(circle(Fraction(2 + index, 7 + index * index))[gen.kind == "sin"])

    values = {p.name: Poly.of(p.nominal) for p in robot.parameters}
    number = fix(poly.substitute(value), values).constant
    return float(number) if number is not None else 0.0


def _relation(basis: Sequence[tuple[Poly, ...]], other: tuple[Poly, ...], keep: Sequence[int]) -> list[Poly]:
    """Cramer's rule: coefficients of the basis rows and of the other one, whose sum vanishes."""
    square = [[row[k] for k in keep] for row in basis]
    last = [other[k] for k in keep]
    entries = [
        -determinant([last if i == k else r for i, r in enumerate(square)]) for k in range(len(square))
    ]
    return [*entries, determinant(square)]


def _readable(row: Sequence[Poly]) -> Relation:
    """The row without rounding dust and common factors: leading coefficient 1."""
    largest = max(abs(float(c)) for p in row for c in p.terms.values())
    kept = [Poly({m: c for m, c in p.terms.items() if abs(float(c)) > NEGLIGIBLE * largest}) for p in row]
    first = next(p for p in kept if p)
    ratios = [_ratio(p, first) for p in kept]
    if all(r is not None for r in ratios):
        return tuple(r for r in ratios if r is not None)
    powers = [dict(m) for p in kept for m in p.terms]
    shared = {g: min(q.get(g, 0) for q in powers) for g in sorted({g for q in powers for g in q})}
    factor = Poly({tuple((g, -e) for g, e in shared.items() if e): _leading(first).terms[()]})
    return tuple(p * factor for p in kept)


def _leading(p: Poly) -> Poly:
    """One over the first coefficient."""
    first = min(p.terms.items(), key=lambda item: [(g.key, e) for g, e in item[0]])
    return Poly.of(first[1].inverse())


def _ratio(a: Poly, b: Poly) -> Poly | None:
    """a / b when it is a number."""
    if not a:
        return a
    if a.terms.keys() != b.terms.keys():
        return None
    m = next(iter(b.terms))
    ratio = a.terms[m] / b.terms[m]
    close = all(abs(float(c - ratio * b.terms[k])) <= NEGLIGIBLE * abs(float(c)) for k, c in a.terms.items())
    return Poly.of(ratio) if close else None


@function("Tzafestas (2.84), the relation of its rows")
def compatibility(robot: Robot, mobility: Mobility) -> Formula:
    """Wheel speeds to the residual of each compatibility row: 0 where they agree."""
    driven, found = relations(robot, mobility)
    if not found:
        raise NotDerivableError(
            f"{robot.name} has no compatibility rows: no driven wheel depends on others "
            f"(driven: {', '.join(w.name for w in driven) or 'none'})"
        )
    spins = [given(f"{w.name}.spin") for w in driven]
    outputs = []
    for k, row in enumerate(found, 1):
        port = Port(f"residual{k}", Role.COMMAND, "rad/s", f"compatibility row {k} times the wheel speeds")
        outputs.append((port, expression(Poly.sum(a * b for a, b in zip(row, spins, strict=True)))))
    seen = {g.name for row in found for p in row for g in p.generators if g.kind in ("cos", "sin")}
    steers = [joint_port(w, "steer", Role.STATE) for w in robot.wheels if w.name in seen]
    inputs = (*(joint_port(w, "spin", Role.COMMAND) for w in driven), *steers, *tunable_ports(robot))
    text = "residuals of the wheel speeds of an over-actuated robot, steering held"
    return Formula("compatibility", inputs, (), tuple(outputs), text)


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
