"""Write section 10: the equations of textbooks that hold for a robot; and the turning circle of a car.

An equation is cited if its rows, with the letters of the text replaced by their values, equal those of the robot to
1e-9 of their size. Exact equality would be too strict, because robot files have rounded numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry import notation
from wmrgen.geometry.constraints import nominal_view, rolling_row, symbolic_view
from wmrgen.geometry.exact.evaluate import cos_sin
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.report.sections.latex import latex
from wmrgen.report.sections.markdown import aligned, items, keyed, listed, plain

Letters = dict[str, Exact]
Wheels = Sequence[Wheel]
Rows = tuple[tuple[Exact, Exact, Exact], ...]


class Citation(NamedTuple):
    """An equation of a textbook that holds for the robot."""

    equation: str  # text and number of the equation
    what: str  # what it gives
    letters: Letters  # symbols of the text, with their values for this robot
    wheels: Wheels = ()  # in the order of the text


def texts(d: Derivation) -> list[str]:
    """Return section 10; [] if no text has this layout."""
    lines = []
    for c in citations(d.robot):
        letters = ", ".join(f"{name} = {plain(value)}" for name, value in c.letters.items())
        order = f"wheels in the order {listed([w.name for w in c.wheels])}" if len(c.wheels) > 1 else ""
        details = "; ".join(part for part in (letters, order) if part)
        lines.append(f"{c.equation}: {c.what}" + (f" ({details})" if details else ""))
    if not lines:
        return []
    return ["## 10 In the textbooks", "These equations have the same rows as this robot:", *items(lines)]


def citations(robot: Robot) -> list[Citation]:
    """Return every citation that holds for the robot.

    The result is [] if a wheel can slide along its rolling direction, because no wheel of the texts does. Robots with
    couplings occur in the texts only if all their wheels steer.
    """
    wheels = [w for w in robot.wheels if w.kind.constrains or w.kind.rolls_across]
    if not all(w.has_spin for w in wheels):
        return []
    rules = (_all_steered, _castors) if robot.couplings else _RULES
    return [c for rule in rules for c in rule(robot, wheels)]


def _driven(wheels: Wheels) -> bool:
    """Return whether every wheel is driven and measured, as `inverse` and `forward` of the texts assume."""
    return all("spin" in w.actuated and "spin" in w.sensed for w in wheels)


def _same(a: Exact, b: Exact) -> bool:
    return abs(float(a - b)) <= NEGLIGIBLE * max(1.0, abs(float(a)))


def _ahead(w: Wheel) -> bool:
    return _same(w.nominal.ch, ONE) and _same(w.nominal.sh, ZERO)


def _rows(wheels: Wheels) -> Rows:
    """Return the exact rows of J2^-1 J1: the spin of each wheel per twist."""
    rows = []
    for w in wheels:
        g = nominal_view(w)
        scale = g.rolling_radius.inverse()
        a, b, c = ((p * scale).constant for p in rolling_row(w, g).row)
        rows.append((a or ZERO, b or ZERO, c or ZERO))
    return tuple(rows)


def _alike(rows: Rows, expected: Rows) -> bool:
    return all(_same(a, b) for f, e in zip(rows, expected, strict=True) for a, b in zip(f, e, strict=True))


def _unicycle(robot: Robot, wheels: Wheels) -> list[Citation]:
    """Cite the unicycle: one fixed wheel, under P."""
    if len(wheels) != 1 or not wheels[0].kind.fixed_axle or not _ahead(wheels[0]):
        return []
    g = wheels[0].nominal
    if not _same(g.x, ZERO) or not _same(g.y, ZERO):
        return []
    return [
        Citation("Tzafestas (2.26)-(2.28)", "the posture model of the unicycle", {"r": g.r}),
        Citation("Siegwart (3.37)", "C1 of the single fixed wheel, rank 1", {"r": g.r}),
    ]


def _differential(robot: Robot, wheels: Wheels) -> list[Citation]:
    """Cite the differential drive: two fixed wheels on one axle, symmetric about the x axis."""
    if len(wheels) != 2 or any(not w.kind.fixed_axle or not _ahead(w) for w in wheels) or not _driven(wheels):
        return []
    pair = right, left = sorted(wheels, key=lambda w: float(w.nominal.y))
    a, b, r = left.nominal.y, left.nominal.x, left.nominal.r
    if not a or not _same(right.nominal.y, -a) or not _same(right.nominal.x, b):
        return []
    if not _alike(_rows(pair), ((ONE / r, ZERO, a / r), (ONE / r, ZERO, -a / r))):
        return []
    if b:
        what = "`inverse`, and the constraint with the offset b"
        return [Citation("Tzafestas Example 2.2", what, {"a": a, "b": b, "r": r}, pair)]
    return [
        Citation("Siegwart (3.29), (3.30)", "the stacked rows and `forward`", {"l": a, "r": r}, pair),
        Citation("Tzafestas (2.34)-(2.37), (2.41c)", "`forward` and `inverse`", {"a": a, "r": r}, pair),
        Citation("Kelly, differential steer", "`inverse` and `forward` in rim speeds", {"W": a}, pair),
    ]


def _locked_bicycle(robot: Robot, wheels: Wheels) -> list[Citation]:
    """Cite the bicycle with locked steering: two fixed wheels, one behind the other."""
    in_line = [
        w for w in wheels if w.kind.fixed_axle and _same(w.nominal.y, ZERO) and _same(w.nominal.sh, ZERO)
    ]
    if len(wheels) != 2 or len(in_line) != 2:
        return []
    l2, l1 = sorted((w.nominal.x for w in wheels), key=float)
    if _same(l1, l2):
        return []
    what = "C1f of rank 2: a holonomic robot on a line"
    return [Citation("Siegwart (3.39), 3.4.2", what, {"l1": l1, "l2": -l2})]


def car(robot: Robot, wheels: Wheels) -> list[Citation]:
    """Cite the car: fixed wheels on the axle through P, steered wheels in front."""
    fixed, steered = [w for w in wheels if w.kind.fixed_axle], [w for w in wheels if w.kind.steers]
    if not fixed or not steered or len(fixed) + len(steered) < len(wheels):
        return []
    if not all(_same(w.nominal.x, ZERO) and _ahead(w) for w in fixed):
        return []
    front, middle = steered[0].nominal.x, sum((w.nominal.y for w in steered), ZERO)
    if not all(_same(w.nominal.x, front) for w in steered):
        return []
    if not _same(middle, ZERO) or not front or any(w.nominal.o for w in steered):
        return []
    letters = {"D": front}
    if len(steered) > 1:
        what = "the constraints, with ψ the steering angle of a virtual wheel midway"
        return [
            Citation("Tzafestas (2.49)-(2.51)", what, letters),
            Citation("Kelly, Ackermann", "tan ψ = ω D / v<sub>x</sub>", letters),
        ]
    driven = "spin" in steered[0].actuated
    equations, end = ("(2.46), (2.56a)", "steered wheel") if driven else ("(2.52)-(2.55)", "fixed axle")
    return [
        Citation(f"Tzafestas {equations}", f"the posture model, {end} driven", letters),
        Citation("Tzafestas (2.51)", "the constraints", letters),
        Citation("Kelly, Ackermann", "`inverse` and `forward`: tan ψ = ω D / v<sub>x</sub>", letters),
    ]


def turning_circle(robot: Robot) -> list[str]:
    """Write the steering angle and the turning circle of a car (Tzafestas (2.49)-(2.51)).

    The result is [] unless the robot has a fixed axle through P and one or two steered wheels in front of it.
    """
    steered = [w for w in robot.wheels if w.kind.steers]
    wheels = [w for w in robot.wheels if w.kind.constrains or w.kind.rolls_across]
    if (
        len(steered) not in (1, 2)
        or robot.couplings
        or not car(robot, wheels)
        or any(w.heading for w in steered)
    ):
        return []
    right, left = (
        min(steered, key=lambda w: float(w.nominal.y)),
        max(steered, key=lambda w: float(w.nominal.y)),
    )
    psi_r, psi_l = (notation.port(f"{w.name}.steer") for w in (right, left))
    base, track = left.nominal.x, left.nominal.y - right.nominal.y
    written = latex(symbolic_view(left).x)
    taken = written != "L" and any(notation.parameter(p.name) == "L" for p in robot.parameters)
    letter, in_text = ("x_A", "x<sub>A</sub>") if taken else ("L", "L")
    length = " = ".join(dict.fromkeys([letter, written, plain(base)]))
    radius = rf"&= \frac{{\omega\,{letter}}}{{v_x}} = \frac{{{letter}}}{{R}}, \qquad {length}"
    words = "P moves on a circle of radius R, to the left if R > 0, with v<sub>x</sub> = ω R."
    behind = ""
    if base.sign < 0:
        behind = keyed("car.steers_behind", f" {in_text} is negative, because the steered wheel is behind P.")
    if len(steered) == 1:
        return [f"{words}{behind}", *aligned([rf"\tan{psi_l} {radius}"])]
    named = (symbolic_view(left).y - symbolic_view(right).y) * symbolic_view(left).x.inverse()
    equal = [
        r"\frac{\mathrm{track}}{\mathrm{wheelbase}}",
        *([latex(named)] if named.constant is None else []),
    ]
    ratio = " = ".join([*equal, notation.decimal(float(track / base))])
    return [
        keyed(
            "car.ackermann",
            f"{words} The axles of both steered wheels pass through its centre (Ackermann). ψ is the "
            f"angle of a virtual wheel midway between them.{behind}",
        ),
        *aligned([rf"\tan\psi {radius}", rf"\cot{psi_r} - \cot{psi_l} &= {ratio}"]),
    ]


def _omni(robot: Robot, wheels: Wheels) -> list[Citation]:
    """Cite the omnidirectional robot: omni wheels that drive along the tangents of a circle."""
    if len(wheels) < 3 or not _driven(wheels):
        return []
    if any(not w.kind.rolls_across or not _same(w.nominal.sg, ZERO) for w in wheels):
        return []
    r = wheels[0].nominal.r
    if not all(_same(w.nominal.x * w.nominal.ch + w.nominal.y * w.nominal.sh, ZERO) for w in wheels):
        return []
    radius, *others = (row[2] * w.nominal.r for row, w in zip(_rows(wheels), wheels, strict=True))
    if any(w.nominal.r != r for w in wheels) or not all(_same(other, radius) for other in others):
        return []
    if radius.sign > 0:
        letters = {"D": radius, "r": r}
        general = Citation("Tzafestas (2.72)", "`inverse` for any number of omni wheels", letters)
        return [general, *_ring(wheels, (0, 8, 16), "Tzafestas (2.73), (2.74)", letters)]
    letters = {"a": -radius, "r": r}
    return [
        Citation("Konstantinov (3), (4)", "`inverse`, φ<sub>i</sub> the polar angle of wheel i", letters),
        *_ring(wheels, (-2, 6, -10), "Siegwart (3.32)-(3.34)", {"l": -radius, "r": r}),
        *_ring(wheels, (-6, 2, 10), "Konstantinov (5)", letters),
    ]


def _ring(wheels: Wheels, twelfths: tuple[int, ...], equation: str, letters: Letters) -> list[Citation]:
    """Return a citation if three wheels have these headings, as multiples of pi/12, in any order."""
    order = []
    for k in twelfths:
        c, s = (p.constant for p in cos_sin(Poly.gen("pi") * Poly.of(k) * Poly.of(12).inverse()))
        order += [w for w in wheels if _same(w.nominal.ch, c or ZERO) and _same(w.nominal.sh, s or ZERO)]
    complete = len(wheels) == len(order) == len(twelfths)
    return [Citation(equation, "`inverse` and `forward`", letters, order)] if complete else []


def _mecanum(robot: Robot, wheels: Wheels) -> list[Citation]:
    """Cite the mecanum robot: four Swedish 45° wheels in a rectangle."""
    if len(wheels) != 4 or not _driven(wheels):
        return []
    if any(not w.kind.rollers or not _ahead(w) or not w.nominal.sg for w in wheels):
        return []
    ordered = sorted(wheels, key=lambda w: (w.nominal.x.sign < 0, w.nominal.y.sign * w.nominal.x.sign))
    front = ordered[0].nominal
    d1, d2, r = -front.y, front.x, front.r
    s = d1 + d2
    rows = ((ONE, ONE, s), (ONE, -ONE, -s), (ONE, ONE, -s), (ONE, -ONE, s))
    if not _alike(_rows(ordered), tuple((a / r, b / r, c / r) for a, b, c in rows)):
        return []
    what = "`inverse` and `forward`, turned to x forward"
    return [Citation("Tzafestas (2.82), (2.84)", what, {"d1": d1, "d2": d2, "R": r}, ordered)]


def _all_steered(robot: Robot, wheels: Wheels) -> list[Citation]:
    """Cite robots with steered wheels only, coupled or not."""
    if len(wheels) < 2 or any(not w.kind.steers for w in wheels):
        return []
    if robot.couplings:
        first = wheels[0].nominal
        parallel = all(_same(w.nominal.ch, first.ch) and _same(w.nominal.sh, first.sh) for w in wheels)
        turns = {(robot.spin_group[w.index], robot.per_turn(w, w.nominal)) for w in wheels}
        rolls = len(turns) == len({shaft for shaft, _ in turns})  # equally far, where one shaft turns them
        if not (parallel and rolls) or len(set(robot.steer_group)) > 1:
            return []
        return [Citation("Siegwart 3.3.3", "synchro drive: the chassis only translates", {})]
    box = Citation("Kelly Box 4.2", "rows H of the contact velocities and their least squares", {})
    offsets = {w.nominal.o for w in wheels if w.nominal.o}
    if len(wheels) != 4 or not offsets:
        return [box]
    what = "H and Q of four wheel steering with offset contacts"
    return [box, Citation("Kelly (4.62)", what, {"d": max(offsets, key=float)})]


def _castors(robot: Robot, wheels: Wheels) -> list[Citation]:
    """Cite powered castors; the robot may have other wheels."""
    powered = [w for w in robot.wheels if w.kind.swivels and "steer" in w.actuated]
    what = "both rates of a powered castor from the twist"
    return [Citation("Siegwart (3.17), (3.18)", what, {}, powered)] if powered else []


_RULES: tuple[Callable[[Robot, Wheels], list[Citation]], ...] = (
    _unicycle, _differential, _locked_bicycle, car, _omni, _mecanum, _all_steered, _castors,
)  # fmt: skip
