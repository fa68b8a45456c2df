"""Frames composed exactly: rotations by quarter turns are, others are kept to 30 digits.

Angles within `TOLERANCE` of a multiple of pi/12 are taken for it here, before frames are composed: 1.57 in one joint of
a car would put its rear wheels on two axles.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction

from wmrgen.errors import Code, RobotFileError
from wmrgen.geometry.exact.poly import triple
from wmrgen.geometry.layout.expressions import TOLERANCE
from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.records import Frame, Joint, Matrix, Vector

MAX_JOINTS, MAX_CHAIN = 500, 64  # of a robot, of its longest chain
_QUARTERS = {0: (0, 1), 1: (1, 0), 2: (0, -1), 3: (-1, 0)}  # sine, cosine
_DIGITS = 10**30
_ZERO, _ONE = Fraction(0), Fraction(1)
IDENTITY = Frame(((_ONE, _ZERO, _ZERO), (_ZERO, _ONE, _ZERO), (_ZERO, _ZERO, _ONE)), (_ZERO, _ZERO, _ZERO))


def _sine_cosine(angle: Fraction) -> tuple[Fraction, Fraction]:
    value = float(angle)
    step = round(value / (math.pi / 12))
    if abs(value - step * math.pi / 12) < TOLERANCE:
        if step % 6 == 0:
            sine, cosine = _QUARTERS[step // 6 % 4]
            return Fraction(sine), Fraction(cosine)
        value = step * math.pi / 12
    return Fraction(math.sin(value)), Fraction(math.cos(value))


def frame(xyz: Vector, rpy: Vector) -> Frame:
    """The frame at ``xyz``, turned by roll, pitch and yaw about fixed axes [rad]: Rz Ry Rx."""
    (sr, cr), (sp, cp), (sy, cy) = map(_sine_cosine, rpy)
    rotation = (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )
    return Frame(triple(map(_tamed, rotation)), xyz)


def _tamed(vector: Vector) -> Vector:
    return triple(v if v.denominator < _DIGITS else Fraction(round(v * _DIGITS), _DIGITS) for v in vector)


def turned(rotation: Matrix, vector: Vector) -> Vector:
    return triple(dot(row, vector) for row in rotation)


def plus(a: Vector, b: Vector, factor: Fraction | int = 1) -> Vector:
    """Return a + factor b.

    Args:
        a: A vector.
        b: A vector.
        factor: The factor of b.

    Returns:
        The sum.
    """
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


def dot(a: Vector, b: Vector) -> Fraction:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def across(vector: Vector, axis: Vector) -> Vector:
    """The part of a vector across a unit vector ``axis``: off a wheel's axle."""
    return plus(vector, axis, -dot(vector, axis))


def cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def transposed(m: Matrix) -> Matrix:
    return triple(zip(*m, strict=True))


def composed(outer: Frame, inner: Frame) -> Frame:
    """A frame ``inner``, given in ``outer``, in what ``outer`` is given in."""
    columns = triple(turned(outer.rotation, column) for column in transposed(inner.rotation))
    rotation = triple(map(_tamed, transposed(columns)))
    return Frame(rotation, _tamed(plus(turned(outer.rotation, inner.origin), outer.origin)))


def inverse(of: Frame) -> Frame:
    back = transposed(of.rotation)
    x, y, z = turned(back, of.origin)
    return Frame(back, (-x, -y, -z))


def unit(vector: Vector) -> Vector:
    """The vector of length 1; one along a coordinate axis stays exact. ValueError for none."""
    size = max(map(abs, vector))
    if not size:
        raise ValueError("no direction")
    longest = triple(v / size for v in vector)
    length = dot(longest, longest)
    if length == 1:
        return longest
    root = Fraction(math.sqrt(length))
    return _tamed(triple(v / root for v in longest))


def tree(
    joints: Sequence[Joint], links: Collection[str], notes: list[str]
) -> tuple[tuple[Joint, ...], tuple[Joint, ...]]:
    """Return the joints of the tree, and those that give a link a second parent.

    Args:
        joints: All joints.
        links: The names of all links.
        notes: A list to which a note on each second parent is appended.

    Returns:
        The joints of the tree and the others.

    Raises:
        RobotFileError: A link is missing, or joints form a circle.
    """
    if len(joints) > MAX_JOINTS:
        raise RobotFileError(f"more than {MAX_JOINTS} joints", joints[MAX_JOINTS].mark, code=Code.DESCRIPTION)
    above: dict[str, Joint] = {}
    closing = []
    for joint in joints:
        what = f"joint {quoted(joint.name)}"
        if unknown := [link for link in (joint.parent, joint.child) if link not in links]:
            raise RobotFileError(
                f"{what}: there is no link {quoted(unknown[0])}", joint.mark, code=Code.DESCRIPTION
            )
        if joint.child in above:
            notes.append(f"{what}: {quoted(joint.child)} has a parent already; this one is not read")
            closing.append(joint)
        else:
            above[joint.child] = joint
    for start in above:
        link, seen = start, {start}
        while link in above:
            mark, link = above[link].mark, above[link].parent
            if link in seen:
                what = f"the joints go in a circle through the link {quoted(link)}"
                raise RobotFileError(what, mark, code=Code.DESCRIPTION)
            if len(seen) > MAX_CHAIN:
                what = f"more than {MAX_CHAIN} joints one behind the other, down to {quoted(start)}"
                raise RobotFileError(what, mark, code=Code.DESCRIPTION)
            seen.add(link)
    return tuple(above.values()), tuple(closing)


def parents(joints: tuple[Joint, ...]) -> Mapping[str, Joint]:
    """Link -> the joint that carries it."""
    return {joint.child: joint for joint in joints}


def ancestors(link: str, above: Mapping[str, Joint]) -> list[Joint]:
    """The joints from a link to the root, nearest first."""
    chain = []
    while link in above:
        chain.append(above[link])
        link = above[link].parent
    return chain


def pose(link: str, above: Mapping[str, Joint]) -> Frame:
    """The frame of a link in that of its root, all joints at zero."""
    result = IDENTITY
    for joint in ancestors(link, above):
        result = composed(joint.frame, result)
    return result
