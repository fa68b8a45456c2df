"""Measured lengths: axles that miss one another by no more than the tolerance are taken for one.

What fixed wheels allow hangs on whether their axle lines coincide (rank C1f): two that lie 0.4 mm apart forbid every
turn. A wheel that is moved keeps its parameters, tunable ones too: numbers are added to its place and its heading is
turned by a number, so that the lines coincide at the nominal values. A layout that is exact stays as it is written.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from math import asin, atan2, degrees, pi, remainder
from typing import TypeVar

from wmrgen.errors import RobotFileError
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.expressions import Scope
from wmrgen.geometry.layout.joints import constant
from wmrgen.geometry.layout.records import Geometry, Wheel
from wmrgen.geometry.layout.tolerance import Near, Tolerance, rounded_up
from wmrgen.geometry.notation import in_code, listed
from wmrgen.robotfile.records import Quantity

T = TypeVar("T", Poly, Exact)
Agreed = tuple[list[Wheel], list[Near]]  # the wheels that are moved, and what is to be told
PER_METRE = 1e-3  # of the robot's size, where the file names no tolerance
ROUNDING = 1e-12  # of the robot's size, or rad: no distance, but what 40 digits leave
SLACK = 1 + 1e-9  # a distance equal to the tolerance is within it, however doubles were rounded
SLIP = 0.05  # of the robot's size, or rad: nearer axles were likely meant to be one
_OVER = "over the robot's size"
_ONE_HEADING, _ONE_LINE, _ONE_PLACE = "one heading for them", "their places on one line", "one place for them"


def tolerance_of(quantity: Quantity | None, wheels: Sequence[Wheel], scope: Scope) -> Tolerance:
    """The tolerance that a file names, else 1 mm per metre of the robot's size. RobotFileError where it is negative."""
    rims = [2 * float(w.nominal.r) for w in wheels]
    places = [(w.pivot, w.nominal.r) for w in wheels]
    rims += [abs(p - q) + float(r + s) for (p, r), (q, s) in combinations(places, 2)]
    size = max(rims, default=0.0)
    if quantity is None:
        return Tolerance(PER_METRE * size, size, False)
    length = constant("tolerance", quantity, scope)
    if length < ZERO:
        raise RobotFileError(
            f"tolerance is {quantity.text}, which is negative", quantity.mark, "It is a distance of axles.",
            "Write a length such as tolerance: 1 mm, or tolerance: 0 for a layout that is exact.",
        )  # fmt: skip
    return Tolerance(float(length), size, True)


def agreed(
    wheels: Sequence[Wheel], steer_group: Sequence[int], tolerance: Tolerance
) -> tuple[list[Wheel], tuple[Near, ...]]:
    """The wheels, with one heading, axle line or steering axis where theirs agree within the tolerance; and what nearly
    agrees, within it and above."""
    now, near = list(wheels), list[Near]()
    fixed = [w.index for w in wheels if w.kind.fixed_axle]
    turning = [w for w in wheels if w.turns]
    coupled = [[w.index for w in turning if steer_group[w.index] == k] for k in dict.fromkeys(steer_group)]
    steps: list[tuple[list[int], Callable[[list[Wheel], Tolerance], Agreed]]] = [
        *((members, _headings) for members in (fixed, *coupled)),
        (fixed, _lines),
        *((axis, _axis) for axis in _axes(turning, steer_group, tolerance)),
    ]
    for members, agreeing in steps:
        moved, told = agreeing([now[i] for i in members], tolerance)
        near += told
        for w in moved:
            now[w.index] = w
    return now, tuple(near)


def _headings(wheels: list[Wheel], tolerance: Tolerance) -> Agreed:
    """Wheels whose axles are nearly parallel take the heading of the middle one; of two, that of the first."""
    moved, told = list[Wheel](), list[Near]()
    groups = _parallel(wheels, tolerance.angle)
    for group in groups:
        middle = min(group[(len(group) - 1) // 2], group[len(group) // 2], key=lambda w: w.index)
        turns = {w.name: -_angle(middle, w) for w in group}
        apart = max(turns.values()) - min(turns.values())
        if apart > ROUNDING:
            moved += (_turned(w, middle) for w in group if w is not middle)
            length = apart * tolerance.size
            text = (
                f"the headings of {_names(group)} are {_degrees(apart)} apart, {_millimetres(length)} {_OVER}"
            )
            told.append(
                Near(text, _last(group), length, length, _ONE_HEADING, _steps("turned", turns, _degrees))
            )
    for one, other in combinations(groups, 2):
        apart = abs(_angle(one[0], other[0]))
        if apart < SLIP and one[0].kind.fixed_axle:
            angles = {w.index: _angle(wheels[0], w) for w in wheels}
            span = max(abs(_angle(a, b)) for a, b in combinations((*one, *other), 2))
            length = _joining(wheels, angles, one, other, tolerance.size) or span * tolerance.size
            off = f"{_degrees(span)} off that of {_names(one)}, {_millimetres(span * tolerance.size)} {_OVER}"
            text = f"the heading of {_names(other)} is {off}"
            if span > apart + ROUNDING:
                off = f"{_degrees(span)} apart, {_millimetres(span * tolerance.size)} {_OVER}"
                text = f"the headings of {_names((*one, *other))} are {off}"
            told.append(Near(text, _last(other), length, apart * tolerance.size, _ONE_HEADING))
    return moved, told


def _lines(fixed: list[Wheel], tolerance: Tolerance) -> Agreed:
    """Fixed wheels of one heading whose axle lines nearly coincide take one."""
    moved, told = list[Wheel](), list[Near]()
    for parallel in _parallel(fixed, 0.0):
        e = parallel[0].nominal
        ahead = {w.index: w.nominal.x * e.ch + w.nominal.y * e.sh for w in parallel}
        places = {k: float(place) for k, place in ahead.items()}
        groups = _grouped(parallel, places, tolerance.length)
        for line in groups:
            apart = float(ahead[line[-1].index] - ahead[line[0].index])
            if apart > ROUNDING * tolerance.size:
                to = _line([(w, ahead[w.index]) for w in line], tolerance)
                steps = {w.name: to - ahead[w.index] for w in line}
                moved += (_moved(w, e.ch * steps[w.name], e.sh * steps[w.name]) for w in line)
                text = f"the axle lines of {_names(line)} are {_millimetres(apart)} apart"
                told.append(
                    Near(text, _last(line), apart, apart, _ONE_LINE, _steps("moved", steps, _millimetres))
                )
        for one, other in pairwise(groups):
            apart = float(ahead[other[0].index] - ahead[one[-1].index])
            if apart < SLIP * tolerance.size or _side_by_side(one, other):
                span = float(ahead[other[-1].index] - ahead[one[0].index])
                text = f"the axle line of {_names(other)} is {_millimetres(apart)} from that of {_names(one)}"
                if span > apart + ROUNDING * tolerance.size:
                    text = f"the axle lines of {_names((*one, *other))} are {_millimetres(span)} apart"
                enough = _joining(parallel, places, one, other) or span
                told.append(Near(text, _last(other), enough, apart, _ONE_LINE))
    return moved, told


def _line(places: list[tuple[Wheel, Exact]], tolerance: Tolerance) -> Exact:
    """How far ahead of P the axle line of several wheels is, from how far those of each are: where the first wheel is
    that a tunable parameter moves; else at P, if all are there; else in the middle."""
    tuned = [(w.index, at) for w, at in places if _tunable(w)]
    if tuned:
        return min(tuned)[1]
    if max(abs(float(at)) for _, at in places) <= tolerance.length * SLACK:
        return ZERO
    return sum((at for _, at in places), ZERO) / len(places)


def _axis(wheels: list[Wheel], tolerance: Tolerance) -> Agreed:
    """Wheels that steer about nearly one axis take the one in the middle."""
    x, y = (sum((getattr(w.nominal, k) for w in wheels), ZERO) / len(wheels) for k in "xy")
    moved = [_moved(w, x - w.nominal.x, y - w.nominal.y) for w in wheels]
    steps = {w.name: abs(m.pivot - w.pivot) for w, m in zip(wheels, moved, strict=True)}
    apart = max(abs(a.pivot - b.pivot) for a, b in combinations(wheels, 2))
    text = f"the steering axes of {_names(wheels)} are {_millimetres(apart)} apart"
    return moved, [Near(text, _last(wheels), apart, apart, _ONE_PLACE, _steps("moved", steps, _millimetres))]


def _axes(turning: list[Wheel], steer_group: Sequence[int], tolerance: Tolerance) -> Iterator[list[int]]:
    """Sets of wheels that steer, or turn together, about one axis but for the tolerance."""
    rest = turning
    while rest:
        first, *others = rest
        twins = [
            w for w in others
            if abs(w.pivot - first.pivot) <= tolerance.length * SLACK
            and ((w.kind.steers and first.kind.steers) or steer_group[w.index] == steer_group[first.index])
        ]  # fmt: skip
        rest = [w for w in others if w not in twins]
        if any(abs(w.pivot - first.pivot) > ROUNDING * tolerance.size for w in twins):
            yield [w.index for w in (first, *twins)]


def _parallel(wheels: list[Wheel], angle: float) -> list[list[Wheel]]:
    """Wheels in sets whose axles are parallel but for ``angle`` [rad], in the order of their headings."""
    return _grouped(wheels, {w.index: _angle(wheels[0], w) for w in wheels}, max(angle, ROUNDING))


def _grouped(wheels: list[Wheel], values: Mapping[int, float], width: float) -> list[list[Wheel]]:
    """The wheels in the order of values by index, in sets within which they differ by ``width`` at most."""
    groups: list[list[Wheel]] = []
    for w in sorted(wheels, key=lambda w: values[w.index]):
        if groups and values[w.index] - values[groups[-1][0].index] <= width * SLACK:
            groups[-1].append(w)
        else:
            groups.append([w])
    return groups


def _joining(
    wheels: list[Wheel], values: Mapping[int, float], one: list[Wheel], other: list[Wheel], scale: float = 1.0
) -> float:
    """The least distance of values, times ``scale``, that as a width of `_grouped` puts two sets into one. It is not
    always that of their own ends: a set that begins earlier may take some of them. 0 where none does."""
    together = {w.index for w in (*one, *other)}
    distances = {abs(a - b) * scale for a, b in combinations(values.values(), 2)}
    own = max(abs(values[i] - values[j]) * scale for i, j in combinations(together, 2))
    for distance in sorted(d for d in distances if d >= own):
        groups = _grouped(wheels, values, rounded_up(distance) / scale)
        if any(together <= {w.index for w in group} for group in groups):
            return distance
    return 0.0


def _angle(a: Wheel, b: Wheel) -> float:
    """From the heading of a to that of b, or to the opposite one: from -pi/2 to pi/2 [rad]."""
    between = b.zero_heading / a.zero_heading
    return asin(max(-1.0, min(1.0, between.imag if between.real > 0 else -between.imag)))


def _side_by_side(one: list[Wheel], other: list[Wheel]) -> bool:
    """The wheels of one axle line stand all to the left of the other's, or all to the right."""
    a, b = ([(w.pivot / one[0].zero_heading).imag for w in line] for line in (one, other))
    return min(a) > max(b) or min(b) > max(a)


def _tunable(w: Wheel) -> bool:
    """A tunable parameter moves its axle line."""
    g = w.working
    return (g.x * g.ch + g.y * g.sh).constant is None


def _turned(w: Wheel, to: Wheel) -> Wheel:
    """The wheel turned in its place until its axle is parallel to that of ``to``."""
    a, b = w.nominal, to.nominal
    c, s = a.ch * b.ch + a.sh * b.sh, a.ch * b.sh - a.sh * b.ch
    size = (a.ch * a.ch + a.sh * a.sh) * (ONE if c.sign > 0 else -ONE)
    return _moved(w, ZERO, ZERO, c / size, s / size)


def _moved(w: Wheel, x: Exact, y: Exact, c: Exact = ONE, s: Exact = ZERO) -> Wheel:
    """The wheel moved by (x, y) [m] and turned by the angle of cosine c and sine s."""

    def view(g: Geometry[T]) -> Geometry[T]:
        return replace(g, x=g.x + x, y=g.y + y, ch=g.ch * c - g.sh * s, sh=g.sh * c + g.ch * s)

    nominal = view(w.nominal)
    p, heading = complex(float(nominal.x), float(nominal.y)), w.heading + atan2(float(s), float(c))
    alpha = atan2(p.imag, p.real)
    return replace(
        w, symbolic=view(w.symbolic), working=view(w.working), nominal=nominal, l=abs(p), alpha=alpha,
        heading=heading, beta=remainder(heading + pi / 2 - alpha, 2 * pi),
    )  # fmt: skip


def _names(wheels: Sequence[Wheel]) -> str:
    return in_code(w.name for w in sorted(wheels, key=lambda w: w.index))


def _last(wheels: Sequence[Wheel]) -> str:
    return max(wheels, key=lambda w: w.index).name


def _steps(verb: str, sizes: Mapping[str, float | Exact], shown: Callable[[float], str]) -> str:
    """left is moved by 0.2 mm and right by 0.2 mm: what is done to the wheels, but to those that stay."""
    (first, size), *rest = ((name, shown(abs(float(size)))) for name, size in sizes.items() if float(size))
    return listed([f"`{first}` is {verb} by {size}", *(f"`{name}` by {size}" for name, size in rest)])


def _millimetres(length: float) -> str:
    return f"{1000 * length:.3g} mm"


def _degrees(angle: float) -> str:
    return f"{degrees(angle):.3g} deg"
