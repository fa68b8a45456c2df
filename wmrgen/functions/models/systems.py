"""The models of a robot by name, as systems and as functions."""

from __future__ import annotations

from collections.abc import Callable

from wmrgen.functions.models.configuration import configuration_system
from wmrgen.functions.models.posture import eta_system, posture_system
from wmrgen.functions.models.system import System
from wmrgen.functions.models.zeta import zeta_system
from wmrgen.functions.trailers.trailer import trailer_system
from wmrgen.kinematics.records import Formula
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility

SYSTEMS: dict[str, Callable[[Robot, Mobility, bool], System]] = {
    "posture": posture_system,
    "configuration": configuration_system,
    "eta": eta_system,
    "zeta": zeta_system,
    "trailer": trailer_system,
}


def posture(robot: Robot, mobility: Mobility) -> Formula:
    """State and driven speeds to the rates of the posture."""
    return posture_system(robot, mobility).formula()


def configuration(robot: Robot, mobility: Mobility) -> Formula:
    """State and driven speeds to the rates of everything that moves."""
    return configuration_system(robot, mobility).formula()
