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
from wmrgen.kinematics.records import Formula, Locals, joint_port
from wmrgen.kinematics.sensing import sensed_joints
from wmrgen.layout.records import Encoder, Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import DT, Port, Role
from wmrgen.symbolic import maximum, number, signal, times

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
    rate = names.define("per_time", 1 / maximum(signal("dt"), SHORTEST))
    counters, outputs = [], []
    for w, joint, encoder in joints:
        name = f"{w.name}.{joint}_counts"
        counters.append(Port(name, Role.COMMAND, "", _COUNTERS[joint][1], bits=encoder.bits))
        angle = times(2 * sympy.pi / number(encoder.turn), signal(name))
        outputs.append(
            (joint_port(w, joint, Role.COMMAND), times(rate, angle) if _COUNTERS[joint][2] else angle)
        )
    step = replace(DT, text="duration of the step, above 0")
    text = "counts of encoders to the joint rates and angles that forward takes"
    dt = (step,) if any(_COUNTERS[joint][2] for _, joint, _ in joints) else ()
    return names.formula("joints_from_counts", (*counters, *dt), outputs, text)


def _counted(robot: Robot, w: Wheel) -> Iterator[tuple[str, Encoder]]:
    """The joints whose value an encoder shows: its own, and a steering rate where `forward` takes one."""
    for joint, (shows, _, _) in _COUNTERS.items():
        encoder = robot.encoder_of(w, shows)
        if encoder is not None and (joint != "steer_rate" or joint in sensed_joints(w)):
            yield joint, encoder
