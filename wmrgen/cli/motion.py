"""``wmrgen motion``: where constant wheel speeds take a robot, and the wheel commands of a list of segments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any

from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, Words, option, verb, words
from wmrgen.cli.loading import derived
from wmrgen.cli.values import from_file, from_words, note_zeros, rounded, with_joints
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import ZERO
from wmrgen.geometry.ports import Port, Role

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.functions.motion.segments import Phase

SLIDES = 1e-9  # m/s, rad/s or m: smaller values are rounding
_POSE = ("x", "y", "theta")
_UNITS = {
    "vx": "m/s", "vy": "m/s", "omega": "rad/s", "x_rate": "m/s", "y_rate": "m/s", "theta_rate": "rad/s",
    "x": "m", "y": "m", "theta": "rad", "dt": "s",
}  # fmt: skip


@verb("motion")
def motion(
    robot: Robot,
    values: Annotated[
        Words, words("Speeds of wheels (left=4 or left.spin=4), steering angles, start pose x y theta.")
    ] = None,
    time: Annotated[str | None, option("The duration [s].", "T")] = None,
    segments: Annotated[
        str | None,
        option(
            "A list of {vx vy omega | x_rate y_rate theta_rate | x y theta: value, dt: value}; - is stdin.",
            "FILE.json",
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen motion robots/pioneer3dx.yaml left=4 right=2 --time 2.3

    Compute where constant wheel speeds take a robot: the pose at the end, and the straight line or circle of the path.
    With --segments: the wheel commands of each segment, including the time for steering between segments.
    """
    if (time is None) == (segments is None):
        what = "there are both --time and --segments" if time else "there is neither --time nor --segments"
        raise UsageError(f"{what}. Give wheel speeds and --time, or --segments FILE.json.")
    with derived(robot, []) as derivation:
        if segments is None:
            result = _constant(derivation, [*(values or ()), f"dt={time}"])
        else:
            result = {"phases": [_phase(p) for p in planned(derivation, values or (), segments)]}
    if as_json:
        console.data(result)
    elif segments is None:
        console.values(result)
    else:
        for line in _table(result["phases"]):
            console.result(line)
    return 0


def _constant(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    """Return the pose at the end, and the path: a straight line, or a circle with centre, radius and period."""
    robot = derivation.robot
    ports = derivation.formula("motion").inputs
    values = from_words(with_joints(words, robot, "spin", ports), ports, robot)
    note_zeros([p for p in ports if p.name.endswith((".spin", ".steer"))], [values])
    end = derivation.evaluate("motion", values)
    rates = {k: v for k, v in values.items() if k not in (*_POSE, "dt")}
    residual = float(derivation.evaluate("forward", rates)["slip"])
    if residual > SLIDES:
        console.note(
            f"{robot.name}: these wheel speeds do not agree: wheels slide at {residual:.6g} m/s; the motion is the "
            "least-squares solution"
        )
    without_time = {k: v for k, v in values.items() if k != "dt"}
    circle = {k: float(v) for k, v in derivation.evaluate("circle", without_time).items()}
    result: dict[str, Any] = {k: float(end[k]) for k in _POSE}
    if circle["turns"]:
        sense = "counter-clockwise" if circle["turns"] > 0 else "clockwise"
        path = "circle" if circle["radius"] > SLIDES else "turning on the spot"
        result |= {"path": f"{path}, {sense}", "centre": [circle["x_centre"], circle["y_centre"]]}
        result |= {k: circle[k] for k in ("radius", "period", "speed", "direction")}
    elif circle["speed"] > SLIDES:
        result |= {"path": "straight line", "speed": circle["speed"], "direction": circle["direction"]}
    else:
        result |= {"path": "standstill"}
    return result


def planned(derivation: Derivation, words: Sequence[str], file: str) -> list[Phase]:
    """Return the phases of the segments of a file, and print what is remarkable about them.

    Args:
        derivation: The robot.
        words: Start pose (x y theta) and steering angles, as NAME=VALUE.
        file: The path of the file, ``-`` for standard input.

    Raises:
        UsageError: If the file has no segments, or the wheels forbid one of them.
    """
    from wmrgen.functions.motion.segments import forbidden, plan, segment

    robot = derivation.robot
    start = [Port(n, Role.STATE, _UNITS[n]) for n in _POSE]
    turning = [w.name for w in robot.wheels if w.turns]
    steers = [Port(f"{n}.steer", Role.STATE, "rad") for n in turning]
    start_values = from_words(with_joints(words, robot, "steer"), [*start, *steers])
    ports = [Port(n, Role.COMMAND, unit) for n, unit in _UNITS.items()]
    cases = from_file(file, ports)
    if not cases:
        raise UsageError(f'{file} has no segment. Write a list: [{{"vx": 0.5, "dt": 2}}, …]')
    parts = [segment(case, f"{file}, segment {k}") for k, case in enumerate(cases)]
    pose = (start_values.get("x", ZERO), start_values.get("y", ZERO), start_values.get("theta", ZERO))
    angles = {n: start_values.get(f"{n}.steer", ZERO) for n in turning}
    phases = plan(robot, parts, derivation.evaluate, pose, angles)
    for p in forbidden(phases):
        text = (
            f"segment {p.segment}: the wheels forbid this motion: they would slide at {float(p.slip):.6g} m/s"
        )
        if not derivation.mobility.degenerate:
            raise UsageError(text)
        console.note(text)
    if any(p.action == "steer" and not p.dt for p in phases):
        console.note(
            f"{robot.name}: there is no steer_rate limit, so steering takes no time. Write limits: {{steer_rate: …}}"
        )
    return phases


def _phase(p: Phase) -> dict[str, Any]:
    """Return a phase for JSON."""
    spins = {f"{name}.spin": value for name, value in p.spins.items()}
    steers = {f"{name}.steer": value for name, value in p.steers.items()}
    return {
        "segment": p.segment,
        "action": p.action,
        "dt": float(p.dt),
        "commands": rounded(spins | steers),
        "pose": rounded(dict(zip(_POSE, p.pose, strict=True))),
    }


def _table(phases: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return a line for each phase: its start, action, duration, commands, and the pose at its end."""
    lines, time = [], 0.0
    for p in phases:
        commands = " ".join(f"{k}={v:.6g}" for k, v in p["commands"].items())
        pose = " ".join(f"{k}={v:.6g}" for k, v in p["pose"].items())
        lines.append(f"{time:8.3f} s  {p['action']:5} {p['dt']:.6g} s  {commands}  ->  {pose}")
        time += p["dt"]
    return lines
