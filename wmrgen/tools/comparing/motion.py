"""The motion of a robot that is driven by commands from another description of it.

The second description turns a twist into joint rates and angles. With these, the twist of the first robot is the least
squares solution of its rolling and sliding rows (those of `wmrgen.geometry.constraints`, in doubles).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wmrgen.tools.comparing.quantities import forward
from wmrgen.tools.comparing.record import SAME, Effect, Side, Tie

Array = NDArray[np.float64]
Pairs = Sequence[tuple[Side, Side]]  # wheels of the first robot, each as the second file has it
_SEEN = 5e-4  # share of a motion: a smaller change is not reported


@dataclass(frozen=True, slots=True)
class Command:
    """Joint angle [rad] and rates [rad/s] of a wheel."""

    steer: float
    steer_rate: float
    spin: float


def _along(w: Side, direction: complex) -> Array:
    """Return the row of the pivot's velocity along a direction, to be multiplied by a twist."""
    return np.array([direction.real, direction.imag, (w.pivot.conjugate() * direction).imag])


def _rows(w: Side, steer: float) -> tuple[Array, Array]:
    """Return the rolling and the sliding row at a joint angle [rad], to be multiplied by a twist."""
    e = cmath.rect(1, w.of("heading") + steer)
    rolling = _along(w, e * cmath.rect(1, w.of("gamma"))) - [0, 0, w.of("offset_y")]
    return rolling, _along(w, 1j * e) + np.array([0, 0, w.of("d")])


def command_of(w: Side, twist: Array) -> Command:
    """Return the command of a wheel for a twist (vx, vy, omega), with at most a quarter turn; a castor has angle 0."""
    kind = w.kind
    steer = rate = 0.0
    if kind.steers:
        velocity = complex(*twist[:2]) + 1j * twist[2] * w.pivot
        if abs(velocity) > 1e-9 * math.hypot(*twist[:2], abs(twist[2] * w.pivot)):
            steer = math.remainder(cmath.phase(velocity) - w.of("heading"), math.pi)
    rolling, sliding = _rows(w, steer)
    if kind.swivels:
        rate = -float(sliding @ twist) / w.of("d")
    rim = float(rolling @ twist) - w.of("offset_y") * rate
    return Command(steer, rate, rim / (w.values["r"] * math.cos(w.of("gamma"))))


def _together(commands: Sequence[Command], wheels: Sequence[Side], ties: Sequence[Tie]) -> Sequence[Command]:
    """Return the commands, those of coupled joints by the joint that has the motor."""
    result, names = list(commands), [w.name for w in wheels]
    for tie in ties:
        members = [(names.index(name), turns) for name, turns in tie.turns.items() if name in names]
        for i, turns in members[1:]:
            first, own = members[0]
            lead = result[first]
            if tie.joint == "spin":
                result[i] = replace(result[i], spin=lead.spin * turns / own)
            else:
                k = turns / own
                result[i] = replace(result[i], steer=lead.steer * k, steer_rate=lead.steer_rate * k)
    return result


def _response(wheels: Sequence[Side], commands: Sequence[Command]) -> Array:
    """Return the least squares twist over all rows whose rates are known, then the residual of each row [m/s].

    In a car the steering angles decide, because its wheels cannot follow speeds that contradict them.
    """
    rows, rates, weights = [], [], []
    firm = 1e4 if _is_car(wheels) else 1.0
    for w, c in zip(wheels, commands, strict=True):
        kind = w.kind
        rolling, sliding = _rows(w, c.steer)
        if w.actuated is None or "spin" in w.actuated:
            rows.append(rolling)
            weights.append(1.0)
            rates.append(w.values["r"] * math.cos(w.of("gamma")) * c.spin + w.of("offset_y") * c.steer_rate)
        if kind.sliding_row:
            rows.append(sliding)
            weights.append(firm)
            rates.append(-w.of("d") * c.steer_rate if kind.swivels else 0.0)
    h, z, weight = np.array(rows), np.array(rates), np.array(weights)
    twist, *_ = np.linalg.lstsq(h * weight[:, None], z * weight, rcond=1e-12)
    return np.concatenate([twist, h @ twist - z])


def _is_car(wheels: Sequence[Side]) -> bool:
    kinds = [w.kind for w in wheels]
    return any(k.fixed_axle for k in kinds) and any(k.steers for k in kinds)


def ahead_of_origin(wheels: Sequence[Side]) -> float:
    """Return the distance of the fixed axle ahead of P along the direction of driving [m]; 0 without one."""
    along = forward(wheels).conjugate()
    fixed = [(along * w.pivot).real for w in wheels if w.kind.fixed_axle]
    return math.fsum(fixed) / len(fixed) if fixed else 0.0


def _asked(motion: str, wheels: Sequence[Side]) -> Array:
    """Return the twist of unit speed, for the fixed axle if a robot has one."""
    along = forward(wheels)
    if motion != "turn":
        direction = along * (1 if motion == "straight" else 1j)
        return np.array([direction.real, direction.imag, 0.0])
    aside = -1j * along * ahead_of_origin(wheels)  # of P, while the axle does not move sideways
    return np.array([aside.real, aside.imag, 1.0])


def effects(pairs: Pairs, own_ties: Sequence[Tie] = (), other_ties: Sequence[Tie] = ()) -> Iterator[Effect]:
    """Yield the changes of each motion that the robot can do.

    Args:
        pairs: Wheels of the robot, each as the second file has it.
        own_ties: The couplings of the robot.
        other_ties: The couplings of the second file.
    """
    own, others = [a for a, _ in pairs], [b for _, b in pairs]

    def commands(twist: Array) -> Sequence[Command]:
        return _together([command_of(w, twist) for w in others], others, other_ties)

    yield from effects_of(own, own_ties, commands, others)


def effects_of(
    own: Sequence[Side],
    ties: Sequence[Tie],
    commands: Callable[[Array], Sequence[Command]],
    others: Sequence[Side],
) -> Iterator[Effect]:
    """Yield the changes of each motion that the robot can do.

    Args:
        own: The wheels of the robot.
        ties: Its couplings.
        commands: Twist of P -> commands of the wheels in their order.
        others: The wheels as the source of the commands has them, which decide where its fixed axle is.
    """
    size = max(abs(w.pivot - v.pivot) for w in own for v in own) or 1.0

    def needed(twist: Array) -> Sequence[Command]:
        return _together([command_of(w, twist) for w in own], own, ties)

    for motion in ("straight", "strafe", "turn"):
        nominal = _driven(own, ties, needed, _twists(motion, own, own, size))
        actual = _driven(own, ties, commands, _twists(motion, own, others, size))
        effect = _effect(motion, nominal, actual, forward(own), size / 2)
        if effect:
            yield effect


def _twists(
    motion: str, own: Sequence[Side], others: Sequence[Side], size: float
) -> list[tuple[Array, float]]:
    """Return the twists of a motion with their weights: for the turn of a car, two gentle curves per curvature."""
    asked = _asked(motion, others)
    if motion != "turn" or not _is_car(own):
        return [(asked, 1.0)]
    # So small a curvature that the angles of the wheels are in proportion to it.
    ahead, bend = _asked("straight", others), 1e-4 / size
    return [(ahead + bend * asked, 0.5 / bend), (ahead - bend * asked, -0.5 / bend)]


def _driven(
    own: Sequence[Side],
    ties: Sequence[Tie],
    commands: Callable[[Array], Sequence[Command]],
    twists: Sequence[tuple[Array, float]],
) -> Array:
    """Return the weighted response of a robot to the commands for some twists."""
    responses = [weight * _response(own, _together(commands(twist), own, ties)) for twist, weight in twists]
    return np.asarray(sum(responses))


def _effect(motion: str, nominal: Array, actual: Array, forward: complex, arm: float) -> Effect | None:
    """Return the change of a motion by the other's commands; None if the robot cannot do the motion itself."""

    def parts(twist: Array) -> dict[str, float]:
        along = forward.conjugate() * complex(*twist[:2])
        return {"straight": along.real, "strafe": along.imag, "turn": float(twist[2]) * arm}

    was, now = parts(nominal), parts(actual)
    if was[motion] < {"straight": 0.5, "strafe": 0.99, "turn": 1e-3 * arm}[motion]:
        return None
    ratio = now[motion] / was[motion]
    others = {m: (now[m] - was[m] * ratio) / abs(was[motion]) for m in now if m != motion}
    slip = float(np.linalg.norm(actual[3:]) - np.linalg.norm(nominal[3:]) * abs(ratio)) / abs(was[motion])
    return Effect(motion, ratio, ", ".join(_words(motion, ratio, others, slip)))


_SAY = {  # the wrong way, not at all, more, less
    "straight": ("drives backwards", "does not drive straight", "drives {} too fast", "drives {} too slow"),
    "strafe": ("strafes the wrong way", "does not strafe", "strafes {} too fast", "strafes {} too slow"),
    "turn": ("turns the wrong way", "does not turn", "yaw rate {} high", "yaw rate {} low"),
}  # fmt: skip
_BESIDE = {"straight": "drives ahead or back", "strafe": "drifts sideways", "turn": "turns"}
_WHILE = {"straight": "driving straight", "strafe": "strafing", "turn": "turning"}


def _words(motion: str, ratio: float, others: Mapping[str, float], slip: float) -> Iterator[str]:
    wrong, none, more, less = _SAY[motion]
    if abs(ratio) < _SEEN:
        yield none
    elif ratio < 0:
        yield wrong
    if abs(ratio) >= _SEEN and abs(abs(ratio) - 1) >= _SEEN:
        yield (more if abs(ratio) > 1 else less).format(f"{abs(abs(ratio) - 1):.1%}".replace("%", " %"))
    for other, share in others.items():
        if abs(share) >= SAME:
            yield f"{_BESIDE[other]} while {_WHILE[motion]}"
    if slip >= 5 * SAME:
        yield f"wheels work against each other, by {slip:.1%}".replace("%", " %")
