"""The steady circle of a train of trailers: hitch angles for a constant curvature of the body.

On it every axle turns at the rate of the body, kappa per metre that the body's axle advances. Seen from the trailer
the coupling moves by (v_i, L_i kappa), from what pulls it by (v_(i-1), -h_i kappa). Lengths and directions agree for

    v_i**2 = v_(i-1)**2 + kappa**2 (h_i**2 - L_i**2),   v_0 = 1
    hitch angle_i = atan2(L_i kappa, v_i) + atan2(h_i kappa, v_(i-1))

It exists while every v_i**2 is not negative: the radii satisfy R_i**2 = R_(i-1)**2 + h_i**2 - L_i**2
(Tzafestas 2.3.6 with h = 0).
"""

from __future__ import annotations

import sympy

from wmrgen.constraints import working_view
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import function
from wmrgen.functions.trailers.trailer import body_of, check_trailers, require_trailers
from wmrgen.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, angle_of, expression, maximum, minimum, root, signal, square, times

CURVATURE = Port("curvature", Role.COMMAND, "1/m", "yaw rate of the body per speed of its axle centre")


@function("Tzafestas 2.3.6, (2.70) at rest")
def steady_circle(robot: Robot, mobility: Mobility) -> Formula:
    """curvature to ``<trailer>.hitch_angle``, ``<trailer>.speed`` (the body's axle has 1) and ``margin``.

    margin is the smallest v_i**2: the steady circle exists where it is not negative. Forward motion is stable on it.
    """
    require_trailers(robot)
    check_trailers(robot, mobility)
    if not body_of(robot, mobility, working_view).axle:
        raise NotDerivableError(
            f"{robot.name} has no steady circle in closed form: its body has no fixed axle that leads the trailers."
        )
    names = Locals()
    kappa = signal("curvature")
    bend = names.define("curvature_squared", square(kappa))
    squared: Expr = sympy.S.One
    speed: Expr = sympy.S.One
    margin: Expr | None = None
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
        outputs.append((Port(f"{t.name}.hitch_angle", Role.COMMAND, "rad", text), angle))
        text = "speed of its axle per speed of the body's axle, on the steady circle"
        outputs.append((Port(f"{t.name}.speed", Role.COMMAND, "", text), speed))
    text = "smallest squared speed ratio: the steady circle exists where it is not negative"
    outputs.append((Port("margin", Role.COMMAND, "", text), margin))
    return Formula(
        "steady_circle", (CURVATURE, *tunable_ports(robot)), tuple(names.items), tuple(outputs),
        "hitch angles on the steady circle of constant curvature",
    )  # fmt: skip
