"""Bad robot files as people write them, in bad_files.txt: the code and the place of each error.

A case is ``== its name``, the file, and a line ``-> code line:column`` for each error. A line ``=> words`` follows if
the error must offer these words. Lines ``~> this ~ that`` are what a user does then: with ``that`` in place of ``this``
the file is read. In the file ``\\t``, ``\\r`` and ``\\u200b`` are the characters that they stand for, and a backslash
at the end removes the line end.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import pytest

import wmrgen
from tests.robotfile.files import places
from wmrgen.errors import Code, RobotFileError

ESCAPE = re.compile(r"\\(?:u([0-9a-f]{4})|([tr\n]))")


class Case(NamedTuple):
    file: str
    places: list[str]  # of each error: code line:column
    words: list[tuple[int, str]]  # the number of an error, and words that it offers
    changes: list[tuple[str, str]]


def cases() -> dict[str, Case]:
    text = (Path(__file__).parent / "bad_files.txt").read_text(encoding="utf-8")
    found = {}
    for case in re.split(r"^== ", text, flags=re.MULTILINE)[1:]:
        name, _, rest = case.partition("\n")
        lines = re.findall(r"^(->|=>) (.*)$", rest, re.MULTILINE)
        found_places: list[str] = []
        words = []
        for sign, line in lines:
            if sign == "->":
                found_places.append(line)
            else:
                words.append((len(found_places) - 1, line))
        file = re.split(r"^-> ", rest, maxsplit=1, flags=re.MULTILINE)[0]
        changes = re.findall(r"^~> (.+?) ~ ?(.*)$", ESCAPE.sub(_meant, rest), re.MULTILINE)
        found[name] = Case(ESCAPE.sub(_meant, file), found_places, words, changes)
    return found


def _meant(escape: re.Match[str]) -> str:
    return chr(int(escape[1], 16)) if escape[1] else {"t": "\t", "r": "\r"}.get(escape[2], "")


CASES = cases()


@pytest.mark.parametrize("name", CASES)
def test_errors(name: str, tmp_path: Path) -> None:
    case = CASES[name]
    path = tmp_path / "bot.yaml"
    path.write_bytes(case.file.encode())
    with pytest.raises(RobotFileError) as caught:
        wmrgen.load(path)
    parts = caught.value.parts
    assert places(caught.value).split(", ") == case.places
    for part in parts:
        assert part.mark and (part.why or part.instead)
        changed = followed(case.file, part)
        if changed is not None:
            path.write_bytes(changed.encode())
            assert (part.what, part.mark) not in [(rest.what, rest.mark) for rest in errors(path)]
        a_letter_first = re.match(r"[^']*'[^\w']*[^\W\d_].*'", part.what)
        assert changed or part.code != Code.NAME or not a_letter_first, "a similar name is offered"
    for number, words in case.words:
        assert words in parts[number].instead
    if case.changes:
        file = case.file
        for this, that in case.changes:
            assert this.replace("\\n", "\n") in file
            file = file.replace(this.replace("\\n", "\n"), that.replace("\\n", "\n"))
        path.write_bytes(file.encode())
        wmrgen.load(path)


ADVICE = re.compile(r"(?:Write|Did you mean) ([^\s.?]+(?:: [^\s.?]+)?)(?:\.$|\?)")


def followed(file: str, part: RobotFileError) -> str | None:
    """The file with the offered word in place of the word that the error quotes; None if it offers no word."""
    quoted, advice = re.search("'(.+?)'", part.what), ADVICE.match(part.instead)
    lines = re.split(r"(\r\n|\r|\n)", file)
    if quoted is None or advice is None or part.mark is None:
        return None
    before, wrong, after = lines[2 * part.mark.line - 2].partition(quoted[1])
    lines[2 * part.mark.line - 2] = before + advice[1] + after
    return "".join(lines) if wrong else None


def errors(path: Path) -> tuple[RobotFileError, ...]:
    try:
        wmrgen.load(path)
    except RobotFileError as error:
        return error.parts
    return ()


def test_there_are_many() -> None:
    assert len(CASES) >= 190 and sum(len(case.places) for case in CASES.values()) > len(CASES)
