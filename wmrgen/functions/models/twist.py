"""The model in twist inputs: how a controller commands a robot, regular in every motion.

Robots that steer two axles or more have no steering coordinates that cover both turning on the spot and driving
sideways. Here the angles of the modules are states, their rates and the twist are inputs, and rolling is a constraint
g(x, u) = 0: no steered wheel slides. The angles of driven castors are also states. Their rates follow from the twist,
d steer' = -(sliding row) . xi, which no angle makes singular. Wheel speeds and steering rates are limits h(x, u). If
fixed wheels allow only some sideways velocity, it follows from the other components. If they allow no useful motion
(skid-steer), the sideways velocity is that of least sliding.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, parameter_ports, tunable_ports
from wmrgen.analysis.mobility.basis import led
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.posture import in_world
from wmrgen.functions.models.tied import only_straight, parallel_groups, where_motions_meet
from wmrgen.functions.registry import Reason, system, underivable
from wmrgen.functions.system import System, rate_port
from wmrgen.geometry.constraints import View, heading, sliding_row, symbolic_view, working_view
from wmrgen.geometry.exact.poly import triple
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.layout.skid import no_track, parallel
from wmrgen.geometry.ports import POSE, TWIST, TWIST_NAMES, Port, Role, output
from wmrgen.geometry.symbolic import Expr, add, expression, over, signal, square, subtract, times

Column = tuple[Expr, Expr, Expr]


@system("twist")
def twist_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """Return the model in twist inputs.

    Its state is x y theta and the angles of steered wheels and driven castors. Its inputs are the components of the
    twist that fixed wheels leave free, and steering rates.

    Args:
        robot: The robot.
        mobility: Its mobility.
        symbolic: Whether all parameters are symbols, or only the tunable ones.

    Raises:
        NotDerivableError: If fixed wheels point in different directions.
    """
    view = symbolic_view if symbolic else working_view
    inputs, columns = _free_components(robot, mobility, view)
    steered, castors = _steered(robot), _driven_castors(robot)
    still = (sympy.S.Zero,) * len(steered)
    turns = (
        (*(sympy.S.Zero,) * 3, *still[:k], sympy.S.One, *still[k + 1 :], *(sympy.S.Zero,) * len(castors))
        for k in range(len(steered))
    )
    swings = [[_swing_rate(robot, w, view, column) for w in castors] for column in columns]
    state = (*POSE, *(joint_port(w, "steer", Role.STATE) for w in (*steered, *castors)))
    rates = tuple(joint_port(w, "steer_rate", Role.COMMAND) for w in steered)
    geometry = parameter_ports(robot) if symbolic else tunable_ports(robot)
    text = f"model in twist inputs{_validity(robot, mobility)}"

    def code() -> Formula:
        names = Locals()
        twist = _named_twist(inputs, columns, names)
        velocity = names.turned("velocity", twist[:2], signal("theta"))
        swung = (_swing_rate(robot, w, view, twist) for w in castors)
        values = (*velocity, twist[2], *(signal(port.name) for port in rates), *swung)
        outputs = zip(map(rate_port, state), values, strict=True)
        return names.formula("twist", (*state, *inputs, *rates, *geometry), outputs, text)

    return System(
        "twist",
        text,
        state,
        (*inputs, *rates),
        (*((*in_world(c), *still, *swing) for c, swing in zip(columns, swings, strict=True)), *turns),
        geometry,
        where_motions_meet(robot, view),
        code,
    )


def _named_twist(inputs: Sequence[Port], columns: Sequence[Column], names: Locals) -> Column:
    """Return the twist of P, robot frame: inputs themselves, or intermediate results for dependent components."""

    def component(i: int) -> Expr:
        return add(*(times(column[i], signal(u.name)) for column, u in zip(columns, inputs, strict=True)))

    sums = map(component, range(3))
    return triple(
        names.define(f"body_{name}", e) if e.args else e for name, e in zip(TWIST_NAMES, sums, strict=True)
    )


def _swing(robot: Robot, w: Wheel, view: View, twist: Column) -> Expr:
    """Return d times the steering rate at which the contact of a castor does not slide: -(sliding row) . xi.

    This is the velocity of the point at d from its pivot along its axle (Siegwart (3.18)). No angle makes it singular.
    """
    g, (vx, vy, omega) = view(w), twist
    (c, s), (x, y) = (expression(led(robot, p)) for p in heading(w, g)), (expression(g.x), expression(g.y))
    ahead, left = subtract(vx, times(y, omega)), add(vy, times(x, omega))
    return subtract(times(s, ahead), add(times(c, left), times(expression(g.d), omega)))


def sliding(robot: Robot, mobility: Mobility) -> Formula | None:
    """Return g(x, u), the sliding speeds of wheels [m/s] (Siegwart (3.16)); None if no wheel can slide.

    Steered wheels that turn together need only as many constraints as determine all, see `parallel_groups`: one wheel
    and the yaw rate, or two wheels. Driven castors that swing together need one for all but the first, whose rate they
    share.
    """
    sets, straight = parallel_groups(robot), only_straight(robot)
    swinging = [members for members in robot.together("steer", _swiveling(robot)) if len(members) > 1]
    if not sets and not swinging:
        return None
    system, (inputs, columns) = twist_system(robot, mobility), _free_components(robot, mobility, working_view)
    names = Locals()
    twist = _named_twist(inputs, columns, names)
    outputs = []
    for w in (w for members in sets for w in members[: 1 if straight else 2]):
        row = [expression(led(robot, p)) for p in sliding_row(w, working_view(w)).row]
        outputs.append((_slide_port(w), add(*map(times, row, twist))))
    for first, *others in swinging:
        rate = _swing_rate(robot, first, working_view, twist)
        for w in others:
            swing = _swing(robot, w, working_view, twist)
            outputs.append((_slide_port(w), subtract(times(expression(working_view(w).d), rate), swing)))
    if sets and straight:
        outputs.append((TWIST[2], signal(TWIST[2].name)))
    ports = (*system.state, *system.inputs, *system.geometry)
    return names.formula("sliding", ports, outputs, "sliding speed of each wheel, 0 if it rolls")


def _slide_port(w: Wheel) -> Port:
    """Return the output for the sliding speed of a wheel."""
    return output(f"{w.name}.slide", "m/s", "velocity of the contact along the axle")


def goes_straight(mobility: Mobility) -> bool:
    """Return whether every motion without sliding keeps the heading."""
    return not any(column[2] for column in mobility.scaled_symbolic)


def where_it_slides(mobility: Mobility) -> str:
    """Return a sentence on the motions that a form without sliding does not cover."""
    return f"wheels slide, as they do in every {'curve' if goes_straight(mobility) else 'motion but one'}"


def _steered(robot: Robot) -> list[Wheel]:
    """Return the first wheel of each group of steered wheels that turn together."""
    return [w for w in robot.wheels if w.kind.steers and robot.steer_group[w.index] == w.index]


def _swing_rate(robot: Robot, w: Wheel, view: View, twist: Column) -> Expr:
    """Return the steering rate of a castor [rad/s]."""
    return over(_swing(robot, w, view, twist), expression(view(w).d))


def _swiveling(robot: Robot) -> list[Wheel]:
    """Return castors of groups that swing together and have a driven member: their speeds depend on their angles."""
    groups = {robot.steer_group[w.index] for w in robot.wheels if w.kind.swivels and w.actuated}
    return [w for w in robot.wheels if robot.steer_group[w.index] in groups]


def _driven_castors(robot: Robot) -> list[Wheel]:
    """Return the first castor of each group that swings together and has a driven member."""
    return [members[0] for members in robot.together("steer", _swiveling(robot))]


def _validity(robot: Robot, mobility: Mobility) -> str:
    """Return the end of the model's description: under which condition it holds."""
    text = "; it holds where no steered wheel slides" if _steered(robot) else ""
    if mobility.degenerate and mobility.rank_C1f.value < 2:  # wheels whose spins are coupled
        text += f"; {where_it_slides(mobility)}"
    if mobility.rank_C1f.value > 1:
        text += "; its fixed wheels slide when it turns, and the sideways velocity is that of least sliding"
        if not any(no_track(robot.wheels)):
            text += "; effective_track in the robot file would give the wheel speeds of a turn"
    return text


def _free_components(
    robot: Robot, mobility: Mobility, view: View
) -> tuple[tuple[Port, ...], tuple[Column, ...]]:
    """Return the components of the twist that are inputs, and the twist that each of them causes."""
    wheels = [w for w in robot.wheels if w.kind.fixed_axle]
    units = [[sympy.Integer(int(i == k)) for i in range(3)] for k in range(3)]
    if not wheels:
        return TWIST, tuple((x, y, turn) for x, y, turn in units)
    if not parallel([w.zero_heading for w in wheels]):
        raise underivable(
            robot, "model in twist inputs", "its fixed wheels point in different directions", Reason.AXLES
        )
    heading = wheels[0].zero_heading
    dependent = 1 if abs(heading.real) > abs(heading.imag) else 0
    rows = [[expression(p) for p in sliding_row(w, view(w)).row] for w in wheels]
    rows = rows if mobility.rank_C1f.value > 1 else rows[:1]
    divisor = add(*(square(row[dependent]) for row in rows))
    columns = []
    for k in (i for i in range(3) if i != dependent):
        column = list(units[k])
        column[dependent] = over(
            times(sympy.S.NegativeOne, add(*(times(row[dependent], row[k]) for row in rows))), divisor
        )
        columns.append((column[0], column[1], column[2]))
    return tuple(port for k, port in enumerate(TWIST) if k != dependent), tuple(columns)
