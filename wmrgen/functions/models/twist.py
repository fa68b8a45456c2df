"""The model in twist inputs: how a controller commands a robot, regular in every motion.

Robots that steer two axles or more have no chart of steering coordinates that covers turning on the spot and driving
sideways alike. Here the angles of the modules are states, their rates and the twist are inputs, and rolling is a
constraint g(x, u) = 0: that no steered wheel slides. Where fixed wheels leave a sideways velocity, it follows from the
others; where they leave none that people drive with (skid-steer), it is the one of least sliding.
"""

from __future__ import annotations

import sympy

from wmrgen.constraints import View, sliding_row, symbolic_view, working_view
from wmrgen.functions.models.posture import in_world
from wmrgen.functions.models.tied import meeting, only_straight, tied
from wmrgen.functions.registry import system, underivable
from wmrgen.functions.system import System
from wmrgen.kinematics.records import Formula, Locals, joint_port, parameter_ports, tunable_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.layout.skid import no_track, parallel
from wmrgen.mobility.basis import led
from wmrgen.mobility.records import Mobility
from wmrgen.ports import POSE, TWIST, Port, Role, output
from wmrgen.symbolic import Expr, add, expression, over, signal, square, times

Column = tuple[Expr, Expr, Expr]


@system("twist")
def twist_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """State x y theta and the angles of steered wheels; inputs the components of the twist that fixed wheels leave, and
    steering rates. NotDerivableError where fixed wheels point in different directions."""
    view = symbolic_view if symbolic else working_view
    inputs, columns = _free(robot, mobility, view)
    steered = _steered(robot)
    still = (sympy.S.Zero,) * len(steered)
    turns = ((*(sympy.S.Zero,) * 3, *still[:k], sympy.S.One, *still[k + 1 :]) for k in range(len(steered)))
    return System(
        "twist",
        f"model in twist inputs{_condition(robot, mobility)}",
        (*POSE, *(joint_port(w, "steer", Role.STATE) for w in steered)),
        (*inputs, *(joint_port(w, "steer_rate", Role.COMMAND) for w in steered)),
        (*((*in_world(column), *still) for column in columns), *turns),
        parameter_ports(robot) if symbolic else tunable_ports(robot),
        meeting(robot, view),
    )


def sliding(robot: Robot, mobility: Mobility) -> Formula | None:
    """g(x, u): by how much steered wheels slide [m/s] (Siegwart (3.16)) under state and inputs of `twist_system`; None
    where nothing steers. Of wheels that turn together as many as say all, see `tied`: one and the yaw rate, or two."""
    sets, straight = tied(robot), only_straight(robot)
    if not sets:
        return None
    system, (inputs, columns) = twist_system(robot, mobility), _free(robot, mobility, working_view)
    outputs = []
    for w in (w for members in sets for w in members[: 1 if straight else 2]):
        row = [expression(led(robot, p)) for p in sliding_row(w, working_view(w)).row]
        terms = (
            times(add(*map(times, row, column)), signal(port.name))
            for port, column in zip(inputs, columns, strict=True)
        )
        outputs.append(
            (output(f"{w.name}.slide", "m/s", "velocity of the contact along the axle"), add(*terms))
        )
    if straight:
        outputs.append((TWIST[2], signal(TWIST[2].name)))
    ports = (*system.state, *system.inputs, *system.geometry)
    return Locals().formula(
        "sliding", ports, outputs, "velocity at which each steered wheel slides, 0 where it rolls"
    )


def goes_straight(mobility: Mobility) -> bool:
    """Whether no motion without sliding turns the robot."""
    return not any(column[2] for column in mobility.scaled_symbolic)


def where_it_slides(mobility: Mobility) -> str:
    """Where a form does not hold that leaves out sliding."""
    return f"wheels slide, as they do in every {'curve' if goes_straight(mobility) else 'motion but one'}"


def _steered(robot: Robot) -> list[Wheel]:
    """The first of each set of steered wheels that turn together."""
    return [w for w in robot.wheels if w.kind.steers and robot.steer_group[w.index] == w.index]


def _condition(robot: Robot, mobility: Mobility) -> str:
    text = "; it holds where no steered wheel slides" if _steered(robot) else ""
    if mobility.degenerate and mobility.rank_C1f.value < 2:  # wheels whose spins are coupled
        text += f"; {where_it_slides(mobility)}"
    if mobility.rank_C1f.value > 1:
        text += "; its fixed wheels slide where it turns, and the sideways velocity is that of least sliding"
        if not any(no_track(robot.wheels)):
            text += "; effective_track in the robot file would say which wheel speeds turn it so"
    return text


def _free(robot: Robot, mobility: Mobility, view: View) -> tuple[tuple[Port, ...], tuple[Column, ...]]:
    """The components of the twist that are inputs, and the twist that each makes."""
    wheels = [w for w in robot.wheels if w.kind.fixed_axle]
    units = [tuple(sympy.Integer(int(i == k)) for i in range(3)) for k in range(3)]
    if not wheels:
        return TWIST, tuple((x, y, turn) for x, y, turn in units)
    if not parallel([w.zero_heading for w in wheels]):
        raise underivable(robot, "model in twist inputs", "its fixed wheels point in different directions")
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
