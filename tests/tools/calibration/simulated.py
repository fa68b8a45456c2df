"""Robots that drive by contact points alone: nothing here comes from wmrgen.

A contact moves with the body, v + omega x p, as seen on the robot: a standard wheel spins as fast as its contact moves
along its heading; a Swedish one so that what moves across its rollers' axes is taken up by the spin. Steered wheels
point along their contact's velocity; castors turn behind their pivots. Positions come from the exact motion of small
steps in which the twist is constant.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import pi

import numpy as np

Reals = np.ndarray
Twist = Callable[[Reals], tuple[Reals, Reals, Reals]]  # of times [s]
FINE = 4  # steps of the motion in one of the log


@dataclass(frozen=True)
class Wheel:
    """``heading``: where it rolls to at steer 0; ``gamma`` of rollers, ``behind``: how far [m] a castor's contact
    trails its pivot (x, y)."""

    x: float
    y: float
    heading: float
    r: float
    gamma: float = 0.0
    steered: bool = False
    behind: float = 0.0


@dataclass(frozen=True)
class Layout:
    """``text``: the robot file, with nominal values; ``wheels``: name -> wheel, of true values; ``true``: these by
    parameter; ``drives``: twists by time; ``axle``: x of an axle that does not slide along itself."""

    text: str
    wheels: Callable[[Mapping[str, float]], dict[str, Wheel]]
    true: dict[str, float]
    drives: tuple[Twist, ...]
    axle: float = 0.0
    together: tuple[str, ...] = ()  # parameters that no drive tells apart
    bends: float = 1.0  # how sharp its curves are: cars cannot turn as others

    @property
    def slides(self) -> bool:
        """Whether it moves sideways and turns as it likes."""
        return self.drives is ANYWHERE

    @property
    def turns(self) -> bool:
        """Whether its base turns at all."""
        return self.drives is not UNTURNED


def _weave(t: Reals) -> tuple[Reals, Reals, Reals]:
    """Ahead, with turns both ways that do not repeat."""
    return 0.4 + 0 * t, 0 * t, 0.7 * np.sin(0.31 * t) + 0.35 * np.sin(1.13 * t + 1)


def _bend(t: Reals) -> tuple[Reals, Reals, Reals]:
    return 0.3 + 0.1 * np.sin(0.7 * t), 0 * t, 0.5 + 0.2 * np.cos(0.4 * t)


def _back(t: Reals) -> tuple[Reals, Reals, Reals]:
    return -0.3 - 0.1 * np.sin(0.9 * t), 0 * t, -0.25 + 0.3 * np.sin(0.5 * t)


def off_axle(ahead: float, twist: Twist) -> Twist:
    """The twist of a point that lies behind an axle, which does not slide along itself: vy = -ahead omega."""
    return lambda t: (twist(t)[0], -ahead * twist(t)[2], twist(t)[2])


def _wider(share: float, twist: Twist) -> Twist:
    """Curves with a ``share`` of the turning."""
    return lambda t: (*twist(t)[:2], share * twist(t)[2])


def _across(t: Reals) -> tuple[Reals, Reals, Reals]:
    return 0.3 * np.sin(0.43 * t), 0.25 * np.cos(0.29 * t), 0.4 * np.sin(0.37 * t) + 0.2


def _sideways(t: Reals) -> tuple[Reals, Reals, Reals]:
    return 0.2 * np.cos(0.2 * t), -0.3 * np.sin(0.33 * t + 0.4), -0.5 * np.cos(0.23 * t)


def _turning_way(t: Reals) -> tuple[Reals, Reals, Reals]:
    """Of a base that never turns itself."""
    return 0.3 * np.cos(0.3 * t), 0.3 * np.sin(0.3 * t), 0 * t


def _winding_way(t: Reals) -> tuple[Reals, Reals, Reals]:
    way = 1.5 * np.sin(0.25 * t) - 0.4
    return 0.35 * np.cos(way), 0.35 * np.sin(way), 0 * t


AHEAD = (_weave, _bend, _back)
ANYWHERE = (_weave, _across, _sideways)
UNTURNED = (_turning_way, _winding_way)


def _tunable(**nominal: float) -> str:
    return "parameters:\n" + "".join(f"  {k}: {{value: {v}, tunable: true}}\n" for k, v in nominal.items())


def _robot(name: str, parameters: str, *wheels: str, more: str = "") -> str:
    listed = "".join(f"  - {{{w}}}\n" for w in wheels)
    return f"wmrgen: 1\nname: {name}\n{parameters}wheels:\n{listed}{more}"


def _ring(count: int, p: Mapping[str, float]) -> dict[str, Wheel]:
    """Wheels on a circle that roll along it."""
    at = [2 * pi * i / count + 0.3 for i in range(count)]
    return {
        f"w{i}": Wheel(p["reach"] * np.cos(a), p["reach"] * np.sin(a), a + pi / 2, p[f"r{i}"])
        for i, a in enumerate(at)
    }


def _ring_text(name: str, count: int) -> Layout:
    radii = {f"r{i}": 0.05 for i in range(count)}
    return Layout(
        _robot(
            name,
            _tunable(**radii, reach=0.2),
            *(
                f"name: w{i}, type: swedish, l: reach, alpha: 2*pi*{i}/{count} + 0.3, beta: pi, gamma: 0, r: r{i}"
                for i in range(count)
            ),
        ),
        lambda p: _ring(count, p),
        {**{f"r{i}": 0.05 * (1 + 0.02 * (-1) ** i + 0.007 * i) for i in range(count)}, "reach": 0.209},
        ANYWHERE,
    )


def _modules(p: Mapping[str, float]) -> dict[str, Wheel]:
    return {
        "a": Wheel(p["half"], 0.1, p["zero_a"], p["r_a"], steered=True),
        "b": Wheel(-p["half"], -0.1, p["zero_b"], p["r_b"], steered=True),
    }


LAYOUTS = {
    "differential": Layout(
        _robot(
            "differential",
            _tunable(r_left=0.1, r_right=0.1, half_track=0.2),
            "name: left, type: fixed, x: 0.03, y: half_track, heading: 0, r: r_left",
            "name: right, type: fixed, x: 0.03, y: -half_track, heading: pi, r: r_right",
        ),
        lambda p: {
            "left": Wheel(0.03, p["half_track"], 0, p["r_left"]),
            "right": Wheel(0.03, -p["half_track"], pi, p["r_right"]),
        },
        {"r_left": 0.1013, "r_right": 0.0994, "half_track": 0.2071},
        AHEAD,
        axle=0.03,
    ),
    "differential_with_castor": Layout(
        _robot(
            "differential_with_castor",
            _tunable(radius=0.033, track=0.16),
            "name: left, type: fixed, x: 0, y: track/2, heading: 0, r: radius",
            "name: right, type: fixed, x: 0, y: -track/2, heading: 0, r: radius",
            "name: tail, type: castor, x: -0.08, y: 0, heading: 0, d: -0.02, r: 0.01, sensed: []",
        ),
        lambda p: {
            "left": Wheel(0, p["track"] / 2, 0, p["radius"]),
            "right": Wheel(0, -p["track"] / 2, 0, p["radius"]),
        },
        {"radius": 0.0337, "track": 0.151},
        AHEAD,
    ),
    "uneven_differential": Layout(
        _robot(
            "uneven_differential",
            _tunable(r=0.1, y_left=0.25, y_right=0.15),
            "name: left, type: fixed, x: 0, y: y_left, heading: 0, r: r",
            "name: right, type: fixed, x: 0, y: -y_right, heading: 0, r: r",
        ),
        lambda p: {
            "left": Wheel(0, p["y_left"], 0, p["r"]),
            "right": Wheel(0, -p["y_right"], 0, p["r"]),
        },
        {"r": 0.1034, "y_left": 0.26, "y_right": 0.147},
        AHEAD,
        together=("y_left", "y_right"),
    ),
    "skid_steer": Layout(
        _robot(
            "skid_steer",
            _tunable(r=0.1, track=0.5) + "effective_track: track\n",
            *(
                f"name: {end}_{side}, type: fixed, x: {x}, y: {y}, heading: 0, r: r"
                for end, x in (("front", 0.25), ("rear", -0.25))
                for side, y in (("left", 0.2), ("right", -0.2))
            ),
        ),
        lambda p: {
            f"{end}_{side}": Wheel(0, sign * p["track"] / 2, 0, p["r"])  # what skids rolls as on a wider robot
            for end in ("front", "rear")
            for side, sign in (("left", 1), ("right", -1))
        },
        {"r": 0.1034, "track": 0.71},
        AHEAD,
    ),
    "tricycle": Layout(
        _robot(
            "tricycle",
            _tunable(r=0.12, wheelbase=0.8, zero=0.0),
            "name: left, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1, actuated: [], sensed: []",
            "name: front, type: steered, x: wheelbase, y: 0.05, heading: zero, r: r",
        ),
        lambda p: {"front": Wheel(p["wheelbase"], 0.05, p["zero"], p["r"], steered=True)},
        {"r": 0.117, "wheelbase": 0.83, "zero": 0.021},
        AHEAD,
    ),
    "car": Layout(
        _robot(
            "car",
            _tunable(r=0.1, half_track=0.3, wheelbase=0.9, zero=0.0),
            "name: rl, type: fixed, x: 0, y: half_track, heading: 0, r: r",
            "name: rr, type: fixed, x: 0, y: -half_track, heading: 0, r: r",
            "name: fl, type: steered, x: wheelbase, y: 0.3, heading: zero, r: 0.1, actuated: [steer]",
            "name: fr, type: steered, x: wheelbase, y: -0.3, heading: zero, r: 0.1, actuated: [steer]",
        ),
        lambda p: {
            "rl": Wheel(0, p["half_track"], 0, p["r"]),
            "rr": Wheel(0, -p["half_track"], 0, p["r"]),
            "fl": Wheel(p["wheelbase"], 0.3, p["zero"], 0.1, steered=True),
            "fr": Wheel(p["wheelbase"], -0.3, p["zero"], 0.1, steered=True),
        },
        {"r": 0.1021, "half_track": 0.31, "wheelbase": 0.87, "zero": -0.015},
        tuple(_wider(0.5, twist) for twist in AHEAD),
        bends=0.5,
    ),
    "bicycle": Layout(
        _robot(
            "bicycle",
            _tunable(r=0.3, wheelbase=1.0, zero=0.0),
            "name: rear, type: fixed, x: 0, y: 0, heading: 0, r: r",
            "name: front, type: steered, x: wheelbase, y: 0, heading: zero, r: 0.3, actuated: [steer]",
        ),
        lambda p: {
            "rear": Wheel(0, 0, 0, p["r"]),
            "front": Wheel(p["wheelbase"], 0, p["zero"], 0.3, steered=True),
        },
        {"r": 0.309, "wheelbase": 1.06, "zero": 0.03},
        tuple(_wider(0.4, twist) for twist in AHEAD),
        bends=0.4,
    ),
    "three_omni": _ring_text("three_omni", 3),
    "four_omni": _ring_text("four_omni", 4),
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
            "fl": Wheel(0.25, p["half_width"], 0, p["r"], -p["tilt"]),
            "fr": Wheel(0.25, -p["half_width"], 0, p["r"], p["tilt"]),
            "bl": Wheel(-0.25, p["half_width"], 0, p["r"], p["tilt"]),
            "br": Wheel(-0.25, -p["half_width"], pi, p["r"], -p["tilt"]),
        },
        {"r": 0.0781, "half_width": 0.231, "tilt": 0.74},
        ANYWHERE,
    ),
    "swerve": Layout(
        _robot(
            "swerve",
            _tunable(r_a=0.05, r_b=0.05, half=0.3, zero_a=0.0, zero_b=0.0),
            "name: a, type: steered, x: half, y: 0.1, heading: zero_a, r: r_a",
            "name: b, type: steered, x: -half, y: -0.1, heading: zero_b, r: r_b",
        ),
        _modules,
        {"r_a": 0.0511, "r_b": 0.0492, "half": 0.288, "zero_a": -0.03, "zero_b": 0.02},
        ANYWHERE,
    ),
    "synchro": Layout(
        _robot(
            "synchro",
            _tunable(r=0.1, zero=0.0),
            *(
                f"name: w{i}, type: steered, l: 0.3, alpha: 2*pi*{i}/3, heading: zero, r: r"
                for i in range(3)
            ),
            more="couplings:\n  - equal: [w0.steer, w1.steer, w2.steer]\n  - equal: [w0.spin, w1.spin, w2.spin]\n",
        ),
        lambda p: {
            f"w{i}": Wheel(
                0.3 * np.cos(2 * pi * i / 3), 0.3 * np.sin(2 * pi * i / 3), p["zero"], p["r"], steered=True
            )
            for i in range(3)
        },
        {"r": 0.1042, "zero": 0.0},
        UNTURNED,
        together=("zero",),
    ),
    "powered_castors": Layout(
        _robot(
            "powered_castors",
            _tunable(r=0.055, trail=0.04, half=0.2),
            "name: a, type: castor, x: half, y: 0.15, heading: 0, d: -trail, r: r, actuated: [spin, steer]",
            "name: b, type: castor, x: -half, y: -0.15, heading: 0, d: -trail, r: r, actuated: [spin, steer]",
        ),
        lambda p: {
            "a": Wheel(p["half"], 0.15, 0, p["r"], behind=p["trail"]),
            "b": Wheel(-p["half"], -0.15, 0, p["r"], behind=p["trail"]),
        },
        {"r": 0.0562, "trail": 0.0385, "half": 0.207},
        ANYWHERE,
    ),
}  # fmt: skip


def contact(wheel: Wheel, t: Reals, vx: Reals, vy: Reals, omega: Reals) -> tuple[Reals, Reals]:
    """Spin [rad/s] and steering angle [rad] of a wheel on a body that moves so; of both directions that a steered
    wheel may point in, the one nearer to where it pointed before."""
    velocity = (vx - omega * wheel.y) + 1j * (vy + omega * wheel.x)
    if wheel.behind:
        steer = _trailing(wheel, t, velocity, omega)
        return (velocity * np.exp(-1j * (wheel.heading + steer))).real / wheel.r, steer
    if wheel.steered:
        steer = np.unwrap(np.angle(velocity) - wheel.heading, period=pi)
        steer -= np.round(steer[0] / (2 * pi)) * 2 * pi
        return (velocity * np.exp(-1j * (wheel.heading + steer))).real / wheel.r, steer
    # The rollers' axes stand at heading + gamma: along them nothing slides, so r spin cos(gamma) is the velocity there.
    axis = np.exp(-1j * (wheel.heading + wheel.gamma))
    return (velocity * axis).real / (wheel.r * np.cos(wheel.gamma)), 0 * t


def _trailing(wheel: Wheel, t: Reals, velocity: Reals, omega: Reals) -> Reals:
    """The angle of a castor whose contact does not slide sideways: behind (omega + rate) = velocity of the pivot
    across; Heun's steps."""
    angles = np.empty_like(t)
    angle = float(np.angle(velocity[0])) - wheel.heading

    def rate(k: int, at: float) -> float:
        across = float((velocity[k] * np.exp(-1j * (wheel.heading + at))).imag)
        return across / wheel.behind - float(omega[k])

    for k in range(len(t)):
        angles[k] = angle
        if k + 1 < len(t):
            first = rate(k, angle)
            second = rate(k + 1, angle + first * (t[k + 1] - t[k]))
            angle += (first + second) / 2 * (t[k + 1] - t[k])
    return angles


@dataclass(frozen=True)
class Recorded:
    """Columns of a log and of its truth, by name."""

    log: dict[str, Reals]
    truth: dict[str, Reals]


@dataclass(frozen=True)
class Tracker:
    """How the truth is measured: ``mount``: the tracked point on the robot [m], ``turned`` by an angle [rad]; ``late``:
    what its clock shows less [s]; ``noise``: standard deviations of positions [m] and headings [rad]; a row each
    ``every`` readings of the log; ``start``: the robot's first pose in its frame."""

    mount: complex = 0j
    turned: float = 0.0
    late: float = 0.0
    noise: tuple[float, float] = (0.0, 0.0)
    every: int = 1
    start: tuple[complex, float] = (0j, 0.0)


@dataclass(frozen=True)
class Encoders:
    """``resolution`` [rad] of spins, ``steer`` [rad] of steering angles; ``slip``: standard deviation of each reading's
    step, relative to it; ``episodes``: (from, to [s], wheel, factor) in which a wheel turns so many times as far."""

    resolution: float = 0.0
    steer: float = 0.0
    slip: float = 0.0
    episodes: tuple[tuple[float, float, str, float], ...] = field(default=())


def drive(
    layout: Layout,
    twist: Twist,
    seconds: float = 30.0,
    rate: float = 25.0,
    tracker: Tracker = Tracker(),
    encoders: Encoders = Encoders(),
    seed: int = 0,
) -> Recorded:
    """A log and its truth, both from t = 0 on the log's clock."""
    random = np.random.default_rng(seed)
    fine = FINE * (5 if any(w.behind for w in layout.wheels(layout.true).values()) else 1)
    steps = round(seconds * rate) * fine
    dt = 1 / (rate * fine)
    moving = off_axle(layout.axle, twist) if layout.axle else twist
    vx, vy, omega = moving((np.arange(steps) + 0.5) * dt)
    turn = omega * dt
    theta = np.concatenate([[0.0], np.cumsum(turn)])
    chord = (vx + 1j * vy) * dt * np.sinc(turn / (2 * pi)) * np.exp(1j * (theta[:-1] + turn / 2))
    z = np.concatenate([[0j], np.cumsum(chord)])
    t = np.arange(steps + 1) * dt
    log = {"t": t[::fine]}
    for name, w in layout.wheels(layout.true).items():
        spin, steer = contact(w, t, *moving(t))
        angle = np.concatenate([[0.0], np.cumsum((spin[1:] + spin[:-1]) / 2 * dt)])[::fine]
        log[f"{name}.angle"] = _read(name, log["t"], angle, encoders, random)
        if w.steered or w.behind:
            log[f"{name}.steer"] = _rounded(steer[::fine], encoders.steer)
    rows = slice(None, None, fine * tracker.every)
    heading = tracker.start[1] + theta[rows]
    place = tracker.start[0] + np.exp(1j * tracker.start[1]) * z[rows] + np.exp(1j * heading) * tracker.mount
    count = len(heading)
    place = place + tracker.noise[0] * (random.standard_normal(count) + 1j * random.standard_normal(count))
    heading = heading + tracker.turned + tracker.noise[1] * random.standard_normal(count)
    return Recorded(log, {"t": t[rows] - tracker.late, "x": place.real, "y": place.imag, "theta": heading})


def _read(name: str, t: Reals, angle: Reals, encoders: Encoders, random: np.random.Generator) -> Reals:
    """What an encoder tells of a wheel that slips."""
    steps = np.diff(angle, prepend=0.0)
    steps = steps * (1 + encoders.slip * random.standard_normal(len(steps)))
    for start, end, wheel, factor in encoders.episodes:
        steps[(t > start) & (t <= end) & (wheel == name)] *= factor
    return _rounded(np.cumsum(steps), encoders.resolution)


def _rounded(values: Reals, resolution: float) -> Reals:
    return np.round(values / resolution) * resolution if resolution else values


def csv(columns: Mapping[str, Reals]) -> str:
    """A table as a file's text; what is nan is empty."""
    rows = np.column_stack(list(columns.values()))
    lines = (",".join("" if np.isnan(v) else f"{v:.9g}" for v in row) for row in rows)
    return "\n".join([",".join(columns), *lines]) + "\n"
