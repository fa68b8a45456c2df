"""The zeta form of a car: the reference moves to the steered front wheel (Tzafestas (2.56b)).

Point P of the steered wheel (real or virtual) moves along zeta = theta + heading + psi with its own speed v1:

    xp' = v1 cos(zeta),  yp' = v1 sin(zeta),  theta' = v1 k(zeta - theta),  zeta' = u2 = theta' + v2

with v2 = psi' and k = sin(psi)/D for a car; (xp, yp, zeta) is a unicycle. No division by cos(psi).
"""

from __future__ import annotations

from dataclasses import replace

import sympy

from wmrgen.constraints import along, heading
from wmrgen.errors import NotDerivableError
from wmrgen.exact.poly import Gen, Poly, Row, dot
from wmrgen.functions.models.followers import turned
from wmrgen.functions.models.fraction import essential, never_zero, quotient
from wmrgen.functions.models.frame import Frame
from wmrgen.functions.models.posture import geometry_ports
from wmrgen.functions.models.virtual import steering_frame
from wmrgen.functions.registry import function, system
from wmrgen.functions.system import Domain, System
from wmrgen.kinematics.records import Formula
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, expression, signal, substituted, subtract

_COURSE = "course"  # stands for zeta - theta
STATE = (
    Port("xp", Role.STATE, "m", "position of the steered wheel in the world frame"),
    Port("yp", Role.STATE, "m", "position of the steered wheel in the world frame"),
    Port("theta", Role.STATE, "rad", "heading of the robot, counter-clockwise from world x"),
    Port("zeta", Role.STATE, "rad", "rolling direction of the steered wheel, counter-clockwise from world x"),
)
INPUTS = (
    Port("v1", Role.COMMAND, "m/s", "speed of the steered wheel's centre"),
    Port("v2", Role.COMMAND, "rad/s", "steering rate of that wheel against the body"),
)


@system("zeta")
def zeta_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """State xp yp theta zeta, inputs v1 v2. NotDerivableError unless one angle steers and one freedom drives."""
    degrees = (mobility.degree_of_mobility, mobility.degree_of_steerability)
    if degrees != (1, 1):
        raise NotDerivableError(
            f"{robot.name} has no zeta form: it needs one freedom of driving and one steering coordinate, "
            f"degrees (1, 1), and the robot has {degrees}."
        )
    frame = steering_frame(robot, mobility, symbolic)
    if len(frame.wheels) != 1:
        raise NotDerivableError(
            f"{robot.name} has no zeta form: its steering coordinate is not one wheel's angle."
        )
    wheel = frame.wheels[0]
    turn, speed = _turn(frame, wheel)
    zeta = signal("zeta")
    rate = _in_zeta(quotient(turn, speed))
    first = (sympy.cos(zeta), sympy.sin(zeta), rate, rate)
    zero, one = sympy.S.Zero, sympy.S.One
    condition = essential(speed)
    domain = (
        ()
        if never_zero(condition, robot)
        else (Domain(_in_zeta(condition), f"the ICR lies on {wheel.name}: its centre stands still"),)
    )
    text = f"zeta form (Tzafestas (2.56b)): the reference is {wheel.name}, its rolling direction is zeta"
    return System(
        "zeta", text, STATE, INPUTS, (first, (zero, zero, zero, one)), geometry_ports(frame), domain
    )


@function("Tzafestas (2.56b)")
def zeta(robot: Robot, mobility: Mobility) -> Formula:
    """Rates of xp yp theta zeta, and u2 = zeta': with u1 = v1 the inputs of the unicycle (xp, yp, zeta)."""
    formula = zeta_system(robot, mobility).formula()
    u2 = Port("u2", Role.COMMAND, "rad/s", "turning rate of the unicycle (xp, yp, zeta)")
    return replace(formula, outputs=(*formula.outputs, (u2, formula.outputs[3][1])))


def _turn(frame: Frame, wheel: Wheel) -> tuple[Poly, Poly]:
    """Yaw rate and speed of the wheel's pivot per unit of eta, in cosine and sine of its direction in the body."""
    (column,) = frame.columns
    g = frame.view(wheel)
    direction = heading(wheel, g)
    row: Row = along(direction, g)
    speed = dot(turned(frame, wheel, row), column)
    c, s = Poly.gen("cos", _COURSE), Poly.gen("sin", _COURSE)

    def value(gen: Gen) -> Poly | None:
        """cos and sin of psi = (zeta - theta) - zero heading."""
        if gen.kind == "cos":
            return c * g.ch + s * g.sh
        return s * g.ch - c * g.sh if gen.kind == "sin" else None

    return column[2].substitute(value), speed.substitute(value)


def _in_zeta(poly: Poly) -> Expr:
    """The expression with zeta - theta for the direction."""
    course = signal(f"{_COURSE}.steer")
    return substituted(expression(poly), {course: subtract(signal("zeta"), signal("theta"))}, {})
