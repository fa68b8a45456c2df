"""The functions to count, the hand-written ones that do the same, and known figures of them."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import wmrgen
from benchmarks.counts import path_of
from wmrgen.derivation.facade import Derivation


@dataclass(frozen=True)
class Job:
    """A function of a robot; ``reference`` is the hand-written one of the same job.

    ``simpler``: what hand-written code usually does, without the nearest branch and without steering limits.
    ``libm``, ``inline``: the most that wmrgen may need on a Cortex-M4F, with newlib and with kernels of its own,
    the return left out; 0: none known.
    """

    layout: str
    robot: str
    function: str
    reference: str
    simpler: str = ""
    libm: int = 0
    inline: int = 0
    trigonometry: bool = True

    def __str__(self) -> str:
        return f"{self.robot} {self.function}"


JOBS = (
    Job("differential", "textbook_differential", "inverse", "differential_inverse", "", 10, 0, False),
    Job("differential", "textbook_differential", "forward", "differential_forward", trigonometry=False),
    Job("four mecanum", "clearpath_do100", "inverse", "mecanum_inverse", "", 18, 0, False),
    Job("four mecanum", "clearpath_do100", "forward", "mecanum_forward", "", 19, 0, False),
    Job("three omni", "lekiwi", "inverse", "omni_inverse", trigonometry=False),
    Job("three omni", "lekiwi", "forward", "omni_forward", "", 17, 0, False),
    Job("four swerve", "wpilib_swervebot", "inverse", "swerve4_inverse_nearest", "swerve4_inverse", 493, 267),
    Job("four swerve", "wpilib_swervebot", "forward", "swerve4_forward", "", 668, 269),
    Job("eight swerve", "swerve8", "inverse", "swerve8_inverse_nearest"),
    Job("eight swerve", "swerve8", "forward", "swerve8_forward_reference", "", 1422, 535),
    Job("four powered castors", "nomad_xr4000", "inverse", "castors4_inverse"),
    Job("four powered castors", "nomad_xr4000", "forward", "castors4_forward", "", 764, 336),
    Job("Ackermann", "ackermann_car", "inverse", "ackermann_inverse_limited", "ackermann_inverse", 255, 148),
    Job("Ackermann", "ackermann_car", "forward", "ackermann_forward"),
)
# The same for every robot.
ODOMETRY = Job("any", "textbook_differential", "odometry", "")


@cache
def derivations() -> dict[str, Derivation]:
    """Return the derivations of the robots of `JOBS`, by name."""
    with tempfile.TemporaryDirectory() as folder:
        names = dict.fromkeys(job.robot for job in JOBS)
        return {name: wmrgen.derive(wmrgen.load(path_of(name, Path(folder)))) for name in names}


def outputs(job: Job) -> tuple[str, ...]:
    """Return the outputs of every implementation of ``job``; slip of inverse kinematics is left out."""
    function = derivations()[job.robot].c_module.function(job.function)
    return tuple(port.name for port in function.outputs if port.name != "slip")
