"""Which joints are wheels: by geometry, not by names.

A wheel turns without end about a level axis, carries nothing that moves but rollers, and stands on the ground, the
lowest that there is. Where fewer than two do, fixed joints that say wheel, hub or an axis are taken, with a question.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from wmrgen.importing.frames import (
    ancestors,
    composed,
    dot,
    inverse,
    parents,
    plus,
    pose,
    turned,
    unit,
)
from wmrgen.importing.read import refuse
from wmrgen.importing.records import MODEL, RIGID, Description, Frame, Joint, Vector
from wmrgen.spec.text import quoted

LEVEL, UPRIGHT = math.sin(math.radians(12)), math.cos(math.radians(15))
COAXIAL = 0.99  # cosine
ROLLERS = 4  # that a wheel with rollers has at least
UNSEEN = Fraction(5, 100)  # [m] the radius of a wheel that is a mesh, where one must be supposed
X, Z = (Fraction(1), Fraction(0), Fraction(0)), (Fraction(0), Fraction(0), Fraction(1))


@dataclass(frozen=True, slots=True)
class Round:
    """The largest coaxial cylinder or sphere of a wheel: ``words`` say which."""

    radius: Fraction
    centre: Vector
    words: str
    cylinder: bool


@dataclass(frozen=True, slots=True)
class Candidate:
    """A joint that may be a wheel's, in the base frame: ``axis`` through ``origin``. ``steer``: the nearest joint above
    that turns about an upright axis, ``via`` what else moves above. ``doubt`` says
    why that may be wrong, ``unsure`` that the axis of the wheel itself is."""

    joint: Joint
    origin: Vector
    axis: Vector
    shape: Round | None
    steer: Joint | None
    via: tuple[Joint, ...]
    rollers: tuple[Joint, ...]
    doubt: str = ""
    unsure: bool = False

    @property
    def centre(self) -> Vector:
        return self.shape.centre if self.shape else self.origin

    @property
    def radius(self) -> Fraction:
        return self.shape.radius if self.shape else UNSEEN

    @property
    def lowest(self) -> Fraction:
        return self.centre[2] - (self.shape.radius if self.shape else 0)


class Robot:
    """A description seen from its base frame, of which the direction ``forward`` is taken for x."""

    def __init__(self, description: Description, base: str, forward: tuple[int, int] = (1, 0)) -> None:
        self.description, self.base = description, base
        self.above = parents(description.joints)
        c, s = map(Fraction, forward)
        turn = Frame(((c, s, Z[0]), (-s, c, Z[0]), Z), (Z[0], Z[0], Z[0]))
        self._to_base = composed(turn, inverse(pose(base, self.above)))
        self._trunk = {joint.child for joint in ancestors(base, self.above)}
        self._root = self._root_of(base)
        self._below: dict[str, list[Joint]] = {}
        for joint in description.joints:
            self._below.setdefault(joint.parent, []).append(joint)

    def _root_of(self, link: str) -> str:
        chain = ancestors(link, self.above)
        return chain[-1].parent if chain else link

    def frame(self, link: str) -> Frame:
        return composed(self._to_base, pose(link, self.above))

    def reaches(self, link: str) -> bool:
        """The link hangs on the same root as the base."""
        return self._root_of(link) == self._root

    def moving_above(self, joint: Joint) -> list[Joint]:
        """Joints that move between a link and the base, nearest first."""
        return [j for j in ancestors(joint.parent, self.above) if j.moves and j.child not in self._trunk]

    def moving_below(self, link: str) -> list[Joint]:
        return [joint for joint in self.under(link) if joint.moves]

    def under(self, link: str, rigid: bool = False) -> list[Joint]:
        """All joints below a link; with ``rigid`` only what is fixed to it."""
        reached: list[Joint] = []
        waiting = [link]
        while waiting:
            for joint in self._below.get(waiting.pop(), []):
                if not (rigid and joint.moves):
                    reached.append(joint)
                    waiting.append(joint.child)
        return reached

    def origin(self, joint: Joint) -> Vector:
        """A point of the joint's axis."""
        frame = self.frame(joint.child)
        return plus(turned(frame.rotation, joint.pivot), frame.origin)

    def axis(self, joint: Joint) -> Vector:
        return unit(turned(self.frame(joint.child).rotation, joint.axis or X))

    def upright(self, joint: Joint) -> bool:
        return joint.turns and abs(self.axis(joint)[2]) >= UPRIGHT

    def shapes(self, link: str) -> Iterator[tuple[str, str, Fraction, Frame]]:
        """Kind, role, radius and frame of the cylinders and spheres of a link and of what is fixed to it."""
        for each in (link, *(joint.child for joint in self.under(link, rigid=True))):
            for shape in self.description.shapes.get(each, ()):
                if shape.radius:
                    yield shape.kind, shape.role, shape.radius, composed(self.frame(each), shape.frame)

    def balls(self, link: str) -> Iterator[tuple[Vector, Fraction]]:
        """Centre and lowest height of the cylinders and spheres of a link itself."""
        for shape in self.description.shapes.get(link, ()):
            if shape.radius:
                centre = composed(self.frame(link), shape.frame).origin
                yield centre, centre[2] - shape.radius

    def round_shape(self, link: str, origin: Vector, axis: Vector) -> Round | None:
        """The largest coaxial cylinder or sphere, of the collision before the visual."""
        shapes = []
        for kind, role, radius, where in self.shapes(link):
            along = turned(where.rotation, Z)
            reach = plus(where.origin, origin, -1)
            share = dot(reach, axis)
            off = plus(reach, axis, -share)
            if dot(off, off) <= (radius / 5) ** 2 and (kind == "sphere" or abs(dot(along, axis)) >= COAXIAL):
                centre = plus(origin, axis, share)
                shapes.append(
                    (role == "collision", radius, Round(radius, centre, f"{role} {kind}", kind == "cylinder"))
                )
        return max(shapes, key=lambda s: s[:2])[2] if shapes else None


def candidates(robot: Robot) -> list[Candidate]:
    """The wheels, in the order of the file."""
    joints = [j for j in robot.description.joints if robot.reaches(j.child)]
    spins = [c for joint in joints if (c := _spin(robot, joint) or _steer_only(robot, joint))]
    rollers = {roller.child for c in spins for roller in c.rollers}
    spins = [c for c in spins if c.joint.child not in rollers and not _shown_only(robot, c)]
    wheels = _on_ground(robot, spins)
    return wheels if len(wheels) > 1 else _on_ground(robot, spins + _all_fixed(robot))


def rigid_wheels(robot: Robot, wheels: Sequence[Candidate]) -> list[Candidate]:
    """What stands on the ground beside the wheels and looks like one, on joints that are all fixed."""
    others = [c for c in _all_fixed(robot) if all(c.joint is not w.joint for w in wheels)]
    standing = _on_ground(robot, [*wheels, *others])
    return [c for c in others if c in standing]


def _all_fixed(robot: Robot) -> list[Candidate]:
    joints = (j for j in robot.description.joints if not j.moves and robot.reaches(j.child))
    return [c for joint in joints if (c := _fixed(robot, joint))]


def _shown_only(robot: Robot, c: Candidate) -> bool:
    """A wheel that is drawn and touches nothing, and that others mimic: a controller's, not the robot's."""
    leaders = {joint.mimic[0] for joint in robot.description.joints if joint.mimic}
    roles = {role for _, role, _, _ in robot.shapes(c.joint.child)}
    return roles == {"visual"} and bool(leaders & {c.joint.name, c.steer.name if c.steer else ""})


def _spin(robot: Robot, joint: Joint) -> Candidate | None:
    if not joint.spins:
        return None
    moving = robot.moving_below(joint.child)
    leaves = all(j.spins and not robot.moving_below(j.child) for j in moving)
    if moving and not (leaves and len(moving) >= ROLLERS):
        return None
    above = robot.moving_above(joint)
    steer = next((j for j in above if robot.upright(j)), None)
    candidate = _candidate(robot, joint, robot.axis(joint), steer, above, tuple(moving))
    if abs(candidate.axis[2]) <= LEVEL:
        return _without_axis(robot, candidate)
    if abs(candidate.axis[2]) >= UPRIGHT and steer is not None and above and above[0] == steer:
        why = "its axis is upright, as that of the steering joint above it"
        return replace(candidate, shape=None, doubt=why, unsure=True)
    return None


def _without_axis(robot: Robot, candidate: Candidate) -> Candidate:
    """Joints without <axis> turn about 1 0 0, which is seldom meant."""
    joint = candidate.joint
    others = [turned(w.rotation, Z) for kind, _, _, w in robot.shapes(joint.child) if kind == "cylinder"]
    if joint.axis is None and candidate.shape is None and others:
        axis = _forward(unit(others[0]))
        shape = robot.round_shape(joint.child, candidate.origin, axis)
        why = "it has no <axis>, so 1 0 0, which is not that of its cylinder"
        return replace(candidate, axis=axis, shape=shape, doubt=why, unsure=True)
    if candidate.steer is None:
        silent = [j for j in candidate.via if j.turns and j.axis is None]
        if silent:
            why = f"{quoted(silent[0].name)} has no <axis>, so 1 0 0; it is taken for a steering axis, 0 0 1"
            return replace(candidate, steer=replace(silent[0], axis=Z), doubt=why)
        if same := [j for j in candidate.via if j.turns and _coaxial(robot, j, candidate)]:
            return replace(candidate, doubt=f"{quoted(same[0].name)} above it turns about the same axle")
    return candidate


def _coaxial(robot: Robot, joint: Joint, c: Candidate) -> bool:
    """A joint turns about a wheel's own axle."""
    reach = plus(robot.origin(joint), c.origin, -1)
    off = plus(reach, c.axis, -dot(reach, c.axis))
    return dot(off, off) < (UNSEEN / 10) ** 2 and abs(dot(robot.axis(joint), c.axis)) > COAXIAL


def _steer_only(robot: Robot, joint: Joint) -> Candidate | None:
    """A wheel that its joint steers and that has none to roll about: its axis is that of its cylinder."""
    if joint.spins or not robot.upright(joint) or robot.moving_below(joint.child):
        return None
    axis = _level_cylinder(robot, joint.child)
    if axis is None:
        return None
    body = replace(joint, name=joint.child, kind=RIGID)
    above = robot.moving_above(joint)
    candidate = _candidate(robot, body, axis, joint, above, ())
    return replace(candidate, doubt="it steers, and the file has no joint about which the wheel turns")


def _level_cylinder(robot: Robot, link: str) -> Vector | None:
    """The axis of the first cylinder of a link, the sense chosen forward; None where it is not level."""
    along = [turned(w.rotation, Z) for kind, _, _, w in robot.shapes(link) if kind == "cylinder"]
    if not along or abs(along[0][2]) > LEVEL:
        return None
    return _forward(unit(along[0]))


def _forward(axis: Vector) -> Vector:
    """The sense of an axle in which the wheel rolls forward, or to the right."""
    forward = axis[1] > 0 or (axis[1] == 0 and axis[0] < 0)
    return axis if forward else (-axis[0], -axis[1], -axis[2])


def _fixed(robot: Robot, joint: Joint) -> Candidate | None:
    """A wheel without a joint of its own: its axis is that which the fixed joint bears, or that of its cylinder."""
    if robot.moving_below(joint.child):
        return None
    if joint.axis is not None:
        axis: Vector | None = robot.axis(joint)
    else:
        named = re.search("wheel|hub", f"{joint.name} {joint.child}", re.IGNORECASE)
        axis = _level_cylinder(robot, joint.child) if named else None
    if axis is None or abs(axis[2]) > LEVEL:
        return None
    above = robot.moving_above(joint)
    candidate = _candidate(robot, joint, axis, next((j for j in above if robot.upright(j)), None), above, ())
    return replace(candidate, doubt="its joint is fixed: the file has no joint about which the wheel turns")


def _candidate(
    robot: Robot,
    joint: Joint,
    axis: Vector,
    steer: Joint | None,
    above: Sequence[Joint],
    rollers: tuple[Joint, ...],
) -> Candidate:
    origin = robot.origin(joint)
    shape = robot.round_shape(joint.child, origin, axis)
    return Candidate(joint, origin, axis, shape, steer, tuple(j for j in above if j != steer), rollers)


def _on_ground(robot: Robot, wheels: list[Candidate]) -> list[Candidate]:
    """Those whose lowest point is that of all, within 0.35 r + 5 mm; of meshes the centre, within a radius, which may
    be that of a controller."""
    told = (s.value for c in robot.description.controllers for key, s in c.lengths.items() if "radius" in key)
    reach = max(UNSEEN, *told, UNSEEN)
    shaped = [w.lowest for w in wheels if w.shape]
    lowest = min(shaped) if shaped else None
    centre = min((w.centre[2] for w in wheels if lowest is None or not w.shape), default=Fraction(0))
    floor = centre if lowest is None else min(centre, lowest + UNSEEN)
    return [w for w in wheels if _stands(w, lowest, floor, reach)]


def _stands(wheel: Candidate, lowest: Fraction | None, floor: Fraction, reach: Fraction) -> bool:
    if wheel.shape and lowest is not None:
        return wheel.lowest - lowest <= wheel.shape.radius * Fraction(35, 100) + Fraction(5, 1000)
    return wheel.centre[2] - floor <= reach


def base_link(description: Description, wanted: str | None) -> str:
    """The link ``wanted``, else `*base_link` nearest the root, else the root that carries most."""
    if wanted is not None:
        if wanted not in description.links:
            raise refuse(
                f"there is no link {quoted(wanted)}",
                "",
                f"Links: {quoted(' '.join(description.links), 300)}.",
            )
        return wanted
    if MODEL in description.links:
        return MODEL
    above = parents(description.joints)
    named = [link for link in description.links if link.endswith("base_link")]
    if named:
        return min(named, key=lambda link: len(ancestors(link, above)))
    carried: dict[str, int] = {}
    for link in description.links:
        chain = ancestors(link, above)
        root = chain[-1].parent if chain else link
        carried[root] = carried.get(root, 0) + 1
    return max(carried, key=lambda root: carried[root])
