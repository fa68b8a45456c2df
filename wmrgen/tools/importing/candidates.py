"""Which joints are wheels: by geometry, not by names.

A wheel turns without end about a level axis, carries nothing that moves except rollers, and is on the ground. If fewer
than two joints do, fixed joints whose names say wheel, or that have an axis, are taken with a question.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction

from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.frames import dot, plus, transposed, turned, unit
from wmrgen.tools.importing.records import RIGID, Joint, Vector
from wmrgen.tools.importing.rejections import Rejected, coaxial, rejected, remarks
from wmrgen.tools.importing.rule import Rule, rule
from wmrgen.tools.importing.view import EVEN, LEVEL, SUNK, UNSEEN, UPRIGHT, Candidate, Robot, Z

_ROLLERS = 4  # fewer bodies that turn on a wheel are not the rollers of its rim
_WHEEL = re.compile("wheel|hub|tire|tyre", re.IGNORECASE)
_CASTOR = re.compile("cast[eo]r", re.IGNORECASE)

# Each returns the wheel that a joint turns or carries, or None.
PROPOSALS: list[Rule[Callable[[Robot, Joint], Candidate | None]]] = []
# Each returns a candidate whose axis or steering is in doubt, or None if the rule does not apply.
DOUBTS: list[Rule[Callable[[Robot, Candidate], Candidate | None]]] = []


def candidates(robot: Robot) -> tuple[list[Candidate], list[Rejected]]:
    """Return the wheels in the order of the file, and what looks like a wheel and is none, with the reason."""
    joints = [j for j in robot.description.joints if robot.reaches(j.child)]
    turning = _proposed(robot, joints)
    seen = rejected(robot, turning)
    spins = _without([each.joint for each in seen], turning)
    wheels = _on_ground(robot, spins)
    if len(wheels) < 2:
        wheels = _on_ground(robot, _bodies(robot, spins + _all_fixed(robot)))
    else:
        wheels += [c for c in rigid_wheels(robot, wheels) if _alike(c, wheels)]
    rest = _others(joints, [c.joint for c in wheels] + [each.joint for each in seen])
    seen += remarks(robot, rest, wheels)
    return ([] if _lies_on_its_side(robot, wheels, seen) else wheels), seen


def rigid_wheels(robot: Robot, wheels: Sequence[Candidate]) -> list[Candidate]:
    """Return what is on the ground beside the wheels and looks like one, on fixed joints alone."""
    others = []
    for c in _all_fixed(robot):
        if all(c.joint is not w.joint and _apart(c, w) for w in wheels):
            others.append(c)
    standing = _on_ground(robot, [*wheels, *others])
    return [c for c in others if c in standing]


def _proposed(robot: Robot, joints: Sequence[Joint]) -> list[Candidate]:
    """Return the candidates of all joints, without the rollers of other candidates."""
    found = []
    for joint in joints:
        wheel = next((c for each in PROPOSALS if (c := each.check(robot, joint))), None)
        if wheel:
            found.append(wheel)
    rollers = {roller.child for c in found for roller in c.rollers}
    return [c for c in found if c.joint.child not in rollers]


def _without(joints: Sequence[Joint], turning: Sequence[Candidate]) -> list[Candidate]:
    excluded = {id(joint) for joint in joints}
    return [c for c in turning if id(c.joint) not in excluded]


def _others(joints: Sequence[Joint], known: Sequence[Joint]) -> list[Joint]:
    names = {joint.name for joint in known}
    return [joint for joint in joints if joint.name not in names]


def _lies_on_its_side(robot: Robot, wheels: Sequence[Candidate], seen: Sequence[Rejected]) -> bool:
    """Return whether more driven wheels have upright axes than there are wheels: z of the frame is across."""
    driven = robot.description.driven or ()
    upright = [each for each in seen if each.code == "upright axis" and each.joint.name in driven]
    return len(upright) > max(1, len(wheels))


# ---- rules that propose a wheel


@rule(
    PROPOSALS,
    "spin joint",
    "A wheel that its own joint turns without end, with the rollers on it, is a wheel whatever its name.",
    "rby1a, lekiwi and most others; joints named drivewhl_l or ST3215_Servo_Motor-v1_Revolute-64",
)
def _spinning(robot: Robot, joint: Joint) -> Candidate | None:
    if not joint.spins:
        return None
    moving = robot.moving_below(joint.child)
    leaves = all(j.spins and not robot.moving_below(j.child) for j in moving)
    if moving and not (leaves and len(moving) >= _ROLLERS):
        return None
    candidate = _candidate(robot, joint, robot.origin(joint), robot.axis(joint), tuple(moving))
    doubted = next((c for each in DOUBTS if (c := each.check(robot, candidate))), None)
    if doubted and _is_upright(doubted) and doubted.steer:
        return doubted
    return (doubted or candidate) if _is_level((doubted or candidate).axis) else None


@rule(
    PROPOSALS,
    "steering joint alone",
    "A steered wheel whose description has no joint for rolling would be missing.",
    "two descriptions of the collection of 72 from which the reference extractor was written (its rule 7)",
)
def _steered_alone(robot: Robot, joint: Joint) -> Candidate | None:
    if joint.spins or not robot.upright(joint) or robot.moving_below(joint.child):
        return None
    cylinder = _cylinder(robot, joint.child)
    if cylinder is None or not _is_level(cylinder[1]):
        return None
    body = replace(joint, name=joint.child, kind=RIGID)
    candidate = _candidate(robot, body, *cylinder, steer=joint)
    return replace(candidate, doubt="it steers, and the file has no joint about which the wheel turns")


def _fixed(robot: Robot, joint: Joint) -> Candidate | None:
    """Return the wheel of a fixed joint; its axis is that of the joint, else that of its cylinder.

    What is fixed to a body that tilts, and on which other joints turn, is a part of an arm.
    """
    tilting = (j for j in robot.moving_above(joint) if j.turns and not robot.upright(j))
    beyond = robot.moving_below(next((j.child for j in tilting), joint.child))
    if robot.moving_below(joint.child) or any(j.turns for j in beyond):
        return None
    named = _WHEEL.search(f"{joint.name} {joint.child}")
    drawn = _cylinder(robot, joint.child) if named else None
    axle = (robot.origin(joint), robot.axis(joint)) if joint.axis else drawn
    if axle is None or not _is_level(axle[1]):
        return None
    candidate = _candidate(robot, joint, *axle)
    if not (named or candidate.shape):
        return None
    return replace(candidate, doubt="its joint is fixed: the file has no joint about which the wheel turns")


def _all_fixed(robot: Robot) -> list[Candidate]:
    """Return the wheels of fixed joints, of which no rule says that they are none."""
    joints = [j for j in robot.description.joints if not j.moves and robot.reaches(j.child)]
    found = [c for joint in joints if (c := _fixed(robot, joint))]
    return _without([each.joint for each in rejected(robot, found)], found)


def _alike(c: Candidate, wheels: Sequence[Candidate]) -> bool:
    """Return whether a rigid body beside wheels that turn is as large as they, none of their parts, and no castor."""
    if not c.shape or "wheel" not in c.joint.child.lower() or _CASTOR.search(c.joint.name + c.joint.child):
        return False
    own = all(c.joint.parent != w.joint.child and w.joint not in c.via for w in wheels)
    return own and any(w.shape and abs(w.radius - c.radius) < c.radius / 100 for w in wheels)


def _bodies(robot: Robot, wheels: Sequence[Candidate]) -> list[Candidate]:
    """Return each body once: what a wheel carries rigidly is a part of it; a rigid axle that carries two is none."""
    parts = []
    for c in wheels:
        below = {id(joint) for joint in robot.under(c.joint.child, rigid=True)}
        parts.append([other for other in wheels if id(other.joint) in below])
    bodies, carried = [], set[int]()
    for c, own in zip(wheels, parts, strict=True):
        if c.joint.moves or len(own) < 2:
            bodies.append(c)
            carried |= {id(part) for part in own}
    return [c for c in bodies if id(c) not in carried]


# ---- rules that doubt the axis of a wheel, or how it steers


@rule(
    DOUBTS,
    "upright under an upright joint",
    "A wheel whose axis is written like that of its steering joint would be missing.",
    "ranger_mini_v2",
)
def _upright_below_steering(robot: Robot, c: Candidate) -> Candidate | None:
    if not _is_upright(c) or c.steer is None or c.via:
        return None
    why = "its axis is upright, as that of the steering joint above it"
    return replace(c, shape=None, doubt=why, unsure=True)


@rule(
    DOUBTS,
    "no axis",
    "A joint without <axis> turns about 1 0 0, which is seldom meant: its cylinder shows the axle.",
    "f1tenth_sim, of the collection of 72",
)
def _no_axis(robot: Robot, c: Candidate) -> Candidate | None:
    if c.joint.axis is not None or c.shape is not None:
        return None
    why = "it has no <axis>, so 1 0 0"
    if cylinder := _cylinder(robot, c.joint.child):
        _, axis = cylinder
        shape = robot.round_shape(c.joint.child, c.origin, axis)
        why += ", which is not that of its cylinder"
        return replace(c, axis=axis, shape=shape, doubt=why, unsure=True)
    if robot.roles(c.joint.child):
        return None
    return replace(c, doubt=f"{why}, and nothing is drawn of it", unsure=True)


@rule(
    DOUBTS,
    "steering joint without axis",
    "The castor of a description whose swivel has no <axis> would be a plain wheel.",
    "pioneer3dx",
)
def _silent_steering(robot: Robot, c: Candidate) -> Candidate | None:
    silent = [j for j in c.via if j.turns and j.axis is None]
    if c.steer or not silent:
        return None
    why = f"{quoted(silent[0].name)} has no <axis>, so 1 0 0; it is taken for an upright steering axis"
    rest = tuple(j for j in c.via if j is not silent[0])
    upright = turned(transposed(robot.frame(silent[0].child).rotation), Z)
    return replace(c, steer=replace(silent[0], axis=upright), via=rest, doubt=why)


@rule(
    DOUBTS,
    "same axle twice",
    "A steering joint whose axis is written like that of the wheel would be suspension.",
    "hunter2, of the collection of 72",
)
def _same_axle(robot: Robot, c: Candidate) -> Candidate | None:
    above = [j for j in c.via if j.turns and coaxial(c, robot.origin(j), robot.axis(j))]
    if c.steer or not above:
        return None
    return replace(c, doubt=f"{quoted(above[0].name)} above it turns about the same axle")


# ---- geometry


def _is_level(axis: Vector) -> bool:
    return abs(axis[2]) <= LEVEL


def _is_upright(c: Candidate) -> bool:
    return abs(c.axis[2]) >= UPRIGHT


def _apart(c: Candidate, other: Candidate) -> bool:
    between = plus(c.centre, other.centre, -1)
    return dot(between, between) > c.radius**2


def _cylinder(robot: Robot, link: str) -> tuple[Vector, Vector] | None:
    """Return the centre and the axis, pointing as for rolling forward, of the first cylinder of a link."""
    cylinders = (where for kind, _, _, where in robot.shapes(link) if kind == "cylinder")
    return next(((where.origin, _forward(unit(turned(where.rotation, Z)))) for where in cylinders), None)


def _forward(axis: Vector) -> Vector:
    """Return the sense of an axle in which the wheel rolls forward, or to the right."""
    forward = axis[1] > 0 or (axis[1] == 0 and axis[0] < 0)
    return axis if forward else (-axis[0], -axis[1], -axis[2])


def _candidate(
    robot: Robot,
    joint: Joint,
    origin: Vector,
    axis: Vector,
    rollers: tuple[Joint, ...] = (),
    steer: Joint | None = None,
) -> Candidate:
    """Return the candidate of a joint; without ``steer`` the nearest upright joint above it steers."""
    above = robot.moving_above(joint)
    steer = steer or next((j for j in above if robot.upright(j)), None)
    shape = robot.round_shape(joint.child, origin, axis)
    return Candidate(joint, origin, axis, shape, steer, tuple(j for j in above if j != steer), rollers)


def _on_ground(robot: Robot, wheels: Sequence[Candidate]) -> list[Candidate]:
    """Return the wheels whose lowest point is that of all, within 0.35 r + 5 mm.

    A wheel that is a mesh is on the ground if its axle is above the ground, but not higher than the largest radius of a
    wheel on the ground or of a controller.
    """
    shaped = [w for w in wheels if w.shape]
    if not shaped:
        return _low_meshes(robot, wheels)
    lowest = min(w.lowest for w in shaped)
    standing = [w for w in shaped if w.lowest - lowest <= w.radius * SUNK + EVEN]
    reach = _largest_radius(robot, standing)
    least = reach / 20 + EVEN
    meshes = [w for w in wheels if not w.shape and least < w.centre[2] - lowest <= UNSEEN + reach]
    return [w for w in wheels if w in standing or w in meshes]


def _low_meshes(robot: Robot, wheels: Sequence[Candidate]) -> list[Candidate]:
    """Return the lowest of wheels that are all meshes; if only castors are that low, those that drive as well."""
    lowest = min((w.centre[2] for w in wheels), default=Fraction(0))
    highest = lowest + _largest_radius(robot, ())
    if all(_trails(robot, w) for w in wheels if w.centre[2] <= highest):
        above = (w.centre[2] for w in wheels if w.steer is None)
        highest = min((z for z in above if z <= lowest + 4 * UNSEEN), default=highest)
    return [w for w in wheels if w.centre[2] <= highest]


def _trails(robot: Robot, c: Candidate) -> bool:
    """Return whether a wheel is a castor: its centre is ahead of or behind its steering axis."""
    if c.steer is None:
        return False
    off = plus(c.centre, robot.origin(c.steer), -1)
    return abs(off[0] * c.axis[1] - off[1] * c.axis[0]) > EVEN


def _largest_radius(robot: Robot, standing: Sequence[Candidate]) -> Fraction:
    """Return the largest radius [m] that a wheel may have: of those on the ground, and of what controllers give."""
    given = []
    for controller in robot.description.controllers:
        given += [length.value for key, length in controller.lengths.items() if "radius" in key]
    return max(UNSEEN, *given, *(w.radius for w in standing), UNSEEN)
