"""Measured lengths: align axles whose distance is within the tolerance.

The mobility of a robot depends on whether the axle lines of its fixed wheels coincide exactly (rank C1f): two lines
0.4 mm apart allow no turn at all. Wheels whose axles nearly coincide are therefore moved. A moved wheel keeps its
parameters, including tunable ones: constant numbers are added to its position and its heading, so that the axle lines
coincide at the nominal values. An exact layout is not changed.
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
from wmrgen.geometry.layout.records import Geometry, Near, Tolerance, Wheel, rounded_up
from wmrgen.geometry.notation import in_backticks, listed
from wmrgen.robotfile.records import Quantity

T = TypeVar("T", Poly, Exact)
Aligned = tuple[list[Wheel], list[Near]]  # the wheels that are moved, and the axles to report
PER_METRE = 1e-3  # default tolerance per robot size [m/m]: what a tape measure gives
ROUNDING = 1e-12  # relative to the robot's size, or rad: above the rounding of 40 digits and of doubles
SLACK = 1 + 1e-9  # factor, so that a distance equal to the tolerance is within it in spite of rounding
SLIP = 0.05  # relative to the robot's size, or rad: closer axles were probably meant to coincide, which is reported
_OVER = "over the robot's size"
_ONE_HEADING, _ONE_LINE, _ONE_PLACE = (
    "one heading for them",
    "positions on one line for them",
    "one position for them",
)


def tolerance_of(quantity: Quantity | None, wheels: Sequence[Wheel], scope: Scope) -> Tolerance:
    """Return the tolerance of a robot.

    Args:
        quantity: The tolerance in the robot file; None for the default of 1 mm per metre of the robot's size.
        wheels: The wheels of the robot.
        scope: The parameters of the robot file.

    Returns:
        The tolerance, with the size of the robot.

    Raises:
        RobotFileError: If the tolerance is negative.
    """
    lengths = [2 * float(w.nominal.r) for w in wheels]
    for a, b in combinations(wheels, 2):
        lengths.append(abs(a.pivot - b.pivot) + float(a.nominal.r + b.nominal.r))  # from rim to rim
    size = max(lengths, default=0.0)
    if quantity is None:
        return Tolerance(PER_METRE * size, size, False)
    length = constant("tolerance", quantity, scope)
    if length < ZERO:
        raise RobotFileError(
            f"tolerance is {quantity.text}, which is negative", quantity.mark, "It is a distance between axles.",
            "Write a length such as tolerance: 1 mm, or tolerance: 0 for an exact layout.",
        )  # fmt: skip
    return Tolerance(float(length), size, True)


def agreed(
    wheels: Sequence[Wheel], steer_group: Sequence[int], tolerance: Tolerance
) -> tuple[list[Wheel], tuple[Near, ...]]:
    """Align headings, axle lines and steering axes that agree within the tolerance.

    Args:
        wheels: The wheels of the robot.
        steer_group: For each wheel the index of the first wheel that its steering is coupled to.
        tolerance: The tolerance of the robot.

    Returns:
        The wheels, and a record for each set of axles that was aligned or is only a little too far apart.
    """
    now, near = list(wheels), list[Near]()
    fixed = [w.index for w in wheels if w.kind.fixed_axle]
    turning = [w for w in wheels if w.turns]
    steps: list[tuple[list[int], Callable[[list[Wheel], Tolerance], Aligned]]] = [(fixed, _align_headings)]
    for leader in dict.fromkeys(steer_group):
        steps.append(([w.index for w in turning if steer_group[w.index] == leader], _align_headings))
    steps.append((fixed, _align_axle_lines))
    for axis in _nearly_common_axes(turning, steer_group, tolerance):
        steps.append((axis, _align_steering_axes))
    for members, align in steps:
        moved, found = align([now[i] for i in members], tolerance)
        near += found
        for w in moved:
            now[w.index] = w
    return now, tuple(near)


def _align_headings(wheels: list[Wheel], tolerance: Tolerance) -> Aligned:
    """Turn wheels whose axles are nearly parallel to the heading of the middle one, or of the first one of two."""
    moved, found = list[Wheel](), list[Near]()
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
            steps = _steps("turned", turns, _degrees)
            found.append(Near(text, _last(group), length, length, _ONE_HEADING, steps))
    for one, other in combinations(groups, 2):
        apart = abs(_angle(one[0], other[0]))
        if apart < SLIP and one[0].kind.fixed_axle:
            angles = {w.index: _angle(wheels[0], w) for w in wheels}
            span = max(abs(_angle(a, b)) for a, b in combinations((*one, *other), 2))
            length = _joining(wheels, angles, one, other, tolerance.size) or span * tolerance.size
            size = f"{_millimetres(span * tolerance.size)} {_OVER}"
            if span > apart + ROUNDING:
                text = f"the headings of {_names((*one, *other))} are {_degrees(span)} apart, {size}"
            else:
                text = f"the heading of {_names(other)} is {_degrees(span)} from the heading of {_names(one)}, {size}"
            found.append(Near(text, _last(other), length, apart * tolerance.size, _ONE_HEADING))
    return moved, found


def _align_axle_lines(fixed: list[Wheel], tolerance: Tolerance) -> Aligned:
    """Move fixed wheels with the same heading whose axle lines nearly coincide onto one line."""
    moved, found = list[Wheel](), list[Near]()
    for parallel in _parallel(fixed, 0.0):
        e = parallel[0].nominal
        ahead = {w.index: w.nominal.x * e.ch + w.nominal.y * e.sh for w in parallel}
        places = {k: float(place) for k, place in ahead.items()}
        groups = _grouped(parallel, places, tolerance.length)
        for line in groups:
            apart = float(ahead[line[-1].index] - ahead[line[0].index])
            if apart > ROUNDING * tolerance.size:
                to = _common_line([(w, ahead[w.index]) for w in line], tolerance)
                distances = {w.name: to - ahead[w.index] for w in line}
                moved += (_moved(w, e.ch * distances[w.name], e.sh * distances[w.name]) for w in line)
                text = f"the axle lines of {_names(line)} are {_millimetres(apart)} apart"
                steps = _steps("moved", distances, _millimetres)
                found.append(Near(text, _last(line), apart, apart, _ONE_LINE, steps))
        for one, other in pairwise(groups):
            apart = float(ahead[other[0].index] - ahead[one[-1].index])
            if apart < SLIP * tolerance.size or _side_by_side(one, other):
                span = float(ahead[other[-1].index] - ahead[one[0].index])
                text = f"the axle line of {_names(other)} is {_millimetres(apart)} from the line of {_names(one)}"
                if span > apart + ROUNDING * tolerance.size:
                    text = f"the axle lines of {_names((*one, *other))} are {_millimetres(span)} apart"
                enough = _joining(parallel, places, one, other) or span
                found.append(Near(text, _last(other), enough, apart, _ONE_LINE))
    return moved, found


def _common_line(places: list[tuple[Wheel, Exact]], tolerance: Tolerance) -> Exact:
    """Return the position of a common axle line along the heading, relative to P [m].

    It is at the first wheel whose axle line depends on a tunable parameter. If there is none it is at P if all wheels
    are within the tolerance of it, else at the mean of the wheels.
    """
    tuned = [(w.index, at) for w, at in places if _tunable(w)]
    if tuned:
        return min(tuned)[1]
    if max(abs(float(at)) for _, at in places) <= tolerance.length * SLACK:
        return ZERO
    return sum((at for _, at in places), ZERO) / len(places)


def _align_steering_axes(wheels: list[Wheel], tolerance: Tolerance) -> Aligned:
    """Move wheels that steer about nearly the same axis to their mean position."""
    x = sum((w.nominal.x for w in wheels), ZERO) / len(wheels)
    y = sum((w.nominal.y for w in wheels), ZERO) / len(wheels)
    moved = [_moved(w, x - w.nominal.x, y - w.nominal.y) for w in wheels]
    steps = {w.name: abs(m.pivot - w.pivot) for w, m in zip(wheels, moved, strict=True)}
    apart = max(abs(a.pivot - b.pivot) for a, b in combinations(wheels, 2))
    text = f"the steering axes of {_names(wheels)} are {_millimetres(apart)} apart"
    return moved, [Near(text, _last(wheels), apart, apart, _ONE_PLACE, _steps("moved", steps, _millimetres))]


def _nearly_common_axes(
    turning: list[Wheel], steer_group: Sequence[int], tolerance: Tolerance
) -> Iterator[list[int]]:
    """Yield sets of wheels whose steering axes are within the tolerance of each other but do not coincide."""
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
    """Return sets of wheels whose axles are parallel within ``angle`` [rad], in the order of their headings."""
    return _grouped(wheels, {w.index: _angle(wheels[0], w) for w in wheels}, max(angle, ROUNDING))


def _grouped(wheels: list[Wheel], values: Mapping[int, float], width: float) -> list[list[Wheel]]:
    """Return the wheels sorted by ``values`` (by wheel index), in sets whose values differ by ``width`` at most."""
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
    """Return the least tolerance with which `_grouped` puts two sets of wheels into one; 0 if none does.

    It may be larger than the distance of the farthest wheels, because a set that starts earlier may take some of them.
    ``values`` are by wheel index, and ``scale`` converts their differences to metres.
    """
    together = {w.index for w in (*one, *other)}
    distances = {abs(a - b) * scale for a, b in combinations(values.values(), 2)}
    own = max(abs(values[i] - values[j]) * scale for i, j in combinations(together, 2))
    for distance in sorted(d for d in distances if d >= own):
        groups = _grouped(wheels, values, rounded_up(distance) / scale)
        for group in groups:
            if together <= {w.index for w in group}:
                return distance
    return 0.0


def _angle(a: Wheel, b: Wheel) -> float:
    """Return the angle from the heading of a to the heading of b or its opposite, in [-pi/2, pi/2] rad."""
    between = b.zero_heading / a.zero_heading
    return asin(max(-1.0, min(1.0, between.imag if between.real > 0 else -between.imag)))


def _side_by_side(one: list[Wheel], other: list[Wheel]) -> bool:
    """Return whether the wheels of one axle line are all to the left, or all to the right, of the other's wheels."""
    a = [(w.pivot / one[0].zero_heading).imag for w in one]
    b = [(w.pivot / one[0].zero_heading).imag for w in other]
    return min(a) > max(b) or min(b) > max(a)


def _tunable(w: Wheel) -> bool:
    """Return whether the axle line depends on a tunable parameter."""
    g = w.working
    return (g.x * g.ch + g.y * g.sh).constant is None


def _turned(w: Wheel, to: Wheel) -> Wheel:
    """Return the wheel turned about its pivot until its axle is parallel to the axle of ``to``."""
    a, b = w.nominal, to.nominal
    c, s = a.ch * b.ch + a.sh * b.sh, a.ch * b.sh - a.sh * b.ch
    size = (a.ch * a.ch + a.sh * a.sh) * (ONE if c.sign > 0 else -ONE)
    return _moved(w, ZERO, ZERO, c / size, s / size)


def _moved(w: Wheel, x: Exact, y: Exact, c: Exact = ONE, s: Exact = ZERO) -> Wheel:
    """Return the wheel moved by (x, y) [m] and turned by the angle with cosine c and sine s."""

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
    return in_backticks(w.name for w in sorted(wheels, key=lambda w: w.index))


def _last(wheels: Sequence[Wheel]) -> str:
    return max(wheels, key=lambda w: w.index).name


def _steps(verb: str, sizes: Mapping[str, float | Exact], shown: Callable[[float], str]) -> str:
    """Return "`left` is moved by 0.2 mm and `right` by 0.2 mm" for the wheels whose size is not 0."""
    (first, size), *rest = ((name, shown(abs(float(size)))) for name, size in sizes.items() if float(size))
    return listed([f"`{first}` is {verb} by {size}", *(f"`{name}` by {size}" for name, size in rest)])


def _millimetres(length: float) -> str:
    return f"{1000 * length:.3g} mm"


def _degrees(angle: float) -> str:
    return f"{degrees(angle):.3g} deg"
