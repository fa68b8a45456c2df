"""Questions about the type of wheels that look plain: what in the description says that they may be another type."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

from wmrgen.geometry.layout.skid import parallel
from wmrgen.robotfile.text import quoted
from wmrgen.robotfile.wheel_types.types import FIXED, STEERED
from wmrgen.tools.importing.frames import ancestors
from wmrgen.tools.importing.records import Question, Wheel
from wmrgen.tools.importing.rollers import names_of
from wmrgen.tools.importing.view import EVEN, Candidate, Robot

_CASTOR = re.compile("cast[eo]r", re.IGNORECASE)
_TRACK = re.compile("(?<![a-z])(tracks?|crawlers?|caterpillar)(?![a-z])", re.IGNORECASE)
_SKIDS = re.compile("diff|skid", re.IGNORECASE)
_STEERING = re.compile("ackermann?|bicycle|tricycle|swerve|wheel_?steer", re.IGNORECASE)


class Subject(NamedTuple):
    """A robot, its wheels, and for each wheel the joint that it was read from."""

    robot: Robot
    wheels: Sequence[Wheel]
    seen: Sequence[Candidate]

    @property
    def plain(self) -> list[tuple[Wheel, Candidate]]:
        """The wheels that were read as fixed."""
        pairs = zip(self.wheels, self.seen, strict=True)
        return [(wheel, c) for wheel, c in pairs if wheel.type == FIXED.name]

    def kinds(self) -> set[str]:
        """Return the kinds of all controllers and drive plugins."""
        return {controller.kind for controller in self.robot.description.controllers}


class Rule(NamedTuple):
    """A reason to ask for the type of wheels."""

    name: str
    why: str  # the mistake that the question prevents
    witness: str  # the description that needs it
    ask: Callable[[Subject], Iterator[Question]]


def types_asked(subject: Subject, asked: Sequence[Question]) -> list[Question]:
    """Return the questions about types that look plain.

    A wheel whose type is already in question, or whose name is in a question of an earlier rule, is not asked about
    again.
    """
    taken = {q.wheel for q in asked if q.key == "type"}
    questions = []
    for rule in RULES:
        for question in rule.ask(subject):
            if taken.isdisjoint(question.wheels):
                questions.append(question)
                taken.update(question.wheels)
    return questions


def _castors(subject: Subject) -> Iterator[Question]:
    """Ask about each wheel that is called a castor and has no joint to swivel."""
    for wheel, c in subject.plain:
        words = [word for word in _names_up_to_base(subject.robot, c) if _CASTOR.search(word)]
        if words and wheel.actuated in ((), None):
            text = f"{quoted(words[0])} is the name of a castor, and no joint lets it swivel: does it swivel?"
            hints = ("castor, with x and y of the swivel and d", "fixed, if it does not swivel")
            yield Question(wheel.name, "type", text, hints)


def _tracks(subject: Subject) -> Iterator[Question]:
    """Ask once about all wheels that are called parts of a track."""
    wheels = []
    words = []
    for wheel, c in subject.plain:
        said = [word for word in _names_up_to_base(subject.robot, c) if _TRACK.search(word)]
        if said:
            wheels.append(wheel.name)
            words.append(said[0])
    if wheels:
        text = f"{quoted(words[0])} is the name of a track: are these the wheels of tracks?"
        hints = (
            "fixed, if they are: keep one wheel for each track, and measure effective_track",
            "fixed, if they are wheels without a track",
        )
        yield Question(wheels[0], "type", text, hints, tuple(wheels[1:]))


def _unsteered(subject: Subject) -> Iterator[Question]:
    """Ask once about the front wheels if a controller steers and no wheel of the file does."""
    description = subject.robot.description
    kinds = (controller.type for controller in description.controllers)
    plugins = [word for word in (*description.words, *kinds) if word != description.name]
    steering = [word for word in plugins if _STEERING.search(word)]
    if not steering or any(w.steer_joint or w.type == STEERED.name for w in subject.wheels):
        return
    front = max((float(wheel.x) for wheel, _ in subject.plain), default=0.0)
    wheels = [wheel.name for wheel, _ in subject.plain if front - float(wheel.x) < EVEN]
    if wheels:
        text = f"{quoted(steering[0])} steers, and no joint of the file does: do these?"
        hints = ("steered, if they steer", "fixed, if other wheels steer: write type: steered there")
        yield Question(wheels[0], "type", text, hints, tuple(wheels[1:]))


def _four_driven(subject: Subject) -> Iterator[Question]:
    """Ask once about four driven wheels in a rectangle if nothing says that they skid."""
    description = subject.robot.description
    wheels = [wheel for wheel, _ in subject.plain if "spin" in (wheel.actuated or ())]
    said = "differential" in subject.kinds() or any(map(_SKIDS.search, description.words))
    if said or len(wheels) != 4 or len(subject.wheels) != 4 or not _in_rectangle(wheels):
        return
    text = "four wheels are driven, and nothing says that they skid in curves: do they have rollers?"
    hints = ("fixed, if they skid", "swedish, with gamma, if they are mecanum wheels")
    yield Question(wheels[0].name, "type", text, hints, tuple(w.name for w in wheels[1:]))


def _in_rectangle(wheels: Sequence[Wheel]) -> bool:
    """Return whether wheels roll in parallel on two axles, with a wheel on each side of each axle."""
    first = wheels[0].heading or 0.0
    if not parallel([cmath.rect(1, w.heading or 0.0) for w in wheels]):
        return False
    ahead = [math.cos(first) * float(w.x) + math.sin(first) * float(w.y) for w in wheels]
    aside = [math.cos(first) * float(w.y) - math.sin(first) * float(w.x) for w in wheels]
    return all(_in_pairs(values) for values in (ahead, aside))


def _in_pairs(values: Sequence[float]) -> bool:
    """Return whether four values are two pairs of equal values."""
    a, b, c, d = sorted(values)
    return b - a < EVEN and d - c < EVEN and c - b > EVEN


def _names_up_to_base(robot: Robot, c: Candidate) -> Iterator[str]:
    """Yield the names of a wheel, and of the joints and links that carry it, without the base."""
    yield from names_of(robot, c)
    for joint in ancestors(c.joint.parent, robot.above):
        if joint.child == robot.base:
            return
        yield from (joint.name, joint.child)


RULES = (
    Rule(
        "swivel is fixed",
        "A castor without its swivel drags the robot: the file has a fixed joint in place of the swivel.",
        "no file of the collection; a small input of the issue, copied to tests/tools/importing/test_kinds.py",
        _castors,
    ),
    Rule(
        "track",
        "The sprockets of tracks are read as plain wheels on several axles.",
        "no file of the collection; the issue reports tracks among fresh descriptions",
        _tracks,
    ),
    Rule(
        "steering plugin",
        "A vehicle plugin steers wheels whose steering joints the file does not have.",
        "no file of the collection; the issue reports one among fresh descriptions",
        _unsteered,
    ),
    Rule(
        "four driven wheels",
        "Mecanum wheels without friction and without the word are read as wheels that skid.",
        "husarion_panther and clearpath_a200, which are sold with both kinds of wheels or with a controller elsewhere",
        _four_driven,
    ),
)
