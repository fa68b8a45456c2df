"""The configuration model: rates of everything that turns or moves (Campion, Bastin, d'Andrea-Novel (1996)).

q = (x, y, theta, steering coordinates, castor angles, wheel angles). Steered wheels that follow by the Ackermann
condition have no state of their own: their angles are functions of the coordinates (`virtual_steering`).
"""

from __future__ import annotations

from wmrgen.exact.poly import Poly
from wmrgen.functions.models.followers import castor_rate, direct, rate_row, rim_row
from wmrgen.functions.models.fraction import quotient
from wmrgen.functions.models.frame import clean
from wmrgen.functions.models.posture import Motion, best_motion, world
from wmrgen.functions.registry import function, system
from wmrgen.functions.system import System
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, joint_port
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, expression

ZERO = Poly({})


@system("configuration")
def configuration_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """Posture model extended by castor angles and wheel angles; inputs as in the posture model."""
    motion = best_motion(robot, mobility, symbolic)
    coordinates = motion.frame.wheels
    castors = tuple(w for w in robot.wheels if w.kind.swivels)
    rolling = tuple(
        w for w in robot.wheels if w.has_spin and (direct(motion.frame, w) or len(motion.etas[0]) == 1)
    )
    state = (
        *POSE,
        *(joint_port(w, "steer", Role.STATE) for w in (*coordinates, *castors)),
        *(Port(f"{w.name}.angle", Role.STATE, "rad", "angle rolled about the axle") for w in rolling),
    )
    fields = []
    for k, port in enumerate(motion.inputs):
        steers = [Poly.of(int(port.name == f"{w.name}.steer_rate")) for w in coordinates]
        swivels = [_castor(motion, w, k) for w in castors]
        spins = [_spin(motion, w, k) for w in rolling]
        joints: list[Expr] = [expression(p) for p in (*steers, *swivels, *spins)]
        fields.append((*world(motion.twists[k]), *joints))
    text = f"configuration model: {motion.text}"
    return System("configuration", text, state, motion.inputs, tuple(fields), motion.geometry, motion.domain)


def _castor(motion: Motion, w: Wheel, k: int) -> Poly:
    rates = tuple(castor_rate(motion.frame, w, column) for column in motion.frame.columns)
    return _per_input(motion, rates, k)


def _spin(motion: Motion, w: Wheel, k: int) -> Poly:
    """(rim speed - o steer_rate) / r; the steering of castors stands in their rim speed already."""
    g = motion.frame.view(w)
    radius = g.rolling_radius
    rim = _per_input(motion, rim_row(motion.frame, w), k)
    if w.kind.steers and g.o:
        name = motion.inputs[k].name.removesuffix(".steer_rate")
        rim = rim - g.o * rate_row(motion.frame, w).get(name, ZERO)
    return clean(rim * radius.inverse())


def _per_input(motion: Motion, row: tuple[Poly, ...], k: int) -> Poly:
    """row . eta for one input."""
    above = Poly.sum(p * e for p, e in zip(row, motion.etas[k], strict=True))
    return quotient(clean(above), motion.divisor)


@function("Siegwart (3.24)-(3.28), solved for the joint rates")
def configuration(robot: Robot, mobility: Mobility) -> Formula:
    """State and driven speeds to the rates of everything that moves."""
    return configuration_system(robot, mobility).formula()
