"""Compute the joints for the motions of a wiring check, and the motions of a robot with wrong wiring."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Gen, Poly
from wmrgen.geometry.notation import listed
from wmrgen.geometry.ports import TWIST_NAMES

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation

Joints = Mapping[str, float]  # spin [rad/s] and steer [rad], by name
_SLOW = Exact(Fraction(1, 10))  # m/s and rad/s: slow enough for a first test
_SHARE = 0.2  # of the largest component of a motion: smaller components are hard to see and are not mentioned
_WORDS = (("forward", "backward"), ("to the left", "to the right"), ("turns left", "turns right"))


class Motion(NamedTuple):
    """A motion of the wiring check."""

    title: str
    twist: Mapping[str, Exact]  # components by name [m/s, rad/s]
    joints: Joints | None  # None if the wheels do not allow the motion


class Fault(NamedTuple):
    """A fault of the wiring, with its symptoms."""

    text: str
    seen: tuple[str, ...]  # how the robot moves instead, for each motion that it can do


@lru_cache(maxsize=1)  # the figure and the page of a robot have the same motions
def motions(d: Derivation) -> tuple[Motion, ...]:
    """Return three motions: forward, to the left and counter-clockwise, each at a tenth of its unit.

    Steering and castor angles are 0 at the start. A robot that cannot turn on the spot drives a curve to the left
    instead.
    """
    forward = _motion(d, "+x, forward", vx=_SLOW)
    left = _motion(d, "+y, to the left", vy=_SLOW)
    turn = _motion(d, "+ω, counter-clockwise", omega=_SLOW)
    if turn.joints is None and forward.joints:
        size = max([abs(w.pivot) for w in d.robot.wheels] + [1e-3])
        rates = (Fraction(f"{0.1 / (k * size):.1g}") for k in (2, 5, 10))
        curves = (_motion(d, "+ω, a curve to the left", vx=_SLOW, omega=Exact(rate)) for rate in rates)
        turn = next((c for c in curves if c.joints), turn)
    return forward, left, turn


def _motion(d: Derivation, title: str, **parts: Exact) -> Motion:
    twist = {name: parts.get(name, ZERO) for name in TWIST_NAMES}
    allowed = admissible(d, twist)
    if allowed["omega"] == twist["omega"] != ZERO:
        twist = allowed  # the robot turns about another point than P, so P has a sideways velocity
    joints = {name: float(value) for name, value in d.evaluate("inverse", twist).items()}
    slides = joints.pop("slip") > NEGLIGIBLE and not d.mobility.degenerate  # a degenerate robot skids
    driven = {f"{w.name}.{joint}" for w in d.robot.wheels for joint in (*w.actuated, *_rate(w.actuated))}
    own = {name: value for name, value in joints.items() if name in driven}
    moves = any(abs(value) > NEGLIGIBLE for name, value in own.items() if not name.endswith(".steer"))
    return Motion(title, twist, own if moves and not slides else None)


def admissible(d: Derivation, twist: Mapping[str, Exact]) -> dict[str, Exact]:
    """Return the nearest twist that the wheels allow."""
    values = {name: Poly.of(value) for name, value in twist.items()}

    def value(g: Gen) -> Poly | None:
        return values.get(g.name)

    return {n: p.substitute(value).constant or ZERO for n, p in zip(TWIST_NAMES, d.nearest, strict=True)}


def _rate(actuated: tuple[str, ...]) -> tuple[str, ...]:
    return ("steer_rate",) if "steer" in actuated else ()


def faults(d: Derivation, possible: Sequence[Motion]) -> list[Fault]:
    """Return how the robot moves if one wheel runs backwards or two wheels are exchanged.

    Args:
        d: the derivation.
        possible: the motions that the robot can do.

    Returns:
        The faults; [] unless two to four wheels are driven, all measured, and none of them steers or is coupled.
    """
    driven = [w for w in d.robot.wheels if w.actuated]
    if (
        any(w.turns or "spin" not in w.sensed for w in driven)
        or d.robot.couplings
        or not 2 <= len(driven) <= 4
    ):
        return []
    spins = [f"{w.name}.spin" for w in driven]
    wired: list[tuple[str, dict[str, tuple[str, int]]]] = [
        (f"`{s.removesuffix('.spin')}` runs backwards", {s: (s, -1)}) for s in spins
    ]
    wired += [
        (f"`{a.removesuffix('.spin')}` and `{b.removesuffix('.spin')}` are exchanged", {a: (b, 1), b: (a, 1)})
        for a, b in combinations(spins, 2)
    ]
    size = max(abs(w.pivot) for w in driven)
    every = [m.joints for m in possible if m.joints is not None]
    found = []
    for text, swaps in wired:
        seen = tuple(_seen(d, _swapped(joints, spins, swaps), size) for joints in every)
        found.append(Fault(text, seen))
    return found


def _swapped(joints: Joints, spins: Sequence[str], swaps: Mapping[str, tuple[str, int]]) -> Joints:
    """Return the speeds of wheels if some of them get the command of another wheel, or its negative."""
    sources = {s: swaps.get(s, (s, 1)) for s in spins}
    return {s: joints[other] * sign for s, (other, sign) in sources.items()}


def _seen(d: Derivation, joints: Joints, size: float) -> str:
    """Return the motion of these wheel speeds in words. ``size``: the distance [m] that makes yaw rates speeds."""
    exact = {name: Exact(Fraction(value).limit_denominator(10**9)) for name, value in joints.items()}
    twist = d.without_gyro.evaluate("forward", exact)
    parts = [float(twist[name]) * scale for name, scale in zip(TWIST_NAMES, (1.0, 1.0, size), strict=True)]
    largest = max(map(abs, parts))
    if largest < NEGLIGIBLE:
        return "stands still"
    words = [pair[part < 0] for pair, part in zip(_WORDS, parts, strict=True) if abs(part) > _SHARE * largest]
    moves = [word for word in words if not word.startswith("turns")]
    turns = [word for word in words if word.startswith("turns")]
    return ", ".join([*([f"moves {listed(moves)}"] if moves else []), *turns])
