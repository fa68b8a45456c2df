"""Differences between two files that describe the wheels of one robot."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from wmrgen.errors import Mark
from wmrgen.tools.comparing.matching import matched
from wmrgen.tools.comparing.motion import Pairs
from wmrgen.tools.comparing.quantities import box, centre, forward, in_ring, lengths, parts, roles
from wmrgen.tools.comparing.record import JOINTS, SAME, Difference, Layout, Side, Silent, Tie

PLACE, SIGN, ROLLERS, ORDER, MISSING, KIND, OFFSET, COUPLED = (f"WMR{n:03}" for n in range(44, 52))
CODES = {"track": "WMR040", "wheelbase": "WMR041", "radius": "WMR042", "sum": "WMR043", "ring": "WMR043"}
CODES["offset"] = OFFSET
_OPTIONAL = {"r": "radius", "heading": "heading", "gamma": "gamma"}  # values that a file may lack
_TITLES = {"sum": "lx + ly", "ring": "distance from the centre", "offset": "offset along the axle"}


def same(a: float, b: float, size: float = 0.0) -> bool:
    """Return whether two lengths are equal within `SAME`.

    Args:
        a: A length [m].
        b: Another length [m].
        size: A length whose share counts instead, if it is larger [m].
    """
    return abs(a - b) <= SAME * max(abs(a), abs(b), size)


def length(
    key: str, a: float, b: float, marks: tuple[Mark, ...], remark: str = "", wheel: str = ""
) -> Difference:
    """Return the difference of a length.

    Args:
        key: The length, as in `quantities.lengths`.
        a: The length in the first file [m].
        b: The length in the second file [m].
        marks: Its places.
        remark: The name of the length in the second file.
        wheel: The wheel that has the length; "" for the whole robot.
    """
    title = _TITLES.get(key, key.replace("_", " "))
    looks = ", twice that" if same(b, 2 * a) else ", half of that" if same(2 * b, a) else ""
    share = f" ({(b - a) / abs(a):+.1%}{looks})".replace("%", " %") if not same(a, 0, abs(b)) else ""
    words = f"{f'{wheel}: ' if wheel else ''}{title}{remark} {a:.6g} m -> {b:.6g} m{share}"
    return Difference(CODES[key.rsplit("_", 1)[-1]], title, wheel, a, b, words, marks)


# ---- another description, which has wheels


def with_layout(a: Layout, b: Layout) -> tuple[list[Difference], Pairs, list[str], Silent]:
    """Return the differences of two files that describe wheels.

    Also return the pairs of wheels that move the robot, notes, and the values that only one file has.
    """
    every, *alone = matched(a.wheels, b.wheels)
    notes: list[str] = []
    differences: list[Difference] = []
    for owner, wheels in zip((a, b), alone, strict=True):
        for w in wheels:
            words = f"{w.name}: only {owner.source} has it"
            if parts([w]):
                first, second = (w.type, None) if owner is a else (None, w.type)
                differences.append(Difference(MISSING, "wheel", w.name, first, second, words, _marks(w)))
            else:
                notes.append(f"{words}; it constrains no motion")
    pairs = [(v, w) for v, w in every if parts([v])]
    if a.effective_track and b.effective_track:
        (old, old_mark), (new, new_mark) = a.effective_track, b.effective_track
        if not same(old, new):
            differences.append(length("effective_track", old, new, (new_mark, old_mark)))
    along = forward([v for v, _ in pairs])
    differences += [*places(pairs, along), *_radii(every)]
    for v, w in every:
        differences += _wheel(v, w)
    differences += coupled(a, b, every)
    if a.ordered and b.ordered and not any(alone):
        differences += order(
            a.wheels, [a.wheels.index(v) for v, _ in sorted(every, key=lambda p: b.wheels.index(p[1]))]
        )
    return differences, pairs, notes, _silent(pairs)


def _silent(pairs: Pairs) -> Silent:
    return _missing(pairs), _missing([(w, v) for v, w in pairs])


def _missing(pairs: Pairs) -> list[str]:
    """Return the values of wheels that the first of each pair lacks."""
    result = []
    for v, w in pairs:
        missing = w.values.keys() - v.values.keys() if v.type == w.type else set()
        result += [f"{words} of {v.name}" for key, words in _OPTIONAL.items() if key in missing]
    return result


def _marks(*wheels: Side, keys: Iterable[str] = ()) -> tuple[Mark, ...]:
    """Return the places of one of ``keys`` of each wheel, or of the wheel, the last wheel first."""
    every = [w.marks.get(key) for w in reversed(wheels) for key in (*keys, "")]
    return tuple(dict.fromkeys(mark for mark in every if mark))


def _radii(pairs: Pairs) -> Iterator[Difference]:
    both = [(v, w, v.values["r"], w.values["r"]) for v, w in pairs if "r" in v.values and "r" in w.values]
    driven = [pair for pair in both if parts([pair[0]])]
    together = len({(p, q) for _, _, p, q in driven}) == 1
    for v, w, p, q in both:
        alike = together and parts([v])
        if not same(p, q) and not (alike and (v, w, p, q) != driven[0]):
            yield length("radius", p, q, _marks(v, w, keys="r"), "", "" if alike else v.name)


def _wheel(v: Side, w: Side) -> Iterator[Difference]:
    """Yield the differences of one wheel, except its position and radius."""
    marks = _marks(v, w, keys=("heading", "beta", "gamma"))
    if v.type != w.type:
        yield Difference(KIND, "type", v.name, v.type, w.type, f"{v.name} is {v.type} -> {w.type}", marks)
    both = v.values.keys() & w.values.keys()
    if "heading" in both and parts([v]) and v.kind.directed:
        p, q = v.values["heading"], w.values["heading"]
        apart = abs(math.remainder(q - p, 2 * math.pi))
        if apart > math.pi - SAME:
            yield Difference(
                SIGN, "sign", v.name, p, q, f"{v.name}: its joint counts in the other direction", marks
            )
        elif apart > SAME:
            words = f"{v.name}: heading {math.degrees(p):.4g} deg -> {math.degrees(q):.4g} deg"
            yield Difference(SIGN, "heading", v.name, p, q, words, marks)
    if "gamma" in both:
        p, q = v.values["gamma"], w.values["gamma"]
        if abs(math.remainder(p - q, math.pi)) > SAME:
            other = (
                ": they lean in the other direction" if abs(math.remainder(p + q, math.pi)) <= SAME else ""
            )
            words = f"{v.name}: rollers {math.degrees(p):.4g} deg -> {math.degrees(q):.4g} deg{other}"
            yield Difference(ROLLERS, "gamma", v.name, p, q, words, marks)
    yield from _contact(v, w)


def _contact(v: Side, w: Side) -> Iterator[Difference]:
    """Yield the difference of the contact from the pivot; for castors without a motor, of its distance alone."""
    offsets = [cmath.rect(1, x.of("heading")) * complex(x.of("d"), x.of("offset_y")) for x in (v, w)]
    if not parts([v]):
        offsets = [complex(abs(offset)) for offset in offsets]
    known = all({"d", "offset_y"} & x.values.keys() for x in (v, w)) and v.kind.turns
    if known and abs(offsets[0] - offsets[1]) > SAME * max(map(abs, offsets)) + 1e-6:
        words = f"{v.name}: contact from pivot {shown(offsets)}"
        yield _pointed(OFFSET, "contact", v.name, offsets, words, _marks(v, w, keys=("d", "offset_y")))


def shown(points: Sequence[complex]) -> str:
    """Return points [m] for a message, with arrows between them."""
    return " -> ".join(f"({z.real:.4g}, {z.imag:.4g}) m" for z in points)


def _pointed(
    code: str, quantity: str, wheel: str, points: Sequence[complex], words: str, marks: tuple[Mark, ...]
) -> Difference:
    first, second = ((z.real, z.imag) for z in points)
    return Difference(code, quantity, wheel, first, second, words, marks)


# ---- what both have


def places(pairs: Pairs, along: complex) -> Iterator[Difference]:
    """Yield the differences of track, wheelbase and origin, and wheels that these do not explain.

    ``along`` is the direction of driving.
    """
    if not pairs:
        return
    turned = along.conjugate()
    a, b = ([turned * complex(w.of("x"), w.of("y")) for w in side] for side in zip(*pairs, strict=True))
    ring = in_ring([v for v, _ in pairs])
    middle, other = centre(a, ring), centre(b, ring)
    near = SAME * abs(box(a)[1])
    if permuted := _permuted(a, b, near):
        for (v, w), (u, _) in zip(pairs, (pairs[i] for i in permuted), strict=True):
            if u is not v:
                words = f"{v.name} is where {u.name} was"
                yield Difference(PLACE, "place", v.name, v.name, u.name, words, _marks(v, w, keys="xy"))
        return
    where = roles([v for v, _ in pairs])
    changed: dict[str, float] = {}
    for key, was, now in _sizes(pairs, where, along):
        changed[key] = now / was
        alike = key.endswith("_track") and same(changed[key], changed.get("track", 0))
        if not alike and not same(was, now):
            keys = ("x", "y", "l") if key == "wheelbase" else ("y", "x", "l")
            yield length(key, was, now, _marks(*_farthest(pairs, a, b, keys[0]), keys=keys))
    for (v, w), p, q, word in zip(pairs, a, b, where, strict=True):
        aside = changed.get("ring", changed.get(f"{word.split(' ')[0]}_track", changed.get("track", 1.0)))
        ahead = changed.get("ring", changed.get("wheelbase", 1.0))
        if abs(q - other - complex((p - middle).real * ahead, (p - middle).imag * aside)) > near:
            points = (v.pivot, complex(w.of("x"), w.of("y")))
            marks = _marks(v, w, keys=("x", "y", "l", "alpha"))
            yield _pointed(PLACE, "place", v.name, points, f"{v.name}: place {shown(points)}", marks)
    if any(_shifted(a, b, other - middle, part, near) for part in ("real", "imag")):
        points = (along * middle, along * other)
        words = f"origin: the middle of the wheels is at {shown(points)}"
        yield _pointed(PLACE, "origin", "", points, words, _marks(*pairs[0], keys=("x", "y", "l")))


def _farthest(pairs: Pairs, a: Sequence[complex], b: Sequence[complex], along: str) -> tuple[Side, Side]:
    """Return the pair whose wheel has moved farthest along x or y."""
    moved = [abs((q - p).real if along == "x" else (q - p).imag) for p, q in zip(a, b, strict=True)]
    return pairs[moved.index(max(moved))]


def _shifted(a: Sequence[complex], b: Sequence[complex], shift: complex, part: str, near: float) -> bool:
    """The middle of the wheels has moved by ``shift`` along one axis, and no wheel has stayed: of a car with another
    wheelbase whose origin is on the rear axle those of that axle have."""
    stayed = any(abs(getattr(q - p, part)) <= near for p, q in zip(a, b, strict=True))
    return not stayed and bool(abs(getattr(shift, part)) > near)


def _permuted(a: Sequence[complex], b: Sequence[complex], near: float) -> list[int]:
    """Return, for each of ``b``, the wheel of ``a`` at its position, if wheels have changed places; else nothing."""
    indices = [min(range(len(a)), key=lambda i: abs(a[i] - q)) for q in b]
    close = all(abs(a[i] - q) <= near for i, q in zip(indices, b, strict=True))
    return indices if close and indices != sorted(indices) and len(set(indices)) == len(a) else []


def _sizes(pairs: Pairs, where: Sequence[str], along: complex) -> Iterator[tuple[str, float, float]]:
    """Yield the lengths that both have: the distance of wheels in a ring; track and wheelbase of others."""
    own = [v for v, _ in pairs]
    moved = [replace(w, type=v.type, values={**v.values, **w.values}) for v, w in pairs]
    first, second = lengths(own, where, along), lengths(moved, where, along)
    for key in ("ring",) if "ring" in first else ("track", "wheelbase", "front_track", "rear_track"):
        if first.get(key) and key in second:
            yield key, first[key], second[key]


def order(wheels: Sequence[Side], indices: Sequence[int]) -> Iterator[Difference]:
    """Yield the difference of the order; ``indices`` are those of ``wheels`` in the order of the second file."""
    if list(indices) != sorted(indices):
        names = [w.name for w in wheels]
        first = " ".join(names[i] for i in sorted(indices))
        second = " ".join(names[i] for i in indices)
        yield Difference(ORDER, "order", "", first, second, f"order of wheels: {first} -> {second}")


# ---- joints that turn together by a shaft, a belt or gears


def coupled(a: Layout, b: Layout, pairs: Sequence[tuple[Side, Side]]) -> Iterator[Difference]:
    """Yield couplings that one file alone has, or in another ratio.

    Args:
        a: The first file.
        b: The second file.
        pairs: The wheels that both have.
    """
    if a.ties is None or b.ties is None:
        return
    for joint in JOINTS:
        own_ties = [tie for tie in a.ties if tie.joint == joint]
        other_ties = [tie for tie in b.ties if tie.joint == joint]
        own = [_shaft(tie, pairs, 0) for tie in own_ties]
        others = [_shaft(tie, pairs, 1) for tie in other_ties]
        for wheels in dict.fromkeys(tuple(shaft) for shaft in (*own, *others) if len(shaft) > 1):
            p, q = _proportion_of(own, wheels), _proportion_of(others, wheels)
            if p == q:
                continue
            joints = ", ".join(f"{name}.{joint}" for name in wheels)
            alone = f"together only by {(a if p else b).source}"
            words = f"{joints} turn {f'{p} -> {q}' if p and q else alone}"
            names = {w.name for v, w in pairs if v.name in wheels}
            marks = (*_tie_marks(other_ties, names), *_tie_marks(own_ties, {*wheels}))
            yield Difference(COUPLED, "coupling", wheels[0], p, q, words, marks)


def _shaft(tie: Tie, pairs: Sequence[tuple[Side, Side]], file: int) -> dict[str, float]:
    """Return the turns of a shaft by the wheels' names in the first file; ``file`` 0 or 1 has the shaft."""
    result = {}
    for pair in pairs:
        name = pair[file].name
        if name in tie.turns:
            result[pair[0].name] = tie.turns[name] * (_sense(*pair, tie.joint) if file else 1)
    return result


def _proportion_of(shafts: Sequence[Mapping[str, float]], wheels: tuple[str, ...]) -> str | None:
    """Return the ratios of the shaft with these wheels; None if there is none."""
    return next((_proportion(shaft) for shaft in shafts if tuple(shaft) == wheels), None)


def _sense(v: Side, w: Side, joint: str) -> int:
    """Return -1 if a spin of the second file counts in the other direction, else 1."""
    return -1 if joint == "spin" and math.cos(w.of("heading") - v.of("heading")) < 0 else 1


def _proportion(turns: Mapping[str, float]) -> str:
    """Return the ratios of turns to the first, with four digits."""
    first = next(iter(turns.values()))
    return " : ".join(f"{each / first:.4g}" for each in turns.values())


def _tie_marks(ties: Iterable[Tie], wheels: set[str]) -> Iterator[Mark]:
    return (mark for tie in ties if tie.turns.keys() & wheels for mark in tie.marks)
