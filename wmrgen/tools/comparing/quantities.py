"""Lengths of a robot as a whole, such as its track; and its wheels as the parameters of a controller have them."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from wmrgen.geometry.layout.skid import placed, sides
from wmrgen.tools.comparing.record import Side

_BESIDE = 0.05  # of the robot's extent: what lies nearer the middle is neither front nor rear, left nor right


def parts(wheels: Iterable[Side]) -> list[Side]:
    """The wheels that are driven or hold the robot to a direction."""
    return [w for w in wheels if w.drives or w.kind.constrains]


def forward(wheels: Sequence[Side]) -> complex:
    """The direction in which the wheels roll straight: x, unless all fixed ones roll along y or aslant."""
    fixed = [w for w in wheels if w.kind.fixed_axle]
    angle = math.remainder(fixed[0].of("heading"), math.pi) if fixed else 0.0
    return cmath.rect(1, angle if angle > -math.pi / 2 + 1e-6 else angle + math.pi)


def as_driven(wheels: Sequence[Side], track: float) -> tuple[Side, ...]:
    """Wheels, the fixed ones where they stand of the differential drive of that track as which a robot turns that
    skids."""
    along = forward(wheels)
    fixed = [w for w in wheels if w.kind.fixed_axle]
    if not fixed:
        return tuple(wheels)
    own = sides([w.pivot for w in fixed], along)
    places = placed([(w.of("x"), w.of("y")) for w in fixed], (along.real, along.imag), own, track)
    moved = {id(w): {"x": x, "y": y} for w, (x, y) in zip(fixed, places, strict=True)}
    return tuple(replace(w, values={**w.values, **moved.get(id(w), {})}) for w in wheels)


def box(points: Sequence[complex]) -> tuple[complex, complex]:
    """The middle of the rectangle that points fill, and its size."""
    xs, ys = [p.real for p in points], [p.imag for p in points]
    size = complex(max(xs) - min(xs), max(ys) - min(ys))
    return complex(min(xs), min(ys)) + size / 2, size


def in_ring(wheels: Sequence[Side]) -> bool:
    """All wheels have rollers, on axles that are not parallel."""
    first = wheels[0].of("heading")
    return all(w.kind.rollers for w in wheels) and any(
        abs(math.sin(w.of("heading") - first)) >= 0.1 for w in wheels
    )


def centre(points: Sequence[complex], ring: bool) -> complex:
    """The middle of places: of a ring their mean, else that of the rectangle that they fill."""
    return sum(points) / len(points) if ring else box(points)[0]


def roles(wheels: Sequence[Side]) -> list[str]:
    """Where each wheel is, by its place: "front left", "rear", "left"."""
    if not wheels:
        return []
    along = forward(wheels).conjugate()
    points = [along * w.pivot for w in wheels]
    middle, size = box(points)
    words = []
    for p in points:
        off = p - middle
        end = "front" if off.real > _BESIDE * size.real else "rear" if off.real < -_BESIDE * size.real else ""
        side = (
            "left" if off.imag > _BESIDE * size.imag else "right" if off.imag < -_BESIDE * size.imag else ""
        )
        words.append(f"{end} {side}".strip())
    return words


def lengths(wheels: Sequence[Side], where: Sequence[str], along: complex) -> dict[str, float]:
    """What the wheels have of `LENGTHS`, and "middle", from their places and radii; ``where``: their `roles`, ``along``
    the `forward` of the robot. The track is that of its fixed wheels, where it has some, the radius that of its driven
    ones."""
    at = [along.conjugate() * w.pivot for w in wheels]
    whole = range(len(wheels))
    driven = [i for i in whole if (joints := wheels[i].actuated) is None or "spin" in joints] or list(whole)
    fixed = [i for i in whole if wheels[i].kind.fixed_axle] or list(whole)

    def of(word: str, indices: Iterable[int] = whole) -> list[int]:
        return [i for i in indices if word in where[i].split()]

    def apart(first: Sequence[int], second: Sequence[int], part: str) -> float | None:
        if not first or not second:
            return None
        return mean(getattr(at[i], part) for i in first) - mean(getattr(at[i], part) for i in second)

    def radius(indices: Iterable[int]) -> float | None:
        values = [wheels[i].values.get("r") for i in indices]
        return None if None in values or not values else mean(v for v in values if v is not None)

    result = {
        "track": apart(of("left", fixed), of("right", fixed), "imag"),
        "front_track": apart(of("left", of("front")), of("right", of("front")), "imag"),
        "rear_track": apart(of("left", of("rear")), of("right", of("rear")), "imag"),
        "wheelbase": apart(of("front"), of("rear"), "real"),
        "radius": radius(driven),
    } | {f"{word}_radius": radius(of(word)) for word in ("left", "right", "front", "rear")}
    if all(w.kind.rollers for w in wheels):
        ring = in_ring(wheels)
        middle = centre(at, ring)
        reach = [abs(p) if ring else abs(p.real) + abs(p.imag) for p in (q - middle for q in at)]
        result["ring" if ring else "sum"] = mean(reach)
    offsets = [abs(w.values["offset_y"]) for w in wheels if "offset_y" in w.values and w.kind.steers]
    result["offset"] = mean(offsets) if offsets else None
    return {key: value for key, value in result.items() if value is not None}


def mean(values: Iterable[float]) -> float:
    numbers = list(values)
    return math.fsum(numbers) / len(numbers)
