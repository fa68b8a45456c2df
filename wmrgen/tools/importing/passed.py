"""What turns as a wheel does and is none, and why: geometry again, not names."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.frames import across, dot, plus, turned
from wmrgen.tools.importing.records import Description, Joint, Vector
from wmrgen.tools.importing.view import COAXIAL, EVEN, SUNK, UNSEEN, Candidate, Robot


@dataclass(frozen=True, slots=True)
class Passed:
    """A joint that turns as a wheel's does, and ``why`` it is none. ``axle``: the joints of the wheels between which it
    is the gear of a differential. ``limb``: its body is one, such as a leg."""

    joint: Joint
    why: str
    axle: tuple[str, ...] = ()
    limb: bool = False

    @property
    def note(self) -> str:
        return f"joint {quoted(self.joint.name)} is not taken for a wheel: {self.why}"


_FEW = 16  # wheels; of more a simulator has no other in their middle
_ROUND = 0.4  # of how far the mesh of a wheel reaches from its axle, as far it reaches to every side
_CHAIN = 4  # joints that turn above a wheel on a leg, beside the one that steers it
LIES = "its axis is upright"
LIMITED = "it has limits, and turns no further"
UNTOLD = "it is called one, but fixed, and neither an axis nor a cylinder says how it stands"


def called_wheel(joint: Joint) -> bool:
    """Its name, or that of its link, says so."""
    return "wheel" in f"{joint.name} {joint.child}".lower()


def nothing_told(robot: Robot, joint: Joint, wheels: Sequence[Candidate]) -> bool:
    """A fixed joint is called a wheel, at the height of one, of which it is no part, and says no more; where there are
    fewer than two, and nothing hangs on it."""
    height = robot.origin(joint)[2]
    level = (
        any(abs(height - w.origin[2]) < EVEN for w in wheels)
        if len(wheels) > 1
        else not robot.under(joint.child)
    )
    own = {id(each) for w in wheels for each in (w.joint, *robot.under(w.joint.child))}
    carries = {id(each) for each in robot.under(joint.child)} & own
    return called_wheel(joint) and level and id(joint) not in own and not carries


def wheel_like(c: Candidate, wheels: Sequence[Candidate]) -> bool:
    """It is called a wheel, or drawn as large as one that is."""
    return called_wheel(c.joint) or any(c.shape and w.shape and c.radius == w.radius for w in wheels)


def off_the_ground(c: Candidate, wheels: Sequence[Candidate]) -> str:
    shaped = [w.lowest for w in wheels if w.shape]
    height = float(c.lowest - min(shaped or [w.lowest for w in wheels] or [c.lowest]))
    what = "it stands" if c.shape else "its axle lies"
    return f"{what} {abs(height):.3g} m {'below' if height < 0 else 'above'} the ground on which the wheels stand"


def no_wheel(robot: Robot, c: Candidate, turning: Sequence[Candidate]) -> Passed | None:
    """What turns as a wheel does, or is fixed, and is none wherever the ground is; None for what may be one.
    ``turning``: all that turns so."""
    roles = robot.roles(c.joint.child)
    if roles == {"visual"} and any("collision" in robot.roles(w.joint.child) for w in _followers(c, turning)):
        return Passed(c.joint, "it is drawn, touches nothing, and others mimic it")
    if why := _limb(robot, c):
        return Passed(c.joint, why, limb=True)
    if roles == {"collision"}:
        drawn = [w for w in turning if robot.roles(w.joint.child) == {"visual"}]
        if ends := _between(c, drawn):
            why = f"it is not drawn and stands in the middle between {_named(ends)}, which touch nothing: a simulator's"
            return Passed(c.joint, why)
    return _gear(robot, c, turning) if c.joint.moves else None


def _followers(c: Candidate, turning: Sequence[Candidate]) -> list[Candidate]:
    """The wheels that turn or steer by mimicking the joints of another."""
    own = {c.joint.name, c.steer.name if c.steer else ""}
    return [w for w in turning if any(j and j.mimic and j.mimic[0] in own for j in (w.joint, w.steer))]


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
    return float(c.radius) if c.shape else max((reach.radius for reach in robot.bounds(c)), default=0.0)


def _named(ends: Sequence[Candidate]) -> str:
    return " and ".join(quoted(end.joint.name) for end in ends)


def with_gears(description: Description, passed: Sequence[Passed]) -> Description:
    """The description, in which what drives the gear of a differential drives the wheels on its axle."""
    driven = description.driven or frozenset()
    wheels = {joint for each in passed if each.joint.name in driven for joint in each.axle}
    return replace(description, driven=driven | wheels) if wheels else description


def _limb(robot: Robot, c: Candidate) -> str:
    """What shows that a body is a limb, such as a leg or a finger, or a blade; empty for what may be a wheel."""
    if {name.rsplit("::", 1)[-1] for name in (c.joint.name, c.joint.child)} & robot.description.pushing:
        return "a plugin has it push air or water, as a propeller does"
    if reach := _reaches_aside(robot, c):
        return f"its body reaches {reach:.3g} m to one side of the axle, as a flipper or an arm does"
    bounds = max(robot.bounds(c), key=lambda b: b.least, default=None)
    if bounds and bounds.least < _ROUND:
        far, near = bounds.radius, bounds.least * bounds.radius
        return (
            f"its mesh is not round: it reaches {far:.3g} m from the axle, and {near:.3g} m to another side"
        )
    off = 0.0 if c.shape or bounds else _unbalanced(robot, c)
    if off > UNSEEN:
        return f"its centre of mass lies {off:.3g} m off the axle, as that of a limb does"
    above = [j for j in robot.moving_above(c.joint) if j.turns and j is not c.steer]
    few: float = _CHAIN if c.joint.moves else _CHAIN // 2
    if c.shape and c.joint.moves:  # a cylinder is drawn of a wheel on a leg, and of a leg's motors
        few = math.inf if called_wheel(c.joint) else _CHAIN - 1
    if len(above) > few:
        return f"{len(above)} joints turn between it and {quoted(robot.base)}, as in an arm or a leg"
    return ""


def of_legs(robot: Robot, turning: Sequence[Candidate], passed: Sequence[Passed]) -> list[Passed]:
    """What hangs on a body that turns about a level axis and bears a limb, or turns about its axle beside it, as the
    motors of legs do."""
    limbs = [each.joint for each in passed if each.limb]
    bearing = {
        j.name: j for limb in limbs for j in robot.moving_above(limb) if j.turns and not robot.upright(j)
    }
    axles = [(j, robot.origin(j), robot.axis(j)) for j in bearing.values()]
    result = []
    for c in (c for c in turning if all(c.joint is not each.joint for each in passed)):
        above = [j.name for j in robot.moving_above(c.joint) if j is not c.steer]
        legs = (j for j, origin, axis in axles if j.name in above or _beside(c, origin, axis))
        if leg := next(legs, None):
            result.append(Passed(c.joint, f"it is beside a limb that {quoted(leg.name)} turns"))
    return result


def _beside(c: Candidate, origin: Vector, axis: Vector) -> bool:
    """An ``axis`` through ``origin`` is a wheel's axle, and the two origins are within the wheel's radius."""
    off = plus(origin, c.origin, -1)
    return dot(off, off) < c.radius**2 and coaxial(c, origin, axis)


def coaxial(c: Candidate, origin: Vector, axis: Vector) -> bool:
    """An ``axis`` through ``origin`` is a wheel's axle."""
    aside = across(plus(origin, c.origin, -1), c.axis)
    return dot(aside, aside) < EVEN**2 and abs(dot(axis, c.axis)) > COAXIAL


def _unbalanced(robot: Robot, c: Candidate) -> float:
    """How far the centre of mass of a link lies off the axle [m]; 0 where the file does not say it."""
    centre = robot.description.masses.get(c.joint.child)
    if centre is None:
        return 0.0
    frame = robot.frame(c.joint.child)
    off = across(plus(plus(turned(frame.rotation, centre), frame.origin), c.origin, -1), c.axis)
    return math.sqrt(dot(off, off))


def _reaches_aside(robot: Robot, c: Candidate) -> float:
    """How far from the axle a box, cylinder or sphere of the body stands [m], where it is beyond the wheel's radius and
    nothing balances it; else 0. Of a wheel with a shape, those of that shape's role."""
    roles = c.shape.words if c.shape else "collision visual"
    bodies = [where for shape, where in robot.body(c.joint.child) if shape.role in roles and not shape.uri]
    offs = [across(plus(where.origin, c.origin, -1), c.axis) for where in bodies]
    far = max(offs, key=lambda off: dot(off, off), default=c.origin)
    balanced = not offs or any(dot(far, off) < 0 for off in offs)
    return 0.0 if balanced or dot(far, far) <= c.radius**2 else math.sqrt(dot(far, far))


def _between(c: Candidate, others: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Two of few ``others`` on the axle of ``c``, each the mirror image of the other in the middle ``c``."""
    few = others if len(others) <= _FEW else ()
    level = [w for w in few if w is not c and abs(dot(w.axis, c.axis)) > COAXIAL]
    for i, a in enumerate(level):
        for b in level[:i]:
            askew = across(plus(a.origin, b.origin, -1), c.axis)
            off = plus(plus(a.origin, b.origin), c.origin, -2)
            if dot(off, off) < EVEN**2 and dot(askew, askew) < EVEN**2:
                return b, a
    return ()
