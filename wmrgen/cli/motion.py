"""``wmrgen motion``: where constant wheel speeds take a robot, and the wheel commands of a list of segments.
``wmrgen icr``: the centre of rotation of a twist or of steering angles, and the steering angles of a centre."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import atan2, hypot
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wmrgen.cli import console
from wmrgen.cli.loading import derived
from wmrgen.cli.values import from_file, from_words, note_zeros, spelled
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.ports import TWIST_NAMES, Port, Role

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.functions.motion.segments import Phase

_TOLERANCE = 1e-9  # a residual or a slip [m/s] worth a note
_FAR = 1e9  # [m] a centre that counts as infinitely far
_DUST = Exact(Fraction(1, 10**40))
_POSE = ("x", "y", "theta")
_UNITS = {
    "vx": "m/s", "vy": "m/s", "omega": "rad/s", "x_rate": "m/s", "y_rate": "m/s", "theta_rate": "rad/s",
    "x": "m", "y": "m", "theta": "rad", "dt": "s",
}  # fmt: skip


def motion(
    robot: Path, values: Sequence[str] | None, time: str | None, segments: str | None, as_json: bool
) -> int:
    """Pose and path after ``time`` at the given joint speeds, or the phases of a file of segments."""
    if (time is None) == (segments is None):
        what = "there are both --time and --segments" if time else "there is neither --time nor --segments"
        raise UsageError(f"{what}. Give wheel speeds and --time, or --segments FILE.json.")
    with derived(robot, []) as derivation:
        if segments is None:
            result = _constant(derivation, [*(values or ()), f"dt={time}"])
        else:
            result = _segments(derivation, values or (), segments)
    if as_json:
        console.data(result)
    elif segments is None:
        console.values(result)
    else:
        for line in _table(result["phases"]):
            console.result(line)
    return 0


def _constant(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    """Pose at the end, then the path: a straight line, or a circle with centre, radius and period."""
    robot = derivation.robot
    ports = derivation.formula("motion").inputs
    values = from_words(spelled(words, robot, "spin", ports), ports, robot)
    note_zeros([p for p in ports if p.name.endswith((".spin", ".steer"))], [values])
    end = derivation.evaluate("motion", values)
    rates = {k: v for k, v in values.items() if k not in (*_POSE, "dt")}
    residual = float(derivation.evaluate("forward", rates)["slip"])
    if residual > _TOLERANCE:
        console.note(
            f"{robot.name}: these wheel speeds do not agree: {residual:.6g} m/s slides, least squares"
        )
    without_time = {k: v for k, v in values.items() if k != "dt"}
    circle = {k: float(v) for k, v in derivation.evaluate("circle", without_time).items()}
    result: dict[str, Any] = {k: float(end[k]) for k in _POSE}
    if circle["turns"]:
        way = "counter-clockwise" if circle["turns"] > 0 else "clockwise"
        path = "circle" if circle["radius"] > _TOLERANCE else "turning on the spot"
        result |= {"path": f"{path}, {way}", "centre": [circle["x_centre"], circle["y_centre"]]}
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
        (start_values.get("x", ZERO), start_values.get("y", ZERO), start_values.get("theta", ZERO)),
        {n: start_values.get(f"{n}.steer", ZERO) for n in turning},
    )
    for p in forbidden(phases):
        text = f"segment {p.segment}: the wheels forbid this motion, {float(p.slip):.6g} m/s slides"
        if not derivation.mobility.degenerate:
            raise UsageError(text)
        console.note(text)
    if any(p.action == "steer" and not p.dt for p in phases):
        console.note(
            f"{robot.name}: wheels without a steer_rate limit turn at once. Write limits: {{steer_rate: …}}"
        )
    return {"phases": [_phase(p) for p in phases]}


def _phase(p: Phase) -> dict[str, Any]:
    commands = _floats(
        {f"{n}.spin": v for n, v in p.spins.items()} | {f"{n}.steer": v for n, v in p.steers.items()}
    )
    pose = _floats(dict(zip(_POSE, p.pose, strict=True)))
    return {"segment": p.segment, "action": p.action, "dt": float(p.dt), "commands": commands, "pose": pose}


def _table(phases: Sequence[Mapping[str, Any]]) -> list[str]:
    """One line per phase: time, action, commands, pose at its end."""
    lines, time = [], 0.0
    for p in phases:
        commands = " ".join(f"{k}={v:.6g}" for k, v in p["commands"].items())
        pose = " ".join(f"{k}={v:.6g}" for k, v in p["pose"].items())
        lines.append(f"{time:8.3f} s  {p['action']:5} {p['dt']:.6g} s  {commands}  ->  {pose}")
        time += p["dt"]
    return lines


# ---- icr


def icr(robot: Path, values: Sequence[str] | None, as_json: bool) -> int:
    """What ``values`` name decides: vx vy omega, steering angles, or icr.x icr.y."""
    if not values:
        raise UsageError(
            "nothing is given. Give vx= vy= omega=, or steering angles <wheel>.steer=, or icr.x= icr.y=."
        )
    with derived(robot, []) as derivation:
        words = spelled(values, derivation.robot, "steer")
        names = [word.partition("=")[0].strip() for word in words]
        if any(n.startswith("icr.") for n in names):
            result = _steering(derivation, words)
        elif any(n.endswith(".steer") for n in names):
            result = _axles(derivation, words)
        else:
            result = _twist(derivation, words)
    if as_json:
        console.data(result)
    else:
        console.values({k: v for k, v in result.items() if k != "wheels"})
        for name, facts in result.get("wheels", {}).items():
            console.result(f"{name}: " + ", ".join(f"{k} {v!r}" for k, v in facts.items()))
    return 0


def _twist(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    values = from_words(words, derivation.formula("icr").inputs, derivation.robot)
    centre = _floats(derivation.evaluate("icr", values))
    twist = {k: v for k, v in values.items() if k in TWIST_NAMES}
    slip = float(derivation.evaluate("inverse", twist)["slip"])
    if slip > _TOLERANCE:
        console.note(f"{derivation.robot.name}: the wheels forbid this twist: slip = {slip:.6g} m/s")
    result = _centre(centre)
    if any(k.startswith("point.") for k in values):
        result["point_velocity"] = [centre["point.vx"], centre["point.vy"]]
        result["point_radius"] = centre["point.radius"]
    return result


def _steering(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    """Steering angles whose axles meet in the point; icr.w is 1 unless given."""
    values = dict(from_words(words, derivation.formula("steer_to").inputs, derivation.robot))
    values.setdefault("icr.w", ONE)
    x, y, w = (values.get(f"icr.{k}", ZERO) for k in "xyw")
    angles = derivation.evaluate("steer_to", values)
    turned = {k: v for k, v in values.items() if not k.startswith("icr.")}
    slip = float(derivation.evaluate("inverse", turned | {"vx": y, "vy": -x, "omega": w})["slip"])
    if slip > _TOLERANCE * max(1.0, float(abs(x)), float(abs(y)), float(abs(w))):
        console.note(
            f"{derivation.robot.name}: the axles cannot meet there, because the fixed wheels keep theirs; the "
            "angles are those of the nearest motion"
        )
    return _floats(angles)


def _axles(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    """The ICR that the axles point at, and each wheel's part in it."""
    from wmrgen.functions.motion.icr import axle_distances, check_steering

    robot = derivation.robot
    ports = [p for p in derivation.formula("axles").inputs if p.name.endswith(".steer")]
    values = from_words(words, ports)
    note_zeros(ports, [values])
    outputs = _floats(derivation.evaluate("axles", values))
    steer = {p.name.removesuffix(".steer"): float(values[p.name]) for p in ports if p.name in values}
    check = check_steering(robot, steer)
    if check.rank < 2:
        where = "anywhere on the one line of all axles"
        return {"rank": check.rank, "consistent": True, "icr": where, "mobility": check.mobility}
    result = {"rank": check.rank, "consistent": check.rank == 2, **_centre(outputs)}
    result["mobility"] = check.mobility
    if check.rank == 2:
        return result
    console.note(
        f"{robot.name}: incompatible steering: the axles do not meet in one point, so the mobility is 0 at these "
        "angles and driving slides; the ICR is the one of least sliding"
    )
    if len(check.odd) == 1:
        console.note(f"{robot.name}: all axles but that of {check.odd[0]} meet")
    result["mismatch"] = outputs["mismatch"]
    distances = {} if isinstance(result["icr"], str) else axle_distances(robot, steer, tuple(result["icr"]))
    result["wheels"] = {}
    for name in (p.name.removesuffix(".steer") for p in ports):
        present, error = steer.get(name, 0.0), outputs[f"{name}.error"]
        facts = {"steer": present, "needed": present + error, "error": error}
        result["wheels"][name] = facts | ({"distance": distances[name]} if name in distances else {})
    return result


def _centre(values: Mapping[str, float]) -> dict[str, Any]:
    """The centre as a point; where it is at infinity its direction, and that of travel, both from x of the robot."""
    x, y, w = (values[f"icr.{k}"] for k in "xyw")
    if abs(w) * _FAR > hypot(x, y):
        return {"icr": [x / w, y / w], "radius": values["radius"], "curvature": values["curvature"]}
    if hypot(x, y) <= 0:
        return {"icr": "none: standstill"}
    return {"icr": "at infinity", "direction": atan2(y, x), "travel": atan2(-x + 0.0, y), "curvature": 0.0}


def _floats(values: Mapping[str, Exact]) -> dict[str, float]:
    """The nearest doubles; what the 60 digits of pi leave over is 0."""
    return {name: float(value) if abs(value) > _DUST else 0.0 for name, value in values.items()}
