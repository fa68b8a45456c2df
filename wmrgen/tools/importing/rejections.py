"""Rules that reject what turns as a wheel does: limbs, propellers, gears, joints in the air or with limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import NamedTuple

from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.frames import across, dot, plus
from wmrgen.tools.importing.records import Description, Joint, Vector
from wmrgen.tools.importing.rule import Rule, rule
from wmrgen.tools.importing.view import COAXIAL, EVEN, LEVEL, SUNK, Candidate, Robot

_ROUND = 0.4  # of the largest distance from the axle: the mesh of a wheel reaches as far to every side
_FEW = 16  # wheels on one axle; a hostile file has hundreds
_CHAIN = 4  # joints that turn above a wheel on a leg, in addition to the one that steers it


@dataclass(frozen=True, slots=True)
class Rejected:
    """A joint that turns as a wheel's does, and ``why`` it is none."""

    joint: Joint
    why: str
    code: str = ""  # of the rule
    axle: tuple[str, ...] = ()  # joints of the wheels between which it is the gear of a differential

    @property
    def note(self) -> str:
        return f"joint {quoted(self.joint.name)} is not taken for a wheel: {self.why}"


class Sight(NamedTuple):
    """A robot, all joints that turn as wheels do, and those that earlier rules rejected."""

    robot: Robot
    turning: Sequence[Candidate]
    rejected: Sequence[Rejected] = ()
    origins: Sequence[Sequence[float]] = ()  # of ``turning``, rounded: exact numbers of many pairs take long


# Each returns why a candidate is no wheel, or "".
REJECTIONS: list[Rule[Callable[[Sight, Candidate], str]]] = []
# Each returns why a joint that is not among the wheels is none, or "".
REMARKS: list[Rule[Callable[[Robot, Joint, Sequence[Candidate]], str]]] = []
_LIMBS = ("reaches to one side", "chain of joints", "propeller")


def rejected(robot: Robot, turning: Sequence[Candidate]) -> list[Rejected]:
    """Return the candidates that a rule rejects, rule by rule."""
    result: list[Rejected] = []
    origins = [tuple(map(float, c.origin)) for c in turning]
    for each in REJECTIONS:
        sight = Sight(robot, turning, tuple(result), origins)
        taken = {id(rejection.joint) for rejection in result}
        for c in turning:
            if id(c.joint) not in taken and (why := each.check(sight, c)):
                ends = _axle(sight, c) if each.code == "gear of a differential" else ()
                result.append(Rejected(c.joint, why, each.code, tuple(w.joint.name for w in ends)))
    return result


def remarks(robot: Robot, joints: Sequence[Joint], wheels: Sequence[Candidate]) -> list[Rejected]:
    """Return the joints that look like wheels and are none of ``wheels``.

    Args:
        robot: The description.
        joints: The joints that no rule has accepted or rejected.
        wheels: The wheels.

    Returns:
        Each joint with the reason of the first rule that has one.
    """
    result = []
    for joint in joints:
        for each in REMARKS:
            if why := each.check(robot, joint, wheels):
                result.append(Rejected(joint, why, each.code))
                break
    return result


def called_wheel(joint: Joint) -> bool:
    """Return whether the name of a joint or of its link says that it is a wheel."""
    return "wheel" in f"{joint.name} {joint.child}".lower()


def coaxial(c: Candidate, origin: Vector, axis: Vector) -> bool:
    """Return whether an axis through a point is the axle of a wheel.

    Args:
        c: The wheel.
        origin: The point [m].
        axis: The unit vector of the axis.

    Returns:
        True if the axis is parallel to the axle, and the point is on it.
    """
    aside = across(plus(origin, c.origin, -1), c.axis)
    return dot(aside, aside) < EVEN**2 and abs(dot(axis, c.axis)) > COAXIAL


def with_gears(description: Description, seen: Sequence[Rejected]) -> Description:
    """Return the description in which a motor on the gear of a differential drives the wheels of its axle."""
    driven = description.driven or frozenset()
    wheels = {joint for each in seen if each.joint.name in driven for joint in each.axle}
    return replace(description, driven=driven | wheels) if wheels else description


# ---- rules for candidates


@rule(
    REJECTIONS,
    "drawn for a controller",
    "A wheel in the middle of an axle that is only drawn would be one wheel more.",
    "carlikebot (ros-controls/ros2_control_demos, example 11): its virtual wheels, which the real ones mimic",
)
def _drawn_alone(sight: Sight, c: Candidate) -> str:
    robot = sight.robot
    if robot.roles(c.joint.child) != {"visual"}:
        return ""
    own = {c.joint.name, c.steer.name if c.steer else ""}
    for w in sight.turning:
        follows = any(j and j.mimic and j.mimic[0] in own for j in (w.joint, w.steer))
        if follows and "collision" in robot.roles(w.joint.child):
            return "it is drawn, touches nothing, and others mimic it"
    return ""


@rule(
    REJECTIONS,
    "propeller",
    "The propellers of a drone or a boat turn without end, and one with a level axis may be the lowest part.",
    "engine.xacro of the WAM-V (osrf/vrx): its propellers turn about x and are its lowest parts",
)
def _propeller(sight: Sight, c: Candidate) -> str:
    names = {name.rsplit("::", 1)[-1] for name in (c.joint.name, c.joint.child)}
    pushes = names & sight.robot.description.pushing
    return "a plugin has it push air or water, as a propeller does" if pushes else ""


@rule(
    REJECTIONS,
    "reaches to one side",
    "A flipper turns about a level axis and touches the ground, but it does not roll.",
    "taurob_tracker_description (TW-Robotics/taurob_simulation): flippers beside its tracks",
)
def _reaches_aside(sight: Sight, c: Candidate) -> str:
    robot = sight.robot
    roles = c.shape.words if c.shape else "collision visual"
    bodies = [where for shape, where in robot.body(c.joint.child) if shape.role in roles and not shape.uri]
    offs = [across(plus(where.origin, c.origin, -1), c.axis) for where in bodies]
    far = max(offs, key=lambda off: dot(off, off), default=c.origin)
    balanced = not offs or any(dot(far, off) < 0 for off in offs)
    if not balanced and dot(far, far) > c.radius**2:
        reach = math.sqrt(dot(far, far))
        return f"its body reaches {reach:.3g} m to one side of the axle, as a flipper or an arm does"
    bounds = max(robot.bounds(c), key=lambda b: b.least, default=None)
    if not bounds or bounds.least >= _ROUND:
        return ""
    near = bounds.least * bounds.radius
    return f"its mesh is not round: it reaches {bounds.radius:.3g} m from the axle, and {near:.3g} m to another side"


@rule(
    REJECTIONS,
    "chain of joints",
    "The fingers at the end of an arm turn without end, and the arm may hang to the ground.",
    "pr2: six or seven joints of an arm turn between its fingers and the base",
)
def _chain(sight: Sight, c: Candidate) -> str:
    above = [j for j in sight.robot.moving_above(c.joint) if j.turns and j is not c.steer]
    few: float = _CHAIN if c.joint.moves else _CHAIN // 2
    if c.shape and c.joint.moves:  # a cylinder is drawn for a wheel on a leg, and for a leg's motors
        few = math.inf if called_wheel(c.joint) else _CHAIN - 1
    if len(above) <= few:
        return ""
    return f"{len(above)} joints turn between it and {quoted(sight.robot.base)}, as in an arm or a leg"


@rule(
    REJECTIONS,
    "gear of a differential",
    "The ring of a differential turns on the axle of the rear wheels without reaching the ground.",
    "racecar_differential.urdf (bulletphysics/bullet3): its differential rings",
)
def _gear(sight: Sight, c: Candidate) -> str:
    ends = _axle(sight, c)
    if not ends:
        return ""
    robot = sight.robot
    own, radius = _radius(robot, c), max(_radius(robot, w) for w in ends)
    if own and (not radius or own >= radius * float(1 - SUNK) - float(EVEN)):
        return ""
    reach = (
        f"it reaches {own:.3g} m from it, they {radius:.3g} m" if own else "nothing says how far it reaches"
    )
    between = " and ".join(quoted(end.joint.name) for end in ends)
    return f"it turns in the middle of the axle of {between}, and {reach}: the gear of a differential"


def _radius(robot: Robot, c: Candidate) -> float:
    """Return the radius of a wheel's shape, else how far its meshes reach from the axle [m]; 0 if neither is known."""
    return float(c.radius) if c.shape else max((reach.radius for reach in robot.bounds(c)), default=0.0)


def _is_aside(point: Sequence[float], middle: Sequence[float], direction: Sequence[float]) -> bool:
    """Return whether a point is clearly not on an axle, by rounded numbers.

    Args:
        point: The point [m].
        middle: A point of the axle [m].
        direction: The unit vector of the axle.
    """
    off = [a - b for a, b in zip(point, middle, strict=True)]
    ahead = sum(a * b for a, b in zip(off, direction, strict=True))
    return sum(a * a for a in off) - ahead**2 > 2 * float(EVEN) ** 2


def _axle(sight: Sight, c: Candidate) -> tuple[Candidate, ...]:
    """Return two unsteered candidates on the axle of ``c``, each the mirror image of the other in its middle."""
    if c.steer or not c.joint.moves:
        return ()
    on_axle, middle, direction = [], tuple(map(float, c.origin)), tuple(map(float, c.axis))
    for w, origin in zip(sight.turning, sight.origins, strict=True):
        if _is_aside(origin, middle, direction):
            continue
        aside = across(plus(w.origin, c.origin, -1), c.axis)
        if w is not c and not w.steer and dot(aside, aside) < EVEN**2 and abs(dot(w.axis, c.axis)) > COAXIAL:
            on_axle.append(w)
    for a, b in combinations(on_axle[:_FEW], 2):
        off = plus(plus(a.origin, b.origin), c.origin, -2)
        if dot(off, off) < EVEN**2:
            return a, b
    return ()


@rule(
    REJECTIONS,
    "beside a limb",
    "The motors of legs turn without end beside the hip, and one may be the lowest part with a level axis.",
    "minitaur.urdf (bulletphysics/bullet3): two motors turn the bars of each leg",
)
def _beside_limb(sight: Sight, c: Candidate) -> str:
    robot = sight.robot
    above = [j.name for j in robot.moving_above(c.joint) if j is not c.steer]
    for limb in sight.rejected:
        if limb.code not in _LIMBS:
            continue
        for j in robot.moving_above(limb.joint):
            if j.turns and not robot.upright(j) and (j.name in above or _near(robot, c, j)):
                return f"it is beside a limb that {quoted(j.name)} turns"
    return ""


def _near(robot: Robot, c: Candidate, joint: Joint) -> bool:
    """Return whether a joint turns about the axle of a wheel, within the wheel's radius of it."""
    origin = robot.origin(joint)
    off = plus(origin, c.origin, -1)
    return dot(off, off) < c.radius**2 and coaxial(c, origin, robot.axis(joint))


# ---- rules for joints that are not among the wheels


@rule(
    REMARKS,
    "in the air",
    "A steering wheel, a gimbal or a finger turns as wheels do, and is not on the ground.",
    "three cars of the collection of 72: the steering wheel of the driver",
)
def _in_the_air(robot: Robot, joint: Joint, wheels: Sequence[Candidate]) -> str:
    if not wheels or not joint.spins or abs(robot.axis(joint)[2]) > LEVEL or robot.moving_below(joint.child):
        return ""
    shape = robot.round_shape(joint.child, robot.origin(joint), robot.axis(joint))
    as_large = shape and any(w.shape and w.radius == shape.radius for w in wheels)
    if not called_wheel(joint) and not as_large:
        return ""
    lowest = shape.centre[2] - shape.radius if shape else robot.origin(joint)[2]
    shaped = [w.lowest for w in wheels if w.shape]
    height = float(lowest - min(shaped or [w.lowest for w in wheels]))
    side = "below" if height < 0 else "above"
    what = "it stands" if shape else "its axle lies"
    return f"{what} {abs(height):.3g} m {side} the ground on which the wheels stand"


@rule(
    REMARKS,
    "upright axis",
    "A body as CAD exports it has z across, and no joint that is called a wheel has a level axis.",
    "a public lesson, repository unknown: its caster_wheel_joint turns a ball about z",
)
def _lies(robot: Robot, joint: Joint, wheels: Sequence[Candidate]) -> str:
    turns = joint.spins and robot.upright(joint) and not robot.moving_below(joint.child)
    return "its axis is upright" if turns and called_wheel(joint) else ""


@rule(
    REMARKS,
    "limits",
    "A wheel's joint with limits is no wheel, which the user may have written by mistake.",
    "Prius.urdf (RobotLocomotion/drake, issue 2476): joints of wheels that are revolute",
)
def _limited(robot: Robot, joint: Joint, wheels: Sequence[Candidate]) -> str:
    turns = joint.turns and not joint.spins and called_wheel(joint)
    if not turns or robot.moving_below(joint.child) or abs(robot.axis(joint)[2]) > LEVEL:
        return ""
    return "it has limits, and turns no further"
