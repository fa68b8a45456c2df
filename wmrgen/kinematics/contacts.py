"""What the unconstrained contacts do: rollers of Swedish wheels and spheres.

A roller takes up what the wheel does not: r_sw roller = n_g . v_A + r spin sin gamma (Siegwart (3.20), corrected
sign). A sphere rolls along the velocity of its contact (Siegwart (3.21), (3.22)).
"""

from __future__ import annotations

from wmrgen.constraints import along, rolling_direction, working_view
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.kinematics.records import Formula, Locals, given, tunable_ports, twist_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, angle_of, expression, root, square, times

Outputs = list[tuple[Port, Expr]]


def contacts(robot: Robot) -> Formula | None:
    """vx vy omega to roller rates and the rolling of spheres; None where the robot has neither.

    Rollers need ``r_sw`` in the robot file, spheres ``r``.
    """
    names = Locals()
    twist: Row = (given("vx"), given("vy"), given("omega"))
    outputs: Outputs = []
    for w in robot.wheels:
        if w.kind.rollers and w.nominal.r_sw:
            outputs.append(_roller(w, twist))
        if not w.kind.directed and w.nominal.r:
            outputs += _sphere(w, twist, names)
    if not outputs:
        return None
    return Formula(
        "contacts",
        (*twist_ports(), *tunable_ports(robot)),
        tuple(names.items),
        tuple(outputs),
        "twist of P in the robot frame to roller rates and the rolling of spheres",
    )


def _roller(w: Wheel, twist: Row) -> tuple[Port, Expr]:
    """(n_g . v_A + tan gamma e_g . v_A) / r_sw, e_g the rolling direction turned by gamma."""
    g = working_view(w)
    e = rolling_direction(w, g)
    across = dot(along((-e[1], e[0]), g), twist)
    drive = dot(along(e, g), twist) * g.sg * g.cg.inverse()
    text = "roller rate, positive moves the hub along the roller's own rolling direction n_gamma"
    port = Port(f"{w.name}.roller", Role.COMMAND, "rad/s", text)
    return port, expression((across + drive) * g.r_sw.inverse())


def _sphere(w: Wheel, twist: Row, names: Locals) -> Outputs:
    """Direction of the contact's velocity [rad, robot frame] and the roll rate along it [rad/s]."""
    g = working_view(w)
    one, zero = Poly.of(1), Poly({})
    a = names.define(f"{w.name}_x", dot(along((one, zero), g), twist))
    b = names.define(f"{w.name}_y", dot(along((zero, one), g), twist))
    speed = root(add(square(a), square(b)))
    return [
        (Port(f"{w.name}.direction", Role.COMMAND, "rad", "direction of rolling, from x"), angle_of(b, a)),
        (
            Port(f"{w.name}.roll", Role.COMMAND, "rad/s", "rate of rolling"),
            times(expression(g.r.inverse()), speed),
        ),
    ]
