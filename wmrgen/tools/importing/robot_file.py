"""An imported robot as a robot file: every value with its source, every question where its answer belongs."""

from __future__ import annotations

import itertools
import math
import re
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

from wmrgen.errors import Mark, RobotFileError
from wmrgen.geometry.layout.expressions import twelfths_of_pi
from wmrgen.geometry.layout.records import DEFAULT_FRAME
from wmrgen.robotfile.load import OPEN
from wmrgen.robotfile.names import is_outer_name, robot_name, wheel_name
from wmrgen.robotfile.text import Scalar, quoted
from wmrgen.robotfile.wheel_types import WHEEL_TYPES
from wmrgen.tools.importing.records import DIGITS, MODEL, SUPPORT, Imported, Question, Wheel

_SAME = 1e-9  # [rad]
_WIDTH = 100
_KINDS_OF_JOINT = re.compile("((?i:_(joint|link|wheel|spin|axle|hinge))|Joint|Link|Wheel|Spin|Axle|Hinge)+$")
_UNQUOTED = re.compile("-?[A-Za-z_/][A-Za-z0-9_./-]*")  # what YAML reads as text in a mapping
_MOST = 28  # characters, which leave room for a number


def as_json(robot: Imported) -> dict[str, Any]:
    """Base, wheels and questions: metres and radians in the base frame, None for what the file does not say."""
    return {
        "base": robot.base,
        "wheels": [_wheel_json(wheel) for wheel in robot.wheels],
        "questions": [
            {"wheel": q.wheel, "key": q.key, "text": q.text, "hints": list(q.hints), "also": list(q.also)}
            for q in robot.questions
        ],
    }


def _wheel_json(wheel: Wheel) -> dict[str, Any]:
    words = "name joint steer_joint type x y heading r d offset_y gamma actuated".split()
    values = {key: getattr(wheel, key) for key in words}
    return {k: float(v) if isinstance(v, Fraction) else v for k, v in values.items()}


def text(robot: Imported, source: str) -> str:
    """The robot file; ``source`` is the name of the file that was read."""
    frame = "that of the model" if robot.base == MODEL else f"link {quoted(robot.base)}"
    lines = [
        *_comment(f"Imported from {quoted(source)}. Frame: {frame}, x forward."),
        *(line for note in robot.notes for line in _comment(f"note: {note}")),
    ]
    if robot.questions:
        lines += _comment(
            f"{counted(robot.questions)} open: put an answer in the place of each {OPEN}, "
            "or delete the wheel that is none. wmrgen derive refuses the file until then."
        )
    lines += ["wmrgen: 1", f"name: {near_robot_name(robot.name)}"]
    if robot.base not in (MODEL, DEFAULT_FRAME) and is_outer_name(robot.base):
        lines.append(f"frame: {_as_yaml(robot.base)}")
    if robot.effective_track:
        track, said = robot.effective_track
        lines += _comment(f"It turns by skidding: {said}")
        lines.append(f"effective_track: {_length(track)}")
    lines.append("wheels:")
    for wheel in robot.wheels:
        own = {key: value for key, value in robot.answers.items() if key.startswith(f"{wheel.name}.")}
        lines += _wheel(
            wheel, own, [q for q in robot.questions if wheel.name in q.wheels and q.key != "equal"]
        )
    lines += _support([q for q in robot.questions if q.wheel == SUPPORT])
    doubts = [q for q in robot.questions if q.key == "equal"]
    if robot.couplings or doubts:
        lines += [
            "couplings:",
            *(f"  - {{equal: {each.joints}}}   # {each.why}" for each in robot.couplings),
        ]
    for question in doubts:
        lines += [*_asked(question, "  "), f"  - {{equal: {OPEN}}}"]
    return "\n".join(lines) + "\n"


def _comment(words: str, indent: str = "") -> list[str]:
    return textwrap.wrap(words, _WIDTH, initial_indent=f"{indent}# ", subsequent_indent=f"{indent}#   ")


def _wheel(wheel: Wheel, answers: Mapping[str, str], questions: Sequence[Question]) -> Iterator[str]:
    """Yield the lines of a wheel; ``answers`` by WHEEL.KEY replace what the description says."""
    values = dict(_values(wheel))
    values.update({key.partition(".")[2]: value for key, value in answers.items()})
    asked = {q.key for q in questions}
    joints = _joints(wheel)
    if joints and not ("type" in asked and wheel.actuated == ()):  # it may be a ball, which has no joints
        values["joints"] = joints
    for key in asked - set(values):
        values[key] = OPEN
    for position, (key, value) in enumerate(values.items()):
        indent = "  - " if position == 0 else "    "
        for question in questions:
            if question.key == key and question.wheel == wheel.name:
                yield from _asked(question, "    ")
            elif question.key == key:
                yield from _comment(f"? the same answer as {question.wheel}.{key}", "    ")
        remark = "answered" if f"{wheel.name}.{key}" in answers else wheel.remarks.get(key, "")
        shown = OPEN if key in asked else value
        yield f"{indent}{key}: {shown}" + (f"   # {remark}" if remark else "")


def _asked(question: Question, indent: str) -> Iterator[str]:
    yield from _comment(f"? {question.text}", indent)
    for hint in question.hints:
        yield from _comment(f"  hint: {hint}", indent)


def _support(questions: Sequence[Question]) -> Iterator[str]:
    """A wheel that nothing describes but a question."""
    for question in questions:
        yield f"  - name: {SUPPORT}   # ? delete the lines down to y where it is none"
        yield from _asked(question, "    ")
        yield from (f"    {key}: {OPEN}" for key in ("type", "x", "y"))


def _values(wheel: Wheel) -> Iterator[tuple[str, str]]:
    """Key and value of all that is known and is not the default of the type."""
    kind = WHEEL_TYPES[wheel.type]
    yield "name", wheel.name
    yield "type", wheel.type
    yield "x", _length(wheel.x)
    yield "y", _length(wheel.y)
    if wheel.heading is not None:
        yield "heading", _angle(wheel.heading)
    if wheel.r is not None:
        yield "r", _length(wheel.r)
    if "d" in kind.required and wheel.d is not None:
        yield "d", _length(wheel.d)
    if wheel.offset_y:
        yield "offset_y", _length(wheel.offset_y)
    if wheel.gamma is not None:
        yield "gamma", _angle(wheel.gamma)
    if wheel.actuated is not None and wheel.actuated != kind.actuated:
        yield "actuated", f"[{', '.join(wheel.actuated)}]"
    if wheel.steer_limits:
        yield "limits", "{steer: [" + ", ".join(map(_length, wheel.steer_limits)) + "]}"


def _joints(wheel: Wheel) -> str:
    """Return the names of the wheel's joints as YAML; "" if all are as they would be without this key."""
    entries = []
    for joint, name in wheel.joints.items():
        own = (wheel.steer_joint if joint == "steer" else wheel.joint) or ""
        if joint in WHEEL_TYPES[wheel.type].joints and is_outer_name(own):
            entries += [f"{joint}: {_as_yaml(name)}"] * (name != f"{wheel.name}_{joint}")
    return "{" + ", ".join(entries) + "}" if entries else ""


def _as_yaml(name: str) -> str:
    """Return a name as YAML, with quotes if it needs them."""
    return name if _UNQUOTED.fullmatch(name) else f"'{name}'"


def _length(value: Fraction) -> str:
    """A decimal number, exactly what the file says where that has no more than `DIGITS` decimals."""
    units = abs(round(value * 10**DIGITS))
    whole, part = divmod(units, 10**DIGITS)
    decimals = f"{part:0{DIGITS}d}".rstrip("0")
    sign = "-" if value < 0 and units else ""
    return f"{sign}{whole}" + (f".{decimals}" if decimals else "")


def _angle(value: float) -> str:
    """An angle [rad]: a multiple of pi/12 as that."""
    steps = round(value / (math.pi / 12))
    if abs(value - steps * math.pi / 12) > _SAME:
        return _length(Fraction(value))
    return twelfths_of_pi(steps)


def counted(questions: Sequence[Question]) -> str:
    return f"{len(questions)} question{'s' * (len(questions) != 1)}"


# ---- names, as near to those of the description as they may be


def near_robot_name(name: str) -> str:
    near = _plain(name)[:_MOST].strip("_")
    return _first((near, near.lower(), f"{near.lower()}_1"), robot_name) or "imported_robot"


def near_wheel_names(joints: Sequence[str]) -> list[str]:
    """Names of wheels, without what says that a joint is one; none twice in any case of letters. Where some are too
    long, without the first words of all; of one that still is, the last words."""
    plain = [_KINDS_OF_JOINT.sub("", _plain(joint)) for joint in joints]
    if any(len(name) > _MOST for name in plain):
        words = [name.split("_") for name in plain]
        least = min(map(len, words)) - 1  # something is left of each
        columns = zip(*(each[:least] for each in words), strict=True)
        shared = len(list(itertools.takewhile(lambda column: len({*column}) == 1, columns)))
        while shared and not all(each[shared][:1].isalpha() for each in words):
            shared -= 1
        plain = ["_".join(each[shared:]) for each in words]
    names: list[str] = []
    for number, near in enumerate(map(_last_words, plain), 1):
        tries = (near, near.lower(), f"{near.lower()}_{number}", f"wheel_{number}")
        name = _first(tries, wheel_name) or f"wheel_{number}"
        clashes = name.lower() in (other.lower() for other in names)
        names.append(f"{name[: _MOST - 2]}_{number}" if clashes else name)
    return names


def _last_words(name: str) -> str:
    while len(name) > _MOST and "_" in name:
        name = name.partition("_")[2]
    return name[:_MOST]


def _plain(name: str) -> str:
    return re.sub("[^A-Za-z0-9]+", "_", name).strip("_")


def _first(tries: Iterable[str], check: Callable[[Scalar], str]) -> str | None:
    """The first that a robot file accepts."""
    for name in tries:
        try:
            return check(Scalar(Mark("", 0, 0, ""), name, True))
        except RobotFileError:
            continue
    return None
