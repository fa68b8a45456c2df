"""Chained form: z1' = u1, z2' = u2, z3' = z2 u1, ..., zn' = z_(n-1) u1 (Tzafestas (2.58)).

Type (2, 0) without trailers takes (2.62), (2.63): z1 = theta, everywhere. A car takes (2.66)-(2.69), and N trailers
coupled on the axle the construction of Sordalen (1993): z1 and zn are the position of the last axle, and
z_(k-1) = dz_k/dz_1 along its path (`wmrgen.models.series`), where cos theta_N and the cosines of all hitch angles
are not 0. u1, u2 to the robot's own inputs is `chained_input`, the way back `chained_rates`.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from wmrgen.errors import NotDerivableError
from wmrgen.exact.poly import Poly
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.layout.records import Robot, Trailer
from wmrgen.mobility.records import Mobility
from wmrgen.models.axle import Axle, Steering, body_axle
from wmrgen.models.series import NARROW, Gate, Link, Path, path
from wmrgen.models.trailers import check_trailers, state_ports
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, signal, subtract, times

V = Port("v", Role.COMMAND, "m/s", "speed of the centre of the axle, along the direction of travel")
OMEGA = Port("omega", Role.COMMAND, "rad/s", "yaw rate, counter-clockwise")
U = (
    Port("u1", Role.COMMAND, "", "first input of the chain"),
    Port("u2", Role.COMMAND, "", "second input of the chain"),
)


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


def _z(k: int) -> Port:
    return Port(f"z{k}", Role.COMMAND, "", f"state {k} of the chain")


def chained(robot: Robot, mobility: Mobility) -> Formula:
    """x y theta, steering, trailers to z1 ... zn."""
    w = write(train(robot, mobility))
    n = w.train.size
    inputs = (*w.train.state, *tunable_ports(robot))
    outputs = tuple((_z(k + 1), z) for k, z in enumerate(coordinates(w)))
    cite = "Tzafestas (2.62)" if w.train.by_heading else "Tzafestas (2.66), Sordalen (1993)"
    return Formula("chained", inputs, tuple(w.names.items), outputs, f"state of the (2,{n}) chain; {cite}")


def coordinates(w: Written) -> tuple[Expr, ...]:
    """z1 ... zn in the state."""
    if w.path is None:
        along = add(times(w.x, w.cosine), times(w.y, w.sine))
        across = subtract(times(w.x, w.sine), times(w.y, w.cosine))
        return signal("theta"), along, across
    slopes = w.path.slopes[1:-1]
    return (w.x, *reversed(slopes), w.y)


def chained_input(robot: Robot, mobility: Mobility) -> Formula:
    """State and u1, u2 to v, the steering rate, and the twist of P that `inverse` turns into wheel commands."""
    w = write(train(robot, mobility))
    u1, u2 = (signal(p.name) for p in U)
    v, turning = own_inputs(w, u1, u2)
    v = w.names.define("axle_speed", v)
    outputs = list(commands(w, v, turning))
    inputs = (*w.train.state, *U, *tunable_ports(robot))
    text = "inputs of the chain to those of the robot; " + ("(2.63)" if w.path is None else "(2.68)")
    return Formula("chained_input", inputs, tuple(w.names.items), tuple(outputs), text)


def own_inputs(w: Written, u1: Expr, u2: Expr) -> tuple[Expr, Expr]:
    """v, and the yaw rate or the steering rate."""
    p = w.path
    if p is None:
        return add(u2, times(u1, coordinates(w)[2])), u1
    rest = subtract(u2, times(p.slopes[-1], u1))
    answer = times(p.along, w.answer) if w.curvature is not None else sympy.S.One
    return times(u1, p.speed), times(p.inverse_gain, answer, rest)


def commands(w: Written, v: Expr, turning: Expr) -> tuple[tuple[Port, Expr], ...]:
    """v, vx, vy, omega of P and the steering rate, where there is one."""
    axle, t = w.train.axle, w.train
    omega = turning if w.curvature is None else times(w.curvature, v)
    omega = w.names.define("yaw_rate", omega)
    ex, ey = expression(axle.ex), expression(axle.ey)
    vx = add(times(ex, v), times(expression(axle.y), omega))
    vy = subtract(times(ey, v), times(expression(axle.x), omega))
    found = [(V, v), (Port("vx", Role.COMMAND, "m/s", "velocity of P forward"), vx)]
    found += [(Port("vy", Role.COMMAND, "m/s", "velocity of P to the left"), vy), (OMEGA, omega)]
    if w.curvature is not None:
        found.append((t.turning, turning))
    return tuple(found)


def chained_rates(robot: Robot, mobility: Mobility) -> Formula:
    """State and the robot's own inputs (v and the yaw or steering rate) to z1' ... zn'; u1, u2 are the first two."""
    w = write(train(robot, mobility))
    inputs = (*w.train.state, V, w.train.turning, *tunable_ports(robot))
    u1, u2 = chain_inputs(w, signal("v"), signal(w.train.turning.name))
    z = coordinates(w)
    u1 = w.names.define("chain_u1", u1)
    rates = [u1, u2, *(times(z[k], u1) for k in range(1, len(z) - 1))]
    outputs = tuple(
        (Port(f"z{k + 1}_rate", Role.COMMAND, "1/s", f"rate of z{k + 1}"), rate)
        for k, rate in enumerate(rates)
    )
    text = "rates of the chained state; z1_rate and z2_rate are the chain's inputs u1 and u2"
    return Formula("chained_rates", inputs, tuple(w.names.items), outputs, text)


def chain_inputs(w: Written, v: Expr, turning: Expr) -> tuple[Expr, Expr]:
    """u1, u2 of the robot's own inputs."""
    p = w.path
    if p is None:
        return turning, subtract(v, times(coordinates(w)[2], turning))
    leverage = times(p.speed, w.leverage) if w.curvature is not None else sympy.S.One
    u1 = w.names.define("path_rate", times(v, p.along))
    return u1, add(times(p.slopes[-1], u1), times(p.gain, leverage, turning))
