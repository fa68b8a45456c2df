"""``wmrgen motion``: where constant wheel speeds take the robot, and the wheel commands of a list of segments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wmrgen.cli import console
from wmrgen.cli.loading import derived
from wmrgen.cli.values import from_file, from_words
from wmrgen.errors import UsageError
from wmrgen.exact.number import ZERO, Exact
from wmrgen.ports import Port, Role

if TYPE_CHECKING:
    from wmrgen.functions.motion.segments import Phase
    from wmrgen.layout.records import Robot
    from wmrgen.robot import Derivation

_TOLERANCE = 1e-9  # a residual or a slip [m/s] worth a note
_DUST = Exact(Fraction(1, 10**40))
_POSE = ("x", "y", "theta")
_UNITS = {
    "vx": "m/s", "vy": "m/s", "omega": "rad/s", "x_rate": "m/s", "y_rate": "m/s", "theta_rate": "rad/s",
    "x": "m", "y": "m", "theta": "rad", "dt": "s",
}  # fmt: skip


def run(path: Path, words: Sequence[str], *, time: str | None, segments: str | None, as_json: bool) -> int:
    """Pose and path after ``time`` at the given joint speeds, or the phases of a file of segments."""
    if (time is None) == (segments is None):
        raise UsageError("give wheel speeds and --time, or --segments FILE.json")
    with derived(path, []) as derivation:
        if segments is None:
            result = _constant(derivation, [*words, f"dt={time}"])
        else:
            result = _segments(derivation, words, segments)
    if as_json:
        console.data(result)
    elif segments is None:
        console.values(result)
    else:
        for line in _table(result["phases"]):
            console.result(line)
    return 0


def spelled(words: Sequence[str], robot: Robot, joint: str, ports: Sequence[Port] = ()) -> list[str]:
    """``left=4`` is ``left.spin=4``: a bare wheel name stands for its ``joint``, or for the only one in ``ports``."""
    wheels = {w.name for w in robot.wheels}
    result = []
    for word in words:
        name, equals, value = word.partition("=")
        name = name.strip()
        own = [p.name for p in ports if p.name.startswith(f"{name}.")]
        full = own[0] if len(own) == 1 else f"{name}.{joint}"
        result.append(f"{full}={value}" if equals and name in wheels else word)
    return result


def _constant(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    """Pose at the end, then the path: a straight line, or a circle with centre, radius and period."""
    robot = derivation.robot
    ports = derivation.formula("motion").inputs
    values = from_words(spelled(words, robot, "spin", ports), ports)
    missing = [p.name for p in ports if p.name.endswith((".spin", ".steer")) and p.name not in values]
    if missing:
        console.note(f"not given, taken as 0: {' '.join(missing)}")
    end = derivation.evaluate("motion", values)
    rates = {k: v for k, v in values.items() if k not in (*_POSE, "dt")}
    residual = float(derivation.evaluate("forward", rates)["slip"])
    if residual > _TOLERANCE:
        console.note(
            f"{robot.name}: these wheel speeds do not agree: {residual:.6g} m/s slides, least squares"
        )
    circle = {
        k: float(v)
        for k, v in derivation.evaluate("circle", {k: v for k, v in values.items() if k != "dt"}).items()
    }
    result: dict[str, Any] = {k: float(end[k]) for k in _POSE}
    if circle["turns"]:
        way = "counter-clockwise" if circle["turns"] > 0 else "clockwise"
        result |= {
            "path": f"circle, {way}" if circle["radius"] > _TOLERANCE else f"turning on the spot, {way}"
        }
        result |= {"centre": [circle["x_centre"], circle["y_centre"]]}
        result |= {k: circle[k] for k in ("radius", "period", "speed", "direction")}
    elif circle["speed"] > _TOLERANCE:
        result |= {"path": "straight line", "speed": circle["speed"], "direction": circle["direction"]}
    else:
        result |= {"path": "standstill"}
    return result


def _segments(derivation: Derivation, words: Sequence[str], file: str) -> dict[str, Any]:
    """The phases of the segments, from the pose and the steering angles that the words give."""
    from wmrgen.functions.motion.segments import forbidden, plan, segment

    robot = derivation.robot
    start = [Port(n, Role.STATE, _UNITS[n]) for n in _POSE]
    turning = [w.name for w in robot.wheels if w.turns]
    steers = [Port(f"{n}.steer", Role.STATE, "rad") for n in turning]
    start_values = from_words(spelled(words, robot, "steer"), [*start, *steers])
    ports = [Port(n, Role.COMMAND, unit) for n, unit in _UNITS.items()]
    cases = from_file(file, ports)
    if not cases:
        raise UsageError(f'{file} holds no segment. Write a list: [{{"vx": 0.5, "dt": 2}}, …]')
    parts = [segment(case, f"{file}, segment {k}") for k, case in enumerate(cases)]
    phases = plan(
        robot,
        parts,
        derivation.evaluate,
        [start_values.get(n, ZERO) for n in _POSE],
        {n: start_values.get(f"{n}.steer", ZERO) for n in turning},
    )
    for p in forbidden(phases):
        text = f"segment {p.segment}: the wheels forbid this motion, {float(p.slip):.6g} m/s slides"
        if not derivation.mobility.degenerate:
            raise UsageError(text)
        console.note(text)
    if any(p.action == "steer" and not p.dt for p in phases):
        console.note(
            f"{robot.name}: wheels without a steer_rate limit turn at once; write limits: {{steer_rate: …}}"
        )
    return {"phases": [_phase(p) for p in phases]}


def _phase(p: Phase) -> dict[str, Any]:
    commands = {f"{n}.spin": clean(v) for n, v in p.spins.items()}
    commands |= {f"{n}.steer": clean(v) for n, v in p.steers.items()}
    pose = {k: clean(v) for k, v in zip(_POSE, p.pose, strict=True)}
    return {"segment": p.segment, "action": p.action, "dt": float(p.dt), "commands": commands, "pose": pose}


def clean(value: Exact) -> float:
    """The nearest double; what the 60 digits of pi leave over is 0."""
    return float(value) if abs(value) > _DUST else 0.0


def _table(phases: Sequence[Mapping[str, Any]]) -> list[str]:
    """One line per phase: time, action, commands, pose at its end."""
    lines, time = [], 0.0
    for p in phases:
        commands = " ".join(f"{k}={v:.6g}" for k, v in p["commands"].items())
        pose = " ".join(f"{k}={v:.6g}" for k, v in p["pose"].items())
        lines.append(f"{time:8.3f} s  {p['action']:5} {p['dt']:.6g} s  {commands}  ->  {pose}")
        time += p["dt"]
    return lines
