"""Judging a design: sizes of rollers, gains of the feedback law, the margin before a robot tips over.

``wmrgen rollers``: Tzafestas (2.86)-(2.91). ``wmrgen gains``: Siegwart (3.60)-(3.65), corrected. ``wmrgen stability``.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.loading import derived
from wmrgen.cli.values import from_words, spelled
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.evaluate import pi_rational
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.ports import Port, Role

FEWEST = 3  # rollers
NEGLIGIBLE = 1e-15  # part of the radius
LARGEST = Exact(10**50)  # 1/s; cubes of gains are doubles up to here
GRAVITY = Exact(Fraction("9.80665"))  # standard gravity [m/s^2]
_ROLLER_NAMES = {"length": "D_r", "width": "d", "half_chord": "b"}
_NEVER = 1e8  # [m/s^2] a force that no robot meets


def rollers(radius: str, count: str, angle: str, as_json: bool) -> int:
    """Print roller length D_r, wheel width d and half chord b in metres."""
    from wmrgen.analysis.kinematics.contacts import mecanum_roller
    from wmrgen.ir.interpret import EXACT, evaluate
    from wmrgen.ir.lower import lower

    function = lower(mecanum_roller())
    case = from_words([f"radius={radius}", f"count={count}", f"angle={angle}"], function.inputs)
    turn = float(case["angle"] / pi_rational()) * 180
    _refuse_impossible(case["radius"], case["count"], turn, angle)
    least = NEGLIGIBLE * float(case["radius"])
    sizes = {_ROLLER_NAMES[k]: float(v) for k, v in evaluate(function, case, EXACT).items()}
    sizes = {k: v if abs(v) > least else 0.0 for k, v in sizes.items()}
    gamma = round(90 - turn, 9) + 0.0
    if as_json:
        console.data({**sizes, "gamma_deg": gamma})
        return 0
    for port in function.outputs:
        name = _ROLLER_NAMES[port.name]
        console.result(f"{name:<3} = {sizes[name]!r} m  {port.text}")
    sign = "±" if gamma else ""
    console.result(f"gamma of the robot file: {sign}{gamma:g} deg, wheel plane to roller axis at the ground")
    return 0


def _refuse_impossible(radius: Exact, count: Exact, turn: float, angle: str) -> None:
    """UsageError for a wheel that cannot be; ``turn`` is ``angle`` in degrees."""
    if radius.sign <= 0:
        raise UsageError("the radius is not positive. Write the radius of the wheel, as 150mm.")
    if not count.is_rational or count.parts[0].denominator != 1 or count < FEWEST:
        raise UsageError(
            f"{count} rollers do not close a wheel: the count is a whole number of at least {FEWEST}."
        )
    if not 0 < turn <= 90 + 1e-9:
        hint = f" A bare number is in radians: write {angle}deg." if angle.strip()[-1:].isdigit() else ""
        raise UsageError(
            f"a roller angle of {turn:.6g} deg is impossible: from the hub axis to the roller axis there are more "
            f"than 0 and at most 90 deg (90 deg is an omni wheel).{hint}"
        )


def gains(values: Sequence[str] | None, as_json: bool) -> int:
    """Verdict on the gains that ``values`` give, else of the robot file before them, else of the text."""
    from wmrgen.functions.control.gains import TEXTBOOK, judge, linearisation, nominal_gains, polynomial

    words = values or ()
    chosen = dict(TEXTBOOK)
    if words and "=" not in words[0]:
        chosen, words = nominal_gains(wmrgen.load(Path(words[0]))), words[1:]
    chosen |= from_words(words, [Port(name, Role.COMMAND, "1/s") for name in chosen])
    if any(abs(value) > LARGEST for value in chosen.values()):
        raise UsageError(
            f"a gain is beyond {float(LARGEST):g} in magnitude. Gains of robots are near 1 to 10."
        )
    verdict = judge(**chosen)
    facts: dict[str, Any] = {name: float(value) for name, value in chosen.items()}
    facts |= {
        "stable": verdict.stable,
        "strong_3_65": verdict.strong,
        "strong_all_beta": verdict.strong_all_beta,
        "violated": list(verdict.violated),
        "linearisation": [[float(v) for v in row] for row in linearisation(**chosen)],
        "polynomial": [float(v) for v in polynomial(**chosen)],
        "eigenvalues": [[e.real + 0.0, e.imag + 0.0] for e in verdict.eigenvalues],
    }
    if as_json:
        console.data(facts)
        return 0
    powers = zip(facts["polynomial"], ("s^3", "s^2", "s", ""), strict=True)
    texts = {k: ("yes" if v else "no") if isinstance(v, bool) else repr(v) for k, v in facts.items()}
    texts["violated"] = ", ".join(verdict.violated) or "nothing"
    texts["polynomial"] = " ".join(f"{c:+.6g} {power}".rstrip() for c, power in powers)
    texts["eigenvalues"] = ", ".join(
        f"{re:.6g}{im:+.6g}i" if im else f"{re:.6g}" for re, im in facts["eigenvalues"]
    )
    console.values(texts)
    for text in verdict.lost if verdict.stable else ():
        console.note(f"not from every pose: {text} fails")
    return 0


def stability(robot: Path, values: Sequence[str] | None, as_json: bool) -> int:
    """Margin of every edge of the support polygon, and the one about which the robot tips over first."""
    from wmrgen.functions.space.pendulum import axle
    from wmrgen.functions.space.stability import polygon

    with derived(robot, ["stability"]) as derivation:
        words = spelled(values or (), derivation.robot, "steer")
        case = dict(from_words(words, derivation.formula("stability").inputs, derivation.robot))
        if "fz" not in case:
            case["fz"] = GRAVITY
            console.note(f"not given: fz, taken as {float(GRAVITY)}")
        margins = {name: float(v) for name, v in derivation.evaluate("stability", case).items()}
        two = axle(derivation.robot)
        steer = {w.name: float(case.get(f"{w.name}.steer", ZERO)) for w in derivation.robot.wheels}
        corners = polygon(derivation.robot, steer)
    pairs = list(zip(corners, (*corners[1:], corners[0]), strict=True))
    # On one axle: over either wheel, and lengthwise about both.
    lines = (
        [(w.name, (w.name, w.name)) for w in two] + [("swing", (two.right.name, two.left.name))]
        if two
        else []
    )
    result = _result(margins, lines or [(a, (a, b)) for a, b in pairs])
    if as_json:
        console.data(result)
    else:
        _show(result)
    return 0


def _result(margins: dict[str, float], lines: Sequence[tuple[str, tuple[str, str]]]) -> dict[str, Any]:
    """The outputs of ``stability`` by line of liftoff, each from one contact to another; ranges if there are some."""
    shown: list[dict[str, Any]] = [
        {"from": a, "to": b, "margin": margins[f"{name}.margin"]} for name, (a, b) in lines
    ]
    first = min(shown, key=lambda e: e["margin"])
    return {
        "liftoff": margins["margin"] <= 0, "margin": margins["margin"], "about": [first["from"], first["to"]],
        "edges": shown,
        **{f: [margins[f"{f}_min"], margins[f"{f}_max"]] for f in ("fx", "fy") if f"{f}_min" in margins},
    }  # fmt: skip


def _line(a: str, b: str) -> str:
    """A line of liftoff: from one contact to another, or along the rolling direction of one."""
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
    for letter in (f for f in ("fx", "fy") if f in result):
        low, high = (f"{v:.6g}" if abs(v) < _NEVER else "any" for v in result[letter])
        console.result(f"{letter:<{width}}  stands from {low} to {high} m/s^2")
