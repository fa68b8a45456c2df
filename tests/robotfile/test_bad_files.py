"""Bad robot files as people write them, in bad_files.txt: the first line and the place of each error that is told.

A case is ``== its name``, the file, and ``-> error at line:column`` for each error, where it matters with a line
``=> what to write``. ``~> this ~ that``, where it stands: the advice followed to the letter, that in the place of this,
after which the file is read. In the file ``\\t``, ``\\r`` and
``\\u200b`` are the characters that they stand for, and a backslash at the end takes the line end away.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import wmrgen
from wmrgen.errors import Code, RobotFileError

ESCAPE = re.compile(r"\\(?:u([0-9a-f]{4})|([tr\n]))")


def cases() -> Iterator[tuple[str, str, list[str], list[str], list[tuple[str, str]]]]:
    text = (Path(__file__).parent / "bad_files.txt").read_text(encoding="utf-8")
    for case in re.split(r"^== ", text, flags=re.MULTILINE)[1:]:
        name, _, rest = case.partition("\n")
        told = re.findall(r"^-> (.*)$", rest, re.MULTILINE)
        file = re.split(r"^-> ", rest, maxsplit=1, flags=re.MULTILINE)[0]
        advice = re.findall(r"^=> (.*)$", rest, re.MULTILINE)
        mends = re.findall(r"^~> (.+?) ~ ?(.*)$", ESCAPE.sub(_meant, rest), re.MULTILINE)
        yield name, ESCAPE.sub(_meant, file), told, advice, mends


def _meant(escape: re.Match[str]) -> str:
    return chr(int(escape[1], 16)) if escape[1] else {"t": "\t", "r": "\r"}.get(escape[2], "")


CASES = {name: case for name, *case in cases()}


@pytest.mark.parametrize("name", CASES)
def test_what_is_told(name: str, tmp_path: Path) -> None:
    file, told, advice, mends = CASES[name]
    path = tmp_path / "bot.yaml"
    path.write_bytes(file.encode())
    with pytest.raises(RobotFileError) as caught:
        wmrgen.load(path)
    parts = caught.value.parts
    places = [f" at {part.mark.line}:{part.mark.column}" for part in parts if part.mark]
    assert [str(part).splitlines()[0] + place for part, place in zip(parts, places, strict=True)] == told
    assert {*advice} <= {part.instead for part in parts}
    for part in parts:  # each stands in the form, says what to write, and its caret below the place
        _, place, *shown = str(part).splitlines()
        assert place.strip() == f"--> {part.mark}"
        if part.mark and part.mark.text:
            line, caret = shown[:2]
            assert caret.index("^") - caret.index("|") == part.mark.column + 1 and line.startswith(
                str(part.mark.line)
            )
        assert part.why or part.instead
        if (mended := followed(file, part)) is not None:
            path.write_bytes(mended.encode())
            assert (part.what, part.mark) not in [(rest.what, rest.mark) for rest in errors(path)]
        a_letter_first = re.match(r"[^']*'[^\w']*[^\W\d_].*'", part.what)
        assert mended or part.code != Code.NAME or not a_letter_first, "a name that is near"
    for this, that in mends:
        assert this.replace("\\n", "\n") in file
        file = file.replace(this.replace("\\n", "\n"), that.replace("\\n", "\n"))
    if mends:
        path.write_bytes(file.encode())
        wmrgen.load(path)


ADVICE = re.compile(r"(?:Write|Did you mean) ([^\s.?]+(?:: [^\s.?]+)?)(?:\.$|\?)")


def followed(file: str, part: RobotFileError) -> str | None:
    """The file with what its error advises in the place of what it quotes; None where that is no word for another."""
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
    assert len(CASES) >= 190 and sum(len(told) for _, told, *_ in CASES.values()) > len(CASES)
