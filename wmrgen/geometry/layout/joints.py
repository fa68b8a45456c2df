"""Exact constants of joints and commands (limits, weights, deadband, noise, lag), and couplings between joints."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from wmrgen.errors import Code, ErrorCollector, NotDerivableError, RobotFileError
from wmrgen.geometry.exact.evaluate import parameters_in, substituted
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.layout.expressions import Scope
from wmrgen.geometry.layout.records import Gyro, Interval, Noise, Robot, Wheel
from wmrgen.robotfile.records import Coupling, GyroSpec, Limit, NoiseSpec, Quantity, RobotSpec

# Ratio to the usual weight of 1: a larger one would lose the other rows in float32 rounding.
MOST_WEIGHT = 1000


def constant(what: str, quantity: Quantity, scope: Scope) -> Exact:
    """Return the value of a quantity that must not depend on a tunable parameter.

    Args:
        what: The name of the quantity, for messages.
        quantity: The quantity in the robot file.
        scope: The parameters of the robot file.

    Returns:
        The value in SI units.

    Raises:
        RobotFileError: If the quantity depends on a tunable parameter.
    """
    symbolic = scope.poly(quantity)
    names = sorted(parameters_in(substituted(symbolic, scope.constants)))
    if names:
        raise RobotFileError(
            f"{what} is {quantity.text}, which depends on the tunable parameter {names[0]}", quantity.mark,
            "It must be a constant, because the generated code and its proved bounds contain it.",
            f"Write a number, or delete tunable: true of {names[0]}.",
        )  # fmt: skip
    return scope.number(symbolic)


def limits_of(limits: Iterable[Limit], scope: Scope) -> dict[str, Interval]:
    """Return the limits in SI units, by quantity.

    Raise RobotFileError if a lower end is above the upper end, or if a limit depends on a tunable parameter.
    """
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
    """Return the weight of a wheel's measurements in the least squares of `forward`.

    Args:
        name: The name of the wheel, for messages.
        weight: The quantity in the robot file.
        scope: The parameters of the robot file.

    Returns:
        The weight, relative to the default of 1.

    Raises:
        RobotFileError: If the weight is not between 1/`MOST_WEIGHT` and `MOST_WEIGHT`.
    """
    value = constant(f"weight of {name}", weight, scope)
    if not 1 <= value * MOST_WEIGHT <= MOST_WEIGHT**2:
        raise RobotFileError(
            f"weight of {name} is {weight.text}, not between 1/{MOST_WEIGHT} and {MOST_WEIGHT}", weight.mark,
            "A weight is about (noise of other wheels / noise of this wheel)**2. Rounding would hide rows with a much "
            "smaller weight.",
            "Write a number such as 0.25; to ignore a wheel, write sensed: [].",
        )  # fmt: skip
    return value


def deadband_of(share: Quantity, scope: Scope) -> Exact:
    """Return the deadband as a fraction of the twist limits. Raise RobotFileError unless it is in [0, 1)."""
    value = constant("deadband", share, scope)
    if not ZERO <= value < ONE:
        raise RobotFileError(
            f"deadband is {share.text}, not from 0 to below 1", share.mark,
            "It is a fraction of the limits of vx, vy and omega; at 1 the robot would never move.",
            "Write a number such as deadband: 0.01.",
        )  # fmt: skip
    return value


def noise_of(noise: Iterable[NoiseSpec], scope: Scope) -> dict[str, Noise]:
    """Return the noise of each joint as standard deviations in SI units. Raise RobotFileError for a negative one."""

    def deviation(joint: str, part: str, quantity: Quantity | None) -> Exact:
        if quantity is None:
            return ZERO
        value = constant(f"{part} of the noise of {joint}", quantity, scope)
        if value.sign < 0:
            raise RobotFileError(
                f"{part} of the noise of {joint} is {quantity.text}, which is negative", quantity.mark,
                "It is a standard deviation.", "Write 0 or a positive value.",
            )  # fmt: skip
        return value

    result = {}
    for n in noise:
        proportional = deviation(n.joint, "proportional", n.proportional)
        result[n.joint] = Noise(proportional, deviation(n.joint, "constant", n.constant))
    return result


def lag_of(whose: str, lag: Iterable[tuple[str, Quantity]], scope: Scope) -> dict[str, Exact]:
    """Return the time constants of joints.

    Args:
        whose: The name of the wheel, or "the robot", for messages.
        lag: Joints and their lags in the robot file.
        scope: The parameters of the robot file.

    Returns:
        A mapping from joint to time constant [s].

    Raises:
        RobotFileError: If a time constant is not positive.
    """
    instead = (
        "Write a time such as 150 ms, or delete the key: without a lag the angle is commanded by its rate."
    )
    return {j: positive(f"{j} lag of {whose}", time, scope, instead) for j, time in lag}


def positive(what: str, quantity: Quantity, scope: Scope, instead: str) -> Exact:
    """Return the value of a quantity that must be positive and must not depend on a tunable parameter.

    Args:
        what: The name of the quantity, for messages.
        quantity: The quantity in the robot file.
        scope: The parameters of the robot file.
        instead: The remedy of the message: what to write.

    Returns:
        The value in SI units.

    Raises:
        RobotFileError: If the value is not positive or depends on a tunable parameter.
    """
    value = constant(what, quantity, scope)
    if value.sign <= 0:
        raise RobotFileError(f"{what} is {quantity.text}, which is not positive", quantity.mark, "", instead)
    return value


def gyro_of(gyro: GyroSpec, scope: Scope) -> Gyro:
    """Return the yaw-rate sensor. Raise RobotFileError if its noise or weight is impossible."""
    weight = ONE if gyro.weight is None else weight_of("the gyro", gyro.weight, scope)
    return Gyro(weight, noise_of([gyro.noise], scope)[gyro.noise.joint])


# ---- couplings: sets of joints that turn together, and their common limits

_LIMITED = {"steer": ("steer", "steer_rate", "steer_acceleration"), "spin": ("spin", "spin_rate")}


def groups(spec: RobotSpec, joint: str) -> tuple[int, ...]:
    """Return for each wheel the lowest index among the wheels that its ``joint`` (spin or steer) is coupled to."""
    names = [w.name for w in spec.wheels]
    leader = list(range(len(names)))
    for coupling in spec.couplings:
        if coupling.joint != joint:
            continue
        members = {leader[names.index(n)] for n in coupling.wheels}
        leader = [min(members) if k in members else k for k in leader]
    return tuple(leader)


def turn_ratios(spec: RobotSpec, joint: str, leaders: Sequence[int], scope: Scope) -> tuple[Exact, ...]:
    """Return for each wheel how far its joint turns for 1 rad of the leading wheel of its coupled set.

    Args:
        spec: The robot file.
        joint: spin or steer.
        leaders: For each wheel the index of its leading wheel, as from `groups`.
        scope: The parameters of the robot file.

    Returns:
        One ratio for each wheel, 1 for a leading wheel.

    Raises:
        RobotFileError: If a ratio is 0, if steering angles are neither equal nor opposite, or if couplings contradict
            each other.
    """
    names = [w.name for w in spec.wheels]
    turns = dict.fromkeys(leaders, ONE)
    rest = [c for c in spec.couplings if c.joint == joint]

    def has_known_wheel(coupling: Coupling) -> bool:
        return any(names.index(n) in turns for n in coupling.wheels)

    while rest:
        coupling = next(c for c in rest if has_known_wheel(c))
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
    """Raise RobotFileError unless coupled steering angles are equal or opposite."""
    for quantity, ratio in zip(coupling.ratios, ratios, strict=True):
        if abs(ratio) != abs(ratios[0]):
            raise RobotFileError(
                f"steering angles in the ratio {coupling.ratios[0].text} to {quantity.text}", quantity.mark,
                "The common angle for a twist has a closed form only if the angles are equal or opposite.",
                "Write ratios of 1 and -1; or delete the coupling, and `inverse` computes an angle for each wheel.",
            )  # fmt: skip


def _ratio(quantity: Quantity, scope: Scope) -> Exact:
    value = constant("a ratio of the coupling", quantity, scope)
    if not value:
        raise RobotFileError(
            f"a ratio of the coupling is {quantity.text}", quantity.mark, "At a ratio of 0 the joint would not move.",
            "Write the turns of the joint for one turn of the shaft.",
        )  # fmt: skip
    return value


def refuse_unmodelled(spec: RobotSpec, robot: Robot) -> None:
    """Raise NotDerivableError for couplings that make the motion of the body depend on steering rates or on castors.

    The angle of a steered wheel is commanded; the angle and rate of a castor follow from the motion.
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
                f"but the angle of the steered wheel {steered[0].name} is commanded"
            )
            raise NotDerivableError(
                f"{what}\nCouple castors with castors, or write one of the two as the other type.",
                coupling.mark,
            )
        against = [w for w in castors if joint == "steer" and w.steer_sign != castors[0].steer_sign]
        if against:
            raise NotDerivableError(
                f"the castors {castors[0].name} and {against[0].name} are coupled to steer in opposite directions\n"
                "Delete the ratios, so that the castors turn by equal angles.",
                coupling.mark,
            )
        if offset and joint == "spin":
            raise NotDerivableError(
                f"{offset[0].name}.spin cannot be coupled: {offset[0].name} is steered and has an offset_y or "
                "per_steer, so steering also spins it, and steering alone would move the robot\n"
                f"Remove {offset[0].name}.spin from the coupling, or delete its offset_y and per_steer.",
                coupling.mark,
            )


def refuse_shared_joints(spec: RobotSpec, robot: Robot) -> None:
    """Raise RobotFileError if two wheels name one joint of other tools that does not turn both of them alike."""
    owners: dict[str, tuple[Wheel, str]] = {}
    for written, wheel in zip(spec.wheels, robot.wheels, strict=True):
        for joint, (name, _) in wheel.joints.items():
            other, its_joint = owners.setdefault(name, (wheel, joint))
            alike = its_joint == joint and _turn_alike(robot, joint, other, wheel)
            if other is not wheel and not alike:  # a joint of SDF with two axes steers and spins one wheel
                raise RobotFileError(
                    f"{other.name}.{its_joint} and {wheel.name}.{joint} both have the joint {name}", written.mark,
                    "Commands and measurements of this joint would belong to two joints.",
                    f"Write another name, or couplings: if one joint turns both: [{{equal: [{other.name}.{joint}, "
                    f"{wheel.name}.{joint}]}}].",
                    Code.TWICE,
                )  # fmt: skip


def _turn_alike(robot: Robot, joint: str, a: Wheel, b: Wheel) -> bool:
    """Return whether a coupling lets ``joint`` of both wheels turn as one joint of other tools does."""
    names = a.joint_name(joint), b.joint_name(joint)
    coupled = any(a in members and b in members for members in robot.together(joint, robot.wheels))
    ratio = robot.turn_ratio(joint, b) / robot.turn_ratio(joint, a)
    return coupled and names[0].name == names[1].name and ratio == Exact(names[0].sign * names[1].sign)


def common_limits(spec: RobotSpec, robot: Robot) -> Robot:
    """Return ``robot`` with the limits of coupled wheels replaced by those that all of them satisfy.

    Raise RobotFileError if the limits of coupled wheels have no value in common.
    """
    wheels = list(robot.wheels)
    for joint, quantity, members in _coupled(robot):
        ratios = [robot.turn_ratio(joint, w) for w in members]
        limits = []
        for w, k in zip(members, ratios, strict=True):
            limit = robot.limit(w, quantity)
            if limit is not None:
                limits.append(limit.times(ONE / k))  # as a limit of the leading wheel
        if not limits:
            continue
        common = Interval(max(limit.low for limit in limits), min(limit.high for limit in limits))
        if common.low > common.high:
            mark = next(
                c.mark for c in spec.couplings if c.joint == joint and robot.wheel(c.wheels[0]) in members
            )
            raise RobotFileError(
                f"the {quantity} limits of {' and '.join(w.name for w in members)} have no value in common", mark,
                "Coupled wheels turn together.", "Write limits that overlap.",
            )  # fmt: skip
        for w, k in zip(members, ratios, strict=True):
            own = common.times(k)
            if robot.limit(w, quantity) != own:
                wheels[w.index] = replace(wheels[w.index], limits={**wheels[w.index].limits, quantity: own})
    return replace(robot, wheels=tuple(wheels))


def _coupled(robot: Robot) -> Iterator[tuple[str, str, list[Wheel]]]:
    """Yield joint, limited quantity and wheels for every set of coupled wheels."""
    for joint, quantities in _LIMITED.items():
        for members in robot.together(joint, robot.wheels):
            if len(members) > 1:
                yield from ((joint, quantity, members) for quantity in quantities)
