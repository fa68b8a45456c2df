"""``wmrgen new``: a robot file that begins as one of the gallery, its keys explained, with numbers of one's own."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import wmrgen
from wmrgen.cli import console
from wmrgen.cli.gallery import gallery, list_robots
from wmrgen.errors import Mark, UsageError
from wmrgen.robotfile.fields import Field, ListOf, Section
from wmrgen.robotfile.keys import ROBOT
from wmrgen.robotfile.load import read_text
from wmrgen.robotfile.names import robot_name
from wmrgen.robotfile.reader import read_tree
from wmrgen.robotfile.schema import MODELINE
from wmrgen.robotfile.text import MappingNode, Node, Scalar, SequenceNode, quoted, suggestion
from wmrgen.robotfile.typesetting import formatted

if TYPE_CHECKING:
    from wmrgen.robotfile.records import RobotSpec

from wmrgen.derivation.artifacts import write_file
from wmrgen.robotfile.schema import SCHEMA_FILE
from wmrgen.robotfile.shipped import shipped

_WIDTH = 110
_PLAIN = re.compile(r"[\w.+*/() -]+")  # values that mean the same without quotes, anywhere in YAML
_UNITS = "Lengths are in metres, angles in radians; a unit may stand behind a number: 150 mm, 30 deg."
_SELF_EVIDENT = ("wmrgen", "name", "description")


def new(
    name: str | None,
    values: Sequence[str] | None,
    start: str | None,
    description: str | None,
    out: Path | None,
    as_json: bool,
) -> int:
    """Write the robot file; on a terminal, what is not given is asked."""
    asks = console.can_ask()
    if not asks and not (name and start):
        raise UsageError(
            "a new robot needs a name and what it begins as. Write wmrgen new MY_ROBOT --from ROBOT; `wmrgen list` "
            "tells the gallery."
        )
    if start is None:
        list_robots(False)
        start = console.ask("Which of them is most like yours?", "pioneer3dx", _of_gallery)
    origin = gallery()[_of_gallery(start)].read_text(encoding="utf-8")
    name = _name(name) if name else console.ask("What is your robot called?", f"my_{start}", _name)
    path = out or Path(f"{name}.yaml")
    if path.exists():
        raise UsageError(f"{path} exists already. Give another name, or another file with --out.")
    spec = read_text(origin, f"{start}.yaml")
    words = _words(values or (), spec, start)
    if asks and not values and spec.parameters:
        console.note(_UNITS)
        for p in spec.parameters:
            words[p.name] = console.ask(
                f"{p.name}?", p.value.text, partial(_value, p.name, words, origin, spec)
            )
    text = _with_values(origin, spec, words)
    text = _commented(_renamed(text, name, description or f"after {spec.description}"), name, start)
    text = formatted(text, str(path))
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


def _of_gallery(name: str) -> str:
    """The name of a robot of the gallery. UsageError where there is none."""
    if name not in gallery():
        raise UsageError(f"the gallery has no robot {quoted(name)}. {suggestion(name, list(gallery()))}")
    return name


def _name(name: str) -> str:
    """A name that a robot may have. RobotFileError for another."""
    return robot_name(Scalar(Mark("the name of the robot", 1, 1, name), name, True))


def _value(name: str, words: Mapping[str, str], origin: str, spec: RobotSpec, word: str) -> str:
    """``word``, with which as the value of a parameter the file is a robot. RobotFileError where it is none."""
    wmrgen.robot_of(read_text(_with_values(origin, spec, {**words, name: word}), f"{spec.name}.yaml"))
    return word


def _words(values: Sequence[str], spec: RobotSpec, start: str) -> dict[str, str]:
    """PARAMETER=VALUE words by parameter. UsageError for what ``start`` does not have."""
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
    """``text``, the file of ``spec``, with other values of parameters."""
    lines = text.split("\n")
    changed = [p for p in spec.parameters if words.get(p.name, p.value.text) != p.value.text]
    for p in sorted(changed, key=lambda p: (p.value.mark.line, p.value.mark.column), reverse=True):
        word, row, start = words[p.name], p.value.mark.line - 1, p.value.mark.column - 1
        shown = word if _PLAIN.fullmatch(word) else json.dumps(word, ensure_ascii=False)
        lines[row] = lines[row][:start] + shown + lines[row][start + len(p.value.text) :]
    return "\n".join(lines)


def _renamed(text: str, name: str, description: str) -> str:
    """``text`` of the gallery with another name and description, without what is said of its source."""
    text = re.sub(r"\A(#.*\n)*", "", text)
    text = re.sub(r"^source: .*\n", "", text, flags=re.MULTILINE)
    text = re.sub(r"^name: .*$", f"name: {name}", text, count=1, flags=re.MULTILINE)
    said = f"description: {json.dumps(description, ensure_ascii=False)}"
    return re.sub(r"^description: .*$", lambda _: said, text, count=1, flags=re.MULTILINE)


def _commented(text: str, name: str, start: str) -> str:
    """``text`` with a head and, above each key, what it and the keys in it mean."""
    tree = read_tree(text, name)
    above = {
        key.mark.line: list(_meaning(ROBOT.field(key.text), value))
        for key, value in (tree.entries if isinstance(tree, MappingNode) else ())
        if key.text not in _SELF_EVIDENT
    }
    head = (
        f"{name}, begun as {start} of wmrgen's gallery. x points forward, y to the left, angles are counter-clockwise. "
        + _UNITS
    )
    lines = [MODELINE, *_comment(head)]
    for number, line in enumerate(text.rstrip("\n").split("\n"), 1):
        lines += [*above.get(number, ()), line]
    return "\n".join(lines) + "\n"


def _meaning(field: Field, value: Node) -> Iterator[str]:
    yield from _comment(field.meaning)
    item = field.value.item if isinstance(field.value, ListOf) else field.value
    if isinstance(item, Section):
        rows = value.items if isinstance(value, SequenceNode) else (value,)
        keys = {key.text for row in rows if isinstance(row, MappingNode) for key, _ in row.entries}
        for part in item.fields:
            if part.key in keys:
                yield from _comment(f"{part.key}: {part.meaning}", "  ")


def _comment(words: str, indent: str = "") -> list[str]:
    return textwrap.wrap(words, _WIDTH, initial_indent=f"# {indent}", subsequent_indent=f"#   {indent}")


# ---- writing a robot file, with the schema beside it that its first line names


def write_robot_file(path: Path, text: str) -> list[str]:
    """Write ``text``, and the schema for editors where none is there yet; the files written.

    UsageError for a file name that cannot be, EnvironmentFailure where it cannot be written."""
    schema = path.parent / SCHEMA_FILE
    write_file(path, text.encode())
    if schema.exists():
        return [str(path)]
    write_file(schema, (shipped("robots") / SCHEMA_FILE).read_bytes())
    return [str(path), str(schema)]
