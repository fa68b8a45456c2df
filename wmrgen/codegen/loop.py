"""The control loop of a robot, from sensors to motors: its functions, their order, and the variables that they share.

counters, wheels      counts of the encoders, and measured joints twist, pose           the measured twist of the robot
and its pose, with covariances if the robot file has noise wanted, driven        the wanted twist, and the twist that
`limit_acceleration` or `setpoint` computes from it; `setpoint`
                      applies the limits of `limit_acceleration` as well, so it replaces that function
commands, before      commands for the joints, and those of the previous step

Steering starts from the last commands, not from the measured angles. Otherwise an error of measurement (a count of an
encoder, the lag of a motor) would become the next command, and steered wheels would creep at rest.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

from wmrgen.codegen.signature import arguments
from wmrgen.ir.nodes import Module

COUNTERS = "joints_from_counters"
# Each function of the loop, with the variable of each argument that has another name.
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
    """Return the joints that `inverse` reads but does not command, such as the angles of passive castors."""
    own = arguments(module.function("inverse"), module.joints)
    commanded = {member for argument in own for member in argument.writes.values()}
    read = [m for argument in own if argument.name == "now" for m in argument.reads.values()]
    return tuple(member for member in read if member not in commanded)


class Stage(NamedTuple):
    """A function of the loop."""

    function: str
    variables: Mapping[str, str]  # argument -> variable of the loop, if it has another name


class Loop(NamedTuple):
    """The functions of the loop of one robot, in the order in which they are called."""

    senses: tuple[Stage, ...]  # from measured joints to the pose
    acts: tuple[Stage, ...]  # from the wanted twist to commands


def loop(module: Module, has: Collection[str], covariances: bool = True) -> Loop:
    """Return the loop of a robot.

    Args:
        module: The functions of the robot.
        has: Names of the functions that may be called.
        covariances: Whether the loop computes covariances.
    """
    names = set(has)
    if not covariances or not {"forward_covariance", "odometry_covariance"} <= names:
        names -= {"forward_covariance", "odometry_covariance"}
    slip = "forward_covariance" in names and any(
        argument.name == "slip"
        for argument in arguments(module.function("forward_covariance"), module.joints)
    )
    names -= {"forward"} if slip else {"forward_slip"}
    # One odometry function updates the pose.
    moves = next(n for n in ("odometry_covariance", "odometry_compensated", "odometry") if n in names)
    names -= {"odometry_covariance", "odometry_compensated", "odometry"} - {moves}
    if "setpoint" in names:
        names -= {"limit_acceleration"}
    driven = {} if names & {"limit_acceleration", "setpoint"} else {"driven": "wanted"}

    def stages(table: tuple[tuple[str, Mapping[str, str]], ...]) -> tuple[Stage, ...]:
        called = []
        for name, variables in table:
            if name in names:
                renamed = {a: driven.get(v, v) for a, v in variables.items()}
                called.append(Stage(name, renamed))
        return tuple(called)

    return Loop(stages(_SENSES), stages(_ACTS))
