"""Poses of an SDF: which frame each is relative to, followed to that of the model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from xml.etree.ElementTree import Element

from wmrgen.errors import Code, Mark, RobotFileError
from wmrgen.robotfile.text import printable, quoted
from wmrgen.tools.importing.frames import IDENTITY, composed, frame
from wmrgen.tools.importing.read import at, child, number, refuse
from wmrgen.tools.importing.records import MODEL, Frame, Vector

_MOST = 256  # frames of which each is relative to the next


@dataclass(frozen=True, slots=True)
class Scope:
    """A model: ``prefix`` of the names in it, its own frame, whether its axes are given in that."""

    prefix: str
    own: str
    axes_in_model: bool

    def full(self, name: str, default: str) -> str:
        """The full name of what an element of the model calls ``name``."""
        if not name:
            return default
        return {"__model__": self.own, "world": MODEL}.get(name, self.prefix + name)


class MissingLinkError(RobotFileError):
    """A link or frame that is not there."""


class FrameGraph:
    """The frames of a model by their full names, each in another, and the links that carry them."""

    def __init__(self) -> None:
        self.missing: list[str] = []  # URIs of models that nobody gave
        self._within: dict[str, tuple[str, Frame, Mark | None]] = {}
        self._carriers: dict[str, str] = {}

    def add(self, name: str, reference: str, where: Frame, carrier: str, mark: Mark | None = None) -> None:
        """Add a frame; the first of a name counts.

        Args:
            name: The full name.
            reference: The frame in which it is given.
            where: Its pose in ``reference``.
            carrier: The link or frame with which it is rigid.
            mark: Its place in the file.
        """
        self._within.setdefault(name, (reference, where, mark))
        self._carriers.setdefault(name, carrier)

    def pose(self, name: str, root: str = MODEL) -> Frame:
        """The frame in ``root``. RobotFileError for one that is not there, or relative to itself."""
        result, at, mark = IDENTITY, name, None
        for _ in range(_MOST):
            if at == root:
                return result
            if at not in self._within:
                raise refuse(
                    f"there is no frame {quoted(at)}",
                    f"{quoted(name)} is relative to it." if at != name else "",
                    mark=mark,
                )
            at, where, mark = self._within[at]
            result = composed(where, result)
        raise refuse(f"the frame {quoted(name)} is relative to itself", mark=mark)

    def _lacks(self, what: str) -> MissingLinkError:
        if not self.missing:
            return MissingLinkError(what, code=Code.DESCRIPTION)
        name = printable(self.missing[0].rpartition("://")[2].partition("/")[0])
        why = f"The model {quoted(self.missing[0])} was not given."
        return MissingLinkError(what, None, why, f"Give --package {name}=DIR.", Code.DESCRIPTION)

    def carrier(self, name: str) -> str:
        """The link that carries a frame; a link is its own. MissingLinkError for a frame that is not there."""
        for _ in range(_MOST):
            if name == MODEL:
                return name
            if name not in self._carriers:
                raise self._lacks(f"there is no link or frame {quoted(name)}")
            if self._carriers[name] == name:
                return name
            name = self._carriers[name]
        raise refuse(f"the frame {quoted(name)} is attached to itself")


def reference(element: Element) -> str:
    """What the pose of an element says that it is relative to; empty where it says nothing."""
    pose = child(element, "pose")
    return "" if pose is None else pose.get("relative_to", "") or pose.get("frame", "")


def placement(element: Element, what: str) -> Frame:
    """The pose of an element: x y z and roll pitch yaw, in radians or degrees, or x y z and a quaternion x y z w."""
    pose = child(element, "pose")
    words = [] if pose is None else (pose.text or "").split()
    if pose is None or not words:
        return IDENTITY
    with at(pose):
        values = [number(word, f"{what}: pose") for word in words]
        quaternion = pose.get("rotation_format") == "quat_xyzw"
        if len(values) != (7 if quaternion else 6):
            count = "seven numbers with quat_xyzw" if quaternion else "six numbers"
            raise refuse(f"{what}: a pose has {count}, not {quoted(' '.join(words))}")
        if quaternion:
            return frame((values[0], values[1], values[2]), _angles(values[3:], what))
    x, y, z, *rpy = values
    if pose.get("degrees", "").strip() in ("true", "1"):
        rpy = [Fraction(math.radians(angle)) for angle in rpy]
    return frame((x, y, z), (rpy[0], rpy[1], rpy[2]))


def _angles(quaternion: Sequence[Fraction], what: str) -> Vector:
    """Roll, pitch and yaw of a quaternion x y z w of any length."""
    length = math.hypot(*map(float, quaternion))
    if not length:
        raise refuse(f"{what}: the quaternion 0 0 0 0 is no rotation")
    x, y, z, w = (float(q) / length for q in quaternion)
    sine = 2 * (w * y - z * x)
    if abs(sine) > 1 - 1e-9:  # roll and yaw turn about one axis
        return Fraction(2 * math.atan2(x, w)), Fraction(math.copysign(math.pi / 2, sine)), Fraction(0)
    roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return Fraction(roll), Fraction(math.asin(sine)), Fraction(yaw)
