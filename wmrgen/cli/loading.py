"""What most verbs start with: read the robot file, print its notes, and derive the model while progress is shown."""

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
    """Split ``words`` into paths of files and NAME:=VALUE arguments of xacro files."""
    paths = [Path(word) for word in words if ":=" not in word]
    arguments = [word for word in words if ":=" in word]
    return paths, arguments


def print_notes(robot: Robot, but: Container[str] = ()) -> Robot:
    """Print the notes of a robot except those in ``but``, which the caller prints; return the robot."""
    for text in map(plain, robot.notes):
        if text not in but:
            console.note(f"note: {robot.name}: {text}")
    return robot


def warn_of_gains(robot: Robot, asked: bool) -> None:
    """Warn if the gains in a robot file do not stabilise the robot, or not from every pose.

    ``asked``: the user requests `goto_pose`, which itself rejects gains that do not stabilise the robot.
    """
    if robot.gains:
        from wmrgen.functions.control.gains import warnings

        for text in warnings(robot, asked):
            console.note(f"warning: {robot.name}: {text}")


@contextmanager
def derived(path: Path, functions: Sequence[str] | None = None) -> Iterator[Derivation]:
    """Derive the model of a robot file with the given functions, or with those that the file requests.

    Progress is shown until the end of the context, because a derivation computes its parts when they are first used.
    """
    with console.progress() as step:
        step(f"deriving {path}")
        yield wmrgen.derive(print_notes(wmrgen.load(path)), functions)


def linted(spec: RobotSpec, derivation: Derivation) -> list[Finding]:
    """Return the likely mistakes in a robot, without those that its file ignores.

    Trailers and virtual wheels are not checked, because a mistake in the wheels may be why the robot cannot have them.
    """
    from wmrgen.tools.lint import Subject, findings

    return findings(Subject(spec, derivation.robot, derivation.layout_mobility))
