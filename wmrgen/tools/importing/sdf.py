"""SDF to a `Description` in the frame of the model, `MODEL`, with nested and included models in it.

Every pose is followed to the model's frame; joints then carry links as those of a URDF do.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from xml.etree.ElementTree import Element

from wmrgen.errors import RobotFileError
from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.frames import IDENTITY, composed, inverse, transposed, tree, turned
from wmrgen.tools.importing.gazebo import driven_by_plugins, friction, pushing, words
from wmrgen.tools.importing.poses import FrameGraph, Scope, placement, reference
from wmrgen.tools.importing.read import (
    at,
    below,
    child,
    children,
    mark_of,
    name_of,
    radius_in,
    refuse,
    text_in,
    vector,
)
from wmrgen.tools.importing.records import MODEL, RIGID, Description, Frame, Friction, Joint, Shape
from wmrgen.tools.importing.sdf_joints import joints_of, passed_over

Include = Callable[[str], Element | None]  # the root of the file that a URI names; None where nobody gave it
_MOST_MODELS = 64


def _has(model: Element, tag: str) -> bool:
    return next(below(model, tag), None) is not None


def describe(root: Element, file: str, include: Include) -> Description:
    """Return what the first model with a joint that turns without end says, else the first that has joints.

    Args:
        root: The root of the file.
        file: The name of the file.
        include: Returns the root of the file that a URI names.

    Returns:
        The description.

    Raises:
        RobotFileError: No model has joints.
    """
    version, lost = root.get("version", ""), list[str]()
    worlds = children(root, "world")
    inside = [model for world in worlds for model in children(world, "model")]
    models = [(model, version) for model in (*children(root, "model"), *inside)]
    for each in (included for world in worlds for included in children(world, "include")):
        other = include(text_in(each, "uri"))
        model = None if other is None else child(other, "model")
        if other is None or model is None:
            lost.append(unread(text_in(each, "uri")))
        else:
            models.append((model, other.get("version", "")))
    robots = [m for m in models if _has(m[0], "joint") or _has(m[0], "include")]
    if not robots:
        why = " ".join(f"Note: {note}." for note in lost[:3])
        hint = "Give the file that describes the robot."
        raise refuse(f"{file}: no model of it has a joint", why, hint, mark_of(root))
    described: Description | None = None
    why = "the first that has joints, of which none turns without end in any"
    for model, said in robots:
        whole = _Reader(include).whole(model, said)
        described = described or whole
        if any(joint.spins for joint in whole.joints):
            described, why = whole, "the first in which a joint turns without end"
            break
    assert described is not None
    if len(robots) < 2:
        return described
    names = [model.get("name", "") for model, _ in robots]
    others = ", ".join(quoted(name) for name in names if name != described.name)
    note = f"only the model {quoted(described.name)} is read, {why}"
    return replace(described, notes=(*described.notes, f"{note}; not {others}"))


def unread(uri: str) -> str:
    return f"the model {quoted(uri)} is not read: its folder was not given (--package NAME=DIR)"


class _Reader:
    """What stands in a model and in the models within it, by full names."""

    def __init__(self, include: Include) -> None:
        self.include = include
        self.frames = FrameGraph()
        self.links: dict[str, tuple[Element, Scope]] = {}
        self.joints: dict[str, tuple[Element, Scope]] = {}
        self.plugins: list[tuple[Element, str]] = []  # with the prefixes of their models
        self.words: list[str] = []
        self.notes: list[str] = []
        self.models = 0

    def whole(self, element: Element, version: str) -> Description:
        """A model that stands in no other."""
        self.model(element, "", MODEL, version)
        return self.description(element.get("name", ""))

    def model(self, element: Element, prefix: str, own: str, version: str) -> str:
        """Take a model in whose frame is ``own``; the link that carries it."""
        self.models += 1
        if self.models > _MOST_MODELS:
            what = f"{quoted(element.get('name', ''))}: more than {_MOST_MODELS} models"
            raise refuse(what, mark=mark_of(element))
        scope = Scope(prefix, own, version in ("1.0", "1.2", "1.3", "1.4"))
        self.words += words(element)
        self.plugins += ((plugin, prefix) for plugin in children(element, "plugin"))
        for link in children(element, "link"):
            name = prefix + name_of(link, "link")
            self.links.setdefault(name, (link, scope))
            self._place(link, name, scope, own, name)
        for nested in children(element, "model"):
            self._within(nested, nested, scope, version)
        for included in children(element, "include"):
            self._include(included, scope)
        for each in children(element, "frame"):
            carrier = scope.full(each.get("attached_to", ""), own)
            self._place(each, prefix + name_of(each, "frame"), scope, carrier, carrier)
        for joint in children(element, "joint"):
            name = prefix + name_of(joint, "joint")
            if name in self.joints:
                self.notes.append(f"joint {quoted(name)}: several joints have this name")
            self.joints.setdefault(name, (joint, scope))
            carrier = scope.full(text_in(joint, "child"), MODEL)
            self._place(joint, name, scope, carrier, carrier)
        first = next((name for name in self.links if name.startswith(prefix)), MODEL)
        return scope.full(element.get("canonical_link", ""), first)

    def _place(self, element: Element, name: str, scope: Scope, default: str, carrier: str) -> None:
        where = placement(element, quoted(name))
        self.frames.add(name, scope.full(reference(element), default), where, carrier, mark_of(element))

    def _include(self, element: Element, scope: Scope) -> None:
        uri = text_in(element, "uri")
        root = self.include(uri)
        model = None if root is None else child(root, "model")
        if root is None or model is None:
            self.frames.missing.append(uri)
            self.notes.append(unread(uri))
            return
        self._within(element, model, scope, root.get("version", ""))

    def _within(self, outer: Element, model: Element, scope: Scope, version: str) -> None:
        """A model in another, at the pose of ``outer``: the model itself, or the element that includes it."""
        name = scope.prefix + (text_in(outer, "name") or outer.get("name") or name_of(model, "model"))
        prefix = scope.prefix if outer.get("merge") in ("true", "1") else f"{name}::"
        own = f"{name}::__model__"
        carrier = self.model(model, prefix, own, version)
        if outer is not model:
            self.plugins += ((plugin, prefix) for plugin in children(outer, "plugin"))
        placed = outer if child(outer, "pose") is not None else model
        where = placement(placed, quoted(name))
        held = text_in(outer, "placement_frame") or placed.get("placement_frame", "")
        if held:
            with at(placed):
                where = composed(
                    where, inverse(self.frames.pose(Scope(prefix, own, False).full(held, own), own))
                )
        self.frames.add(own, scope.full(reference(placed), scope.own), where, carrier, mark_of(placed))
        self.frames.add(name, own, IDENTITY, carrier)

    def description(self, name: str) -> Description:
        joints, lost = joints_of(self.joints, self.frames, self.notes)
        links = (MODEL, *self.links, *(j.child for j in joints if j.child not in self.links))
        carried, closing = tree(joints, links, self.notes)
        self.notes += passed_over(lost, carried)
        free = set(self.links) - {joint.child for joint in carried}
        held = [self._held(link) for link in self.links if link in free]
        return Description(
            name=name,
            links=links,
            joints=(*carried, *held),
            shapes={full: tuple(self._shapes(full)) for full in self.links},
            frictions=self._frictions(),
            driven=driven_by_plugins(self.plugins, self.joints),
            words=tuple(self.words),
            notes=tuple(self.notes),
            closing=closing,
            pushing=pushing(plugin for plugin, _ in self.plugins),
        )

    def _held(self, link: str) -> Joint:
        """What holds a link that no joint carries."""
        with at(self.links[link][0]):
            return Joint(link, RIGID, MODEL, link, self.frames.pose(link), None, None, None)

    def _shapes(self, full: str) -> list[Shape]:
        link, scope = self.links[full]
        shapes = []
        for role in ("collision", "visual"):
            for part in children(link, role):
                what = f"link {quoted(full)}: {role}"
                geometry = child(part, "geometry")
                for form in [] if geometry is None else list(geometry):
                    radius = text_in(form, "radius") if form.tag in ("cylinder", "sphere", "capsule") else ""
                    uri = "" if child(form, "submesh") is not None else text_in(form, "uri")
                    with at(form):
                        scale = vector(text_in(form, "scale") or "1 1 1", f"{what}: scale")
                        value = radius_in(radius, what, self.notes)
                    with at(part):
                        where = self._in_link(part, full, scope)
                    shapes.append(Shape(str(form.tag), role, where, value, uri, scale))
        return shapes

    def _in_link(self, part: Element, link: str, scope: Scope) -> Frame:
        """The frame of a collision or visual in that of its link."""
        where = placement(part, f"link {quoted(link)}")
        if not reference(part):
            return where
        seen = composed(self.frames.pose(scope.full(reference(part), link)), where)
        return composed(inverse(self.frames.pose(link)), seen)

    def _frictions(self) -> dict[str, Friction]:
        frictions = {}
        for full, (link, scope) in self.links.items():
            for part in children(link, "collision"):
                try:
                    if says := friction(part, ""):
                        frictions[full] = self._in_body(says, part, full, scope)
                except RobotFileError as error:
                    self.notes.append(f"link {quoted(full)}: {error.what}; this fdir1 is not read")
        return frictions

    def _in_body(self, says: Friction, part: Element, link: str, scope: Scope) -> Friction:
        """The friction in the frame of the link that carries the frame in which it is given: else of the collision."""
        body = self.frames.carrier(scope.full(says.link, link))
        if says.link:
            seen = turned(self.frames.pose(scope.full(says.link, link)).rotation, says.direction)
            along = turned(transposed(self.frames.pose(body).rotation), seen)
        else:
            along = turned(self._in_link(part, link, scope).rotation, says.direction)
        return Friction(along, body, says.mu1, says.mu2)
