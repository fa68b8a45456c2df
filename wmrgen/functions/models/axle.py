"""The axle of a robot's fixed wheels: it drives (v, 0, omega), leads trailers and is steered onto a path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.polynomials import without_rounding
from wmrgen.geometry.constraints import View
from wmrgen.geometry.exact.linalg import mean
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Geometry, Robot, Wheel
from wmrgen.geometry.symbolic import Expr, add, expression, rotated, subtract, times

Vector = tuple[Expr, Expr]


class Axle(NamedTuple):
    """The axle about which the body turns, in the robot frame."""

    ex: Poly  # unit direction of travel e
    ey: Poly  # unit direction of travel e
    x: Poly  # a point Q on the axle [m]
    y: Poly  # a point Q on the axle [m]

    @property
    def direction(self) -> Vector:
        """Return e as expressions."""
        return expression(self.ex), expression(self.ey)

    @property
    def centre(self) -> Vector:
        """Return Q as expressions [m]."""
        return expression(self.x), expression(self.y)

    @property
    def nominal(self) -> tuple[float, float, float, float]:
        """Return ex, ey, x, y as numbers. The axle must come from a `nominal_view`."""
        ex, ey, x, y = (float(p.constant or 0) for p in (self.ex, self.ey, self.x, self.y))
        return ex, ey, x, y

    def coupling(self, hitch: Poly) -> Vector:
        """Return the point that is ``hitch`` [m] behind Q."""
        return expression(self.x - self.ex * hitch), expression(self.y - self.ey * hitch)

    def seen(self, g: Geometry[Poly]) -> tuple[Poly, Poly]:
        """Return the position of a pivot from Q, along e and to its left [m]."""
        dx, dy = g.x - self.x, g.y - self.y
        return self.ex * dx + self.ey * dy, self.ex * dy - self.ey * dx

    def turned(self, c: Expr, s: Expr) -> Vector:
        """Return cosine and sine of the axle's heading from cosine and sine of the robot's heading."""
        return rotated(c, s, *self.direction)

    def velocity_of_p(self, v: Expr, omega: Expr) -> Vector:
        """Return vx, vy of P for the speed of Q along e and the yaw rate: v e - omega z x Q."""
        (ex, ey), (x, y) = self.direction, self.centre
        return add(times(ex, v), times(y, omega)), subtract(times(ey, v), times(x, omega))


THROUGH_P = Axle(Poly.of(1), Poly({}), Poly({}), Poly({}))  # for robots without fixed wheels


def axle_of(fixed: Sequence[Wheel], view: View) -> Axle:
    """Return the mean of fixed wheels and their direction, pointing forward, or to the left if exactly sideways."""
    views = [view(w) for w in fixed]
    (x,) = without_rounding(mean([g.x for g in views]))
    (y,) = without_rounding(mean([g.y for g in views]))
    lead = fixed[0].nominal
    ahead = lead.ch if abs(float(lead.ch)) > 1e-9 else lead.sh
    sign = 1 if float(ahead) > 0 else -1
    return Axle(views[0].ch.scale(sign), views[0].sh.scale(sign), x, y)


def fixed_axle(robot: Robot, mobility: Mobility, view: View) -> Axle | None:
    """Return the axle of the fixed wheels, with Q at their centre.

    Args:
        robot: The robot.
        mobility: Its mobility.
        view: Which parameters are symbols.

    Returns:
        The axle; None if the fixed wheels have no common axle line.
    """
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    return axle_of(fixed, view) if fixed and mobility.rank_C1f.value == 1 else None


def leading_axle(robot: Robot, mobility: Mobility, view: View) -> Axle:
    """Return the axle that leads trailers.

    Args:
        robot: The robot.
        mobility: Its mobility.
        view: Which parameters are symbols.

    Returns:
        The fixed axle; if there is none, P with the direction of x.
    """
    return fixed_axle(robot, mobility, view) or THROUGH_P
