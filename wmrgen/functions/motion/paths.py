"""Motion under constant joint rates: `motion`, `circle` and `heading`; and the twist to a pose: `reach`.

At constant steering angles a robot drives a straight line or a circle (Konstantinov, case of constant speeds):

    radius = |v| / |omega|,   centre = P + z x v / omega,   period = 2 pi / |omega|

On a straight line the radius is infinite. Here it is limited to `FARTHEST`, with the centre that far to the left, so
that every output is finite and continuous. ``turns`` distinguishes the two cases.

If the yaw rate is a constant combination of wheel speeds, it integrates to a holonomic relation: phi = phi0 -
(r/3a)(psi1 + psi2 + psi3) (Konstantinov (6)), or phi = phi0 + r (theta_r - theta_l) / 2a for the differential drive
(Tzafestas (2.36c)).

`reach` is the inverse of `wmrgen.analysis.kinematics.pose` (SE(2) logarithm). The chord of the arc points along theta
/ 2 and is dt sinc(theta / 2) times the velocity, so

    v = R(-theta / 2) (x, y) / (dt sinc(theta / 2)),   omega = theta / dt
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import sympy

from wmrgen.analysis.kinematics.forward import forward
from wmrgen.analysis.kinematics.pose import SHORTEST, arc
from wmrgen.analysis.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.analysis.kinematics.sensing import measurements
from wmrgen.analysis.mobility.ranks import numeric_rank, unit_of
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.exact.evaluate import number as nominal_number
from wmrgen.geometry.exact.poly import Poly, Row, triple
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import DT, POSE, TWIST, TWIST_NAMES, Port, Role, output
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    local,
    maximum,
    norm,
    over,
    rotated_back,
    select,
    signal,
    times,
)

FARTHEST = sympy.Integer(10**9)  # [m] a path with a larger radius is treated as straight
SLOWEST = sympy.Rational(1, 10**12)  # [rad/s], [m/s]: a smaller yaw rate or speed is treated as 0


def sign(a: Expr) -> Expr:
    """Return -1 if a < 0, else 1."""
    return select(a, sympy.S.Zero, sympy.S.NegativeOne, sympy.S.One)


def named_twist(outputs: Mapping[str, Expr], suffix: str, names: Locals) -> tuple[Expr, Expr, Expr]:
    """Return the twist among outputs as intermediate results ``<name>_<suffix>``; a zero needs no name.

    Args:
        outputs: Values by name, among them vx, vy and omega.
        suffix: The end of the names.
        names: Takes the intermediate results.
    """
    return triple(
        value if (value := outputs[name]) is sympy.S.Zero else names.define(f"{name}_{suffix}", value)
        for name in TWIST_NAMES
    )


def sensed_twist(robot: Robot, names: Locals) -> tuple[tuple[Port, ...], tuple[Expr, Expr, Expr]]:
    """Return the sensed spins and steering angles, and the twist in the robot frame that they drive.

    Steering rates are zero, because a constant command keeps every steering angle.
    """
    formula = forward(robot)
    held = {p.name: sympy.S.Zero for p in formula.inputs if p.name.endswith(".steer_rate")}
    twist = named_twist(names.adopt(formula, held), "driven", names)
    return tuple(p for p in formula.inputs if p.name not in held and p.role is not Role.GEOMETRY), twist


@function("Konstantinov, case of constant speeds; Tzafestas (2.36), (2.38) integrated")
def motion(robot: Robot, _: Mobility) -> Formula:
    """Return the exact pose after constant joint rates for dt: the end of a straight line or an arc."""
    names = Locals()
    joints, twist = sensed_twist(robot, names)
    step = arc()
    end = names.adopt(step, dict(zip(TWIST_NAMES, twist, strict=True)))
    return names.formula(
        "motion",
        (*joints, *POSE, step.inputs[-1], *tunable_ports(robot)),
        ((port, end[port.name]) for port in POSE),
        "pose after constant joint rates for dt, at constant steering angles",
    )


CIRCLE = (
    output("turns", "", "1 a circle counter-clockwise, -1 clockwise, 0 a straight line or standstill"),
    output("x_centre", "m", "centre of the circle, world frame"),
    output("y_centre", "m", "centre of the circle, world frame"),
    output("radius", "m", "radius of the circle of P, at most 1e9: a straight line"),
    output("curvature", "1/m", "yaw rate over speed of P, at most 1e9 in size: turning on the spot"),
    output("period", "s", "time of one full circle"),
    output("speed", "m/s", "speed of P"),
    output("direction", "rad", "direction of motion of P, from x of the robot"),
)


@function("Konstantinov, x_C, y_C and R (corrected); Tzafestas (2.43)")
def circle(robot: Robot, _: Mobility) -> Formula:
    """Return the circle or straight line that sensed joint rates drive from a pose."""
    names = Locals()
    joints, twist = sensed_twist(robot, names)
    values = path(twist, names)
    direction = names.define("direction_left", add(signal("theta"), values["direction"]))
    to_centre = names.define("reach", times(sign(twist[2]), values["radius"]))
    values["x_centre"] = add(signal("x"), times(-1, to_centre, sympy.sin(direction)))
    values["y_centre"] = add(signal("y"), times(to_centre, sympy.cos(direction)))
    return names.formula(
        "circle",
        (*joints, *POSE, *tunable_ports(robot)),
        ((port, values[port.name]) for port in CIRCLE),
        "circle or straight line that constant joint rates drive, at constant steering angles",
    )


def path(twist: tuple[Expr, Expr, Expr], names: Locals) -> dict[str, Expr]:
    """Return turns, radius, curvature, period, speed and direction of a twist."""
    vx, vy, omega = twist
    speed = names.define("speed_of_path", norm(vx, vy))
    rate = names.define("rate_of_path", absolute(omega))
    straight = maximum(over(speed, FARTHEST), SLOWEST)
    turning = names.define("turning", maximum(rate, straight))
    moving = names.define("moving", maximum(speed, maximum(over(rate, FARTHEST), SLOWEST)))
    return {
        "turns": select(straight, rate, sign(omega), sympy.S.Zero),
        "radius": over(speed, turning),
        "curvature": over(omega, moving),
        "period": over(2 * sympy.pi, names.define("turning_kept", maximum(rate, SLOWEST))),
        "speed": speed,
        "direction": angle_of(vy, vx),
    }


@function("Siegwart figures 3.15 and 3.16, the twist of a segment")
def reach(_: Robot, __: Mobility) -> Formula:
    """Return the constant twist that displaces the robot by x y theta in dt, robot frame."""
    names = Locals()
    x, y, theta, dt = (signal(n) for n in ("x", "y", "theta", "dt"))
    # Unit speed for unit time along the same arc: its chord is sinc(theta / 2), series and switch point included.
    unit = {n: sympy.Integer(n in ("vx", "dt")) for n in ("x", "y", "theta", "vx", "vy", "dt")}
    names.adopt(arc(), unit | {"omega": theta})
    sinc, h = local("chord"), local("half_turn")
    c, s = names.define("cos_half", sympy.cos(h)), names.define("sin_half", sympy.sin(h))
    time = names.define("time_kept", maximum(dt, SHORTEST))
    scale = names.define("scale", over(sympy.S.One, times(time, maximum(sinc, SHORTEST))))
    vx, vy = (times(scale, v) for v in rotated_back(c, s, x, y))
    inputs = (
        Port("x", Role.COMMAND, "m", "forward, robot frame at the start"),
        Port("y", Role.COMMAND, "m", "to the left, robot frame at the start"),
        Port("theta", Role.COMMAND, "rad", "change of the heading, at most pi in size"),
        replace(DT, text="duration of the motion, above 0"),
    )
    return names.formula(
        "reach",
        inputs,
        zip(TWIST, (vx, vy, over(theta, time)), strict=True),
        "constant twist that displaces the robot by x y theta in dt",
    )


@function("Konstantinov (6); Tzafestas (2.36)")
def heading(robot: Robot, _: Mobility) -> Formula:
    """Return the present heading from the angles that the wheels have turned since the heading was theta."""
    robot = replace(robot, gyro=None)  # its angle is not an angle of a wheel
    measured = measurements(robot)
    if not measured.constant_normal:
        raise underivable(
            robot,
            "heading function",
            "its yaw rate depends on joint angles that change during the motion",
            Reason.UNOBSERVABLE,
        )
    if not _sees_yaw(robot, [row for row, _, _ in measured.rows]):
        raise underivable(
            robot,
            "heading function",
            "the sensed wheel speeds do not determine its yaw rate",
            Reason.UNOBSERVABLE,
        )
    formula, names = forward(robot), Locals()
    joints = {signal(p.name) for p in formula.inputs if p.name.endswith((".steer", ".steer_rate"))}
    if joints & formula.closed()["omega"].free_symbols:
        raise underivable(
            robot,
            "heading function",
            "its yaw rate depends on steering angles that change during the motion",
            Reason.UNOBSERVABLE,
        )
    text = "angle of the wheel about its axle since the heading was theta"
    angles = {
        p.name: Port(p.name.replace(".spin", ".angle"), Role.STATE, "rad", text)
        for p in formula.inputs
        if p.name.endswith(".spin")
    }
    omega = names.adopt(formula, {spin: signal(angle.name) for spin, angle in angles.items()})["omega"]
    return names.formula(
        "heading",
        (*angles.values(), POSE[2], *tunable_ports(robot)),
        ((POSE[2], add(signal("theta"), omega)),),
        "heading from wheel angles, a holonomic relation",
    )


def _sees_yaw(robot: Robot, rows: list[Row]) -> bool:
    """Return whether the measured rows determine the yaw rate, at nominal parameters and in the robot's own unit."""
    nominal = {p.name: Poly.of(p.nominal) for p in robot.parameters}
    own = [unit_of(robot).own_row(row) for row in rows]
    measured = np.array([[float(nominal_number(p, nominal)) for p in row] for row in own]).reshape(-1, 3)
    return numeric_rank(measured)[0] == numeric_rank(np.vstack([measured, [0.0, 0.0, 1.0]]))[0]
