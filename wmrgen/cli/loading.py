"""What every verb begins with: the robot file read, its notes told, the model derived while progress is shown."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import wmrgen
from wmrgen.cli import console
from wmrgen.geometry.notation import plain

if TYPE_CHECKING:
    from wmrgen.derivation.facade import Derivation
    from wmrgen.geometry.layout.records import Robot
    from wmrgen.robotfile.records import RobotSpec
    from wmrgen.tools.lint import Finding


def paths_and_arguments(words: Sequence[str]) -> tuple[list[Path], list[str]]:
    """The files among ``words``, and what is NAME:=VALUE, for xacro."""
    return [Path(word) for word in words if ":=" not in word], [word for word in words if ":=" in word]


def noted(robot: Robot, but: Container[str] = ()) -> Robot:
    """The robot, its notes told, ``but`` those that are told elsewhere."""
    for text in map(plain, robot.notes):
        if text not in but:
            console.note(f"note: {robot.name}: {text}")
    return robot


def warn_of_gains(robot: Robot, asked: bool) -> None:
    """Say which gains of a robot's file do not stabilise, or not from everywhere. ``asked``: for goto_pose."""
    if robot.gains:
        from wmrgen.functions.control.gains import warnings

        for text in warnings(robot, asked):
            console.note(f"warning: {robot.name}: {text}")


@contextmanager
def derived(path: Path, functions: Sequence[str] | None = None) -> Iterator[Derivation]:
    """The model of a robot file with some functions; what is computed inside the context counts as progress."""
    with console.progress() as step:
        step(f"deriving {path}")
        yield wmrgen.derive(noted(wmrgen.load(path)), functions)


def linted(spec: RobotSpec, derivation: Derivation) -> list[Finding]:
    """What is likely wrong with a robot, but for what its file says is to be ignored."""
    from wmrgen.tools.lint import Subject, findings

    return findings(Subject(spec, derivation.robot, derivation.mobility))
