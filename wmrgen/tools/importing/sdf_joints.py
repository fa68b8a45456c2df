"""Joints of an SDF as those of a URDF. One with two axes becomes two of its name, of which the upper is the one that
stands steeper."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple
from xml.etree.ElementTree import Element

from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.frames import (
    IDENTITY,
    ancestors,
    composed,
    inverse,
    parents,
    plus,
    transposed,
    turned,
)
from wmrgen.tools.importing.poses import FrameGraph, MissingLinkError, Scope, placement, reference
from wmrgen.tools.importing.read import (
    at,
    bound,
    child,
    children,
    direction,
    mark_of,
    number,
    refuse,
    text_in,
)
from wmrgen.tools.importing.records import MODEL, RIGID, Frame, Joint, Vector, endless

_KINDS = {"universal": "revolute", "revolute2": "revolute", "screw": "prismatic", "ball": "floating"}
_TREELESS = "gearbox"  # it couples two joints, and carries nothing
_Mimic = tuple[str, Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class _Axis:
    """A joint's axis in the model's frame."""

    along: Vector | None
    limits: tuple[Fraction, Fraction] | None
    mimic: _Mimic | None


class Lost(NamedTuple):
    """A joint that lacks one of its links: whether it turns without end, and the link that it would carry."""

    error: MissingLinkError
    spins: bool
    child: str


def joints_of(
    elements: Mapping[str, tuple[Element, Scope]], frames: FrameGraph, notes: list[str]
) -> tuple[list[Joint], list[Lost]]:
    """Return the joints that carry links, by their full names, and those that lack a link.

    Args:
        elements: The elements with the models that contain them.
        frames: The frames of the model.
        notes: A list to which a note on each joint that carries nothing is appended.

    Returns:
        The joints and those without a link.
    """
    joints, lost = list[Joint](), list[Lost]()
    for full, (element, scope) in elements.items():
        what, kind = f"joint {quoted(full)}", element.get("type", "")
        if kind == _TREELESS:
            notes.append(f"{what} is a gearbox, and not read")
        elif not text_in(element, "child"):
            raise refuse(f"{what} has no <child>", mark=mark_of(element))
        elif text_in(element, "child") != "world":  # which holds the model
            try:
                with at(element):
                    joints += _joint(full, element, scope, frames)
            except MissingLinkError as error:
                error.what = f"{what}: {error.what}"
                limits = [_limits(axis, what) for axis in _axes(element)] or [None]
                spins = any(endless(_kind(kind, each), each) for each in limits)
                lost.append(Lost(error, spins, scope.full(text_in(element, "child"), "")))
    return joints, lost


def passed_over(lost: Iterable[Lost], carried: tuple[Joint, ...]) -> list[str]:
    """Notes of joints without their links. MissingLinkError where a wheel may hang on one, because it, or a joint below
    it, turns without end."""
    above = parents(carried)
    bearing = {j.parent for w in carried if w.spins for j in (w, *ancestors(w.parent, above))}
    for each in lost:
        if each.spins or each.child in bearing:
            raise each.error
    return [f"{each.error.what}; it is not read" for each in lost]


def _axes(element: Element) -> list[Element]:
    return [axis for key in ("axis", "axis2") for axis in children(element, key)]


def _joint(full: str, element: Element, scope: Scope, frames: FrameGraph) -> list[Joint]:
    """What a joint is to a URDF. MissingLinkError where it names a link that is not there."""
    what = f"joint {quoted(full)}"
    parent, body = (frames.carrier(scope.full(text_in(element, end), MODEL)) for end in ("parent", "child"))
    if body == MODEL:  # which it holds
        return []
    place = frames.pose(body)
    own = frames.pose(scope.full(reference(element), body))
    at = composed(own, placement(element, what))
    pivot = turned(transposed(place.rotation), plus(at.origin, place.origin, -1))
    where = composed(inverse(frames.pose(parent)), place)
    axes = [_axis(axis, scope, at, frames, what) for axis in _axes(element)] or [_Axis(None, None, None)]
    kind = element.get("type", "")
    if kind not in _KINDS or len(axes) < 2:
        axes = axes[:1]
    axes.sort(key=lambda axis: -abs(axis.along[2]) if axis.along else 0)
    ends = [*(f"{full}::{number}" for number in range(1, len(axes))), body]
    joints, mark = [], mark_of(element)
    for axis, end in zip(axes, ends, strict=True):
        along = turned(transposed(place.rotation), axis.along) if axis.along else None
        turning = _kind(kind, axis.limits)
        joints.append(Joint(full, turning, parent, end, where, along, axis.limits, axis.mimic, pivot, mark))
        parent, where = end, IDENTITY
    return joints


def _axis(element: Element, scope: Scope, joint: Frame, frames: FrameGraph, what: str) -> _Axis:
    xyz = child(element, "xyz")
    with at(element if xyz is None else xyz):
        along = direction("0 0 1" if xyz is None else xyz.text, f"{what}: axis")
    said = "" if xyz is None else xyz.get("expressed_in", "")
    in_model = scope.axes_in_model or text_in(element, "use_parent_model_frame") in ("true", "1")
    rotation = joint.rotation
    if said or in_model:
        rotation = frames.pose(scope.full(said, scope.own)).rotation
    seen = turned(rotation, along) if along else None
    return _Axis(seen, _limits(element, what), _mimic(element, scope, what))


def _limits(axis: Element, what: str) -> tuple[Fraction, Fraction] | None:
    limit = child(axis, "limit")
    if limit is None:
        return None
    low, high = (text_in(limit, "lower") or "-inf", text_in(limit, "upper") or "inf")
    with at(limit):
        return bound(low, f"{what}: lower"), bound(high, f"{what}: upper")


def _kind(kind: str, limits: tuple[Fraction, Fraction] | None) -> str:
    """The kind of a URDF joint: one that turns and whose limits are one angle is locked."""
    kind = _KINDS.get(kind, kind)
    if kind in ("revolute", "continuous"):
        if limits is None:
            return "continuous"
        return RIGID if limits[0] == limits[1] else "revolute"
    return kind if kind in ("prismatic", RIGID) else "floating"


def _mimic(axis: Element, scope: Scope, what: str) -> _Mimic | None:
    element = child(axis, "mimic")
    if element is None:
        return None
    factor, offset, zero = (
        number(text_in(element, key) or default, f"{what}: {key}")
        for key, default in (("multiplier", "1"), ("offset", "0"), ("reference", "0"))
    )
    return scope.full(element.get("joint", ""), ""), factor, offset - factor * zero
