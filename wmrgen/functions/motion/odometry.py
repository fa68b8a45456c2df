"""Odometry over many steps: increments, compensated sums, and sensors that count angles.

`odometry_increment` returns the change of the pose in a step. `odometry` returns the pose after a step; in float the
pose does not change if the step is less than half a unit in its last place. At 100 m that is 3.8 um, the distance that
3 mm/s covers in 1.3 ms. A caller with a double adds the increments of each step to it; only theta is needed to compute
them.

`odometry_compensated` uses float only. With the pose it stores the rounding errors of the last sums (Kahan; Higham
4.3):

    s = step + rest    x' = fl(x + s)    rest' = (x + s) - x'

The new rest is a float and is computed without error (Knuth's TwoSum), for operands of any size. The heading is in
[-pi, pi]. A step removes at most one turn, in two parts: 201/32, which is exact, and the rest of 2 pi.

`odometry_from_angles` is for sensors of angles. The angles that wheels turned replace their rates times dt, so a step
at constant rates is exact for any duration. Wheels that steer during the step are evaluated at the middle of their
angles before and after it; the error is of second order in the change of the angle.

`joints_from_counts` converts encoder counts to the joint rates and angles that `forward` takes. A turn of a joint is
counts * gear counts, so a difference of n counts in dt is the rate 2 pi n / (counts gear dt). It adds the angle 2 pi n
/ (counts gear) to a steering angle, which is rounded to whole counts, so steps add up without error. The counts of an
absolute encoder from its offset are the angle itself. Readings wrap: differences are differences of whole numbers,
which the caller computes.
"""

from __future__ import annotations

from dataclasses import replace

import sympy

from wmrgen.analysis.kinematics.forward import forward
from wmrgen.analysis.kinematics.pose import increments, odometry, rate_per_change, wrapped
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port
from wmrgen.analysis.kinematics.sensing import sensed_joints
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.layout.records import Encoder, Robot, Wheel
from wmrgen.geometry.ports import DT, GYRO, POSE, TWIST, Limits, Port, Role, output
from wmrgen.geometry.symbolic import (
    Compensated,
    Expr,
    Nearest,
    add,
    number,
    rounding_error,
    select,
    signal,
    subtract,
    times,
)

_INCREMENTS = (
    output("x_step", "m", "change of x in the step"),
    output("y_step", "m", "change of y in the step"),
    output("theta_step", "rad", "change of theta in the step"),
)


@function("Konstantinov, case of constant speeds; sinc near 0 is ours", limits=Limits.MEASURED)
def odometry_increment(_: Robot, __: Mobility) -> Formula:
    """Return the change of x, y and theta in a step at constant twist, in the world frame."""
    names = Locals()
    outputs = zip(_INCREMENTS, increments(names), strict=True)
    text = "change of the pose after driving a constant twist for dt, world frame"
    return names.formula("odometry_increment", (POSE[2], *TWIST, DT), outputs, text)


_RESTS = tuple(
    Port(f"{p.name}_rest", Role.STATE, p.unit, f"rounding error of {p.name}; 0 at the start") for p in POSE
)
_MOST_OF_TURN = sympy.Rational(201, 32)  # [rad] 2 pi less 0.0019: eight bits, so that subtracting it is exact


@function("Konstantinov, case of constant speeds; Higham 4.3; the rest is ours", limits=Limits.MEASURED)
def odometry_compensated(_: Robot, __: Mobility) -> Formula:
    """Return the pose after a step with its rounding errors; the heading is in [-pi, pi]."""
    names = Locals()
    sums, rests = [], []
    for port, rest, step in zip(POSE, _RESTS, increments(names), strict=True):
        whole = names.define(f"{port.name}_whole_step", add(step, signal(rest.name)))
        sums.append(names.define(f"{port.name}_sum", Compensated(signal(port.name), whole)))
        rests.append(rounding_error(signal(port.name), whole))
    sums[2], lost = _wrapped(sums[2], names)
    rests[2] = add(rests[2], lost)
    outputs = (*zip(POSE, sums, strict=True), *zip(_RESTS, rests, strict=True))
    text = "pose after driving a constant twist for dt, with its rounding errors; heading in [-pi, pi]"
    return names.formula("odometry_compensated", (*POSE, *_RESTS, *TWIST, DT), outputs, text)


def _wrapped(theta: Expr, names: Locals) -> tuple[Expr, Expr]:
    """Return an angle less a turn, if it is beyond half a turn, and the error of its rounding."""
    most, zero = _MOST_OF_TURN, sympy.S.Zero
    little = 2 * sympy.pi - most

    def by_side(above: Expr, below: Expr, between: Expr) -> Expr:
        return select(sympy.pi, theta, above, select(theta, -sympy.pi, below, between))

    near = names.define("theta_near", by_side(subtract(theta, most), add(theta, most), theta))
    last = names.define("theta_last", by_side(-little, little, zero))
    return Compensated(near, last), rounding_error(near, last)


_LAST = "at the last step"
_STEP = "that the wheel turned about its axle since the last step"


@function("Siegwart (3.24), (3.26); Konstantinov, case of constant speeds", limits=Limits.MEASURED)
def odometry_from_angles(robot: Robot, _: Mobility) -> Formula:
    """Return the pose after a step in which sensed wheels turned by these angles at constant rates."""
    names, measured = Locals(), forward(robot)
    ports: list[Port] = []
    values: dict[str, Expr] = {}
    for p in measured.inputs:
        wheel, dot, joint = p.name.rpartition(".")
        if p.name == GYRO.name:
            ports.append(
                Port("gyro_step", Role.COMMAND, "rad", "integral of the yaw-rate sensor since the last step")
            )
            values[p.name] = signal("gyro_step")
        elif not dot:
            ports.append(p)
        elif joint == "spin":
            ports.append(Port(f"{wheel}.spin_step", Role.COMMAND, "rad", f"angle {_STEP}"))
            values[p.name] = signal(ports[-1].name)
        elif joint == "steer":
            last = replace(p, name=f"{p.name}_last", text=f"{p.text}, {_LAST}")
            ports += [p, last]
            turned = wrapped(names.define(f"{wheel}_apart", subtract(signal(p.name), signal(last.name))))
            turned = names.define(f"{wheel}_turned", turned)
            values[p.name] = names.define(
                f"{wheel}_middle", add(signal(last.name), times(turned, sympy.S.Half))
            )
            values[f"{wheel}.steer_rate"] = turned
    fitted = names.adopt(measured, values)
    twist = {p.name: names.define(f"{p.name}_step", fitted[p.name]) for p in TWIST}
    after = names.adopt(odometry(), {**twist, "dt": sympy.S.One})
    return names.formula(
        "odometry_from_angles",
        (*POSE, *ports),
        ((p, after[p.name]) for p in POSE),
        "pose after wheels turned by these angles while they steered from the last to the present steering angles",
    )


_DIFFERENCE = "counts since the last step, the difference of a reading that may wrap"
_FROM_OFFSET = "counts from the offset of the absolute encoder, the difference of a reading that may wrap"


@function("ours; the texts have none", in_place=True, reads=("encoder",))
def joints_from_counts(robot: Robot, _: Mobility) -> Formula:
    """Return joint rates and angles from the counts of encoders."""
    names = Locals()
    step = replace(DT, text="duration of the step; rates are 0 if it is 0")
    per_time = names.define("per_time", rate_per_change(signal("dt")))
    states: list[Port] = []
    counts: list[Port] = []
    outputs: list[tuple[Port, Expr]] = []

    def counted(w: Wheel, joint: str, encoder: Encoder, text: str) -> Expr:
        """Return the angle of an input that gives counts of ``joint`` [rad]."""
        port = Port(f"{w.name}.{joint}_counts", Role.COMMAND, "", text, reading=encoder.reading)
        counts.append(port)
        return times(_radians_of(encoder), signal(port.name))

    for w in robot.wheels:
        spin, steer = (robot.encoder_of(w, joint) for joint in ("spin", "steer"))
        if spin is not None:
            angle = counted(w, "spin", spin, _DIFFERENCE)
            outputs.append((joint_port(w, "spin", Role.COMMAND), times(per_time, angle)))
        if steer is None:
            continue
        has_rate = "steer_rate" in sensed_joints(w)
        if steer.reading.offset is None:
            angle = counted(w, "steer", steer, _DIFFERENCE)
            states.append(joint_port(w, "steer", Role.STATE))
            shown = _advanced_by_counts(w, steer)
        else:
            shown = counted(w, "steer", steer, _FROM_OFFSET)
            angle = counted(w, "steer_rate", steer, _DIFFERENCE) if has_rate else sympy.S.Zero
        outputs.append((joint_port(w, "steer", Role.COMMAND), shown))
        if has_rate:
            outputs.append((joint_port(w, "steer_rate", Role.COMMAND), times(per_time, angle)))
    if not outputs:
        why = "no wheel has an encoder; write encoder: {spin: {counts: 4096, gear: 30}}"
        raise underivable(robot, "joints_from_counts", why, Reason.NO_ENCODER)
    timed = any(port.unit == "rad/s" for port, _ in outputs)
    text = "counts of encoders to the joint rates and angles that forward takes"
    return names.formula("joints_from_counts", (*states, *counts, *([step] if timed else [])), outputs, text)


def _radians_of(encoder: Encoder) -> Expr:
    """Return the angle of a joint per count [rad]."""
    return 2 * sympy.pi / number(encoder.turn)


def _advanced_by_counts(w: Wheel, encoder: Encoder) -> Expr:
    """Return the last angle plus the new counts, rounded to whole counts, so that rounding errors do not add up.

    In float this is exact up to two million counts from 0: three roundings of the quotient are then below half a
    count.
    """
    turned = times(number(encoder.turn) / (2 * sympy.pi), signal(f"{w.name}.steer"))
    return times(_radians_of(encoder), add(Nearest(turned), signal(f"{w.name}.steer_counts")))
