"""The kinematic models of a robot as systems q' = G(q) u: posture, eta, configuration and zeta.

**posture**: xi_I' = R(theta)^T Sigma(beta) u in the speeds that drive the robot (Siegwart 3.4; Campion, Bastin,
d'Andrea-Novel (1996)), see `inputs`. It is the car of Tzafestas (2.55) for a driven rear wheel, the car of (2.56a) for
a driven front wheel, the tricycle (2.46), the differential drive (2.37d), and the robot on three omni wheels (2.74).
**eta**: the same in the coordinates of the null space, `dynamics`.

**configuration**: the rates of everything that turns or moves, q = (x, y, theta, steering coordinates, castor angles,
wheel angles). Steered wheels that follow by the Ackermann condition have no state of their own: their angles are
functions of the coordinates (`virtual_steering`).

**zeta**: the reference point of a car is its steered front wheel (Tzafestas (2.56b)). Point P of that wheel (real or
virtual) moves along zeta = theta + heading + psi with its own speed v1:

    xp' = v1 cos(zeta),  yp' = v1 sin(zeta),  theta' = v1 k(zeta - theta),  zeta' = u2 = theta' + v2

with v2 = psi' and k = sin(psi)/D for a car. (xp, yp, zeta) is a unicycle. There is no division by cos(psi).
"""

from __future__ import annotations

from dataclasses import replace

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, signal_poly, substituted
from wmrgen.analysis.mobility.analyse import towards
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.frame import (
    ZERO,
    Frame,
    castor_row,
    has_coordinate,
    in_coordinates,
    rim_row,
    steering_rates,
)
from wmrgen.functions.models.inputs import Eta, Motion, best_motion, eta_motion
from wmrgen.functions.models.polynomials import (
    angles_in,
    domain_of,
    quotient,
    without_rounding,
    zero_condition,
)
from wmrgen.functions.models.tied import where_motions_meet
from wmrgen.functions.models.virtual import steering_frame
from wmrgen.functions.registry import Reason, function, system, underivable
from wmrgen.functions.system import Domain, System, rate_port
from wmrgen.geometry.constraints import (
    along,
    castor_rate,
    driving_row,
    heading,
    steer_gens,
    symbolic_view,
    working_view,
)
from wmrgen.geometry.exact.number import ONE
from wmrgen.geometry.exact.poly import Gen, Poly, Row, at_angle, common_powers, dot, triple
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import POSE, TWIST_NAMES, Port, Role, output
from wmrgen.geometry.symbolic import Expr, add, expression, rotated, signal, square, subtract

_COURSE = "course"  # the symbol of zeta - theta
ZETA_STATE = (
    Port("xp", Role.STATE, "m", "position of the steered wheel in the world frame"),
    Port("yp", Role.STATE, "m", "position of the steered wheel in the world frame"),
    POSE[2],
    Port("zeta", Role.STATE, "rad", "rolling direction of the steered wheel, counter-clockwise from world x"),
)
ZETA_INPUTS = (
    output("v1", "m/s", "speed of the steered wheel's centre"),
    output("v2", "rad/s", "steering rate of that wheel against the body"),
)


@system("posture")
def posture_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """Return the posture model: state x y theta, steering coordinates and the castors that matter.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.
    """
    return system_of("posture", best_motion(robot, mobility, symbolic))


@function("Tzafestas (2.28), (2.38), (2.46), (2.55), (2.56a); AA274")
def posture(robot: Robot, mobility: Mobility) -> Formula:
    """Return the rates of the posture for a state and driven speeds."""
    return posture_system(robot, mobility).formula()


@system("eta")
def eta_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """Return the model `dynamics` as a system.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.
    """
    motion = eta_motion(robot, mobility, symbolic)
    lines = (s.wheels for s in mobility.singularities if s.kind == "shared_axle")
    shared = (_one_line(robot, a, b, symbolic) for a, b in lines)
    meet = where_motions_meet(robot, motion.frame.view, motion.frame.columns)
    return system_of("dynamics", motion)._replace(domain=(*shared, *motion.lost, *meet))


def _one_line(robot: Robot, first: str, second: str, symbolic: bool) -> Domain:
    """Return where two steered axles are on one line, so that the only column of N vanishes."""
    a, b = robot.wheel(first), robot.wheel(second)
    view = symbolic_view if symbolic else working_view
    conditions = (square(expression(zero_condition(towards(v, w, view)))) for v, w in ((a, b), (b, a)))
    return Domain(
        add(*conditions),
        f"the axles of `{first}` and `{second}` are on one line, and eta1 has no effect (the form `twist` can still "
        "turn the robot)",
    )


@system("configuration")
def configuration_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """Return the posture model extended by castor angles and wheel angles.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.
    """
    motion = best_motion(robot, mobility, symbolic)
    castors = tuple(w for w in robot.wheels if w.kind.swivels)
    driving_freedoms = len(motion.etas[0])
    rolling = tuple(
        w for w in robot.wheels if w.has_spin and (has_coordinate(motion.frame, w) or driving_freedoms == 1)
    )
    model = system_of("configuration", motion, castors, rolling)
    return model._replace(text=f"configuration model: {motion.text}")


@function("Siegwart (3.24)-(3.28), solved for the joint rates")
def configuration(robot: Robot, mobility: Mobility) -> Formula:
    """Return the rates of everything that moves for a state and driven speeds."""
    return configuration_system(robot, mobility).formula()


def system_of(
    name: str, motion: Motion, castors: tuple[Wheel, ...] | None = None, rolling: tuple[Wheel, ...] = ()
) -> System:
    """Return the model of a motion.

    Args:
        name: The name of the model.
        motion: The twists that its inputs cause.
        castors: Castors whose angles are states; None for those that the motion depends on.
        rolling: Wheels whose angles about the axle are states.

    Returns:
        The system with state x y theta, steering coordinates, castor angles, wheel angles.
    """
    castors = motion.swivels if castors is None else castors
    state = (
        *POSE,
        *(joint_port(w, "steer", Role.STATE) for w in (*motion.frame.wheels, *castors)),
        *(Port(f"{w.name}.angle", Role.STATE, "rad", "angle rolled about the axle") for w in rolling),
    )
    shares = _shares(motion, castors, rolling)
    fields = []
    for k, twist in enumerate(motion.twists):
        joints = [expression(share[k]) for share in shares]
        fields.append((*in_world(triple(map(expression, twist))), *joints))
    geometry = motion.frame.geometry

    def code() -> Formula:
        names = Locals()
        outputs = zip(map(rate_port, state), posture_rates(motion, names, castors, rolling)[0], strict=True)
        return names.formula(name, (*state, *motion.inputs, *geometry), outputs, motion.text)

    return System(name, motion.text, state, motion.inputs, tuple(fields), geometry, motion.domain, code)


def posture_rates(
    motion: Motion, names: Locals, castors: tuple[Wheel, ...], rolling: tuple[Wheel, ...] = ()
) -> tuple[tuple[Expr, ...], tuple[Expr, Expr, Expr]]:
    """Return the rates of `system_of`, computed from the twist of P in the robot frame.

    Args:
        motion: The twists that the inputs cause.
        names: Takes the intermediate results.
        castors: Castors whose angles are states.
        rolling: Wheels whose angles about the axle are states.

    Returns:
        The rates in the order of the state, and the twist.
    """
    twist, velocity = _twist(motion, names)
    frame, joints = motion.frame, []
    joints += [signal_poly(f"{w.name}.steer_rate") for w in frame.wheels]
    for w, share in zip(
        (*castors, *rolling), _shares(motion, castors, rolling)[len(frame.wheels) :], strict=True
    ):
        own = Poly.sum(p * signal_poly(u.name) for p, u in zip(share, motion.inputs, strict=True))
        swings = len(joints) < len(frame.wheels) + len(castors)
        by_twist = castor_rate(w, frame.view(w), twist) if swings else _spin(frame, w, twist)
        joints.append(own if len(own.terms) < 2 or by_twist is None else by_twist)
    return (*velocity, *map(expression, (twist[2], *joints))), triple(map(expression, twist))


def _twist(motion: Motion, names: Locals) -> tuple[Row, tuple[Expr, Expr]]:
    """Return the twist of P in the robot frame, and its velocity in the world frame."""
    sums = _sums(motion, names)
    twist = triple(
        names.poly(f"body_{name}", p) if p else p for name, p in zip(TWIST_NAMES, sums, strict=True)
    )
    for (
        w
    ) in motion.frame.wheels:  # a velocity whose direction is fixed to a steered wheel turns with the wheel
        c, s = steer_gens(w)
        vx, vy, _ = sums
        ahead, left = without_rounding(vx * c + vy * s, vy * c - vx * s)
        if w.name in angles_in((vx, vy)) and w.name not in angles_in((ahead, left)):
            course = add(signal("theta"), signal(f"{w.name}.steer"))
            return twist, names.turned("velocity", (expression(ahead), expression(left)), course)
    return twist, names.turned("velocity", (expression(twist[0]), expression(twist[1])), signal("theta"))


def _sums(motion: Motion, names: Locals) -> list[Poly]:
    """Return the components of the twist.

    A factor that one input has in all components, for example its wheel's radius, is multiplied once if other inputs
    do not have it.
    """
    powers = [common_powers(twist) for twist in motion.twists]
    moving = [own for own, twist in zip(powers, motion.twists, strict=True) if any(twist)]

    def in_every_twist(g: Gen) -> bool:
        return all(g in own for own in moving)

    sums = [Poly({})] * 3
    for own, twist, u in zip(powers, motion.twists, motion.inputs, strict=True):
        alone = {g: e for g, e in own.items() if e and not in_every_twist(g)}
        scaled = signal_poly(u.name)
        if alone and any(twist):
            scale = Poly({tuple(sorted(alone.items())): ONE})
            twist = triple(p * scale.inverse() for p in twist)
            scaled = names.poly(f"{u.name}_scaled", expression(scale * scaled))
        sums = [total + p * scaled for total, p in zip(sums, twist, strict=True)]
    return sums


def _spin(frame: Frame, w: Wheel, twist: Row) -> Poly | None:
    """Return the rate about the axle under a twist; None for a wheel whose angle is no coordinate."""
    if not has_coordinate(frame, w):
        return None
    g, lead = frame.view(w), frame.leader(w)
    rim = dot(in_coordinates(frame, w, driving_row(w, g)), twist)
    if w.kind.steers and lead is not None:
        rim = rim - g.steer_arm * signal_poly(f"{lead.name}.steer_rate")
    return rim * g.rolling_radius.inverse()


def _shares(motion: Motion, castors: tuple[Wheel, ...], rolling: tuple[Wheel, ...]) -> list[list[Poly]]:
    """Return the rates of steering coordinates, castors and wheel angles per unit of each input."""
    shares = []
    for w in motion.frame.wheels:
        shares.append([Poly.of(int(u.name == f"{w.name}.steer_rate")) for u in motion.inputs])
    shares += [_per_input(motion, castor_row(motion.frame, w)) for w in castors]
    shares += [_wheel_rates(motion, w) for w in rolling]
    return shares


def in_world(twist: tuple[Expr, Expr, Expr]) -> tuple[Expr, Expr, Expr]:
    """Return R(theta)^T xi: the twist in the world frame (Siegwart (3.1))."""
    theta = signal("theta")
    vx, vy, omega = twist
    return *rotated(sympy.cos(theta), sympy.sin(theta), vx, vy), omega


def _wheel_rates(motion: Motion, w: Wheel) -> list[Poly]:
    """Return (rim speed - o steer_rate) / r by input; the rim speed of castors includes their steering."""
    g = motion.frame.view(w)
    rims = _per_input(motion, rim_row(motion.frame, w))
    if w.kind.steers and g.steer_arm:
        turns = steering_rates(motion.frame, w)
        rims = [
            rim - g.steer_arm * turns.get(u.name.removesuffix(".steer_rate"), ZERO)
            for rim, u in zip(rims, motion.inputs, strict=True)
        ]
    return [without_rounding(rim * g.rolling_radius.inverse())[0] for rim in rims]


def _per_input(motion: Motion, row: Eta) -> list[Poly]:
    """Return row . eta for each input."""
    values = []
    for eta in motion.etas:
        product = Poly.sum(p * e for p, e in zip(row, eta, strict=True))
        values.append(quotient(without_rounding(product)[0], motion.divisor))
    return values


@system("zeta")
def zeta_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """Return the zeta form: state xp yp theta zeta, inputs v1 v2.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.

    Raises:
        NotDerivableError: Unless one angle steers and one freedom drives.
    """
    degrees = (mobility.degree_of_mobility, mobility.degree_of_steerability)
    if degrees != (1, 1):
        raise underivable(
            robot,
            "zeta form",
            "it needs one freedom of driving and one steering coordinate, degrees (1, 1), but the "
            f"robot has {degrees}.",
            Reason.ROBOT_TYPE,
        )
    frame = steering_frame(robot, mobility, symbolic)
    if len(frame.wheels) != 1:
        raise underivable(
            robot, "zeta form", "its steering coordinate is not one wheel's angle.", Reason.ROBOT_TYPE
        )
    wheel = frame.wheels[0]
    turn, speed = _turn(frame, wheel)
    zeta = signal("zeta")
    rate = _in_zeta(quotient(turn, speed))
    first = (sympy.cos(zeta), sympy.sin(zeta), rate, rate)
    zero, one = sympy.S.Zero, sympy.S.One
    lost = f"the ICR is at `{wheel.name}`: its centre stands still"
    domain = domain_of(zero_condition(speed), lost, robot, _in_zeta)
    text = f"zeta form (Tzafestas (2.56b)): the reference is {wheel.name}, its rolling direction is zeta"
    return System(
        "zeta", text, ZETA_STATE, ZETA_INPUTS, (first, (zero, zero, zero, one)), frame.geometry, domain
    )


@function("Tzafestas (2.56b)")
def zeta(robot: Robot, mobility: Mobility) -> Formula:
    """Return the rates of xp yp theta zeta, and u2 = zeta': (xp, yp, zeta) is a unicycle with u1 = v1 and u2."""
    formula = zeta_system(robot, mobility).formula()
    u2 = output("u2", "rad/s", "turning rate of the unicycle (xp, yp, zeta)")
    return replace(formula, outputs=(*formula.outputs, (u2, formula.outputs[3][1])))


def _turn(frame: Frame, wheel: Wheel) -> tuple[Poly, Poly]:
    """Return yaw rate and speed of the wheel's pivot per unit of eta, in terms of its direction in the body."""
    (column,) = frame.columns
    g = frame.view(wheel)
    speed = dot(in_coordinates(frame, wheel, along(heading(wheel, g), g)), column)
    c, s = Poly.gen("cos", _COURSE), Poly.gen("sin", _COURSE)
    psi = c * g.ch + s * g.sh, s * g.ch - c * g.sh  # (zeta - theta) - zero heading
    return at_angle(column[2], *psi), at_angle(speed, *psi)


def _in_zeta(poly: Poly) -> Expr:
    """Return the expression with zeta - theta as the direction."""
    course = signal(f"{_COURSE}.steer")
    return substituted(expression(poly), {course: subtract(signal("zeta"), signal("theta"))}, {})
