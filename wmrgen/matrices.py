"""The matrices of a robot's constraints for readers: sympy, every named parameter a symbol."""

from __future__ import annotations

from collections.abc import Iterable

import sympy

from wmrgen.constraints import ConstraintRow, Constraints, pfaffian
from wmrgen.symbolic import expression, matrix


def of_twist(rows: Iterable[ConstraintRow]) -> sympy.Matrix:
    """The rows over (vx, vy, omega), as many x 3."""
    return matrix([r.row for r in rows], 3)


def radii(constraints: Constraints) -> sympy.Matrix:
    """Diagonal of r cos gamma [m], one entry per rolling row."""
    return sympy.diag(*(expression(-dict(r.rates)[r.wheel.index, "spin"]) for r in constraints.rolling))


def pfaffian_matrix(constraints: Constraints) -> sympy.Matrix:
    """One row per constraint, columns as `pfaffian_rates` names them."""
    slip = constraints.robot.slip
    return matrix(pfaffian(constraints, slip), len(pfaffian_rates(constraints)))


def pfaffian_rates(constraints: Constraints) -> tuple[str, ...]:
    """Names of the columns: the twist, the joint rates and, where wheels slip, their slips."""
    robot = constraints.robot
    rates = (
        f"{robot.wheels[i].name}.{'spin' if joint == 'spin' else 'steer_rate'}"
        for i, joint in constraints.joints
    )
    slipping = (*constraints.rolling, *constraints.sliding) if robot.slip else ()
    slips = (f"{c.wheel.name}.slip_{'x' if c.kind == 'rolling' else 'y'}" for c in slipping)
    return ("vx", "vy", "omega", *rates, *slips)
