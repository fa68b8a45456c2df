"""What a robot file says of joints and commands, as exact constants: limits, weights, deadband, noise, lag;
and what couplings make of single wheels."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from wmrgen.errors import ErrorCollector, NotDerivableError, RobotFileError
from wmrgen.geometry.exact.evaluate import parameters_in, substituted
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.layout.expressions import Scope
from wmrgen.geometry.layout.records import Gyro, Interval, Noise, Robot, Wheel
from wmrgen.robotfile.records import Coupling, GyroSpec, Limit, NoiseSpec, Quantity, RobotSpec

MOST_WEIGHT = 1000  # of the least: rows that count less are lost in the rounding of a float


def constant(what: str, quantity: Quantity, scope: Scope) -> Exact:
    """The value of what no tunable parameter may move."""
    symbolic = scope.poly(quantity)
    names = sorted(parameters_in(substituted(symbolic, scope.constants)))
    if names:
        raise RobotFileError(
            f"{what} is {quantity.text}, which depends on the tunable parameter {names[0]}", quantity.mark,
            "It is a constant of the generated code and of its proved bounds.",
            f"Write a number, or delete tunable: true of {names[0]}.",
        )  # fmt: skip
    return scope.number(symbolic)


def limits_of(limits: Iterable[Limit], scope: Scope) -> dict[str, Interval]:
    """The limits in SI units. RobotFileError where low is above high, and for one that a tunable parameter moves."""
    collector, intervals = ErrorCollector(), {}
    for limit in limits:
        with collector:
            high, low = (constant(f"limit {limit.name}", end, scope) for end in (limit.high, limit.low))
            if low > high:
                raise RobotFileError(
                    f"limit {limit.name} runs from {limit.low.text} to {limit.high.text}", limit.mark,
                    "The lower end is above the upper end.",
                    f"Write {limit.name}: [low, high]; one positive value v means [-v, v].",
                )  # fmt: skip
            intervals[limit.name] = Interval(low, high)
    collector.end()
    return intervals


def weight_of(name: str, weight: Quantity, scope: Scope) -> Exact:
    """A positive constant, not so far from the 1 of other wheels that a float loses one of them."""
    value = constant(f"weight of {name}", weight, scope)
    if not 1 <= value * MOST_WEIGHT <= MOST_WEIGHT**2:
        raise RobotFileError(
            f"weight of {name} is {weight.text}, not between 1/{MOST_WEIGHT} and {MOST_WEIGHT}", weight.mark,
            "Weights are about (noise of other wheels / noise of this one)**2; rows that count next to nothing are "
            "lost in rounding.",
            "Write a number such as 0.25; sensed: [] leaves the wheel out.",
        )  # fmt: skip
    return value


def deadband_of(share: Quantity, scope: Scope) -> Exact:
    """A share of the limits of the twist, from 0 to below 1."""
    value = constant("deadband", share, scope)
    if not ZERO <= value < ONE:
        raise RobotFileError(
            f"deadband is {share.text}, not from 0 to below 1", share.mark,
            "It is a share of the limits of vx, vy and omega; with all of them the robot would never move.",
            "Write a number such as deadband: 0.01.",
        )  # fmt: skip
    return value


def noise_of(noise: Iterable[NoiseSpec], scope: Scope) -> dict[str, Noise]:
    """Standard deviations in SI units. RobotFileError for one below 0."""

    def deviation(joint: str, part: str, quantity: Quantity | None) -> Exact:
        value = ZERO if quantity is None else constant(f"{part} of the noise of {joint}", quantity, scope)
        if quantity is not None and value.sign < 0:
            raise RobotFileError(
                f"{part} of the noise of {joint} is {quantity.text}, which is negative", quantity.mark,
                "It is a standard deviation.", "Write 0 or a positive value.",
            )  # fmt: skip
        return value

    return {
        n.joint: Noise(*(deviation(n.joint, part, getattr(n, part)) for part in ("proportional", "constant")))
        for n in noise
    }


def lag_of(whose: str, lag: Iterable[tuple[str, Quantity]], scope: Scope) -> dict[str, Exact]:
    """Time constants [s]. RobotFileError for one that is not positive."""
    instead = (
        "Write a time such as 150 ms, or delete the key: without a lag the angle is commanded by its rate."
    )
    return {j: positive(f"{j} lag of {whose}", time, scope, instead) for j, time in lag}


def positive(what: str, quantity: Quantity, scope: Scope, instead: str) -> Exact:
    """The value of a constant. RobotFileError where it is not positive; ``instead``: what to write."""
    value = constant(what, quantity, scope)
    if value.sign <= 0:
        raise RobotFileError(
            f"{what} is {quantity.text}, which is not positive", quantity.mark, "", instead
        )  # fmt: skip
    return value


def gyro_of(gyro: GyroSpec, scope: Scope) -> Gyro:
    """The yaw-rate sensor. RobotFileError for noise or a weight that no sensor has."""
    weight = ONE if gyro.weight is None else weight_of("the gyro", gyro.weight, scope)
    return Gyro(weight, noise_of([gyro.noise], scope)[gyro.noise.joint])


# ---- couplings: groups that turn as one, and limits that all their members keep

_LIMITED = {"steer": ("steer", "steer_rate", "steer_acceleration"), "spin": ("spin", "spin_rate")}


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


def turn_ratios(spec: RobotSpec, joint: str, leaders: Sequence[int], scope: Scope) -> tuple[Exact, ...]:
    """Return per wheel how far its joint turns for 1 rad of the wheel that leads its set.

    Args:
        joint: spin or steer.
        leaders: the index of the leading wheel, for each wheel.

    Raises:
        RobotFileError: for a ratio of 0, for steering angles that are neither equal nor opposite, and if couplings
            contradict each other.
    """
    names = [w.name for w in spec.wheels]
    turns = dict.fromkeys(leaders, ONE)
    rest = [c for c in spec.couplings if c.joint == joint]
    while rest:
        coupling = next(c for c in rest if any(names.index(n) in turns for n in c.wheels))
        rest.remove(coupling)
        ratios = [_ratio(q, scope) for q in coupling.ratios] or [ONE] * len(coupling.wheels)
        if joint == "steer" and coupling.ratios:
            _equal_or_opposite(coupling, ratios)
        own = dict(zip(map(names.index, coupling.wheels), ratios, strict=True))
        shaft = next(turns[i] / k for i, k in own.items() if i in turns)
        for i, k in own.items():
            if turns.setdefault(i, shaft * k) != shaft * k:
                raise RobotFileError(
                    f"this coupling contradicts the other couplings of {names[i]}.{joint}", coupling.mark,
                    "Shafts that are geared together in two ratios cannot turn.", "Delete one of them.",
                )  # fmt: skip
    return tuple(turns[i] for i in range(len(names)))


def _equal_or_opposite(coupling: Coupling, ratios: Sequence[Exact]) -> None:
    """Steering angles may be geared 1 to 1 or 1 to -1: then the angle for a twist has a closed form."""
    for quantity, ratio in zip(coupling.ratios, ratios, strict=True):
        if abs(ratio) != abs(ratios[0]):
            raise RobotFileError(
                f"steering angles in the ratio {coupling.ratios[0].text} to {quantity.text}", quantity.mark,
                "The common angle for a twist has a closed form only if the angles are equal or opposite.",
                "Write ratios of 1 and -1; or delete the coupling: inverse then gives each wheel the angle that fits.",
            )  # fmt: skip


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
        offset = [w for w in steered if w.rolls_when_steered]
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
        against = [w for w in castors if joint == "steer" and w.steer_sign != castors[0].steer_sign]
        if against:
            raise NotDerivableError(
                f"{castors[0].name}.steer and {against[0].name}.steer turn against each other, and both are castors\n"
                "Delete the ratios: castors on one motor turn by equal angles.",
                coupling.mark,
            )
        if offset and joint == "spin":
            raise NotDerivableError(
                f"{offset[0].name}.spin cannot be coupled: {offset[0].name} is steered and has an offset_y or "
                "per_steer, so that it also turns while it is steered, and steering alone would move the robot\n"
                f"Leave {offset[0].name}.spin out of the coupling, or delete its offset_y and per_steer.",
                coupling.mark,
            )


def common_limits(spec: RobotSpec, robot: Robot) -> Robot:
    """``robot`` with coupled wheels that keep the limits of all of their group.

    RobotFileError where they have no value in common.
    """
    wheels = list(robot.wheels)
    for joint, quantity, members in _coupled(robot):
        ratios = [robot.turn_ratio(joint, w) for w in members]
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
