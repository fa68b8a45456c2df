"""What turns as a wheel does and is none, and why: geometry again, not names."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from wmrgen.importing.frames import dot, plus
from wmrgen.importing.records import Description, Joint
from wmrgen.importing.view import COAXIAL, EVEN, SUNK, Candidate, Robot
from wmrgen.spec.text import quoted


@dataclass(frozen=True, slots=True)
class Passed:
    """A joint that turns as a wheel's does, and ``why`` it is none. ``axle``: the joints of the wheels between which it
    is the gear of a differential."""

    joint: Joint
    why: str
    axle: tuple[str, ...] = ()

    @property
    def note(self) -> str:
        return f"joint {quoted(self.joint.name)} is not taken for a wheel: {self.why}"


_FEW = 16  # wheels; of more a simulator has no other in their middle
UNTOLD = "it is called one, but fixed, and neither an axis nor a cylinder says how it stands"


def nothing_told(robot: Robot, joint: Joint, wheels: Sequence[Candidate]) -> bool:
    """A fixed joint is called a wheel, at the height of one, of which it is no part, and says no more; where there are
    fewer than two, and nothing hangs on it."""
    named = re.search("wheel", f"{joint.name} {joint.child}", re.IGNORECASE)
    height = robot.origin(joint)[2]
    level = (
        any(abs(height - w.origin[2]) < EVEN for w in wheels)
        if len(wheels) > 1
        else not robot.under(joint.child)
    )
    own = {id(each) for w in wheels for each in (w.joint, *robot.under(w.joint.child))}
    carries = {id(each) for each in robot.under(joint.child)} & own
    return bool(named) and level and id(joint) not in own and not carries


def wheel_like(c: Candidate, wheels: Sequence[Candidate]) -> bool:
    """It is called a wheel, or drawn as large as one that is."""
    named = re.search("wheel", f"{c.joint.name} {c.joint.child}", re.IGNORECASE)
    return bool(named) or any(c.shape and w.shape and c.radius == w.radius for w in wheels)


def off_the_ground(c: Candidate, wheels: Sequence[Candidate]) -> str:
    shaped = [w.lowest for w in wheels if w.shape]
    height = float(c.lowest - min(shaped or [w.lowest for w in wheels] or [c.lowest]))
    what = "it stands" if c.shape else "its axle lies"
    return f"{what} {abs(height):.3g} m {'below' if height < 0 else 'above'} the ground on which the wheels stand"


def no_wheel(robot: Robot, c: Candidate, turning: Sequence[Candidate]) -> Passed | None:
    """What turns as a wheel does, or is fixed, and is none wherever the ground is; None for what may be one.
    ``turning``: all that turns so."""
    leaders = {joint.mimic[0] for joint in robot.description.joints if joint.mimic}
    roles = robot.roles(c.joint.child)
    if roles == {"visual"} and leaders & {c.joint.name, c.steer.name if c.steer else ""}:
        return Passed(c.joint, "it is drawn, touches nothing, and others mimic it")
    if reach := _reaches_aside(robot, c):
        why = f"its body reaches {reach:.3g} m to one side of the axle, as a flipper or an arm does"
        return Passed(c.joint, why)
    if roles == {"collision"}:
        drawn = [w for w in turning if robot.roles(w.joint.child) == {"visual"}]
        if ends := _between(c, drawn):
            why = f"it is not drawn and stands in the middle between {_named(ends)}, which touch nothing: a simulator's"
            return Passed(c.joint, why)
    return _gear(robot, c, turning) if c.joint.moves else None


def _gear(robot: Robot, c: Candidate, turning: Sequence[Candidate]) -> Passed | None:
    """What turns in the middle of an axle, and by its shape and its meshes does not reach the ground as the wheels on
    it do: the gear of a differential."""
    ends = () if c.steer else _between(c, [w for w in turning if not w.steer])
    if not ends:
        return None
    own, radius = _radius(robot, c), max(_radius(robot, w) for w in ends)
    if own and (not radius or own >= radius * float(1 - SUNK) - float(EVEN)):
        return None
    reach = (
        f"it reaches {own:.3g} m from it, they {radius:.3g} m" if own else "nothing says how far it reaches"
    )
    why = f"it turns in the middle of the axle of {_named(ends)}, and {reach}: the gear of a differential"
    return Passed(c.joint, why, tuple(w.joint.name for w in ends))


def _radius(robot: Robot, c: Candidate) -> float:
    """The radius of a wheel's shape, else how far its meshes reach from the axle [m]; 0 where neither says it."""
    meshes = () if c.shape else robot.meshes(c)
    return (
        float(c.radius) if c.shape else max((bounds.radius for _, _, bounds in meshes if bounds), default=0.0)
    )


def _named(ends: Sequence[Candidate]) -> str:
    return " and ".join(quoted(end.joint.name) for end in ends)


def with_gears(description: Description, passed: Sequence[Passed]) -> Description:
    """The description, in which what drives the gear of a differential drives the wheels on its axle."""
    driven = description.driven or frozenset()
    wheels = {joint for each in passed if each.joint.name in driven for joint in each.axle}
    return replace(description, driven=driven | wheels) if wheels else description


def _reaches_aside(robot: Robot, c: Candidate) -> float:
    """How far from the axle a cylinder or sphere of the body stands [m], of those of the wheel's own role, where it is
    beyond the wheel's radius and nothing balances it; else 0."""
    if c.shape is None:
        return 0.0
    shapes = robot.shapes(c.joint.child)
    offs = [plus(where.origin, c.origin, -1) for _, role, _, where in shapes if role in c.shape.words]
    offs = [plus(off, c.axis, -dot(off, c.axis)) for off in offs]
    far = max(offs, key=lambda off: dot(off, off))
    balanced = any(dot(far, off) < 0 for off in offs)
    return 0.0 if balanced or dot(far, far) <= c.radius**2 else math.sqrt(dot(far, far))


def _between(c: Candidate, others: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Two of few ``others`` on the axle of ``c``, each the mirror image of the other in the middle ``c``."""
    level = [w for w in others[: _FEW + 1] if w is not c and abs(dot(w.axis, c.axis)) > COAXIAL]
    for i, a in enumerate(level if len(others) <= _FEW else []):
        for b in level[:i]:
            apart = plus(a.origin, b.origin, -1)
            across = plus(apart, c.axis, -dot(apart, c.axis))
            off = plus(plus(a.origin, b.origin), c.origin, -2)
            if dot(off, off) < EVEN**2 and dot(across, across) < EVEN**2:
                return b, a
    return ()
