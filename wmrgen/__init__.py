"""wmrgen: from the wheel layout of a robot to its verified kinematic model.

>>> import wmrgen
>>> derivation = wmrgen.derive(wmrgen.load("robots/pioneer3dx.yaml"))

Importing the package loads neither sympy nor casadi nor numpy; `load` and `derive` do when they are called.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from functools import partial
from os import PathLike
from typing import TYPE_CHECKING, Any

from wmrgen.derivation.version import __version__

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from wmrgen.derivation.facade import Derivation
    from wmrgen.errors import ErrorCollector
    from wmrgen.errors import NotDerivableError as NotDerivableError
    from wmrgen.errors import RobotFileError as RobotFileError
    from wmrgen.geometry.layout.records import Robot
    from wmrgen.robotfile.records import RobotSpec

_LATER = {  # public name -> module
    "Derivation": "wmrgen.derivation.facade",
    "NotDerivableError": "wmrgen.errors",
    "Robot": "wmrgen.geometry.layout.records",
    "RobotFileError": "wmrgen.errors",
    "calibrate": "wmrgen.tools.calibration.calibrate",
}
__all__ = [
    "Derivation",
    "NotDerivableError",
    "Robot",
    "RobotFileError",
    "__version__",
    "calibrate",
    "derive",
    "load",
]


def load(source: str | PathLike[str] | Mapping[str, object]) -> Robot:
    """Return the robot that a robot file, its text or a mapping describes.

    Args:
        source: The path of a robot file; or its text, a string with a line break; or a mapping with the keys of a robot
            file, whose values are numbers or texts as in a file (``0.165``, ``"150 mm"``, ``"pi/2"``).

    Raises:
        RobotFileError: The robot cannot be accepted. The error names the place: file, line and column, or the path of
            keys in a mapping, ``wheels[0].r``.
    """
    from wmrgen.robotfile.load import read_mapping, read_robot, read_text

    if isinstance(source, Mapping):
        return _spec_and_robot(partial(read_mapping, source))[1]
    if isinstance(source, str) and "\n" in source:
        return _spec_and_robot(partial(read_text, source, "robot.yaml"))[1]
    return _spec_and_robot(partial(read_robot, os.fspath(source)))[1]


def read(path: str | PathLike[str]) -> tuple[RobotSpec, Robot]:
    """Return the content of a robot file, each value with its place, and the robot. RobotFileError as for `load`."""
    from wmrgen.robotfile.load import read_robot

    return _spec_and_robot(partial(read_robot, os.fspath(path)))


def _spec_and_robot(spec_of: Callable[[ErrorCollector], RobotSpec]) -> tuple[RobotSpec, Robot]:
    """Return the content of a robot file and the robot; the errors of both are raised as one."""
    from wmrgen.errors import ErrorCollector

    collector = ErrorCollector()
    spec = spec_of(collector)
    with collector:
        robot = robot_of(spec)
    collector.end()
    return spec, robot


def robot_of(spec: RobotSpec) -> Robot:
    """Return the robot that the content of a file describes. RobotFileError as for `load`."""
    from wmrgen.errors import ErrorCollector
    from wmrgen.functions.registry import check
    from wmrgen.geometry.layout import build

    collector = ErrorCollector()
    with collector:
        check(spec.functions)
    with collector:
        robot = build(spec)
    collector.end()
    return robot


def derive(robot: Robot, functions: Sequence[str] | None = None) -> Derivation:
    """Return the derivation of a robot. Each of its parts is computed when it is first used.

    Args:
        robot: From `load`.
        functions: Names of the functions to generate, instead of the standard ones and those of the robot file.

    Raises:
        NotDerivableError: The robot cannot have a part; raised when the part is first used.
    """
    from wmrgen.derivation.facade import Derivation

    return Derivation(robot, functions)


if TYPE_CHECKING:
    calibrate: Callable[..., Any]  # see wmrgen.tools.calibration.calibrate: this room may not import it
else:

    def __getattr__(name):
        """Import a public name when it is first used."""
        if name not in _LATER:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from importlib import import_module

        return getattr(import_module(_LATER[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
