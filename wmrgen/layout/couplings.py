"""What couplings make of single wheels: groups that turn as one, and limits that all their members keep."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from wmrgen.errors import NotDerivableError, RobotFileError
from wmrgen.layout.records import Interval, Robot
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
        wheels = [robot.wheel(name) for name in coupling.wheels]
        group = robot.steer_group if coupling.joint == "steer" else robot.spin_group
        every = [w for w in robot.wheels if any(group[w.index] == group[k.index] for k in wheels)]
        steered = [w for w in every if w.kind.steers]
        castors = [w for w in every if w.kind.swivels]
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
        own = [robot.limit(wheels[k], quantity) for k in members]
        known = [limit for limit in own if limit is not None]
        if not known:
            continue
        common = Interval(max(limit.low for limit in known), min(limit.high for limit in known))
        if common.low > common.high:
            raise _nothing(spec, joint, quantity, [wheels[k].name for k in members])
        for k, limit in zip(members, own, strict=True):
            if limit != common:
                wheels[k] = replace(wheels[k], limits={**wheels[k].limits, quantity: common})
    return replace(robot, wheels=tuple(wheels))


def _coupled(robot: Robot) -> Iterator[tuple[str, str, list[int]]]:
    """Every limited quantity of every coupled group, with the joint that is coupled."""
    for joint, group in (("steer", robot.steer_group), ("spin", robot.spin_group)):
        for leader in sorted(set(group)):
            members = [k for k, g in enumerate(group) if g == leader]
            if len(members) > 1:
                yield from ((joint, quantity, members) for quantity in _LIMITED[joint])


def _nothing(spec: RobotSpec, joint: str, quantity: str, names: Sequence[str]) -> RobotFileError:
    mark = next(c.mark for c in spec.couplings if c.joint == joint and c.wheels[0] in names)
    return RobotFileError(
        f"the {quantity} limits of {' and '.join(names)} have no value in common", mark,
        "Coupled wheels turn as one.", "Write limits that overlap.",
    )  # fmt: skip
