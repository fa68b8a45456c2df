"""Write the example of the result in numbers, in a box of each section that computes something.

A box is a block quote, which the HTML page shows shaded, beside the formulas on a wide screen.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import cos, degrees, hypot, sin, tan

import numpy as np

from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.analysis.mobility.ranks import independent
from wmrgen.analysis.mobility.records import Array
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.constraints import XI, Constraints, constrain, nominal_view
from wmrgen.geometry.exact.poly import Poly, Row, dot
from wmrgen.geometry.layout.records import Wheel
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.report.sections.example import (
    Numbers,
    Steps,
    as_equation,
    as_sum,
    product_of,
    shown,
    value_at,
    vector,
    velocity,
)
from wmrgen.report.sections.forward import rows_as_printed
from wmrgen.report.sections.markdown import code, listed
from wmrgen.report.sections.mobility import conditions_of_speeds, turns_about

_MANY = 3  # wheels whose rows are written out; more would fill half a screen
_LISTED = 6  # entries of a vector that are written out, on two lines of a box
_RESIDUAL = 5e-5  # m/s: what six digits of joint rates leave of a residual that is 0
_SAME = 1e-4  # relative: what six digits leave of equal rates
_SIDEWAYS = 0.01  # m/s: a small change of the velocity of a pivot, 1 cm/s


def with_example(section: str, d: Derivation, steps: Steps | None, blocks: list[str]) -> list[str]:
    """Return the blocks of a section with the box of the example.

    Args:
        section: the name of the function that writes the section; sections without computation have no box.
        d: the derivation that the section is about.
        steps: the example in numbers, from `steps_of`.
        blocks: the blocks of the section.

    Returns:
        The blocks, with the box after the first formula.
    """
    write = _WRITERS.get(section)
    if write is None or steps is None:
        return blocks
    lines = write(d, steps)
    if not lines:
        return blocks
    box = "  \n".join(f"> {line}" for line in ["**Example.** " + lines[0], *lines[1:]])
    place = _place(section, blocks)
    return [*blocks[:place], box.replace("-", "−"), *blocks[place:]]


def _place(section: str, blocks: Sequence[str]) -> int:
    """Return the index of the box: after the first formula, or in section 9 after the first paragraph."""
    if section == "singular":
        places = (k for k, block in enumerate(blocks, 1) if not block.startswith(("#", "![")))
    else:
        places = (k for k, block in enumerate(blocks, 1) if block.startswith("```math"))
    return next(places, len(blocks))


def _rows(d: Derivation, steps: Steps) -> list[str]:
    """Return each row times the twist."""
    c = constrain(d.robot, nominal_view)
    twist = vector(*(steps.values[n] for n in TWIST_NAMES))
    known = [w for w in d.robot.wheels if not w.kind.steers or f"{w.name}.steer" in steps.values]
    wheels = [w for w in known if w.kind.directed and not w.kind.swivels]
    lines = [f"ξ = {twist} is the example twist of this page. The rows of section 3 times ξ are, in m/s:"]
    for w in wheels[:_MANY]:
        lines.append(f"{code(w.name)}: {'; '.join(_rows_of(c, w, steps.values))}.")
    return lines if wheels else []


def _rows_of(c: Constraints, w: Wheel, values: Numbers) -> list[str]:
    """Return the rolling and the sliding row of a wheel times the twist, in words."""
    own = [row for row in (*c.rolling, *c.sliding) if row.wheel.index == w.index]
    return [f"{row.kind} {as_equation(*product_of(row.row, values))}" for row in own]


def _rates(d: Derivation, steps: Steps) -> list[str]:
    """Return how rates and angles follow from the twist."""
    c, values = constrain(d.robot, nominal_view), steps.values
    lines = []
    for row in [row for row in c.rolling if f"{row.wheel.name}.spin" in values][:_MANY]:
        w = row.wheel
        spin, radius = values[f"{w.name}.spin"], -value_at(dict(row.rates)[w.index, "spin"], values)
        if w.kind.swivels:
            lines.append(f"{code(w.name)}, at ψ = 0: φ̇ = {shown(spin)} rad/s.")
            continue
        rim = product_of(row.row, values)[1]
        quotient = f"{shown(rim)} / {shown(radius)}"
        rate = f"φ̇ = {as_equation(quotient, spin)} rad/s"
        if abs(rim / radius - spin) > _SAME * max(abs(spin), 1.0):  # a coupling or a limit changes it
            rate = f"φ̇ = {shown(spin)} rad/s"
        lines.append(f"{code(w.name)}: {_angle(w, values)}{rate}.")
    return [f"ξ = {vector(*(values[n] for n in TWIST_NAMES))} gives:", *lines] if lines else []


def _angle(w: Wheel, values: Numbers) -> str:
    """Return the steering angle with the velocity of the pivot; "" for a wheel that does not steer."""
    psi = values.get(f"{w.name}.steer")
    if not w.kind.steers or psi is None:
        return ""
    ax, ay = velocity(w, values)
    ratio = f", tan ψ = {shown(tan(psi))}" if abs(ax) > NEGLIGIBLE and not w.heading else ""
    return f"v<sub>A</sub> = {vector(ax, ay)}{ratio}, ψ = {_in_degrees(psi)}, "


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
    known = f"z = {vector(*z)} m/s" if len(z) <= _LISTED else f"z with {len(z)} entries"
    small = "0" if residual < _RESIDUAL else f"{shown(residual)} m/s"
    return [
        f"The joints of section 6 are measured. {known} gives ξ = {vector(*(steps.measured[n] for n in TWIST_NAMES))}, "
        f"and the residual |z − H ξ| is {small}."
    ]


def _pose(_: Derivation, steps: Steps) -> list[str]:
    """Return the pose after one second, from a start at 0."""
    vx, vy, omega = (steps.values[n] for n in TWIST_NAMES)
    half = omega / 2
    factor = sin(half) / half if half else 1.0
    ahead, side = vx * cos(half) - vy * sin(half), vx * sin(half) + vy * cos(half)
    start = f"From (0, 0, 0), with Δt = 1 s: σ = {shown(half)}, sinc σ = {shown(factor)}."
    return [
        start,
        f"x' = {shown(factor)} · {shown(ahead)} = {shown(steps.pose['x'])} m,",
        f"y' = {shown(factor)} · {shown(side)} = {shown(steps.pose['y'])} m,",
        f"θ' = {shown(steps.pose['theta'])} rad",
    ]


def _twist(steps: Steps) -> Array:
    """Return the twist of the example."""
    return np.array([steps.values[n] for n in TWIST_NAMES])


def _numbers(rows: Sequence[Row], values: Numbers) -> Array:
    """Return rows in numbers, as an (N, 3) array."""
    return np.array([[value_at(p, values) for p in row] for row in rows], dtype=np.float64).reshape(-1, 3)


def _all_angles_known(d: Derivation, values: Numbers) -> bool:
    """Return whether the example has the angle of each steered wheel: all pivots move, or are commanded."""
    return all(f"{w.name}.steer" in values for w in d.robot.wheels if w.kind.steers)


def _at_angles(d: Derivation, values: Numbers) -> str:
    """Return the steering angles of the example as the start of a sentence; "" without steered wheels."""
    angles = [
        f"{_in_degrees(values[f'{w.name}.steer'])} ({code(w.name)})" for w in d.robot.wheels if w.kind.steers
    ]
    if not angles:
        return ""
    more = ", …" if len(angles) > _LISTED else ""
    return f"At ψ = {', '.join(angles[:_LISTED])}{more}, "


def _in_degrees(angle: float) -> str:
    return f"{shown(round(degrees(angle), 3))}°"


def _cut(values: Array) -> str:
    """Return a number, or a vector in brackets of which a few entries are shown. Residuals of rounding are 0."""
    entries = [shown(v if abs(v) > _RESIDUAL else 0.0) for v in values[:_LISTED]]
    if len(values) > _LISTED:
        entries.append("…")
    return entries[0] if len(entries) == 1 else f"({', '.join(entries)})"


def _constrained(d: Derivation, steps: Steps) -> Array | None:
    """Return C1 in numbers; None if it has no row or if the example slides, as a robot that skids does in a curve."""
    c = constrain(d.robot, nominal_view)
    rows = [row.row for row in (*c.sliding_fixed, *c.sliding_steered)]
    if not rows or not _all_angles_known(d, steps.values):
        return None
    matrix = _numbers(rows, steps.values)
    return matrix if float(np.abs(matrix @ _twist(steps)).max()) < _RESIDUAL else None


def _products(d: Derivation, steps: Steps) -> list[str]:
    """Return the different rows of C1, and the products of J1 and C1 with the twist."""
    c = constrain(d.robot, nominal_view)
    if not _all_angles_known(d, steps.values) or not c.rolling:
        return []
    speeds = _numbers([row.row for row in c.rolling], steps.values) @ _twist(steps)
    castors = "at ψ = 0 of the castors, " if any(w.kind.swivels for w in d.robot.wheels) else ""
    rolling = f"{castors}J₁ ξ = {_cut(speeds)} m/s"
    sliding = _constrained(d, steps)
    if sliding is None:
        return [f"For ξ = {vector(*_twist(steps))}, {rolling}."]
    rows = list(dict.fromkeys(vector(*row) for row in sliding))
    more = ", …" if len(rows) > _MANY else ""
    head = f"{_at_angles(d, steps.values)}C₁ has the row{'s' * (len(rows) > 1)}"
    return [
        f"{head} {', '.join(rows[:_MANY])}{more}.",
        f"For ξ = {vector(*_twist(steps))}, {rolling} and C₁ ξ = 0.",
    ]


def _combination(d: Derivation, steps: Steps) -> list[str]:
    """Return the twist as a combination of the columns of N."""
    columns = d.mobility.null_space_symbolic
    if not columns or len(columns) == len(TWIST_NAMES) or not _all_angles_known(d, steps.values):
        return []
    twist, basis = _twist(steps), _numbers(columns, steps.values)
    eta = np.asarray(np.linalg.lstsq(basis.T, twist, rcond=None)[0], dtype=np.float64)
    if float(np.abs(basis.T @ eta - twist).max()) > _RESIDUAL:
        return []
    which = ("",) if len(eta) == 1 else tuple(f"<sub>{k}</sub>" for k in range(1, len(eta) + 1))
    names = ["N" if len(eta) == 1 else f"N{k}" for k in which]
    numbers = ", ".join(f"{n} = {vector(*column)}" for n, column in zip(names, basis, strict=True))
    parts = " + ".join(f"{shown(v)} {n}" for v, n in zip(eta, names, strict=True)).replace("+ -", "- ")
    at = "At the angles of section 3, " if any(w.kind.steers for w in d.robot.wheels) else ""
    lines = [f"{at}{numbers}.", f"ξ = {vector(*twist)} = {parts}, so η = {_cut(eta)}."]
    if len(eta) == 1 and abs(twist[2]) > NEGLIGIBLE:
        lines[-1] += f" The ICR is at {vector(-twist[1] / twist[2], twist[0] / twist[2])} m."
    return lines


def _ranks(d: Derivation, steps: Steps) -> list[str]:
    """Return why C1 has its rank, and one condition of compatibility, in numbers."""
    return [*_rank(d, steps), *_compatible(d, steps)]


def _rank(d: Derivation, steps: Steps) -> list[str]:
    """Show the rank of C1 by independent rows: it is below 3 because C1 xi = 0."""
    matrix = _constrained(d, steps)
    rank = 3 - d.mobility.degree_of_mobility
    if matrix is None or d.mobility.rank_C1.value != rank:  # couplings constrain the twist too
        return []
    chosen = [matrix[i] for i in independent(matrix, rank)]
    if rank == 1:
        return [f"All rows of C₁ are multiples of {vector(*chosen[0])}: rank C₁ = 1."]
    if rank != 2 or len(chosen) != rank:
        return []
    first, second = (vector(*row) for row in chosen)
    product = vector(*np.cross(*chosen))
    return [
        f"{first} × {second} = {product} is not 0, so these rows of C₁ are independent. "
        "With C₁ ξ = 0, this leaves rank C₁ = 2."
    ]


def _compatible(d: Derivation, steps: Steps) -> list[str]:
    """Return the first condition of compatibility with the rates of the example."""
    conditions, values = conditions_of_speeds(d), steps.values
    spins = {f"{w.name}.spin": 0.0 for w in d.robot.wheels if "spin" in w.actuated}
    if not conditions or not spins.keys() <= values.keys():
        return []
    try:
        factors = {n: value_at(conditions[0], {**values, **spins, n: 1.0}) for n in spins}
    except KeyError:
        return []
    parts = [(k, values[n]) for n, k in factors.items() if abs(k) > NEGLIGIBLE]
    if abs(sum(k * spin for k, spin in parts)) > _SAME * max(abs(k * spin) for k, spin in parts):
        return []
    text = as_sum(parts)
    which = "Condition" if len(conditions) == 1 else "First condition"
    return [f"{which} of compatibility: {text} = 0."]


def _singular(d: Derivation, steps: Steps) -> list[str]:
    """Return how far the example is from singular configurations."""
    values = steps.values
    if not _all_angles_known(d, values):
        return []
    return [*_slowest_pivot(d, values), *_conditions(d, values)]


def _slowest_pivot(d: Derivation, values: Numbers) -> list[str]:
    """Return how much a small sideways change of the velocity of a pivot turns its wheel, if it can be the ICR."""
    steered = [d.robot.wheel(s.wheels[0]) for s in d.mobility.singularities if s.kind == "icr_on_pivot"]
    speeds = {w.name: hypot(*velocity(w, values)) for w in steered if turns_about(w, d.mobility)}
    if not speeds:
        return []
    name = min(speeds, key=lambda n: (round(speeds[n], 6), n))
    speed = speeds[name]
    if speed < NEGLIGIBLE:
        return [f"The pivot of {code(name)} does not move: the example is singular."]
    change = _SIDEWAYS / speed
    return [
        f"{code(name)}: |v<sub>A</sub>| = {shown(speed)} m/s. A change by {shown(_SIDEWAYS)} m/s across the wheel "
        f"turns it by {shown(change)} rad."
    ]


def _conditions(d: Derivation, values: Numbers) -> list[str]:
    """Return the left sides of the conditions for other singular configurations."""
    lines = []
    for s in d.mobility.singularities:
        if s.kind == "icr_on_pivot" or not s.conditions:
            continue
        polys = [c if isinstance(c, Poly) else dot(c, XI) for c in s.conditions]
        try:
            sides = [value_at(p, values) for p in polys]
        except KeyError:
            continue
        if max(map(abs, sides)) > _RESIDUAL:
            one = len(sides) == 1
            lines.append(
                f"The left side{'' if one else 's'} of the condition{'' if one else 's'} for {listed(s.wheels)} "
                f"{'is' if one else 'are'} {' and '.join(map(shown, sides))}, not 0."
            )
    return lines[:_MANY]


_WRITERS: Mapping[str, Callable[[Derivation, Steps], list[str]]] = {
    "wheel_rows": _rows,
    "matrices": _products,
    "null_space": _combination,
    "analysis": _ranks,
    "inverse": _rates,
    "forward": _measured,
    "motion": _pose,
    "singular": _singular,
}
