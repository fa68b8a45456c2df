"""The lengths of a controller against those of a robot, and the robot's wheels as the controller has them."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from wmrgen.errors import Mark
from wmrgen.robotfile.wheel_types import WheelType
from wmrgen.robotfile.wheel_types.types import FIXED, STEERED, SWEDISH
from wmrgen.tools.comparing.differences import KIND, MISSING, PLACE, SIGN, length, order, places, same
from wmrgen.tools.comparing.matching import bare
from wmrgen.tools.comparing.motion import Pairs
from wmrgen.tools.comparing.quantities import centre, forward, in_ring, lengths, mean, parts, roles
from wmrgen.tools.comparing.record import CONTROLLER, Difference, Layout, Side, Silent
from wmrgen.tools.importing.controllers import LENGTHS
from wmrgen.tools.importing.records import Controller, Named

# Whether a controller of a kind can drive such wheels.
_FITS: dict[str, Callable[[list[WheelType]], bool]] = {
    "differential": lambda kinds: not any(k.rollers or k.steers for k in kinds),
    "mecanum": lambda kinds: all(k.rollers for k in kinds),
    "omni": lambda kinds: all(k.rollers or k.turns for k in kinds),
    "swerve": lambda kinds: any(k.turns for k in kinds),
}
_FITS |= dict.fromkeys(("ackermann", "bicycle", "tricycle"), _FITS["swerve"])
# Types of other software whose controllers expect every joint to count forward.
_FORWARD = re.compile("(diff|mecanum|skid)_?(steer_?)?drive", re.IGNORECASE)
# A robot of each kind: type and place of its wheels.
_SHAPES: dict[str, dict[str, tuple[complex, ...]]] = {
    "differential": {FIXED.name: (1j, -1j)},
    "mecanum": {SWEDISH.name: (1 + 1j, 1 - 1j, -1 + 1j, -1 - 1j)},
    "omni": {SWEDISH.name: tuple(cmath.rect(1, k * math.pi / 3) for k in (1, 3, 5))},
    "ackermann": {FIXED.name: (1j, -1j), STEERED.name: (2 + 1j, 2 - 1j)},
    "tricycle": {FIXED.name: (1j, -1j), STEERED.name: (2,)},
    "bicycle": {FIXED.name: (0,), STEERED.name: (2,)},
    "swerve": {STEERED.name: (1 + 1j, 1 - 1j, -1 + 1j, -1 - 1j)},
}


def standing(layout: Layout, other: Controller | None = None) -> Layout:
    """Return a controller as a robot of its kind, with its lengths, and with those of ``other`` that it lacks."""
    c = layout.controller
    if c is None:
        return layout
    kind = c.kind or ("swerve" if "wheelbase" in c.lengths else "differential")
    wheels = [_usual(kind, name, z) for name, points in _SHAPES[kind].items() for z in points]
    known = {**_missing(c, other), **{key: worth(c, key, True) for key in c.lengths}}
    moved = _moved(c, wheels, known)
    wheels = [replace(w, values={**w.values, **m.values}) for w, m in zip(wheels, moved, strict=True)]
    return Layout(layout.file, CONTROLLER, tuple(wheels), controller=c, title=layout.title)


def _missing(c: Controller, other: Controller | None) -> dict[str, float]:
    """Return the lengths of another controller [m] that one lacks.

    Only radii are returned if one has a sum of lengths, and the other has single ones.
    """
    known = other.lengths if other else {}
    radii = {key for key in LENGTHS if key.endswith("radius")}
    sums = {"sum", "ring"} & {*c.lengths, *known} if c.lengths.keys() - radii else set()
    return {key: worth(other, key, True) for key in known if other and (not sums or key in radii)}


def _usual(kind: str, type_: str, at: complex) -> Side:
    """Return a wheel of radius 1 at a position, with the usual heading and rollers of a kind of drive."""
    values = {"x": at.real, "y": at.imag, "r": 1.0, "heading": 0.0}
    if kind == "omni":
        values |= {"heading": cmath.phase(1j * at), "gamma": 0.0}
    elif kind == "mecanum":
        values |= {"gamma": -math.copysign(math.pi / 4, at.real * at.imag)}
    return Side((f"wheel at {at:.3g}",), type_, values)


class WithController(NamedTuple):
    """The lengths of a controller against those of a robot."""

    differences: list[Difference]
    pairs: Pairs  # the robot's wheels, each with what the controller has of it
    notes: list[str]
    silent: Silent
    compared: bool  # they have a length or a place in common


def with_controller(a: Layout, c: Controller) -> WithController:
    """Return what a controller has otherwise than a robot."""
    wheels = parts(a.wheels)
    if not wheels:
        return WithController([], [], [], ([], []), False)
    kinds = [w.kind for w in wheels]
    where, along = roles(wheels), forward(wheels)
    skids = all(k.fixed_axle for k in kinds) and any("front" in word for word in where)
    only = a.controller.lengths if a.controller else LENGTHS
    sizes = {key: value for key, value in lengths(wheels, where, along).items() if key in only}
    c = _as_meant(c, kinds, sizes.get("wheelbase", 0.0))
    alone = [s for key, s in c.lengths.items() if key not in sizes]
    of_wheels = {_placed(c, w, word) for w, word in zip(wheels, where, strict=True)}
    alone += [s for k, place in c.places.items() if k not in of_wheels for s in place]
    silent = (
        [f"{s.key} {float(s.value):.6g} m" for s in alone],
        _needed(c, sizes),
    )
    said = {key: worth(c, key, not skids) for key in c.lengths}
    differences: list[Difference] = []
    for key, value in list(said.items()):
        tracks = [sizes[k] for k in ("front_track", "rear_track") if k in sizes and key == "track"]
        if key in sizes and any(same(v, value) for v in (sizes[key], *tracks)):
            del said[key]
        elif key in sizes:
            settings = (c.lengths[key], c.multipliers.get(key))
            marks = tuple(s.mark for s in settings if s and s.mark)
            title = "effective_track" if key == "track" and a.effective_track else key
            differences.append(length(title, sizes[key], value, marks, f" ({settings[0].key})"))
    pairs = list(zip(wheels, _moved(c, wheels, said), strict=True))
    if c.places:
        differences += places(pairs, along)
    differences += [*_joints(a, c), *_sides(c, wheels, where), *_signs(pairs)]
    if c.kind and not _FITS[c.kind](kinds):
        has = ", ".join(dict.fromkeys(k.noun for k in kinds))
        words = f"a {c.kind} drive cannot drive a {has}"
        differences.append(Difference(KIND, "kind", "", has, c.kind, words))
    if c.kind == "omni" and a.ordered:
        differences += order(wheels, [i for j in c.joints for i, w in enumerate(wheels) if _is(w, j.joint)])
    factors = [f"{f.key} {float(f.value):g}" for f in c.multipliers.values() if skids and f.value != 1]
    notes = [f"{factor} corrects for skidding, and does not count" for factor in factors]
    placed = bool(of_wheels & c.places.keys())
    named = any(_is(w, j.joint) for w in wheels for j in c.joints)
    common = placed or any(key in sizes for key in c.lengths) or named
    return WithController(differences, pairs, notes, silent, common)


def _needed(c: Controller, sizes: Mapping[str, float]) -> list[str]:
    """Return the lengths of a robot that a controller of its kind needs and lacks."""
    track = "ring" if "ring" in sizes else "track"
    needed = ["radius"] if c.kind in ("tricycle", "bicycle") else [track, "radius"]
    if c.kind and c.kind not in ("differential", "omni"):
        needed.append("wheelbase")
    placed = {"sum", "ring"} & c.lengths.keys() or c.places
    known = {key.rpartition("_")[2] for key in c.lengths}
    known |= {"track", "ring", "wheelbase"} if placed else set()
    return [
        key.replace("ring", "distance from the centre") for key in needed if key in sizes and key not in known
    ]


def worth(c: Controller, key: str, multiplied: bool) -> float:
    """Return a length of a controller [m]. The sign of a multiplier is a direction of rolling and does not count.

    Args:
        c: The controller.
        key: The length.
        multiplied: Whether its multiplier counts.
    """
    factor = c.multipliers.get(key) if multiplied else None
    return float(c.lengths[key].value) * (abs(float(factor.value)) if factor else 1.0)


def _as_meant(c: Controller, kinds: Iterable[WheelType], wheelbase: float) -> Controller:
    """Return a controller with its track under that name, and a radius for each side with its own multiplier.

    Drivers of plain wheels call the track a wheel base. It is one if it equals the robot's ``wheelbase`` [m].
    """
    known = dict(c.lengths)
    plain = "track" not in known and "wheelbase" in known and all(k.fixed_axle for k in kinds)
    if plain and not same(float(known["wheelbase"].value), wheelbase):
        known["track"] = known.pop("wheelbase")
    if "radius" in known:
        known |= {
            key: known["radius"] for key in c.multipliers if key.endswith("_radius") and key not in known
        }
    return replace(c, lengths=known)


def _is(w: Side, joint: str) -> bool:
    """Return whether a joint belongs to a wheel: by its name without a prefix, or by the part that distinguishes it."""
    names = (*w.names, *(known.name for known in w.joints.values()))
    return any(own.endswith(joint) or bare(own) == bare(joint) != "" for own in names)


def _joints(a: Layout, c: Controller) -> Iterator[Difference]:
    for named in c.joints:
        if a.joints is not None and not any(own.endswith(named.joint) for own in a.joints):
            words = f"no joint is called {named.joint}"
            yield Difference(MISSING, "joint", "", None, named.joint, words, _mark(named))


def _mark(named: Named) -> tuple[Mark, ...]:
    return (named.mark,) if named.mark else ()


def _sides(c: Controller, wheels: Sequence[Side], where: Sequence[str]) -> Iterator[Difference]:
    """Yield wheels that are not on the side where the controller expects them, or not at that end."""
    for w, word in zip(wheels, where, strict=True):
        named = next((j for j in c.joints if _is(w, j.joint)), None)
        if named and _mirror(c, named.role, word):
            words = f"{w.name} is {word}, the controller expects it {named.role}"
            yield Difference(PLACE, "side", w.name, word, named.role, words, _mark(named))


def _mirror(c: Controller, expected: str, word: str) -> complex:
    """Return the signs of x and y that move a wheel from ``word`` to where it is expected; 0 if it is there."""
    ahead = {expected.split(" ")[0], word.split(" ")[0]} == {"front", "rear"} and c.kind != "differential"
    aside = {expected.split(" ")[-1], word.split(" ")[-1]} == {"left", "right"}
    return complex(-1 if ahead else 1, -1 if aside else 1) if ahead or aside else 0


def _signs(pairs: Pairs) -> Iterator[Difference]:
    for v, w in pairs:
        if "heading" in w.values:
            p, q = v.of("heading"), w.values["heading"]
            words = f"{v.name}: its joint counts backward, the controller expects it to count forward"
            yield Difference(SIGN, "sign", v.name, p, q, words, tuple(v.marks.values()))


def _moved(c: Controller, wheels: Sequence[Side], said: Mapping[str, float]) -> list[Side]:
    """Return the wheels of a robot, in order, at the positions that the lengths ``said`` of a controller give.

    The controller treats the robot as symmetric. Its fixed axle stays where it is.
    """
    where, along = roles(wheels), forward(wheels)
    sizes = lengths(wheels, where, along)
    at = [along.conjugate() * w.pivot for w in wheels]
    axle = [p.real for p, w in zip(at, wheels, strict=True) if w.kind.fixed_axle]
    middle = centre(at, in_ring(wheels))
    origin = complex(mean(axle) if axle else middle.real, middle.imag)
    result = []
    for w, p, word in zip(wheels, at, where, strict=True):
        own = next((j for j in c.joints if _is(w, j.joint)), Named("", "", False))
        expected, off = own.role or word, p - origin
        if signs := _mirror(c, expected, word):
            off = complex(off.real * signs.real, off.imag * signs.imag)
        place = along * (origin + _displaced(off, expected, said, sizes))
        values, marks = {"x": place.real, "y": place.imag}, {}
        if signs and "gamma" in w.values:
            values["gamma"] = w.values["gamma"] * signs.real * signs.imag  # the rollers that are usual there
        if pivot := c.places.get(_placed(c, w, word)):
            values = {axis: float(s.value) for axis, s in zip("xy", pivot, strict=True)}
            marks = {axis: s.mark for axis, s in zip("xy", pivot, strict=True) if s.mark}
        for key in (*(f"{side}_radius" for side in expected.split()), "radius"):
            if key in said:
                values.setdefault("r", said[key])
        if "offset" in said and w.kind.steers:
            outward = w.of("offset_y") or values["y"] * math.cos(w.of("heading"))
            values["offset_y"] = math.copysign(said["offset"], outward)
        ahead = along * _positive(c)
        if not w.kind.turns and (ahead.conjugate() * cmath.rect(1, w.of("heading"))).real < -0.9:
            values |= {"heading": cmath.phase(ahead)}
        result.append(replace(w, values=values, marks=marks))
    return result


def _positive(c: Controller) -> int:
    """Return the direction in which a controller expects a wheel to roll at a positive rate; 0 if it may know it."""
    return 1 if _FORWARD.search(c.type) else 0


def _placed(c: Controller, w: Side, word: str) -> str:
    """Return the joint, or the end and side, for which a controller has the position of a wheel; "" if for none."""
    roles = {named.joint: named.role for named in c.joints}
    own = [k for k in c.places if _is(w, k)] or [
        k for k in c.places if word in (k, k.removeprefix("middle "), roles.get(k))
    ]
    return own[0] if len(own) == 1 else ""


def _displaced(p: complex, expected: str, said: Mapping[str, float], sizes: Mapping[str, float]) -> complex:
    """Return a pivot from the centre of the robot by the lengths of a controller; ``expected`` is its position."""
    end = expected.split(" ")[0]
    track = said.get(f"{end}_track", said.get("track"))
    if track is not None and expected.endswith(("left", "right")):
        p = complex(p.real, track / 2 if expected.endswith("left") else -track / 2)
    if "wheelbase" in said and sizes.get("wheelbase"):
        p = complex(p.real * said["wheelbase"] / sizes["wheelbase"], p.imag)
    if "sum" in said and "sum" in sizes:
        p = complex(p.real, math.copysign(abs(p.imag) + said["sum"] - sizes["sum"], p.imag))
    return p * said["ring"] / sizes["ring"] if "ring" in said and "ring" in sizes else p
