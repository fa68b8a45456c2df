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
    "motion": "wmrgen.functions.motion.circle:motion",
    "circle": "wmrgen.functions.motion.circle:circle",
    "icr": "wmrgen.functions.motion.icr:icr",
    "axles": "wmrgen.functions.motion.axles:axles",
    "steer_to": "wmrgen.functions.motion.icr:steer_to",
    "reach": "wmrgen.functions.motion.reach:reach",
    "contact_velocity": "wmrgen.functions.motion.points:contact_velocity",
    "projections": "wmrgen.functions.motion.points:projections",
    "inverse_world": "wmrgen.functions.motion.world:inverse_world",
    "forward_world": "wmrgen.functions.motion.world:forward_world",
    "vaf": "wmrgen.functions.motion.vaf:vaf",
    "compatibility": "wmrgen.functions.motion.compatibility:compatibility",
    "heading": "wmrgen.functions.motion.heading:heading",
    "goto_pose": "wmrgen.functions.control.goto_pose:goto_pose",
    "pursuit": "wmrgen.functions.control.pursuit:pursuit",
    "posture": "wmrgen.functions.models.systems:posture",
    "configuration": "wmrgen.functions.models.systems:configuration",
    "virtual_steering": "wmrgen.functions.models.virtual:virtual_steering",
    "virtual_angle": "wmrgen.functions.models.virtual:virtual_angle",
    "zeta": "wmrgen.functions.models.zeta:zeta",
    "trailer": "wmrgen.functions.trailers.trailer:trailer",
    "trailer_positions": "wmrgen.functions.trailers.trailer_positions:trailer_positions",
    "steady_circle": "wmrgen.functions.trailers.steady_circle:steady_circle",
    "slip_inverse": "wmrgen.functions.models.slip:slip_inverse",
    "chained": "wmrgen.functions.trailers.chained:chained",
    "chained_input": "wmrgen.functions.trailers.chained:chained_input",
    "chained_rates": "wmrgen.functions.trailers.chained:chained_rates",
    "brockett": "wmrgen.functions.trailers.brockett:brockett",
    "brockett_input": "wmrgen.functions.trailers.brockett:brockett_input",
    "brockett_rates": "wmrgen.functions.trailers.brockett:brockett_rates",
    "desaturate": "wmrgen.functions.control.desaturate:desaturate",
    "inverse_together": "wmrgen.functions.control.inverse_together:inverse_together",
    "wheel_angles": "wmrgen.functions.structure.integrals:wheel_angles",
    "flat": "wmrgen.functions.trailers.flat:flat",
    "input_limits": "wmrgen.functions.control.input_limits:input_limits",
    "accelerations": "wmrgen.functions.space.accelerations:accelerations",
    "wheel_motion": "wmrgen.functions.space.wheel_motion:wheel_motion",
    "stability": "wmrgen.functions.space.stability:stability",
    "cg_force": "wmrgen.functions.space.specific_force:cg_force",
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
