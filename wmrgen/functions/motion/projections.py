"""Velocities of the contact points along and across each wheel, and in the world (Konstantinov (2), (3))."""

from __future__ import annotations

import sympy

from wmrgen.constraints import heading, working_view
from wmrgen.exact.poly import Poly
from wmrgen.functions.motion.points import contact_points, point_inputs, point_port, velocities
from wmrgen.functions.registry import function
from wmrgen.kinematics.records import Formula, Locals
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port
from wmrgen.symbolic import Expr, add, expression, signal, subtract, times


@function("Konstantinov (1)-(3), (2) corrected; Tzafestas (2.71)")
def projections(robot: Robot, _: Mobility) -> Formula:
    """Twist and heading to the contact velocities along e and n and in the world (Konstantinov (2), (3)).

    ``along`` = e . v (lambda_i), ``across`` = n . v (mu_i); for a Swedish-90 wheel the rim and the roller speed.
    """
    names, points = Locals(), contact_points(robot)
    c = names.define("cos_theta", sympy.cos(signal("theta")))
    s = names.define("sin_theta", sympy.sin(signal("theta")))
    outputs: list[tuple[Port, Expr]] = []
    for p, (a, b) in zip(points, velocities(points, names), strict=True):
        w = p.wheel
        if w.kind.directed:
            g = working_view(w)
            ex, ey = heading(w, g)
            vx, vy = Poly.gen("local", f"{w.name}_x"), Poly.gen("local", f"{w.name}_y")
            outputs += [
                (
                    point_port(w, "along", "contact velocity along the rolling direction e"),
                    expression(ex * vx + ey * vy),
                ),
                (
                    point_port(w, "across", "contact velocity along the lateral n"),
                    expression(ex * vy - ey * vx),
                ),
            ]
        outputs += [
            (point_port(w, "x_rate", "contact velocity along world x"), subtract(times(c, a), times(s, b))),
            (point_port(w, "y_rate", "contact velocity along world y"), add(times(s, a), times(c, b))),
        ]
    inputs = point_inputs(robot, points, theta=True, headings=True)
    text = "contact velocities along and across each wheel, and in the world"
    return Formula("projections", inputs, tuple(names.items), tuple(outputs), text)
