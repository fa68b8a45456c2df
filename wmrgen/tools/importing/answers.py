"""Answers to the questions of an import, from the command line or from an earlier robot file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from wmrgen.errors import ErrorCollector, UsageError
from wmrgen.robotfile.load import OPEN, text_of
from wmrgen.robotfile.reader import read_tree
from wmrgen.robotfile.text import MappingNode, Node, Scalar, SequenceNode, quoted
from wmrgen.tools.importing.records import SUPPORT, Imported, Question

Answers = Mapping[str, str]  # by WHEEL.KEY
# Words, expressions and lists of them.
_VALUE = re.compile(r"[A-Za-z0-9_.+*/() -]+|\[[A-Za-z0-9_.+*/(), -]*\]")


def read_answers(words: Iterable[str]) -> Answers:
    """Read words of the form WHEEL.KEY=VALUE. Raise UsageError if a word has another form."""
    answers = {}
    for word in words:
        key, equals, value = word.partition("=")
        if not equals or "." not in key or not _VALUE.fullmatch(value):
            raise UsageError(f"write WHEEL.KEY=VALUE, such as left.r=0.1, not {quoted(word)}")
        answers[key.strip()] = value.strip()
    return answers


def answered(robot: Imported, answers: Answers) -> Imported:
    """Return the robot with answers in place of its questions.

    If the type of a wheel is answered, other keys of this wheel may be given too: a castor needs ``d``.

    Raises:
        UsageError: An answer belongs to no question.
    """
    questions = [q for q in robot.questions if _takes_answer(q)]
    names = {f"{q.wheel}.{q.key}" for q in questions}
    retyped = {
        wheel for q in questions if f"{q.wheel}.type" in answers for wheel in q.wheels if q.key == "type"
    }
    for key in answers:
        if key not in names and key.partition(".")[0] not in retyped:
            asked = (
                f"The questions are: {' '.join(sorted(names))}." if names else "There is no open question."
            )
            raise UsageError(f"there is no question {quoted(key)}. {asked}")
    return _filled(replace(robot, answers={**robot.answers, **answers}), answers)


def updated(robot: Imported, earlier: Path) -> Imported:
    """Return the robot with the answers that an earlier robot file has to the same questions.

    Args:
        robot: The robot with questions.
        earlier: The robot file that an earlier import wrote and a user completed.

    Raises:
        RobotFileError: The earlier file cannot be read.
    """
    written = dict(_values(earlier))
    answers = {}
    for question in robot.questions:
        values = [written.get(f"{wheel}.{question.key}", OPEN) for wheel in question.wheels]
        if _takes_answer(question) and values[0] != OPEN and len(set(values)) == 1:
            answers[f"{question.wheel}.{question.key}"] = values[0]
    return _filled(robot, answers)


def _takes_answer(question: Question) -> bool:
    """Return whether the answer is the value of one key of a wheel."""
    return question.wheel != SUPPORT and question.key != "equal"


def _filled(robot: Imported, answers: Answers) -> Imported:
    """Return the robot with its questions replaced by ``answers``, which belong to questions."""
    values = dict(robot.answers)
    for question in robot.questions:
        value = answers.get(f"{question.wheel}.{question.key}")
        if value is not None:
            values.update({f"{wheel}.{question.key}": value for wheel in question.wheels})
    rest = tuple(q for q in robot.questions if f"{q.wheel}.{q.key}" not in answers or not _takes_answer(q))
    return replace(robot, questions=rest, answers=values)


def _values(file: Path) -> Iterator[tuple[str, str]]:
    """Yield WHEEL.KEY and the value of each key of each wheel of a robot file, if it is a word or a list of words."""
    collector = ErrorCollector()
    tree = read_tree(text_of(file), str(file), collector)
    collector.end()
    entries = {key.text: value for key, value in tree.entries} if isinstance(tree, MappingNode) else {}
    wheels = entries.get("wheels")
    for item in wheels.items if isinstance(wheels, SequenceNode) else ():
        keys = {key.text: value for key, value in item.entries} if isinstance(item, MappingNode) else {}
        name = keys.get("name")
        for key, value in keys.items():
            text = _text(value)
            if isinstance(name, Scalar) and _VALUE.fullmatch(text):
                yield f"{name.text}.{key}", text


def _text(node: Node) -> str:
    """Return a word, or a list of words, as a robot file writes it; "" for other values."""
    if isinstance(node, Scalar):
        return node.text.strip()
    if isinstance(node, SequenceNode) and all(isinstance(item, Scalar) for item in node.items):
        return "[" + ", ".join(_text(item) for item in node.items) + "]"
    return ""
