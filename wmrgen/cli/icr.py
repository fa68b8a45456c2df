"""``wmrgen icr``: the centre of rotation of a twist or of steering angles, and the steering angles of a centre."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import atan2, hypot
from typing import TYPE_CHECKING, Annotated, Any

from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, Words, verb, words
from wmrgen.cli.loading import derived
from wmrgen.cli.motion import SLIDES
from wmrgen.cli.values import from_words, note_zeros, rounded, with_joints
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import ONE, ZERO
from wmrgen.geometry.ports import TWIST_NAMES

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.geometry.exact.number import Exact
    from wmrgen.geometry.layout.records import Robot as Loaded

_STANDSTILL, _AT_INFINITY = "none: standstill", "at infinity"  # in place of the coordinates of a centre
_UNITS = {
    "icr": "m",
    "radius": "m",
    "curvature": "1/m",
    "direction": "rad",
    "travel": "rad",
    "point_velocity": "m/s",
    "point_radius": "m",
    "steer": "rad",
    "needed": "rad",
    "error": "rad",
    "distance": "m",
    "mismatch": "rad",
}
_FAR = 1e9  # m: a centre farther away is called infinitely far


@verb("icr")
def icr(
    robot: Robot,
    values: Annotated[
        Words, words("vx vy omega (and a point: point.x point.y), or <wheel>.steer, or icr.x icr.y.")
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen icr robots/ackermann_car.yaml front_left.steer=0.3 front_right.steer=0.25

    Find the centre of rotation (ICR) of a twist. Or find the point where the axles meet at given steering angles, and
    the wheels whose axles miss it. Or find the steering angles that turn the robot about icr.x, icr.y.
    """
    if not values:
        raise UsageError(
            "nothing is given. Give vx= vy= omega=, or steering angles <wheel>.steer=, or icr.x= icr.y=."
        )
    with derived(robot, []) as derivation:
        words = with_joints(values, derivation.robot, "steer")
        names = [word.partition("=")[0].strip() for word in words]
        _refuse_mixture(names)
        if any(n.startswith("icr.") for n in names):
            result = _steering(derivation, words)
        elif any(n.endswith(".steer") for n in names):
            result = _axles(derivation, words)
        else:
            result = _twist(derivation, words)
    if as_json:
        console.data(result)
    else:
        wheels = result.pop("wheels", {})
        console.result(_sentence(result))
        console.values(
            result, {name: _unit(name) for name, value in result.items() if not isinstance(value, str)}
        )
        for name, facts in wheels.items():
            console.result(f"{name}: " + ", ".join(f"{k} {v!r} {_unit(k)}" for k, v in facts.items()))
    return 0


def _refuse_mixture(names: Sequence[str]) -> None:
    """Raise UsageError if there are inputs of two kinds, or speeds of wheels."""
    kinds = {
        "a twist": [n for n in names if n in TWIST_NAMES],
        "steering angles": [n for n in names if n.endswith(".steer")],
        "a centre": [n for n in names if n.startswith("icr.")],
    }
    given = [kind for kind, inputs in kinds.items() if inputs]
    if len(given) > 1:
        raise UsageError(f"the inputs are {' and '.join(given)}. Give one of them.")
    if any(n.endswith(".spin") for n in names):
        raise UsageError("wheel speeds are no input of icr. `wmrgen motion` takes them.")


def _sentence(result: Mapping[str, Any]) -> str:
    """Return what the robot does at this centre of rotation, or with these steering angles, in one sentence."""
    centre = result.get("icr")
    if result.get("rank") == 1:
        return "All axles are on one line, so the robot can turn about any point of this line."
    if centre is None:
        return (
            "These steering angles turn the robot about the given centre, or as nearly as its wheels allow."
        )
    if centre == _STANDSTILL:
        return "The robot stands still, so it turns about no point."
    if centre == _AT_INFINITY:
        return f"The robot does not turn: every point of it moves in the direction {result['travel']:.6g} rad from x."
    point = f"({centre[0]:.6g}, {centre[1]:.6g}) m"
    if result.get("consistent") is False:
        return f"The axles do not meet in one point. The wheels slide least if the robot turns about {point}."
    return f"The robot turns about the point {point} of its frame."


def _unit(name: str) -> str:
    """Return the unit of a result, or of a fact about a wheel; "" if it has none."""
    return _UNITS.get(name, "rad" if name.endswith(".steer") else "")


def _twist(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    """Return the centre of rotation of a twist, and the velocity of a point if one is given."""
    values = from_words(words, derivation.formula("icr").inputs, derivation.robot)
    centre = rounded(derivation.evaluate("icr", values))
    twist = {k: v for k, v in values.items() if k in TWIST_NAMES}
    moved = derivation.evaluate("inverse", twist)
    slip = float(moved["slip"])
    if slip > SLIDES:
        reason = _obstacle(derivation.robot, twist, moved)
        console.note(
            f"{derivation.robot.name}: wheels slide at this twist, because {reason}: slip = {slip:.6g} m/s"
        )
    result = _centre(centre)
    if any(k.startswith("point.") for k in values):
        result["point_velocity"] = [centre["point.vx"], centre["point.vy"]]
        result["point_radius"] = centre["point.radius"]
    return result


def _steering(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    """Return the steering angles for which the axles meet in the point (icr.x, icr.y)/icr.w; icr.w is 1 by default."""
    values = dict(from_words(words, derivation.formula("steer_to").inputs, derivation.robot))
    values.setdefault("icr.w", ONE)
    x, y, w = (values.get(f"icr.{k}", ZERO) for k in "xyw")
    angles = derivation.evaluate("steer_to", values)
    parameters = {k: v for k, v in values.items() if not k.startswith("icr.")}
    about_it = {"vx": y, "vy": -x, "omega": w}  # a twist about the point
    moved = derivation.evaluate("inverse", parameters | about_it)
    if float(moved["slip"]) > SLIDES * max(1.0, float(abs(x)), float(abs(y)), float(abs(w))):
        console.note(
            f"{derivation.robot.name}: the axles cannot meet there, because "
            f"{_obstacle(derivation.robot, about_it, moved)}; the angles are those of the nearest possible motion"
        )
    return rounded(angles)


def _obstacle(robot: Loaded, twist: Mapping[str, Exact], moved: Mapping[str, Exact]) -> str:
    """Return why wheels slide at a twist, in words.

    Args:
        robot: The robot.
        twist: Its twist [m/s, rad/s] by name; names that are missing are 0.
        moved: The results of `inverse` at this twist.
    """
    from wmrgen.functions.motion.icr import sideways_speeds

    speeds = [float(twist.get(name, ZERO)) for name in TWIST_NAMES]
    size = SLIDES * max(1.0, *map(abs, speeds))
    sliding = [name for name, speed in sideways_speeds(robot, speeds).items() if abs(speed) > size]
    if sliding:
        return f"the fixed axles of {', '.join(sliding)} miss the centre of rotation"
    at_limit = [name for name, angle in moved.items() if _is_at_limit(robot, name, float(angle))]
    if at_limit:
        return f"the limits of {' and '.join(at_limit)} are too small"
    return "its joints are coupled"


def _is_at_limit(robot: Loaded, name: str, angle: float) -> bool:
    """Return whether a steering angle [rad] is at one of its limits."""
    limits = robot.limit_of(name) if name.endswith(".steer") else None
    return limits is not None and any(abs(angle - float(limit)) <= SLIDES for limit in limits[:2])


def _axles(derivation: Derivation, words: Sequence[str]) -> dict[str, Any]:
    """Return the centre of rotation at given steering angles; if there is none, the error of each wheel."""
    from wmrgen.functions.motion.icr import axle_distances, check_steering

    robot = derivation.robot
    ports = [p for p in derivation.formula("axles").inputs if p.name.endswith(".steer")]
    values = from_words(words, ports)
    note_zeros(ports, [values])
    outputs = rounded(derivation.evaluate("axles", values))
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
        f"{robot.name}: incompatible steering: the axles do not meet in one point. The mobility is 0 at these angles, "
        "and wheels slide in every motion; the ICR given is that of least sliding"
    )
    if len(check.odd) == 1:
        console.note(f"{robot.name}: all axles but that of {check.odd[0]} meet in one point")
    result["mismatch"] = outputs["mismatch"]
    distances = {} if isinstance(result["icr"], str) else axle_distances(robot, steer, tuple(result["icr"]))
    result["wheels"] = {}
    for name in (p.name.removesuffix(".steer") for p in ports):
        present, error = steer.get(name, 0.0), outputs[f"{name}.error"]
        facts = {"steer": present, "needed": present + error, "error": error}
        result["wheels"][name] = facts | ({"distance": distances[name]} if name in distances else {})
    return result


def _centre(values: Mapping[str, float]) -> dict[str, Any]:
    """Return the centre as a point; if it is at infinity, its direction and that of travel, as angles from x."""
    x, y, w = (values[f"icr.{k}"] for k in "xyw")
    if abs(w) * _FAR > hypot(x, y):
        return {"icr": [x / w, y / w], "radius": values["radius"], "curvature": values["curvature"]}
    if hypot(x, y) <= 0:
        return {"icr": _STANDSTILL}
    return {"icr": _AT_INFINITY, "direction": atan2(y, x), "travel": atan2(-x + 0.0, y), "curvature": 0.0}
