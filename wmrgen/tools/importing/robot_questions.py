"""What must be asked of a robot as a whole: its motors, its front, what else carries it."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from fractions import Fraction

from wmrgen.robotfile.names import role
from wmrgen.robotfile.text import quoted
from wmrgen.robotfile.wheel_types.types import CASTOR, FIXED, STEERED, SWEDISH
from wmrgen.tools.importing.candidates import rigid_wheels
from wmrgen.tools.importing.frames import ancestors, dot, plus
from wmrgen.tools.importing.passed import Passed
from wmrgen.tools.importing.records import MODEL, SUPPORT, Joint, Question, Wheel
from wmrgen.tools.importing.view import COAXIAL, UNSEEN, UPRIGHT, Candidate, Robot

DIRECTIONS = {"x": (1, 0), "y": (0, 1), "-x": (-1, 0), "-y": (0, -1)}
_ALONG = math.cos(math.radians(20))
_CHASSIS = re.compile("(base(_link|_footprint)?|chassis|body)$")
_CARRIES = re.compile("cast[eo]r|ball|skid|support|slider|wheel|omni", re.IGNORECASE)
_STRAIGHT = Fraction(1, 10**6)  # [m^2]
_CAD, _EVENLY = (
    Fraction(5, 1000),
    Fraction(1, 1000),
)  # [m] by which one place differs from others; as they do among them
_LOW = Fraction(15, 1000)  # [m] above the ground, what still carries


def motors_unknown(wheels: Sequence[Wheel]) -> list[Question]:
    """Where the file drives no wheel, and not all need be driven; or where it moves the body as a whole."""
    steering = [w for w in wheels if w.type == STEERED.name]
    fixed = [w for w in wheels if w.type == FIXED.name]
    if all(w.actuated == () for w in wheels):
        text = "the file drives no joint of a wheel, or moves the body as a whole: which have motors?"
        return [Question(w.name, "actuated", text, ("[spin]", "[]")) for w in wheels if w.type != CASTOR.name]
    if any(w.actuated is not None for w in wheels):
        return []
    text = "the file does not say which joints are driven"
    if all(w.type == CASTOR.name for w in wheels):
        return [Question(w.name, "actuated", text, ("[spin, steer]", "[]")) for w in wheels]
    if fixed and steering:
        return [Question(w.name, "actuated", text, ("[steer]", "[spin, steer]")) for w in steering]
    return [Question(w.name, "actuated", text, ("[spin]", "[]")) for w in fixed if len(fixed) > 2]


def front_doubted(robot: Robot, wheels: Sequence[Wheel], seen: Sequence[Candidate]) -> list[Question]:
    """Where the wheels roll along y, their names contradict their places, or nothing tells where x points."""
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
        return []
    turned = "" if best == "x" else f"; --forward {best}: its {best} is, as it seems to be"
    shown = "" if first.heading is None else f" {first.heading:.6g}"
    hint = (
        f"import again with --forward x: x is forward, and the heading is{shown} as the file has it{turned}"
    )
    return [Question(first.name, "heading", f"which way is forward? In {quoted(robot.base)} {why}", (hint,))]


def corner_asked(wheels: Sequence[Wheel]) -> list[Question]:
    """Of four wheels of a kind three stand at corners of a rectangle, and one near the fourth, but not there."""
    text = "the other three wheels stand at corners of a rectangle, this one not at the fourth: does it stand so?"
    for w in wheels:
        others = [other for other in wheels if other.type == w.type and other is not w]
        corner = _corner(others) if len(others) == 3 else None
        questions = []
        for key, at, to in zip("xy", (w.x, w.y), corner, strict=True) if corner else ():
            if _CAD < abs(at - to) < abs(to) / 4:
                hints = (f"{float(at):.6g} as in the file", f"{float(to):.6g} at the corner")
                questions.append(Question(w.name, key, text, hints))
        if questions:
            return questions
    return []


def _corner(three: Sequence[Wheel]) -> tuple[Fraction, Fraction] | None:
    """The fourth corner of the rectangle, its sides along x and y, of which three wheels are corners."""
    corner = []
    for places in ([w.x for w in three], [w.y for w in three]):
        a, b, c = sorted(places)
        if min(b - a, c - b) > _EVENLY or c - a < 10 * _CAD:
            return None
        corner.append(c if b - a < c - b else a)
    return corner[0], corner[1]


def articulated(robot: Robot, wheels: Sequence[Wheel], seen: Sequence[Candidate]) -> list[Question]:
    """A joint that steers wheels far from it, or turns about an upright axis above one that steers: it may turn a part
    of the body."""
    none = "a robot file has no articulated bodies; what is towed stands under trailers:"
    questions = []
    for w, c in zip(wheels, seen, strict=True):
        if above := next((j for j in c.via if robot.upright(j)), None):
            text = f"joint {quoted(above.name)} turns its steering axis, too, and is taken at zero"
            keep = "keep it if that joint never turns"
        elif _companions(w, wheels) and math.hypot(w.d or 0, w.offset_y or 0) > 2 * (w.r or UNSEEN):
            text, keep = "its steering axis carries several wheels far from it", "keep it if it steers"
        else:
            continue
        questions.append(Question(w.name, "type", f"{text}: is the robot articulated there?", (keep, none)))
    return questions


def odd_one_asked(wheels: Sequence[Wheel]) -> list[Question]:
    """One of four or more wheels that are driven alike differs from all others, which are alike: in its radius, or how
    far its contact lies off the steering axis."""
    questions = []
    for w in wheels:
        others = [other for other in wheels if other is not w and _driven_alike(w, other)]
        keys = ("d", "offset_y", "r")[: 3 if all(each.r for each in (w, *others)) else 2]
        for key in keys if len(others) > 2 else ():
            own, *rest = (abs(getattr(each, key) or Fraction(0)) for each in (w, *others))
            off = min(abs(own - other) for other in rest)
            if off > (own / 50 if key == "r" else _CAD) and max(rest) - min(rest) < _EVENLY:
                text = f"its {key} is {float(own):.6g}, that of the {len(rest)} others {float(rest[0]):.6g}"
                asked = "type" if key == "d" else key
                hints = (f"{_shown(w, key)} as in the file", f"{_shown(others[0], key)} as the others")
                questions.append(Question(w.name, asked, f"{text}: does this wheel stand so?", hints))
    return questions


def undrawn_asked(robot: Robot, wheels: Sequence[Wheel], seen: Sequence[Candidate]) -> list[Question]:
    """One wheel of three or more is not drawn, the others are."""
    roles = [robot.roles(c.joint.child) for c in seen]
    drawn = ["visual" in each for each in roles]
    if len(wheels) < 3 or drawn.count(False) != 1 or roles[drawn.index(False)] != {"collision"}:
        return []
    w = wheels[drawn.index(False)]
    text = "it touches the ground and is not drawn, as all other wheels are: is it a simulator's?"
    hint = "delete it where it is, {} where the robot has it"
    return [Question(w.name, "type", text, (hint.format(w.type),))]


def tool_asked(robot: Robot, wheels: Sequence[Wheel], seen: Sequence[Candidate]) -> list[Question]:
    """What hangs alone, without a mirror image, on a joint that turns about an axis like its own, where two or more
    wheels hang on none, may be a drum or a brush that an arm lowers."""
    text = "it alone hangs on {}, which turns about a level axis, as arms do: is it a wheel, or a tool?"
    hint = "{} where it is a wheel; delete it where it is none"
    arms = [next((j for j in c.via if _pitches(robot, j, c)), None) for c in seen]
    places = [(w.x, -w.y) for w in wheels]
    questions = []
    for w, arm in zip(wheels, arms, strict=True):
        mirrored = any(
            math.dist(at, (w.x, w.y)) < _CAD for v, at in zip(wheels, places, strict=True) if v is not w
        )
        if arm and not mirrored and arms.count(arm) == 1 and arms.count(None) > 1:
            questions.append(Question(w.name, "type", text.format(quoted(arm.name)), (hint.format(w.type),)))
    return questions


def _pitches(robot: Robot, joint: Joint, c: Candidate) -> bool:
    return joint.turns and abs(dot(robot.axis(joint), c.axis)) > COAXIAL


def steering_missed(wheels: Sequence[Wheel], seen: Sequence[Candidate]) -> list[Question]:
    """One wheel does not steer, all others do, and a joint above it turns about an axis that is not upright."""
    plain = [(w, c) for w, c in zip(wheels, seen, strict=True) if not w.steer_joint]
    if len(plain) != 1 or len(wheels) < 4:
        return []
    (w, c), *_ = plain
    above = (j for j in c.via if j.turns)
    text = "all other wheels steer, and joint {} above it turns about a level axis: does it steer, too?"
    hints = ("steered, where it does", f"{w.type}, where it does not")
    return [Question(w.name, "type", text.format(quoted(j.name)), hints) for j in above][:1]


def _driven_alike(w: Wheel, other: Wheel) -> bool:
    steers = [each.steer_joint is not None for each in (w, other)]
    return w.actuated == other.actuated and (all(steers) or (not any(steers) and w.type == other.type))


def _shown(w: Wheel, key: str) -> str:
    if key == "d":
        return f"castor, with d: {float(w.d or 0):.6g}," if w.type == CASTOR.name else "steered, without d,"
    return f"{float(getattr(w, key) or 0):.6g}"


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


def support_asked(
    robot: Robot, wheels: Sequence[Wheel], seen: Sequence[Candidate], passed: Sequence[Passed]
) -> list[Question]:
    """A castor whose joints are fixed; or what carries wheels that all stand on one line, where no body does.
    ``passed``: what looks like wheels and is none."""
    for rigid in (c for c in rigid_wheels(robot, seen) if c.joint.axis and c.shape and c.shape.cylinder):
        return [Question(SUPPORT, "type", *_castor(robot, rigid))]
    own = {link for c in seen for link in (c.joint.child, *(j.child for j in robot.under(c.joint.child)))}
    own |= {each.joint.child for each in passed}
    others = [link for link in robot.description.links if link not in own and robot.reaches(link)]
    if any(w.type == CASTOR.name for w in wheels) or not _on_a_line([c.centre[:2] for c in seen]):
        return []
    ground = min(c.lowest if c.shape else c.lowest - c.radius for c in seen)
    low = [(link, *ball) for link in others for ball in robot.balls(link) if ball[1] - ground < _LOW]
    bodies = robot.description.shapes
    if any(_CARRIES.search(link) for link in others) or any(len(bodies[link]) == 1 for link, _, _ in low):
        return []
    text = "the wheels stand on one line, and no other body of the file stands on the ground: what carries the rest?"
    hints = [
        f"a ball of {quoted(link)} at x = {float(x):.6g}, y = {float(y):.6g}: spherical"
        for link, (x, y, _), _ in low
    ]
    hints += [f"{quoted(each.joint.name)}, where {each.why}" for each in passed]
    return [Question(SUPPORT, "type", text, tuple(dict.fromkeys(hints)))]


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
