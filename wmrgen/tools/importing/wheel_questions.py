"""Rules that ask about one wheel, because the file does not say something or says two things."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction

from wmrgen.robotfile.text import quoted
from wmrgen.robotfile.wheel_types.types import CASTOR, FIXED, STEERED, SWEDISH
from wmrgen.tools.importing.records import DIGITS, Question, Wheel
from wmrgen.tools.importing.rule import rule
from wmrgen.tools.importing.subject import Subject, WheelRule
from wmrgen.tools.importing.view import Candidate, Robot

CONFLICT = Fraction(1, 100)  # part of a radius by which two sources may differ
TRAIL = Fraction(1, 1000)  # [m] a smaller distance from the steering axis makes no castor
_TILTED = math.cos(math.radians(1))  # of a steering axis; less is rounding
_LARGEST = 5  # [m] the radius of a wheel
_GROUND = "base_footprint"  # the end of the name of a link

RULES: list[WheelRule] = []


@rule(
    RULES,
    "inclined steering axis",
    "The trail of a castor or of a kingpin depends on the height at which the axis is taken.",
    "cart_front_steer_sdf: kingpins inclined by 5 to 10 degrees",
)
def _tilted(subject: Subject, wheel: Wheel, c: Candidate) -> Iterator[Question]:
    if c.steer is None:
        return
    upright = abs(float(subject.robot.axis(c.steer)[2]))
    if upright >= _TILTED:
        return
    tilt = math.degrees(math.acos(min(1.0, upright)))
    text = f"the steering axis leans by {tilt:.3g} deg: is the pivot at the height of the axle, or on the ground?"
    hint = f"at the axle x = {float(wheel.x):.6g}, y = {float(wheel.y):.6g}"
    yield Question(wheel.name, "x", text, (hint,))


@rule(
    RULES,
    "doubtful joint",
    "A wheel whose joint is fixed, or whose axis is not written, is a guess.",
    "pioneer3dx, festo_robotino: fixed joints; ranger_mini_v2: an axis that is not level",
)
def _doubted(subject: Subject, wheel: Wheel, c: Candidate) -> Iterator[Question]:
    if not c.doubt:
        return
    where = "if the axle lies along y where the steering angle is 0"
    if c.shape:
        where = "by the axis of its cylinder"
    elif c.joint.axis is None:
        where = "about 1 0 0"
    rollers = ("swedish, with gamma, where it has rollers",) if wheel.type == FIXED.name else ()
    hints: tuple[str, ...] = (f"{wheel.type}, where it is one", *rollers)
    if c.unsure:
        hints = (f"{wheel.heading or 0.0:.6g} {where}",)
    text = f"joint {quoted(c.joint.name)}: {c.doubt}. Is it a wheel that stands so?"
    yield Question(wheel.name, "heading" if c.unsure else "type", text, hints)


@rule(
    RULES,
    "swivel of a robot with rollers",
    "Wheels with rollers on passive swivels of a simulator are read as a swerve drive.",
    "kuka_youbot, of the collection of 72",
)
def _swivel_with_rollers(subject: Subject, wheel: Wheel, c: Candidate) -> Iterator[Question]:
    if c.steer and wheel.type != SWEDISH.name and subject.rolling:
        text = f"{subject.rolling}, and here the wheel swivels: does the robot have this swivel?"
        yield Question(wheel.name, "type", text, ("swedish, where it has not",))


@rule(
    RULES,
    "steered wheel beside its axis",
    "CAD noise of some millimetres looks like the trail of a castor that a motor steers.",
    "jpl_osr: d = 6 mm",
)
def _steered_beside(subject: Subject, wheel: Wheel, c: Candidate) -> Iterator[Question]:
    d = wheel.d or Fraction(0)
    if wheel.type == STEERED.name and abs(d) > TRAIL:
        text = f"the contact lies {float(d):.6g} m off the steering axis along the rolling direction: is that meant?"
        hints = ("steered (then it is 0)", f"castor, with d: {float(d):.6g}")
        yield Question(wheel.name, "type", text, hints)


@rule(
    RULES,
    "passive steering axis",
    "A castor that is drawn without trail is read as a steered wheel, which no motor steers.",
    "a public rover, repository unknown: its caster_fork_joint is straight above its caster_wheel_joint",
)
def _passive(subject: Subject, wheel: Wheel, c: Candidate) -> Iterator[Question]:
    powered = subject.powered
    stray = "" in powered and wheel.steer_joint not in powered
    if wheel.type == STEERED.name and stray and abs(wheel.offset_y or Fraction(0)) < c.radius:
        text = "nothing turns its steering axis, on which it stands: does it trail, as castors do, or is it fixed?"
        hints = ("castor, with d as measured", "steered, where a motor turns it")
        yield Question(wheel.name, "type", text, hints)


@rule(
    RULES,
    "swivel without a body",
    "A swivel that only a transmission names, and that has no body, need not exist.",
    "kuka_youbot, of the collection of 72: casters that do not exist",
)
def _bodiless(subject: Subject, wheel: Wheel, c: Candidate) -> Iterator[Question]:
    steer, robot = c.steer, subject.robot
    if wheel.type != STEERED.name or steer is None or not steer.spins:
        return
    if steer.name in robot.description.transmitted and not robot.roles(steer.child):
        text = "no body is drawn between the robot and its wheel, and only a transmission names its swivel"
        hints = ("steered, where it has", "swedish, where it has not and the wheel has rollers")
        yield Question(wheel.name, "type", f"{text}: does the robot have it?", hints)


@rule(
    RULES,
    "castor with a transmission",
    "A transmission is no proof of a motor: the swivels of a drive with pivots have one.",
    "kelo_robile_4w",
)
def _transmitted(subject: Subject, wheel: Wheel, c: Candidate) -> Iterator[Question]:
    said = subject.robot.description
    proven = frozenset() if "" in subject.powered else said.commanded
    if wheel.type != CASTOR.name or wheel.steer_joint not in said.transmitted - proven or subject.rolling:
        return
    text = "the swivel has a transmission: does a motor turn it, or does it follow?"
    rest = ", ".join(key for key in wheel.actuated or () if key != "steer")
    yield Question(wheel.name, "actuated", text, (f"[{rest}]", f"[{', '.join(wheel.actuated or ())}]"))


@rule(
    RULES,
    "sphere that nothing drives",
    "The ball of a castor that a simulator turns about one axle is read as a plain wheel.",
    "six public copies of one lesson's robot: front_caster_joint and back_caster_joint turn balls of 15 mm about y",
)
def _ball(subject: Subject, wheel: Wheel, c: Candidate) -> Iterator[Question]:
    passive = not c.steer and subject.powered and wheel.actuated == ()
    if passive and wheel.type == FIXED.name and c.shape and not c.shape.cylinder:
        text = "a sphere that nothing drives: does it roll any way, as the ball of a castor, or about its axle alone?"
        hints = ("spherical, where it rolls any way", "fixed, about its axle alone")
        yield Question(wheel.name, "type", text, hints)


@rule(
    RULES,
    "radius",
    "The radius of a wheel that is a mesh is in no number of the description.",
    "axebot, care_o_bot_4, rby1a and 20 others of the collection of 72",
)
def _no_radius(subject: Subject, wheel: Wheel, c: Candidate) -> Iterator[Question]:
    if wheel.r is None:
        yield size_question(subject.robot, c, wheel.name)


@rule(
    RULES,
    "radius against height",
    "A sphere is seldom drawn as large as the wheel, and the axle has another height above the ground.",
    "neobotix_mp_400, neobotix_mpo_700, pioneer3dx",
)
def _other_radius(subject: Subject, wheel: Wheel, c: Candidate) -> Iterator[Question]:
    height = other_height(subject.robot, c) if c.shape else None
    if not height or not c.shape or (c.shape.cylinder and not c.doubt):
        return
    text = "the radius that is drawn is not the height of the axle above what seems the ground: which is it?"
    told = (f"{float(r):.6g} by {quoted(key)}" for key, r in _radii_told(subject.robot))
    hints = (f"{float(c.radius):.6g} as drawn", f"{float(height):.6g} above the ground", *told)
    yield Question(wheel.name, "r", text, tuple(dict.fromkeys(hints)))


def _height_above_ground(robot: Robot, c: Candidate) -> tuple[str, Fraction] | None:
    links = (link for link in robot.description.links if link.endswith(_GROUND))
    ground = next(filter(robot.reaches, links), None)
    return None if ground is None else (ground, c.centre[2] - robot.frame(ground).origin[2])


def mesh_radius(robot: Robot, c: Candidate) -> tuple[Fraction, str] | None:
    """The radius by the mesh of a wheel [m], to the micrometre, and where it is from. None where that is not sure: for
    several meshes, of collisions else of visuals, for one that is not round, and where the other meshes, a plugin or
    the height above the ground say another."""
    meshes = sorted((mesh for mesh in robot.meshes(c) if mesh.reach), key=lambda mesh: mesh.role)
    own = [mesh for mesh in meshes if mesh.role == meshes[0].role]
    bounds = own[0].reach if len(own) == 1 else None
    if not bounds or not bounds.round or bounds.radius > _LARGEST or c.unsure or c.rollers:
        return None
    drawn = sorted(mesh.reach.radius for mesh in meshes[1:] if mesh.reach)
    told = [float(radius) for _, radius in _radii_told(robot)]
    ground = _height_above_ground(robot, c)
    others = (drawn[-1:], told, [float(ground[1])] if ground else [])
    for radii in others:
        if radii and not any(abs(radius / bounds.radius - 1) <= CONFLICT for radius in radii):
            return None
    return Fraction(round(bounds.radius * 10**6), 10**6), f"bound of the {own[0].words} about the axle"


def size_question(robot: Robot, c: Candidate, name: str) -> Question:
    """Return the question for a radius, with a hint for each number that may be it.

    Args:
        robot: The description.
        c: The joint of the wheel.
        name: The name of the wheel.

    Returns:
        The question.
    """
    text = "no cylinder or sphere about the axle gives the radius: measure it, ground to axle under load"
    seen = () if c.unsure else robot.meshes(c)
    hints = [
        f"{mesh.reach.radius:.6g} by the {mesh.words}{_in_millimetres(mesh.reach.radius)}"
        for mesh in seen
        if mesh.reach
    ]
    if ground := _height_above_ground(robot, c):
        hints.append(f"the axle is {float(ground[1]):.6g} m above {ground[0]}, which may be the ground")
    hints += [f"{float(r):.6g} by {quoted(key)}" for key, r in _radii_told(robot)]
    for kind, role, radius, _ in robot.shapes(c.joint.child):
        if kind == "cylinder":
            hints.append(f"{float(radius):.6g} by a {role} cylinder, which does not lie along the axle")
    return Question(name, "r", text, tuple(dict.fromkeys(hints)))


def _in_millimetres(radius: float) -> str:
    """What a radius is in metres that no wheel has [m]."""
    return f", or {radius / 1000:.6g} if its unit is the millimetre" if radius > _LARGEST else ""


def _radii_told(robot: Robot) -> list[tuple[str, Fraction]]:
    """What drive plugins say of radii, by the names that they have there."""
    told = [item for each in robot.description.controllers for item in each.lengths.items()]
    return [(said.key, said.value) for key, said in told if "radius" in key]


def other_height(robot: Robot, c: Candidate) -> Fraction | None:
    """The height of an axle above the frame that seems to be the ground, where it is near the radius, but not that."""
    above = _height_above_ground(robot, c)
    height = above[1] if above else c.centre[2]
    near = Fraction(1, 2) < height / c.radius < Fraction(3, 2)
    return height if near and abs(height / c.radius - 1) > CONFLICT else None


def heights_noted(robot: Robot, seen: Sequence[Candidate], names: Sequence[str]) -> Iterator[str]:
    """Yield a note for each height above the frame of the ground that contradicts the cylinders of wheels.

    The frame of the ground of public descriptions is often not on the ground (neobotix_mp_400, pr2), so the cylinder is
    used.

    Args:
        robot: The description.
        seen: The joints of the wheels.
        names: The names of the wheels.
    """
    wheels: dict[tuple[str, float, float], list[str]] = {}
    for c, name in zip(seen, names, strict=True):
        above = _height_above_ground(robot, c)
        if above and c.shape and c.shape.cylinder and other_height(robot, c):
            key = above[0], round(float(above[1]), DIGITS), float(c.radius)
            wheels.setdefault(key, []).append(name)
    for (ground, height, radius), own in wheels.items():
        axles = f"{', '.join(own)}: the axle is {height:.6g} m above {ground}"
        yield f"{axles}, and the cylinder has the radius {radius:.6g} m, which is used"
