"""Robots that drive by contact points alone: nothing here comes from wmrgen.

A wheel is (x, y, heading, gamma, r, steered). Its contact moves with the body, v + omega x p, as seen on the robot: a
standard wheel spins as fast as its contact moves along its heading; a Swedish one so that what moves across its
rollers' axes is taken up by the spin. Steered wheels point along their contact's velocity. Positions come from the
exact motion of small steps in which the twist is constant.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

Wheel = tuple[float, float, float, float, float, bool]
Twist = Callable[[float], tuple[float, float, float]]


@dataclass(frozen=True)
class Layout:
    """``text``: the robot file, with nominal values; ``wheels``: name -> wheel, of true values; ``true``: these by
    parameter; ``drives``: twists by time [s]."""

    text: str
    wheels: Callable[[Mapping[str, float]], dict[str, Wheel]]
    true: dict[str, float]
    drives: tuple[Twist, ...]


def _weave(t: float) -> tuple[float, float, float]:
    """Ahead, with turns both ways that do not repeat."""
    return 0.4, 0.0, 0.7 * sin(0.31 * t) + 0.35 * sin(1.13 * t + 1)


def _bend(t: float) -> tuple[float, float, float]:
    return 0.3 + 0.1 * sin(0.7 * t), 0.0, 0.5 + 0.2 * cos(0.4 * t)


def _back(t: float) -> tuple[float, float, float]:
    return -0.3 - 0.1 * sin(0.9 * t), 0.0, -0.25 + 0.3 * sin(0.5 * t)


def _off_axle(ahead: float, twist: Twist) -> Twist:
    """The twist of a point that lies behind an axle, which does not slide along itself: vy = -ahead omega."""
    return lambda t: (twist(t)[0], -ahead * twist(t)[2], twist(t)[2])


def _across(t: float) -> tuple[float, float, float]:
    return 0.3 * sin(0.43 * t), 0.25 * cos(0.29 * t), 0.4 * sin(0.37 * t) + 0.2


def _sideways(t: float) -> tuple[float, float, float]:
    return 0.2 * cos(0.2 * t), -0.3 * sin(0.33 * t + 0.4), -0.5 * cos(0.23 * t)


AHEAD = (_weave, _bend, _back)
ANYWHERE = (_weave, _across, _sideways)


def _tunable(**nominal: float) -> str:
    return "parameters:\n" + "".join(f"  {k}: {{value: {v}, tunable: true}}\n" for k, v in nominal.items())


def _robot(name: str, parameters: str, *wheels: str) -> str:
    return f"wmrgen: 1\nname: {name}\n{parameters}wheels:\n" + "".join(f"  - {{{w}}}\n" for w in wheels)


LAYOUTS = {
    "differential": Layout(
        _robot(
            "differential",
            _tunable(r_left=0.1, r_right=0.1, half_track=0.2),
            "name: left, type: fixed, x: 0.03, y: half_track, heading: 0, r: r_left",
            "name: right, type: fixed, x: 0.03, y: -half_track, heading: pi, r: r_right",
        ),
        lambda p: {
            "left": (0.03, p["half_track"], 0, 0, p["r_left"], False),
            "right": (0.03, -p["half_track"], pi, 0, p["r_right"], False),
        },
        {"r_left": 0.1013, "r_right": 0.0994, "half_track": 0.2071},
        tuple(_off_axle(0.03, twist) for twist in AHEAD),
    ),
    "tricycle": Layout(
        _robot(
            "tricycle",
            _tunable(r=0.12, wheelbase=0.8, zero=0.0),
            "name: left, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1, actuated: [], sensed: []",
            "name: front, type: steered, x: wheelbase, y: 0.05, heading: zero, r: r",
        ),
        lambda p: {"front": (p["wheelbase"], 0.05, p["zero"], 0, p["r"], True)},
        {"r": 0.117, "wheelbase": 0.83, "zero": 0.021},
        AHEAD,
    ),
    "mecanum": Layout(
        _robot(
            "mecanum",
            _tunable(r=0.08, half_width=0.22, tilt=0.7),
            "name: fl, type: swedish, x: 0.25, y: half_width, heading: 0, gamma: -tilt, r: r",
            "name: fr, type: swedish, x: 0.25, y: -half_width, heading: 0, gamma: tilt, r: r",
            "name: bl, type: swedish, x: -0.25, y: half_width, heading: 0, gamma: tilt, r: r",
            "name: br, type: swedish, x: -0.25, y: -half_width, heading: pi, gamma: -tilt, r: r",
        ),
        lambda p: {
            "fl": (0.25, p["half_width"], 0, -p["tilt"], p["r"], False),
            "fr": (0.25, -p["half_width"], 0, p["tilt"], p["r"], False),
            "bl": (-0.25, p["half_width"], 0, p["tilt"], p["r"], False),
            "br": (-0.25, -p["half_width"], pi, -p["tilt"], p["r"], False),
        },
        {"r": 0.0781, "half_width": 0.231, "tilt": 0.74},
        ANYWHERE,
    ),
    "swerve": Layout(
        _robot(
            "swerve",
            _tunable(r_a=0.05, r_b=0.05, half=0.3, zero=0.0),
            "name: a, type: steered, x: half, y: 0.1, heading: zero, r: r_a",
            "name: b, type: steered, x: -half, y: -0.1, heading: 0, r: r_b",
        ),
        lambda p: {
            "a": (p["half"], 0.1, p["zero"], 0, p["r_a"], True),
            "b": (-p["half"], -0.1, 0, 0, p["r_b"], True),
        },
        {"r_a": 0.0511, "r_b": 0.0492, "half": 0.288, "zero": -0.03},
        ANYWHERE,
    ),
}


def contact(wheel: Wheel, twist: tuple[float, float, float], last: float = 0.0) -> tuple[float, float]:
    """Spin [rad/s] and steering angle [rad] of a wheel on a body that moves so; of both directions that a steered
    wheel may point in, the one nearer to where it pointed ``last``."""
    x, y, heading, gamma, r, steered = wheel
    vx, vy, omega = twist
    velocity = complex(vx - omega * y, vy + omega * x)
    if steered:
        turned = float(np.angle(velocity)) - heading
        half_turns = round((last - turned) / pi)
        return (-1) ** half_turns * abs(velocity) / r, turned + half_turns * pi
    # The rollers' axes stand at heading + gamma: along them nothing slides, so r spin cos(gamma) is the velocity there.
    axis = np.exp(1j * (heading + gamma))
    return float((velocity * axis.conjugate()).real) / (r * cos(gamma)), 0.0


@dataclass(frozen=True)
class Recorded:
    """Columns of a log and of its truth, by name."""

    log: dict[str, np.ndarray]
    truth: dict[str, np.ndarray]


def drive(
    layout: Layout,
    twist: Twist,
    seconds: float = 30.0,
    rate: float = 25.0,
    mount: complex = 0j,
    late: float = 0.0,
    resolution: float = 0.0,
    noise: tuple[float, float] = (0.0, 0.0),
    seed: int = 0,
) -> Recorded:
    """``mount``: the tracked point on the robot [m]; ``late``: what the truth's clock shows less [s]; ``resolution``
    of encoders [rad]; ``noise``: standard deviations of the truth's positions [m] and headings [rad]."""
    random = np.random.default_rng(seed)
    fine = 4
    steps = round(seconds * rate) * fine
    dt = 1 / (rate * fine)
    wheels = layout.wheels(layout.true)
    z, theta, poses = 0j, 0.0, [(0j, 0.0)]
    angles = {name: [0.0] for name in wheels}
    steers = {name: [contact(w, twist(0.0))[1]] for name, w in wheels.items()}
    for k in range(steps):
        now = twist((k + 0.5) * dt)
        turn = now[2] * dt
        chord = complex(now[0], now[1]) * dt * (np.sinc(turn / (2 * pi)))
        z += chord * np.exp(1j * (theta + turn / 2))
        theta += turn
        poses.append((z, theta))
        for name, w in wheels.items():
            spin, _ = contact(w, now, steers[name][-1])
            angles[name].append(angles[name][-1] + spin * dt)
            steers[name].append(contact(w, twist((k + 1) * dt), steers[name][-1])[1])
    t = np.arange(0, steps + 1, fine) * dt
    log = {"t": t}
    for name, w in wheels.items():
        column = np.array(angles[name])[::fine]
        log[f"{name}.angle"] = np.round(column / resolution) * resolution if resolution else column
        if w[5]:
            log[f"{name}.steer"] = np.array(steers[name])[::fine]
    place = np.array([p for p, _ in poses])[::fine]
    heading = np.array([h for _, h in poses])[::fine]
    place = place + np.exp(1j * heading) * mount
    place = place + noise[0] * (random.standard_normal(len(t)) + 1j * random.standard_normal(len(t)))
    heading = heading + noise[1] * random.standard_normal(len(t))
    return Recorded(log, {"t": t - late, "x": place.real, "y": place.imag, "theta": heading})


def csv(columns: Mapping[str, np.ndarray]) -> str:
    """A table as a file's text."""
    rows = np.column_stack(list(columns.values()))
    return "\n".join([",".join(columns), *(",".join(f"{v:.9g}" for v in row) for row in rows)]) + "\n"
