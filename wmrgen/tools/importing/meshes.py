"""How far the mesh of a wheel reaches from its axle and along it: STL, OBJ and COLLADA, read as points."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from wmrgen.errors import RobotFileError
from wmrgen.tools.importing.frames import plus, transposed, turned
from wmrgen.tools.importing.read import below, child, children, local, parse
from wmrgen.tools.importing.records import Frame, Vector

MAX_BYTES = 32 * 1024 * 1024  # of a mesh; larger files are not read
_NUMBER = rb"\s+([-+.\deE]{1,40})"
_VERTEX = re.compile(rb"^\s*vertex" + 3 * _NUMBER, re.MULTILINE)
_OBJ_VERTEX = re.compile(rb"^v" + 3 * _NUMBER, re.MULTILINE)
_DEPTH = 32  # of nodes in nodes of a COLLADA scene
_RIM = 0.98  # of the largest distance from the axle, what belongs to the rim of a wheel
_TRIANGLE = np.dtype([("normal", "<3f4"), ("corners", "<9f4"), ("attribute", "<u2")])  # of a binary STL
Reals = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Reach:
    """The largest distance from the axle, and the extent along it [m]. ``least``: what part of that it
    reaches to the other three sides; of a wheel nearly all. ``round``: it reaches so far all the way round."""

    radius: float
    low: float
    high: float
    least: float
    round: bool


def reach(data: bytes, name: str, scale: Vector, where: Frame, origin: Vector, axis: Vector) -> Reach | None:
    """Return how far a mesh reaches from an axle.

    Args:
        data: The content of the file.
        name: The name of the file.
        scale: Factors along the axes of the mesh.
        where: The frame of the mesh.
        origin: A point of the axle [m].
        axis: The unit vector of the axle.

    Returns:
        None if the file is no mesh that is read here.
    """
    try:
        cloud = points(data, name)
    except (RobotFileError, ValueError, OverflowError):
        return None
    back = transposed(where.rotation)
    centre = np.array(turned(back, plus(origin, where.origin, -1)), dtype=float)
    axle = np.array(turned(back, axis), dtype=float)
    with np.errstate(all="ignore"):
        off = cloud * np.array(scale, dtype=float) - centre
        along = off @ axle
        across = off - along[:, None] * axle
    if not len(cloud) or not np.isfinite(across).all():
        return None
    squares = (across**2).sum(axis=1)
    largest, far = squares.max(), across[squares.argmax()]
    aside = np.cross(axle, far)
    least = min((across @ side).max() for side in (-far, aside, -aside))
    share = float(least / largest) if largest else 0.0
    rim = across[squares >= _RIM**2 * largest]
    turns = np.sort(np.arctan2(rim @ aside, rim @ far))
    # Between neighbours at an angle g a polygon comes as near to its middle as cos(g/2) of its radius.
    gap = np.diff(turns, append=turns[0] + 2 * math.pi).max()
    rounded = bool(largest and math.cos(gap / 2) >= _RIM)
    return Reach(math.sqrt(largest), float(along.min()), float(along.max()), share, rounded)


def points(data: bytes, name: str) -> Reals:
    """The points of a mesh (n, 3) [m, unscaled]. ValueError or RobotFileError for what cannot be read."""
    kind = name.lower().rsplit(".", 1)[-1]
    if kind == "stl":
        return _stl(data)
    if kind == "obj":
        return _texts(_OBJ_VERTEX, data)
    if kind == "dae":
        return _Collada(parse(data, name, MAX_BYTES)).points()
    raise ValueError(f"{kind} is not read")


def _stl(data: bytes) -> Reals:
    """Binary, where its length is that of the triangles which it announces; else text."""
    if len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little"):
        return np.frombuffer(data, _TRIANGLE, offset=84)["corners"].reshape(-1, 3).astype(float)
    return _texts(_VERTEX, data)


def _texts(pattern: re.Pattern[bytes], data: bytes) -> Reals:
    return np.array([list(map(float, match.groups())) for match in pattern.finditer(data)]).reshape(-1, 3)


class _Collada:
    """The geometries of a COLLADA file, where its scene puts them, in its unit. Which axis is up is left to whoever
    shows it, as the viewers of robot descriptions do."""

    def __init__(self, root: Element) -> None:
        self.root = root
        self.named = {f"#{e.get('id')}": e for e in root.iter() if e.get("id")}

    def points(self) -> Reals:
        unit = next((float(u.get("meter", "1")) for u in below(self.root, "unit")), 1.0)
        scenes = list(below(self.root, "visual_scene"))
        placed = (
            part
            for scene in scenes
            for node in children(scene, "node")
            for part in self._node(node, np.eye(4), 0)
        )
        free = (part for geometry in below(self.root, "geometry") for part in self._geometry(geometry))
        return unit * np.concatenate([np.empty((0, 3)), *(placed if scenes else free)])

    def _node(self, node: Element, outer: Reals, depth: int) -> Iterator[Reals]:
        """The points of a node, which ``outer``, a matrix (4, 4), takes to the scene, and of those in it."""
        if depth > _DEPTH:
            raise ValueError("nodes without end")
        matrix = outer
        for element in node:
            kind, other = local(element), self.named.get(element.get("url", ""))
            if kind in ("matrix", "translate", "rotate", "scale"):
                matrix = matrix @ _transform(kind, [float(v) for v in (element.text or "").split()])
            elif kind == "instance_geometry" and other is not None:
                yield from (part @ matrix[:3, :3].T + matrix[:3, 3] for part in self._geometry(other))
            elif kind == "node":
                yield from self._node(element, matrix, depth + 1)
            elif kind == "instance_node" and other is not None:
                yield from self._node(other, matrix, depth + 1)

    def _geometry(self, geometry: Element) -> Iterator[Reals]:
        for vertices in below(geometry, "vertices"):
            for each in children(vertices, "input"):
                source = self.named.get(each.get("source", ""))
                numbers = None if source is None else child(source, "float_array")
                if each.get("semantic") == "POSITION" and numbers is not None:
                    values = [float(v) for v in (numbers.text or "").split()]
                    yield np.array(values[: len(values) // 3 * 3]).reshape(-1, 3)


def _transform(kind: str, values: Sequence[float]) -> Reals:
    """An element of a node as a matrix (4, 4); a turn about no axis is no number."""
    result = np.eye(4)
    if kind == "matrix" and len(values) == 16:
        result[:3] = np.reshape(values, (4, 4))[:3]
    elif kind == "rotate" and len(values) == 4:
        with np.errstate(invalid="ignore"):
            axis = np.array(values[:3]) / np.linalg.norm(values[:3])
        c, s = math.cos(math.radians(values[3])), math.sin(math.radians(values[3]))
        # Rodrigues' formula.
        result[:3, :3] = c * np.eye(3) + (1 - c) * np.outer(axis, axis) + s * np.cross(axis, np.eye(3)).T
    elif kind == "translate" and len(values) == 3:
        result[:3, 3] = values
    elif kind == "scale" and len(values) == 3:
        result[:3, :3] = np.diag(values)
    else:
        raise ValueError(f"<{kind}> of {len(values)} numbers")
    return result
