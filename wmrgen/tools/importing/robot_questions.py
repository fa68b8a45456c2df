"""Rules that ask about the robot as a whole: its motors, its front, the planes of its wheels, what else carries it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from fractions import Fraction

from wmrgen.robotfile.names import role
from wmrgen.robotfile.text import quoted
from wmrgen.robotfile.wheel_types.types import CASTOR, FIXED, STEERED, SWEDISH
from wmrgen.tools.importing.candidates import rigid_wheels
from wmrgen.tools.importing.frames import ancestors, plus
from wmrgen.tools.importing.mecanum import MECANUM_TEXT, ROLLERS, mecanum_choices
from wmrgen.tools.importing.records import DIGITS, MODEL, SUPPORT, Question, Wheel
from wmrgen.tools.importing.rule import rule
from wmrgen.tools.importing.subject import RobotRule, Subject
from wmrgen.tools.importing.view import EVEN, UNSEEN, UPRIGHT, Candidate, Mesh, Robot

DIRECTIONS = {"x": (1, 0), "y": (0, 1), "-x": (-1, 0), "-y": (0, -1)}
_ALONG = math.cos(math.radians(20))
_CHASSIS = re.compile("(base(_link|_footprint)?|chassis|body)$")
_CARRIES = re.compile("cast[eo]r|ball|skid|support|slider|wheel|omni", re.IGNORECASE)
_STRAIGHT = Fraction(1, 10**6)  # [m^2] twice the area between wheels on one line
_LOW = Fraction(15, 1000)  # [m] above the ground, what still carries
_OFF = 2e-3  # [m] a smaller distance of a mesh from its joint along the axle is not asked about

RULES: list[RobotRule] = []
LAST: list[RobotRule] = []  # asked only if something else is, or if a hint says what carries the robot


@rule(
    RULES,
    "rollers",
    "Wheels with rollers whose directions the description does not say would be a guess.",
    "lekiwi, festo_robotino: omni wheels; eight of 17 such robots in the collection of 72",
)
def _rollers(subject: Subject) -> Iterator[Question]:
    unknown = [w for w in subject.wheels if w.type == SWEDISH.name and w.gamma is None]
    if not unknown:
        return
    names = [w.name for w in unknown]
    why = tuple(filter(None, [unknown[0].remarks.get("type", "")]))
    if choices := mecanum_choices(unknown):
        yield Question(names[0], "gamma", MECANUM_TEXT, why, tuple(names[1:]), choices, ROLLERS)
        return
    text = (
        "which way do the rollers stand? Look at the wheel from above, through it at the roller that touches the "
        "ground (those on top cross it): gamma is the angle from the rolling direction to that roller's axis, "
        "counter-clockwise"
    )
    if _any_way(unknown) and len(unknown) == len(subject.wheels):
        yield Question(names[0], "gamma", text, ("0 for omni wheels", *why), tuple(names[1:]))
        return
    for name in names:
        yield Question(
            name, "gamma", text, ("0 for an omni wheel", "pi/4 or -pi/4 for a mecanum wheel", *why)
        )


@rule(
    RULES,
    "plane of a mesh",
    "A wheel that is a mesh need not touch the ground at its joint: the track would be wrong.",
    "lekiwi, jpl_osr",
)
def _planes(subject: Subject) -> Iterator[Question]:
    robot = subject.robot
    meshes = [() if c.shape or c.unsure else robot.meshes(c) for c in subject.seen]
    off = [_beside(own) for own in meshes]
    asked = []
    for w, own, shifts in zip(subject.wheels, meshes, off, strict=True):
        aside = any(abs(shift) >= _OFF for shift in shifts.values())
        asked.append(aside or bool(own and w.offset_y and not _measured(own)))
    # Another wheel may have the same mesh, whose middle is as far off the joint.
    doubted = {mesh.name for own, is_asked in zip(meshes, asked, strict=True) if is_asked for mesh in own}
    for (w, c), own, shifts, is_asked in zip(subject.pairs, meshes, off, asked, strict=True):
        if is_asked or not (_measured(own) or all(mesh.name not in doubted for mesh in own)):
            yield _plane_question(w, c, shifts)


def _plane_question(w: Wheel, c: Candidate, shifts: dict[str, float]) -> Question:
    text = "the wheel is a mesh: where along its axle does it touch the ground? The joint need not be in its middle"
    axis = 0 if abs(c.axis[0]) > abs(c.axis[1]) else 1
    key, at, share = "xy"[axis], float(c.centre[axis]), float(c.axis[axis])
    if w.offset_y is not None:
        key, at, share = "offset_y", float(w.offset_y), 1.0
    hints = (f"{round(at + share * shift, DIGITS):.6g} at the {words}" for words, shift in shifts.items())
    return Question(w.name, key, text, (f"{at:.6g} at the joint", *hints))


def _measured(meshes: Sequence[Mesh]) -> bool:
    return any(mesh.reach for mesh in meshes)


def _beside(meshes: Sequence[Mesh]) -> dict[str, float]:
    """How far the middles of meshes are off the joint along the axle [m], else their origins."""
    middles = {f"middle of the {m.words}": (m.reach.low + m.reach.high) / 2 for m in meshes if m.reach}
    return middles or {f"origin of the {m.words}": m.shift for m in meshes}


@rule(
    RULES,
    "motors",
    "A description without ros2_control, transmission or plugin does not say which wheels have motors.",
    "mushr, cart_soft_suspension_sdf: no motors; festo_robotino: the body moves as a whole",
)
def _motors(subject: Subject) -> Iterator[Question]:
    for name, text, hints in _motor_questions(subject.wheels):
        yield Question(name, "actuated", text, hints)


def _motor_questions(wheels: Sequence[Wheel]) -> list[tuple[str, str, tuple[str, str]]]:
    """Return the wheels whose motors are not known, with text and hints."""
    steering = [w for w in wheels if w.type == STEERED.name]
    fixed = [w for w in wheels if w.type == FIXED.name]
    if all(w.actuated == () for w in wheels):
        text = "the file drives no joint of a wheel, or moves the body as a whole: which have motors?"
        return [(w.name, text, ("[spin]", "[]")) for w in wheels if w.type != CASTOR.name]
    if any(w.actuated is not None for w in wheels):
        return []
    text = "the file does not say which joints are driven"
    if all(w.type == CASTOR.name for w in wheels):
        return [(w.name, text, ("[spin, steer]", "[]")) for w in wheels]
    if fixed and steering:
        return [(w.name, text, ("[steer]", "[spin, steer]")) for w in steering]
    return [(w.name, text, ("[spin]", "[]")) for w in fixed if len(fixed) > 2]


@rule(
    RULES,
    "articulated body",
    "The joint of an articulated body, or of a hitch, looks like the steering axis of the wheels that it carries.",
    "kloubak, of the collection of 72",
)
def _articulated(subject: Subject) -> Iterator[Question]:
    robot, wheels = subject.robot, subject.wheels
    groups: dict[str, list[Wheel]] = {}
    words: dict[str, tuple[str, str]] = {}
    for w, c in subject.pairs:
        if above := next((j for j in c.via if robot.upright(j)), None):
            text = f"joint {quoted(above.name)} turns its steering axis, too, and is taken at zero"
            joint, words[above.name] = above.name, (text, "keep it if that joint never turns")
        elif w.steer_joint and _carries_far(w, wheels):
            text = "its steering axis carries several wheels far from it"
            joint, words[w.steer_joint] = w.steer_joint, (text, "keep it if it steers")
        else:
            continue
        groups.setdefault(joint, []).append(w)
    for joint, own in groups.items():
        text, keep = words[joint]
        hints = (keep, *_as_trailer(own, wheels))
        also = tuple(w.name for w in own[1:])
        yield Question(own[0].name, "type", f"{text}: is the robot articulated there?", hints, also)


def _carries_far(w: Wheel, wheels: Sequence[Wheel]) -> bool:
    """Return whether a steering axis carries several wheels, and a wheel is far from it."""
    return _companions(w, wheels) and math.hypot(w.d or 0, w.offset_y or 0) > 2 * (w.r or UNSEEN)


def _as_trailer(own: Sequence[Wheel], wheels: Sequence[Wheel]) -> tuple[str, ...]:
    """Return the hints how to write the part of the body with the wheels ``own`` as a trailer."""
    none = "a robot file has no articulated bodies; what is towed is listed under trailers:"
    others = [w for w in wheels if w.type == FIXED.name and w not in own]
    axles = [float(w.x) + float(w.d or 0) * math.cos(w.heading or 0.0) for w in own]
    places = [float(w.x) for w in others]
    one_axle = bool(places) and max(places) - min(places) < EVEN and max(axles) - min(axles) < EVEN
    length, hitch = float(own[0].x) - axles[0], (places[0] if places else 0.0) - float(own[0].x)
    if not one_axle or length <= 0:
        return (none,)
    written = f"trailers: [{{length: {length:.6g}, hitch: {hitch:.6g}}}]"
    return (f"delete the wheels, and write {written} if it is towed", none)


@rule(
    RULES,
    "front",
    "The x axis of a CAD frame need not point forward.",
    "lekiwi: a CAD plate; scout_mini, open_base and prius_hybrid of the collection of 72 roll along y",
)
def _front(subject: Subject) -> Iterator[Question]:
    robot, wheels, seen = subject.robot, subject.wheels, subject.seen
    if subject.forward_given:
        return
    first = wheels[0]
    headings = [w.heading for w in wheels if w.heading is not None and w.type != CASTOR.name]
    labels = [
        "" if w.type == CASTOR.name or _companions(w, wheels) else role(c.joint.name, c.joint.child)
        for w, c in zip(wheels, seen, strict=True)
    ]
    misses = {name: _misses(wheels, labels, turn) for name, turn in DIRECTIONS.items()}
    best = min(misses, key=lambda name: misses[name])
    if headings and all(abs(math.sin(h)) > _ALONG for h in headings):
        why = "the wheels roll along y"
        side = "y" if sum(map(math.sin, headings)) > 0 else "-y"
        sideways = misses["x"] if best in ("y", "-y") else 0
        told = misses[side] if all(w.steer_joint for w in wheels) else sideways
        best = best if misses[best] < told else side
    elif misses["x"]:
        why = "the names of wheels say front, rear, left or right where they do not stand so"
    elif _any_way(wheels) and not _CHASSIS.search(robot.base) and robot.base != MODEL:
        why = f"the frame {quoted(robot.base)} is not called that of a robot, and the wheels do not tell"
    else:
        return
    turned = "" if best == "x" else f"; --forward {best}: its {best} is, as it seems to be"
    shown = "" if first.heading is None else f" {first.heading:.6g}"
    hint = (
        f"import again with --forward x: x is forward, and the heading is{shown} as the file has it{turned}"
    )
    yield Question(first.name, "heading", f"which way is forward? In {quoted(robot.base)} {why}", (hint,))


def _companions(wheel: Wheel, wheels: Sequence[Wheel]) -> bool:
    """Other wheels stand on its steering axis."""
    return wheel.steer_joint is not None and sum(w.steer_joint == wheel.steer_joint for w in wheels) > 1


def _any_way(wheels: Sequence[Wheel]) -> bool:
    """Rollers on axles that are not parallel: the robot drives any way alike."""
    headings = [w.heading for w in wheels if w.heading is not None and w.type == SWEDISH.name]
    return any(abs(math.sin(a - b)) > 0.2 for a in headings for b in headings)


def _misses(wheels: Sequence[Wheel], labels: Sequence[str], forward: tuple[int, int]) -> int:
    """How many labels contradict the places, seen with ``forward`` to the front. A side that all name, as in a1_l for a
    link, says nothing."""
    fx, fy = forward
    places = [(float(fx * w.x + fy * w.y), float(fx * w.y - fy * w.x)) for w in wheels]
    count = 0
    for axis, (high, low) in enumerate((("front", "rear"), ("left", "right"))):
        values = [place[axis] for place in places]
        middle, reach = (max(values) + min(values)) / 2, (max(values) - min(values)) / 20
        signs = [(high in label.split()) - (low in label.split()) for label in labels]
        if len({*signs}) > 1:
            count += sum(s * (value - middle) < -reach for s, value in zip(signs, values, strict=True))
    return count


@rule(
    LAST,
    "castor on fixed joints",
    "A castor whose swivel and axle are fixed is no wheel that turns, though it carries the robot.",
    "andino",
)
def _rigid_castor(subject: Subject) -> Iterator[Question]:
    for c in rigid_wheels(subject.robot, subject.seen):
        if c.joint.axis and c.shape and c.shape.cylinder:
            yield Question(SUPPORT, "type", *_castor(subject.robot, c))
            return


@rule(
    LAST,
    "what carries the rest",
    "Wheels on one line do not carry a robot: a castor is missing, which constrains nothing but need be known.",
    "rby1a, pioneer2dx_sdf",
)
def _support(subject: Subject) -> Iterator[Question]:
    robot, wheels, seen, passed = subject.robot, subject.wheels, subject.seen, subject.rejected
    if any(w.type == CASTOR.name for w in wheels) or not _on_a_line([c.centre[:2] for c in seen]):
        return
    own = {each.joint.child for each in passed}
    for c in seen:
        own |= {c.joint.child, *(j.child for j in robot.under(c.joint.child))}
    others = [link for link in robot.description.links if link not in own and robot.reaches(link)]
    ground = min(c.lowest if c.shape else c.lowest - c.radius for c in seen)
    low = [(link, *ball) for link in others for ball in robot.balls(link) if ball[1] - ground < _LOW]
    bodies = robot.description.shapes
    if any(_CARRIES.search(link) for link in others) or any(len(bodies[link]) == 1 for link, _, _ in low):
        return
    text = "the wheels stand on one line, and no other body of the file stands on the ground: what carries the rest?"
    hints = [
        f"a ball of {quoted(link)} at x = {float(x):.6g}, y = {float(y):.6g}: spherical"
        for link, (x, y, _), _ in low
    ]
    hints += [f"{quoted(each.joint.name)}, where {each.why}" for each in passed]
    yield Question(SUPPORT, "type", text, tuple(dict.fromkeys(hints)))


def _castor(robot: Robot, c: Candidate) -> tuple[str, tuple[str, ...]]:
    text = f"is {quoted(c.joint.child)} a castor? Its joints are fixed in the file, though they have axes"
    swivels = [
        j for j in ancestors(c.joint.parent, robot.above) if j.axis and abs(robot.axis(j)[2]) >= UPRIGHT
    ]
    if not swivels:
        return text, ("castor, with d and r", "spherical where it slides, or delete it")
    (x, y, _), d = robot.origin(swivels[0]), plus(c.centre, robot.origin(swivels[0]), -1)[:2]
    at = f"x: {float(x):.6g}, y: {float(y):.6g}, d: {-math.hypot(*d):.6g}, r: {float(c.radius):.6g}"
    return text, (f"castor, with {at}", "spherical where it slides, or delete it")


def _on_a_line(places: Sequence[tuple[Fraction, Fraction]]) -> bool:
    x0, y0 = places[0]
    x1, y1 = max(places, key=lambda place: math.dist(place, places[0]))
    return all(abs((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) < _STRAIGHT for x, y in places)
