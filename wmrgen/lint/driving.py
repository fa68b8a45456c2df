"""Joints that drive, steer or measure: too few, too many, or in one another's way."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from wmrgen.kinematics.sensing import generic_rank, measurements
from wmrgen.layout.records import Robot, Wheel
from wmrgen.lint.record import Finding, Subject, rule
from wmrgen.mobility.reasons import listed


def _first(subject: Subject) -> Wheel:
    return subject.robot.wheels[0]


@rule(
    "WMR020",
    "too few actuated joints",
    """Each freedom of the robot needs a joint that is driven, each freedom of steering one that is steered. With fewer
    the robot does not go where it is told: the rest of the motion is left to chance. Fixed, steered and Swedish wheels
    are driven unless the file says otherwise, castors are not.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1, actuated: [], sensed: [spin]}
""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
""",
)
def short(subject: Subject) -> Iterator[Finding]:
    if subject.mobility.degree_of_mobility:
        for sentence in subject.mobility.actuation:
            if "short by" in sentence:
                yield Finding(
                    subject.mark(_first(subject)), sentence, "Add joints to actuated: [spin, steer]."
                )


@rule(
    "WMR021",
    "more actuated joints than freedoms, and not of all like wheels",
    """Where more joints are driven than the robot has freedoms, their rates must agree, or wheels slide. That is usual
    where all wheels of a kind are driven, as four mecanum wheels are. Where some are and others not, an entry of
    actuated is likely missing or too many.""",
    """
wheels:
  - {name: front_left,  type: steered, x: 0.3,  y: 0.2,  heading: 0, r: 0.1}
  - {name: front_right, type: steered, x: 0.3,  y: -0.2, heading: 0, r: 0.1}
  - {name: back_left,   type: steered, x: -0.3, y: 0.2,  heading: 0, r: 0.1}
  - {name: back_right,  type: steered, x: -0.3, y: -0.2, heading: 0, r: 0.1, actuated: [steer]}
""",
    """
wheels:
  - {name: front_left,  type: steered, x: 0.3,  y: 0.2,  heading: 0, r: 0.1}
  - {name: front_right, type: steered, x: 0.3,  y: -0.2, heading: 0, r: 0.1}
  - {name: back_left,   type: steered, x: -0.3, y: 0.2,  heading: 0, r: 0.1}
  - {name: back_right,  type: steered, x: -0.3, y: -0.2, heading: 0, r: 0.1}
""",
)
def uneven(subject: Subject) -> Iterator[Finding]:
    for sentence in subject.mobility.actuation:
        joint = "spin" if sentence.startswith("driving") else "steer"
        for alike in _alike(subject.robot, joint) if "beyond need" in sentence else ():
            idle = [w for w in alike if joint not in w.actuated]
            if 0 < len(idle) < len(alike) - len(idle):
                yield Finding(
                    subject.mark(idle[0]),
                    f"{sentence}; {listed([w.name for w in idle])} alone of the {idle[0].kind.noun}s "
                    f"{'is' if len(idle) == 1 else 'are'} not driven",
                    f"Write {joint} in actuated of all of them, or of as many as are needed.",
                )


def _alike(robot: Robot, joint: str) -> list[list[Wheel]]:
    """The wheels that have the joint, by type."""
    types: dict[str, list[Wheel]] = {}
    for w in robot.wheels:
        if joint in w.kind.joints:
            types.setdefault(w.type, []).append(w)
    return list(types.values())


@rule(
    "WMR022",
    "odometry lacks a sensor",
    """The sensed joints do not tell the whole twist, though the wheels would if all their joints were sensed: `forward`
    and `odometry` give the smallest twist that fits. What is actuated is sensed unless the file says otherwise.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1, sensed: []}
""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
""",
)
def unsensed(subject: Subject) -> Iterator[Finding]:
    robot = subject.robot
    every = replace(robot, wheels=tuple(replace(w, sensed=w.kind.joints) for w in robot.wheels))
    seen, possible = _seen(robot), _seen(every)
    if seen < possible:
        blind = [w for w in robot.wheels if set(w.kind.joints) - set(w.sensed)]
        yield Finding(
            subject.mark(blind[0]),
            f"the sensed joints tell {seen} of the 3 components of the twist, all joints would tell {possible}",
            f"Write sensed: [{', '.join(blind[0].kind.joints)}] where there is a sensor: "
            f"{listed([w.name for w in blind])} {'lacks' if len(blind) == 1 else 'lack'} one.",
        )


def _seen(robot: Robot) -> int:
    """How many components of the twist the sensed joints tell."""
    measured = measurements(robot)
    return generic_rank(measured) if measured.all else 0
