"""What must be asked of an imported robot, because its file does not say it or says two things."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from wmrgen.importing.candidates import Candidate, Robot
from wmrgen.importing.records import Question, Vector, Wheel
from wmrgen.spec.text import quoted
from wmrgen.wheels.types import FIXED, STEERED

CONFLICT = Fraction(1, 100)  # part of a radius by which two sources may differ
_GROUND = ("base_footprint",)


def doubt(c: Candidate, name: str) -> Question:
    return Question(
        name,
        "heading" if c.unsure else "type",
        f"joint {quoted(c.joint.name)}: {c.doubt}. Is it a wheel that stands so?",
    )


def tilted(name: str, foot: Vector, tilt: float) -> Question:
    text = f"the steering axis leans by {tilt:.3g} deg: is the pivot at the height of the axle, or on the ground?"
    return Question(name, "x", text, (f"at the axle x = {float(foot[0]):.6g}, y = {float(foot[1]):.6g}",))


def rollers_asked(name: str, why: str) -> Question:
    text = (
        "which way do the rollers stand? Look at the wheel from above, through it at the roller that touches the "
        "ground (those on top cross it): gamma is the angle from the rolling direction to that roller's axis, "
        "counter-clockwise"
    )
    hints = ("0 for an omni wheel", "pi/4 or -pi/4 for a mecanum wheel; diagonal wheels have the same", why)
    return Question(name, "gamma", text, tuple(filter(None, hints)))


def trail_asked(name: str, d: Fraction) -> Question:
    text = f"the contact lies {float(d):.6g} m off the steering axis along the rolling direction: meant, or drawn so?"
    return Question(name, "type", text, ("steered (then it is 0)", f"castor, with d: {float(d):.6g}"))


def radius_asked(robot: Robot, c: Candidate, name: str) -> Question:
    text = "no cylinder or sphere about the axle gives the radius: measure it, ground to axle under load"
    hints = [
        f"the axle is {float(c.centre[2] - robot.frame(link).origin[2]):.6g} m above {link}, which may be the ground"
        for link in _GROUND
        if link in robot.description.links and robot.reaches(link)
    ]
    return Question(name, "r", text, tuple(hints))


def other_height(robot: Robot, c: Candidate) -> Fraction | None:
    """The height of an axle above the frame that seems to be the ground, where it is near the radius, but not that."""
    ground = (link for link in _GROUND if link in robot.description.links and robot.reaches(link))
    link = next(ground, robot.base)
    height = c.centre[2] - robot.frame(link).origin[2]
    near = Fraction(1, 2) < height / c.radius < Fraction(3, 2)
    return height if near and abs(height / c.radius - 1) > CONFLICT else None


def radius_doubted(c: Candidate, name: str, height: Fraction) -> Question:
    """A sphere is seldom drawn as large as the wheel; a cylinder is believed."""
    text = "the radius that is drawn is not the height of the axle above what seems the ground: which is it?"
    return Question(
        name, "r", text, (f"{float(c.radius):.6g} as drawn", f"{float(height):.6g} above the ground")
    )


def motors_unknown(wheels: Sequence[Wheel]) -> list[Question]:
    """Where the file drives nothing, and some wheels steer and others not: by default all would be driven."""
    steering = [w for w in wheels if w.type == STEERED.name]
    if any(w.actuated is not None for w in wheels) or not any(w.type == FIXED.name for w in wheels):
        return []
    text = "the file does not say which joints are driven"
    return [Question(w.name, "actuated", text, ("[steer]", "[spin, steer]")) for w in steering]
