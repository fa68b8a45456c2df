"""Write the example of the result in numbers, in a box of each section: rows, rates, measurements and pose.

A box is a block quote, which the HTML page shows shaded, beside the formulas on a wide screen.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import cos, degrees, hypot, prod, sin, tan
from typing import NamedTuple

from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.constraints import Constraints, constrain, nominal_view
from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.layout.records import Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.report.sections.forward import rows_as_printed
from wmrgen.report.sections.markdown import code
from wmrgen.report.sections.result import example

_MANY = 3  # wheels whose rows are written out; more would fill half a screen
_Z = 6  # entries of z that are written out, on two lines of a box
_ZERO = 1e-9  # rounding errors of factors and speeds that are 0
_RESIDUAL = 5e-5  # m/s: what six digits of joint rates leave of a residual that is 0
_SAME = 1e-4  # relative: what six digits leave of equal rates
Numbers = Mapping[str, float]


class Steps(NamedTuple):
    """The example in numbers."""

    values: Numbers  # twist, joints, and named parameters under "param NAME"
    measured: Numbers  # the twist that `forward` returns; {} if the example has no such step
    pose: Numbers  # the pose after one second


def with_example(section: str, d: Derivation, steps: Steps | None, blocks: list[str]) -> list[str]:
    """Return the blocks of a section with the box of the example.

    Args:
        section: "wheel_rows", "inverse", "forward" or "motion"; other sections have no box.
        d: the derivation.
        steps: the example in numbers, from `steps_of`.
        blocks: the blocks of the section.

    Returns:
        The blocks, with the box after the first formula.
    """
    write = _WRITERS.get(section)
    if write is None or steps is None:
        return blocks
    lines = write(d.driven, steps)
    if not lines:
        return blocks
    box = "  \n".join(f"> {line}" for line in ["**Example.** " + lines[0], *lines[1:]])
    place = _place(blocks)
    return [*blocks[:place], box.replace("-", "−"), *blocks[place:]]


def _place(blocks: Sequence[str]) -> int:
    """Return the index after the first formula, where the box is beside the next formulas."""
    formulas = (k for k, block in enumerate(blocks, 1) if block.startswith("```math"))
    return next(formulas, len(blocks))


def steps_of(d: Derivation) -> Steps | None:
    """Return the example of the result in numbers; None if the robot has none."""
    values = {f"param {p.name}": float(p.nominal) for p in d.robot.parameters}
    outputs: dict[str, Numbers] = {}
    for function, given, returned in example(d):
        outputs[function] = {name: float(text) for name, text in returned.items()}
        for name, text in (*given.items(), *returned.items()):
            values.setdefault(name, float(text))
    return Steps(values, outputs.get("forward", {}), outputs["odometry"]) if outputs else None


# ---- Numbers.


def _shown(value: float) -> str:
    """Return a number with six significant digits."""
    return f"{round(value, 9) + 0.0:.6g}"


def _pair(*values: float) -> str:
    return f"({', '.join(map(_shown, values))})"


def value_at(p: Poly, values: Numbers) -> float:
    """Return the value of a polynomial in parameters, joints and inputs. KeyError if it has other generators."""
    total = 0.0
    for monomial, number in p.terms.items():
        total += float(number) * prod(_generator(g.kind, g.name, values) ** e for g, e in monomial)
    return total


def _generator(kind: str, name: str, values: Numbers) -> float:
    functions = {"cos": cos, "sin": sin}
    if kind in functions:
        return functions[kind](values.get(f"{name}.steer", 0.0))  # a castor that is not measured points ahead
    return values[f"param {name}"] if kind == "param" else values[name]


def product_of(row: Row, values: Numbers) -> tuple[str, float]:
    """Return the product of a row and the twist, summand by summand, and its value."""
    text, total = "", 0.0
    for p, name in zip(row, TWIST_NAMES, strict=True):
        factor, speed = value_at(p, values), values[name]
        if abs(factor * speed) < _ZERO:
            continue
        total += factor * speed
        if abs(abs(factor) - 1) < _ZERO:
            text += f" {'-' if factor * speed < 0 else '+'} {_shown(abs(speed))}"
            continue
        number = _shown(speed) if speed > 0 else f"({_shown(speed)})"
        text += f" {'-' if factor < 0 else '+'} {_shown(abs(factor))} · {number}"
    text = (
        text.removeprefix(" + ").replace(" - ", "-", 1)
        if text.startswith(" - ")
        else text.removeprefix(" + ")
    )
    return (text, round(total, 6)) if text else ("0", 0.0)


def _equal(text: str, value: float) -> str:
    """Return ``text = value``, or the value alone if the text says the same."""
    return text if text == _shown(value) else f"{text} = {_shown(value)}"


# ---- The boxes.


def _rows(d: Derivation, steps: Steps) -> list[str]:
    """Return each row times the twist."""
    c = constrain(d.robot, nominal_view)
    twist = _pair(*(steps.values[n] for n in TWIST_NAMES))
    wheels = [w for w in d.robot.wheels if w.kind.directed and not w.kind.swivels]
    lines = [f"ξ = {twist} is the example twist of this page. The rows of section 3 times ξ are, in m/s,"]
    for w in wheels[:_MANY]:
        lines.append(f"{code(w.name)}: {'; '.join(_rows_of(c, w, steps.values))}")
    return lines if wheels else []


def _rows_of(c: Constraints, w: Wheel, values: Numbers) -> list[str]:
    """Return the rolling and the sliding row of a wheel times the twist, in words."""
    own = [row for row in (*c.rolling, *c.sliding) if row.wheel.index == w.index]
    return [f"{row.kind} {_equal(*product_of(row.row, values))}" for row in own]


def _rates(d: Derivation, steps: Steps) -> list[str]:
    """Return how rates and angles follow from the twist."""
    c, values = constrain(d.robot, nominal_view), steps.values
    lines = []
    for row in [row for row in c.rolling if f"{row.wheel.name}.spin" in values][:_MANY]:
        w = row.wheel
        spin, radius = values[f"{w.name}.spin"], -value_at(dict(row.rates)[w.index, "spin"], values)
        if w.kind.swivels:
            lines.append(f"{code(w.name)}, at ψ = 0: φ̇ = {_shown(spin)} rad/s")
            continue
        rim = product_of(row.row, values)[1]
        quotient = f"{_shown(rim)} / {_shown(radius)}"
        rate = f"φ̇ = {_equal(quotient, spin)} rad/s"
        if abs(rim / radius - spin) > _SAME * max(abs(spin), 1.0):  # a coupling or a limit changes it
            rate = f"φ̇ = {_shown(spin)} rad/s"
        lines.append(f"{code(w.name)}: {_angle(w, values)}{rate}")
    return [f"ξ = {_pair(*(values[n] for n in TWIST_NAMES))} gives", *lines] if lines else []


def _angle(w: Wheel, values: Numbers) -> str:
    """Return the steering angle with the velocity of the pivot; "" for a wheel that does not steer."""
    psi = values.get(f"{w.name}.steer")
    if not w.kind.steers or psi is None:
        return ""
    x, y = float(w.nominal.x), float(w.nominal.y)
    ax, ay = values["vx"] - y * values["omega"], values["vy"] + x * values["omega"]
    ratio = f", tan ψ = {_shown(tan(psi))}" if abs(ax) > _ZERO and not w.heading else ""
    return f"v<sub>A</sub> = {_pair(ax, ay)}{ratio}, ψ = {_shown(round(degrees(psi), 3))}°, "


def _twist_along(row: Row, steps: Steps) -> float:
    """Return a row times the twist that `forward` returns."""
    return sum(value_at(p, steps.values) * steps.measured[n] for p, n in zip(row, TWIST_NAMES, strict=True))


def _measured(d: Derivation, steps: Steps) -> list[str]:
    """Return z, the twist that follows from it, and the residual."""
    if not steps.measured:
        return []
    rows = rows_as_printed(d)
    try:
        z = [value_at(value, steps.values) for _, value, _ in rows]
        gaps = [z_k - _twist_along(row, steps) for (row, _, _), z_k in zip(rows, z, strict=True)]
    except KeyError:
        return []
    residual = hypot(*gaps)
    known = f"z = {_pair(*z)} m/s" if len(z) <= _Z else f"z with {len(z)} entries"
    small = "0" if residual < _RESIDUAL else f"{_shown(residual)} m/s"
    return [
        f"The joints of section 6 are measured. {known} gives ξ = {_pair(*(steps.measured[n] for n in TWIST_NAMES))}, "
        f"and the residual |z − H ξ| is {small}."
    ]


def _pose(_: Derivation, steps: Steps) -> list[str]:
    """Return the pose after one second, from a start at 0."""
    vx, vy, omega = (steps.values[n] for n in TWIST_NAMES)
    half = omega / 2
    factor = sin(half) / half if half else 1.0
    ahead, side = vx * cos(half) - vy * sin(half), vx * sin(half) + vy * cos(half)
    start = f"From (0, 0, 0), with Δt = 1 s: σ = {_shown(half)}, sinc σ = {_shown(factor)},"
    return [
        start,
        f"x' = {_shown(factor)} · {_shown(ahead)} = {_shown(steps.pose['x'])} m,",
        f"y' = {_shown(factor)} · {_shown(side)} = {_shown(steps.pose['y'])} m,",
        f"θ' = {_shown(steps.pose['theta'])} rad",
    ]


_WRITERS: Mapping[str, Callable[[Derivation, Steps], list[str]]] = {
    "wheel_rows": _rows,
    "inverse": _rates,
    "forward": _measured,
    "motion": _pose,
}
