"""The loop of a robot, from sensors to motors: its functions, their order, and the variables that they share.

counters, wheels      counts of the encoders, and measured joints
twist, pose           the measured motion of the robot and its pose, with covariances if the robot file has noise
wanted, driven        the wanted twist, and the twist that `limit_acceleration` or `setpoint` makes of it; `setpoint`
                      keeps the limits of `limit_acceleration` as well, so it replaces it
commands, before      commands for the joints, and those of the previous step

Steering starts from the last commands, not from the measured angles: the error of a measurement (a count of an encoder,
the lag of a motor) would become the next command, and modules would creep at rest.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

from wmrgen.codegen.signature import arguments
from wmrgen.ir.nodes import Module

COUNTERS = "joints_from_counters"
# What the arguments of each function are in the loop, where they are not called so.
_SENSES: tuple[tuple[str, Mapping[str, str]], ...] = (
    (COUNTERS, {"now": "counters", "last": "counters_before", "out": "wheels"}),
    ("forward", {}),
    ("forward_slip", {}),
    ("forward_covariance", {}),
    ("odometry_compensated", {}),
    ("odometry_covariance", {}),
    ("odometry", {}),
)
_ACTS: tuple[tuple[str, Mapping[str, str]], ...] = (
    ("limit_twist", {"twist": "wanted"}),
    ("turn_first", {"twist": "wanted"}),
    ("drive_first", {"twist": "wanted"}),
    ("limit_acceleration", {"twist": "driven"}),
    ("setpoint", {"twist": "driven", "wheels": "commands"}),
    ("inverse", {"twist": "driven", "now": "commands", "out": "commands"}),
    ("desaturate", {"wheels": "commands"}),
    ("compensate_steering", {"wheels": "commands", "twist": "driven", "now": "wheels"}),
    ("steer_toward", {"now": "before", "wanted": "commands", "out": "commands"}),
)


def only_read(module: Module) -> tuple[str, ...]:
    """The joints that `inverse` reads and does not command, as angles of castors: commands take them from wheels."""
    own = arguments(module.function("inverse"), module.joints)
    commanded = {member for argument in own for member in argument.writes.values()}
    read = [m for argument in own if argument.name == "now" for m in argument.reads.values()]
    return tuple(member for member in read if member not in commanded)


class Stage(NamedTuple):
    """A function of the loop, and the variable that each of its arguments is, where that is called otherwise."""

    function: str
    variables: Mapping[str, str]


class Loop(NamedTuple):
    """``senses``: from what the wheels do to the pose; ``acts``: from the wanted twist to commands."""

    senses: tuple[Stage, ...]
    acts: tuple[Stage, ...]


def loop(module: Module, has: Collection[str], covariances: bool = True) -> Loop:
    """The loop of ``module`` with those functions that it ``has``; without ``covariances`` where nobody reads them."""
    names = set(has)
    if not covariances or not {"forward_covariance", "odometry_covariance"} <= names:
        names -= {"forward_covariance", "odometry_covariance"}
    slip = "forward_covariance" in names and any(
        argument.name == "slip"
        for argument in arguments(module.function("forward_covariance"), module.joints)
    )
    names -= {"forward"} if slip else {"forward_slip"}
    # One of them moves the pose.
    moves = next(n for n in ("odometry_covariance", "odometry_compensated", "odometry") if n in names)
    names -= {"odometry_covariance", "odometry_compensated", "odometry"} - {moves}
    if "setpoint" in names:
        names -= {"limit_acceleration"}
    driven = {} if names & {"limit_acceleration", "setpoint"} else {"driven": "wanted"}

    def stages(table: tuple[tuple[str, Mapping[str, str]], ...]) -> tuple[Stage, ...]:
        return tuple(
            Stage(name, {a: driven.get(v, v) for a, v in variables.items()})
            for name, variables in table
            if name in names
        )

    return Loop(stages(_SENSES), stages(_ACTS))
