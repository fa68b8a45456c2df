"""Where trailers stand: their axles for given headings, and the hitch angles on the steady circle.

On the steady circle every axle turns at the rate of the body, kappa per metre that the body's axle advances. Seen from
the trailer the coupling moves by (v_i, L_i kappa), from what pulls it by (v_(i-1), -h_i kappa). Lengths and directions
agree for

    v_i**2 = v_(i-1)**2 + kappa**2 (h_i**2 - L_i**2),   v_0 = 1
    hitch angle_i = atan2(L_i kappa, v_i) + atan2(h_i kappa, v_(i-1))

It exists while no v_i**2 is negative: the radii satisfy R_i**2 = R_(i-1)**2 + h_i**2 - L_i**2
(Tzafestas 2.3.6 with h = 0).
"""

from __future__ import annotations

import sympy

from wmrgen.constraints import working_view
from wmrgen.exact.poly import Poly
from wmrgen.functions.models.axle import Vector, fixed_axle, leading_axle
from wmrgen.functions.registry import function, underivable
from wmrgen.functions.trailers.trailer import require_trailers, state_ports
from wmrgen.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import POSE, Port, Role, output
from wmrgen.symbolic import (
    Expr,
    add,
    angle_of,
    expression,
    maximum,
    minimum,
    root,
    rotated,
    signal,
    square,
    subtract,
    times,
)

CURVATURE = output("curvature", "1/m", "yaw rate of the body per speed of its axle centre")


def behind(point: Vector, length: Poly, heading: Expr) -> Vector:
    """The point that lies ``length`` [m] behind another, seen along a heading in the world."""
    x, y = point
    distance = expression(length)
    return subtract(x, times(distance, sympy.cos(heading))), subtract(y, times(distance, sympy.sin(heading)))


@function("Tzafestas 2.3.6")
def trailer_positions(robot: Robot, mobility: Mobility) -> Formula:
    """Pose of the body and headings of the trailers to the centre of each trailer's axle, world frame [m].

    On the axle x_i = x_Q - sum of L_j cos(theta_j).
    """
    require_trailers(robot, mobility)
    axle = leading_axle(robot, mobility, working_view)
    names = Locals()
    ahead = signal("theta")
    coupling = axle.coupling(robot.trailers[0].hitch.working)
    x, y = rotated(sympy.cos(ahead), sympy.sin(ahead), *coupling)
    at: Vector = add(signal("x"), x), add(signal("y"), y)
    outputs: list[tuple[Port, Expr]] = []
    for i, t in enumerate(robot.trailers):
        heading = signal(f"{t.name}.theta")
        if i:
            at = behind(at, t.hitch.working, ahead)
        x, y = behind(at, t.length.working, heading)
        at = names.define(f"{t.name}.at_x", x), names.define(f"{t.name}.at_y", y)
        text = "centre of the trailer's axle, world frame"
        outputs += [(Port(f"{t.name}.{k}", Role.STATE, "m", text), v) for k, v in zip("xy", at, strict=True)]
        ahead = heading
    inputs = (*POSE, *state_ports(robot.trailers), *tunable_ports(robot))
    text = "where the axles of the trailers stand"
    return names.formula("trailer_positions", inputs, outputs, text)


@function("Tzafestas 2.3.6, (2.70) at rest")
def steady_circle(robot: Robot, mobility: Mobility) -> Formula:
    """curvature to ``<trailer>.hitch_angle``, ``<trailer>.speed`` (the body's axle has 1) and ``margin``.

    margin is the smallest v_i**2: the steady circle exists where it is not negative. Forward motion is stable on it.
    """
    require_trailers(robot, mobility)
    if fixed_axle(robot, mobility, working_view) is None:
        why = "its body has no fixed axle that leads the trailers."
        raise underivable(robot, "steady circle in closed form", why)
    names = Locals()
    kappa = signal("curvature")
    bend = names.define("curvature_squared", square(kappa))
    margin: Expr | None = None
    squared: Expr = sympy.S.One
    speed: Expr = sympy.S.One
    outputs: list[tuple[Port, Expr]] = []
    for t in robot.trailers:
        length, hitch = t.length.working, t.hitch.working
        squared = names.define(
            f"{t.name}.squared", add(squared, times(expression(hitch**2 - length**2), bend))
        )
        margin = squared if margin is None else minimum(margin, squared)
        ahead = speed
        speed = names.define(f"{t.name}.speed", root(maximum(sympy.S.Zero, squared)))
        angle = angle_of(times(expression(length), kappa), speed)
        if hitch:
            angle = add(angle, angle_of(times(expression(hitch), kappa), ahead))
        text = "heading of what pulls it minus its own, on the steady circle"
        outputs.append((output(f"{t.name}.hitch_angle", "rad", text), angle))
        text = "speed of its axle per speed of the body's axle, on the steady circle"
        outputs.append((output(f"{t.name}.speed", "", text), speed))
    text = "smallest squared speed ratio: the steady circle exists where it is not negative"
    outputs.append((output("margin", "", text), margin))
    text = "hitch angles on the steady circle of constant curvature"
    return names.formula("steady_circle", (CURVATURE, *tunable_ports(robot)), outputs, text)
