"""Lengths of a robot as a whole, such as its track; and its wheels as the parameters of a controller have them."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from wmrgen.comparing.record import Side
from wmrgen.importing.records import Controller, Setting
from wmrgen.wheels import WHEEL_TYPES

_BESIDE = 0.05  # of the robot's extent: what lies nearer the middle is neither front nor rear, left nor right


def parts(wheels: Iterable[Side]) -> list[Side]:
    """The wheels that are driven or hold the robot to a direction."""
    return [w for w in wheels if w.drives or WHEEL_TYPES[w.type].constrains]


def forward(wheels: Sequence[Side]) -> complex:
    """The direction in which the wheels roll straight: x, unless all fixed ones roll along y or aslant."""
    fixed = [w for w in wheels if WHEEL_TYPES[w.type].fixed_axle]
    angle = math.remainder(fixed[0].of("heading"), math.pi) if fixed else 0.0
    return cmath.rect(1, angle if angle > -math.pi / 2 + 1e-6 else angle + math.pi)


def box(points: Sequence[complex]) -> tuple[complex, complex]:
    """The middle of the rectangle that points fill, and its size."""
    xs, ys = [p.real for p in points], [p.imag for p in points]
    size = complex(max(xs) - min(xs), max(ys) - min(ys))
    return complex(min(xs), min(ys)) + size / 2, size


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
    the `forward` of the robot. The track is that of its fixed wheels, where it has some."""
    at = [along.conjugate() * w.pivot for w in wheels]
    whole = range(len(wheels))
    fixed = [i for i in whole if WHEEL_TYPES[wheels[i].type].fixed_axle] or list(whole)

    def of(word: str, indices: Iterable[int] = whole) -> list[int]:
        return [i for i in indices if word in where[i].split()]

    def apart(first: Sequence[int], second: Sequence[int], part: str) -> float | None:
        if not first or not second:
            return None
        return _mean(getattr(at[i], part) for i in first) - _mean(getattr(at[i], part) for i in second)

    def radius(indices: Iterable[int]) -> float | None:
        values = [wheels[i].values.get("r") for i in indices]
        return None if None in values or not values else _mean(v for v in values if v is not None)

    result = {
        "track": apart(of("left", fixed), of("right", fixed), "imag"),
        "front_track": apart(of("left", of("front")), of("right", of("front")), "imag"),
        "rear_track": apart(of("left", of("rear")), of("right", of("rear")), "imag"),
        "wheelbase": apart(of("front"), of("rear"), "real"),
        "radius": radius(whole),
    } | {f"{word}_radius": radius(of(word)) for word in ("left", "right", "front", "rear")}
    rolling = [w for w in wheels if WHEEL_TYPES[w.type].rollers]
    if len(rolling) == len(wheels):
        parallel = all(abs(math.sin(w.of("heading") - wheels[0].of("heading"))) < 0.1 for w in wheels)
        middle = box(at)[0] if parallel else sum(at) / len(at)
        reach = [abs(p.real) + abs(p.imag) if parallel else abs(p) for p in (q - middle for q in at)]
        result["sum" if parallel else "ring"] = _mean(reach)
    offsets = [
        abs(w.values["offset_y"]) for w in wheels if "offset_y" in w.values and WHEEL_TYPES[w.type].steers
    ]
    result["offset"] = _mean(offsets) if offsets else None
    return {key: value for key, value in result.items() if value is not None}


def _mean(values: Iterable[float]) -> float:
    numbers = list(values)
    return math.fsum(numbers) / len(numbers)


def worth(setting: Setting, c: Controller, key: str, multiplied: bool) -> float:
    """A length of a controller, times its multiplier where that counts."""
    factor = c.multipliers.get(key) if multiplied else None
    return float(setting.value * (factor.value if factor else 1))


def named(w: Side, names: Iterable[str]) -> str:
    """The first of ``names`` that is one of the wheel's, or the end of one: prefixes are arguments."""
    return next((name for name in names if any(own == name or own.endswith(name) for own in w.names)), "")


def controlled(c: Controller, wheels: Sequence[Side], said: Mapping[str, float]) -> list[Side]:
    """The wheels of a robot, in order, as a controller has them: moved to the lengths ``said`` about the middle of the
    robot, which it takes to be symmetric, its fixed axle kept."""
    where, along = roles(wheels), forward(wheels)
    mine = lengths(wheels, where, along)
    cars = [w for w in wheels if WHEEL_TYPES[w.type].fixed_axle]
    middle = box([along.conjugate() * w.pivot for w in wheels])[0]
    still = _mean((along.conjugate() * w.pivot).real for w in cars) if cars else middle.real
    centre = complex(still, middle.imag)
    joints = [joint.joint for joint in c.joints]
    result = []
    for w, word in zip(wheels, where, strict=True):
        told = next((j.role for j in c.joints if j.joint == named(w, joints) and j.role), word)
        p = along.conjugate() * w.pivot - centre
        end = next((e for e in ("front", "rear") if e in told), "")
        track = said.get(f"{end}_track", said.get("track"))
        if track is not None and ("left" in told or "right" in told):
            p = complex(p.real, math.copysign(track / 2, 1 if "left" in told else -1))
        if "wheelbase" in said and mine.get("wheelbase"):
            p = complex(p.real * said["wheelbase"] / mine["wheelbase"], p.imag)
        if "sum" in said and "sum" in mine:
            p = complex(p.real, math.copysign(abs(p.imag) + said["sum"] - mine["sum"], p.imag))
        if "ring" in said and "ring" in mine:
            p *= said["ring"] / mine["ring"]
        place = along * (p + centre)
        key = named(w, c.places) or (
            word if word in c.places else f"middle {word}" if f"middle {word}" in c.places else ""
        )
        marks = {}
        if key:
            x, y = c.places[key]
            place = complex(float(x.value), float(y.value))
            marks = {axis: s.mark for axis, s in (("x", x), ("y", y)) if s.mark}
        values = {"x": place.real, "y": place.imag}
        radii = [said[k] for k in (*(f"{side}_radius" for side in told.split()), "radius") if k in said]
        if radii:
            values["r"] = radii[0]
        if "offset" in said and WHEEL_TYPES[w.type].steers:
            values["offset_y"] = math.copysign(
                said["offset"], w.of("offset_y") or place.imag * math.cos(w.of("heading"))
            )
        result.append(replace(w, values=values, marks=marks))
    return result
