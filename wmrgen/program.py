"""The program of a robot: every function of its model in symbols, ready to be lowered.

`STANDARD` functions are generated for every robot, `OPTIONAL` ones where its file asks for them under `functions`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import import_module
from typing import cast

from wmrgen.errors import NotDerivableError
from wmrgen.kinematics import Formula, contacts, dynamics, forward, inverse, odometry
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility

Builder = Callable[[Robot, Mobility], Formula]


@dataclass(frozen=True, slots=True)
class Program:
    """The formulas of a robot, in the order in which they are emitted."""

    name: str
    formulas: tuple[Formula, ...]

    def formula(self, name: str) -> Formula:
        """The formula called ``name``; KeyError when there is none."""
        return {f.name: f for f in self.formulas}[name]


def _contacts(robot: Robot, _: Mobility) -> Formula:
    found = contacts(robot)
    if found is None:
        raise NotDerivableError(
            f"{robot.name} has no contacts: it has neither rollers (r_sw) nor spheres with a radius (r)"
        )
    return found


STANDARD: dict[str, Builder] = {
    "inverse": inverse,
    "forward": lambda robot, _: forward(robot),
    "odometry": lambda robot, _: odometry(),
    "dynamics": dynamics,
    "contacts": _contacts,
}
IN_C = ("inverse", "forward", "odometry")  # of the standard ones: what firmware runs

# Function -> where its builder stands; imported when asked for. A builder raises NotDerivableError where the
# robot cannot have the function.
OPTIONAL: dict[str, str] = {
    "motion": "wmrgen.motion.circle:motion",
    "circle": "wmrgen.motion.circle:circle",
    "icr": "wmrgen.motion.icr:icr",
    "axles": "wmrgen.motion.axles:axles",
    "steer_to": "wmrgen.motion.icr:steer_to",
    "reach": "wmrgen.motion.reach:reach",
    "contact_velocity": "wmrgen.motion.points:contact_velocity",
    "projections": "wmrgen.motion.points:projections",
    "inverse_world": "wmrgen.motion.world:inverse_world",
    "forward_world": "wmrgen.motion.world:forward_world",
    "vaf": "wmrgen.motion.vaf:vaf",
    "compatibility": "wmrgen.motion.compatibility:compatibility",
    "heading": "wmrgen.motion.heading:heading",
    "goto_pose": "wmrgen.control.goto_pose:goto_pose",
    "pursuit": "wmrgen.control.pursuit:pursuit",
    "posture": "wmrgen.models.functions:posture",
    "configuration": "wmrgen.models.functions:configuration",
    "virtual_steering": "wmrgen.models.virtual:virtual_steering",
    "virtual_angle": "wmrgen.models.virtual:virtual_angle",
    "zeta": "wmrgen.models.zeta:zeta",
    "trailer": "wmrgen.models.trailers:trailer",
    "trailer_positions": "wmrgen.models.places:trailer_positions",
    "steady_circle": "wmrgen.models.steady:steady_circle",
    "slip_inverse": "wmrgen.models.slip:slip_inverse",
    "chained": "wmrgen.models.chained:chained",
    "chained_input": "wmrgen.models.chained:chained_input",
    "chained_rates": "wmrgen.models.chained:chained_rates",
    "brockett": "wmrgen.models.canonical:brockett",
    "brockett_input": "wmrgen.models.canonical:brockett_input",
    "brockett_rates": "wmrgen.models.canonical:brockett_rates",
    "desaturate": "wmrgen.edges.desaturate:desaturate",
    "inverse_together": "wmrgen.edges.together:inverse_together",
    "wheel_angles": "wmrgen.models.integrals:wheel_angles",
    "flat": "wmrgen.models.flat:flat",
    "input_limits": "wmrgen.control.input_limits:input_limits",
    "accelerations": "wmrgen.space.accelerations:accelerations",
    "wheel_motion": "wmrgen.space.wheel_motion:wheel_motion",
    "stability": "wmrgen.space.stability:stability",
    "cg_force": "wmrgen.space.specific_force:cg_force",
}


def functions() -> tuple[str, ...]:
    """Names of all functions that a robot may have."""
    return (*STANDARD, *OPTIONAL)


def formula(robot: Robot, mobility: Mobility, name: str) -> Formula:
    """One function. KeyError for an unknown name, NotDerivableError where the robot does not have it."""
    if name in STANDARD:
        return STANDARD[name](robot, mobility)
    module, _, attribute = OPTIONAL[name].partition(":")
    builder = cast(Builder, getattr(import_module(module), attribute))
    return builder(robot, mobility)


def program(robot: Robot, mobility: Mobility, names: Iterable[str]) -> Program:
    """The named functions of a robot."""
    return Program(robot.name, tuple(formula(robot, mobility, name) for name in names))


def standard(robot: Robot) -> tuple[str, ...]:
    """The functions generated for a robot: the standard ones that it has, then those it asks for."""
    has = [name for name in STANDARD if name != "contacts" or contacts(robot) is not None]
    return (*has, *(name for name in asked(robot) if name not in has))


def asked(robot: Robot) -> tuple[str, ...]:
    """The functions beyond the standard ones that a robot file asks for; `slip: true` asks for slip_inverse."""
    slip = ("slip_inverse",) if robot.slip and "slip_inverse" not in robot.functions else ()
    return (*robot.functions, *slip)
