"""Relations that integrable constraints integrate to, for wheels that do not steer.

The admissible twists span a subalgebra g of se(2) if DDOF = DOF. With one translation the body moves along a line, and
every wheel angle is its distance over r (Siegwart 3.4.2: phi = x/r + phi0). With one rotation the body moves on a
circle about a fixed centre. With two translations the heading is constant. In every case rolling integrates as well,
and wheel angles are functions of the position.
"""

from __future__ import annotations

from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Reason, UnderivableError, function
from wmrgen.geometry.constraints import constrain, nominal_view, rolling_row, working_view
from wmrgen.geometry.exact.evaluate import fix
from wmrgen.geometry.exact.linalg import left_null_space
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Row, dot, triple
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import POSE, Port, Role
from wmrgen.geometry.symbolic import add, expression, rotated_back, signal, times

Terms = tuple[tuple[str, float], ...]  # a linear function: quantity, coefficient
Twist = tuple[Exact, Exact, Exact]

SMALL = 1e-12  # a component of a row or of a twist nearer to zero is treated as zero


class Integral(NamedTuple):
    """A relation: the sum of coefficients * quantities is constant along every motion."""

    # of ``x_body`` and ``y_body`` [m], the displacement of P in the robot frame at constant heading;
    # ``theta``; ``<wheel>.angle``
    coefficients: Terms
    text: str


def integrals(robot: Robot, mobility: Mobility) -> tuple[Integral, ...]:
    """Return the relations that the constraints integrate to; for steered wheels, only relations of the pose."""
    twists = constant_twists(robot, mobility)
    if twists is None:
        straight = mobility.dof == 2 and not any(turn for _, _, turn in mobility.null_space)
        return (Integral((("theta", 1.0),), "theta = const"),) if straight else ()
    if mobility.dof == 3:
        return _angle_combinations(robot)
    return (*_pose_relations(twists), *_wheel_relations(robot, twists))


def constant_twists(robot: Robot, mobility: Mobility) -> list[Twist] | None:
    """Return the columns of the null space as numbers; None if they depend on an angle."""
    values = {p.name: p.value for p in robot.parameters}
    twists = []
    for column in mobility.null_space:
        vx, vy, omega = (fix(p, values).constant for p in column)
        if vx is None or vy is None or omega is None:
            return None
        twists.append((vx, vy, omega))
    return twists


def on_circle(twists: list[Twist]) -> bool:
    """Return whether the body can only turn about one point."""
    return len(twists) == 1 and abs(float(twists[0][2])) > SMALL


def _pose_relations(twists: list[Twist]) -> tuple[Integral, ...]:
    """Return the relations of the pose: a constant heading and a line, or the centre of a circle."""
    if not twists:
        return (Integral((("x_body", 1.0),), "x, y and theta are constant: the robot cannot move"),)
    vx, vy, omega = (float(v) for v in twists[0])
    if on_circle(twists):
        centre = f"({-vy / omega:.6g}, {vx / omega:.6g})"
        text = f"the body turns about the point {centre} of the robot frame, which does not move"
        return (Integral((), text),)
    fixed = Integral((("theta", 1.0),), "theta = const")
    if len(twists) == 2:
        return (fixed,)
    across = tuple((k, v) for k, v in (("x_body", -vy), ("y_body", vx)) if abs(v) > SMALL)
    return fixed, Integral(across, f"{_sum(across)} = const: the body can only translate along a line")


def _wheel_relations(robot: Robot, twists: list[Twist]) -> tuple[Integral, ...]:
    """Return wheel angles as linear functions of the position, or of theta on a circle."""
    relations = []
    for w in rolling_wheels(robot):
        row, radius = _numbers(rolling_row(w, nominal_view(w)).row), w.nominal.rolling_radius
        if on_circle(twists):
            rate = sum((a * b for a, b in zip(row, twists[0], strict=True)), ZERO) / twists[0][2]
            way: Terms = (("theta", float(rate / radius)),)
        else:
            way = _gradient_along_line((float(row[0] / radius), float(row[1] / radius)), twists)
        way = tuple((k, c) for k, c in way if abs(c) > SMALL)
        relations.append(Integral(((f"{w.name}.angle", -1.0), *way), f"{w.name}.angle = {_sum(way)} + const"))
    return tuple(relations)


def _gradient_along_line(gradient: tuple[float, float], twists: list[Twist]) -> Terms:
    """Return the gradient along x and y of the body, projected on the line if there is only one translation."""
    a, b = gradient
    if len(twists) == 1:
        vx, vy, _ = (float(v) for v in twists[0])
        share = (a * vx + b * vy) / (vx * vx + vy * vy)
        a, b = share * vx, share * vy
    return ("x_body", a), ("y_body", b)


def _angle_combinations(robot: Robot) -> tuple[Integral, ...]:
    """Return sums of wheel angles that depend on the heading alone, or are constant."""
    wheels = rolling_wheels(robot)
    if not wheels:
        return ()
    rows = [_numbers(rolling_row(w, nominal_view(w)).row) for w in wheels]
    rows += [_numbers(r.row) for r in constrain(robot, nominal_view).sliding_fixed]
    relations = []
    for weights in left_null_space([row[:2] for row in rows]):
        turn = float(sum((k * row[2] for k, row in zip(weights, rows, strict=True)), ZERO))
        angles = [
            (f"{w.name}.angle", float(k * w.nominal.rolling_radius))
            for w, k in zip(wheels, weights[: len(wheels)], strict=True)
            if k
        ]
        if not angles:
            continue
        turns = abs(turn) > SMALL
        scale = turn if turns else angles[0][1]
        terms = tuple((name, value / scale) for name, value in angles)
        if turns:
            relations.append(Integral((("theta", -1.0), *terms), f"theta = {_sum(terms)} + const"))
        else:
            relations.append(Integral(terms, f"{_sum(terms)} = const"))
    return tuple(relations)


def rolling_wheels(robot: Robot) -> list[Wheel]:
    """Return the wheels whose rolling row is constant."""
    return [w for w in robot.wheels if w.has_spin and not w.turns]


def _numbers(row: Row) -> Twist:
    """Return a row as numbers."""
    return triple(p.constant or ZERO for p in row)


def _sum(terms: Terms) -> str:
    """Return a sum as text with signs: 2 x + 0.5 y."""
    text = ""
    for name, c in terms:
        size = "" if abs(abs(c) - 1) < SMALL else f"{abs(c):.6g} "
        text += (f" {'-' if c < 0 else '+'} " if text else "-" if c < 0 else "") + size + name
    return text or "0"


@function("Siegwart 3.4.2, the locked bicycle; Konstantinov (6)")
def wheel_angles(robot: Robot, mobility: Mobility) -> Formula:
    """Return the wheel angles after P has moved, for holonomic robots that do not steer.

    If the body moves on a line or is free to translate, x and y are the displacement of P in the world and theta is
    the constant heading. If it moves on a circle, theta is the angle of rotation (Siegwart 3.4.2).
    """
    twists = constant_twists(robot, mobility)
    if twists is None or mobility.dof == 3 or not twists or not rolling_wheels(robot):
        raise UnderivableError(
            f"{robot.name} has no wheel_angles: they are functions of the position only for holonomic robots that do "
            f"not turn freely (DOF < 3) and do not steer; this robot has DDOF {mobility.ddof}, DOF {mobility.dof}",
            Reason.MOBILITY,
        )
    names = Locals()
    x, y, theta = (signal(p.name) for p in POSE)
    along, across = rotated_back(sympy.cos(theta), sympy.sin(theta), x, y)
    way = names.define("way_x", along), names.define("way_y", across)
    inputs, outputs = [], []
    for w in rolling_wheels(robot):
        g = working_view(w)
        row = rolling_row(w, g).row
        inverse = g.rolling_radius.inverse()
        port = Port(f"{w.name}.angle", Role.STATE, "rad", "angle of the wheel about its axle")
        if on_circle(twists):
            column = mobility.null_space[0]
            rolled = times(expression(dot(row, column) * column[2].inverse() * inverse), theta)
        else:
            rolled = add(*(times(expression(row[k] * inverse), way[k]) for k in range(2)))
        inputs.append(port)
        outputs.append((port, add(signal(port.name), rolled)))
    text = "wheel angles as functions of the position: the integrated rolling constraints; Siegwart 3.4.2"
    return names.formula("wheel_angles", (*POSE, *inputs, *tunable_ports(robot)), outputs, text)
