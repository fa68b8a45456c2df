"""What the wheels are: type, place, heading, radius, trail, rollers and motors, with the questions of all rules."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import chain

from wmrgen.robotfile.text import quoted
from wmrgen.robotfile.wheel_types.types import CASTOR, FIXED, STEERED, SWEDISH
from wmrgen.tools.importing import robot_questions, type_questions, wheel_questions
from wmrgen.tools.importing.candidates import candidates
from wmrgen.tools.importing.couplings import couplings
from wmrgen.tools.importing.frames import ancestors, dot, plus
from wmrgen.tools.importing.instructions import skid_track
from wmrgen.tools.importing.read import refuse
from wmrgen.tools.importing.records import DIGITS, Description, Imported, Joint, Question, Vector, Wheel
from wmrgen.tools.importing.rejections import with_gears
from wmrgen.tools.importing.robot_file import near_wheel_names
from wmrgen.tools.importing.rollers import UNSAID, angle, gamma_said, heading, rollers_said
from wmrgen.tools.importing.subject import Subject, asked_once
from wmrgen.tools.importing.view import LEVEL, Candidate, Robot, X, base_link

_TURN = Fraction(6)  # [rad] a range of steering angles beyond which it is not one
_BACKWARD = -0.94  # cosine of a heading that is straight back, by and large


def import_wheels(description: Description, base: str | None, forward: str | None = None) -> Imported:
    """Return the wheels of a description in the frame of a link.

    Args:
        description: What the file says.
        base: The name of the link; None: the link that looks like the robot's.
        forward: The direction of the link's frame that is x of the robot; None: x, and it may be asked.

    Returns:
        The wheels with their questions.

    Raises:
        RobotFileError: There is no wheel, or a single one that nothing drives, which may be anything that turns.
    """
    robot = Robot(description, base_link(description, base), robot_questions.DIRECTIONS[forward or "x"])
    found, seen = candidates(robot)
    robot.description = description = with_gears(description, seen)
    notes = [*(each.note for each in seen), *description.notes]
    _refuse_fewer_than_two(robot, found, notes)
    names = near_wheel_names([c.joint.name for c in found])
    rolling = rollers_said(robot, found)
    wheels = [_wheel(robot, c, name, rolling) for c, name in zip(found, names, strict=True)]
    coupled, doubts, other_notes = couplings(robot, wheels)
    subject = Subject(robot, wheels, found, rolling, seen, forward is not None)
    questions, left = _questions(subject, doubts)
    notes += [*other_notes, *(question.text for question in left)]
    notes += wheel_questions.heights_noted(robot, found, names)
    above = sorted({j.name for c in found for j in c.via})
    notes += [f"joint {quoted(name)} moves above wheels and is taken at zero" for name in above]
    if forward not in (None, "x"):
        notes.append(f"x is the direction {forward} of {quoted(robot.base)}")
    track = skid_track(wheels, description.controllers)
    return Imported(
        description.name, robot.base, tuple(wheels), tuple(questions), coupled, tuple(notes), track
    )


def _refuse_fewer_than_two(robot: Robot, found: Sequence[Candidate], notes: Sequence[str]) -> None:
    """Raise RobotFileError if there is no wheel, or one alone that nothing drives."""
    if len(found) > 1 or any(c.shape and not c.doubt and _actuated(robot, c) for c in found):
        return
    rule = "A wheel's joint turns without end about a level axis and is the lowest of all."
    raise refuse(
        f"{quoted(found[0].joint.name)} alone is a wheel" if found else "0 joints are wheels",
        " ".join((rule, *(f"Note: {note}." for note in notes[:3]))),
        "Give the link that is the base frame with --base, or write the robot file by hand.",
    )


def _questions(subject: Subject, doubts: Sequence[Question]) -> tuple[list[Question], list[Question]]:
    """Return the questions, and those that are only notes because nothing else is asked.

    Args:
        subject: The robot and its wheels.
        doubts: The questions about couplings.

    Returns:
        Questions and notes.
    """
    of_wheels = (
        question
        for wheel, c in subject.pairs
        for each in wheel_questions.RULES
        for question in each.check(subject, wheel, c)
    )
    of_robot = (question for each in robot_questions.RULES for question in each.check(subject))
    of_types = (question for each in type_questions.RULES for question in each.check(subject))
    questions = asked_once(chain(of_wheels, of_robot, doubts, of_types))
    last = [question for each in robot_questions.LAST for question in each.check(subject)][:1]
    if questions or any(question.hints for question in last):
        return [*questions, *last], []
    return questions, last


def _wheel(robot: Robot, c: Candidate, name: str, rolling: str) -> Wheel:
    """Return a wheel; ``rolling`` is what says of all wheels that they have rollers."""
    joint, steer = c.joint, c.steer
    e = X if abs(c.axis[2]) > LEVEL else heading(c.axis)
    where = f"joint {quoted(joint.name)}" if joint.moves else f"link {quoted(joint.child)}"
    place = f"centre of the {c.shape.words} of {where}" if c.shape else where
    remarks = {"x": place, "heading": f"axis of {where}"}
    (x, y, _), d, offset = c.centre, None, None
    if steer is not None:
        x, y, _ = foot = _pivot(robot.origin(steer), robot.axis(steer), c.centre)
        lever = plus(c.centre, foot, -1)
        d, offset = (round(dot(lever, along), DIGITS) for along in (e, (-e[1], e[0], Fraction(0))))
        remarks["x"] = f"steering axis of joint {quoted(steer.name)}, wheel: {place}"
        if robot.axis(steer)[2] < 0:
            remarks["joints"] = f"{quoted(steer.name)} points down: its angle is -{name}.steer"
    actuated = _actuated(robot, c)
    gamma, source = gamma_said(robot, c, e)
    kind, why = _type(c, d, actuated, rolling if source == UNSAID and not steer else source)
    if why:
        remarks["type"] = why
    if kind == SWEDISH.name:
        remarks["gamma"] = source
    radius, remarks["r"] = _radius(robot, c, remarks["heading"].removeprefix("axis of "))
    if e[0] < _BACKWARD and kind != CASTOR.name:
        remarks["heading"] += ", reversed: it rolls backward for a positive rate"
    return Wheel(
        name,
        joint.name if joint.moves else None,
        steer.name if steer else None,
        kind,
        round(x, DIGITS),
        round(y, DIGITS),
        angle(e),
        radius and round(radius, DIGITS),
        d,
        offset,
        gamma if kind == SWEDISH.name else None,
        actuated,
        _steer_limits(robot, steer),
        remarks,
        steer is not None and robot.axis(steer)[2] < 0,
    )


def _radius(robot: Robot, c: Candidate, body: str) -> tuple[Fraction | None, str]:
    """Return the radius [m] of a wheel's shape, else of its mesh, and where it is from."""
    if not c.shape:
        return wheel_questions.mesh_radius(robot, c) or (None, "")
    source = f"{c.shape.words} of {body}"
    height = wheel_questions.other_height(robot, c)
    if height:
        source += f"; the axle is {float(height):.6g} m above what seems the ground"
    return c.radius, source


def _steer_limits(robot: Robot, steer: Joint | None) -> tuple[Fraction, Fraction] | None:
    """The steering angles that the file allows, where it limits them to less than a turn to either side."""
    if steer is None or steer.spins or not steer.limits:
        return None
    low, high = steer.limits
    if not (low <= 0 <= high and low < high and high - low < _TURN):
        return None
    return (low, high) if robot.axis(steer)[2] > 0 else (-high, -low)


def _pivot(point: Vector, axis: Vector, centre: Vector) -> Vector:
    """Return where a steering axis passes the height of the wheel's centre."""
    return plus(point, axis, (centre[2] - point[2]) / axis[2])


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
    for _, names in joints:  # those that lead them, and those that lead these
        while more := {leads[name] for name in names if name in leads} - names:
            names |= more
    return tuple(key for key, names in joints if driven & names)


def _type(
    c: Candidate, d: Fraction | None, actuated: tuple[str, ...] | None, rolling: str
) -> tuple[str, str]:
    """The type, and what it is taken from where that is not plain."""
    if c.rollers:
        return SWEDISH.name, f"{len(c.rollers)} rollers turn on it"
    if d is not None:
        least = (
            c.radius / 10 + Fraction(3, 2000) if actuated and "steer" in actuated else wheel_questions.TRAIL
        )
        if abs(d) > least:
            return CASTOR.name, ""
        return (
            STEERED.name,
            f"its contact lies {float(d):.2g} m off the steering axis, taken as 0" if d else "",
        )
    return (SWEDISH.name, rolling) if rolling else (FIXED.name, "")
