"""What the wheels are: type, place, heading, radius, trail, rollers, motors, and what must be asked."""

from __future__ import annotations

import math
from collections.abc import Collection
from fractions import Fraction

from wmrgen.robotfile.text import quoted
from wmrgen.robotfile.wheel_types.types import CASTOR, FIXED, STEERED, SWEDISH
from wmrgen.tools.importing.candidates import LEVEL, candidates
from wmrgen.tools.importing.couplings import couplings
from wmrgen.tools.importing.frames import ancestors, dot, plus
from wmrgen.tools.importing.instructions import skid_track
from wmrgen.tools.importing.kinds import Subject, types_asked
from wmrgen.tools.importing.passed import with_gears
from wmrgen.tools.importing.questions import (
    CONFLICT,
    TRAIL,
    axle_asked,
    ball_asked,
    doubt,
    heights_noted,
    mesh_radius,
    other_height,
    planes_asked,
    radius_doubted,
    roller_reach,
    rollers_asked,
    rollers_doubted,
    size_asked,
    swivel_doubts,
    tilted,
)
from wmrgen.tools.importing.read import refuse
from wmrgen.tools.importing.records import DIGITS, Description, Imported, Joint, Question, Vector, Wheel
from wmrgen.tools.importing.robot_file import near_wheel_names
from wmrgen.tools.importing.robot_questions import (
    DIRECTIONS,
    articulated,
    corner_asked,
    front_doubted,
    motors_unknown,
    odd_one_asked,
    steering_missed,
    support_asked,
    tool_asked,
    undrawn_asked,
)
from wmrgen.tools.importing.rollers import UNSAID, angle, gamma_said, heading, rollers_said
from wmrgen.tools.importing.view import Candidate, Robot, X, base_link

_TURN = Fraction(6)  # [rad] a range of steering angles beyond which it is not one
_BACKWARD = -0.94  # cosine of a heading that is straight back, by and large


def import_wheels(description: Description, base: str | None, forward: str | None = None) -> Imported:
    """The wheels of a description in the frame of its link ``base``, turned so that its direction ``forward`` is x.

    RobotFileError where there is none, or one that nothing drives: it may be anything that turns.
    """
    robot = Robot(description, base_link(description, base), DIRECTIONS[forward or "x"])
    wheels, passed = candidates(robot)
    robot.description = description = with_gears(description, passed)
    seen = [*(each.note for each in passed), *description.notes]
    if len(wheels) < 2 and not any(c.shape and not c.doubt and _actuated(robot, c) for c in wheels):
        raise refuse(
            f"{quoted(wheels[0].joint.name)} alone is a wheel" if wheels else "0 joints are wheels",
            " ".join(
                (
                    "A wheel's joint turns without end about a level axis and is the lowest of all.",
                    *(f"Note: {note}." for note in seen[:3]),
                )
            ),
            "Give the link that is the base frame with --base, or write the robot file by hand.",
        )
    names = near_wheel_names([c.joint.name for c in wheels])
    rolling = rollers_said(robot, wheels)
    powered = {c.steer.name if c.steer else "" for c in wheels if _actuated(robot, c)}
    read = [_wheel(robot, c, name, rolling, powered) for c, name in zip(wheels, names, strict=True)]
    result = [wheel for wheel, _ in read]
    coupled, doubts, notes = couplings(robot, result)
    questions = [
        *(question for _, asked in read for question in asked),
        *planes_asked(robot, result, wheels),
        *motors_unknown(result),
        *articulated(robot, result, wheels),
        *corner_asked(result),
        *odd_one_asked(result),
        *undrawn_asked(robot, result, wheels),
        *tool_asked(robot, result, wheels),
        *steering_missed(result, wheels),
        *([] if forward else front_doubted(robot, result, wheels)),
        *doubts,
    ]
    questions += types_asked(Subject(robot, result, wheels), questions)
    support = support_asked(robot, result, wheels, passed)
    if questions or any(question.hints for question in support):
        questions += support
    notes += [question.text for question in support if question not in questions]
    notes += heights_noted(robot, wheels, names)
    above = sorted({j.name for c in wheels for j in c.via})
    notes += [f"joint {quoted(name)} moves above wheels and is taken at zero" for name in above]
    if forward not in (None, "x"):
        notes.append(f"x is the direction {forward} of {quoted(robot.base)}")
    track = skid_track(result, description.controllers)
    return Imported(
        description.name, robot.base, tuple(result), tuple(questions), coupled, (*seen, *notes), track
    )


def _wheel(
    robot: Robot, c: Candidate, name: str, rolling: str, powered: Collection[str]
) -> tuple[Wheel, list[Question]]:
    """A wheel and what is asked of it; ``powered``: steering joints of wheels that have motors, "" of those without."""
    joint, steer = c.joint, c.steer
    e = X if abs(c.axis[2]) > LEVEL else heading(c.axis)
    questions: list[Question] = []
    x, y, _ = c.centre
    d = offset = None
    where = f"joint {quoted(joint.name)}" if joint.moves else f"link {quoted(joint.child)}"
    place = f"centre of the {c.shape.words} of {where}" if c.shape else where
    remarks = {"x": place, "heading": f"axis of {where}"}
    if steer is not None:
        foot, tilt = _pivot(robot.origin(steer), robot.axis(steer), c.centre)
        lever = plus(c.centre, foot, -1)
        d, offset = (round(dot(lever, along), DIGITS) for along in (e, (-e[1], e[0], Fraction(0))))
        x, y, _ = foot
        remarks["x"] = f"steering axis of joint {quoted(steer.name)}, wheel: {place}"
        if robot.axis(steer)[2] < 0:
            remarks["joints"] = f"{quoted(steer.name)} points down: its angle is -{name}.steer"
        if tilt > 1:
            questions.append(tilted(name, foot, tilt))
    actuated, stops = _actuated(robot, c), _steer_limits(robot, steer)
    gamma, source = gamma_said(robot, c, e)
    kind, why = _type(c, d, actuated, rolling if source == UNSAID and not steer else source)
    if why:
        remarks["type"] = "; ".join(filter(None, [remarks.get("type", ""), why]))
    if c.doubt:
        questions.append(doubt(c, name, angle(e), kind))
    if kind == SWEDISH.name:
        remarks["gamma"] = source
        if gamma is None:
            questions.append(rollers_asked(name, why))
    elif steer:
        said = robot.description
        transmitted = steer.name in said.transmitted - (frozenset() if "" in powered else said.commanded)
        stray = "" in powered and steer.name not in powered and -c.radius < (offset or 0) < c.radius
        bodiless = steer.spins and steer.name in said.transmitted and not robot.roles(steer.child)
        questions += swivel_doubts(
            name, kind, d or Fraction(0), actuated, transmitted, rolling, stray, bodiless, stops
        )
    elif powered and actuated == () and c.shape and not c.shape.cylinder:
        questions.append(ball_asked(name))
    questions += axle_asked(robot, c, name)
    radius, doubts = _size(robot, c, name, remarks)
    questions += doubts
    if e[0] < _BACKWARD and kind != CASTOR.name:
        remarks["heading"] += ", reversed: it rolls backward for a positive rate"
    wheel = Wheel(
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
        stops,
        remarks,
        steer is not None and robot.axis(steer)[2] < 0,
    )
    return wheel, questions


def _size(
    robot: Robot, c: Candidate, name: str, remarks: dict[str, str]
) -> tuple[Fraction | None, list[Question]]:
    """The radius, and what is asked of it; what is not is remarked."""
    if not c.shape:
        if bound := mesh_radius(robot, c):
            radius, remarks["r"] = bound
            return radius, []
        return None, [size_asked(robot, c, name)]
    remarks["r"] = f"{c.shape.words} of {remarks['heading'].removeprefix('axis of ')}"
    reach = roller_reach(robot, c)
    if reach and abs(reach / c.radius - 1) > CONFLICT:
        return c.radius, [rollers_doubted(c, name, reach)]
    height = other_height(robot, c)
    if not height:
        return c.radius, []
    remarks["r"] += f"; the axle is {float(height):.6g} m above what seems the ground"
    return c.radius, [radius_doubted(robot, c, name, height)] if c.doubt or not c.shape.cylinder else []


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
        least = c.radius / 10 + Fraction(3, 2000) if actuated and "steer" in actuated else TRAIL
        if abs(d) > least:
            return CASTOR.name, ""
        return (
            STEERED.name,
            f"its contact lies {float(d):.2g} m off the steering axis, taken as 0" if d else "",
        )
    return (SWEDISH.name, rolling) if rolling else (FIXED.name, "")
