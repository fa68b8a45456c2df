"""What integrable constraints integrate to, for wheels that do not steer.

The admissible twists span a subalgebra g of se(2) when DDOF = DOF. One translation: the body moves along a line,
every wheel angle is its distance over r (Siegwart 3.4.2: phi = x/r + phi0). One rotation: a circle about a fixed
centre. Two translations: the heading is constant. In every case rolling integrates with it.
"""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.constraints import constrain, nominal_view, rolling_row
from wmrgen.exact.evaluate import fix
from wmrgen.exact.linalg import left_null_space
from wmrgen.exact.number import ZERO, Exact
from wmrgen.exact.poly import Row
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility

SMALL = 1e-12


@dataclass(frozen=True, slots=True)
class Integral:
    """sum of coefficients * quantities is constant along every motion.

    Quantities: ``x_body``, ``y_body``: components [m] in the robot frame of the way of P at constant heading;
    ``theta``; ``<wheel>.angle``.
    """

    coefficients: tuple[tuple[str, float], ...]
    text: str


def integrals(robot: Robot, mobility: Mobility) -> tuple[Integral, ...]:
    """Relations that the constraints integrate to; where steered wheels decide the motion, those of the pose alone."""
    twists = constant_twists(robot, mobility)
    if twists is None:  # a subalgebra of se(2) of dimension 2 is that of the translations
        return (Integral((("theta", 1.0),), "theta = const"),) if mobility.dof == 2 else ()
    if mobility.dof == 3:
        return _combinations(robot)
    return (*_posture(twists), *_rolled(robot, twists))


def constant_twists(robot: Robot, mobility: Mobility) -> list[tuple[Exact, ...]] | None:
    """Columns of the null space as numbers; None where they turn with an angle."""
    values = {p.name: p.value for p in robot.parameters}
    found = []
    for column in mobility.null_space:
        numbers = tuple(fix(p, values).constant for p in column)
        if any(n is None for n in numbers):
            return None
        found.append(tuple(n for n in numbers if n is not None))
    return found


def _posture(twists: list[tuple[Exact, ...]]) -> tuple[Integral, ...]:
    """theta and the way across, or the centre of the circle."""
    if not twists:
        return (Integral((("x_body", 1.0),), "x, y and theta are constant: the robot cannot move"),)
    fixed = Integral((("theta", 1.0),), "theta = const")
    if len(twists) == 2:
        return (fixed,)
    vx, vy, omega = (float(v) for v in twists[0])
    if abs(omega) > SMALL:
        centre = f"({-vy / omega:.6g}, {vx / omega:.6g})"
        return (
            Integral(
                (), f"the body turns about the point {centre} of the robot frame, which stays where it is"
            ),
        )
    across = tuple((k, v) for k, v in (("x_body", -vy), ("y_body", vx)) if abs(v) > SMALL)
    return fixed, Integral(across, f"{_sum(across)} = const: the body can only translate along a line")


def _rolled(robot: Robot, twists: list[tuple[Exact, ...]]) -> tuple[Integral, ...]:
    """Wheel angles as linear functions of the way, or of theta on a circle."""
    found = []
    way: tuple[tuple[str, float], ...]
    for w in rolling_wheels(robot):
        row, radius = _numbers(rolling_row(w, nominal_view(w)).row), w.nominal.rolling_radius
        if len(twists) == 1 and abs(float(twists[0][2])) > SMALL:
            rate = sum((a * b for a, b in zip(row, twists[0], strict=True)), ZERO) / twists[0][2]
            way = (("theta", float(rate / radius)),)
        else:
            way = tuple((k, float(c / radius)) for k, c in zip(("x_body", "y_body"), row, strict=False))
            way = _reachable(way, twists)
        way = tuple((k, c) for k, c in way if abs(c) > SMALL)
        coefficients = ((f"{w.name}.angle", -1.0), *way)
        found.append(Integral(coefficients, f"{w.name}.angle = {_sum(way)} + const"))
    return tuple(found)


def _reachable(
    way: tuple[tuple[str, float], ...], twists: list[tuple[Exact, ...]]
) -> tuple[tuple[str, float], ...]:
    """The gradient without what is across the only line."""
    if len(twists) != 1:
        return way
    vx, vy, _ = (float(v) for v in twists[0])
    (_, a), (_, b) = way
    share = (a * vx + b * vy) / (vx * vx + vy * vy)
    return ("x_body", share * vx), ("y_body", share * vy)


def _combinations(robot: Robot) -> tuple[Integral, ...]:
    """Sums of wheel angles that depend on the heading alone, or on nothing."""
    wheels = rolling_wheels(robot)
    c = constrain(robot, nominal_view)
    rows = [_numbers(rolling_row(w, nominal_view(w)).row) for w in wheels]
    rows += [_numbers(r.row) for r in c.sliding_fixed]
    if not wheels:
        return ()
    found = []
    for weights in left_null_space([row[:2] for row in rows]):
        turn = sum((k * row[2] for k, row in zip(weights, rows, strict=True)), ZERO)
        angles = [
            (f"{w.name}.angle", float(k * w.nominal.rolling_radius))
            for w, k in zip(wheels, weights, strict=False)
            if k
        ]
        if not angles:
            continue
        scale = float(turn) if abs(float(turn)) > SMALL else angles[0][1]
        terms = tuple((name, value / scale) for name, value in angles)
        if abs(float(turn)) > SMALL:
            found.append(Integral((("theta", -1.0), *terms), f"theta = {_sum(terms)} + const"))
        else:
            found.append(Integral(terms, f"{_sum(terms)} = const"))
    return tuple(found)


def rolling_wheels(robot: Robot) -> list[Wheel]:
    """Wheels whose rolling row is constant."""
    return [w for w in robot.wheels if w.has_spin and not w.turns]


def _numbers(row: Row) -> tuple[Exact, Exact, Exact]:
    a, b, k = (p.constant or ZERO for p in row)
    return a, b, k


def _sum(terms: tuple[tuple[str, float], ...]) -> str:
    """2*x + 0.5*y, with signs."""
    said = ""
    for name, c in terms:
        size = "" if abs(abs(c) - 1) < SMALL else f"{abs(c):.6g} "
        said += (f" {'-' if c < 0 else '+'} " if said else "-" if c < 0 else "") + size + name
    return said or "0"
