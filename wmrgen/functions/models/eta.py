"""The posture model in the coordinates eta of the null space, `dynamics`, as a system (Campion (1996))."""

from __future__ import annotations

from wmrgen.functions.models.posture import eta_motion, system_of
from wmrgen.functions.registry import system
from wmrgen.functions.system import System
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility


@system("eta")
def eta_system(robot: Robot, mobility: Mobility, symbolic: bool = False) -> System:
    """`dynamics` as a system."""
    return system_of("dynamics", eta_motion(robot, mobility, symbolic))
