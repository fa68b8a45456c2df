"""Relations between driven wheel speeds: their compatibility rows, and the velocity augmentation factor.

If more wheels drive than the robot has freedoms, w . spin = 0 for every motion, with w in the left null space of J2^-1
J1 on the admissible twists: theta1 + theta2 = theta3 + theta4 for a mecanum base (Tzafestas (2.84)).

The velocity augmentation factor is the speed of the robot over the largest rim speed of its wheels (Tzafestas 2.4.1):

    VAF(direction) = 1 / max_i |e_i . direction| / cos gamma_i

Here e_i is the rolling row of driven wheel i, and gamma belongs to its rollers. The translations that keep every rim
within 1 m/s form a polygon. VAF is its extent in a direction, largest at a corner and smallest across an edge.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import sympy

from wmrgen.analysis.kinematics.least_squares import NEGLIGIBLE, ratio_of
from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, signal_poly, tunable_ports
from wmrgen.analysis.mobility.basis import IDENTITY, primitive
from wmrgen.analysis.mobility.ranks import generic, independent, nominal_at, numeric_rank, to_array, unit_rows
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.polynomials import angles_in, without_rounding
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import (
    View,
    driving_row,
    nominal_view,
    rolling_row,
    symbolic_view,
    working_view,
)
from wmrgen.geometry.exact.linalg import determinant
from wmrgen.geometry.exact.number import ZERO
from wmrgen.geometry.exact.poly import Poly, dot
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import Port, Role, output
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    expression,
    matrix,
    maximum,
    over,
    signal,
    times,
)

Relation = tuple[Poly, ...]  # one entry per driven wheel


def _driven(robot: Robot) -> list[Wheel]:
    """Return the wheels with a driven spin."""
    return [w for w in robot.wheels if "spin" in w.actuated]


def relations(robot: Robot, mobility: Mobility, view: View = working_view) -> list[Relation]:
    """Return the independent rows w with w . spin = 0 of the driven wheels, at constant steering angles.

    A degenerate robot (skid-steer) may drive every twist, as in its inverse.

    Args:
        robot: The robot.
        mobility: Its mobility.
        view: Which parameters are symbols.

    Returns:
        Rows with one entry per driven wheel.
    """
    driven = _driven(robot)
    columns = mobility.null_space_symbolic if view is symbolic_view else mobility.null_space
    if mobility.degenerate:
        columns = IDENTITY
    if not driven or not columns:
        return []
    rims = []  # for each driven wheel, its rim speed along each column
    for w in driven:
        row = driving_row(w, view(w))
        rims.append(tuple(dot(row, column) for column in columns))
    numbers, angles = np.zeros((len(driven), 3)), generic(robot)
    numbers[:, : len(columns)] = [[nominal_at(p, robot, angles) for p in row] for row in rims]
    numbers = unit_rows(numbers)
    rows = independent(numbers, numeric_rank(numbers)[0])
    keep = independent(np.pad(numbers[rows].T, ((0, 0), (0, 3 - len(rows)))), len(rows)) if rows else []
    radii = [view(w).rolling_radius for w in driven]
    result = []
    for other in (i for i in range(len(driven)) if i not in rows):
        entries = dict(
            zip((*rows, other), _relation([rims[i] for i in rows], rims[other], keep), strict=True)
        )
        result.append(_readable([entries.get(i, Poly({})) * radius for i, radius in enumerate(radii)]))
    return result


def relation_matrix(robot: Robot, mobility: Mobility) -> sympy.Matrix:
    """Return the rows w, one column per driven wheel, with every named parameter as a symbol."""
    return matrix(relations(robot, mobility, symbolic_view), len(_driven(robot)))


def _relation(basis: Sequence[tuple[Poly, ...]], other: tuple[Poly, ...], keep: Sequence[int]) -> list[Poly]:
    """Return coefficients, by Cramer's rule, of the basis rows and another row, so that their sum is 0."""
    square = [[row[k] for k in keep] for row in basis]
    last = [other[k] for k in keep]
    replaced = ([*square[:k], last, *square[k + 1 :]] for k in range(len(square)))
    return [*(-determinant(m) for m in replaced), determinant(square)]


def _readable(row: Sequence[Poly]) -> Relation:
    """Return the row without rounding errors and common factors, with leading coefficient 1."""
    kept = without_rounding(*row)
    first = next(p for p in kept if p)
    ratios = [ratio_of(p, first, NEGLIGIBLE) if p else ZERO for p in kept]
    known = [Poly.of(ratio) for ratio in ratios if ratio is not None]
    return tuple(known) if len(known) == len(kept) else primitive(kept)


@function("Tzafestas (2.84), the relation of its rows")
def compatibility(robot: Robot, mobility: Mobility) -> Formula:
    """Return the residual of each compatibility row for wheel speeds: 0 if the speeds are consistent."""
    driven, rows = _driven(robot), relations(robot, mobility)
    if not rows:
        raise underivable(
            robot,
            "compatibility rows",
            f"the driven wheel speeds are independent (driven: {', '.join(w.name for w in driven) or 'none'})",
        )
    spins = [signal_poly(f"{w.name}.spin") for w in driven]
    outputs = []
    for k, row in enumerate(rows, 1):
        port = output(f"residual{k}", "rad/s", f"compatibility row {k} times the wheel speeds")
        outputs.append((port, expression(Poly.sum(a * b for a, b in zip(row, spins, strict=True)))))
    steered = angles_in(tuple(p for row in rows for p in row))
    steers = [joint_port(w, "steer", Role.STATE) for w in robot.wheels if w.name in steered]
    inputs = (*(joint_port(w, "spin", Role.COMMAND) for w in driven), *steers, *tunable_ports(robot))
    text = "residuals of the wheel speeds of an over-actuated robot, at constant steering angles"
    return Formula("compatibility", inputs, (), tuple(outputs), text)


def _rim(w: Wheel, view: View) -> tuple[Poly, Poly]:
    """Return the rim speed per velocity along x and y."""
    g = view(w)
    row, over_cg = rolling_row(w, g).row, g.cg.inverse()
    return row[0] * over_cg, row[1] * over_cg


def _require_translations(robot: Robot, mobility: Mobility) -> None:
    """Raise NotDerivableError if the rim speeds do not determine every translation by constant rows."""
    if mobility.degree_of_mobility != 3:
        why = f"it cannot translate in every direction (mobility {mobility.degree_of_mobility}, not 3)"
        raise underivable(robot, "vaf", why, Reason.MOBILITY)
    driven = _driven(robot)
    for w in driven:
        if w.turns:
            raise underivable(
                robot, "vaf", f"the rim speed of {w.name} changes with its steering angle", Reason.AXLES
            )
    rims = [[p.constant or ZERO for p in _rim(w, nominal_view)] for w in driven]
    if numeric_rank(to_array([[*rim, ZERO] for rim in rims]))[0] < 2:
        raise underivable(
            robot, "vaf", "in one direction it can move without turning a driven wheel", Reason.NOT_DRIVEN
        )


@function("Tzafestas 2.4.1, (2.71)")
def vaf(robot: Robot, mobility: Mobility) -> Formula:
    """Return the velocity augmentation factor for the direction of a translation in the robot frame."""
    _require_translations(robot, mobility)
    names = Locals()
    c = names.define("cos_direction", sympy.cos(signal("direction")))
    s = names.define("sin_direction", sympy.sin(signal("direction")))
    largest: Expr = sympy.Rational(1, 10**9)
    for w in _driven(robot):
        a, b = _rim(w, working_view)
        speed = names.define(f"{w.name}_rim", add(times(expression(a), c), times(expression(b), s)))
        largest = maximum(absolute(speed), largest)
    direction = Port("direction", Role.COMMAND, "rad", "direction of motion, from x of the robot")
    port = output("vaf", "", "speed of P over the largest rim speed of a driven wheel")
    return names.formula(
        "vaf",
        (direction, *tunable_ports(robot)),
        ((port, over(sympy.S.One, largest)),),
        "velocity augmentation factor of a translation",
    )
