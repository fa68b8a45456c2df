"""Rollers on wheels: what says that there are any, and how they stand to the heading."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from fractions import Fraction

from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.frames import across, cross, dot, plus, turned, unit
from wmrgen.tools.importing.records import Joint, Vector
from wmrgen.tools.importing.view import EVEN, Candidate, Robot

UNSAID = "not in the file"
_SAYS_ROLLERS = re.compile("mecanum|omni", re.IGNORECASE)
# A macro omni_camera says nothing of wheels.
_MACRO_OF_ROLLERS = re.compile("mecanum|omni_?wheel", re.IGNORECASE)
_MOVES_ANY_WAY = re.compile("planar_?move", re.IGNORECASE)  # simulators move cars and tracks so, too
_MOST = 4  # wheels with rollers, where nothing but how they move says them


def heading(axis: Vector) -> Vector:
    """The direction in which a wheel rolls that turns about ``axis`` at a positive rate: axis x z, level."""
    return unit((axis[1], -axis[0], Fraction(0)))


def angle(direction: Vector) -> float:
    return math.atan2(direction[1], direction[0])


def says_rollers(macro: str) -> bool:
    """Return whether the name of a xacro macro says that its wheels have rollers."""
    return bool(_MACRO_OF_ROLLERS.search(macro))


def rollers_said(robot: Robot, wheels: Sequence[Candidate]) -> str:
    """What says, of the whole robot, that its wheels have rollers; empty where nothing does."""
    steers = any(wheel.steer for wheel in wheels)
    for word in (*robot.description.words, *(word for c in wheels for word in names_of(robot, c))):
        moved = _MOVES_ANY_WAY.search(word) and 2 < len(wheels) <= _MOST and not steers
        if moved or _SAYS_ROLLERS.search(word):
            return f"the file says {quoted(word)}"
    if steers:
        return ""
    axles = [angle(heading(w.axis)) for w in wheels if not w.unsure]
    if len(axles) > 2 and any(abs(math.sin(a - b)) > 0.2 for a in axles for b in axles):
        return "plain wheels on axles that are not parallel could not roll"
    return _mirrored(robot, wheels)


def names_of(robot: Robot, c: Candidate) -> Iterator[str]:
    """Yield the names of a wheel's joint, links and meshes."""
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


def gamma_said(robot: Robot, c: Candidate, e: Vector) -> tuple[float | None, str]:
    """The direction of the roller at the ground from the heading, modulo pi in (-pi/2, pi/2], and its source."""
    if c.rollers:
        lowest = min(c.rollers, key=lambda j: robot.origin(j)[2])
        return _gamma_of(robot, lowest, c), f"axis of the lowest roller {quoted(lowest.name)}"
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


def _gamma_of(robot: Robot, roller: Joint, c: Candidate) -> float | None:
    """gamma of a roller once the wheel has turned so far that the roller is straight below the axle: there the rim of
    a wheel that turns forward moves against its heading. None for one on the axle, which comes to stand anywhere."""
    out, axis = across(plus(robot.origin(roller), c.origin, -1), c.axis), robot.axis(roller)
    if dot(out, out) < EVEN**2:
        return None
    return _modulo(math.atan2(dot(axis, c.axis), -dot(axis, cross(c.axis, unit(out)))))


def _slanting_friction(robot: Robot, c: Candidate, e: Vector) -> tuple[float, str] | None:
    """The angle from the heading in which the wheel grips, and whose frame says so; None unless that is aslant, or the
    wheel slides freely across it in a frame that does not turn with the wheel, as on rollers alone."""
    friction = robot.description.frictions.get(c.joint.child)
    if not friction or friction.mu2 > friction.mu1 / 10 or friction.link not in robot.description.links:
        return None
    aslant = _modulo(angle(turned(robot.frame(friction.link).rotation, friction.direction)) - angle(e))
    free = friction.mu2 == 0 and friction.link != c.joint.child
    least, most = (0, 80) if free else (20, 70)
    return (aslant, friction.link) if least <= abs(math.degrees(aslant)) <= most else None


def _modulo(angle: float) -> float:
    turned_back = math.remainder(angle, math.pi)
    if abs(turned_back) < 1e-12:
        return 0.0
    return turned_back if turned_back > -math.pi / 2 + 1e-12 else math.pi / 2
