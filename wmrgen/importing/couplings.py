"""Joints of wheels that turn alike, because one mimics the other or both mimic a third."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.importing.records import Description, Question, Wheel
from wmrgen.spec.text import quoted
from wmrgen.wheels.types import FIXED

Coupling = tuple[str, ...]
_LEVEL = 1e-6  # [m]


def couplings(
    description: Description, wheels: Sequence[Wheel]
) -> tuple[tuple[Coupling, ...], list[Question], list[str]]:
    """What turns alike; questions where that may be the simulator's way alone; notes on what turns in a ratio."""
    roles = {w.joint: f"{w.name}.spin" for w in wheels if w.joint}
    roles |= {w.steer_joint: f"{w.name}.steer" for w in wheels if w.steer_joint}
    alike: dict[tuple[str, str], list[str]] = {}
    notes = []
    for joint in description.joints:
        if joint.name in roles and joint.mimic:
            leader, factor, offset = joint.mimic
            kind = roles[joint.name].split(".")[1]
            if (leader in roles and not roles[leader].endswith(kind)) or factor != 1 or offset:
                ratio = f"{float(factor):g} times {quoted(leader)}" + (
                    f" + {float(offset):g}" if offset else ""
                )
                notes.append(
                    f"joint {quoted(joint.name)} turns as {ratio}: a robot file couples equal angles alone, so "
                    "this is not taken over"
                )
            else:
                alike.setdefault((leader, kind), [roles[leader]] if leader in roles else []).append(
                    roles[joint.name]
                )
    groups = [tuple(dict.fromkeys(names)) for names in alike.values() if len(set(names)) > 1]
    sure = [group for group in groups if not _doubted(group, wheels)]
    questions = [_asked(group, "mimic one joint") for group in groups if group not in sure]
    bodies = {joint.child: roles[joint.name] for joint in description.joints if joint.name in roles}
    for closing in description.closing:
        ends = [bodies[link] for link in (closing.parent, closing.child) if link in bodies]
        if len(set(ends)) == 2:
            questions.append(_asked(tuple(ends), f"are joined by {quoted(closing.name)}"))
    return tuple(sure), questions, notes


def _doubted(group: Coupling, wheels: Sequence[Wheel]) -> bool:
    """Spins across the robot, which a solid axle couples, and angles beside fixed wheels, which then must skid."""
    members = [w for w in wheels if {f"{w.name}.spin", f"{w.name}.steer"} & set(group)]
    if group[0].endswith("spin"):
        return max(w.y for w in members) - min(w.y for w in members) > _LEVEL
    return any(w.type == FIXED.name for w in wheels)


def _asked(group: Coupling, why: str) -> Question:
    text = f"{' and '.join(group)} {why}: do they turn alike on the robot, too?"
    hints = (
        f"[{', '.join(group)}] where one shaft turns both",
        "delete the coupling where each turns by itself",
    )
    return Question(group[-1].split(".")[0], "equal", text, hints)
