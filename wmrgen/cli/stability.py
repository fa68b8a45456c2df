"""``wmrgen stability``: the margin before a robot tips over."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Annotated, Any

from wmrgen.cli import console
from wmrgen.cli.declare import Json, Robot, Words, verb, words
from wmrgen.cli.loading import derived
from wmrgen.cli.values import from_words, with_joints
from wmrgen.geometry.exact.number import ZERO, Exact

GRAVITY = Exact(Fraction("9.80665"))  # standard gravity [m/s^2]
_NO_LIMIT = 1e8  # m/s^2: a specific force beyond this is printed as "any"

Line = tuple[str, str, str]  # name of its margin, and the two contacts that it connects


@verb("stability")
def stability(
    robot: Robot,
    values: Annotated[
        Words, words("Specific force a - g at the centre of gravity: fx fy fz; <wheel>.steer of castors.")
    ] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen stability my_robot.yaml fx=0 fy=4

    Compute how far a robot is from tipping over each edge of its support polygon, and over which edge it tips first.
    The robot file gives the centre of gravity: cg: {x: 0, y: 0, z: 0.6}.
    """
    from wmrgen.functions.space.pendulum import axle
    from wmrgen.functions.space.stability import polygon

    with derived(robot, ["stability"]) as derivation:
        given = with_joints(values or (), derivation.robot, "steer")
        case = dict(from_words(given, derivation.formula("stability").inputs, derivation.robot))
        if "fz" not in case:
            case["fz"] = GRAVITY
            console.note(f"not given: fz, taken as {float(GRAVITY)}")
        margins = {name: float(v) for name, v in derivation.evaluate("stability", case).items()}
        wheels = axle(derivation.robot)
        steer = {w.name: float(case.get(f"{w.name}.steer", ZERO)) for w in derivation.robot.wheels}
        corners = polygon(derivation.robot, steer)
    lines: list[Line]
    if wheels:  # two wheels on one axle: it tips over either wheel, or swings about the axle
        lines = [(w.name, w.name, w.name) for w in wheels]
        lines.append(("swing", wheels.right.name, wheels.left.name))
    else:
        lines = [(a, a, b) for a, b in zip(corners, (*corners[1:], corners[0]), strict=True)]
    result = _result(margins, lines)
    if as_json:
        console.data(result)
    else:
        _show(result)
    return 0


def _result(margins: dict[str, float], lines: Sequence[Line]) -> dict[str, Any]:
    """Return the outputs of the function ``stability`` by line, and the ranges of force that it gives, if any."""
    edges: list[dict[str, Any]] = [
        {"from": a, "to": b, "margin": margins[f"{name}.margin"]} for name, a, b in lines
    ]
    first = min(edges, key=lambda edge: edge["margin"])
    result = {
        "liftoff": margins["margin"] <= 0,
        "margin": margins["margin"],
        "about": [first["from"], first["to"]],
        "edges": edges,
    }
    for force in ("fx", "fy"):
        if f"{force}_min" in margins:
            result[force] = [margins[f"{force}_min"], margins[f"{force}_max"]]
    return result


def _line(a: str, b: str) -> str:
    """Return the name of a line over which the robot tips: two contacts, or one wheel along its rolling direction."""
    return a if a == b else f"{a} - {b}"


def _show(result: dict[str, Any]) -> None:
    names = [_line(e["from"], e["to"]) for e in result["edges"]]
    width = max(map(len, (*names, "fx")))
    for name, edge in zip(names, result["edges"], strict=True):
        console.result(f"{name:<{width}}  {edge['margin']:.6g} rad")
    line = _line(*result["about"])
    if result["liftoff"]:
        console.result(f"liftoff about the line {line} at {result['margin']:.6g} rad", "bold")
        return
    console.result(f"stands; {result['margin']:.6g} rad to liftoff about the line {line}", "bold")
    for force in ("fx", "fy"):
        if force in result:
            low, high = (f"{v:.6g}" if abs(v) < _NO_LIMIT else "any" for v in result[force])
            console.result(f"{force:<{width}}  stands from {low} to {high} m/s^2")
