"""What a layout allows: constraints, mobility, the matrices of the texts; each computed when first asked for."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING

import sympy

from wmrgen.analysis.kinematics.forward import nominal_rank
from wmrgen.analysis.kinematics.least_squares import Measured
from wmrgen.analysis.kinematics.sensing import Measurements, measurements
from wmrgen.analysis.mobility import Mobility, analyse
from wmrgen.analysis.mobility.analyse import driving
from wmrgen.geometry.constraints import (
    ConstraintRow,
    Constraints,
    constrain,
    nominal_view,
    pfaffian,
    pfaffian_rates,
    seen,
    symbolic_view,
)  # fmt: skip
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.symbolic import expression, matrix

if TYPE_CHECKING:
    from wmrgen.functions.models.frobenius import Integrability
    from wmrgen.functions.models.growth import Growth


class Analysis:
    """The matrices (J1, J2, C1f, C1s, pfaffian, null_space) keep named parameters as symbols."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    @cached_property
    def constraints(self) -> Constraints:
        """All rows, parameters as symbols."""
        return constrain(self.robot, symbolic_view)

    @cached_property
    def mobility(self) -> Mobility:
        """Degrees, ranks and reasons. NotDerivableError for trailers or virtual wheels that the layout cannot have."""
        mobility = analyse(self.robot)
        if self.robot.trailers or self.robot.virtual:
            from wmrgen.functions.models.virtual import check_virtual
            from wmrgen.functions.trailers.trailer import check_trailers

            check_virtual(self.robot, mobility)
            check_trailers(*driving(self.robot, mobility))
        return mobility

    @cached_property
    def measured(self) -> Measurements:
        """What the sensed joints measure, parameters as symbols."""
        return measurements(seen(self.robot, symbolic_view))

    @cached_property
    def measured_at_nominal(self) -> list[Measured]:
        """The rows of `measured` at nominal values."""
        return measurements(seen(self.robot, nominal_view)).rows

    @cached_property
    def determined(self) -> bool:
        """Whether `measured_at_nominal` gives the whole twist."""
        return nominal_rank(self.measured_at_nominal, self.robot).value == 3

    @cached_property
    def integrability(self) -> Integrability:
        """Frobenius's test of each constraint, of all together, and what they integrate to."""
        from wmrgen.functions.models.frobenius import integrability

        return integrability(self.robot, self.mobility)

    @cached_property
    def growth(self) -> Growth:
        """Vector fields, Lie brackets and growth vector of the posture model, with trailers where there are some."""
        from wmrgen.functions.models.growth import robot_growth

        return robot_growth(self.robot, self.mobility)

    # Matrices.

    @property
    def J1(self) -> sympy.Matrix:
        """Rolling rows, (number of rolling wheels) x 3: J1 xi = J2 spin (Siegwart (3.24))."""
        return _of_twist(self.constraints.rolling)

    @property
    def J2(self) -> sympy.Matrix:
        """Diagonal of r cos gamma [m] (Siegwart (3.24))."""
        rolling = self.constraints.rolling
        return sympy.diag(*(expression(-dict(r.rates)[r.wheel.index, "spin"]) for r in rolling))

    @property
    def C1f(self) -> sympy.Matrix:
        """Sliding rows of fixed wheels, N x 3 (Siegwart (3.26))."""
        return _of_twist(self.constraints.sliding_fixed)

    @property
    def C1s(self) -> sympy.Matrix:
        """Sliding rows of steered wheels, N x 3 (Siegwart (3.26))."""
        return _of_twist(self.constraints.sliding_steered)

    @property
    def C1(self) -> sympy.Matrix:
        """Sliding rows of all wheels that constrain the robot: C1f above C1s (Siegwart (3.26))."""
        return sympy.Matrix.vstack(self.C1f, self.C1s)

    @property
    def pfaffian(self) -> sympy.Matrix:
        """A with A (vx, vy, omega, joint rates) = 0; joints in the order of `pfaffian_rates`.

        With ``slip: true``, e . v + slip_x = r spin in rolling rows and n . v = slip_y in sliding rows.
        """
        rows = pfaffian(self.constraints, self.robot.slip)
        return matrix(rows, len(self.pfaffian_rates))

    @property
    def pfaffian_rates(self) -> tuple[str, ...]:
        """Names of the Pfaffian matrix's columns."""
        return pfaffian_rates(self.constraints)

    @property
    def H(self) -> sympy.Matrix:
        """2N x 3: velocities of all contact points per twist, v_c = H xi + Q steer_rate (Kelly Box 4.2, (4.62))."""
        from wmrgen.functions.motion.velocities import twist_matrix

        return twist_matrix(self.robot)

    @property
    def Q(self) -> sympy.Matrix:
        """2N x M: velocities of all contact points per steering rate of the M wheels that turn, in wheel order."""
        from wmrgen.functions.motion.velocities import steering_matrix

        return steering_matrix(self.robot)

    @property
    def compatibility(self) -> sympy.Matrix:
        """Rows w with w . spin = 0, one column per driven wheel: left null space of J2^-1 J1 (Tzafestas (2.84))."""
        from wmrgen.functions.motion.wheel_speeds import relation_matrix

        return relation_matrix(self.robot, self.mobility)

    @property
    def null_space(self) -> sympy.Matrix:
        """3 x delta_m: columns span the admissible twists at steering angles that meet in one ICR, scaled so that their
        coordinates eta are speeds (`mobility.basis.scaled`)."""
        return matrix(self.mobility.scaled_symbolic, 3).T


def _of_twist(rows: Iterable[ConstraintRow]) -> sympy.Matrix:
    """Rows over (vx, vy, omega), as many x 3."""
    return matrix([r.row for r in rows], 3)
