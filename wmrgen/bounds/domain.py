"""The inputs that a proof is about: the limits of the robot file, and stated ranges where it has none.

Defaults: vy as vx; steering angles two turns about zero; spins and steering rates what `inverse` commands within the
limits of the twist; a pose 100 m and two turns around the origin, headings of trailers alike, steps of at most 0.1 s;
speeds of virtual wheels as vx; tunable parameters 10 % around their nominal value. The limits of vx and omega have
none: without them there is nothing to prove. A rate that nothing commands needs a limit, too.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from wmrgen.exact.number import Exact
from wmrgen.ir.nodes import Function, Port, Role
from wmrgen.ir.rounding import to_float64
from wmrgen.layout.records import Robot

TURNS = 12.5663707  # two turns [rad]
_POSE = {"x": (-100.0, 100.0), "y": (-100.0, 100.0), "theta": (-TURNS, TURNS), "dt": (0.0, 0.1)}
_JOINTS = ("spin", "steer", "steer_rate")
_EXAMPLES = {"vx": "1.0", "omega": "2.0", "spin": "20.0", "steer_rate": "2.0", "steer": "60 deg"}
_SPREAD = 0.1  # of a tunable parameter about its nominal value
_SPAN = 0.01  # of one that is nominally zero [m, rad]

Range = tuple[float, float]


@dataclass(slots=True)
class Domain:
    """``declared``: declared limits by input name. ``commanded``: what `inverse` gives, by output name."""

    robot: Robot
    declared: dict[str, Range]
    commanded: dict[str, Range] = field(default_factory=dict)

    def missing(self) -> tuple[str, ...]:
        """Limits without which nothing can be proved."""
        return tuple(name for name in ("vx", "omega") if name not in self.declared)

    def of(self, function: Function) -> tuple[dict[str, Range], list[str]]:
        """Range of every input, and the names of those that have none."""
        ranges: dict[str, Range] = {}
        unknown = []
        for port in function.inputs:
            interval = self._range(port)
            if interval is None:
                unknown.append(port.name)
            else:
                ranges[port.name] = interval
        return ranges, unknown

    def assumed(self, function: Function) -> dict[str, Range]:
        """Ranges of inputs that the robot file does not limit."""
        return {name: r for name, r in self.of(function)[0].items() if name not in self.declared}

    def _range(self, port: Port) -> Range | None:
        name = port.name
        if name in self.declared:
            return self.declared[name]
        if port.role is Role.GEOMETRY and port.default is not None:
            value = to_float64(port.default)
            spread = abs(value) * _SPREAD or _SPAN
            return inside(value - spread, value + spread)
        if name == "vy":
            return self.declared.get("vx")
        if name in _POSE:
            return inside(*_POSE[name])
        _, _, joint = name.rpartition(".")
        limit = self.robot.limits.get(joint) if joint in _JOINTS else None
        if limit is not None:  # of a virtual wheel, which has none of its own
            self.declared[name] = _floats(limit.low, limit.high)
            return self.declared[name]
        if joint in ("steer", "theta"):
            return inside(-TURNS, TURNS)
        return self.declared.get("vx") if joint == "speed" else self.commanded.get(name)


def domain(robot: Robot) -> Domain:
    """The declared limits, those of a wheel before those of the robot."""
    declared = {name: _floats(i.low, i.high) for name, i in robot.limits.items() if name not in _JOINTS}
    for wheel in robot.wheels:
        for joint in _JOINTS:
            limit = robot.limit(wheel, joint)
            if limit is not None:
                declared[f"{wheel.name}.{joint}"] = _floats(limit.low, limit.high)
    return Domain(robot, declared)


def wanted(missing: tuple[str, ...]) -> str:
    """What to write in the robot file: limits of the robot, those of wheels by the name of their joint."""
    names = dict.fromkeys(name.rpartition(".")[2] for name in missing)
    examples = [f"{name}: {_EXAMPLES.get(name, '1.0')}" for name in names]
    return f"limits: {{{', '.join(examples)}}}"


def _floats(low: Exact, high: Exact) -> Range:
    return inside(to_float64(low), to_float64(high))


def inside(low: float, high: float) -> Range:
    """The floats (float32) of an interval: its ends moved inward."""
    a, b = np.float32(low), np.float32(high)
    a = np.nextafter(a, np.float32(np.inf)) if float(a) < low else a
    b = np.nextafter(b, np.float32(-np.inf)) if float(b) > high else b
    return (float(a), float(b)) if a <= b else (low, high)
