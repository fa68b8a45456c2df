"""Trailers behind a body (Tzafestas 2.3.6, (2.70) corrected; off-axle hitches included).

Trailer i turns about its axle, L_i behind its coupling. With t_i its direction and n_i = z x t_i, the velocity V of
the coupling has a component that the axle follows and a component that turns the trailer:

    v_i = V . t_i,   L_i theta_i' = V . n_i        (so n_i . (velocity of the axle) = 0: it does not slide)

The next coupling is at distance h (hitch) behind that axle: V = v_i t_i - h theta_i' n_i. The hitch behind the body is
measured from the fixed axle at the centre of the fixed wheels; from P if there is none.

On the steady circle every axle has the yaw rate of the body, kappa per metre of travel of the body's axle. Seen from
the trailer the coupling moves by (v_i, L_i kappa), seen from the vehicle ahead by (v_(i-1), -h_i kappa). Equal lengths
and directions of these vectors give

    v_i**2 = v_(i-1)**2 + kappa**2 (h_i**2 - L_i**2),   v_0 = 1
    hitch angle_i = atan2(L_i kappa, v_i) + atan2(h_i kappa, v_(i-1))

The circle exists while no v_i**2 is negative. The radii satisfy R_i**2 = R_(i-1)**2 + h_i**2 - L_i**2 (Tzafestas 2.3.6
with h = 0).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.axle import THROUGH_P, Axle, Vector, fixed_axle, leading_axle
from wmrgen.functions.models.inputs import Motion, best_motion
from wmrgen.functions.models.polynomials import whole, without_lengths
from wmrgen.functions.models.posture import posture_rates, system_of
from wmrgen.functions.models.sheet import LONGEST
from wmrgen.functions.models.vector_fields import to_poly
from wmrgen.functions.registry import Reason, UnderivableError, function, system, underivable
from wmrgen.functions.system import Domain, System, rate_port, with_guards
from wmrgen.geometry.constraints import working_view
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Length, Robot, Trailer
from wmrgen.geometry.ports import POSE, Port, Role, output
from wmrgen.geometry.printing import size
from wmrgen.geometry.symbolic import (
    Expr,
    add,
    angle_of,
    expression,
    maximum,
    minimum,
    root,
    rotated,
    signal,
    square,
    subtract,
    times,
)


def check_trailers(robot: Robot, mobility: Mobility) -> None:
    """Raise NotDerivableError for a body that cannot tow in this model."""
    if not robot.trailers:
        return
    names = ", ".join(t.name for t in robot.trailers)
    if mobility.degree_of_mobility == 3:
        raise UnderivableError(
            f"{robot.name} cannot tow {names}: its degree of mobility is 3, and a robot that can move sideways at any "
            "time has no axle that leads a trailer: if the robot moves sideways, the trailer jack-knifes.\n"
            "  Delete `trailers`; they need a body with fixed or steered wheels, degree of mobility 1 or 2.",
            Reason.MOBILITY,
            robot.trailers[0].mark,
        )
    if not mobility.degree_of_mobility:
        raise UnderivableError(
            f"{robot.name} cannot tow {names}: its degree of mobility is 0, it cannot move.",
            Reason.MOBILITY,
            robot.trailers[0].mark,
        )


def require_trailers(robot: Robot, mobility: Mobility) -> None:
    """Raise NotDerivableError if the file has no trailers, or for a body that cannot tow."""
    if not robot.trailers:
        raise UnderivableError(
            f"{robot.name} has no trailers.\n  Write trailers: [{{length: 1.1}}] in its file; hitch: 0 is on the axle.",
            Reason.NO_TRAILERS,
        )
    check_trailers(robot, mobility)


class Towed(NamedTuple):
    """The motion of a trailer's axle."""

    speed: Expr  # along its heading [m/s]
    turn: Expr  # yaw rate [rad/s]


def towed_axles(motion: Motion, axle: Axle, twist: Sequence[Expr], names: Locals | None) -> list[Towed]:
    """Return the motion of the axle of each trailer.

    Args:
        motion: The model of the body.
        axle: The axle that leads the first trailer.
        twist: The twist of P in the robot frame.
        names: Takes the intermediate results; None to write them out.

    Returns:
        The axles in the order of the trailers.
    """
    vx, vy, omega = twist
    axles: list[Towed] = []
    coupling: Vector = vx, vy
    for i, t in enumerate(motion.robot.trailers):
        hitch = in_view(t.hitch, motion.frame.symbolic)
        if axles:
            coupling = (
                axles[-1].speed,
                times(-1, expression(hitch), axles[-1].turn) if hitch else sympy.S.Zero,
            )
        else:
            x, y = axle.coupling(hitch)
            coupling = subtract(vx, times(y, omega)), add(vy, times(x, omega))
        angle = hitch_angle(motion.robot, i)
        if names is not None and coupling[1].args:
            coupling = coupling[0], names.define(f"{t.name}.across", coupling[1])
        if names is None:
            speed, across = rotated(sympy.cos(angle), sympy.sin(angle), *coupling)
        else:
            speed, across = names.turned(f"{t.name}.pull", coupling, angle)
        turn = times(sympy.Pow(expression(in_view(t.length, motion.frame.symbolic)), -1), across)
        if names is not None:
            speed, turn = names.define(f"{t.name}.speed", speed), names.define(f"{t.name}.turn", turn)
        axles.append(Towed(speed, turn))
    return axles


def turns(motion: Motion, mobility: Mobility, sideways: bool = True) -> list[Expr]:
    """Return the yaw rate of each trailer's axle [rad/s], in the twist of P (signals vx, vy, omega) and the headings.

    Args:
        motion: The model of the body.
        mobility: The mobility of the robot.
        sideways: Whether vy is a signal; otherwise it is 0.
    """
    axle = leading_axle(motion.robot, mobility, motion.frame.view)
    vy = signal("vy") if sideways else sympy.S.Zero
    return [own.turn for own in towed_axles(motion, axle, (signal("vx"), vy, signal("omega")), None)]


def in_view(length: Length, symbolic: bool) -> Poly:
    """Return a length with its parameters as symbols, or only the tunable ones."""
    return length.symbolic if symbolic else length.working


def hitch_angle(robot: Robot, i: int) -> Expr:
    """Return the heading of the vehicle ahead of trailer i minus the trailer's heading: 0 if it follows straight."""
    ahead = "theta" if i == 0 else f"{robot.trailers[i - 1].name}.theta"
    return subtract(signal(ahead), signal(f"{robot.trailers[i].name}.theta"))


def state_ports(trailers: Sequence[Trailer]) -> tuple[Port, ...]:
    """Return the port ``<trailer>.theta`` of each trailer."""
    text = "heading of the trailer, counter-clockwise from world x"
    return tuple(Port(f"{t.name}.theta", Role.STATE, "rad", text) for t in trailers)


@system("trailer")
def trailer_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """Return the posture model with the trailers' headings; inputs are eta if joints lack motors.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.
    """
    require_trailers(robot, mobility)
    return towing_system(best_motion(robot, mobility, symbolic), mobility)


def towing_system(motion: Motion, mobility: Mobility) -> System:
    """Return the posture model of a motion with the headings of the trailers."""
    trailers = motion.robot.trailers
    axle = fixed_axle(motion.robot, mobility, motion.frame.view)
    posture = system_of("trailer", motion)
    convoys, fields = [], []
    for field, twist in zip(posture.fields, motion.twists, strict=True):
        convoy = towed_axles(motion, axle or THROUGH_P, [expression(p) for p in twist], None)
        convoys.append(convoy)
        fields.append((*field, *(a.turn for a in convoy)))
    state = (*posture.state, *state_ports(trailers))

    def code() -> Formula:
        names = Locals()
        rates, twist = posture_rates(motion, names, motion.swivels)
        rates = (*rates, *(a.turn for a in towed_axles(motion, axle or THROUGH_P, twist, names)))
        outputs = zip(map(rate_port, state), rates, strict=True)
        return names.formula("trailer", (*state, *motion.inputs, *posture.geometry), outputs, motion.text)

    return posture._replace(
        text=f"body and {len(trailers)} trailer{'' if len(trailers) == 1 else 's'}: {motion.text}",
        state=state,
        fields=tuple(fields),
        domain=(*posture.domain, *_jackknives(motion, axle is not None, convoys)),
        code=code,
    )


def _jackknives(motion: Motion, on_fixed_axle: bool, convoys: list[list[Towed]]) -> list[Domain]:
    """Return where an axle stands still while pulled: cos(hitch angle) = 0 on the axle, speed 0 off it."""
    domains = []
    for i, t in enumerate(motion.robot.trailers):
        if not in_view(t.hitch, motion.frame.symbolic) and (i or on_fixed_axle):
            condition: Expr = sympy.cos(hitch_angle(motion.robot, i))
            why = "it is perpendicular to the vehicle ahead"
        else:
            speeds = [
                (chain[i].speed, u)
                for chain, u in zip(convoys, motion.inputs, strict=True)
                if chain[i].speed is not sympy.S.Zero
            ]
            alone = len(speeds) == 1
            condition = _cleared(add(*(v if alone else times(v, signal(u.name)) for v, u in speeds)))
            why = "its axle turns on the spot while it is pulled; at a larger angle it is pushed backwards"
        domains.append(Domain(condition, f"`{t.name}` is jack-knifed: {why}"))
    return domains


def _cleared(condition: Expr) -> Expr:
    """Return ``condition`` without denominators and common lengths: the same states make it 0.

    A condition that is too long to be shown is returned unchanged: the condition of trailer k has 2**k terms.
    """
    if size(condition) > LONGEST:
        return condition
    (cleared,) = whole([without_lengths(to_poly(condition))])
    return expression(cleared)


@function("Tzafestas 2.3.6, (2.70) corrected; off the axle it is ours", reads=("trailers",))
def trailer(robot: Robot, mobility: Mobility) -> Formula:
    """Return the rates of the posture and of the trailers' headings, and the speed of each trailer's axle."""
    require_trailers(robot, mobility)
    motion = best_motion(robot, mobility)
    axle = leading_axle(robot, mobility, motion.frame.view)
    model, names = towing_system(motion, mobility), Locals()
    rates, twist = posture_rates(motion, names, motion.swivels)
    axles = towed_axles(motion, axle, twist, names)
    rates = (*rates, *(a.turn for a in axles))
    outputs = [(rate_port(p), e) for p, e in zip(model.state, rates, strict=True)]
    speed = "speed of the trailer's axle; 0 when jack-knifed"
    outputs += [
        (output(f"{t.name}.speed", "m/s", speed), a.speed) for t, a in zip(robot.trailers, axles, strict=True)
    ]
    inputs = (*model.state, *model.inputs, *model.geometry)
    text = f"rates of a body with trailers (a trailer is jack-knifed if its speed is 0): {motion.text}"
    return with_guards(names.formula("trailer", inputs, outputs, text))


# ---- positions of trailers

CURVATURE = output("curvature", "1/m", "yaw rate of the body per speed of its axle centre")


def behind(point: Vector, length: Poly, heading: Expr) -> Vector:
    """Return the point that is ``length`` [m] behind another, seen along a heading in the world.

    Args:
        point: The point ahead [m].
        length: The distance [m].
        heading: The heading [rad].
    """
    x, y = point
    distance = expression(length)
    return subtract(x, times(distance, sympy.cos(heading))), subtract(y, times(distance, sympy.sin(heading)))


@function("Tzafestas 2.3.6", reads=("trailers",))
def trailer_positions(robot: Robot, mobility: Mobility) -> Formula:
    """Return the centre of each trailer's axle in the world frame [m], for the pose and the headings.

    On the axle x_i = x_Q - sum of L_j cos(theta_j).
    """
    require_trailers(robot, mobility)
    axle = leading_axle(robot, mobility, working_view)
    names = Locals()
    ahead = signal("theta")
    coupling = axle.coupling(robot.trailers[0].hitch.working)
    x, y = rotated(sympy.cos(ahead), sympy.sin(ahead), *coupling)
    at: Vector = add(signal("x"), x), add(signal("y"), y)
    outputs: list[tuple[Port, Expr]] = []
    for i, t in enumerate(robot.trailers):
        heading = signal(f"{t.name}.theta")
        if i:
            at = behind(at, t.hitch.working, ahead)
        x, y = behind(at, t.length.working, heading)
        at = names.define(f"{t.name}.at_x", x), names.define(f"{t.name}.at_y", y)
        text = "centre of the trailer's axle, world frame"
        outputs += [(Port(f"{t.name}.{k}", Role.STATE, "m", text), v) for k, v in zip("xy", at, strict=True)]
        ahead = heading
    inputs = (*POSE, *state_ports(robot.trailers), *tunable_ports(robot))
    text = "positions of the axles of the trailers"
    return names.formula("trailer_positions", inputs, outputs, text)


@function("Tzafestas 2.3.6, (2.70) at rest", reads=("trailers",))
def steady_circle(robot: Robot, mobility: Mobility) -> Formula:
    """Return hitch angle and speed of each trailer on the steady circle of a curvature, and ``margin``.

    Speeds are relative to the speed of the body's axle. The margin is the smallest v_i**2: the steady circle exists if
    it is not negative. Forward motion on it is stable.
    """
    require_trailers(robot, mobility)
    if fixed_axle(robot, mobility, working_view) is None:
        why = "its body has no fixed axle that leads the trailers"
        raise underivable(robot, "steady circle in closed form", why, Reason.AXLES)
    names = Locals()
    kappa = signal("curvature")
    bend = names.define("curvature_squared", square(kappa))
    margin: Expr | None = None
    squared: Expr = sympy.S.One
    speed: Expr = sympy.S.One
    outputs: list[tuple[Port, Expr]] = []
    for t in robot.trailers:
        length, hitch = t.length.working, t.hitch.working
        squared = names.define(
            f"{t.name}.squared", add(squared, times(expression(hitch**2 - length**2), bend))
        )
        margin = squared if margin is None else minimum(margin, squared)
        ahead = speed
        speed = names.define(f"{t.name}.speed", root(maximum(sympy.S.Zero, squared)))
        angle = angle_of(times(expression(length), kappa), speed)
        if hitch:
            angle = add(angle, angle_of(times(expression(hitch), kappa), ahead))
        text = "heading of the vehicle ahead minus its own heading, on the steady circle"
        outputs.append((output(f"{t.name}.hitch_angle", "rad", text), angle))
        text = "speed of its axle per speed of the body's axle, on the steady circle"
        outputs.append((output(f"{t.name}.speed", "", text), speed))
    text = "smallest squared speed ratio: the steady circle exists if it is not negative"
    outputs.append((output("margin", "", text), margin))
    text = "hitch angles on the steady circle of constant curvature"
    return names.formula("steady_circle", (CURVATURE, *tunable_ports(robot)), outputs, text)
