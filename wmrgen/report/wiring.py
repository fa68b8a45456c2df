"""What every driven joint does for the motions of a wiring check, and what a robot does that is wired wrongly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Gen, Poly
from wmrgen.geometry.notation import listed
from wmrgen.geometry.ports import TWIST_NAMES

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation

Joints = Mapping[str, float]  # spin [rad/s] and steer [rad] by contract name
_SLOW = Exact(Fraction(1, 10))  # m/s, rad/s
_NEGLIGIBLE = 1e-9
_SHARE = 0.2  # of the largest part of a motion: what is smaller is not said
_WORDS = (("forward", "backward"), ("to the left", "to the right"), ("turns left", "turns right"))


class Motion(NamedTuple):
    """``twist``: components by contract name, in m/s and rad/s. ``joints``: None where the wheels forbid the motion."""

    title: str
    twist: Mapping[str, Exact]
    joints: Joints | None


class Fault(NamedTuple):
    """``seen``: what the robot does instead, a sentence's part for each motion that it can do."""

    text: str
    seen: tuple[str, ...]


@lru_cache(maxsize=1)  # figure and page of a robot ask for the same
def motions(d: Derivation) -> tuple[Motion, ...]:
    """Forward, to the left, counter-clockwise, each at a tenth of its unit; steering and castors at 0 before.

    A robot that drives forward and cannot turn on the spot drives a curve to the left.
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
        twist = allowed  # turning about another point than P has its sideways velocity
    joints = {name: float(value) for name, value in d.evaluate("inverse", twist).items()}
    slides = joints.pop("slip") > _NEGLIGIBLE and not d.mobility.degenerate  # a degenerate robot skids
    driven = {f"{w.name}.{joint}" for w in d.robot.wheels for joint in (*w.actuated, *_rate(w.actuated))}
    own = {name: value for name, value in joints.items() if name in driven}
    moves = any(abs(value) > _NEGLIGIBLE for name, value in own.items() if not name.endswith(".steer"))
    return Motion(title, twist, own if moves and not slides else None)


def admissible(d: Derivation, twist: Mapping[str, Exact]) -> dict[str, Exact]:
    """The twist without what the wheels forbid."""
    values = {name: Poly.of(value) for name, value in twist.items()}

    def value(g: Gen) -> Poly | None:
        return values.get(g.name)

    return {n: p.substitute(value).constant or ZERO for n, p in zip(TWIST_NAMES, d.nearest, strict=True)}


def _rate(actuated: tuple[str, ...]) -> tuple[str, ...]:
    return ("steer_rate",) if "steer" in actuated else ()


def faults(d: Derivation, possible: Sequence[Motion]) -> list[Fault]:
    """One wheel that runs backwards, two that are exchanged: what `forward` makes of the ``possible`` motions. Nothing
    where wheels turn."""
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
    return [
        Fault(text, tuple(_seen(d, _swapped(joints, spins, swaps), size) for joints in every))
        for text, swaps in wired
    ]


def _swapped(joints: Joints, spins: Sequence[str], swaps: Mapping[str, tuple[str, int]]) -> Joints:
    """The speeds of wheels of which some hear what another is told, or its opposite."""
    heard = {s: swaps.get(s, (s, 1)) for s in spins}
    return {s: joints[other] * sign for s, (other, sign) in heard.items()}


def _seen(d: Derivation, joints: Joints, size: float) -> str:
    """The motion of these wheel speeds in words."""
    exact = {name: Exact(Fraction(value).limit_denominator(10**9)) for name, value in joints.items()}
    twist = d.without_gyro.evaluate("forward", exact)
    parts = [float(twist[name]) * scale for name, scale in zip(TWIST_NAMES, (1.0, 1.0, size), strict=True)]
    largest = max(map(abs, parts))
    if largest < _NEGLIGIBLE:
        return "stands still"
    words = [pair[part < 0] for pair, part in zip(_WORDS, parts, strict=True) if abs(part) > _SHARE * largest]
    moves = [word for word in words if not word.startswith("turns")]
    turns = [word for word in words if word.startswith("turns")]
    return ", ".join([*([f"moves {listed(moves)}"] if moves else []), *turns])
