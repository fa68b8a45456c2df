"""Evaluate rows and polynomials at the example of the result, and write products with their factors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import atan2, cos, hypot, pi, prod, sin, sqrt, tan
from typing import NamedTuple

from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.poly import Gen, Poly, Row
from wmrgen.geometry.layout.records import Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.report.sections.result import example

_OF_JOINTS = {"cos": cos, "sin": sin}
_OF_NUMBERS: Mapping[str, Callable[..., float]] = {
    "pi": lambda: pi, "sqrt": sqrt, "tan": tan, "atan2": atan2, "cosf": cos, "sinf": sin,
    "inv": lambda v: 1 / v, "free": lambda v: v,
}  # fmt: skip
Numbers = Mapping[str, float]


class Steps(NamedTuple):
    """The example in numbers."""

    values: Numbers  # twist, joints, and named parameters under "param NAME"
    measured: Numbers  # the twist that `forward` returns; {} if the example has no such step
    pose: Numbers  # the pose after one second


def steps_of(d: Derivation) -> Steps | None:
    """Return the example of the result in numbers; None if the robot has none."""
    values = {f"param {p.name}": float(p.nominal) for p in d.robot.parameters}
    outputs: dict[str, Numbers] = {}
    for function, given, returned in example(d):
        outputs[function] = {name: float(text) for name, text in returned.items()}
        for name, text in (*given.items(), *returned.items()):
            values.setdefault(name, float(text))
    for w in d.robot.wheels:
        if w.kind.steers and not w.actuated and outputs:
            values |= _passive_angle(w, values)
    return Steps(values, outputs.get("forward", {}), outputs["odometry"]) if outputs else None


def velocity(w: Wheel, values: Numbers) -> tuple[float, float]:
    """Return the velocity of a pivot [m/s]: v + omega z x A."""
    x, y = float(w.nominal.x), float(w.nominal.y)
    return values["vx"] - y * values["omega"], values["vy"] + x * values["omega"]


def _passive_angle(w: Wheel, values: Numbers) -> Numbers:
    """Return the angle of a steered wheel without a drive, which points along its velocity; {} if its pivot rests."""
    ax, ay = velocity(w, values)
    turn = atan2(ay, ax) - w.heading
    return {f"{w.name}.steer": turn - pi * round(turn / pi)} if hypot(ax, ay) > NEGLIGIBLE else {}


def shown(value: float) -> str:
    """Return a number with six significant digits."""
    return f"{round(value, 9) + 0.0:.6g}"


def vector(*values: float) -> str:
    """Return numbers in brackets."""
    return f"({', '.join(map(shown, values))})"


def value_at(p: Poly, values: Numbers) -> float:
    """Return the value of a polynomial in parameters, joints and inputs. KeyError if one of these has no value."""
    total = 0.0
    for monomial, number in p.terms.items():
        total += float(number) * prod(_generator(g, values) ** e for g, e in monomial)
    return total


def _generator(g: Gen, values: Numbers) -> float:
    if g.kind in _OF_JOINTS:
        return _OF_JOINTS[g.kind](
            values.get(f"{g.name}.steer", 0.0)
        )  # a castor that is not measured points ahead
    if g.kind in _OF_NUMBERS:
        return _OF_NUMBERS[g.kind](*(value_at(a, values) for a in g.args))
    return values[f"param {g.name}"] if g.kind == "param" else values[g.name]


def product_of(row: Row, values: Numbers) -> tuple[str, float]:
    """Return the product of a row and the twist, summand by summand, and its value."""
    parts = [(value_at(p, values), values[name]) for p, name in zip(row, TWIST_NAMES, strict=True)]
    total = sum(factor * speed for factor, speed in parts)
    return as_sum(parts), round(total, 6)


def as_sum(parts: Sequence[tuple[float, float]]) -> str:
    """Return products of a factor and a speed as a sum, without products that are 0 and factors that are 1."""
    text = ""
    for factor, speed in parts:
        if abs(factor * speed) < NEGLIGIBLE:
            continue
        if abs(abs(factor) - 1) < NEGLIGIBLE:
            text += f" {'-' if factor * speed < 0 else '+'} {shown(abs(speed))}"
            continue
        number = shown(speed) if speed > 0 else f"({shown(speed)})"
        text += f" {'-' if factor < 0 else '+'} {shown(abs(factor))} · {number}"
    if not text:
        return "0"
    return text.removeprefix(" + ") if text.startswith(" + ") else text.replace(" - ", "-", 1)


def as_equation(text: str, value: float) -> str:
    """Return ``text = value``, or the value alone if the text says the same."""
    return text if text == shown(value) else f"{text} = {shown(value)}"
