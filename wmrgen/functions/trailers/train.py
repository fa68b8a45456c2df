"""A robot with a fixed axle as the tractor of a train: its axle, state, curvature, and the path of the last axle.

A fixed axle allows two motions, along its heading and about a point of its line. A differential drive and a car have
this in common. Q is the centre of the fixed wheels on it, where trailers are coupled too, and e is the direction of
travel. With v the speed of Q along e,

    d/dt Q = v e,    omega = kappa v for a steered wheel,    kappa(beta) = sin h / (X cos h + Y sin h),

where (X, Y) is the pivot and h the heading of the steered wheel, both seen from the axle. Tzafestas (2.26), (2.55).
"""

from __future__ import annotations

from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Locals
from wmrgen.analysis.mobility.analyse import fixed
from wmrgen.analysis.mobility.ranks import nominal_at, straight
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.axle import Axle, Vector, fixed_axle
from wmrgen.functions.models.frame import constant_rows
from wmrgen.functions.models.virtual import steering_frame
from wmrgen.functions.registry import Reason, UnderivableError
from wmrgen.functions.system import Gate
from wmrgen.functions.trailers.series import NARROW, Link, Path, path
from wmrgen.functions.trailers.trailer import behind, check_trailers, in_view, state_ports
from wmrgen.geometry.constraints import symbolic_view, working_view
from wmrgen.geometry.exact.evaluate import sqrt_poly
from wmrgen.geometry.exact.poly import Poly, Row, has_angles
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import POSE, TWIST, Port, Role, output
from wmrgen.geometry.symbolic import Expr, add, expression, rotated, signal, subtract, times

SMALL = 1e-9  # a smaller component of a direction is treated as 0
V = output("v", "m/s", "speed of the centre of the axle, along the direction of travel")
OMEGA = TWIST[2]


class Steering(NamedTuple):
    """The steered wheel that sets the curvature, in the axle's frame."""

    name: str
    x: Poly  # pivot [m]
    y: Poly  # pivot [m]
    ch: Poly  # cosine of the zero heading
    sh: Poly  # sine of the zero heading


class Train(NamedTuple):
    """The robot seen from its axle, with its trailers."""

    robot: Robot
    axle: Axle
    steering: Steering | None  # None for type (2, 0)
    symbolic: bool  # whether all parameters are symbols

    @property
    def size(self) -> int:
        """Return the number of states: pose, steering, a heading for each trailer."""
        return 3 + len(self.robot.trailers) + (self.steering is not None)

    @property
    def steering_port(self) -> Port | None:
        """Return the steering angle among the states; None for type (2, 0)."""
        s = self.steering
        return None if s is None else Port(f"{s.name}.steer", Role.STATE, "rad", "steering angle")

    @property
    def state(self) -> tuple[Port, ...]:
        """Return x y theta, steering, and headings of the trailers in the world frame."""
        steer = () if self.steering_port is None else (self.steering_port,)
        return (*POSE, *steer, *state_ports(self.robot.trailers))

    @property
    def turning(self) -> Port:
        """Return the second of the robot's own inputs: yaw rate, or steering rate."""
        if self.steering_port is None:
            return OMEGA
        return output(f"{self.steering_port.name}_rate", "rad/s", "steering rate, counter-clockwise")

    @property
    def by_heading(self) -> bool:
        """Return whether z1 is the heading."""
        return self.steering is None and not self.robot.trailers


def train(robot: Robot, mobility: Mobility, symbolic: bool = False, what: str = "the chained form") -> Train:
    """Return the robot as a tractor with trailers.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.
        what: The form that needs it, for messages.

    Raises:
        NotDerivableError: If the construction does not exist for this robot.
    """
    check_trailers(robot, mobility)
    axle = _axle(robot, mobility, what, symbolic)
    off = [t for t in robot.trailers if t.hitch.nominal]
    if len(off) > 1:
        raise UnderivableError(
            f"{robot.name}: {what} is not known for more than one trailer coupled off the axle "
            f"({', '.join(t.name for t in off)}): such trains are not flat in general (Rouchon, Fliess, Levine, Martin "
            "1993). `hitch: 0` couples a trailer on the axle in front, for which it exists",
            Reason.HITCH,
        )
    if off:
        raise UnderivableError(
            f"{robot.name}: {off[0].name} is coupled {float(off[0].hitch.nominal):.6g} m off the axle, and {what} is "
            "built on the last axle, which needs trailers coupled on the axle (hitch: 0). A train with one trailer "
            "coupled off the axle is flat with another output, which is not derived here",
            Reason.HITCH,
        )
    steering = _steering(robot, mobility, axle, symbolic) if mobility.degree_of_steerability else None
    return Train(robot, axle, steering, symbolic)


class TrainTerms(NamedTuple):
    """A train with its axle's direction, position, curvature and path as expressions."""

    train: Train
    names: Locals
    cosine: Expr  # of the tractor's heading
    sine: Expr
    x: Expr  # of the last axle
    y: Expr
    curvature: Expr | None
    leverage: Expr  # dkappa/dbeta, or 1
    inverse_leverage: Expr  # dbeta/dkappa, or 1
    path: Path | None  # None where z1 is the heading


def terms_of(t: Train) -> TrainTerms:
    """Return the expressions that the functions of a train share."""
    names, axle = Locals(), t.axle
    c, s = axle.turned(sympy.cos(signal("theta")), sympy.sin(signal("theta")))
    if t.by_heading:
        c, s = names.define("axle_cosine", c), names.define("axle_sine", s)
    curvature: Expr | None = None
    leverage = inverse_leverage = sympy.S.One
    if t.steering is not None:
        curvature, leverage, inverse_leverage = curvature_of(t.steering, names)
    x, y = last_axle(t)
    x, y = names.define("last_x", x), names.define("last_y", y)
    driven = None if t.by_heading else path(names, links_of(t), curvature)
    return TrainTerms(t, names, c, s, x, y, curvature, leverage, inverse_leverage, driven)


def last_axle(t: Train) -> Vector:
    """Return the position of the centre of the last axle, world frame [m]."""
    theta = signal("theta")
    x, y = rotated(sympy.cos(theta), sympy.sin(theta), *t.axle.centre)
    point: Vector = add(signal("x"), x), add(signal("y"), y)
    for trailer in t.robot.trailers:
        point = behind(point, in_view(trailer.length, t.symbolic), signal(f"{trailer.name}.theta"))
    return point


def curvature_of(s: Steering, names: Locals) -> tuple[Expr, Expr, Expr]:
    """Return kappa [1/m] of the axle's path, dkappa/dbeta and dbeta/dkappa, with beta the steering angle."""
    beta = signal(f"{s.name}.steer")
    c, n = sympy.cos(beta), sympy.sin(beta)
    along, across = rotated(c, n, expression(s.ch), expression(s.sh))
    cosine, sine = names.define("steer_cosine", along), names.define("steer_sine", across)
    inverse = s.x.inverse()
    divisor = names.define("steer_divisor", add(cosine, times(expression(s.y * inverse), sine)))
    over = Gate(divisor, NARROW).inverse(names, divisor, "steer_divisor_kept", "steer_over")
    kappa = names.define("kappa", times(expression(inverse), sine, over))
    leverage = times(expression(inverse), over, over)
    return kappa, leverage, times(expression(s.x), divisor, divisor)


def links_of(t: Train) -> list[Link]:
    """Return the last heading, then the hitch angles from the last to the first."""
    theta = signal("theta")
    headings = [signal(f"{trailer.name}.theta") for trailer in t.robot.trailers]
    if not headings:
        c, s = t.axle.turned(sympy.cos(theta), sympy.sin(theta))
        return [Link("last", c, s, sympy.S.One)]
    last = headings[-1]
    links = [Link("last", sympy.cos(last), sympy.sin(last), sympy.S.One)]
    for k in reversed(range(len(headings))):
        d = subtract(headings[k - 1] if k else theta, headings[k])
        c, s = sympy.cos(d), sympy.sin(d)
        c, s = (c, s) if k else t.axle.turned(c, s)
        inverse = expression(in_view(t.robot.trailers[k].length, t.symbolic).inverse())
        links.append(Link(f"hitch{k + 1}", c, s, inverse))
    return links


def _axle(robot: Robot, mobility: Mobility, what: str, symbolic: bool = False) -> Axle:
    """Return the fixed axle of a (2, 0) or (1, 1) body. Raise NotDerivableError, with the reason, for others."""
    if mobility.robot_type not in ((2, 0), (1, 1)):
        raise UnderivableError(
            f"{robot.name}: {what} is known for the types (2, 0) and (1, 1); {_type(mobility)}",
            Reason.ROBOT_TYPE,
        )
    rows = constant_rows(robot, mobility)
    if len(rows) != 1 or has_angles(rows[0]):
        raise UnderivableError(
            f"{robot.name}: {what} is built on a fixed axle, and this robot of type (1, 1) has none: no fixed wheel "
            "constrains it",
            Reason.ROBOT_TYPE,
        )
    if mobility.dof < 3:
        raise UnderivableError(
            f"{robot.name}: {what} needs a robot that can turn; this robot only translates (DOF {mobility.dof})",
            Reason.ROBOT_TYPE,
        )
    return fixed_axle(robot, mobility, symbolic_view if symbolic else working_view) or _of_row(
        robot, rows[0] if symbolic else fixed(rows[0], robot)
    )


def _of_row(robot: Robot, row: Row) -> Axle:
    """Return the axle of a row that no single wheel gives: its direction of travel, its point nearest to P."""
    nx, ny, k = row
    squared = nx * nx + ny * ny
    sign = _sign(robot, ny, -nx)
    scale = sqrt_poly(squared).inverse().scale(sign)
    ex, ey, at = ny * scale, -nx * scale, k * scale
    return Axle(ex, ey, at * ex, at * ey)


def _type(mobility: Mobility) -> str:
    """Return a clause on the type of the robot."""
    if mobility.degenerate:
        return f"this robot is degenerate (degree of mobility {mobility.degree_of_mobility})"
    if mobility.degree_of_mobility == 3:
        return "this robot is omnidirectional, type (3, 0): its pose is free, and no chain is needed"
    return f"this robot is of type {mobility.robot_type}"


def _sign(robot: Robot, ex: Poly, ey: Poly) -> int:
    """Return +1 if (ex, ey) points forward, or left if it has no forward part; else -1."""
    x, y = nominal_at(ex, robot, straight), nominal_at(ey, robot, straight)
    return 1 if (x if abs(x) > SMALL else y) > 0 else -1


def _steering(robot: Robot, mobility: Mobility, axle: Axle, symbolic: bool) -> Steering:
    """Return the wheel whose angle is the steering coordinate, virtual if the file has one, seen from the axle."""
    wheel = steering_frame(robot, mobility, symbolic).wheels[0]
    g = wheel.symbolic if symbolic else wheel.working
    (x, y), ex, ey = axle.seen(g), axle.ex, axle.ey
    return Steering(
        name=wheel.name, x=x, y=y, ch=ex * g.ch + ey * g.sh, sh=ex * g.sh - ey * g.ch,
    )  # fmt: skip
