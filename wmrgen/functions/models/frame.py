"""The steering coordinates of a robot, the twists that its wheels admit, and how the other wheels follow.

xi = N(beta) eta: N spans the null space of C1 (Siegwart (3.36); Campion (1996)). beta are the angles of those steered
wheels, real or virtual, that determine where the ICR is. All other wheels follow. With one freedom of driving, the
velocity of every point of the body has a direction that the coordinates determine, V = N_xy + N_omega z x A. A wheel
that follows points along it (the Ackermann condition), on the side that is nearer to its zero when steering is
straight.
"""

from __future__ import annotations

from typing import NamedTuple

from wmrgen.analysis.kinematics.records import parameter_ports, tunable_ports
from wmrgen.analysis.mobility.analyse import fixed
from wmrgen.analysis.mobility.basis import null_columns
from wmrgen.analysis.mobility.ranks import generic, nominal_at, straight
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.polynomials import angles_in, by_steering, row_without_rounding, without_rounding
from wmrgen.functions.registry import Reason, UnderivableError, underivable
from wmrgen.geometry.constraints import (
    View,
    along,
    castor_rate,
    driving_row,
    sliding_row,
    steer_gens,
    symbolic_view,
    working_view,
)
from wmrgen.geometry.exact.evaluate import sqrt_poly
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly, Row, at_angle, dot, each
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import Port

MOST_TERMS = 120  # terms of a velocity: squaring them takes a second, squaring twice as many takes five
ONE, ZERO = Poly.of(1), Poly({})


class Frame(NamedTuple):
    """Null space and steering coordinates of a robot."""

    robot: Robot
    symbolic: bool  # whether all parameters are symbols, or only the tunable ones
    columns: tuple[Row, ...]  # columns of N
    wheels: tuple[Wheel, ...]  # their angles are the steering coordinates; a virtual wheel has index -1

    @property
    def view(self) -> View:
        """Return the geometry in which all expressions are written."""
        return symbolic_view if self.symbolic else working_view

    @property
    def geometry(self) -> tuple[Port, ...]:
        """Return the parameters that remain symbols in this view."""
        return parameter_ports(self.robot) if self.symbolic else tunable_ports(self.robot)

    def leader(self, wheel: Wheel) -> Wheel | None:
        """Return the coordinate that turns ``wheel`` directly: the wheel itself or the wheel it is coupled to."""
        names = {w.name: w for w in self.wheels}
        if wheel.name in names or wheel.index < 0:
            return names.get(wheel.name)
        return names.get(self.robot.wheels[self.robot.steer_group[wheel.index]].name)


def frame(robot: Robot, mobility: Mobility, symbolic: bool, virtual: tuple[Wheel, ...] = ()) -> Frame:
    """Return coordinates and null space of a robot.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.
        virtual: Virtual wheels that replace the real steering coordinates: as many as the degree of steerability.

    Raises:
        NotDerivableError: If the robot cannot move, or if its couplings tie steering angles together.
    """
    if not mobility.degree_of_mobility:
        raise UnderivableError(
            f"{robot.name} cannot move (degree of mobility 0): it has no model of motion", Reason.MOBILITY
        )
    if len(mobility.basis_wheels) > mobility.degree_of_steerability:
        raise underivable(
            robot,
            "model of motion with free steering rates",
            f"its couplings tie the angles of {', '.join(mobility.basis_wheels)} together, and the degree of "
            f"steerability is {mobility.degree_of_steerability}",
            Reason.COUPLINGS,
        )
    if virtual:
        rows = list(constant_rows(robot, mobility))
        rows += [sliding_row(w, symbolic_view(w)).row for w in virtual]
        columns, wheels = null_columns(rows), virtual
    else:
        columns = mobility.null_space_symbolic
        wheels = tuple(robot.wheel(name) for name in mobility.basis_wheels)
    if not symbolic:
        columns = tuple(fixed(column, robot) for column in columns)
    return Frame(robot, symbolic, tuple(row_without_rounding(column) for column in columns), wheels)


def constant_rows(robot: Robot, mobility: Mobility) -> list[Row]:
    """Return the independent rows of C1 that no steered wheel gives, with parameters as symbols where possible."""
    steered = set(mobility.basis_wheels)
    fixed_wheels = [w for w in robot.wheels if w.kind.fixed_axle]
    rows = []
    for row in mobility.basis_rows:
        if not steered & angles_in(row):
            source = next((w for w in fixed_wheels if sliding_row(w, working_view(w)).row == row), None)
            rows.append(row if source is None else sliding_row(source, symbolic_view(source)).row)
    return rows


def _pivot_velocity(frame: Frame, wheel: Wheel, column: Row) -> tuple[Poly, Poly]:
    """Return the velocity of the wheel's pivot under one column of N, robot frame [m/s per unit of eta].

    Raise NotDerivableError if it has too many terms for its square, which directions and rates need.
    """
    g = frame.view(wheel)
    a, b = without_rounding(dot(along((ONE, ZERO), g), column), dot(along((ZERO, ONE), g), column))
    terms = len(a.terms) + len(b.terms)
    if terms > MOST_TERMS:
        raise underivable(
            frame.robot,
            "model of motion that can be written out",
            f"the velocity of {wheel.name} has {terms} terms in the parameters, more than {MOST_TERMS}.\n"
            "  Give numbers for some of the lengths and angles, or simpler expressions; inverse and forward do not "
            "need it.",
            Reason.TOO_LONG,
        )
    return a, b


def _travel_velocity(frame: Frame, wheel: Wheel) -> tuple[Poly, Poly]:
    """Return the velocity of the pivot of a wheel that points along it.

    Any column that moves the pivot gives the same direction, because such a wheel is on the line of a fixed axle.
    """
    velocities = [_pivot_velocity(frame, wheel, column) for column in frame.columns]
    return next((v for v in velocities if any(v)), velocities[0])


def _rolling_sign(frame: Frame, wheel: Wheel, velocity: tuple[Poly, Poly]) -> int:
    """Return +1 if the wheel rolls forward under +eta with its heading nearest to its zero, else -1."""
    g = wheel.nominal
    for angles in (straight, generic(frame.robot)):
        a, b = (nominal_at(p, frame.robot, angles) for p in velocity)
        forward = a * float(g.ch) + b * float(g.sh)
        if abs(forward) > 1e-9:
            return 1 if forward > 0 else -1
    return 1


def in_coordinates(frame: Frame, wheel: Wheel, row: Row) -> Row:
    """Return a row of ``wheel`` written in the angle of the coordinate that turns it.

    Args:
        frame: The coordinates.
        wheel: The wheel.
        row: A row in the wheel's own angle.
    """
    lead = frame.leader(wheel)
    if lead is None or lead.name == wheel.name:
        return row
    c, s = _coupled_angle(lead, wheel)
    return each(row, lambda p: at_angle(p, c, s))


def _coupled_angle(lead: Wheel, wheel: Wheel) -> tuple[Poly, Poly]:
    """Return (cos, sin) of the steering angle of a wheel that turns with ``lead`` or against it."""
    c, s = steer_gens(lead)
    return c, s.scale(Exact(wheel.steer_sign))


def has_coordinate(frame: Frame, wheel: Wheel) -> bool:
    """Return whether the heading of a wheel is constant, a state of its own, or a coordinate."""
    return not wheel.kind.steers or frame.leader(wheel) is not None


def rim_row(frame: Frame, wheel: Wheel) -> tuple[Poly, ...]:
    """Return the rim speed [m/s] per unit of each eta, without the effect of steering rates."""
    g = frame.view(wheel)
    if has_coordinate(frame, wheel):
        row = in_coordinates(frame, wheel, driving_row(wheel, g))
        return tuple(dot(row, column) for column in frame.columns)
    (column,) = frame.columns
    a, b = _pivot_velocity(frame, wheel, column)
    speed = _length(a * a + b * b)
    return (speed.scale(_rolling_sign(frame, wheel, (a, b))) - g.o * column[2],)


def steering_rates(frame: Frame, wheel: Wheel) -> dict[str, Poly]:
    """Return the wheel's steering rate per unit rate of each coordinate, by the coordinate's name."""
    lead = frame.leader(wheel)
    if lead is not None:
        return {lead.name: ONE.scale(Exact(wheel.steer_sign))}
    a, b = _travel_velocity(frame, wheel)
    squared = a * a + b * b
    rates = {
        w.name: (a * by_steering(b, w.name) - b * by_steering(a, w.name)) * squared.inverse()
        for w in frame.wheels
    }
    return {name: rate for name, rate in rates.items() if rate}


def castor_row(frame: Frame, wheel: Wheel) -> tuple[Poly, ...]:
    """Return the steering rate of a castor [rad/s] per unit of each eta."""
    return tuple(castor_rate(wheel, frame.view(wheel), column) for column in frame.columns)


def steering_direction(frame: Frame, wheel: Wheel) -> tuple[Poly, Poly]:
    """Return (cos, sin) of the wheel's steering angle, times a positive factor."""
    lead = frame.leader(wheel)
    if lead is not None:
        return _coupled_angle(lead, wheel)
    a, b = _travel_velocity(frame, wheel)
    g, sign = frame.view(wheel), _rolling_sign(frame, wheel, (a, b))
    return (a * g.ch + b * g.sh).scale(sign), (b * g.ch - a * g.sh).scale(sign)


def _length(squared: Poly) -> Poly:
    """Return the square root of a sum of squares; for one square of positive lengths, the length."""
    root = sqrt_poly(squared)
    if root.constant is not None or len(squared.terms) > 1:
        return root
    ((monomial, coefficient),) = squared.terms.items()
    head = sqrt_poly(Poly.of(coefficient))
    if any(e % 2 or g.kind != "param" for g, e in monomial):
        return root
    # |p| as sqrt(p**2), since a parameter may be negative.
    return head * Poly.gen("sqrt", "", Poly({monomial: Poly.of(1).terms[()]}))
