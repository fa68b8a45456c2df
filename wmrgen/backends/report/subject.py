"""What a report is about: one robot in the three views of its geometry."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from wmrgen.backends.report.markdown import listed
from wmrgen.constraints import Constraints, View, constrain, nominal_view, symbolic_view

if TYPE_CHECKING:
    from wmrgen.layout.records import Robot, Wheel
    from wmrgen.mobility.records import Mobility
    from wmrgen.robot import Derivation

CAP = 16  # wheels whose equations are written out


@dataclass(frozen=True, slots=True)
class Subject:
    """``letters``: the robot with every parameter a symbol, for formulas. ``numbers``: every parameter its value."""

    derivation: Derivation
    robot: Robot
    letters: Robot
    numbers: Robot
    mobility: Mobility
    rows: Constraints
    values: Constraints

    @property
    def shown(self) -> tuple[Wheel, ...]:
        """The wheels whose equations are written out."""
        return self.robot.wheels[:CAP]

    @property
    def more(self) -> int:
        """How many wheels are not."""
        return max(len(self.robot.wheels) - CAP, 0)


def subject(d: Derivation) -> Subject:
    """The robot of a derivation."""
    robot = d.robot
    letters, numbers = _seen(robot, symbolic_view), _seen(robot, nominal_view)
    return Subject(
        d, robot, letters, numbers, d.mobility, d.constraints, constrain(robot, nominal_view)
    )  # fmt: skip


def _seen(robot: Robot, view: View) -> Robot:
    """The robot with one view of its geometry as the working one."""
    return replace(robot, wheels=tuple(replace(w, working=view(w)) for w in robot.wheels))


def some(wheels: Sequence[Wheel]) -> str:
    """The names of wheels, of many the first ones."""
    return listed([w.name for w in wheels[:CAP]]) + (" and others" if len(wheels) > CAP else "")


def grouped(pairs: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    """Each text once, with the names of all wheels that have it."""
    names: dict[str, list[str]] = {}
    for text, name in pairs:
        names.setdefault(text, []).append(name)
    return names


def cut_note(s: Subject, where: str = "`model.json`") -> list[str]:
    """Says that detail was left out."""
    return [f"({s.more} more wheels follow the same pattern; they stand in {where}.)"] if s.more else []
