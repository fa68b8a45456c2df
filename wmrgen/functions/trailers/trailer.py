"""Trailers behind a body (Tzafestas 2.3.6, (2.70) corrected; off-axle hitches included).

Trailer i turns about its axle, L_i behind its coupling. With t_i its direction and n_i = z x t_i, the velocity V
of the coupling splits into what the axle follows and what turns the trailer:

    v_i = V . t_i,   L_i theta_i' = V . n_i        (so n_i . (velocity of the axle) = 0: it does not slide)

The next coupling lies hitch h behind that axle: V = v_i t_i - h theta_i' n_i. Behind the body the hitch is measured
from the fixed axle at the centre of the fixed wheels, from P where there is none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import sympy

from wmrgen.constraints import View
from wmrgen.errors import NotDerivableError
from wmrgen.exact.poly import Poly
from wmrgen.functions.models.frame import clean
from wmrgen.functions.models.posture import Motion, best_motion, posture_field, posture_state
from wmrgen.functions.registry import function, system
from wmrgen.functions.system import Domain, System, guarded, rate_port
from wmrgen.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.layout.records import Length, Robot, Trailer
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, add, expression, signal, subtract, times

Vector = tuple[Expr, Expr]


@dataclass(frozen=True, slots=True)
class Body:
    """Where the body tows: axle point (x, y), its forward direction (fx, fy), robot frame."""

    x: Poly
    y: Poly
    fx: Poly
    fy: Poly
    axle: bool  # False where the body has no fixed axle and P stands for its centre


def body_of(robot: Robot, mobility: Mobility, view: View) -> Body:
    """The centre of the fixed wheels, which lies on their axle, or P."""
    one, zero = Poly.of(1), Poly({})
    wheels = [w for w in robot.wheels if w.kind.fixed_axle]
    if not wheels or mobility.rank_C1f.value != 1:
        return Body(zero, zero, one, zero, False)
    g = [view(w) for w in wheels]
    share = Fraction(1, len(g))
    x, y = (clean(Poly.sum(getattr(w, k) for w in g).scale(share)) for k in "xy")
    lead = wheels[0].nominal
    ahead = lead.ch if abs(float(lead.ch)) > 1e-9 else lead.sh
    sign = 1 if float(ahead) > 0 else -1
    return Body(x, y, g[0].ch.scale(sign), g[0].sh.scale(sign), True)


def check_trailers(robot: Robot, mobility: Mobility) -> None:
    """NotDerivableError for a body that cannot tow in this model."""
    if not robot.trailers:
        return
    names = ", ".join(t.name for t in robot.trailers)
    if mobility.degree_of_mobility == 3:
        raise NotDerivableError(
            f"{robot.name} cannot tow {names}: its degree of mobility is 3, and a robot that can move sideways at any "
            "time has no axle that leads a trailer: pushed sideways it jack-knifes.\n"
            "  Trailers go behind a body with fixed or steered wheels, degree of mobility 1 or 2; delete `trailers`.",
            robot.trailers[0].mark,
        )
    if not mobility.degree_of_mobility:
        raise NotDerivableError(
            f"{robot.name} cannot tow {names}: its degree of mobility is 0, it cannot move.",
            robot.trailers[0].mark,
        )


@dataclass(frozen=True, slots=True)
class Axle:
    """Speed along and yaw rate of an axle, and its direction in the world."""

    speed: Expr
    turn: Expr
    theta: Expr


def convoy(motion: Motion, body: Body, twist: Sequence[Expr], names: Locals | None) -> list[Axle]:
    """The axle of each trailer under a twist of P in the robot frame. With ``names`` shared results are named."""
    view = motion.frame.symbolic
    trailers = motion.robot.trailers
    vx, vy, omega = twist
    h = _of(trailers[0].hitch, view)
    px, py = body.x - body.fx * h, body.y - body.fy * h
    coupling: Vector = (
        subtract(vx, times(expression(py), omega)),
        add(vy, times(expression(px), omega)),
    )
    ahead = signal("theta")
    found: list[Axle] = []
    for i, t in enumerate(trailers):
        theta = signal(f"{t.name}.theta")
        speed, across = _into(coupling, subtract(ahead, theta), names, t.name)
        turn = times(sympy.Pow(expression(_of(t.length, view)), -1), across)
        if names is not None:
            speed = names.define(f"{t.name}.speed", speed)
            turn = names.define(f"{t.name}.turn", turn)
        found.append(Axle(speed, turn, theta))
        if i + 1 < len(trailers):
            h = _of(trailers[i + 1].hitch, view)
            coupling = (speed, times(-1, expression(h), turn) if h else sympy.S.Zero)
        ahead = theta
    return found


def _into(coupling: Vector, hitch_angle: Expr, names: Locals | None, name: str) -> Vector:
    """The coupling's velocity along and across a trailer that lies ``hitch_angle`` behind what pulls it."""
    a, b = coupling
    c, s = sympy.cos(hitch_angle), sympy.sin(hitch_angle)
    if names is not None:
        c, s = names.define(f"{name}.cos", c), names.define(f"{name}.sin", s)
    return subtract(times(a, c), times(b, s)), add(times(a, s), times(b, c))


def _of(length: Length, symbolic: bool) -> Poly:
    return length.symbolic if symbolic else length.working


def hitch_angle(robot: Robot, i: int) -> Expr:
    """Heading of what pulls trailer i minus that of the trailer: 0 when it follows straight."""
    ahead = "theta" if i == 0 else f"{robot.trailers[i - 1].name}.theta"
    return subtract(signal(ahead), signal(f"{robot.trailers[i].name}.theta"))


def state_ports(trailers: Sequence[Trailer]) -> tuple[Port, ...]:
    """``<trailer>.theta`` of each."""
    text = "heading of the trailer, counter-clockwise from world x"
    return tuple(Port(f"{t.name}.theta", Role.STATE, "rad", text) for t in trailers)


def require_trailers(robot: Robot) -> None:
    """NotDerivableError where the file names none."""
    if not robot.trailers:
        raise NotDerivableError(
            f"{robot.name} has no trailers.\n  Write trailers: [{{length: 1.1}}] in its file; hitch: 0 is on the axle."
        )


def trailer_motion(robot: Robot, mobility: Mobility, symbolic: bool = False) -> tuple[Motion, Body]:
    """How the body moves and where it tows. NotDerivableError where it cannot."""
    require_trailers(robot)
    check_trailers(robot, mobility)
    motion = best_motion(robot, mobility, symbolic)
    return motion, body_of(robot, mobility, motion.frame.view)


@system("trailer")
def trailer_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """Posture state and the trailers' headings; inputs as in the posture model, eta where actuation is missing."""
    motion, body = trailer_motion(robot, mobility, symbolic)
    rows = [[expression(p) for p in twist] for twist in motion.twists]
    axles = [convoy(motion, body, row, None) for row in rows]
    fields = tuple(
        (*posture_field(motion, port, twist), *(a.turn for a in chain))
        for port, twist, chain in zip(motion.inputs, motion.twists, axles, strict=True)
    )
    state = (*posture_state(motion), *state_ports(robot.trailers))
    domain = (*motion.domain, *_jackknives(motion, body, axles))
    text = f"body and {len(robot.trailers)} trailer{'' if len(robot.trailers) == 1 else 's'}: {motion.text}"
    return System("trailer", text, state, motion.inputs, fields, motion.geometry, domain)


def _jackknives(motion: Motion, body: Body, axles: list[list[Axle]]) -> list[Domain]:
    """Where an axle stands still while it is pulled: cos(hitch angle) = 0 on the axle, speed 0 off it."""
    found = []
    for i, t in enumerate(motion.robot.trailers):
        if not _of(t.hitch, motion.frame.symbolic) and (i or body.axle):
            condition: Expr = sympy.cos(hitch_angle(motion.robot, i))
            why = "what pulls it stands square to it and cannot move it"
        else:
            parts = [
                (chain[i].speed, u)
                for chain, u in zip(axles, motion.inputs, strict=True)
                if chain[i].speed is not sympy.S.Zero
            ]
            condition = parts[0][0] if len(parts) == 1 else add(*(times(v, signal(u.name)) for v, u in parts))
            why = "its axle stands still and turns on the spot while it is pulled; beyond, it is pushed backwards"
        found.append(Domain(condition, f"{t.name} is jack-knifed: {why}"))
    return found


@function("Tzafestas 2.3.6, (2.70) corrected; off the axle it is ours")
def trailer(robot: Robot, mobility: Mobility) -> Formula:
    """Rates of the posture and of the trailers' headings, and the speed of each trailer's axle (0 when jack-knifed)."""
    motion, body = trailer_motion(robot, mobility)
    names = Locals()
    memo: dict[Expr, Expr] = {}
    twist = [_summed(motion, i, names, memo) for i in range(3)]
    theta = signal("theta")
    c, s = names.define("cos_theta", sympy.cos(theta)), names.define("sin_theta", sympy.sin(theta))
    world = (
        subtract(times(twist[0], c), times(twist[1], s)),
        add(times(twist[0], s), times(twist[1], c)),
        twist[2],
    )
    state = posture_state(motion)
    pairs = [(posture_field(motion, u, t), u) for u, t in zip(motion.inputs, motion.twists, strict=True)]
    joints = [
        guarded(add(*(times(field[i], signal(u.name)) for field, u in pairs)), names, memo)
        for i in range(3, len(state))
    ]
    axles = convoy(motion, body, twist, names)
    headings = state_ports(robot.trailers)
    rates = (*world, *joints, *(a.turn for a in axles))
    outputs = [(rate_port(p), e) for p, e in zip((*state, *headings), rates, strict=True)]
    outputs += [
        (
            Port(f"{t.name}.speed", Role.COMMAND, "m/s", "speed of the trailer's axle; 0 when jack-knifed"),
            a.speed,
        )
        for t, a in zip(robot.trailers, axles, strict=True)
    ]
    inputs = (*state, *headings, *motion.inputs, *tunable_ports(robot))
    text = f"rates of a body with trailers (one is jack-knifed where its speed is 0): {motion.text}"
    return Formula("trailer", inputs, tuple(names.items), tuple(outputs), text)


def _summed(motion: Motion, i: int, names: Locals, memo: dict[Expr, Expr]) -> Expr:
    """Component i of the twist of P, all inputs together."""
    terms = [
        times(expression(t[i]), signal(u.name)) for t, u in zip(motion.twists, motion.inputs, strict=True)
    ]
    total = add(*terms)
    return total if total is sympy.S.Zero else names.define(f"body_{'xyz'[i]}", guarded(total, names, memo))
