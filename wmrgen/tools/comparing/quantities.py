"""Lengths of a robot as a whole, such as its track, and the positions of its wheels in words."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from wmrgen.geometry.layout.skid import placed, sides
from wmrgen.tools.comparing.record import Side

_BESIDE = 0.05  # of the robot's extent: what lies nearer the middle is neither front nor rear, left nor right


def parts(wheels: Iterable[Side]) -> list[Side]:
    """Return the wheels that are driven or constrain the direction of motion."""
    return [w for w in wheels if w.drives or w.kind.constrains]


def forward(wheels: Sequence[Side]) -> complex:
    """Return the direction of driving straight: x, unless all fixed wheels roll along y or aslant."""
    fixed = [w for w in wheels if w.kind.fixed_axle]
    angle = math.remainder(fixed[0].of("heading"), math.pi) if fixed else 0.0
    return cmath.rect(1, angle if angle > -math.pi / 2 + 1e-6 else angle + math.pi)


def as_driven(wheels: Sequence[Side], track: float) -> tuple[Side, ...]:
    """Return the wheels, the fixed ones at the positions of the differential drive that a robot that skids turns like.

    ``track`` is the effective track [m].
    """
    along = forward(wheels)
    fixed = [w for w in wheels if w.kind.fixed_axle]
    if not fixed:
        return tuple(wheels)
    own = sides([w.pivot for w in fixed], along)
    positions = placed([(w.of("x"), w.of("y")) for w in fixed], (along.real, along.imag), own, track)
    moved = {id(w): {"x": x, "y": y} for w, (x, y) in zip(fixed, positions, strict=True)}
    return tuple(replace(w, values={**w.values, **moved.get(id(w), {})}) for w in wheels)


def box(points: Sequence[complex]) -> tuple[complex, complex]:
    """Return the middle of the rectangle that points fill, and its size."""
    xs, ys = [p.real for p in points], [p.imag for p in points]
    size = complex(max(xs) - min(xs), max(ys) - min(ys))
    return complex(min(xs), min(ys)) + size / 2, size


def in_ring(wheels: Sequence[Side]) -> bool:
    """Return whether all wheels have rollers, on axles that are not parallel."""
    first = wheels[0].of("heading")
    return all(w.kind.rollers for w in wheels) and any(
        abs(math.sin(w.of("heading") - first)) >= 0.1 for w in wheels
    )


def centre(points: Sequence[complex], ring: bool) -> complex:
    """Return the middle of positions: for a ring their mean, else the middle of the rectangle that they fill."""
    return sum(points) / len(points) if ring else box(points)[0]


def roles(wheels: Sequence[Side]) -> list[str]:
    """Return the position of each wheel in words: "front left", "rear", "left"."""
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
    """Return the lengths of a robot [m] by the keys of `importing.controllers.LENGTHS`, as far as its wheels have them.

    The track is that of the fixed wheels, if there are any. The radius is that of the driven wheels.

    Args:
        wheels: The wheels.
        where: Their positions in words, from `roles`.
        along: The direction of driving, from `forward`.
    """
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
        off = [p - middle for p in at]
        reach = [abs(p) if ring else abs(p.real) + abs(p.imag) for p in off]
        result["ring" if ring else "sum"] = mean(reach)
    offsets = [abs(w.values["offset_y"]) for w in wheels if "offset_y" in w.values and w.kind.steers]
    result["offset"] = mean(offsets) if offsets else None
    return {key: value for key, value in result.items() if value is not None}


def mean(values: Iterable[float]) -> float:
    """Return the mean of some numbers."""
    numbers = list(values)
    return math.fsum(numbers) / len(numbers)
