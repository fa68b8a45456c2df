"""The axle that a body turns about: what a differential drive and a car have in common.

A fixed axle leaves two motions, along its heading and about a point of its line. Q is the centre of the fixed
wheels on it, where trailers are coupled too; e is the direction of travel. With v the speed of Q along e,

    d/dt Q = v e,    omega = kappa v for a steered wheel,    kappa(beta) = sin h / (X cos h + Y sin h),

(X, Y) the pivot and h the heading of the steered wheel, both seen from the axle. Tzafestas (2.26), (2.55).
"""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.constraints import symbolic_view, working_view
from wmrgen.errors import NotDerivableError
from wmrgen.exact.evaluate import sqrt_poly
from wmrgen.exact.poly import Poly, Row
from wmrgen.functions.models.frame import constant_rows, fixed, nominal_at, straight
from wmrgen.functions.models.virtual import steering_frame
from wmrgen.functions.trailers.trailer import body_of
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility

SMALL = 1e-9


@dataclass(frozen=True, slots=True)
class Steering:
    """The steered wheel that sets the curvature. (x, y): pivot, (ch, sh): zero heading, in the axle's frame."""

    name: str
    x: Poly
    y: Poly
    ch: Poly
    sh: Poly


@dataclass(frozen=True, slots=True)
class Axle:
    """``ex, ey``: unit direction of travel e. ``x, y`` [m]: the point Q. Robot frame. ``steering``: None for (2, 0)."""

    ex: Poly
    ey: Poly
    x: Poly
    y: Poly
    steering: Steering | None


def body_axle(robot: Robot, mobility: Mobility, what: str, symbolic: bool = False) -> Axle:
    """The fixed axle of a (2, 0) or (1, 1) body. NotDerivableError, saying what is missing, for any other.

    ``what`` needs it: the beginning of the message. ``symbolic``: named parameters stay symbols.
    """
    if mobility.robot_type not in ((2, 0), (1, 1)):
        raise NotDerivableError(
            f"{robot.name}: {what} is known for the types (2, 0) and (1, 1); {_type(mobility)}"
        )
    rows = constant_rows(robot, mobility)
    if len(rows) != 1 or any(g.kind in ("cos", "sin") for p in rows[0] for g in p.generators):
        raise NotDerivableError(
            f"{robot.name}: {what} is built on a fixed axle, and this robot of type (1, 1) has none: no fixed wheel "
            "constrains it"
        )
    if mobility.dof < 3:
        raise NotDerivableError(
            f"{robot.name}: {what} needs a robot that can turn; this one only translates (DOF {mobility.dof})"
        )
    body = body_of(robot, mobility, symbolic_view if symbolic else working_view)
    if body.axle:
        ex, ey, x, y = body.fx, body.fy, body.x, body.y
    else:
        ex, ey, x, y = _foot(robot, rows[0] if symbolic else fixed(rows[0], robot))
    turning = mobility.degree_of_steerability > 0
    return Axle(ex, ey, x, y, _steering(robot, mobility, (ex, ey, x, y), symbolic) if turning else None)


def _foot(robot: Robot, row: Row) -> tuple[Poly, Poly, Poly, Poly]:
    """The axle of a row that no single wheel gives: its direction of travel, its point nearest to P."""
    nx, ny, k = row
    squared = nx * nx + ny * ny
    sign = _sign(robot, ny, -nx)
    scale = Poly.of(sign) if squared == 1 else sqrt_poly(squared).inverse().scale(sign)
    ex, ey, at = ny * scale, -nx * scale, k * scale
    return ex, ey, at * ex, at * ey


def _type(mobility: Mobility) -> str:
    if mobility.degenerate:
        return f"this robot is degenerate (degree of mobility {mobility.degree_of_mobility})"
    if mobility.degree_of_mobility == 3:
        return "this one is omnidirectional, type (3, 0): its pose is free, so there is nothing to chain"
    return f"this one is of type {mobility.robot_type}"


def _sign(robot: Robot, ex: Poly, ey: Poly) -> int:
    """+1 where (ex, ey) points forward, or left when it has no forward part."""
    x, y = nominal_at(ex, robot, straight), nominal_at(ey, robot, straight)
    return 1 if (x if abs(x) > SMALL else y) > 0 else -1


def _steering(
    robot: Robot, mobility: Mobility, axle: tuple[Poly, Poly, Poly, Poly], symbolic: bool
) -> Steering:
    """The wheel whose angle is the steering coordinate, virtual where the file names one, seen from the axle."""
    wheel: Wheel = steering_frame(robot, mobility, symbolic).wheels[0]
    g = wheel.symbolic if symbolic else wheel.working
    ex, ey, x, y = axle
    dx, dy = g.x - x, g.y - y
    return Steering(
        name=wheel.name, x=ex * dx + ey * dy, y=ex * dy - ey * dx,
        ch=ex * g.ch + ey * g.sh, sh=ex * g.sh - ey * g.ch,
    )  # fmt: skip
