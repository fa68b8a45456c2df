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

Answers = Mapping[str, str]  # by WHEEL.KEY, or by the name of a choice
# Words, expressions and lists of them.
_VALUE = re.compile(r"[A-Za-z0-9_.+*/() -]+|\[[A-Za-z0-9_.+*/(), -]*\]")


def read_answers(words: Iterable[str]) -> Answers:
    """Read words of the form WHEEL.KEY=VALUE or NAME=CHOICE. Raise UsageError if a word has another form."""
    answers = {}
    for word in words:
        key, equals, value = word.partition("=")
        if not equals or not key.strip() or not _VALUE.fullmatch(value):
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
    names = {q.answer_key for q in questions} | {f"{q.wheel}.{q.key}" for q in questions}
    for q in questions:
        names.update(f"{wheel}.{q.key}" for wheel in q.wheels if q.choices and q.key != "type")
    retyped = {
        wheel for q in questions if f"{q.wheel}.type" in answers for wheel in q.wheels if q.key == "type"
    }
    for key in answers:
        if key not in names and key.partition(".")[0] not in retyped:
            asked = (
                f"The questions are: {' '.join(sorted(names))}." if names else "There is no open question."
            )
            raise UsageError(f"there is no question {quoted(key)}. {asked}")
    own = {key: value for key, value in answers.items() if "." in key}
    return _filled(replace(robot, answers={**robot.answers, **own}), answers)


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
    for question in filter(_takes_answer, robot.questions):
        values = [written.get(f"{wheel}.{question.key}", OPEN) for wheel in question.wheels]
        if values[0] != OPEN and len(set(values)) == 1:
            answers[f"{question.wheel}.{question.key}"] = values[0]
        for word, choice in question.choices.items():
            if all(written.get(key) == value for key, value in choice.items()):
                answers[question.name] = word
    return _filled(robot, answers)


def _takes_answer(question: Question) -> bool:
    """Return whether the answer is the value of one key of a wheel."""
    return question.wheel != SUPPORT and question.key != "equal"


def _filled(robot: Imported, answers: Answers) -> Imported:
    """Return the robot with its questions replaced by ``answers``, which belong to questions.

    Raises:
        UsageError: An answer is none of the choices.
    """
    values, rest = dict(robot.answers), list[Question]()
    for question in robot.questions:
        filled = _values_of(question, answers) if _takes_answer(question) else {}
        values.update(filled)
        if not filled:
            rest.append(question)
    return replace(robot, questions=tuple(rest), answers=values)


def _values_of(question: Question, answers: Answers) -> Mapping[str, str]:
    """Return WHEEL.KEY -> value for the answer to a question; empty if there is none."""
    word = answers.get(question.name) if question.name else None
    if word is not None:
        if word not in question.choices:
            choices = " or ".join(question.choices)
            raise UsageError(f"{question.name} is {choices}, not {quoted(word)}")
        return question.choices[word]
    own = [f"{wheel}.{question.key}" for wheel in question.wheels]
    if question.choices and question.key != "type":  # each wheel has a value of its own
        return {key: answers[key] for key in own} if all(key in answers for key in own) else {}
    value = answers.get(own[0])
    return {} if value is None else dict.fromkeys(own, value)


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
