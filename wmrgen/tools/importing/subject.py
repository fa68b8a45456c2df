"""What the rules of questions see: a robot, its wheels as they were read, and what the file says of all of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

from wmrgen.robotfile.wheel_types.types import FIXED
from wmrgen.tools.importing.records import Question, Wheel
from wmrgen.tools.importing.rejections import Rejected
from wmrgen.tools.importing.rule import Rule
from wmrgen.tools.importing.view import Candidate, Robot


class Subject(NamedTuple):
    """A robot, its wheels, and for each wheel the joint from which it was read."""

    robot: Robot
    wheels: Sequence[Wheel]
    seen: Sequence[Candidate]
    rolling: str = ""  # what says that the wheels have rollers
    rejected: Sequence[Rejected] = ()
    forward_given: bool = False

    @property
    def pairs(self) -> list[tuple[Wheel, Candidate]]:
        """The wheels with their joints."""
        return list(zip(self.wheels, self.seen, strict=True))

    @property
    def plain(self) -> list[tuple[Wheel, Candidate]]:
        """The wheels that were read as fixed."""
        return [(wheel, c) for wheel, c in self.pairs if wheel.type == FIXED.name]

    @property
    def powered(self) -> set[str]:
        """Return the steering joints of wheels with motors; "" stands for a wheel that does not steer."""
        return {wheel.steer_joint or "" for wheel in self.wheels if wheel.actuated}

    def kinds(self) -> set[str]:
        """Return the kinds of all controllers and drive plugins."""
        return {controller.kind for controller in self.robot.description.controllers}


WheelRule = Rule[Callable[[Subject, Wheel, Candidate], Iterator[Question]]]
RobotRule = Rule[Callable[[Subject], Iterator[Question]]]


def asked_once(questions: Iterable[Question]) -> list[Question]:
    """Return the questions without those about a type that an earlier question asks for."""
    taken: set[str] = set()
    result = []
    for question in questions:
        if question.key == "type":
            if not taken.isdisjoint(question.wheels):
                continue
            taken.update(question.wheels)
        result.append(question)
    return result
