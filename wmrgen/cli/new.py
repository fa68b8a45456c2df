"""``wmrgen new``: a robot file for a kind of drive, or a commented copy of a robot of the gallery."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.declare import Json, Words, argument, option, output, verb
from wmrgen.cli.drives import DRIVES
from wmrgen.cli.values import from_words
from wmrgen.errors import Mark, UsageError
from wmrgen.geometry.ports import Port, Role
from wmrgen.robotfile.shipped import shipped
from wmrgen.robotfile.text import (
    MAX_BYTES,
    MappingNode,
    Node,
    Scalar,
    SequenceNode,
    bytes_of,
    quoted,
    suggestion,
)

if TYPE_CHECKING:
    from wmrgen.robotfile.fields import Field
    from wmrgen.robotfile.records import RobotSpec

_PLAIN = re.compile(r"[\w.+*/() -]+")  # values that need no quotes anywhere in YAML
_COMPLETE = "every number is given"
_UNITS = "Lengths are in metres, angles in radians. A number may have a unit: 150 mm, 30 deg."


def _gallery(incomplete: str) -> list[str]:
    from wmrgen.cli.gallery import shipped_robots

    return [name for name in shipped_robots() if name.startswith(incomplete)]


def _drives(incomplete: str) -> list[str]:
    return [name for name in DRIVES if name.startswith(incomplete)]


@verb("new")
def new(
    name: Annotated[str | None, argument("[NAME]", "The name of the robot, and of its file.")] = None,
    values: Annotated[
        Words, argument("[NUMBER=VALUE]...", "Numbers of the drive or of the robot: radius='50 mm'.")
    ] = None,
    drive: Annotated[
        str | None, option(f"The kind of drive: {', '.join(DRIVES)}.", "KIND", _drives, "--drive")
    ] = None,
    start: Annotated[
        str | None,
        option("Copy this robot instead; `wmrgen list` lists them.", "ROBOT", _gallery, "--from"),
    ] = None,
    description: Annotated[str | None, option("A description of the robot.", "TEXT")] = None,
    out: Annotated[Path | None, output("ROBOT.yaml", "The file; without it NAME.yaml.")] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen new my_robot --drive differential track="30 cm" radius="50 mm"

    Write a robot file for a kind of drive, or a copy of a robot of the gallery, with comments that explain it. Numbers
    that are not given become TODO with a hint; `wmrgen derive` rejects the file until they are filled in. On a
    terminal, wmrgen asks for the drive and its numbers. robot.schema.json is written next to the file, for editors.
    """
    asks = console.can_ask()
    if drive and start:
        raise UsageError("--drive and --from exclude each other. Give one of them.")
    if not asks and not (name and (drive or start)):
        raise UsageError(
            "a new robot needs a name and a kind of drive. Write wmrgen new MY_ROBOT --drive KIND, "
            f"where KIND is one of {' '.join(DRIVES)}, or --from ROBOT for a copy from the gallery."
        )
    if drive is None and start is None:
        drive = _asked_drive()
    name = (
        _robot_name(name)
        if name
        else console.ask("What is your robot called?", f"my_{start or drive}", _robot_name)
    )
    path = out or Path(f"{name}.yaml")
    if path.exists():
        raise UsageError(f"{path} exists already. Give another name, or another file with --out.")
    if start:
        text, said = _copy(name, values, start, description, path)
    else:
        text, said = _of_drive(name, values, _drive_name(drive or ""), description, path)
    files = write_robot_file(path, text)
    if as_json:
        key, origin = ("from", start) if start else ("drive", drive)
        console.data({"file": str(path), "name": name, key: origin, "files": files})
        return 0
    console.result(f"{' '.join(files)}: {said}")
    first = "" if said == _COMPLETE or start else "Write a number in place of each TODO. "
    console.note(f"{first}Next: wmrgen lint {path}; wmrgen derive {path}")
    return 0


def _asked_drive() -> str:
    """Show the kinds of drives with their pictures, and ask for one."""
    for kind, drive in DRIVES.items():
        console.note(f"{kind}: {drive.summary}\n{drive.picture}")
    return console.ask("Which kind of drive does your robot have?", "differential", _drive_name)


def _of_drive(
    name: str, values: Sequence[str] | None, kind: str, description: str | None, path: Path
) -> tuple[str, str]:
    """Return the text of a robot file for a kind of drive, and how many numbers are missing, in words.

    Args:
        name: The name of the robot.
        values: NUMBER=VALUE words. On a terminal and without them the numbers are asked for.
        kind: The kind of drive.
        description: The description of the robot.
        path: The file, for messages.
    """
    from wmrgen.robotfile.load import OPEN, read_text
    from wmrgen.robotfile.schema import MODELINE

    drive = DRIVES[kind]
    names = [number.name for number in drive.numbers]
    said = json.dumps(description or f"{kind} drive", ensure_ascii=False)
    words = _given_words(values or (), names, f"a {kind} drive")

    def accept(number: str, word: str) -> str:
        """Return ``word`` if the file is valid with it; examples stand in for the other numbers."""
        if word != OPEN:
            tried = {each.name: each.example for each in drive.numbers} | {number: _as_yaml(word)}
            wmrgen.robot_of(read_text(drive.robot_file(name, said, tried), str(path)))
            _refuse_length(number, word)
        return word

    for given, word in words.items():
        accept(given, word)
    if console.can_ask() and not values:
        console.note(f"{_UNITS} An empty answer leaves the number open: {OPEN}.")
        for number in drive.numbers:
            console.note(number.meaning)
            words[number.name] = console.ask(f"{number.name}?", OPEN, partial(accept, number.name))
    shown = {given: _as_yaml(word) for given, word in words.items()}
    missing = [each for each in names if words.get(each, OPEN) == OPEN]
    head = f"{name}, {kind} drive: {drive.summary}. x points forward, y to the left. {_UNITS}"
    if missing:
        head += f" Write a number in place of each {OPEN}; wmrgen derive refuses the file until then."
    picture = [f"# {line}".rstrip() for line in drive.picture.strip("\n").split("\n")]
    lines = [MODELINE, *_comment(head), *picture]
    text = "\n".join(lines) + "\n" + drive.robot_file(name, said, shown)
    return text, f"open: {' '.join(missing)}" if missing else _COMPLETE


def _copy(
    name: str, values: Sequence[str] | None, start: str, description: str | None, path: Path
) -> tuple[str, str]:
    """Return the text of a copy of a robot of the gallery, and its degrees in words.

    Args:
        name: The name of the robot.
        values: PARAMETER=VALUE words. On a terminal and without them the parameters are asked for.
        start: The robot of the gallery.
        description: The description of the robot.
        path: The file, for messages.
    """
    from wmrgen.cli.gallery import shipped_robots
    from wmrgen.cli.own_parts import comment_own_parts
    from wmrgen.robotfile.load import read_text, text_of
    from wmrgen.robotfile.typesetting import formatted

    origin = text_of(shipped_robots()[_gallery_name(start)])
    spec = read_text(origin, f"{start}.yaml")
    words = _given_words(values or (), [p.name for p in spec.parameters], start)
    for number, word in words.items():
        _accepted_value(number, words, origin, spec, word)
    if console.can_ask() and not values and spec.parameters:
        console.note(_UNITS)
        for p in spec.parameters:
            accept = partial(_accepted_value, p.name, words, origin, spec)
            words[p.name] = console.ask(f"{p.name}?", p.value.text, accept)
    text = _with_values(origin, spec, words)
    text = _renamed(text, name, description or f"after {spec.description}")
    text, left_out = comment_own_parts(_commented(text, name, start), spec, start)
    text = formatted(text, str(path))
    mobility = wmrgen.derive(wmrgen.robot_of(read_text(text, str(path)))).mobility
    if left_out:
        console.note(
            f"Comments in the file, because they describe {start}: {' '.join(left_out)}. "
            "Remove the # of the parts that your robot has, and write its values."
        )
    degrees = f"mobility {mobility.degree_of_mobility}, steerability {mobility.degree_of_steerability}"
    return text, degrees


def _refuse_length(number: str, word: str) -> None:
    """Raise UsageError if the value ``word`` of a number of a drive is not a length above 0."""
    length = from_words([f"{number}={word}"], [Port(number, Role.GEOMETRY, "m")])[number]
    if length <= 0:
        raise UsageError(f"{number} = {quoted(word)} is not above 0. Write the measured length.")


def _drive_name(name: str) -> str:
    """Return ``name`` if it is a kind of drive; raise UsageError otherwise."""
    if name not in DRIVES:
        raise UsageError(f"there is no kind of drive {quoted(name)}. {suggestion(name, list(DRIVES))}")
    return name


def _as_yaml(word: str) -> str:
    """Return a value as YAML text, in quotes if it needs them."""
    return word if _PLAIN.fullmatch(word) else json.dumps(word, ensure_ascii=False)


def _gallery_name(name: str) -> str:
    """Return ``name`` if the gallery has such a robot; raise UsageError otherwise."""
    from wmrgen.cli.gallery import shipped_robots

    if name not in shipped_robots():
        raise UsageError(
            f"the gallery has no robot {quoted(name)}. {suggestion(name, list(shipped_robots()))}"
        )
    return name


def _robot_name(name: str) -> str:
    """Return ``name`` if a robot may have it; raise RobotFileError otherwise."""
    from wmrgen.robotfile.names import robot_name

    return robot_name(Scalar(Mark("the name of the robot", 1, 1, name), name, True))


def _accepted_value(name: str, words: Mapping[str, str], origin: str, spec: RobotSpec, word: str) -> str:
    """Return ``word`` if the file is valid with this value of the parameter ``name``, else raise RobotFileError."""
    from wmrgen.robotfile.load import read_text

    wmrgen.robot_of(read_text(_with_values(origin, spec, {**words, name: word}), f"{spec.name}.yaml"))
    return word


def _given_words(values: Sequence[str], names: Sequence[str], owner: str) -> dict[str, str]:
    """Return NUMBER=VALUE words by name.

    Args:
        values: the words.
        names: the numbers that ``owner`` has.
        owner: the robot or drive, for messages.

    Raises:
        UsageError: for a word of another form, and for a number that ``owner`` does not have.
    """
    words = {}
    for word in values:
        name, equals, value = word.partition("=")
        if not equals or name not in names:
            what = (
                f"{owner} has no parameter {quoted(name)}"
                if equals
                else f"{quoted(word)} is not NUMBER=VALUE"
            )
            if name in names:
                raise UsageError(f"{what}. Write {name} with its value, such as {name}=0.1.")
            raise UsageError(f"{what}. {suggestion(name, names) or 'It has none: edit the file.'}")
        words[name] = value
    return words


def _with_values(text: str, spec: RobotSpec, words: Mapping[str, str]) -> str:
    """Return ``text``, the file of ``spec``, with the values ``words`` of parameters."""
    lines = text.split("\n")
    changed = [p for p in spec.parameters if words.get(p.name, p.value.text) != p.value.text]
    # From the end of the file to its start: a replacement does not move the places before it.
    for p in sorted(changed, key=lambda p: (p.value.mark.line, p.value.mark.column), reverse=True):
        word, row, start = words[p.name], p.value.mark.line - 1, p.value.mark.column - 1
        lines[row] = lines[row][:start] + _as_yaml(word) + lines[row][start + len(p.value.text) :]
    return "\n".join(lines)


def _renamed(text: str, name: str, description: str) -> str:
    """Return a file of the gallery with another name and description, and without its source."""
    text = re.sub(r"\A(#.*\n)*", "", text)
    text = re.sub(r"^source: .*\n", "", text, flags=re.MULTILINE)
    text = re.sub(r"^name: .*$", f"name: {name}", text, count=1, flags=re.MULTILINE)
    line = f"description: {json.dumps(description, ensure_ascii=False)}"
    return re.sub(r"^description: .*$", lambda _: line, text, count=1, flags=re.MULTILINE)


def _commented(text: str, name: str, start: str) -> str:
    """Return ``text`` with a comment at the top, and a comment above each key that explains it and its own keys."""
    from wmrgen.robotfile.keys import ROBOT
    from wmrgen.robotfile.reader import read_tree
    from wmrgen.robotfile.schema import MODELINE

    tree = read_tree(text, name)
    above: dict[int, list[str]] = {}  # line -> comments
    if isinstance(tree, MappingNode):
        for key, value in tree.entries:
            if key.text not in ("wmrgen", "name", "description"):  # which explain themselves
                above[key.mark.line] = list(_meaning(ROBOT.field(key.text), value))
    head = (
        f"{name}, started from {start} of wmrgen's gallery. x points forward, y to the left, angles are "
        f"counter-clockwise. {_UNITS}"
    )
    lines = [MODELINE, *_comment(head)]
    for number, line in enumerate(text.rstrip("\n").split("\n"), 1):
        lines += [*above.get(number, ()), line]
    return "\n".join(lines) + "\n"


def _meaning(field: Field, value: Node) -> Iterator[str]:
    """Yield comments on a key of a robot file, and on the keys in it that ``value`` has."""
    from wmrgen.robotfile.fields import ListOf, Section

    yield from _comment(field.meaning)
    item = field.value.item if isinstance(field.value, ListOf) else field.value
    if isinstance(item, Section):
        rows = value.items if isinstance(value, SequenceNode) else (value,)
        keys = {key.text for row in rows if isinstance(row, MappingNode) for key, _ in row.entries}
        for part in item.fields:
            if part.key in keys:
                yield from _comment(f"{part.key}: {part.meaning}", "  ")


def _comment(words: str, indent: str = "") -> list[str]:
    return textwrap.wrap(words, 110, initial_indent=f"# {indent}", subsequent_indent=f"#   {indent}")


# ---- writing a robot file, and the schema that its first line names next to it


def write_robot_file(path: Path, text: str) -> list[str]:
    """Write a robot file, and the schema for editors if there is none yet; return the names of the files written.

    Raises UsageError for an invalid file name, EnvironmentFailure if a file cannot be written.
    """
    from wmrgen.derivation.artifacts import write_file
    from wmrgen.robotfile.schema import SCHEMA_FILE

    schema = path.parent / SCHEMA_FILE
    write_file(path, text.encode())
    if schema.exists():
        return [str(path)]
    write_file(schema, bytes_of(shipped("robots") / SCHEMA_FILE, MAX_BYTES))
    return [str(path), str(schema)]
