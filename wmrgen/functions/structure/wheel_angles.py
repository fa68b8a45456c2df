"""Wheel angles as functions of the position, where the rolling constraints integrate (Siegwart 3.4.2)."""

from __future__ import annotations

import sympy

from wmrgen.constraints import rolling_row, working_view
from wmrgen.errors import NotDerivableError
from wmrgen.exact.poly import dot
from wmrgen.functions.registry import function
from wmrgen.functions.structure.integrals import SMALL, constant_twists, rolling_wheels
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, signal, subtract, times


@function("Siegwart 3.4.2, the locked bicycle; Konstantinov (6)")
def wheel_angles(robot: Robot, mobility: Mobility) -> Formula:
    """Position of P since the wheel angles were as given, to the wheel angles: holonomic robots that do not steer.

    Body on a line or free to translate: x, y are the way of P in the world, theta the constant heading. Body on a
    circle: theta is the angle turned (Siegwart 3.4.2).
    """
    twists = constant_twists(robot, mobility)
    if twists is None or mobility.dof == 3 or not twists or not rolling_wheels(robot):
        raise NotDerivableError(
            f"{robot.name}: wheel angles are functions of the position only for holonomic robots that do not turn "
            f"freely (DOF < 3) and do not steer; this one has DDOF {mobility.ddof}, DOF {mobility.dof}"
        )
    names = Locals()
    circle = len(twists) == 1 and abs(float(twists[0][2])) > SMALL
    x, y, theta = (signal(p.name) for p in POSE)
    c, s = sympy.cos(theta), sympy.sin(theta)
    way: tuple[Expr, Expr] = (
        names.define("way_x", add(times(x, c), times(y, s))),
        names.define("way_y", subtract(times(y, c), times(x, s))),
    )
    inputs, outputs = [], []
    for w in rolling_wheels(robot):
        g = working_view(w)
        row = rolling_row(w, g).row
        inverse = g.rolling_radius.inverse()
        port = Port(f"{w.name}.angle", Role.STATE, "rad", "angle of the wheel about its axle")
        if circle:
            column = mobility.null_space[0]
            rolled = times(expression(dot(row, column) * column[2].inverse() * inverse), theta)
        else:
            rolled = add(*(times(expression(row[k] * inverse), way[k]) for k in range(2)))
        inputs.append(port)
        outputs.append((port, add(signal(port.name), rolled)))
    return Formula(
        "wheel_angles", (*POSE, *inputs, *tunable_ports(robot)), tuple(names.items), tuple(outputs),
        "wheel angles as functions of the position: the integrated rolling constraints; Siegwart 3.4.2",
    )  # fmt: skip
