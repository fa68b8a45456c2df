"""A description seen from its base frame: places and axes of joints, shapes of bodies, what moves above and below."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from wmrgen.robotfile.text import quoted
from wmrgen.tools.importing.frames import ancestors, composed, dot, inverse, parents, plus, pose, turned, unit
from wmrgen.tools.importing.meshes import Reach, reach
from wmrgen.tools.importing.read import refuse
from wmrgen.tools.importing.records import MODEL, Description, Frame, Joint, Shape, Vector

UPRIGHT = math.cos(math.radians(15))
LEVEL = math.sin(math.radians(12))  # how far the axle of a wheel may be inclined
COAXIAL = 0.99  # cosine
UNSEEN = Fraction(5, 100)  # [m] the radius of a wheel that is a mesh, where one must be supposed
EVEN = Fraction(5, 1000)  # [m] by which the ground may be uneven
SUNK = Fraction(35, 100)  # of its radius: as far a wheel may end above the lowest, and stand with it
_WORLD = re.compile("(world|map|odom)$")
_GROUND = re.compile(f"footprint$|{_WORLD.pattern}")
X, Z = (Fraction(1), Fraction(0), Fraction(0)), (Fraction(0), Fraction(0), Fraction(1))


@dataclass(frozen=True, slots=True)
class Round:
    """The largest coaxial cylinder or sphere of a wheel: ``words`` say which."""

    radius: Fraction
    centre: Vector
    words: str
    cylinder: bool


@dataclass(frozen=True, slots=True)
class Candidate:
    """A joint that may be a wheel's, in the base frame: ``axis`` through ``origin``. ``steer``: the nearest joint above
    that turns about an upright axis, ``via`` what else moves above. ``doubt`` says why that may be wrong, ``unsure``
    that the axis of the wheel itself is."""

    joint: Joint
    origin: Vector
    axis: Vector
    shape: Round | None
    steer: Joint | None
    via: tuple[Joint, ...]
    rollers: tuple[Joint, ...]
    doubt: str = ""
    unsure: bool = False

    @property
    def centre(self) -> Vector:
        return self.shape.centre if self.shape else self.origin

    @property
    def radius(self) -> Fraction:
        return self.shape.radius if self.shape else UNSEEN

    @property
    def lowest(self) -> Fraction:
        return self.centre[2] - (self.shape.radius if self.shape else 0)


class Mesh(NamedTuple):
    """A mesh of a wheel's body: how far its origin is off the joint along the axle [m], and how far it reaches where
    its file is at hand."""

    role: str
    name: str
    shift: float
    reach: Reach | None

    @property
    def words(self) -> str:
        return f"{self.role} mesh {quoted(self.name)}"


class Robot:
    """A description seen from its base frame, of which the direction ``forward`` is taken for x."""

    def __init__(self, description: Description, base: str, forward: tuple[int, int] = (1, 0)) -> None:
        self.description, self.base = description, base
        self.above = parents(description.joints)
        c, s = map(Fraction, forward)
        turn = Frame(((c, s, Z[0]), (-s, c, Z[0]), Z), (Z[0], Z[0], Z[0]))
        self._to_base = composed(turn, inverse(pose(base, self.above)))
        self._trunk = {joint.child for joint in ancestors(base, self.above)}
        self._root = self._root_of(base)
        self._meshes: dict[tuple[str, Vector, Vector], tuple[Mesh, ...]] = {}
        self._frames: dict[str, Frame] = {}
        self._below: dict[str, list[Joint]] = {}
        for joint in description.joints:
            self._below.setdefault(joint.parent, []).append(joint)

    def _root_of(self, link: str) -> str:
        chain = ancestors(link, self.above)
        return chain[-1].parent if chain else link

    def frame(self, link: str) -> Frame:
        if link not in self._frames:
            self._frames[link] = composed(self._to_base, pose(link, self.above))
        return self._frames[link]

    def reaches(self, link: str) -> bool:
        """The link hangs on the same root as the base."""
        return self._root_of(link) == self._root

    def moving_above(self, joint: Joint) -> list[Joint]:
        """Joints that move between a link and the base, nearest first."""
        return [j for j in ancestors(joint.parent, self.above) if j.moves and j.child not in self._trunk]

    def moving_below(self, link: str) -> list[Joint]:
        return [joint for joint in self.under(link) if joint.moves]

    def under(self, link: str, rigid: bool = False) -> list[Joint]:
        """All joints below a link; with ``rigid`` only what is fixed to it."""
        reached: list[Joint] = []
        waiting = [link]
        while waiting:
            for joint in self._below.get(waiting.pop(), []):
                if not (rigid and joint.moves):
                    reached.append(joint)
                    waiting.append(joint.child)
        return reached

    def origin(self, joint: Joint) -> Vector:
        """A point of the joint's axis."""
        frame = self.frame(joint.child)
        return plus(turned(frame.rotation, joint.pivot), frame.origin)

    def axis(self, joint: Joint) -> Vector:
        return unit(turned(self.frame(joint.child).rotation, joint.axis or X))

    def upright(self, joint: Joint) -> bool:
        return joint.turns and abs(self.axis(joint)[2]) >= UPRIGHT

    def body(self, link: str) -> Iterator[tuple[Shape, Frame]]:
        """The shapes of a link and of what is fixed to it, with their frames."""
        for each, shape in self._rigid(link):
            yield shape, composed(self.frame(each), shape.frame)

    def _rigid(self, link: str) -> Iterator[tuple[str, Shape]]:
        """The shapes of a link and of what is fixed to it, with the links that have them."""
        for each in (link, *(joint.child for joint in self.under(link, rigid=True))):
            for shape in self.description.shapes.get(each, ()):
                yield each, shape

    def shapes(self, link: str) -> Iterator[tuple[str, str, Fraction, Frame]]:
        """Kind, role, radius and frame of the cylinders and spheres of a link and of what is fixed to it."""
        for shape, where in self.body(link):
            if shape.radius:
                yield shape.kind, shape.role, shape.radius, where

    def roles(self, link: str) -> set[str]:
        """Whether a link, with what is fixed to it, touches (collision), is drawn (visual), or both."""
        return {shape.role for _, shape in self._rigid(link)}

    def meshes(self, c: Candidate) -> tuple[Mesh, ...]:
        """The meshes of a wheel's body."""
        axle = (c.joint.child, c.origin, c.axis)
        if axle not in self._meshes:
            self._meshes[axle] = tuple(self._reaches(c))
        return self._meshes[axle]

    def bounds(self, c: Candidate) -> list[Reach]:
        """How far the meshes of a wheel's body reach whose files are at hand."""
        return [mesh.reach for mesh in self.meshes(c) if mesh.reach]

    def _reaches(self, c: Candidate) -> Iterator[Mesh]:
        for shape, where in self.body(c.joint.child):
            if shape.uri:
                data = self.description.file_of(shape.uri)
                bounds = reach(data, shape.uri, shape.scale, where, c.origin, c.axis) if data else None
                shift = float(dot(plus(where.origin, c.origin, -1), c.axis))
                yield Mesh(shape.role, shape.uri.rsplit("/", 1)[-1], shift, bounds)

    def balls(self, link: str) -> Iterator[tuple[Vector, Fraction]]:
        """Centre and lowest height of the cylinders and spheres of a link itself."""
        for shape in self.description.shapes.get(link, ()):
            if shape.radius:
                centre = composed(self.frame(link), shape.frame).origin
                yield centre, centre[2] - shape.radius

    def round_shape(self, link: str, origin: Vector, axis: Vector) -> Round | None:
        """Return the largest coaxial cylinder or sphere; one that collides before one that is only drawn.

        Args:
            link: The link with what is fixed to it.
            origin: A point of the axle [m].
            axis: The unit vector of the axle.

        Returns:
            The shape, in the middle of several of one size, as the two sides of a wheel are.
        """
        shapes: list[tuple[tuple[bool, Fraction], Fraction, str]] = []
        for kind, role, radius, where in self.shapes(link):
            along = turned(where.rotation, Z)
            reach = plus(where.origin, origin, -1)
            share = dot(reach, axis)
            off = plus(reach, axis, -share)
            if dot(off, off) <= (radius / 5) ** 2 and (kind == "sphere" or abs(dot(along, axis)) >= COAXIAL):
                shapes.append(((role == "collision", radius), share, kind))
        if not shapes:
            return None
        (collides, radius), _, kind = largest = max(shapes, key=lambda s: s[0])
        shares = [share for rank, share, _ in shapes if rank == largest[0]]
        words = f"{'collision' if collides else 'visual'} {kind}"
        middle = plus(origin, axis, (min(shares) + max(shares)) / 2)
        return Round(radius, middle, words, kind == "cylinder")


def base_link(description: Description, wanted: str | None) -> str:
    """The link ``wanted``, else `*base_link` nearest the root, but none of an arm or a hand, nor one that lies in the
    frame of the ground, else the root that carries most, or what all hangs on that moves below it."""
    if wanted is not None:
        if wanted not in description.links:
            raise refuse(
                f"there is no link {quoted(wanted)}",
                "",
                f"Links: {quoted(' '.join(description.links), 300)}.",
            )
        return wanted
    if MODEL in description.links:
        return MODEL
    above = parents(description.joints)
    chains = {link: ancestors(link, above) for link in description.links}
    carried = Counter(chains.keys())
    for chain in chains.values():
        carried.update(joint.parent for joint in chain)
    named = [link for link in description.links if link.endswith("base_link") and _stands(link, above)]
    whole = []
    for link in named:
        if 2 * carried[link] >= len(chains) or not any(joint.moves for joint in chains[link]):
            whole.append(link)
    if whole:
        return min(whole, key=lambda link: len(chains[link]))
    root = max((link for link, chain in chains.items() if not chain), key=lambda root: carried[root])
    return _moved_whole(description, root)


def _moved_whole(description: Description, root: str) -> str:
    """The link below the joints that move all of a robot, as simulators have them: each alone on a link without a
    shape; of one that is fixed to the world so, its first body."""
    base = link = root
    while not description.shapes.get(link):
        below = [joint for joint in description.joints if joint.parent == link]
        if len(below) != 1:
            break
        link = below[0].child
        base = link if below[0].moves else base
    return link if _WORLD.search(root) and _upright(link, parents(description.joints)) else base


def _stands(link: str, above: Mapping[str, Joint]) -> bool:
    """The frame of a link has its z up, where its root is a frame of the ground."""
    chain = ancestors(link, above)
    return not chain or not _GROUND.search(chain[-1].parent) or _upright(link, above)


def _upright(link: str, above: Mapping[str, Joint]) -> bool:
    return pose(link, above).rotation[2][2] > Fraction(1, 2)
