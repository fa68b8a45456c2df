"""``wmrgen stability``: about which line a robot tips over, and how far it is from that."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from wmrgen.cli import console
from wmrgen.cli.loading import derived
from wmrgen.cli.motion import spelled
from wmrgen.cli.values import from_words
from wmrgen.exact.number import Exact

GRAVITY = Exact(Fraction("9.80665"))  # standard gravity [m/s^2]
_NEVER = 1e8


def run(path: Path, words: Sequence[str], *, as_json: bool) -> int:
    """Margin of every edge of the support polygon, and the one about which the robot tips over first."""
    from wmrgen.functions.space.support import polygon

    with derived(path, ["stability"]) as derivation:
        robot = derivation.robot
        values = dict(from_words(spelled(words, robot, "steer"), derivation.formula("stability").inputs))
        if "fz" not in values:
            values["fz"] = GRAVITY
            console.note(f"not given: fz, taken as {float(GRAVITY)}")
        margins = {name: float(v) for name, v in derivation.evaluate("stability", values).items()}
        steer = {w.name: float(values.get(f"{w.name}.steer", Exact(0))) for w in robot.wheels}
        corners = polygon(robot, steer)
    result = _result(margins, list(zip(corners, (*corners[1:], corners[0]), strict=True)))
    if as_json:
        console.data(result)
    else:
        _show(result)
    return 0


def _result(margins: dict[str, float], edges: Sequence[tuple[str, str]]) -> dict[str, Any]:
    """The outputs of ``stability`` by edge of the support polygon, each from one corner to the next."""
    shown: list[dict[str, Any]] = [{"from": a, "to": b, "margin": margins[f"{a}.margin"]} for a, b in edges]
    first = min(shown, key=lambda e: e["margin"])
    return {
        "liftoff": margins["margin"] <= 0, "margin": margins["margin"], "about": [first["from"], first["to"]],
        "edges": shown,
        "fx": [margins["fx_min"], margins["fx_max"]], "fy": [margins["fy_min"], margins["fy_max"]],
    }  # fmt: skip


def _show(result: dict[str, Any]) -> None:
    names = [f"{e['from']} - {e['to']}" for e in result["edges"]]
    width = max(map(len, (*names, "fx")))
    for name, edge in zip(names, result["edges"], strict=True):
        console.result(f"{name:<{width}}  {edge['margin']:.6g} rad")
    line = " - ".join(result["about"])
    if result["liftoff"]:
        console.result(f"liftoff about the line {line} at {result['margin']:.6g} rad", "bold")
        return
    console.result(f"stands; {result['margin']:.6g} rad to liftoff about the line {line}", "bold")
    for letter in ("fx", "fy"):
        low, high = (_limit(v) for v in result[letter])
        console.result(f"{letter:<{width}}  stands from {low} to {high} m/s^2")


def _limit(value: float) -> str:
    return f"{value:.6g}" if abs(value) < _NEVER else "any"
