"""A robot with a fixed axle as the tractor of a train: its axle, state, curvature, and the path of the last axle.

A fixed axle leaves two motions, along its heading and about a point of its line: what a differential drive and a car
have in common. Q is the centre of the fixed wheels on it, where trailers are coupled too; e is the direction of travel.
With v the speed of Q along e,

    d/dt Q = v e,    omega = kappa v for a steered wheel,    kappa(beta) = sin h / (X cos h + Y sin h),

(X, Y) the pivot and h the heading of the steered wheel, both seen from the axle. Tzafestas (2.26), (2.55).
"""

from __future__ import annotations

from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Locals
from wmrgen.analysis.mobility.analyse import fixed
from wmrgen.analysis.mobility.ranks import nominal_at, straight
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.axle import Axle, Vector, fixed_axle
from wmrgen.functions.models.frame import constant_rows
from wmrgen.functions.models.virtual import steering_frame
from wmrgen.functions.system import Gate
from wmrgen.functions.trailers.series import NARROW, Link, Path, path
from wmrgen.functions.trailers.trailer import behind, check_trailers, in_view, state_ports
from wmrgen.geometry.constraints import symbolic_view, working_view
from wmrgen.geometry.exact.evaluate import sqrt_poly
from wmrgen.geometry.exact.poly import Poly, Row, has_angles
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import POSE, TWIST, Port, Role, output
from wmrgen.geometry.symbolic import Expr, add, expression, rotated, signal, subtract, times

SMALL = 1e-9
V = output("v", "m/s", "speed of the centre of the axle, along the direction of travel")
OMEGA = TWIST[2]


class Steering(NamedTuple):
    """The steered wheel that sets the curvature. (x, y): pivot, (ch, sh): zero heading, in the axle's frame."""

    name: str
    x: Poly
    y: Poly
    ch: Poly
    sh: Poly


class Train(NamedTuple):
    """The robot seen from its axle, with its trailers. ``steering``: None for type (2, 0)."""

    robot: Robot
    axle: Axle
    steering: Steering | None
    symbolic: bool

    @property
    def size(self) -> int:
        """States: pose, steering, a heading for each trailer."""
        return 3 + len(self.robot.trailers) + (self.steering is not None)

    @property
    def steering_port(self) -> Port | None:
        """The steering angle among the states; None for type (2, 0)."""
        s = self.steering
        return None if s is None else Port(f"{s.name}.steer", Role.STATE, "rad", "steering angle")

    @property
    def state(self) -> tuple[Port, ...]:
        """x y theta, steering, headings of the trailers in the world frame."""
        steer = () if self.steering_port is None else (self.steering_port,)
        return (*POSE, *steer, *state_ports(self.robot.trailers))

    @property
    def turning(self) -> Port:
        """The second of the robot's own inputs: yaw rate, or steering rate."""
        if self.steering_port is None:
            return OMEGA
        return output(f"{self.steering_port.name}_rate", "rad/s", "steering rate, counter-clockwise")

    @property
    def by_heading(self) -> bool:
        """True where z1 is the heading."""
        return self.steering is None and not self.robot.trailers


def train(robot: Robot, mobility: Mobility, symbolic: bool = False, what: str = "the chained form") -> Train:
    """The robot as a tractor with trailers. NotDerivableError where the construction does not exist."""
    check_trailers(robot, mobility)
    axle = _axle(robot, mobility, what, symbolic)
    off = [t for t in robot.trailers if t.hitch.nominal]
    if len(off) > 1:
        raise NotDerivableError(
            f"{robot.name}: {what} is not known for more than one trailer coupled off the axle "
            f"({', '.join(t.name for t in off)}): such trains are not flat in general (Rouchon, Fliess, Levine, Martin "
            "1993). `hitch: 0` couples a trailer on the axle in front, for which it exists"
        )
    if off:
        raise NotDerivableError(
            f"{robot.name}: {off[0].name} is coupled {float(off[0].hitch.nominal):.6g} m off the axle, and {what} is "
            "built on the last axle, which works for trailers coupled on the axle (hitch: 0). With one coupled off it "
            "the train is flat, but with another output, which is not derived here"
        )
    steering = _steering(robot, mobility, axle, symbolic) if mobility.degree_of_steerability else None
    return Train(robot, axle, steering, symbolic)


class TrainTerms(NamedTuple):
    """A train with its axle's direction, position, curvature and path written down."""

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
    """Everything that the functions below share."""
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
    """Position of the centre of the last axle, world frame [m]."""
    theta = signal("theta")
    x, y = rotated(sympy.cos(theta), sympy.sin(theta), *t.axle.centre)
    point: Vector = add(signal("x"), x), add(signal("y"), y)
    for trailer in t.robot.trailers:
        point = behind(point, in_view(trailer.length, t.symbolic), signal(f"{trailer.name}.theta"))
    return point


def curvature_of(s: Steering, names: Locals) -> tuple[Expr, Expr, Expr]:
    """kappa [1/m] of the axle's path, dkappa/dbeta and dbeta/dkappa, for the steering angle beta."""
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
    """The last heading, then the hitch angles from the last to the first."""
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
    """The fixed axle of a (2, 0) or (1, 1) body. NotDerivableError, saying what is missing, for any other.

    ``what`` needs it: the beginning of the message. ``symbolic``: named parameters stay symbols.
    """
    if mobility.robot_type not in ((2, 0), (1, 1)):
        raise NotDerivableError(
            f"{robot.name}: {what} is known for the types (2, 0) and (1, 1); {_type(mobility)}"
        )
    rows = constant_rows(robot, mobility)
    if len(rows) != 1 or has_angles(rows[0]):
        raise NotDerivableError(
            f"{robot.name}: {what} is built on a fixed axle, and this robot of type (1, 1) has none: no fixed wheel "
            "constrains it"
        )
    if mobility.dof < 3:
        raise NotDerivableError(
            f"{robot.name}: {what} needs a robot that can turn; this one only translates (DOF {mobility.dof})"
        )
    return fixed_axle(robot, mobility, symbolic_view if symbolic else working_view) or _of_row(
        robot, rows[0] if symbolic else fixed(rows[0], robot)
    )


def _of_row(robot: Robot, row: Row) -> Axle:
    """The axle of a row that no single wheel gives: its direction of travel, its point nearest to P."""
    nx, ny, k = row
    squared = nx * nx + ny * ny
    sign = _sign(robot, ny, -nx)
    scale = sqrt_poly(squared).inverse().scale(sign)
    ex, ey, at = ny * scale, -nx * scale, k * scale
    return Axle(ex, ey, at * ex, at * ey)


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


def _steering(robot: Robot, mobility: Mobility, axle: Axle, symbolic: bool) -> Steering:
    """The wheel whose angle is the steering coordinate, virtual where the file names one, seen from the axle."""
    wheel = steering_frame(robot, mobility, symbolic).wheels[0]
    g = wheel.symbolic if symbolic else wheel.working
    (x, y), ex, ey = axle.seen(g), axle.ex, axle.ey
    return Steering(
        name=wheel.name, x=x, y=y, ch=ex * g.ch + ey * g.sh, sh=ex * g.sh - ey * g.ch,
    )  # fmt: skip
