"""`joints_from_counts`: what encoders count to the joint rates and angles that `forward` takes.

A turn of a joint is counts * gear counts, so that a difference of n counts in dt is the rate 2 pi n / (counts gear dt),
and a steering encoder that stands at 0 where steer is 0 shows the angle 2 pi n / (counts gear). Counters wrap: their
difference is a whole number of the counter's width, which is the caller's to take.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import sympy

from wmrgen.functions.motion.paths import SHORTEST
from wmrgen.functions.registry import function, underivable
from wmrgen.kinematics.pose import DT
from wmrgen.kinematics.records import Formula, Locals, joint_port
from wmrgen.kinematics.sensing import sensed_joints
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, maximum, number, signal, times

_DIFFERENCE = "counts since the last step, the difference of a counter that may wrap"
_COUNTERS = {  # joint -> its encoder, what is counted, whether it is a rate
    "spin": ("spin", _DIFFERENCE, True),
    "steer": ("steer", "counts of the steering encoder, 0 where steer is 0", False),
    "steer_rate": ("steer", _DIFFERENCE, True),
}


@function("ours; the texts have none")
def joints_from_counts(robot: Robot, _: Mobility) -> Formula:
    """Counts of encoders to the joint rates and angles that they show."""
    joints = [(w, joint) for w in robot.wheels for joint in _counted(w)]
    if not joints:
        raise underivable(
            robot,
            "joints_from_counts",
            "no wheel has an encoder; write encoder: {spin: {counts: 4096, gear: 30}}",
        )
    names = Locals()
    rate = names.define("per_time", 1 / maximum(signal("dt"), SHORTEST))
    counters, outputs = [], []
    for w, joint in joints:
        counters.append(counter_port(w, joint))
        outputs.append((joint_port(w, joint, Role.COMMAND), _angle(w, joint, rate)))
    timed = (replace(DT, text="duration of the step, above 0"),)
    text = "counts of encoders to the joint rates and angles that forward takes"
    dt = timed if any(_COUNTERS[joint][2] for _, joint in joints) else ()
    return names.formula("joints_from_counts", (*counters, *dt), outputs, text)


def counter_port(w: Wheel, joint: str) -> Port:
    """``<wheel>.<joint>_counts``, a whole number."""
    encoder, text, _ = _COUNTERS[joint]
    return Port(f"{w.name}.{joint}_counts", Role.COMMAND, "", text, bits=w.encoders[encoder].bits)


def _counted(w: Wheel) -> Iterator[str]:
    """The joints whose value an encoder shows: its own, and a steering rate where `forward` takes one."""
    for joint, (encoder, _, _) in _COUNTERS.items():
        if encoder in w.encoders and (joint != "steer_rate" or joint in sensed_joints(w)):
            yield joint


def _angle(w: Wheel, joint: str, rate: Expr) -> Expr:
    """The angle of the counts, over the time where they are a difference."""
    encoder, _, timed = _COUNTERS[joint]
    count = 2 * sympy.pi / number(w.encoders[encoder].turn)
    counts = signal(f"{w.name}.{joint}_counts")
    return times(count, rate, counts) if timed else times(count, counts)
