"""Which joints are wheels: by geometry, not by names.

A wheel turns without end about a level axis, carries nothing that moves but rollers, and stands on the ground, the
lowest that there is. Where fewer than two do, fixed joints that say wheel, hub or an axis are taken, with a question.
What turns so and is none is passed over in words.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.frames import dot, plus, transposed, turned, unit
from wmrgen.tools.importing.passed import (
    LIES,
    LIMITED,
    UNTOLD,
    Passed,
    called_wheel,
    coaxial,
    no_wheel,
    nothing_told,
    of_legs,
    off_the_ground,
    wheel_like,
)
from wmrgen.tools.importing.records import RIGID, Joint, Vector
from wmrgen.tools.importing.view import COAXIAL, EVEN, SUNK, UNSEEN, UPRIGHT, Candidate, Robot, Z

LEVEL = math.sin(math.radians(12))
ROLLERS = 4  # that a wheel with rollers has at least
_FOLLOWS = re.compile("cast[eo]r", re.IGNORECASE)


def candidates(robot: Robot) -> tuple[list[Candidate], list[Passed]]:
    """The wheels, in the order of the file; after them what stands rigid beside them and looks like them. With what
    looks like a wheel, and why it is none."""
    joints = [j for j in robot.description.joints if robot.reaches(j.child)]
    turning = [c for joint in joints if (c := _spin(robot, joint) or _steer_only(robot, joint))]
    rollers = {roller.child for c in turning for roller in c.rollers}
    turning = [c for c in turning if c.joint.child not in rollers]
    passed = [none for c in turning if (none := no_wheel(robot, c, turning))]
    passed += of_legs(robot, turning, passed)
    spins = [c for c in turning if all(c.joint is not each.joint for each in passed)]
    wheels = _mirrored(_on_ground(robot, spins), spins)
    wheels += [c for joint in joints if (c := _limited(robot, joint)) and any(_mirrors(c, w) for w in wheels)]
    rolling = {c.joint.name for c in wheels}
    upright = [j for j in joints if j.name not in rolling and _stands_upright(robot, j)]
    driven = [j for j in upright if j.name in (robot.description.driven or ())]
    passed += [Passed(j, LIES) for j in driven]
    if len(driven) > max(1, len(wheels)):  # the z of the frame is across
        return [], passed
    if len(wheels) < 2:
        bodies = _bodies(robot, spins + _all_fixed(robot))
        wheels, spins = _on_ground(robot, bodies), [c for c in spins if any(c is body for body in bodies)]
        passed += [Passed(j, UNTOLD) for j in joints if not j.moves and nothing_told(robot, j, wheels)]
        passed += [Passed(j, LIES) for j in upright if j not in driven]
        passed += [Passed(j, LIMITED) for j in joints if called_wheel(j) and _limited(robot, j)]
    else:
        wheels += [c for c in rigid_wheels(robot, wheels) if _alike(c, wheels)]
    passed += [
        Passed(c.joint, off_the_ground(c, wheels))
        for c in spins
        if all(c.joint is not w.joint for w in wheels) and wheel_like(c, wheels)
    ]
    return wheels, passed


def _alike(c: Candidate, wheels: list[Candidate]) -> bool:
    """What stands rigid beside wheels that turn, as large as they, and is none of their parts nor a castor."""
    if not c.shape or "wheel" not in c.joint.child.lower() or _FOLLOWS.search(c.joint.name + c.joint.child):
        return False
    own = all(c.joint.parent != w.joint.child and w.joint not in c.via for w in wheels)
    return own and any(w.shape and abs(w.radius - c.radius) < c.radius / 100 for w in wheels)


def _bodies(robot: Robot, wheels: list[Candidate]) -> list[Candidate]:
    """Each body once: what a wheel carries rigidly is a part of it, and a rigid axle that carries two is none."""
    under = [{id(joint) for joint in robot.under(c.joint.child, rigid=True)} for c in wheels]
    parts = [[other for other in wheels if id(other.joint) in below] for below in under]
    axles = [not c.joint.moves and len(own) > 1 for c, own in zip(wheels, parts, strict=True)]
    carried = [part for own, axle in zip(parts, axles, strict=True) if not axle for part in own]
    return [c for c, axle in zip(wheels, axles, strict=True) if not axle and all(c is not p for p in carried)]


def _stands_upright(robot: Robot, joint: Joint) -> bool:
    """What is called a wheel turns without end about an upright axis, and carries nothing that moves."""
    turns = joint.spins and robot.upright(joint) and not robot.moving_below(joint.child)
    return turns and called_wheel(joint)


def _apart(c: Candidate, other: Candidate) -> bool:
    between = plus(c.centre, other.centre, -1)
    return dot(between, between) > c.radius**2


def _mirrored(wheels: list[Candidate], spins: list[Candidate]) -> list[Candidate]:
    """With the wheels those that do not stand, as they are drawn, and whose mirror images do: the drawing is wrong; or
    that hang on a rocker with one that does, as the rocker is drawn."""
    both, standing = list[Candidate](), {c.joint.name for c in wheels}
    for c in spins:
        if c.joint.name in standing:
            both.append(c)
        elif c.shape and not c.via and (other := next((w for w in wheels if _mirrors(c, w)), None)):
            own, others = float(c.radius), float(other.radius)
            why = f"it is drawn with radius {own:.6g}, as if in the air, its mirror image with {others:.6g}"
            both.append(replace(c, shape=None, doubt=why))
        elif (other := next((w for w in wheels if _rocking(c, w)), None)) and wheel_like(c, wheels):
            why = f"it hangs on one rocker with {quoted(other.joint.name)}, and {off_the_ground(c, wheels)}"
            both.append(replace(c, doubt=why))
    return both


def _rocking(c: Candidate, other: Candidate) -> bool:
    """Two wheels hang on one joint that turns about an axis like theirs, and are about as high."""
    rockers = [j for j in c.via if j.turns and any(j is each for each in other.via)]
    return bool(rockers) and abs(c.centre[2] - other.centre[2]) < 2 * max(c.radius, other.radius, UNSEEN)


def _mirrors(c: Candidate, other: Candidate) -> bool:
    """The axles of two wheels stand at one height and place, left and right of the middle."""
    (x, y, z), (u, v, w) = c.origin, other.origin
    near = (abs(off) < EVEN / 5 for off in (x - u, y + v, z - w))
    return all(near) and abs(dot(c.axis, other.axis)) > COAXIAL


def rigid_wheels(robot: Robot, wheels: Sequence[Candidate]) -> list[Candidate]:
    """What stands on the ground beside the wheels and looks like one, on joints that are all fixed; not what is drawn
    in the place of a wheel."""
    others = [c for c in _all_fixed(robot) if all(c.joint is not w.joint and _apart(c, w) for w in wheels)]
    standing = _on_ground(robot, [*wheels, *others])
    return [c for c in others if c in standing]


def _all_fixed(robot: Robot) -> list[Candidate]:
    joints = (j for j in robot.description.joints if not j.moves and robot.reaches(j.child))
    return [c for joint in joints if (c := _fixed(robot, joint)) and not no_wheel(robot, c, ())]


def _spin(robot: Robot, joint: Joint) -> Candidate | None:
    if not joint.spins:
        return None
    moving = robot.moving_below(joint.child)
    leaves = all(j.spins and not robot.moving_below(j.child) for j in moving)
    if moving and not (leaves and len(moving) >= ROLLERS):
        return None
    candidate = _candidate(robot, joint, robot.origin(joint), robot.axis(joint), tuple(moving))
    if joint.axis is None and candidate.shape is None:
        candidate = _as_drawn(robot, candidate)
    if abs(candidate.axis[2]) <= LEVEL:
        return _without_axis(robot, candidate)
    if abs(candidate.axis[2]) >= UPRIGHT and candidate.steer is not None and not candidate.via:
        why = "its axis is upright, as that of the steering joint above it"
        return replace(candidate, shape=None, doubt=why, unsure=True)
    return None


def _limited(robot: Robot, joint: Joint) -> Candidate | None:
    """What would be a wheel if it turned without end."""
    if not joint.turns or joint.spins or robot.moving_below(joint.child) or abs(robot.axis(joint)[2]) > LEVEL:
        return None
    why = "its joint has limits, and its mirror image turns without end"
    return replace(_candidate(robot, joint, robot.origin(joint), robot.axis(joint)), doubt=why)


def _as_drawn(robot: Robot, candidate: Candidate) -> Candidate:
    """A joint without <axis> turns about 1 0 0, which is seldom meant: its cylinder says what is."""
    joint, why = candidate.joint, "it has no <axis>, so 1 0 0"
    if cylinder := _cylinder(robot, joint.child):
        _, axis = cylinder
        shape = robot.round_shape(joint.child, candidate.origin, axis)
        why += ", which is not that of its cylinder"
        return replace(candidate, axis=axis, shape=shape, doubt=why, unsure=True)
    if not robot.roles(joint.child):
        return replace(candidate, doubt=f"{why}, and nothing is drawn of it", unsure=True)
    return candidate


def _without_axis(robot: Robot, candidate: Candidate) -> Candidate:
    """With what a steering joint without <axis>, or one about the same axle, makes doubtful."""
    if candidate.doubt:
        return candidate
    if candidate.steer is None:
        silent = [j for j in candidate.via if j.turns and j.axis is None]
        if silent:
            why = (
                f"{quoted(silent[0].name)} has no <axis>, so 1 0 0; it is taken for an upright steering axis"
            )
            rest = tuple(j for j in candidate.via if j is not silent[0])
            upright = turned(transposed(robot.frame(silent[0].child).rotation), Z)
            return replace(candidate, steer=replace(silent[0], axis=upright), via=rest, doubt=why)
        turning = (j for j in candidate.via if j.turns)
        if same := [j for j in turning if coaxial(candidate, robot.origin(j), robot.axis(j))]:
            return replace(candidate, doubt=f"{quoted(same[0].name)} above it turns about the same axle")
    return candidate


def _steer_only(robot: Robot, joint: Joint) -> Candidate | None:
    """A wheel that its joint steers and that has none to roll about: its axis is that of its cylinder."""
    if joint.spins or not robot.upright(joint) or robot.moving_below(joint.child):
        return None
    cylinder = _cylinder(robot, joint.child)
    if cylinder is None or abs(cylinder[1][2]) > LEVEL:
        return None
    body = replace(joint, name=joint.child, kind=RIGID)
    candidate = _candidate(robot, body, *cylinder, steer=joint)
    return replace(candidate, doubt="it steers, and the file has no joint about which the wheel turns")


def _cylinder(robot: Robot, link: str) -> tuple[Vector, Vector] | None:
    """The centre and the axis of the first cylinder of a link, the sense chosen forward; None where it has none."""
    cylinders = (where for kind, _, _, where in robot.shapes(link) if kind == "cylinder")
    return next(((where.origin, _forward(unit(turned(where.rotation, Z)))) for where in cylinders), None)


def _forward(axis: Vector) -> Vector:
    """The sense of an axle in which the wheel rolls forward, or to the right."""
    forward = axis[1] > 0 or (axis[1] == 0 and axis[0] < 0)
    return axis if forward else (-axis[0], -axis[1], -axis[2])


def _fixed(robot: Robot, joint: Joint) -> Candidate | None:
    """A wheel without a joint of its own: its axis is that which the fixed joint bears, or that of its cylinder. What
    is fixed to a body that tilts, and on which others turn, is a part of an arm."""
    tilting = (j for j in robot.moving_above(joint) if j.turns and not robot.upright(j))
    beyond = robot.moving_below(next((j.child for j in tilting), joint.child))
    if robot.moving_below(joint.child) or any(j.turns for j in beyond):
        return None
    named = re.search("wheel|hub|tire|tyre", f"{joint.name} {joint.child}", re.IGNORECASE)
    drawn = _cylinder(robot, joint.child) if named else None
    axle = (robot.origin(joint), robot.axis(joint)) if joint.axis else drawn
    if axle is None or abs(axle[1][2]) > LEVEL:
        return None
    candidate = _candidate(robot, joint, *axle)
    if not (named or candidate.shape):
        return None
    return replace(candidate, doubt="its joint is fixed: the file has no joint about which the wheel turns")


def _candidate(
    robot: Robot,
    joint: Joint,
    origin: Vector,
    axis: Vector,
    rollers: tuple[Joint, ...] = (),
    steer: Joint | None = None,
) -> Candidate:
    """A joint with ``rollers`` on its wheel; without ``steer`` the nearest upright one above it steers."""
    above = robot.moving_above(joint)
    steer = steer or next((j for j in above if robot.upright(j)), None)
    shape = robot.round_shape(joint.child, origin, axis)
    return Candidate(joint, origin, axis, shape, steer, tuple(j for j in above if j != steer), rollers)


def _on_ground(robot: Robot, wheels: list[Candidate]) -> list[Candidate]:
    """Those whose lowest point is that of all, within 0.35 r + 5 mm; of meshes those whose axle is above the ground,
    and not higher than a wheel's that stands, or than a controller says."""
    shaped = [w for w in wheels if w.shape]
    if not shaped:
        reach, lowest = _reach(robot, ()), min((w.centre[2] for w in wheels), default=Fraction(0))
        highest = lowest + reach
        # Where castors alone stand so low, what drives is larger.
        if all(_trails(robot, w) for w in wheels if w.centre[2] <= highest):
            above = (w.centre[2] for w in wheels if w.steer is None)
            highest = min((z for z in above if z <= lowest + 4 * UNSEEN), default=highest)
        return [w for w in wheels if w.centre[2] <= highest]
    lowest = min(w.lowest for w in shaped)
    standing = [w for w in shaped if w.lowest - lowest <= w.radius * SUNK + EVEN]
    reach = _reach(robot, standing)
    least = reach / 20 + EVEN
    meshes = [w for w in wheels if not w.shape and least < w.centre[2] - lowest <= UNSEEN + reach]
    return [w for w in wheels if w in standing or w in meshes]


def _trails(robot: Robot, c: Candidate) -> bool:
    """A castor, by where it stands from its steering axis."""
    if c.steer is None:
        return False
    off = plus(c.centre, robot.origin(c.steer), -1)
    return abs(off[0] * c.axis[1] - off[1] * c.axis[0]) > EVEN


def _reach(robot: Robot, standing: Sequence[Candidate]) -> Fraction:
    """The largest radius that a wheel may have: of those that stand, and of what controllers say."""
    told = (s.value for c in robot.description.controllers for key, s in c.lengths.items() if "radius" in key)
    return max(UNSEEN, *told, *(w.radius for w in standing), UNSEEN)
