"""A robot with a fixed axle as the tractor of a train: state, curvature, path of the last axle, written down once."""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from wmrgen.errors import NotDerivableError
from wmrgen.exact.poly import Poly
from wmrgen.functions.trailers.axle import Axle, Steering, body_axle
from wmrgen.functions.trailers.series import NARROW, Gate, Link, Path, path
from wmrgen.functions.trailers.trailer import check_trailers, state_ports
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Locals
from wmrgen.layout.records import Robot, Trailer
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, signal, subtract, times

V = Port("v", Role.COMMAND, "m/s", "speed of the centre of the axle, along the direction of travel")
OMEGA = Port("omega", Role.COMMAND, "rad/s", "yaw rate, counter-clockwise")


@dataclass(frozen=True, slots=True)
class Train:
    """The robot seen from its axle, with its trailers."""

    robot: Robot
    axle: Axle
    trailers: tuple[Trailer, ...]
    symbolic: bool = False

    @property
    def size(self) -> int:
        """States: pose, steering, a heading for each trailer."""
        return 3 + len(self.trailers) + (self.axle.steering is not None)

    @property
    def steering_port(self) -> Port | None:
        """The steering angle among the states; None for type (2, 0)."""
        s = self.axle.steering
        return None if s is None else Port(f"{s.name}.steer", Role.STATE, "rad", "steering angle")

    @property
    def state(self) -> tuple[Port, ...]:
        """x y theta, steering, headings of the trailers in the world frame."""
        steer = () if self.steering_port is None else (self.steering_port,)
        return (*POSE, *steer, *state_ports(self.trailers))

    @property
    def turning(self) -> Port:
        """The second of the robot's own inputs: yaw rate, or steering rate."""
        if self.steering_port is None:
            return OMEGA
        return Port(
            f"{self.steering_port.name}_rate", Role.COMMAND, "rad/s", "steering rate, counter-clockwise"
        )

    @property
    def by_heading(self) -> bool:
        """True where z1 is the heading."""
        return self.axle.steering is None and not self.trailers


def train(robot: Robot, mobility: Mobility, symbolic: bool = False, what: str = "the chained form") -> Train:
    """The robot as a tractor with trailers. NotDerivableError where the construction does not exist."""
    check_trailers(robot, mobility)
    axle = body_axle(robot, mobility, what, symbolic)
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
    return Train(robot, axle, robot.trailers, symbolic)


@dataclass(frozen=True, slots=True)
class Written:
    """A train with its axle's direction, position, curvature and path written down."""

    train: Train
    names: Locals
    cosine: Expr  # of the tractor's heading
    sine: Expr
    x: Expr  # of the last axle
    y: Expr
    curvature: Expr | None
    leverage: Expr  # dkappa/dbeta, or 1
    answer: Expr  # dbeta/dkappa, or 1
    path: Path | None  # None where z1 is the heading


def write(t: Train) -> Written:
    """Everything that the functions below share."""
    names, axle = Locals(), t.axle
    c, s = turned(axle, sympy.cos(signal("theta")), sympy.sin(signal("theta")))
    if t.by_heading:
        c, s = names.define("axle_cosine", c), names.define("axle_sine", s)
    curvature: Expr | None = None
    leverage = answer = sympy.S.One
    if axle.steering is not None:
        curvature, leverage, answer = bending(axle.steering, names)
    x, y = last_axle(t)
    x, y = names.define("last_x", x), names.define("last_y", y)
    found = None if t.by_heading else path(names, _links(t), curvature)
    return Written(t, names, c, s, x, y, curvature, leverage, answer, found)


def last_axle(t: Train) -> tuple[Expr, Expr]:
    """Position of the centre of the last axle, world frame [m]."""
    theta = signal("theta")
    x: Expr = signal("x")
    y: Expr = signal("y")
    if t.axle.x or t.axle.y:
        qx, qy, c, s = expression(t.axle.x), expression(t.axle.y), sympy.cos(theta), sympy.sin(theta)
        x = add(x, subtract(times(qx, c), times(qy, s)))
        y = add(y, add(times(qx, s), times(qy, c)))
    for trailer in t.trailers:
        heading, length = signal(f"{trailer.name}.theta"), expression(length_of(t, trailer))
        x, y = subtract(x, times(length, sympy.cos(heading))), subtract(y, times(length, sympy.sin(heading)))
    return x, y


def bending(s: Steering, names: Locals) -> tuple[Expr, Expr, Expr]:
    """kappa [1/m] of the axle's path, dkappa/dbeta and dbeta/dkappa, for the steering angle beta."""
    beta = signal(f"{s.name}.steer")
    c, n = sympy.cos(beta), sympy.sin(beta)
    ch, sh = expression(s.ch), expression(s.sh)
    cosine = names.define("steer_cosine", subtract(times(ch, c), times(sh, n)))
    sine = names.define("steer_sine", add(times(sh, c), times(ch, n)))
    inverse = s.x.inverse()
    divisor = names.define("steer_divisor", add(cosine, times(expression(s.y * inverse), sine)))
    gate = Gate(divisor, NARROW)
    kept = names.define("steer_divisor_kept", gate.choose(sympy.S.One, divisor))
    over = names.define("steer_over", gate.choose(sympy.S.Zero, sympy.Pow(kept, -1)))
    kappa = names.define("kappa", times(expression(inverse), sine, over))
    leverage = times(expression(inverse), over, over)
    return kappa, leverage, times(expression(s.x), divisor, divisor)


def length_of(t: Train, trailer: Trailer) -> Poly:
    """The trailer's length in the view that the train is written in."""
    return trailer.length.symbolic if t.symbolic else trailer.length.working


def turned(axle: Axle, c: Expr, s: Expr) -> tuple[Expr, Expr]:
    """Cosine and sine of the axle's heading, from those of the robot's."""
    ex, ey = expression(axle.ex), expression(axle.ey)
    return subtract(times(ex, c), times(ey, s)), add(times(ex, s), times(ey, c))


def _links(t: Train) -> list[Link]:
    """The last heading, then the hitch angles from the last to the first."""
    theta = signal("theta")
    headings = [signal(f"{trailer.name}.theta") for trailer in t.trailers]
    if not headings:
        c, s = turned(t.axle, sympy.cos(theta), sympy.sin(theta))
        return [Link("last", c, s, sympy.S.One)]
    last = headings[-1]
    links = [Link("last", sympy.cos(last), sympy.sin(last), sympy.S.One)]
    for k in reversed(range(len(headings))):
        d = subtract(headings[k - 1] if k else theta, headings[k])
        c, s = sympy.cos(d), sympy.sin(d)
        c, s = (c, s) if k else turned(t.axle, c, s)
        inverse = expression(length_of(t, t.trailers[k]).inverse())
        links.append(Link(f"hitch{k + 1}", c, s, inverse))
    return links
