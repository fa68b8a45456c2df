"""Trajectories of segments (Siegwart figures 3.15, 3.16): wheel commands per segment, with waits for steering.

A segment is a constant twist for a time. Steered wheels must be at its angles before it begins. The robot waits while
they turn, for the time that the slowest wheel needs at its limit of ``steer_rate``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

from wmrgen.errors import UsageError
from wmrgen.functions.registry import Reason, underivable
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import TWIST_NAMES

Values = Mapping[str, Exact]
Triple = tuple[Exact, Exact, Exact]  # a twist or a pose
Call = Callable[[str, Values], Values]  # function name and inputs to outputs
FORBIDDEN = Exact(Fraction(1, 10**9))  # [m/s] faster sliding is more than rounding error
STILL = Exact(Fraction(1, 10**12))  # [rad] a smaller change of an angle is rounding error

RATES = ("x_rate", "y_rate", "theta_rate")
POSE = ("x", "y", "theta")
KINDS = {"twist": TWIST_NAMES, "world": RATES, "displacement": POSE}


class Segment(NamedTuple):
    """A constant motion for a time."""

    # twist (vx vy omega, robot frame), world (x_rate y_rate theta_rate) or displacement (x y theta in
    # the robot frame at its start)
    kind: str
    values: Triple  # in this order, SI units
    dt: Exact  # s


class Phase(NamedTuple):
    """A time of constant commands."""

    segment: int  # counts from 0
    action: str  # steer (the robot stands) or drive
    dt: Exact
    spins: Mapping[str, Exact]  # rad/s, by wheel name
    steers: Mapping[str, Exact]  # steering angle at the end [rad], by wheel name
    twist: Triple  # robot frame
    pose: Triple  # (x, y, theta) at the end
    slip: Exact = ZERO  # m/s, as `inverse` returns it


def segment(values: Values, place: str) -> Segment:
    """Return a segment from its named values: one of the three kinds, and dt. Raise UsageError for other values."""
    names = {n for n in values if n != "dt"}
    kinds = [k for k, own in KINDS.items() if names and names.issubset(own)]
    if len(kinds) != 1:
        ways = "; ".join(" ".join(own) for own in KINDS.values())
        raise UsageError(f"{place}: give dt and values of one kind: {ways}")
    dt = values.get("dt", ZERO)
    if dt <= 0:
        raise UsageError(f"{place}: dt must be above 0")
    a, b, c = (values.get(n, ZERO) for n in KINDS[kinds[0]])
    if kinds[0] == "world" and c and (a or b):
        raise UsageError(
            f"{place}: a constant velocity in the world needs changing wheel speeds while the robot turns; "
            "give vx vy omega (an arc), or translate and turn one after the other"
        )
    return Segment(kinds[0], (a, b, c), dt)


def plan(robot: Robot, segments: Sequence[Segment], call: Call, start: Triple, steers: Values) -> list[Phase]:
    """Return the phases of the segments.

    A degenerate robot slides where it must: see ``slip``.

    Args:
        robot: The robot.
        segments: The motions, one after the other.
        call: Evaluates a function of the robot: its name and inputs to its outputs.
        start: The pose x, y, theta at the start.
        steers: Present steering angles [rad] by wheel name, 0 if not given.

    Raises:
        NotDerivableError: For driven castors, whose commands change during a segment.
        UsageError: For a steering angle that a limit of steer_rate makes unreachable.
    """
    for w in robot.wheels:
        if w.kind.swivels and w.actuated:
            why = f"the commands of its castor {w.name} change during a constant twist"
            raise underivable(robot, "segments", why, Reason.CASTOR)
    phases: list[Phase] = []
    pose = start
    now = {w.name: steers.get(w.name, ZERO) for w in robot.wheels if w.turns}
    for k, part in enumerate(segments):
        twist = _twist(part, pose, call)
        present = {f"{name}.steer": angle for name, angle in now.items()}
        joints = call("inverse", dict(zip(TWIST_NAMES, twist, strict=True)) | present)
        target = {w.name: joints[f"{w.name}.steer"] for w in robot.wheels if w.kind.steers}
        if any(abs(angle - now[name]) > STILL for name, angle in target.items()):
            phases.append(_wait(robot, k, now, target, pose))
        now |= target
        pose = _moved(pose, twist, part.dt, call)
        spins = {w.name: joints[f"{w.name}.spin"] for w in robot.wheels if "spin" in w.actuated}
        phases.append(Phase(k, "drive", part.dt, spins, target, twist, pose, joints["slip"]))
    return phases


def forbidden(phases: Sequence[Phase]) -> list[Phase]:
    """Return the phases in which wheels slide."""
    return [p for p in phases if p.slip > FORBIDDEN]


def _twist(part: Segment, pose: Triple, call: Call) -> Triple:
    """Return the constant twist of a segment in the robot frame."""
    a, b, c = part.values
    if part.kind == "displacement":
        twist = call("reach", {"x": a, "y": b, "theta": c, "dt": part.dt})
        return twist["vx"], twist["vy"], twist["omega"]
    if part.kind == "world":  # in the robot frame: rotated by -theta
        x, y, _ = _moved((ZERO, ZERO, -pose[2]), (a, b, ZERO), Exact(1), call)
        return x, y, c
    return a, b, c


def _moved(pose: Triple, twist: Triple, dt: Exact, call: Call) -> Triple:
    """Return the pose after a constant twist."""
    values = dict(zip((*POSE, *TWIST_NAMES), (*pose, *twist), strict=True))
    end = call("odometry", values | {"dt": dt})
    return end["x"], end["y"], end["theta"]


def _wait(robot: Robot, k: int, now: Values, target: Values, pose: Triple) -> Phase:
    """Return the phase of steering before a segment. Without a limit it takes no time."""
    swings = {name: angle - now[name] for name, angle in target.items()}
    dt = max(_time(robot, robot.wheel(name), swing) for name, swing in swings.items())
    spins = {
        w.name: _rolling_spin(w, swings.get(w.name, ZERO), dt) for w in robot.wheels if "spin" in w.actuated
    }
    return Phase(k, "steer", dt, spins, target, (ZERO, ZERO, ZERO), pose)


def _time(robot: Robot, w: Wheel, swing: Exact) -> Exact:
    """Return the time [s] that a wheel needs to turn by ``swing`` [rad]."""
    limit = robot.limit(w, "steer_rate")
    if limit is None or not swing:
        return ZERO
    rate = limit.high if swing > 0 else limit.low
    if rate * swing <= 0:
        raise UsageError(
            f"{w.name} cannot turn by {float(swing):.6g} rad: its steer_rate limit forbids that direction"
        )
    return swing / rate


def _rolling_spin(w: Wheel, swing: Exact, dt: Exact) -> Exact:
    """Return the spin of a wheel beside its steering axis while it turns and the robot stands.

    r spin = -o steer_rate.
    """
    if not w.nominal.steer_arm or not dt:
        return ZERO
    return -(w.nominal.steer_arm * swing) / (w.nominal.r * dt)
