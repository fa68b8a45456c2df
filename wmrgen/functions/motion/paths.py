"""Where constant joint rates lead: `motion`, `circle` and `heading`; and back, the twist to a pose: `reach`.

Steering held, a robot drives a straight line or a circle (Konstantinov, case of constant speeds):

    radius = |v| / |omega|,   centre = P + z x v / omega,   period = 2 pi / |omega|

On a straight line the radius is infinite. Here it ends at `FARTHEST`, with the centre that far to the left, so that
every output is finite and continuous; ``turns`` tells which of the two it is.

Where the yaw rate is a constant combination of wheel speeds, it integrates to a holonomic relation, as
phi = phi0 - (r/3a)(psi1 + psi2 + psi3) (Konstantinov (6)) and phi = phi0 + r (theta_r - theta_l) / 2a of the
differential drive (Tzafestas (2.36c)).

`reach` is the inverse of `wmrgen.kinematics.odometry` (SE(2) logarithm): the chord of the arc points along theta / 2
and is dt sinc(theta / 2) times the velocity, so

    v = R(-theta / 2) (x, y) / (dt sinc(theta / 2)),   omega = theta / dt
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np
import sympy

from wmrgen.errors import NotDerivableError
from wmrgen.exact.evaluate import fix
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly
from wmrgen.functions.registry import function
from wmrgen.kinematics.forward import constant_normal, forward
from wmrgen.kinematics.odometry import POSE, odometry
from wmrgen.kinematics.records import Formula, Locals, tunable_ports, twist_ports
from wmrgen.kinematics.sensing import Component, Contact, measurements
from wmrgen.layout.records import Robot
from wmrgen.mobility.ranks import numeric_rank
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    local,
    maximum,
    number,
    root,
    select,
    signal,
    square,
    subtract,
    times,
)


def include(formula: Formula, inputs: Mapping[str, Expr], names: Locals) -> dict[str, Expr]:
    """Add the locals of ``formula`` to ``names``; output name -> expression.

    ``inputs`` replaces inputs by port name; those that it does not name stay inputs.
    """
    return names.adopt(formula, {signal(name): value for name, value in inputs.items()})


def named(outputs: Mapping[str, Expr], wanted: tuple[str, ...], suffix: str, names: Locals) -> list[Expr]:
    """The wanted outputs as intermediate results ``<name>_<suffix>``; a zero stays zero."""
    return [
        value if (value := outputs[name]) is sympy.S.Zero else names.define(f"{name}_{suffix}", value)
        for name in wanted
    ]


def over(above: Expr, below: Expr) -> Expr:
    """above / below as it stands; ``below`` is kept off zero by the caller."""
    return times(above, sympy.Pow(below, -1, evaluate=below.is_Rational))


TWIST = ("vx", "vy", "omega")


def driven(robot: Robot, names: Locals) -> tuple[tuple[Port, ...], list[Expr]]:
    """Inputs (sensed spins and steering angles, tunable parameters) and the twist in the robot frame.

    Steering rates are zero: a constant command holds every steering angle, and the Jacobian with it.
    """
    formula = forward(robot)
    held = {p.name: sympy.S.Zero for p in formula.inputs if p.name.endswith(".steer_rate")}
    twist = named(include(formula, held, names), TWIST, "driven", names)
    return tuple(p for p in formula.inputs if p.name not in held), twist


def joint_ports(ports: tuple[Port, ...]) -> tuple[Port, ...]:
    """The ports that change from step to step."""
    return tuple(p for p in ports if p.role is not Role.GEOMETRY)


def geometry(ports: tuple[Port, ...]) -> tuple[Port, ...]:
    """The tunable parameters among ``ports``."""
    return tuple(p for p in ports if p.role is Role.GEOMETRY)


FARTHEST = Exact(10**9)  # [m] a radius that counts as straight
SLOWEST = Exact(Fraction(1, 10**12))  # [rad/s] a yaw rate that counts as none, [m/s] a speed that does

CIRCLE = (
    ("turns", "", "1 a circle counter-clockwise, -1 clockwise, 0 a straight line or standstill"),
    ("x_centre", "m", "centre of the circle, world frame"),
    ("y_centre", "m", "centre of the circle, world frame"),
    ("radius", "m", "radius of the circle of P, at most 1e9: a straight line"),
    ("curvature", "1/m", "yaw rate over speed of P, at most 1e9 in size: turning on the spot"),
    ("period", "s", "time of one turn"),
    ("speed", "m/s", "speed of P"),
    ("direction", "rad", "direction of motion of P, from x of the robot"),
)


@function("Konstantinov, x_C, y_C and R (corrected); Tzafestas (2.43)")
def circle(robot: Robot, _: Mobility) -> Formula:
    """Sensed joint rates and the pose to the circle or straight line that they drive."""
    names = Locals()
    joints, (vx, vy, omega) = driven(robot, names)
    values = path((vx, vy, omega), names)
    left = names.define("direction_left", add(signal("theta"), values["direction"]))
    reach = names.define(
        "reach", times(select(omega, sympy.S.Zero, sympy.S.NegativeOne, sympy.S.One), values["radius"])
    )
    values["x_centre"] = add(signal("x"), times(-1, reach, sympy.sin(left)))
    values["y_centre"] = add(signal("y"), times(reach, sympy.cos(left)))
    outputs = tuple((Port(n, Role.COMMAND, unit, text), values[n]) for n, unit, text in CIRCLE)
    inputs = (*joint_ports(joints), *POSE, *geometry(joints))
    text = "circle or straight line that constant joint rates drive, steering held"
    return Formula("circle", inputs, tuple(names.items), outputs, text)


def path(twist: tuple[Expr, Expr, Expr], names: Locals) -> dict[str, Expr]:
    """turns, radius, curvature, period, speed and direction of a twist."""
    vx, vy, omega = twist
    zero, one = sympy.S.Zero, sympy.S.One
    least, far = number(SLOWEST), number(FARTHEST)
    speed = names.define("speed_of_path", root(add(square(vx), square(vy))))
    rate = names.define("rate_of_path", absolute(omega))
    turning = names.define("turning", maximum(rate, maximum(over(speed, far), least)))
    moving = names.define("moving", maximum(speed, maximum(over(rate, far), least)))
    way = select(omega, zero, sympy.S.NegativeOne, one)
    straight = maximum(over(speed, far), least)
    return {
        "turns": select(straight, rate, way, zero),
        "radius": over(speed, turning),
        "curvature": over(omega, moving),
        "period": over(2 * sympy.pi, names.define("turning_kept", maximum(rate, least))),
        "speed": speed,
        "direction": angle_of(vy, vx),
    }


@function("Konstantinov, case of constant speeds; Tzafestas (2.36), (2.38) integrated")
def motion(robot: Robot, _: Mobility) -> Formula:
    """Sensed joint rates held for dt: the pose after it, exactly (a straight line or an arc)."""
    names = Locals()
    joints, twist = driven(robot, names)
    ride = odometry()
    end = include(ride, dict(zip(("vx", "vy", "omega"), twist, strict=True)), names)
    outputs = tuple((port, end[port.name]) for port in POSE)
    inputs = (*joint_ports(joints), *POSE, ride.inputs[-1], *geometry(joints))
    text = "pose after holding constant joint rates for dt, steering held"
    return Formula("motion", inputs, tuple(names.items), outputs, text)


SHORTEST = Exact(Fraction(1, 10**9))  # [s] a duration below counts as this, a chord this short as none
_TEXTS = (
    "forward, robot frame at the start",
    "to the left, robot frame at the start",
    "turn, at most pi in size",
)


@function("Siegwart figures 3.15 and 3.16, the twist of a segment")
def reach(robot: Robot, _: Mobility) -> Formula:
    """Displacement x y theta in the robot frame and dt to the constant twist that makes it."""
    del robot
    names = Locals()
    x, y, theta, dt = (signal(n) for n in ("x", "y", "theta", "dt"))
    # Unit speed for unit time along the same arc: its chord is sinc(theta / 2), series and switch point included.
    unit = {n: sympy.Integer(n in ("vx", "dt")) for n in ("x", "y", "theta", "vx", "vy", "dt")}
    include(odometry(), unit | {"omega": theta}, names)
    sinc, h = local("chord"), local("half_turn")
    c, s = names.define("cos_half", sympy.cos(h)), names.define("sin_half", sympy.sin(h))
    time = names.define("time_kept", maximum(dt, number(SHORTEST)))
    scale = names.define("scale", over(sympy.S.One, times(time, maximum(sinc, number(SHORTEST)))))
    values = (
        times(scale, add(times(c, x), times(s, y))),
        times(scale, subtract(times(c, y), times(s, x))),
        over(theta, time),
    )
    inputs = (
        *(replace(p, role=Role.COMMAND, text=t) for p, t in zip(POSE, _TEXTS, strict=True)),
        Port("dt", Role.COMMAND, "s", "duration of the motion, above 0"),
    )
    outputs = tuple(zip(twist_ports(), values, strict=True))
    text = "constant twist that displaces the robot by x y theta in dt"
    return Formula("reach", inputs, tuple(names.items), outputs, text)


@function("Konstantinov (6); Tzafestas (2.36)")
def heading(robot: Robot, _: Mobility) -> Formula:
    """Wheel angles turned since the heading was theta, to the heading now."""
    contacts, components = measurements(robot)
    if not constant_normal(contacts, components):
        raise NotDerivableError(_why(robot, "its yaw rate depends on joint angles that change on the way"))
    if not _sees_yaw(robot, contacts, components):
        raise NotDerivableError(_why(robot, "the sensed wheel speeds do not determine its yaw rate"))
    formula, names = forward(robot), Locals()
    spins = [p for p in formula.inputs if p.name.endswith(".spin")]
    joints = {signal(p.name) for p in formula.inputs if p.name.endswith((".steer", ".steer_rate"))}
    if joints & formula.closed()["omega"].free_symbols:
        raise NotDerivableError(_why(robot, "its yaw rate depends on steering angles that change on the way"))
    angles = {p.name: signal(p.name.replace(".spin", ".angle")) for p in spins}
    omega = include(formula, angles, names)["omega"]
    text = "angle of the wheel about its axle since the heading was theta"
    inputs = (
        *(Port(p.name.replace(".spin", ".angle"), Role.STATE, "rad", text) for p in spins),
        POSE[2],
        *tunable_ports(robot),
    )
    outputs = ((POSE[2], add(signal("theta"), omega)),)
    return Formula(
        "heading", inputs, tuple(names.items), outputs, "heading from wheel angles, a holonomic relation"
    )


def _why(robot: Robot, reason: str) -> str:
    return f"{robot.name} has no heading function: {reason}"


def _sees_yaw(robot: Robot, contacts: list[Contact], components: list[Component]) -> bool:
    """True when the known rows contain the yaw rate, at nominal parameters."""
    nominal = {p.name: Poly.of(p.nominal) for p in robot.parameters}

    def value(p: Poly) -> float:
        found = fix(p, nominal).constant
        return float(found) if found is not None else 0.0

    rows = [r for c in contacts for r in ([1.0, 0.0, -value(c.by)], [0.0, 1.0, value(c.bx)])]
    rows += [[value(p) for p in c.row] for c in components]
    known = np.array(rows).reshape(-1, 3)
    return numeric_rank(known)[0] == numeric_rank(np.vstack([known, [0.0, 0.0, 1.0]]))[0]
