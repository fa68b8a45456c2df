"""What must be asked of a wheel, because the file does not say it or says two things."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction

from wmrgen.robotfile.text import quoted
from wmrgen.robotfile.wheel_types.types import CASTOR, FIXED, STEERED
from wmrgen.tools.importing.frames import across, dot, plus
from wmrgen.tools.importing.records import DIGITS, Question, Vector, Wheel
from wmrgen.tools.importing.view import Candidate, Mesh, Robot

CONFLICT = Fraction(1, 100)  # part of a radius by which two sources may differ
TRAIL = Fraction(1, 1000)  # [m] what trails less is no castor
_OFF = 2e-3  # [m] how far a mesh may stand off its joint along the axle
_QUARTER = math.pi / 2  # [rad]
_LARGEST = 5  # [m] the radius of a wheel
_GROUND = "base_footprint"  # as the name of a link ends


def doubt(c: Candidate, name: str, heading: float, kind: str) -> Question:
    """Whether it is a wheel, of a ``kind``, or where it rolls."""
    where = "if the axle lies along y where the steering angle is 0"
    if c.shape:
        where = "by the axis of its cylinder"
    elif c.joint.axis is None:
        where = "about 1 0 0"
    rollers = ("swedish, with gamma, where it has rollers",) if kind == FIXED.name else ()
    hints = (f"{heading:.6g} {where}",) if c.unsure else (f"{kind}, where it is one", *rollers)
    text = f"joint {quoted(c.joint.name)}: {c.doubt}. Is it a wheel that stands so?"
    return Question(name, "heading" if c.unsure else "type", text, hints)


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


def swivel_doubts(
    name: str,
    kind: str,
    d: Fraction,
    actuated: tuple[str, ...] | None,
    transmitted: bool,
    rolling: str,
    stray: bool,
    bodiless: bool,
    stops: tuple[Fraction, Fraction] | None,
) -> Iterator[Question]:
    """What may be otherwise of a wheel on a steering axis, from which its contact lies ``d`` off. ``transmitted``: only
    a transmission says that a motor steers it. ``stray``: nothing turns it, but something other wheels. ``bodiless``:
    it turns without end, no shape is drawn of what it turns, and only a transmission names it. ``stops``: its steering
    limits [rad]."""
    if rolling:
        text = f"{rolling}, and here the wheel swivels: does the robot have this swivel?"
        yield Question(name, "type", text, ("swedish, where it has not",))
    elif kind == STEERED.name and abs(d) > TRAIL:
        text = f"the contact lies {float(d):.6g} m off the steering axis along the rolling direction: is that meant?"
        yield Question(name, "type", text, ("steered (then it is 0)", f"castor, with d: {float(d):.6g}"))
    elif kind == STEERED.name and stray:
        text = "nothing turns its steering axis, on which it stands: does it trail, as castors do, or is it fixed?"
        yield Question(name, "type", text, ("castor, with d as measured", "steered, where a motor turns it"))
    elif kind == STEERED.name and bodiless:
        text = "no body is drawn between the robot and its wheel, and only a transmission names its swivel"
        yield Question(
            name,
            "type",
            f"{text}: does the robot have it?",
            ("steered, where it has", "swedish, where it has not and the wheel has rollers"),
        )
    elif kind == CASTOR.name and transmitted:
        text = "the swivel has a transmission: does a motor turn it, or does it follow?"
        rest = ", ".join(key for key in actuated or () if key != "steer")
        yield Question(name, "actuated", text, (f"[{rest}]", f"[{', '.join(actuated or ())}]"))
    elif (
        kind == CASTOR.name and "steer" not in (actuated or ()) and stops and max(map(abs, stops)) < _QUARTER
    ):
        text = (
            f"its contact lies {float(d):.6g} m off an axis that turns by less than a quarter: does it trail?"
        )
        yield Question(
            name, "type", text, (f"castor, with d: {float(d):.6g}", "steered, where something steers it")
        )


def axle_asked(robot: Robot, c: Candidate, name: str) -> Iterator[Question]:
    """What may be two wheels on one shaft, in whose middle one is taken: two as large as one another, and further apart
    than their diameter, or a mesh that is twice as long."""
    bounds = max(robot.bounds(c), key=lambda b: b.radius, default=None)
    if c.shape:
        (a, b), least = c.shape.sides, 2 * c.radius
    elif bounds and bounds.round:
        a, b = (plus(c.origin, c.axis, Fraction(end)) for end in (bounds.low, bounds.high))
        least = Fraction(4 * bounds.radius)
    else:
        return
    between = plus(b, a, -1)
    if dot(between, between) > least**2:
        at = " and ".join(f"({float(p[0]):.6g}, {float(p[1]):.6g})" for p in (a, b))
        text = "its joint turns two wheels, and one in their middle is taken: does a shaft turn both?"
        where = "at" if c.shape else "whose outer sides are at"
        hints = (
            f"two wheels where it does, {where} {at}, and equal: their spins, under couplings:",
            "else the one that touches the ground",
        )
        yield Question(name, "type", text, hints)


def ball_asked(name: str) -> Question:
    text = "a sphere that nothing drives: does it roll any way, as the ball of a castor, or about its axle alone?"
    return Question(name, "type", text, ("spherical, where it rolls any way", "fixed, about its axle alone"))


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
    agree = (
        any(abs(radius / bounds.radius - 1) <= CONFLICT for radius in radii) for radii in others if radii
    )
    if not all(agree):
        return None
    return Fraction(round(bounds.radius * 10**6), 10**6), f"bound of the {own[0].words} about the axle"


def size_asked(robot: Robot, c: Candidate, name: str) -> Question:
    """The radius, with what speaks for one."""
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


def planes_asked(robot: Robot, wheels: Sequence[Wheel], seen: Sequence[Candidate]) -> Iterator[Question]:
    """The planes of wheels along their axles, where meshes do not stand about the joint, or are not at hand and look as
    if they did not: be it at another wheel, whose joint is as little in the middle of the same mesh."""
    meshes = [() if c.shape or c.unsure else robot.meshes(c) for c in seen]
    off = [_beside(own) for own in meshes]
    asked = [
        any(abs(shift) >= _OFF for shift in shifts.values())
        or bool(own and w.offset_y and not _measured(own))
        for w, own, shifts in zip(wheels, meshes, off, strict=True)
    ]
    doubted = {mesh.name for own, is_asked in zip(meshes, asked, strict=True) if is_asked for mesh in own}
    text = "the wheel is a mesh: where along its axle does it touch the ground? The joint need not be in its middle"
    for w, c, own, shifts, is_asked in zip(wheels, seen, meshes, off, asked, strict=True):
        if not is_asked and (_measured(own) or all(mesh.name not in doubted for mesh in own)):
            continue
        axis = 0 if abs(c.axis[0]) > abs(c.axis[1]) else 1
        key, at, share = "xy"[axis], float(c.centre[axis]), float(c.axis[axis])
        if w.offset_y is not None:
            key, at, share = "offset_y", float(w.offset_y), 1.0
        hints = (f"{round(at + share * shift, DIGITS):.6g} at the {words}" for words, shift in shifts.items())
        yield Question(w.name, key, text, (f"{at:.6g} at the joint", *hints))


def _measured(meshes: Sequence[Mesh]) -> bool:
    return any(mesh.reach for mesh in meshes)


def _beside(meshes: Sequence[Mesh]) -> dict[str, float]:
    """How far the middles of meshes are off the joint along the axle [m], else their origins."""
    middles = {f"middle of the {m.words}": (m.reach.low + m.reach.high) / 2 for m in meshes if m.reach}
    return middles or {f"origin of the {m.words}": m.shift for m in meshes}


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


def roller_reach(robot: Robot, c: Candidate) -> Fraction:
    """How far the rollers of a wheel reach from its axle, as they are drawn; 0 where they are not."""
    reaches = [Fraction(0)]
    for roller in c.rollers:
        for _, _, radius, where in robot.shapes(roller.child):
            out = across(plus(where.origin, c.origin, -1), c.axis)
            reaches.append(radius + Fraction(math.sqrt(dot(out, out))))
    return max(reaches)


def rollers_doubted(c: Candidate, name: str, reach: Fraction) -> Question:
    text = "the surface of the rollers is not where the wheel is drawn: which is its radius?"
    hints = (f"{float(c.radius):.6g} as the wheel is drawn", f"{float(reach):.6g} to the rollers' surface")
    return Question(name, "r", text, hints)


def radius_doubted(robot: Robot, c: Candidate, name: str, height: Fraction) -> Question:
    """A sphere is seldom drawn as large as the wheel; a cylinder is believed."""
    text = "the radius that is drawn is not the height of the axle above what seems the ground: which is it?"
    told = (f"{float(r):.6g} by {quoted(key)}" for key, r in _radii_told(robot))
    hints = (f"{float(c.radius):.6g} as drawn", f"{float(height):.6g} above the ground", *told)
    return Question(name, "r", text, tuple(dict.fromkeys(hints)))
