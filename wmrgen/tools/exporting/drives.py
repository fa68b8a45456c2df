"""The kind of drive of a robot in other software, and its terms there.

Other software has a formula with few terms for each drive. A robot has a drive only if that formula gives the wheel
speeds of its own inverse kinematics. Castors and balls without a motor are ignored.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import asin, atan2, cos, degrees, pi, sin, tan
from typing import TypeVar

from wmrgen.errors import NotDerivableError
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.layout.skid import driven
from wmrgen.robotfile.text import quoted
from wmrgen.tools.controllers.mecanum import CORNERS
from wmrgen.tools.exporting.bodies import joint_of

TOLERANCE = 1e-6  # of the largest of what must be equal
SIDES = ("right", "left")
KINDS = {  # fixed wheels, steered wheels, whether these drive
    (1, 1, False): "bicycle", (2, 1, False): "tricycle", (2, 2, False): "ackermann",
    (1, 1, True): "front-wheel", (2, 1, True): "front-wheel",
}  # fmt: skip
Term = float | tuple[str, ...] | NotDerivableError


@dataclass(frozen=True, slots=True)
class Drive:
    """A drive with the terms of its formula."""

    kind: str
    wheels: tuple[Wheel, ...]  # in the order of the formula
    terms: Mapping[str, Term]  # a size [m, rad], joints, or the reason why there is none
    backward: frozenset[str] = frozenset()  # wheels that roll the robot backward at a positive rate
    notes: tuple[str, ...] = ()  # on the limits of the formula

    def named(self, names: Mapping[str, str], more: Mapping[str, Term]) -> dict[str, float | tuple[str, ...]]:
        """Return name in other software -> value of its term; names without a term are left out.

        Args:
            names: Name in other software -> term.
            more: Terms in addition to those of the drive.

        Raises:
            NotDerivableError: A term has no value, with the reason.
        """
        values, terms = {}, {**more, **self.terms}
        for name, key in names.items():
            term = terms.get(key)
            if isinstance(term, NotDerivableError):
                raise term
            if term is not None:
                values[name] = term
        return values


@contextmanager
def refusing(what: str, instead: str = "") -> Iterator[None]:
    """Raise NotDerivableError in these words, with the reason that the inner one has, and what to do instead."""
    try:
        yield
    except NotDerivableError as error:
        raise NotDerivableError(f"{what}: {error.what}.", instead=instead) from None


Record = TypeVar("Record")


def drive_with(robot: Robot, record_of: Callable[[str], Record | None]) -> tuple[Drive, Record]:
    """Return the drive of a robot and the record that other software has for its kind.

    Kinds are differential, mecanum, omni, swerve, and those of `KINDS`.

    Raises:
        NotDerivableError: The robot is none of these, or there is no record, with the reason.
    """
    drive = _drive_of(driven(robot))
    record = record_of(drive.kind)
    if record is None:
        raise NotDerivableError(f"there is none for {drive.kind} drives")
    return drive, record


def _drive_of(robot: Robot) -> Drive:
    wheels = [w for w in robot.wheels if w.has_spin and (w.actuated or not w.kind.swivels)]
    if not any(w.actuated for w in wheels):
        raise NotDerivableError("no motor drives it")
    _none([w for w in wheels if w.kind.swivels], "is a powered castor")
    for joint in ("spin", "steer"):
        for group in robot.together(joint, [w for w in wheels if joint in w.kind.joints]):
            _none(group[1:], f"has its {joint} coupled to that of {quoted(group[0].name)}")
    for joint in ("spin", "steer"):
        reverses = [w for w in wheels if joint in w.actuated and w.joint_name(joint).reversed]
        _none(reverses, f"has a {joint} joint that turns the other way, and controllers reverse none")
    rolling = [w for w in wheels if w.kind.rolls_across]
    steered = [w for w in wheels if w.turns]
    fixed = [w for w in wheels if not w.turns and not w.kind.rolls_across]
    _none([w for w in steered if "steer" not in w.actuated], "is not steered by a motor")
    if rolling:
        _none([*fixed, *steered], "cannot move across its rolling direction, while others can")
        _none([w for w in rolling if not w.actuated], "is not driven")
        slants = any(abs(float(w.nominal.sg)) > TOLERANCE for w in rolling)
        return _mecanum(rolling) if slants else _ring(rolling)
    if not steered:
        return _sides(fixed)
    return _car(robot, fixed, steered) if fixed else _swerve(steered)


def limits_of(robot: Robot) -> dict[str, Term]:
    """Return the terms of the limits of the twist: ``vx.high``, ``vx_rate.low``, and in reverse ``vx_rate.-high``."""
    named = {f"{n}.{end}": getattr(v, end) for n, v in robot.limits.items() for end in ("low", "high")}
    named |= {f"{n}.-{end}": -getattr(v, end) for n, v in robot.limits.items() for end in ("low", "high")}
    return {name: float(value) for name, value in named.items()}


def _none(wheels: Sequence[Wheel], what: str) -> None:
    """Raise NotDerivableError about the first of these wheels, if there is one."""
    if wheels:
        raise NotDerivableError(f"{quoted(wheels[0].name)} {what}")


def _same(values: Iterable[float], scale: float = 0.0) -> bool:
    ends = [f(values := list(values)) for f in (min, max)]
    return ends[1] - ends[0] <= TOLERANCE * max(scale, *map(abs, ends))


def _common(values: Sequence[float], what: str) -> Term:
    """Return the value of equal numbers; an error if they differ."""
    shown = ", ".join(f"{v:.6g}" for v in values)
    return values[0] if _same(values) else NotDerivableError(f"{what} differ: {shown}")


def _x(w: Wheel) -> float:
    return float(w.nominal.x)


def _y(w: Wheel) -> float:
    return float(w.nominal.y)


def _r(w: Wheel) -> float:
    return float(w.nominal.r)


def _spins(wheels: Iterable[Wheel]) -> tuple[str, ...]:
    return tuple(joint_of(w, "spin") for w in wheels)


def _backward(wheels: Sequence[Wheel]) -> frozenset[str]:
    """Return the wheels that roll against x at a positive rate; raise an error for one that does not roll along x."""
    _none([w for w in wheels if abs(float(w.nominal.sh)) > TOLERANCE], "does not roll along x")
    return frozenset(w.name for w in wheels if w.nominal.ch.sign < 0)


def _radius(wheels: Sequence[Wheel], backward: frozenset[str]) -> Term:
    """Return the one radius of a formula that has no sign for each wheel."""
    if backward:
        return NotDerivableError(
            f"{quoted(min(backward))} rolls backward at a positive rate, for which the formula has no sign. Reverse "
            "its joint: heading 0, and the motor inverted"
        )
    return _common([_r(w) for w in wheels], "the radii")


def _half_track(wheels: Sequence[Wheel]) -> float:
    """Return the distance of P from wheels on both sides of it [m]."""
    values = [abs(_y(w)) for w in wheels]
    if not _same(values) or not values[0]:
        shown = ", ".join(f"{_y(w):.6g}" for w in wheels)
        raise NotDerivableError(f"its wheels are not at equal distances beside P: y = {shown}")
    return values[0]


def _of_axle(x: float) -> tuple[str, ...]:
    """Return a note for a drive whose formula is for the middle of its axle, not for P."""
    if abs(x) < TOLERANCE:
        return ()
    return (f"Twist and odometry are those of the middle of the axle, {x:.6g} m ahead of P.",)


def _sides(wheels: Sequence[Wheel]) -> Drive:
    """Return a differential drive: a wheel rolls at (vx - y omega)/r. Several on a side are skid steer."""
    driven = [w for w in wheels if w.actuated]
    left, right = ([w for w in driven if sign * _y(w) > 0] for sign in (1, -1))
    if not left or len(left) != len(right):
        raise NotDerivableError(f"it drives {len(left)} wheels on the left and {len(right)} on the right")
    half, backward = _half_track(driven), _backward(driven)
    shares = {}
    for side, members in (("left", left), ("right", right)):
        signed = [_r(w) * (-1 if w.name in backward else 1) / _r(left[0]) for w in members]
        share = _common(signed, f"radii, or ways to turn, of the {side} wheels")
        if share != 1:  # what is not said is 1
            shares[f"{side}_share"] = share
    skids = not _same(map(_x, wheels), half)
    terms: dict[str, Term] = {"left": _spins(left), "right": _spins(right), "separation": 2 * half}
    terms |= {"left_radius": _r(left[0]), "radius": _radius(driven, backward), **shares}
    slide = ("In curves its wheels slide sideways: measure a multiplier of wheel_separation.",)
    return Drive("differential", (*left, *right), terms, backward, slide if skids else _of_axle(_x(left[0])))


def _mecanum(wheels: Sequence[Wheel]) -> Drive:
    """Return a mecanum drive: a wheel rolls at (vx + t vy + (t x - y) omega)/r with t = tan(gamma) = -1 or 1."""
    middle = [sum(map(of, wheels)) / len(wheels) for of in (_x, _y)]
    at = {(_x(w) > middle[0], _y(w) > middle[1]): w for w in wheels}
    if len(wheels) != 4 or len(at) != 4:
        raise NotDerivableError("a mecanum drive has four wheels, one in each corner")
    corners = [at[front, left] for front in (True, False) for left in (True, False)]
    for w, (corner, t) in zip(corners, CORNERS.items(), strict=True):
        wrong = [w] if abs(float(w.nominal.sg) - t * float(w.nominal.cg)) > TOLERANCE else []
        what = f"has gamma = {degrees(w.gamma):.6g} deg at the ground, where the formula has {45 * t} deg"
        _none(wrong, f"{what} for the {corner.replace('_', ' ')} wheel")
    fl, fr, rl, rr = corners
    sums = [(_x(fl) + _y(fl) - _x(rr) - _y(rr)) / 2, (_x(fr) - _y(fr) - _x(rl) + _y(rl)) / 2]
    ahead, aside = (_x(fl) + _y(fl) + _x(rr) + _y(rr)) / 2, (_x(fr) - _y(fr) + _x(rl) - _y(rl)) / 2
    backward = _backward(corners)
    off = abs(ahead) + abs(aside) > TOLERANCE * sums[0]
    terms: dict[str, Term] = {corner: _spins([w]) for corner, w in zip(CORNERS, corners, strict=True)}
    total, base = _common(sums, "half wheelbase plus half track of the diagonals"), _x(fl) - _x(rl)
    terms |= {
        "radius": _radius(corners, backward),
        "sum": total,
        "offset_x": -(ahead + aside) / 2, "offset_y": -(ahead - aside) / 2, "offset_theta": 0.0,
        "wheelbase": NotDerivableError("the middle of its wheels is not P") if off else base,
        "track": 2 * total - base if isinstance(total, float) else total,
    }  # fmt: skip
    return Drive("mecanum", tuple(corners), terms, backward)


def _ring(wheels: Sequence[Wheel]) -> Drive:
    """Return an omni drive: the wheel at the angle a rolls at (sin(a) vx - cos(a) vy - R omega)/r, equally spaced."""
    headings = [atan2(float(w.nominal.sh), float(w.nominal.ch)) for w in wheels]
    distances = [_y(w) * cos(h) - _x(w) * sin(h) for w, h in zip(wheels, headings, strict=True)]
    angles = [(h + pi / 2 + TOLERANCE) % (2 * pi) - TOLERANCE for h in headings]
    order = sorted(range(len(wheels)), key=lambda k: angles[k])
    first: Term = angles[order[0]]
    if len(wheels) < 3 or not _same([angles[k] - i * 2 * pi / len(wheels) for i, k in enumerate(order)], 1.0):
        shown = ", ".join(f"{degrees(angles[k]):.6g}" for k in order)
        first = NotDerivableError(
            f"the formula has three wheels or more, equally spaced about P, not {shown} deg"
        )
    distance = _common(distances, "distances of the wheels from P, positive where they turn it clockwise,")
    if isinstance(distance, float) and distance <= 0:
        distance = NotDerivableError(
            "its wheels turn it counter-clockwise at positive rates, the formula's clockwise. Reverse their "
            "joints: headings by pi, and the motors inverted"
        )
    terms: dict[str, Term] = {"ring": _spins(wheels[k] for k in order), "offset": first}
    terms |= {"distance": distance, "radius": _common([_r(w) for w in wheels], "the radii")}
    return Drive("omni", tuple(wheels[k] for k in order), terms)


def _swerve(wheels: Sequence[Wheel]) -> Drive:
    _none([w for w in wheels if "spin" not in w.actuated], "is not driven")
    _none([w for w in wheels if w.nominal.o], "is beside its steering axis (offset_y), which no formula has")
    if len(wheels) < 2:
        raise NotDerivableError("a swerve drive has two steered wheels or more")
    return Drive("swerve", tuple(wheels), {})


def _car(robot: Robot, fixed: Sequence[Wheel], steered: Sequence[Wheel]) -> Drive:
    """Return a car: the wheel on the x axis steers by atan(wheelbase omega / vx), two wheels about the same ICR."""
    axle, front = ([float(w.nominal.x) for w in group] for group in (fixed, steered))
    base = front[0] - axle[0]
    if not _same(axle, abs(base)) or not _same(front, abs(base)) or base <= 0:
        raise NotDerivableError("it has not one fixed axle, with one steered axle ahead of it")
    driven = [w for w in (*fixed, *steered) if "spin" in w.actuated]
    kind = KINDS.get((len(fixed), len(steered), driven == [*steered]))
    if kind is None or driven not in ([*fixed], [*steered]):
        raise NotDerivableError(
            f"no formula has its {len(fixed)} fixed, {len(steered)} steered, {len(driven)} driven wheels"
        )
    _none([w for w in driven if w.nominal.o], "is beside its steering axis (offset_y), which no formula has")
    tracks = []
    for group in (fixed, steered):
        if len(group) == 1:
            _none([w for w in group if abs(_y(w)) > TOLERANCE * base], "is not on the x axis")
        tracks.append(2 * _half_track(group) if len(group) > 1 else 0.0)
    limits = [v for w in steered if (v := robot.limit(w, "steer"))]
    joints = {  # the right one first
        "traction": _spins(sorted(driven, key=_y)),
        "steering": tuple(joint_of(w, "steer") for w in sorted(steered, key=_y)),
    }
    sides = {f"{side}_{n}": names[k : k + 1] for n, names in joints.items() for k, side in enumerate(SIDES)}
    terms: dict[str, Term] = {
        **joints, **sides,
        "wheelbase": base, "traction_track": tracks[0], "steering_track": tracks[1],
        "radius": _radius(driven, _backward([*fixed, *steered]) & {w.name for w in driven}),
    }  # fmt: skip
    if len(limits) == len(steered):
        low, high = max(float(v.low) for v in limits), min(float(v.high) for v in limits)
        terms |= {"steer.low": low, "steer.high": high}
        if 0 < (inner := min(-low, high)) < pi / 2:  # Gazebo turns at wheelbase / sin(this) or more
            terms["least_turn"] = asin(min(1.0, base / (base / tan(inner) + tracks[1] / 2)))
    return Drive(kind, tuple(driven), terms, notes=_of_axle(axle[0]))
