"""Odometry over many steps: `odometry_increment`, what a step adds to the pose, `odometry_compensated`, and
`odometry_from_angles`, for sensors that give positions: the angles that wheels turned take the place of their rates
over the time, so that a step is exact at constant rates whatever it lasted.

`odometry` gives the pose after a step. In float it stands still where a step is less than half a unit in the last
place of the pose: at 100 m that is 3.8 um, the way of 3 mm/s in 1.3 ms. Whoever has a double to add in adds the
increments of each step there; only theta is needed to compute them.

`odometry_compensated` stays in float and carries, beside the pose, what its last roundings lost (Kahan; Higham 4.3):

    s = step + rest    x' = fl(x + s)    rest' = (x + s) - x'

The last is a float and computed without error (Knuth's TwoSum), whatever the sizes. The heading is kept in [-pi, pi]: a
step takes off one turn at most, in two parts, 201/32, which leaves nothing to round, and the rest of 2 pi.

`joints_from_counts` makes of what encoders count the joint rates and angles that `forward` takes. A turn of a joint is
counts * gear counts, so that a difference of n counts in dt is the rate 2 pi n / (counts gear dt), and a steering
encoder that stands at 0 where steer is 0 shows the angle 2 pi n / (counts gear). Counters wrap: their difference is a
whole number of the counter's width, which is the caller's to take.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import sympy

from wmrgen.functions.registry import function, underivable
from wmrgen.kinematics.forward import forward
from wmrgen.kinematics.pose import increments, odometry, rate_per_change
from wmrgen.kinematics.records import Formula, Locals, joint_port
from wmrgen.kinematics.sensing import sensed_joints
from wmrgen.layout.records import Encoder, Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import DT, POSE, TWIST, Limits, Port, Role, output
from wmrgen.symbolic import (
    Compensated,
    Expr,
    add,
    number,
    rounding_error,
    select,
    signal,
    subtract,
    times,
)

_INCREMENTS = (
    output("x_step", "m", "what the step adds to x"),
    output("y_step", "m", "what the step adds to y"),
    output("theta_step", "rad", "what the step adds to theta"),
)


@function("Konstantinov, case of constant speeds; sinc near 0 is ours", limits=Limits.MEASURED)
def odometry_increment(_: Robot, __: Mobility) -> Formula:
    """What a step at constant twist adds to x, y and theta, in the world frame."""
    names = Locals()
    outputs = zip(_INCREMENTS, increments(names), strict=True)
    text = "what driving a constant twist for dt adds to the pose, world frame"
    return names.formula("odometry_increment", (POSE[2], *TWIST, DT), outputs, text)


_RESTS = tuple(
    Port(f"{p.name}_rest", Role.STATE, p.unit, f"what roundings have left out of {p.name}; 0 at the start")
    for p in POSE
)
_MOST_OF_TURN = sympy.Rational(201, 32)  # 2 pi less 0.0019, in eight bits


@function("Konstantinov, case of constant speeds; Higham 4.3; the rest is ours", limits=Limits.MEASURED)
def odometry_compensated(_: Robot, __: Mobility) -> Formula:
    """The pose after a step, with what its roundings lost; the heading in [-pi, pi]."""
    names = Locals()
    sums, rests = [], []
    for port, rest, step in zip(POSE, _RESTS, increments(names), strict=True):
        whole = names.define(f"{port.name}_whole_step", add(step, signal(rest.name)))
        sums.append(names.define(f"{port.name}_sum", Compensated(signal(port.name), whole)))
        rests.append(rounding_error(signal(port.name), whole))
    sums[2], lost = _wrapped(sums[2], names)
    rests[2] = add(rests[2], lost)
    outputs = (*zip(POSE, sums, strict=True), *zip(_RESTS, rests, strict=True))
    text = "pose after driving a constant twist for dt, with what its roundings lost; heading in [-pi, pi]"
    return names.formula("odometry_compensated", (*POSE, *_RESTS, *TWIST, DT), outputs, text)


def _wrapped(theta: Expr, names: Locals) -> tuple[Expr, Expr]:
    """An angle less a turn, where it lies beyond half a turn, and what its rounding lost."""
    most, zero = _MOST_OF_TURN, sympy.S.Zero
    little = 2 * sympy.pi - most

    def by_side(above: Expr, below: Expr, between: Expr) -> Expr:
        return select(sympy.pi, theta, above, select(theta, -sympy.pi, below, between))

    near = names.define("theta_near", by_side(subtract(theta, most), add(theta, most), theta))
    last = names.define("theta_last", by_side(-little, little, zero))
    return Compensated(near, last), rounding_error(near, last)


_STEPS = {
    "spin": ("spin_step", "angle that the wheel turned about its axle since the last step"),
    "steer_rate": ("steer_step", "angle that the wheel was steered since the last step, counter-clockwise"),
}


@function("Siegwart (3.24), (3.26); Konstantinov, case of constant speeds", limits=Limits.MEASURED)
def odometry_from_angles(robot: Robot, _: Mobility) -> Formula:
    """The pose after a step in which sensed wheels turned by these angles, each at its constant rate."""
    names, measured = Locals(), forward(robot)
    steps = {p.name: _as_step(p) for p in measured.inputs}
    values = names.adopt(measured, {name: signal(port.name) for name, port in steps.items()})
    twist = {p.name: names.define(f"{p.name}_step", values[p.name]) for p in TWIST}
    after = names.adopt(odometry(), {**twist, "dt": sympy.S.One})
    return names.formula(
        "odometry_from_angles",
        (*POSE, *steps.values()),
        ((p, after[p.name]) for p in POSE),
        "pose after wheels turned by these angles, at present steering angles",
    )


def _as_step(port: Port) -> Port:
    """The angle in place of a rate; other ports as they are."""
    wheel, _, joint = port.name.rpartition(".")
    if joint not in _STEPS:
        return port
    name, text = _STEPS[joint]
    return Port(f"{wheel}.{name}", Role.COMMAND, "rad", text)


_DIFFERENCE = "counts since the last step, the difference of a counter that may wrap"
_COUNTERS = {  # joint -> its encoder, what is counted, whether it is a rate
    "spin": ("spin", _DIFFERENCE, True),
    "steer": ("steer", "counts of the steering encoder, 0 where steer is 0", False),
    "steer_rate": ("steer", _DIFFERENCE, True),
}


@function("ours; the texts have none")
def joints_from_counts(robot: Robot, _: Mobility) -> Formula:
    """Counts of encoders to the joint rates and angles that they show."""
    joints = [(w, joint, encoder) for w in robot.wheels for joint, encoder in _counted(robot, w)]
    if not joints:
        raise underivable(
            robot,
            "joints_from_counts",
            "no wheel has an encoder; write encoder: {spin: {counts: 4096, gear: 30}}",
        )
    names = Locals()
    rate = names.define("per_time", rate_per_change(signal("dt")))
    counters, outputs = [], []
    for w, joint, encoder in joints:
        name = f"{w.name}.{joint}_counts"
        counters.append(Port(name, Role.COMMAND, "", _COUNTERS[joint][1], bits=encoder.bits))
        angle = times(2 * sympy.pi / number(encoder.turn), signal(name))
        outputs.append(
            (joint_port(w, joint, Role.COMMAND), times(rate, angle) if _COUNTERS[joint][2] else angle)
        )
    step = replace(DT, text="duration of the step; without any, rates are 0")
    text = "counts of encoders to the joint rates and angles that forward takes"
    dt = (step,) if any(_COUNTERS[joint][2] for _, joint, _ in joints) else ()
    return names.formula("joints_from_counts", (*counters, *dt), outputs, text)


def _counted(robot: Robot, w: Wheel) -> Iterator[tuple[str, Encoder]]:
    """The joints whose value an encoder shows: its own, and a steering rate where `forward` takes one."""
    for joint, (shows, _, _) in _COUNTERS.items():
        encoder = robot.encoder_of(w, shows)
        if encoder is not None and (joint != "steer_rate" or joint in sensed_joints(w)):
            yield joint, encoder
