"""How far the mesh of a wheel reaches from its axle and along it: STL, OBJ and COLLADA, read as points."""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from wmrgen.errors import RobotFileError
from wmrgen.importing.frames import plus, transposed, turned
from wmrgen.importing.read import below, child, children, local, parse
from wmrgen.importing.records import Frame, Vector

MAX_BYTES = 32 * 1024 * 1024
_NUMBER = rb"\s+([-+.\deE]{1,40})"
_VERTEX = re.compile(rb"^\s*vertex" + 3 * _NUMBER, re.MULTILINE)
_OBJ_VERTEX = re.compile(rb"^v" + 3 * _NUMBER, re.MULTILINE)
_DEPTH = 32
Point = tuple[float, float, float]
Rows = tuple[tuple[float, ...], ...]  # three rows of a 4 by 4 matrix
_SAME: Rows = ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0))


@dataclass(frozen=True, slots=True)
class Reach:
    """The largest distance from the axle, and the extent along it [m]. ``least``: what part of that it
    reaches to the other three sides; of a wheel nearly all."""

    radius: float
    low: float
    high: float
    least: float


def reach(data: bytes, name: str, scale: Vector, where: Frame, origin: Vector, axis: Vector) -> Reach | None:
    """What a mesh in the frame ``where`` covers about an axle; None for what is no mesh that is read here."""
    try:
        cloud = set(points(data, name))
    except (RobotFileError, ValueError, OverflowError):
        return None
    back = transposed(where.rotation)
    ox, oy, oz = map(float, turned(back, plus(origin, where.origin, -1)))
    ax, ay, az = map(float, turned(back, axis))
    sx, sy, sz = map(float, scale)
    low, high, largest, far = math.inf, -math.inf, 0.0, (0.0, 0.0, 0.0)
    for x, y, z in cloud:
        dx, dy, dz = sx * x - ox, sy * y - oy, sz * z - oz
        along = dx * ax + dy * ay + dz * az
        if not math.isfinite(along):
            return None
        low, high = min(low, along), max(high, along)
        if (square := dx * dx + dy * dy + dz * dz - along * along) > largest:
            largest, far = square, (dx - along * ax, dy - along * ay, dz - along * az)
    if not cloud:
        return None
    fx, fy, fz = far
    across = ay * fz - az * fy, az * fx - ax * fz, ax * fy - ay * fx
    sides = [(-fx, -fy, -fz), across, (-across[0], -across[1], -across[2])]
    least = min(
        max((sx * x - ox) * u + (sy * y - oy) * v + (sz * z - oz) * w for x, y, z in cloud)
        for u, v, w in sides
    )
    return Reach(math.sqrt(largest), low, high, least / largest if largest else 0.0)


def points(data: bytes, name: str) -> Iterable[Point]:
    """The points of a mesh [m, unscaled]. ValueError or RobotFileError for what cannot be read."""
    kind = name.lower().rsplit(".", 1)[-1]
    if kind == "stl":
        return _stl(data)
    if kind == "obj":
        return _texts(_OBJ_VERTEX, data)
    if kind == "dae":
        return _Collada(parse(data, name, MAX_BYTES)).points()
    raise ValueError(f"{kind} is not read")


def _stl(data: bytes) -> Iterable[Point]:
    """Binary, where its length is that of the triangles which it announces; else text."""
    if len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little"):
        return (v[i : i + 3] for v in struct.iter_unpack("<12x9f2x", data[84:]) for i in (0, 3, 6))
    return _texts(_VERTEX, data)


def _texts(pattern: re.Pattern[bytes], data: bytes) -> Iterator[Point]:
    for match in pattern.finditer(data):
        x, y, z = map(float, match.groups())
        yield x, y, z


class _Collada:
    """The geometries of a COLLADA file, where its scene puts them, in its unit. Which axis is up is left to whoever
    shows it, as the viewers of robot descriptions do."""

    def __init__(self, root: Element) -> None:
        self.root = root
        self.named = {f"#{e.get('id')}": e for e in root.iter() if e.get("id")}

    def points(self) -> Iterator[Point]:
        unit = next((float(u.get("meter", "1")) for u in below(self.root, "unit")), 1.0)
        scenes = list(below(self.root, "visual_scene"))
        placed = (
            p for scene in scenes for node in children(scene, "node") for p in self._node(node, _SAME, 0)
        )
        free = (p for geometry in below(self.root, "geometry") for p in self._geometry(geometry))
        yield from ((unit * x, unit * y, unit * z) for x, y, z in (placed if scenes else free))

    def _node(self, node: Element, outer: Rows, depth: int) -> Iterator[Point]:
        if depth > _DEPTH:
            raise ValueError("nodes without end")
        matrix = outer
        for element in node:
            kind = local(element)
            if kind in ("matrix", "translate", "rotate", "scale"):
                matrix = _product(matrix, _transform(kind, [float(v) for v in (element.text or "").split()]))
            elif kind == "instance_geometry" and element.get("url", "") in self.named:
                yield from (_moved(matrix, p) for p in self._geometry(self.named[element.get("url", "")]))
            elif kind == "node":
                yield from self._node(element, matrix, depth + 1)
            elif kind == "instance_node" and element.get("url", "") in self.named:
                yield from self._node(self.named[element.get("url", "")], matrix, depth + 1)

    def _geometry(self, geometry: Element) -> Iterator[Point]:
        for vertices in below(geometry, "vertices"):
            for each in children(vertices, "input"):
                source = self.named.get(each.get("source", ""))
                numbers = None if source is None else child(source, "float_array")
                if each.get("semantic") == "POSITION" and numbers is not None:
                    values = iter([float(v) for v in (numbers.text or "").split()])
                    yield from zip(values, values, values, strict=False)


def _transform(kind: str, values: Sequence[float]) -> Rows:
    if kind == "matrix" and len(values) == 16:
        return tuple(tuple(values[4 * row : 4 * row + 4]) for row in range(3))
    if kind == "rotate" and len(values) == 4:
        return _turn(values[:3], math.radians(values[3]))
    if kind in ("translate", "scale") and len(values) == 3:
        x, y, z = values
        if kind == "scale":
            return (x, 0, 0, 0), (0, y, 0, 0), (0, 0, z, 0)
        return (1, 0, 0, x), (0, 1, 0, y), (0, 0, 1, z)
    raise ValueError(f"<{kind}> of {len(values)} numbers")


def _turn(axis: Sequence[float], angle: float) -> Rows:
    """Rodrigues' formula."""
    x, y, z = (v / math.hypot(*axis) for v in axis)
    c, s = math.cos(angle), math.sin(angle)
    return (
        (c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s, 0),
        (y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s, 0),
        (z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c), 0),
    )


def _product(a: Rows, b: Rows) -> Rows:
    last = (0.0, 0.0, 0.0, 1.0)
    return tuple(
        tuple(sum(row[k] * (*b, last)[k][column] for k in range(4)) for column in range(4)) for row in a
    )


def _moved(rows: Rows, point: Point) -> Point:
    x, y, z = (r[0] * point[0] + r[1] * point[1] + r[2] * point[2] + r[3] for r in rows)
    return x, y, z
