"""Joints of wheels that turn alike, because one mimics the other or both mimic a third."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from wmrgen.importing.records import Question, Wheel
from wmrgen.importing.view import Robot
from wmrgen.spec.text import quoted
from wmrgen.wheels.types import FIXED

Coupling = tuple[str, str]
_LEVEL = 1e-6  # [m]


def couplings(
    robot: Robot, wheels: Sequence[Wheel]
) -> tuple[tuple[Coupling, ...], list[Question], list[str]]:
    """Pairs that turn alike; questions where that may be the simulator's way alone; notes on what turns in a ratio."""
    description = robot.description
    roles = {w.joint: f"{w.name}.spin" for w in wheels if w.joint}
    roles |= {w.steer_joint: f"{w.name}.steer" for w in wheels if w.steer_joint}
    down = {j.name for j in description.joints if j.name not in roles or roles[j.name].endswith(".steer")}
    down &= {
        j.name for j in description.joints if robot.axis(j)[2] < 0
    }  # there the angle is that of the file negated
    first = {(name, role.rpartition(".")[2], Fraction(1)): role for name, role in roles.items()}
    pairs, notes = [], []
    for joint in description.joints:
        if joint.name not in roles or not joint.mimic:
            continue
        leader, factor, offset = joint.mimic
        wheel, _, kind = roles[joint.name].rpartition(".")
        turned = kind == "steer" and (leader in down) != (joint.name in down)
        other = first.setdefault((leader, kind, -factor if turned else factor), roles[joint.name])
        if not offset and other != roles[joint.name]:
            pairs.append((other, roles[joint.name]))
        elif offset or leader in roles or sum(key[:2] == (leader, kind) for key in first) > 1:
            ratio = f"{float(factor):g} times {quoted(leader)}" + (f" + {float(offset):g}" if offset else "")
            notes.append(
                f"joint {quoted(joint.name)} turns as {ratio}. Couplings of a robot file join what turns equally, so "
                f"there {wheel}.{kind} turns by itself, and inverse may ask of it what this gear cannot give. Where "
                f"{quoted(leader)} has the only motor, leave {kind} out of actuated of {wheel}"
            )
    sure = [pair for pair in pairs if not _doubted(pair, wheels)]
    questions = [_asked(pair, "turn alike in the file") for pair in pairs if pair not in sure]
    bodies = {joint.child: roles[joint.name] for joint in description.joints if joint.name in roles}
    for closing in description.closing:
        a, b = bodies.get(closing.parent), bodies.get(closing.child)
        if a and b and a != b:
            questions.append(_asked((a, b), f"are joined by {quoted(closing.name)}"))
    return tuple(sure), questions, notes


def _doubted(pair: Coupling, wheels: Sequence[Wheel]) -> bool:
    """Fixed wheels across the robot that turn alike, as on a solid axle."""
    places = [w.y for w in wheels if f"{w.name}.spin" in pair and w.type == FIXED.name]
    return len(places) == 2 and abs(places[0] - places[1]) > _LEVEL


def _asked(pair: Coupling, why: str) -> Question:
    text = f"{pair[0]} and {pair[1]} {why}: does one shaft turn both, so that the robot cannot turn without skidding?"
    hints = (f"[{pair[0]}, {pair[1]}] where it does", "delete the coupling where each wheel has its own")
    return Question(pair[1].split(".")[0], "equal", text, hints)
