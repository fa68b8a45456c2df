"""Wheels that slip: spins for a twist and given longitudinal slip, and the lateral slip that follows.

At the heading e that a wheel has now, n = z x e, contact B (Tzafestas Ex. 2.2, corrected for steered wheels):

    r spin = e . v_B + slip_x,     slip_y = n . v_B
"""

from __future__ import annotations

from wmrgen.constraints import rolling_row, sliding_row, working_view
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.functions.registry import function
from wmrgen.kinematics.records import Formula, given, joint_port, tunable_ports, twist_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Limits, Port, Role
from wmrgen.symbolic import Expr, expression

TEXT = {
    "slip_x": "longitudinal slip: rim speed minus speed of the contact along the rolling direction",
    "slip_y": "lateral slip: velocity of the contact to the left of the rolling direction",
}


def slip_port(w: Wheel, name: str) -> Port:
    """``<wheel>.slip_x`` or ``<wheel>.slip_y``"""
    text = TEXT[name]
    if w.kind.rollers:
        text = "slip along the roller axis: what the rim adds there minus the contact's velocity"
    return Port(f"{w.name}.{name}", Role.COMMAND, "m/s", text)


@function("Tzafestas Example 2.2, corrected for steered wheels", limits=Limits.COMMANDED)
def slip_inverse(robot: Robot, _: Mobility) -> Formula:
    """vx vy omega, steering angles and rates and slip_x to every wheel's spin and every standard wheel's slip_y.

    The twist is not projected: what the wheels do not roll they slip.
    """
    twist: Row = (given("vx"), given("vy"), given("omega"))
    inputs = [*twist_ports()]
    inputs += [joint_port(w, "steer", Role.STATE) for w in robot.wheels if w.turns]
    inputs += [joint_port(w, "steer_rate", Role.COMMAND) for w in robot.wheels if _swings(w)]
    outputs: list[tuple[Port, Expr]] = []
    for w in robot.wheels:
        g = working_view(w)
        rate = given(f"{w.name}.steer_rate") if _swings(w) else Poly({})
        if w.has_spin:
            inputs.append(slip_port(w, "slip_x"))
            rim = dot(rolling_row(w, g).row, twist) - g.o * rate + given(f"{w.name}.slip_x")
            spin = expression(rim * g.rolling_radius.inverse())
            outputs.append((joint_port(w, "spin", Role.COMMAND), spin))
        if w.kind.sliding_row:
            lateral = dot(sliding_row(w, g).row, twist) + g.d * rate
            outputs.append((slip_port(w, "slip_y"), expression(lateral)))
    return Formula(
        "slip_inverse", (*inputs, *tunable_ports(robot)), (), tuple(outputs),
        "twist of P, steering and longitudinal slip to wheel speeds and lateral slip",
    )  # fmt: skip


def _swings(w: Wheel) -> bool:
    """True where the steering rate moves the contact."""
    return w.turns and bool(w.nominal.d or w.nominal.o)
