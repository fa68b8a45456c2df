"""Joints of wheels that turn alike: one mimics the other, both mimic a third, or one joint steers both."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from wmrgen.robotfile.text import quoted
from wmrgen.robotfile.wheel_types.types import FIXED, STEERED
from wmrgen.tools.importing.read import refuse
from wmrgen.tools.importing.records import Coupling, Joint, Question, Wheel
from wmrgen.tools.importing.view import Robot

Turn = tuple[Fraction, Fraction]  # factor and offset: how a joint turns as another one does
_LEVEL = 1e-6  # [m]
_MOST = 10**6  # of the ratio of gears
_ITSELF = Fraction(1), Fraction(0)


def couplings(
    robot: Robot, wheels: Sequence[Wheel]
) -> tuple[tuple[Coupling, ...], list[Question], list[str]]:
    """Pairs that turn alike, spins in their ratio; questions where that may be the simulator's way alone; notes on
    steering that follows in another way."""
    description = robot.description
    pairs, notes, steering = list[Coupling](), list[str](), dict[str, str]()
    for name, role in ((w.steer_joint, f"{w.name}.steer") for w in wheels if w.steer_joint):
        if (first := steering.setdefault(name, role)) != role:
            pairs.append(Coupling(first, role, why=f"joint {quoted(name)} steers both"))
    roles = {w.joint: f"{w.name}.spin" for w in wheels if w.joint} | steering
    steered = {w.name for w in wheels if w.type == STEERED.name}
    leads = {(name, role.rpartition(".")[2]): [(role, _ITSELF)] for name, role in roles.items()}
    for joint in description.joints:
        if joint.name not in roles or not joint.mimic:
            continue
        role = roles[joint.name]
        wheel, _, kind = role.rpartition(".")
        root, turn = _followed(robot, joint, kind)
        others = leads.setdefault((root, kind), [])
        opposite = kind == "steer" and wheel in steered
        alike = (
            (r, t)
            for r, t in others
            if t == turn
            or (kind == "spin" and _geared(t[0], turn[0]))
            or (opposite and t == (-turn[0], -turn[1]) and r.rpartition(".")[0] in steered)
        )
        lead, of = next(alike, ("", turn))
        if lead:
            pairs.append(Coupling(lead, role, turn[0] / of[0] if of[0] else Fraction(1)))
            continue
        if others:
            leader, factor, offset = joint.mimic
            ratio = f"{float(factor):g} times {quoted(leader)}" + (f" + {float(offset):g}" if offset else "")
            notes.append(
                f"joint {quoted(joint.name)} turns as {ratio}. Couplings of a robot file join steering angles that are "
                "equal or, for steered wheels, opposite, and spins in ratios up to a million: there "
                f"{wheel}.{kind} turns by itself, and inverse may ask of it what this gear cannot give. Where "
                f"{quoted(leader)} has the only motor, leave {kind} out of actuated of {wheel}"
            )
        others.append((role, turn))
    sure = [pair for pair in pairs if not _doubted(pair, wheels)]
    questions = [
        _asked(pair, "turn in one ratio in the file" if pair.ratio != 1 else "turn alike in the file")
        for pair in pairs
        if pair not in sure
    ]
    bodies = {joint.child: roles[joint.name] for joint in description.joints if joint.name in roles}
    for closing in description.closing:
        a, b = bodies.get(closing.parent), bodies.get(closing.child)
        if a and b and a != b:
            questions.append(_asked(Coupling(a, b), f"are joined by {quoted(closing.name)}"))
    return tuple(sure), questions, notes


def _geared(a: Fraction, b: Fraction) -> bool:
    """Whether gears may turn two joints by these factors."""
    return abs(b) <= _MOST * abs(a) and abs(a) <= _MOST * abs(b) != 0


def _followed(robot: Robot, joint: Joint, kind: str) -> tuple[str, Turn]:
    """The joint that this one follows, through others, and how; the angle of a steering joint that points down is that
    of the file negated."""
    joints = {j.name: j for j in robot.description.joints}

    def sign(name: str) -> int:
        return -1 if kind == "steer" and name in joints and robot.axis(joints[name])[2] < 0 else 1

    name, (factor, offset) = joint.name, _ITSELF
    for _ in joints:
        mimic = joints[name].mimic if name in joints else None
        if mimic is None:
            break
        name, factor, offset = mimic[0], factor * mimic[1], offset + factor * mimic[2]
    else:
        what = f"joint {quoted(joint.name)} mimics itself, be it through others"
        raise refuse(what, "", "Delete the mimic of the joint that leads.", joint.mark)
    return name, (factor * sign(name) * sign(joint.name), offset * sign(joint.name))


def _doubted(pair: Coupling, wheels: Sequence[Wheel]) -> bool:
    """Fixed wheels across the robot that turn alike, as on a solid axle."""
    places = [w.y for w in wheels if f"{w.name}.spin" in (pair.first, pair.second) and w.type == FIXED.name]
    return len(places) == 2 and abs(places[0] - places[1]) > _LEVEL


def _asked(pair: Coupling, why: str) -> Question:
    a, b = pair.first, pair.second
    text = f"{a} and {b} {why}: does one shaft turn both, so that the robot cannot turn without skidding?"
    hints = (f"{pair.joints} where it does", "delete the coupling where each wheel has its own")
    return Question(b.split(".")[0], "equal", text, hints)
