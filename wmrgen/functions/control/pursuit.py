"""`pursuit`: steer onto the circle that is tangent to the heading and meets a point ahead (Tzafestas (2.57)).

With the goal at distance L in direction epsilon, its lateral offset d = L sin epsilon, the curvature is
2 sin epsilon / L = 2 d / L^2 and a wheel at distance D before the fixed axle steers by atan(2 D sin epsilon / L).
"""

from __future__ import annotations

import sympy

from wmrgen.constraints import working_view
from wmrgen.exact.poly import Poly
from wmrgen.functions.control.drive import Reference, commands, reference
from wmrgen.functions.control.goto_pose import AT_GOAL
from wmrgen.functions.registry import function
from wmrgen.kinematics.records import Formula, Locals
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, angle_of, expression, select, signal, square, times

INPUTS = (
    Port("goal_x", Role.COMMAND, "m", "point to meet, robot frame"),
    Port("goal_y", Role.COMMAND, "m", "point to meet, robot frame"),
    Port(
        "v",
        Role.COMMAND,
        "m/s",
        "speed forward of the axle centre; negative drives the same circle backwards",
    ),
)


@function("Tzafestas (2.57)")
def pursuit(robot: Robot, mobility: Mobility) -> Formula:
    """A look-ahead point and a speed to every joint's command; straight on where the point is reached."""
    ref = reference(robot, mobility, "pursuit")
    names = Locals()
    gx, gy = ref.seen(signal("goal_x"), signal("goal_y"), names, "goal")
    square_l = names.define("distance_squared", add(square(gx), square(gy)))
    far = times(AT_GOAL, AT_GOAL)
    divisor = names.define("divisor", select(far, square_l, square_l, sympy.S.One))
    bend = names.define("curvature_value", select(far, square_l, times(2, gy, 1 / divisor), sympy.S.Zero))
    omega = names.define("omega_value", times(signal("v"), bend))
    more, outputs = commands(robot, mobility, ref, signal("v"), omega, names)
    results: list[tuple[Port, Expr]] = [
        (Port("omega", Role.COMMAND, "rad/s", "yaw rate, counter-clockwise"), omega),
        (Port("curvature", Role.COMMAND, "1/m", "of the circle of the axle centre, to the left"), bend),
    ]
    base = wheelbase(robot, ref)
    if base is not None:
        text = "steering angle of a wheel on the centre line, from straight ahead"
        psi = angle_of(times(2, expression(base), gy), square_l)
        results.append((Port("psi", Role.COMMAND, "rad", text), psi))
    return Formula(
        "pursuit", (*INPUTS, *more), tuple(names.items), (*outputs, *results),
        "look-ahead point and speed to joint commands, pursuit (Tzafestas (2.57))",
    )  # fmt: skip


def wheelbase(robot: Robot, ref: Reference) -> Poly | None:
    """D [m], from the fixed axle to the steered wheels along the heading; None unless all have the same."""
    if not any(w.kind.fixed_axle for w in robot.wheels):
        return None
    views = [working_view(w) for w in robot.wheels if w.kind.steers]
    found = {(g.x - ref.x) * ref.c + (g.y - ref.y) * ref.s for g in views}
    return found.pop() if len(found) == 1 else None
