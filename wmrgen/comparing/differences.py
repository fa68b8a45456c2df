"""What two descriptions of one robot say differently, and what that does."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from wmrgen.comparing.matching import matched
from wmrgen.comparing.motion import Pairs, effects
from wmrgen.comparing.quantities import box, controlled, forward, lengths, named, parts, roles, worth
from wmrgen.comparing.record import SAME, Comparison, Difference, Effect, Layout, Side
from wmrgen.errors import Mark, UsageError
from wmrgen.importing.controllers import role
from wmrgen.importing.records import Controller
from wmrgen.lint.record import Finding, ignored
from wmrgen.wheels import WHEEL_TYPES, WheelType

PLACE, SIGN, ROLLERS, ORDER, MISSING, KIND, OFFSET = (f"WMR{n:03}" for n in range(44, 51))
CODES = {"track": "WMR040", "wheelbase": "WMR041", "radius": "WMR042", "sum": "WMR043", "ring": "WMR043"}
CODES["offset"] = OFFSET
_TITLES = {"sum": "lx + ly", "ring": "distance from the centre", "offset": "offset along the axle"}
_FITS: dict[str, Callable[[list[WheelType]], bool]] = {  # whether such a controller can drive such wheels
    "differential": lambda kinds: not any(k.rollers or k.steers for k in kinds),
    "mecanum": lambda kinds: all(k.rollers for k in kinds),
    "omni": lambda kinds: all(k.rollers or k.turns for k in kinds),
    "swerve": lambda kinds: any(k.turns for k in kinds),
}
_FITS |= dict.fromkeys(("ackermann", "bicycle", "tricycle"), _FITS["swerve"])


def compare(a: Layout, b: Layout) -> Comparison:
    """What differs from ``a``, which has wheels, to ``b``, and how a robot like ``a`` moves by commands of ``b``."""
    if a.controller:
        raise UsageError(f"{a.source} has lengths but no wheels. Give a robot file or a description, too.")
    if b.controller:
        differences, pairs, notes = _with_controller(a, b.controller)
    else:
        differences, pairs, notes = _with_layout(a, b)
    told = [d for d in differences if not any(d.code in ignored(mark) for mark in d.marks)]
    if len(told) < len(differences):
        notes.append(f"{len(differences) - len(told)} differences are to be ignored")
    moved: tuple[Effect, ...] = ()
    try:
        moved = tuple(effects(_filled(pairs)))
        if any(d.code == ORDER for d in told) and len(a.wheels) == len(b.wheels):
            numbered = [(v, w) for v, w in zip(a.wheels, b.wheels, strict=True) if parts([v])]
            said = [e.words for e in effects(_filled(numbered)) if e.words]
            notes += [f"wheels taken by number, not by name: {words}" for words in said]
    except _Unknown as why:
        notes.append(f"motion is not computed: {why}")
    return Comparison(a, b, tuple(told), moved, tuple(notes))


def findings(c: Comparison) -> list[Finding]:
    """The differences as findings, each where the second file says it; with the first, what they do together."""
    does = "; ".join(effect.words for effect in c.effects if effect.words)
    instead = f"Commanded by {c.b.title or c.b.file}, the robot {does}." if does else ""
    nowhere = Mark(c.b.file, 1, 1, "")
    return [
        Finding(d.marks[0] if d.marks else nowhere, d.words, "" if position else instead, d.code)
        for position, d in enumerate(c.differences)
    ]


def labelled(layout: Layout) -> Iterator[Finding]:
    """Wheels of a description whose names contradict their places: WMR011, as of robot files."""
    wheels = parts(layout.wheels)
    opposite = {"front": "rear", "rear": "front", "left": "right", "right": "left"}
    for w, where in zip(wheels, roles(wheels), strict=True):
        twin = any(
            v is not w and abs(v.pivot - w.pivot) < 1e-3 for v in wheels
        )  # their sides are those of a module
        for word in role(*w.names).split():
            if not twin and opposite.get(word) in where.split():
                what = f"{w.names[-1]} stands at {_shown([w.pivot])}, {where} of the middle of the wheels: not {word}"
                yield Finding(Mark(layout.file, 1, 1, ""), what, "", "WMR011")


def same(a: float, b: float, size: float = 0.0) -> bool:
    """Equal within `SAME` of the larger, or of ``size`` where that is more."""
    return abs(a - b) <= SAME * max(abs(a), abs(b), size)


# ---- a controller, which has lengths


def _with_controller(a: Layout, c: Controller) -> tuple[list[Difference], Pairs, list[str]]:
    wheels = parts(a.wheels)
    if not wheels:
        return [], [], []
    kinds = [WHEEL_TYPES[w.type] for w in wheels]
    where, along = roles(wheels), forward(wheels)
    skids = all(k.fixed_axle for k in kinds) and any("front" in word for word in where)
    if "track" not in c.lengths and "wheelbase" in c.lengths and all(k.fixed_axle for k in kinds):
        rest = {key: s for key, s in c.lengths.items() if key != "wheelbase"}
        c = replace(c, lengths={**rest, "track": c.lengths["wheelbase"]})  # as some drivers call it
    mine = lengths(wheels, where, along)
    differences, notes = [], []
    other = {key: worth(setting, c, key, not skids) for key, setting in c.lengths.items()}
    for key, setting in c.lengths.items():
        value = other[key]
        tracks = [mine[k] for k in ("front_track", "rear_track") if k in mine and key == "track"]
        if key in mine and any(same(v, value) for v in (mine[key], *tracks)):
            del other[key]
        elif key in mine:
            marks = tuple(s.mark for s in (setting, c.multipliers.get(key)) if s and s.mark)
            differences.append(_length(key, mine[key], value, marks, f" ({setting.key})"))
    for factor in c.multipliers.values():
        if skids and factor.value != 1:
            notes.append(
                f"{factor.key} {float(factor.value):g} corrects for skidding: it is no length and not counted"
            )
    pairs = list(zip(wheels, controlled(c, wheels, other), strict=True))
    if c.places:
        differences += _places(pairs, along)
    for joint in c.joints:
        if a.joints is not None and not any(own.endswith(joint.joint) for own in a.joints):
            marks = (joint.mark,) if joint.mark else ()
            differences.append(
                Difference(
                    MISSING, "joint", "", None, joint.joint, f"no joint is called {joint.joint}", marks
                )
            )
    if c.kind and not _FITS[c.kind](kinds):
        has = ", ".join(dict.fromkeys(k.noun for k in kinds))
        words = f"parameters are those of a {c.kind} drive, wheels are {has}s"
        differences.append(Difference(KIND, "kind", "", has, c.kind, words))
    order = [i for j in c.joints for i, w in enumerate(wheels) if named(w, [j.joint])]
    if c.kind == "omni" and a.ordered:
        differences += _order(wheels, order)
    return differences, pairs, notes


def _length(
    key: str, a: float, b: float, marks: tuple[Mark, ...], remark: str = "", wheel: str = ""
) -> Difference:
    base = key.rsplit("_", 1)[-1]
    title = _TITLES.get(key, key.replace("_", " "))
    looks = next(
        (f", {word}" for word, factor in (("twice that", 2), ("half of that", 0.5)) if same(b, factor * a)),
        "",
    )
    words = f"{f'{wheel}: ' if wheel else ''}{title}{remark} {a:.6g} m -> {b:.6g} m"
    words += f" ({(b - a) / abs(a):+.1%}{looks})".replace("%", " %") if a else ""
    return Difference(CODES[base], title, wheel, a, b, words, marks)


# ---- another description, which has wheels


def _with_layout(a: Layout, b: Layout) -> tuple[list[Difference], Pairs, list[str]]:
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
                notes.append(f"{words}; it leaves every motion free")
    pairs = [(v, w) for v, w in every if parts([v])]
    along = forward([v for v, _ in pairs])
    differences += [*_places(pairs, along), *_radii(every)]
    for v, w in every:
        differences += _wheel(v, w)
    if a.ordered and b.ordered and not any(alone):
        differences += _order(
            a.wheels, [a.wheels.index(v) for v, _ in sorted(every, key=lambda p: b.wheels.index(p[1]))]
        )
    return differences, pairs, notes


def _marks(*wheels: Side, keys: Iterable[str] = ()) -> tuple[Mark, ...]:
    """Where the last of the wheels says one of ``keys``, else the wheel; then the same of those before."""
    every = [w.marks.get(key) for w in reversed(wheels) for key in (*keys, "")]
    return tuple(dict.fromkeys(mark for mark in every if mark))


def _radii(pairs: Pairs) -> Iterator[Difference]:
    both = [(v, w, v.values["r"], w.values["r"]) for v, w in pairs if "r" in v.values and "r" in w.values]
    driven = [pair for pair in both if parts([pair[0]])]
    together = len({(p, q) for _, _, p, q in driven}) == 1
    for v, w, p, q in both:
        alike = together and parts([v])
        if not same(p, q) and not (alike and (v, w, p, q) != driven[0]):
            yield _length("radius", p, q, _marks(v, w, keys="r"), "", "" if alike else v.name)


def _wheel(v: Side, w: Side) -> Iterator[Difference]:
    """What differs of one wheel but its place and radius."""
    marks = _marks(v, w, keys=("heading", "beta", "gamma"))
    if v.type != w.type:
        yield Difference(KIND, "type", v.name, v.type, w.type, f"{v.name} is {v.type} -> {w.type}", marks)
    if parts([v]) and {"heading"} <= v.values.keys() & w.values.keys() and WHEEL_TYPES[v.type].directed:
        p, q = v.values["heading"], w.values["heading"]
        apart = abs(math.remainder(q - p, 2 * math.pi))
        if apart > math.pi - SAME:
            yield Difference(SIGN, "sign", v.name, p, q, f"{v.name}: its joint counts the other way", marks)
        elif apart > SAME:
            words = f"{v.name}: heading {math.degrees(p):.4g} deg -> {math.degrees(q):.4g} deg"
            yield Difference(SIGN, "heading", v.name, p, q, words, marks)
    if "gamma" in v.values and "gamma" in w.values:
        p, q = v.values["gamma"], w.values["gamma"]
        if abs(math.remainder(p - q, math.pi)) > SAME:
            other = ": they lean the other way" if abs(math.remainder(p + q, math.pi)) <= SAME else ""
            words = f"{v.name}: rollers {math.degrees(p):.4g} deg -> {math.degrees(q):.4g} deg{other}"
            yield Difference(ROLLERS, "gamma", v.name, p, q, words, marks)
    yield from _contact(v, w)


def _contact(v: Side, w: Side) -> Iterator[Difference]:
    """Where the contact lies from the pivot: of castors that nothing drives only how far."""
    arms = [cmath.rect(1, x.of("heading")) * complex(x.of("d"), x.of("offset_y")) for x in (v, w)]
    if not parts([v]):
        arms = [complex(abs(arm)) for arm in arms]
    said = all({"d", "offset_y"} & x.values.keys() for x in (v, w)) and WHEEL_TYPES[v.type].turns
    if said and abs(arms[0] - arms[1]) > SAME * max(map(abs, arms)) + 1e-6:
        words = f"{v.name}: contact from pivot {_shown(arms)}"
        yield _pointed(OFFSET, "contact", v.name, arms, words, _marks(v, w, keys=("d", "offset_y")))


def _shown(points: Sequence[complex]) -> str:
    return " -> ".join(f"({z.real:.4g}, {z.imag:.4g}) m" for z in points)


def _pointed(
    code: str, quantity: str, wheel: str, points: Sequence[complex], words: str, marks: tuple[Mark, ...]
) -> Difference:
    first, second = ((z.real, z.imag) for z in points)
    return Difference(code, quantity, wheel, first, second, words, marks)


# ---- what both have


def _places(pairs: Pairs, along: complex) -> Iterator[Difference]:
    """Track, wheelbase, the origin, and wheels that stand elsewhere than these make them."""
    if not pairs:
        return
    a, b = (
        [along.conjugate() * complex(w.of("x"), w.of("y")) for w in side] for side in zip(*pairs, strict=True)
    )
    where = roles([v for v, _ in pairs])
    (middle, size), (other, _) = box(a), box(b)
    extent = abs(size)
    permuted = [min(range(len(a)), key=lambda i: abs(a[i] - q)) for q in b]
    if (
        sorted(permuted) == list(range(len(a)))
        and permuted != list(range(len(a)))
        and all(same(abs(a[i] - q), 0, extent) for i, q in zip(permuted, b, strict=True))
    ):
        for (v, w), i in zip(pairs, permuted, strict=True):
            if pairs[i][0] is not v:
                words = f"{v.name} stands where {pairs[i][0].name} is"
                yield Difference(
                    PLACE, "place", v.name, v.name, pairs[i][0].name, words, _marks(v, w, keys="xy")
                )
        return
    moved = [replace(w, type=v.type, values={**v.values, **w.values}) for v, w in pairs]
    mine, its = (lengths(wheels, where, along) for wheels in ([v for v, _ in pairs], moved))
    changed = {key: its[key] / mine[key] for key in mine.keys() & its.keys() if mine[key]}
    for key in ("ring",) if "ring" in changed else ("track", "wheelbase", "front_track", "rear_track"):
        stated = "track" in changed and key.endswith("_track") and same(changed.get(key, 1), changed["track"])
        if key in changed and not stated and not same(mine[key], its[key]):
            yield _length(key, mine[key], its[key], _marks(*pairs[0], keys=("y", "x", "l")))
    for (v, w), p, q, word in zip(pairs, a, b, where, strict=True):
        ahead = changed.get("ring", changed.get("wheelbase", 1.0))
        aside = changed.get("ring", changed.get(f"{word.split(' ')[0]}_track", changed.get("track", 1.0)))
        off = p - middle
        if abs(q - other - complex(off.real * ahead, off.imag * aside)) > SAME * extent:
            points = (v.pivot, complex(w.of("x"), w.of("y")))
            marks = _marks(v, w, keys=("x", "y", "l", "alpha"))
            yield _pointed(PLACE, "place", v.name, points, f"{v.name}: place {_shown(points)}", marks)
    if abs(other - middle) > SAME * extent:
        points = (along * middle, along * other)
        words = f"origin: the middle of the wheels lies at {_shown(points)}"
        yield _pointed(PLACE, "origin", "", points, words, _marks(*pairs[0], keys=("x", "y", "l")))


def _order(wheels: Sequence[Side], order: Sequence[int]) -> Iterator[Difference]:
    """``order``: the indices of the first file's wheels, as the second one has them."""
    if order and list(order) != sorted(order):
        first, second = (" ".join(wheels[i].name for i in indices) for indices in (sorted(order), order))
        yield Difference(ORDER, "order", "", first, second, f"order of wheels: {first} -> {second}")


class _Unknown(Exception):
    """What kinematics need and neither file says."""


def _filled(pairs: Pairs) -> Pairs:
    """Pairs that move the robot, what one file does not say taken from the other; a radius that neither says is 1."""
    result = []
    for v, w in pairs:
        mine = replace(v, values={"r": 1.0, **w.values, **v.values})
        its = replace(w, values={"r": 1.0, **v.values, **w.values})
        for side in (mine, its):
            kind = WHEEL_TYPES[side.type]
            if kind.rollers and "gamma" not in side.values:
                raise _Unknown(f"no file says how the rollers of {v.name} stand")
            if kind.swivels and not side.of("d"):
                raise _Unknown(f"no file says how far {v.name} trails")
        result.append((mine, its))
    if not result:
        raise _Unknown("no wheel is known to be driven")
    return result
