"""``wmrgen new``: a robot file from the gallery with its keys explained, and with the user's own values."""

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
from wmrgen.errors import Mark, UsageError
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
_UNITS = "Lengths are in metres, angles in radians. A number may have a unit: 150 mm, 30 deg."


def _gallery(incomplete: str) -> list[str]:
    from wmrgen.cli.gallery import gallery

    return [name for name in gallery() if name.startswith(incomplete)]


@verb("new")
def new(
    name: Annotated[str | None, argument("[NAME]", "The name of the robot, and of its file.")] = None,
    values: Annotated[
        Words, argument("[PARAMETER=VALUE]...", "Values of its parameters: radius='50 mm'.")
    ] = None,
    start: Annotated[
        str | None,
        option("The robot to start from; `wmrgen list` lists them.", "ROBOT", _gallery, "--from"),
    ] = None,
    description: Annotated[str | None, option("A description of the robot.", "TEXT")] = None,
    out: Annotated[Path | None, output("ROBOT.yaml", "The file; without it NAME.yaml.")] = None,
    as_json: Json = False,
) -> int:
    """Example:  wmrgen new my_robot --from pioneer3dx radius="50 mm"

    Write a robot file that starts from a robot of the gallery, with a comment on every key. It can be derived as it is.
    On a terminal, wmrgen asks for what is not given. robot.schema.json is written next to it: editors use it to check
    and complete the file.
    """
    from wmrgen.cli.gallery import gallery, list_robots
    from wmrgen.robotfile.load import read_text, text_of
    from wmrgen.robotfile.typesetting import formatted

    asks = console.can_ask()
    if not asks and not (name and start):
        raise UsageError(
            "a new robot needs a name and a robot to start from. Write wmrgen new MY_ROBOT --from ROBOT; "
            "`wmrgen list` lists the robots."
        )
    if start is None:
        list_robots(False)
        start = console.ask("Which of them is most like yours?", "pioneer3dx", _gallery_name)
    origin = text_of(gallery()[_gallery_name(start)])
    name = (
        _robot_name(name) if name else console.ask("What is your robot called?", f"my_{start}", _robot_name)
    )
    path = out or Path(f"{name}.yaml")
    if path.exists():
        raise UsageError(f"{path} exists already. Give another name, or another file with --out.")
    spec = read_text(origin, f"{start}.yaml")
    words = _given_values(values or (), spec, start)
    if asks and not values and spec.parameters:
        console.note(_UNITS)
        for p in spec.parameters:
            accept = partial(_accepted_value, p.name, words, origin, spec)
            words[p.name] = console.ask(f"{p.name}?", p.value.text, accept)
    text = _with_values(origin, spec, words)
    text = _renamed(text, name, description or f"after {spec.description}")
    text = formatted(_commented(text, name, start), str(path))
    mobility = wmrgen.derive(wmrgen.robot_of(read_text(text, str(path)))).mobility
    files = write_robot_file(path, text)
    if as_json:
        console.data({"file": str(path), "name": name, "from": start, "files": files})
        return 0
    console.result(
        f"{' '.join(files)}: mobility {mobility.degree_of_mobility}, steerability {mobility.degree_of_steerability}"
    )
    console.note(f"Put in your own numbers. Then: wmrgen lint {path}; wmrgen derive {path}")
    return 0


def _gallery_name(name: str) -> str:
    """Return ``name`` if the gallery has such a robot; raise UsageError otherwise."""
    from wmrgen.cli.gallery import gallery

    if name not in gallery():
        raise UsageError(f"the gallery has no robot {quoted(name)}. {suggestion(name, list(gallery()))}")
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


def _given_values(values: Sequence[str], spec: RobotSpec, start: str) -> dict[str, str]:
    """Return PARAMETER=VALUE words by parameter. Raise UsageError for a parameter that ``start`` does not have."""
    names = [p.name for p in spec.parameters]
    words = {}
    for word in values:
        name, equals, value = word.partition("=")
        if not equals or name not in names:
            what = (
                f"{start} has no parameter {quoted(name)}"
                if equals
                else f"{quoted(word)} is not PARAMETER=VALUE"
            )
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
        shown = word if _PLAIN.fullmatch(word) else json.dumps(word, ensure_ascii=False)
        lines[row] = lines[row][:start] + shown + lines[row][start + len(p.value.text) :]
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
