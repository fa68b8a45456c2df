"""Rules that ask for the type of wheels that look plain: what in the description says that they may be another type."""

from __future__ import annotations

import re
from collections.abc import Iterator

from wmrgen.robotfile.text import quoted
from wmrgen.robotfile.wheel_types.types import STEERED, SWEDISH
from wmrgen.tools.importing.frames import ancestors
from wmrgen.tools.importing.mecanum import ROLLERS, in_rectangle, mecanum_choices
from wmrgen.tools.importing.records import Question
from wmrgen.tools.importing.rollers import names_of
from wmrgen.tools.importing.rule import rule
from wmrgen.tools.importing.subject import RobotRule, Subject
from wmrgen.tools.importing.view import EVEN, Candidate, Robot

_CASTOR = re.compile("cast[eo]r", re.IGNORECASE)
_TRACK = re.compile("(?<![a-z])(tracks?|crawlers?|caterpillar)(?![a-z])", re.IGNORECASE)
_SKIDS = re.compile("diff|skid", re.IGNORECASE)
_STEERING = re.compile("ackermann?|bicycle|tricycle|swerve|wheel_?steer", re.IGNORECASE)


RULES: list[RobotRule] = []


@rule(
    RULES,
    "swivel is fixed",
    "A castor without its swivel drags the robot: the file has a fixed joint in place of the swivel.",
    "a public description of the MiR 250, repository unknown: the swivel is of type fixed, its comment says continuous",
)
def _castors(subject: Subject) -> Iterator[Question]:
    """Ask about each wheel that is called a castor and has no joint to swivel."""
    for wheel, c in subject.plain:
        words = [word for word in _names_up_to_base(subject.robot, c) if _CASTOR.search(word)]
        if words and wheel.actuated in ((), None):
            text = f"{quoted(words[0])} is the name of a castor, and no joint lets it swivel: does it swivel?"
            hints = ("castor, with x and y of the swivel and d", "fixed, if it does not swivel")
            yield Question(wheel.name, "type", text, hints)


@rule(
    RULES,
    "track",
    "The wheels in a track are read as plain wheels on several axles.",
    "tracked_vehicle_wheeled.world (gazebosim/gazebo-classic): left_track_wheel1 to left_track_wheel8",
)
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


@rule(
    RULES,
    "steering plugin",
    "A vehicle plugin steers wheels whose steering joints the file does not have.",
    "a report on a fresh public description; the input is in tests/tools/importing/test_type_questions.py",
)
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


@rule(
    RULES,
    "four driven wheels",
    "Mecanum wheels without friction and without the word are read as wheels that skid.",
    "husarion_panther and clearpath_a200, which are sold with both kinds of wheels or with a controller elsewhere",
)
def _four_driven(subject: Subject) -> Iterator[Question]:
    """Ask once about four driven wheels in a rectangle if nothing says that they skid."""
    description = subject.robot.description
    wheels = [wheel for wheel, _ in subject.plain if "spin" in (wheel.actuated or ())]
    said = "differential" in subject.kinds() or any(map(_SKIDS.search, description.words))
    if said or len(wheels) != 4 or len(subject.wheels) != 4 or not in_rectangle(wheels):
        return
    text = "four wheels are driven, and nothing says that they skid in curves: do they have rollers?"
    hints = ("fixed, if they skid", "swedish, with gamma, if they are mecanum wheels")
    choices = mecanum_choices(wheels, {"type": SWEDISH.name})
    also = tuple(w.name for w in wheels[1:])
    yield Question(wheels[0].name, "type", text, hints, also, choices, ROLLERS if choices else "")


def _names_up_to_base(robot: Robot, c: Candidate) -> Iterator[str]:
    """Yield the names of a wheel, and of the joints and links that carry it, without the base."""
    yield from names_of(robot, c)
    for joint in ancestors(c.joint.parent, robot.above):
        if joint.child == robot.base:
            return
        yield from (joint.name, joint.child)
