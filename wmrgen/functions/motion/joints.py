"""The twist that sensed joint rates make, steering held: what constant commands drive."""

from __future__ import annotations

import sympy

from wmrgen.functions.motion.compose import include, named
from wmrgen.kinematics.forward import forward
from wmrgen.kinematics.records import Locals
from wmrgen.layout.records import Robot
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr

TWIST = ("vx", "vy", "omega")


def driven(robot: Robot, names: Locals) -> tuple[tuple[Port, ...], list[Expr]]:
    """Inputs (sensed spins and steering angles, tunable parameters) and the twist in the robot frame.

    Steering rates are zero: a constant command holds every steering angle, and the Jacobian with it.
    """
    formula = forward(robot)
    held = {p.name: sympy.S.Zero for p in formula.inputs if p.name.endswith(".steer_rate")}
    twist = named(include(formula, held, names), TWIST, "driven", names)
    return tuple(p for p in formula.inputs if p.name not in held), twist


def joint_ports(ports: tuple[Port, ...]) -> tuple[Port, ...]:
    """The ports that change from step to step."""
    return tuple(p for p in ports if p.role is not Role.GEOMETRY)


def geometry(ports: tuple[Port, ...]) -> tuple[Port, ...]:
    """The tunable parameters among ``ports``."""
    return tuple(p for p in ports if p.role is Role.GEOMETRY)
