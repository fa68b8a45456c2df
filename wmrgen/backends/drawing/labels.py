"""Where names go: beside their wheel, on free paper, preferably outside. Greedy, in wheel order."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import cos, pi, sin

from wmrgen.backends.drawing.view import Box, Point, along, bounds, clip, distance, middle, overlap, unit

CHARACTER, HEIGHT = 7.25, 14.0  # a monospaced character at 12 px
_GAPS = (4.0, 12.0, 22.0, 36.0, 54.0)
_LEADER = 14.0
_DIRECTIONS = 24


@dataclass(frozen=True, slots=True)
class Label:
    """``at``: centre of the words' baseline; ``leader``: a line to the wheel where the name stands apart."""

    words: str
    at: Point
    leader: tuple[Point, Point] | None


@dataclass(slots=True)
class Paper:
    """What is already drawn: boxes that names must not touch, segments that they had better not cross."""

    area: Box
    boxes: list[Box] = field(default_factory=list)
    segments: list[tuple[Point, Point]] = field(default_factory=list)

    def put(self, words: str, target: Box, away: Point, crowded: bool = False) -> Label | None:
        """The best place for ``words`` beside the box ``target``, seen from ``away``.

        On a crowded page a name that finds no free place is left out (None).
        """
        half = (len(words) * CHARACTER / 2 + 1, HEIGHT / 2)
        outward = unit(away, middle(target)) if distance(middle(target), away) > 2 else (1.0, 0.0)
        best: tuple[float, Point, float] | None = None
        count = _DIRECTIONS // 3 if crowded else _DIRECTIONS
        for gap in _GAPS[:2] if crowded else _GAPS:
            for k in range(count):
                c, s = cos(2 * pi * k / count), sin(2 * pi * k / count)
                cost = 0.9 * gap + 7 * (1 - (c * outward[0] + s * outward[1]))
                if best is not None and cost >= best[0]:
                    continue
                centre = _beside(target, half, (c, s), gap)
                cost += self._cost(centre, half, not crowded)
                if best is None or round(cost, 3) < round(best[0], 3):
                    best = (cost, centre, gap)
        assert best is not None
        cost, centre, gap = best
        if crowded and cost > 400:
            return None
        box = bounds([along(centre, half, -1), along(centre, half, 1)])
        leader = _leader(box, target) if gap >= _LEADER else None
        self.boxes.append(box)
        if leader:
            self.segments.append(leader)
        return Label(words, (centre[0], centre[1] + 4.1), leader)

    def _cost(self, centre: Point, half: Point, lines: bool) -> float:
        box = bounds([along(centre, half, -1), along(centre, half, 1)], 1)
        hits = sum(500 + common for other in self.boxes if (common := overlap(box, other)) > 0)
        size = (box[2] - box[0]) * (box[3] - box[1])
        outside = size - overlap(box, self.area)
        crossed = sum(14.0 for a, b in self.segments if lines and _crosses(a, b, box))
        return hits + (2000 + outside if outside > 1e-6 else 0.0) + crossed


def _beside(target: Box, half: Point, direction: Point, gap: float) -> Point:
    """The centre of a label that clears ``target`` by ``gap`` in a direction."""
    c, s = direction
    reach_x = (target[2] - target[0]) / 2 + half[0] + gap
    reach_y = (target[3] - target[1]) / 2 + half[1] + gap
    scale = min(reach_x / abs(c) if abs(c) > 1e-9 else 1e9, reach_y / abs(s) if abs(s) > 1e-9 else 1e9)
    return along(middle(target), direction, scale)


def _leader(box: Box, target: Box) -> tuple[Point, Point] | None:
    centre = middle(box)
    way = unit(centre, middle(target))
    out, into = clip(centre, way, box), clip(centre, way, target)
    return (out[1], into[0]) if out and into else None


def _crosses(a: Point, b: Point, box: Box) -> bool:
    step = (b[0] - a[0], b[1] - a[1])
    part = clip(a, step, box)
    if part is None:
        return False
    size = step[0] * step[0] + step[1] * step[1] or 1.0
    first, last = (((p[0] - a[0]) * step[0] + (p[1] - a[1]) * step[1]) / size for p in part)
    return last > 0 and first < 1
