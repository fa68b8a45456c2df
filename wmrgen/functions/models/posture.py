"""The posture model xi_I' = R(theta)^T Sigma(beta) u in the speeds that drive the robot (Siegwart 3.4; Campion (1996)).

Inputs are driven wheel speeds and the steering rates of the steering coordinates; where too few wheels are driven,
null-space coordinates eta in place of the speeds. With a driven rear wheel the car of Tzafestas (2.55), with a
driven front wheel that of (2.56a), the tricycle (2.46), the differential drive (2.37d), three omni wheels (2.74).
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import sympy

from wmrgen.exact.poly import Poly, Row
from wmrgen.functions.models.followers import castor_rate
from wmrgen.functions.models.fraction import divided, essential, never_zero
from wmrgen.functions.models.frame import Frame, angles_in, clean, frame
from wmrgen.functions.models.inputs import UnderactuatedError, choose, etas
from wmrgen.functions.models.virtual import steering_frame
from wmrgen.functions.registry import function, system
from wmrgen.functions.system import Domain, System
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, joint_port, tunable_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, signal, subtract, times


@dataclass(frozen=True, slots=True)
class Motion:
    """How inputs move the body.

    ``twists[k]``: the twist of P per unit of ``inputs[k]``, robot frame. ``etas[k] / divisor``: its coordinates
    along the columns of N. The model holds where ``divisor`` is not zero.
    """

    frame: Frame
    inputs: tuple[Port, ...]
    etas: tuple[tuple[Poly, ...], ...]
    divisor: Poly
    twists: tuple[Row, ...]
    text: str

    @property
    def robot(self) -> Robot:
        """The layout."""
        return self.frame.robot

    @property
    def swivels(self) -> tuple[Wheel, ...]:
        """Castors whose angle the motion depends on: states of the posture model."""
        seen = angles_in(tuple(p for twist in self.twists for p in twist))
        return tuple(w for w in self.robot.wheels if w.kind.swivels and w.name in seen)

    @property
    def geometry(self) -> tuple[Port, ...]:
        """Parameters that stay symbols."""
        return geometry_ports(self.frame)

    @property
    def domain(self) -> tuple[Domain, ...]:
        """Where the inputs lose their grip on the motion."""
        if self.divisor.constant is not None and len(self.frame.columns) == 1:
            condition = Poly.sum(p * p for p in self.frame.columns[0])
            text = "all entries of the null space vanish: axles fall into one line and rank C1 drops"
        else:
            condition = essential(self.divisor)
            names = ", ".join(p.name for p in self.inputs if not self._turns(p))
            one = len(self.frame.columns) == 1
            text = f"G is unbounded: {names} " + (
                "stands still whatever the robot does" if one else "no longer determine the motion"
            )
        return () if never_zero(condition, self.robot) else (Domain(expression(condition), text),)

    def _turns(self, port: Port) -> bool:
        return port.name in {f"{w.name}.steer_rate" for w in self.frame.wheels}


def posture_motion(robot: Robot, mobility: Mobility, symbolic: bool = False) -> Motion:
    """The motion in driven speeds and steering rates."""
    found = steering_frame(robot, mobility, symbolic)
    chosen = choose(found)
    rates = tuple(joint_port(w, "steer_rate", Role.COMMAND) for w in found.wheels)
    found_etas, determinant = etas(chosen, tuple(w.name for w in found.wheels))
    inputs = (*(d.port for d in chosen.drives), *rates)
    note = f"; {', '.join(chosen.idle)} must follow" if chosen.idle else ""
    text = f"posture model in {', '.join(p.name for p in inputs)}{note}"
    return _motion(found, inputs, found_etas, determinant, text)


def eta_motion(robot: Robot, mobility: Mobility, symbolic: bool = False, virtual: bool = False) -> Motion:
    """The motion in null-space coordinates, as ``dynamics`` has it; ``virtual`` takes the virtual angles."""
    found = steering_frame(robot, mobility, symbolic) if virtual else frame(robot, mobility, symbolic)
    size = range(len(found.columns))
    ports = tuple(
        Port(f"eta{k + 1}", Role.COMMAND, "", f"coordinate along column {k + 1} of the null space")
        for k in size
    )
    rates = tuple(joint_port(w, "steer_rate", Role.COMMAND) for w in found.wheels)
    one = [tuple(Poly.of(int(i == k)) for i in size) for k in range(len(size) + len(rates))]
    return _motion(found, (*ports, *rates), one, Poly.of(1), "posture model in null-space coordinates")


def _motion(
    found: Frame, inputs: tuple[Port, ...], given: list[tuple[Poly, ...]], divisor: Poly, text: str
) -> Motion:
    rows = []
    for eta in given:
        parts = [Poly.sum(c[i] * e for c, e in zip(found.columns, eta, strict=True)) for i in range(3)]
        rows.append(divided((parts[0], parts[1], parts[2]), divisor))
    return Motion(found, inputs, tuple(given), divisor, tuple(rows), text)


def best_motion(robot: Robot, mobility: Mobility, symbolic: bool = False) -> Motion:
    """In driven speeds where the actuation allows it, else in null-space coordinates."""
    try:
        return posture_motion(robot, mobility, symbolic)
    except UnderactuatedError as error:
        found = eta_motion(robot, mobility, symbolic, virtual=True)
        return replace(found, text=f"{found.text}: {error}")


@system("posture")
def posture_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """State x y theta, steering coordinates and the castors that matter; inputs as in `best_motion`."""
    return system_of("posture", best_motion(robot, mobility, symbolic))


@function("Tzafestas (2.28), (2.38), (2.46), (2.55), (2.56a); AA274")
def posture(robot: Robot, mobility: Mobility) -> Formula:
    """State and driven speeds to the rates of the posture."""
    return posture_system(robot, mobility).formula()


def system_of(name: str, motion: Motion) -> System:
    """The posture model of a motion."""
    state = posture_state(motion)
    found = tuple(
        posture_field(motion, port, twist) for port, twist in zip(motion.inputs, motion.twists, strict=True)
    )
    return System(name, motion.text, state, motion.inputs, found, motion.geometry, motion.domain)


def posture_state(motion: Motion) -> tuple[Port, ...]:
    """x y theta, steering coordinates, castors that matter."""
    wheels = (*motion.frame.wheels, *motion.swivels)
    return (*POSE, *(joint_port(w, "steer", Role.STATE) for w in wheels))


def posture_field(motion: Motion, port: Port, twist: Row) -> tuple[Expr, ...]:
    """The vector field of one input on the states of the posture model."""
    steers = [sympy.Integer(port.name == f"{w.name}.steer_rate") for w in motion.frame.wheels]
    swivels = [expression(clean(castor_rate(motion.frame, w, twist))) for w in motion.swivels]
    return (*world(twist), *steers, *swivels)


def world(twist: Row) -> tuple[Expr, Expr, Expr]:
    """R(theta)^T xi: the twist in the world frame (Siegwart (3.1))."""
    theta = signal("theta")
    c, s = sympy.cos(theta), sympy.sin(theta)
    vx, vy, omega = (expression(p) for p in twist)
    return subtract(times(vx, c), times(vy, s)), add(times(vx, s), times(vy, c)), omega


def geometry_ports(frame: Frame) -> tuple[Port, ...]:
    """The parameters that stay symbols in the frame's view."""
    return parameter_ports(frame.robot) if frame.symbolic else tunable_ports(frame.robot)


def parameter_ports(robot: Robot) -> tuple[Port, ...]:
    """Every parameter as an input, with its nominal value."""
    tunable = {p.name: p for p in tunable_ports(robot)}
    angles = {
        g.name
        for w in robot.wheels
        for f in fields(w.symbolic)
        for h in getattr(w.symbolic, f.name).generators
        if h.kind in ("cosf", "sinf")
        for a in h.args
        for g in a.generators
        if g.kind == "param"
    }
    return tuple(
        tunable.get(p.name)
        or Port(p.name, Role.GEOMETRY, "rad" if p.name in angles else "m", "parameter", p.nominal)
        for p in robot.parameters
    )
