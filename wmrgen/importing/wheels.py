"""What the wheels are: type, place, heading, radius, trail, rollers, motors, and what must be asked."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from fractions import Fraction

from wmrgen.errors import Mark, RobotFileError
from wmrgen.importing.candidates import LEVEL, Candidate, Robot, X, base_link, candidates
from wmrgen.importing.couplings import couplings
from wmrgen.importing.frames import ancestors, dot, plus, turned, unit
from wmrgen.importing.questions import (
    TRAIL,
    doubt,
    other_height,
    radius_doubted,
    rollers_asked,
    size_asked,
    swivel_doubts,
    tilted,
)
from wmrgen.importing.read import refuse
from wmrgen.importing.records import Description, Imported, Joint, Question, Vector, Wheel
from wmrgen.importing.robot_questions import (
    DIRECTIONS,
    articulated,
    front_doubted,
    motors_unknown,
    support_asked,
)
from wmrgen.spec.names import wheel_name
from wmrgen.spec.text import Scalar, quoted
from wmrgen.wheels.types import CASTOR, FIXED, STEERED, SWEDISH

_KINDS_OF_JOINT = re.compile("((?i:_(joint|link|wheel|spin|axle|hinge))|Joint|Link|Wheel|Spin|Axle|Hinge)+$")
_TURN = Fraction(6)  # [rad] a range of steering angles beyond which it is not one
UNSAID = "not in the file"
_SAYS_ROLLERS = re.compile("mecanum|omni|planar_?move", re.IGNORECASE)


def import_wheels(description: Description, base: str | None = None, forward: str | None = None) -> Imported:
    """The wheels of a description in the frame of its link ``base``, turned so that its direction ``forward`` is x.

    RobotFileError where there are fewer than two.
    """
    robot = Robot(description, base_link(description, base), DIRECTIONS[forward or "x"])
    wheels = candidates(robot)
    if len(wheels) < 2:
        raise refuse(
            f"{len(wheels)} joints are wheels",
            " ".join(
                (
                    "A wheel's joint turns without end about a level axis and is the lowest of all.",
                    *(f"Note: {note}." for note in description.notes[:3]),
                )
            ),
            "Give the link that is the base frame with --base, or write the robot file by hand.",
        )
    names = _names(wheels)
    rolling = _rollers_said(robot, wheels)
    read = [_wheel(robot, c, name, rolling) for c, name in zip(wheels, names, strict=True)]
    result = [wheel for wheel, _ in read]
    coupled, doubts, notes = couplings(description, result)
    questions = [
        *(question for _, asked in read for question in asked),
        *motors_unknown(result),
        *articulated(result),
        *([] if forward else front_doubted(robot, result, wheels)),
        *doubts,
    ]
    support = support_asked(robot, result, wheels)
    if questions or any(question.hints for question in support):
        questions += support
    notes += [question.text for question in support if question not in questions]
    passed = sorted({j.name for c in wheels for j in c.via})
    notes += [f"joint {quoted(name)} moves above wheels and is taken at zero" for name in passed]
    if forward not in (None, "x"):
        notes.append(f"x is the direction {forward} of {quoted(robot.base)}")
    return Imported(
        description.name, robot.base, tuple(result), tuple(questions), coupled, (*description.notes, *notes)
    )


def _names(wheels: Sequence[Candidate]) -> list[str]:
    """Names for robot files, as near to those of the joints as they may be, none twice in any case of letters."""
    names: list[str] = []
    for number, wheel in enumerate(wheels, 1):
        near = re.sub("[^A-Za-z0-9]+", "_", wheel.joint.name).strip("_")
        short = _KINDS_OF_JOINT.sub("", near)[:28].strip("_")
        tries = (
            t for t in (short, short.lower(), f"{short.lower()}_{number}", f"wheel_{number}") if _may_be(t)
        )
        name = next(tries)
        taken = name.lower() in (other.lower() for other in names)
        names.append(f"{name[:26]}_{number}" if taken else name)
    return names


def _may_be(name: str) -> bool:
    try:
        return bool(wheel_name(Scalar(Mark("", 0, 0, ""), name, True)))
    except RobotFileError:
        return False


def _heading(axis: Vector) -> Vector:
    """The direction in which a wheel rolls that turns about ``axis`` at a positive rate: axis x z, level."""
    return unit((axis[1], -axis[0], Fraction(0)))


def _angle(direction: Vector) -> float:
    return math.atan2(direction[1], direction[0])


def _rollers_said(robot: Robot, wheels: Sequence[Candidate]) -> str:
    """What says, of the whole robot, that its wheels have rollers; empty where nothing does."""
    for word in (*robot.description.words, *(word for c in wheels for word in _called(robot, c))):
        if _SAYS_ROLLERS.search(word):
            return f"the file says {quoted(word)}"
    if any(wheel.steer for wheel in wheels):
        return ""
    axles = [_angle(_heading(w.axis)) for w in wheels if not w.unsure]
    if len(axles) > 2 and any(abs(math.sin(a - b)) > 0.2 for a in axles for b in axles):
        return "plain wheels on axles that are not parallel could not roll"
    return _mirrored(robot, wheels)


def _called(robot: Robot, c: Candidate) -> Iterator[str]:
    """The names of a wheel's joint, links and meshes."""
    yield c.joint.name
    for link in (c.joint.child, *(joint.child for joint in robot.under(c.joint.child, rigid=True))):
        yield link
        yield from (s.uri.rsplit("/", 1)[-1] for s in robot.description.shapes.get(link, ()))


def _mirrored(robot: Robot, wheels: Sequence[Candidate]) -> str:
    """What four meshes say of which the diagonals are alike, and the sides are not."""
    at: dict[tuple[bool, bool], tuple[str, bool]] = {}
    middle = [sum((w.centre[k] for w in wheels), Fraction(0)) / len(wheels) for k in (0, 1)]
    for wheel in wheels:
        mesh = next((s for s in robot.description.shapes.get(wheel.joint.child, ()) if s.uri), None)
        if mesh:
            sx, sy, sz = mesh.scale
            at[wheel.centre[0] > middle[0], wheel.centre[1] > middle[1]] = mesh.uri, sx * sy * sz < 0
    corners = [at.get(place) for place in ((True, True), (False, False), (True, False), (False, True))]
    if len(wheels) != 4 or None in corners:
        return ""
    a, b, c, d = corners
    return (
        "meshes are alike on the diagonals and not on the sides, as of mecanum wheels"
        if a == b != c == d
        else ""
    )


def _wheel(robot: Robot, c: Candidate, name: str, rolling: str) -> tuple[Wheel, list[Question]]:
    joint, steer = c.joint, c.steer
    e = X if abs(c.axis[2]) > LEVEL else _heading(c.axis)
    questions = [] if not c.doubt else [doubt(c, name, _angle(e))]
    x, y, _ = c.centre
    d = offset = None
    where = f"joint {quoted(joint.name)}" if joint.moves else f"link {quoted(joint.child)}"
    place = f"centre of the {c.shape.words} of {where}" if c.shape else where
    remarks = {"x": place, "heading": f"axis of {where}"}
    if steer is not None:
        foot, tilt = _pivot(robot.origin(steer), robot.axis(steer), c.centre)
        lever = plus(c.centre, foot, -1)
        d, offset = dot(lever, e), dot(lever, (-e[1], e[0], Fraction(0)))
        x, y, _ = foot
        remarks["x"] = f"steering axis of joint {quoted(steer.name)}, wheel: {place}"
        if robot.axis(steer)[2] < 0:
            remarks["type"] = f"joint {quoted(steer.name)} points down: its angle is -{name}.steer"
        if tilt > 1:
            questions.append(tilted(name, foot, tilt))
    actuated = _actuated(robot, c)
    gamma, source = _gamma(robot, c, e)
    kind, why = _type(c, d, actuated, rolling if source == UNSAID and not steer else source)
    if why:
        remarks["type"] = "; ".join(filter(None, [remarks.get("type", ""), why]))
    if kind == SWEDISH.name:
        remarks["gamma"] = source
        if gamma is None:
            questions.append(rollers_asked(name, why))
    elif steer:
        transmitted = steer.name in robot.description.transmitted
        questions += swivel_doubts(name, kind, d or Fraction(0), actuated, transmitted, rolling)
    questions += _size_doubts(robot, c, name, offset, remarks)
    wheel = Wheel(
        name,
        joint.name if joint.moves else None,
        steer.name if steer else None,
        kind,
        x,
        y,
        _angle(e),
        c.shape.radius if c.shape else None,
        d,
        offset,
        gamma if kind == SWEDISH.name else None,
        actuated,
        _steer_limits(robot, steer),
        remarks,
    )
    return wheel, questions


def _size_doubts(
    robot: Robot, c: Candidate, name: str, lateral: Fraction | None, remarks: dict[str, str]
) -> list[Question]:
    """What is asked of the radius and of the wheel's plane; what is not is remarked."""
    if not c.shape:
        return list(size_asked(robot, c, name, lateral))
    remarks["r"] = f"{c.shape.words} of {remarks['heading'].removeprefix('axis of ')}"
    height = other_height(robot, c)
    if not height:
        return []
    remarks["r"] += f"; the axle is {float(height):.6g} m above what seems the ground"
    return [radius_doubted(robot, c, name, height)] if c.doubt or not c.shape.cylinder else []


def _steer_limits(robot: Robot, steer: Joint | None) -> tuple[Fraction, Fraction] | None:
    """The steering angles that the file allows, where it limits them to less than a turn to either side."""
    if steer is None or steer.spins or not steer.limits:
        return None
    low, high = steer.limits
    if not (low <= 0 <= high and low < high and high - low < _TURN):
        return None
    return (low, high) if robot.axis(steer)[2] > 0 else (-high, -low)


def _pivot(point: Vector, axis: Vector, centre: Vector) -> tuple[Vector, float]:
    """Where a steering axis passes the height of the wheel's centre, and its inclination [deg]."""
    foot = plus(point, axis, (centre[2] - point[2]) / axis[2])
    return foot, math.degrees(math.acos(min(1.0, abs(float(axis[2])))))


def _actuated(robot: Robot, c: Candidate) -> tuple[str, ...] | None:
    """The joints that the file drives; of a wheel on a fixed joint, by the fixed joints that carry it."""
    driven = robot.description.driven
    if driven is None:
        return None
    leads = {j.name: j.mimic[0] for j in robot.description.joints if j.mimic}
    spins = {c.joint.name}
    if not c.joint.moves:
        rigid = (*ancestors(c.joint.child, robot.above), *robot.under(c.joint.child, rigid=True))
        spins |= {joint.name for joint in rigid if not joint.moves}
    joints = (("spin", spins), ("steer", {c.steer.name} if c.steer else set()))
    return tuple(key for key, names in joints if driven & (names | {leads.get(n, "") for n in names}))


def _type(
    c: Candidate, d: Fraction | None, actuated: tuple[str, ...] | None, rolling: str
) -> tuple[str, str]:
    """The type, and what it is taken from where that is not plain."""
    if c.rollers:
        return SWEDISH.name, f"{len(c.rollers)} rollers turn on it"
    if d is not None:
        least = c.radius / 10 + Fraction(3, 2000) if actuated and "steer" in actuated else TRAIL
        if abs(d) > least:
            return CASTOR.name, ""
        return (
            STEERED.name,
            f"its contact lies {float(d):.2g} m off the steering axis, taken as 0" if d else "",
        )
    return (SWEDISH.name, rolling) if rolling else (FIXED.name, "")


def _gamma(robot: Robot, c: Candidate, e: Vector) -> tuple[float | None, str]:
    """The direction of the roller at the ground from the heading, modulo pi in (-pi/2, pi/2], and its source."""
    if c.rollers:
        lowest = min(c.rollers, key=lambda j: robot.origin(j)[2])
        return _modulo(
            _angle(robot.axis(lowest)) - _angle(e)
        ), f"axis of the lowest roller {quoted(lowest.name)}"
    slanting = _slanting_friction(robot, c, e)
    if slanting is None:
        return None, UNSAID
    gamma, link = slanting
    if link == c.joint.child:
        return (
            None,
            f"fdir1 stands in {quoted(link)}, which turns: {gamma:.6g} rad holds at joint angle 0 alone",
        )
    return gamma, f"fdir1 in {quoted(link)}: full friction along the roller's axis"


def _slanting_friction(robot: Robot, c: Candidate, e: Vector) -> tuple[float, str] | None:
    """The angle from the heading in which the wheel grips, and whose frame says so; None unless that is aslant, or the
    wheel slides freely across it in a frame that does not turn with the wheel, as on rollers alone."""
    friction = robot.description.frictions.get(c.joint.child)
    if not friction or friction.mu2 > friction.mu1 / 10 or friction.link not in robot.description.links:
        return None
    angle = _modulo(_angle(turned(robot.frame(friction.link).rotation, friction.direction)) - _angle(e))
    free = friction.mu2 == 0 and friction.link != c.joint.child
    least, most = (0, 80) if free else (20, 70)
    return (angle, friction.link) if least <= abs(math.degrees(angle)) <= most else None


def _modulo(angle: float) -> float:
    turned_back = math.remainder(angle, math.pi)
    if abs(turned_back) < 1e-12:
        return 0.0
    return turned_back if turned_back > -math.pi / 2 + 1e-12 else math.pi / 2
