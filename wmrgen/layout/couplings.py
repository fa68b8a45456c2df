"""What couplings make of single wheels: groups that turn as one, and limits that all their members keep."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from wmrgen.errors import NotDerivableError, RobotFileError
from wmrgen.layout.records import Interval, Robot, Wheel
from wmrgen.spec.records import RobotSpec

_LIMITED = {"steer": ("steer", "steer_rate"), "spin": ("spin",)}


def groups(spec: RobotSpec, joint: str) -> tuple[int, ...]:
    """Union of the coupled sets: per wheel the lowest index it is coupled to."""
    names = [w.name for w in spec.wheels]
    leader = list(range(len(names)))
    for coupling in spec.couplings:
        if coupling.joint != joint:
            continue
        members = {leader[names.index(n)] for n in coupling.wheels}
        leader = [min(members) if k in members else k for k in leader]
    return tuple(leader)


def refuse_unmodelled(spec: RobotSpec, robot: Robot) -> None:
    """NotDerivableError for couplings through which the body's motion would depend on steering rates or on castors.

    A steered wheel chooses its angle freely, at a rate of its own; a castor's angle and rate follow from the motion.
    """
    for coupling in spec.couplings:
        sets = robot.together(coupling.joint, robot.wheels)
        members = next(s for s in sets if robot.wheel(coupling.wheels[0]) in s)
        steered = [w for w in members if w.kind.steers]
        castors = [w for w in members if w.kind.swivels]
        offset = [w for w in steered if w.nominal.o]
        joint = coupling.joint
        if steered and castors:
            what = (
                f"{castors[0].name}.{joint} cannot be coupled to {steered[0].name}.{joint}: "
                f"the swivel angle of the castor {castors[0].name} follows from the motion, "
                f"the angle of the steered wheel {steered[0].name} is chosen"
            )
            raise NotDerivableError(
                f"{what}\nCouple castors with castors, or write one of the two as the other type.",
                coupling.mark,
            )
        if offset and joint == "spin":
            raise NotDerivableError(
                f"{offset[0].name}.spin cannot be coupled: {offset[0].name} is steered and has an offset_y, so that "
                "it also turns while it is steered, and steering alone would move the robot\n"
                f"Leave {offset[0].name}.spin out of the coupling, or set its offset_y to 0.",
                coupling.mark,
            )


def common_limits(spec: RobotSpec, robot: Robot) -> Robot:
    """``robot`` with coupled wheels that keep the limits of all of their group.

    RobotFileError where they have no value in common.
    """
    wheels = list(robot.wheels)
    for joint, quantity, members in _coupled(robot):
        limits = [limit for w in members if (limit := robot.limit(w, quantity))]
        if not limits:
            continue
        common = Interval(max(limit.low for limit in limits), min(limit.high for limit in limits))
        if common.low > common.high:
            mark = next(
                c.mark for c in spec.couplings if c.joint == joint and robot.wheel(c.wheels[0]) in members
            )
            raise RobotFileError(
                f"the {quantity} limits of {' and '.join(w.name for w in members)} have no value in common", mark,
                "Coupled wheels turn as one.", "Write limits that overlap.",
            )  # fmt: skip
        for w in members:
            if robot.limit(w, quantity) != common:
                k = w.index
                wheels[k] = replace(wheels[k], limits={**wheels[k].limits, quantity: common})
    return replace(robot, wheels=tuple(wheels))


def _coupled(robot: Robot) -> Iterator[tuple[str, str, list[Wheel]]]:
    """Every limited quantity of every set of coupled wheels, with the joint that is coupled."""
    for joint, quantities in _LIMITED.items():
        for members in robot.together(joint, robot.wheels):
            if len(members) > 1:
                yield from ((joint, quantity, members) for quantity in quantities)
