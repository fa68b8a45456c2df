"""Where the axles of the trailers stand (Tzafestas 2.3.6: x_i = x_Q - sum of L_j cos(theta_j) on the axle)."""

from __future__ import annotations

import sympy

from wmrgen.constraints import working_view
from wmrgen.functions.registry import function
from wmrgen.functions.trailers.trailer import body_of, check_trailers, require_trailers, state_ports
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, signal, subtract, times


@function("Tzafestas 2.3.6")
def trailer_positions(robot: Robot, mobility: Mobility) -> Formula:
    """Pose of the body and headings of the trailers to the centre of each trailer's axle, world frame [m]."""
    require_trailers(robot)
    check_trailers(robot, mobility)
    body = body_of(robot, mobility, working_view)
    names = Locals()
    h = robot.trailers[0].hitch.working
    px, py = expression(body.x - body.fx * h), expression(body.y - body.fy * h)
    theta = signal("theta")
    c, s = sympy.cos(theta), sympy.sin(theta)
    x = add(signal("x"), subtract(times(px, c), times(py, s)))
    y = add(signal("y"), add(times(px, s), times(py, c)))
    outputs: list[tuple[Port, Expr]] = []
    for i, t in enumerate(robot.trailers):
        angle = signal(f"{t.name}.theta")
        back = t.length.working
        if i:
            ahead = signal(f"{robot.trailers[i - 1].name}.theta")
            h = t.hitch.working
            x = subtract(x, times(expression(h), sympy.cos(ahead)))
            y = subtract(y, times(expression(h), sympy.sin(ahead)))
        x = names.define(f"{t.name}.at_x", subtract(x, times(expression(back), sympy.cos(angle))))
        y = names.define(f"{t.name}.at_y", subtract(y, times(expression(back), sympy.sin(angle))))
        outputs += [
            (Port(f"{t.name}.{k}", Role.STATE, "m", "centre of the trailer's axle, world frame"), v)
            for k, v in (("x", x), ("y", y))
        ]
    inputs = (*POSE, *state_ports(robot.trailers), *tunable_ports(robot))
    text = "where the axles of the trailers stand"
    return Formula("trailer_positions", inputs, tuple(names.items), tuple(outputs), text)
