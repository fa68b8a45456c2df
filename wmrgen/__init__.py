"""wmrgen: from the wheel layout of a robot to its verified kinematic model.

>>> import wmrgen
>>> derivation = wmrgen.derive(wmrgen.load("robots/pioneer3dx.yaml"))

Importing the package loads neither sympy nor casadi nor numpy: `load` and `derive` do, when called.
"""

from __future__ import annotations

import os
from os import PathLike
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wmrgen.layout.records import Robot
    from wmrgen.robot import Derivation
    from wmrgen.spec.records import RobotSpec

__version__ = "0.1.0"
__all__ = ["__version__", "derive", "load"]


def load(path: str | PathLike[str]) -> Robot:
    """The robot that a file describes. RobotFileError, with the place, where the file cannot be accepted."""
    return read(path)[1]


def read(path: str | PathLike[str]) -> tuple[RobotSpec, Robot]:
    """What a file says, each value with its place, and the robot that it describes. RobotFileError as `load`."""
    from wmrgen.errors import Several
    from wmrgen.spec.load import read_robot

    several = Several()
    spec = read_robot(os.fspath(path), several)
    with several:
        robot = robot_of(spec)
    several.end()
    return spec, robot


def robot_of(spec: RobotSpec) -> Robot:
    """The robot that a file's content describes. RobotFileError as `load`."""
    from wmrgen.errors import Several
    from wmrgen.functions.registry import check
    from wmrgen.layout import build

    several = Several()
    with several:
        check(spec.functions)
    with several:
        robot = build(spec)
    several.end()
    return robot


def derive(robot: Robot, functions: Sequence[str] | None = None) -> Derivation:
    """Everything that follows from the robot's layout. NotDerivableError where nothing does.

    ``functions``: only those, instead of the ones that are generated for the robot.
    """
    from wmrgen.robot import Derivation

    return Derivation(robot, functions)
