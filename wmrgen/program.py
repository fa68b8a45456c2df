"""The program of a robot: every function of its model in symbols, ready to be lowered."""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.kinematics import Formula, contacts, dynamics, forward, inverse, odometry
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility


@dataclass(frozen=True, slots=True)
class Program:
    """The formulas of a robot, in the order in which they are emitted."""

    name: str
    formulas: tuple[Formula, ...]

    def formula(self, name: str) -> Formula:
        """The formula called ``name``; KeyError when there is none."""
        return {f.name: f for f in self.formulas}[name]


def program(robot: Robot, mobility: Mobility) -> Program:
    """inverse, forward, odometry and dynamics of a robot, and contacts where it has rollers or spheres."""
    formulas = [inverse(robot, mobility), forward(robot), odometry(), dynamics(robot, mobility)]
    extra = contacts(robot)
    return Program(robot.name, (*formulas, extra) if extra else tuple(formulas))
