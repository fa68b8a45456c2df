"""What couplings make of single wheels: groups that turn as one, and limits that all their members keep."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from wmrgen.errors import NotDerivableError, RobotFileError
from wmrgen.exact.number import ONE, Exact
from wmrgen.layout.expressions import Scope
from wmrgen.layout.joints import constant
from wmrgen.layout.records import Interval, Robot, Wheel
from wmrgen.spec.records import Quantity, RobotSpec

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


def spin_ratios(spec: RobotSpec, leaders: Sequence[int], scope: Scope) -> tuple[Exact, ...]:
    """Per wheel its spin for a spin of 1 of the wheel that leads its set. RobotFileError for a ratio of 0, and where
    couplings contradict each other."""
    names = [w.name for w in spec.wheels]
    turns = dict.fromkeys(leaders, ONE)
    rest = [c for c in spec.couplings if c.joint == "spin"]
    while rest:
        coupling = next(c for c in rest if any(names.index(n) in turns for n in c.wheels))
        rest.remove(coupling)
        ratios = [_ratio(q, scope) for q in coupling.ratios] or [ONE] * len(coupling.wheels)
        own = dict(zip(map(names.index, coupling.wheels), ratios, strict=True))
        shaft = next(turns[i] / k for i, k in own.items() if i in turns)
        for i, k in own.items():
            if turns.setdefault(i, shaft * k) != shaft * k:
                raise RobotFileError(
                    f"this coupling contradicts the other couplings of {names[i]}.spin", coupling.mark,
                    "Shafts that are geared together in two ratios cannot turn.", "Delete one of them.",
                )  # fmt: skip
    return tuple(turns[i] for i in range(len(names)))


def _ratio(quantity: Quantity, scope: Scope) -> Exact:
    value = constant("a ratio of the coupling", quantity, scope)
    if not value:
        raise RobotFileError(
            f"a ratio of the coupling is {quantity.text}", quantity.mark, "It is zero: that joint would stand still.",
            "Write the turns of the joint for one turn of the shaft.",
        )  # fmt: skip
    return value


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
        ratios = [robot.spin_ratio(w) if joint == "spin" else ONE for w in members]
        told = [
            (limit, k) for w, k in zip(members, ratios, strict=True) if (limit := robot.limit(w, quantity))
        ]
        if not told:
            continue
        limits = [limit.times(ONE / k) for limit, k in told]
        common = Interval(max(limit.low for limit in limits), min(limit.high for limit in limits))
        if common.low > common.high:
            mark = next(
                c.mark for c in spec.couplings if c.joint == joint and robot.wheel(c.wheels[0]) in members
            )
            raise RobotFileError(
                f"the {quantity} limits of {' and '.join(w.name for w in members)} have no value in common", mark,
                "Coupled wheels turn as one.", "Write limits that overlap.",
            )  # fmt: skip
        for w, k in zip(members, ratios, strict=True):
            if robot.limit(w, quantity) != (own := common.times(k)):
                wheels[w.index] = replace(wheels[w.index], limits={**wheels[w.index].limits, quantity: own})
    return replace(robot, wheels=tuple(wheels))


def _coupled(robot: Robot) -> Iterator[tuple[str, str, list[Wheel]]]:
    """Every limited quantity of every set of coupled wheels, with the joint that is coupled."""
    for joint, quantities in _LIMITED.items():
        for members in robot.together(joint, robot.wheels):
            if len(members) > 1:
                yield from ((joint, quantity, members) for quantity in quantities)
