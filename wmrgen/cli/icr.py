"""``wmrgen icr``: the centre of rotation of a twist or of steering angles, and the steering angles of a centre."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import atan2, hypot
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wmrgen.cli import console
from wmrgen.cli.loading import derived
from wmrgen.cli.motion import clean, spelled
from wmrgen.cli.values import from_words
from wmrgen.errors import UsageError
from wmrgen.exact.number import ONE, ZERO, Exact

if TYPE_CHECKING:
    from wmrgen.robot import Derivation

_FAR = 1e9  # [m] a centre that counts as infinitely far
_TOLERANCE = 1e-9


def run(path: Path, words: Sequence[str], *, as_json: bool) -> int:
    """What the words name decides: vx vy omega, steering angles, or icr.x icr.y."""
    if not words:
        raise UsageError("give vx= vy= omega=, or steering angles <wheel>.steer=, or icr.x= icr.y=")
    with derived(path, []) as derivation:
        words = spelled(words, derivation.robot, "steer")
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


def _centre(values: Mapping[str, float]) -> dict[str, Any]:
    """The centre as a point; where it is at infinity its direction, and that of travel, both from x of the robot."""
    x, y, w = (values[f"icr.{k}"] for k in "xyw")
    if abs(w) * _FAR > hypot(x, y):
        return {"icr": [x / w, y / w], "radius": values["radius"], "curvature": values["curvature"]}
    if hypot(x, y) <= 0:
        return {"icr": "none: standstill"}
    return {"icr": "at infinity", "direction": atan2(y, x), "travel": atan2(-x + 0.0, y), "curvature": 0.0}


def _floats(values: Mapping[str, Exact]) -> dict[str, float]:
    return {k: clean(v) for k, v in values.items()}


def _twist(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    values = from_words(words, derivation.formula("icr").inputs)
    centre = _floats(derivation.evaluate("icr", values))
    twist = {k: v for k, v in values.items() if k in ("vx", "vy", "omega")}
    slip = float(derivation.evaluate("inverse", twist)["slip"])
    if slip > _TOLERANCE:
        console.note(f"{derivation.robot.name}: the wheels forbid this twist: {slip:.6g} m/s slides")
    result = _centre(centre)
    if any(k.startswith("point.") for k in values):
        result |= {
            "point_velocity": [centre["point.vx"], centre["point.vy"]],
            "point_radius": centre["point.radius"],
        }
    return result


def _steering(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    """Steering angles whose axles meet in the point; icr.w is 1 unless given."""
    values = dict(from_words(words, derivation.formula("steer_to").inputs))
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
    missing = [p.name for p in ports if p.name not in values]
    if missing:
        console.note(f"not given, taken as 0: {' '.join(missing)}")
    outputs = _floats(derivation.evaluate("axles", values))
    steer = {p.name.removesuffix(".steer"): float(values[p.name]) for p in ports if p.name in values}
    check = check_steering(robot, steer)
    if check.rank < 2:
        where = "anywhere on the one line of all axles"
        return {"rank": check.rank, "consistent": True, "icr": where, "mobility": check.mobility}
    result = {
        "rank": check.rank,
        "consistent": check.rank == 2,
        **_centre(outputs),
        "mobility": check.mobility,
    }
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
