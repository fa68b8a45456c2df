"""The file as a whole: bytes, characters, YAML, top keys, names, free text."""

from __future__ import annotations

import os
import unicodedata
from itertools import chain
from pathlib import Path

import pytest

from tests.robotfile.files import HEAD, read, robot, wheel
from wmrgen.errors import RobotFileError
from wmrgen.robotfile.load import read_robot
from wmrgen.robotfile.schema import json_schema
from wmrgen.robotfile.text import refused_character
from wmrgen.robotfile.wheel_types import WHEEL_TYPES

WHEELS = robot().removeprefix(HEAD)
ROBOTS = sorted((Path(__file__).parents[2] / "robots").glob("*.yaml"))


@pytest.mark.parametrize("path", ROBOTS, ids=lambda p: p.stem)
def test_the_gallery_is_read(path: Path) -> None:
    spec = read_robot(path)
    assert spec.name
    assert spec.wheels


def test_the_example_of_the_design() -> None:
    spec = read(
        "wmrgen: 1                      # format version\n"
        "name: pioneer\n"
        "description: Pioneer P3-DX\n"
        "parameters:\n"
        "  half_track: 0.1655\n"
        "  radius: {value: 0.0975, tunable: true}\n"
        "wheels:\n"
        "  - {name: left,  type: fixed,  l: half_track, alpha: pi/2,  beta: 0,  r: radius}\n"
        "  - {name: right, type: fixed,  l: half_track, alpha: -pi/2, beta: pi, r: radius}\n"
        "  - {name: tail,  type: castor, x: -0.22, y: 0, d: 0.04, r: 0.05}\n"
    )
    assert [w.name for w in spec.wheels] == ["left", "right", "tail"]
    assert [p.tunable for p in spec.parameters] == [False, True]
    assert spec.snap
    radius = spec.wheels[2].r
    assert radius is not None and radius.mark.line == 10


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("bom", [b"", b"\xef\xbb\xbf"])
def test_line_ends_and_byte_order_mark(end: str, bom: bytes, tmp_path: Path) -> None:
    path = tmp_path / "bot.yaml"
    path.write_bytes(bom + robot(wheel("a"), wheel("b")).replace("\n", end).encode())
    assert read_robot(path).wheels[1].mark.line == 5


def test_free_text() -> None:
    spec = read(
        f"{HEAD}description: |\n  two\n  lines é 中 %s \\end {{}} `x`\nsource: 42\nsnap: false\n{WHEELS}"
    )
    assert spec.description == "two\nlines é 中 %s \\end {} `x`"
    assert (spec.source, spec.snap) == ("42", False)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"), ("# nothing\n", "is empty"), ("---\n", "is empty"), ("null", "must be a mapping"),
        ("- 1", "must be a mapping"), (f"name: bot\n{WHEELS}", "no wmrgen"),
        (f"wmrgen: 2\nname: bot\n{WHEELS}", "version '2'"), (f"wmrgen: 1\n{WHEELS}", "no name"),
        (HEAD, "no wheels"), (f"{HEAD}wheels: []\n", "is empty"), (f"{HEAD}wheels: 3\n", "must be a list"),
        (f"{HEAD}wheels:\n", "must be a list"), (f"{HEAD}whels: 1\n{WHEELS}", "Did you mean wheels"),
        (f"{HEAD}x: 1\n{WHEELS}", "unknown key 'x'"), (f"{HEAD}name: b\n{WHEELS}", "duplicate key 'name'"),
        (f"{HEAD}angles: degrees\n{WHEELS}", "Did you mean deg"),
        (f"{HEAD}snap: maybe\n{WHEELS}", "true or false"),
        (f"{HEAD}description: [1]\n{WHEELS}", "one value"),
        (f"{HEAD}description: {'x' * 2001}\n{WHEELS}", "2001 characters"),
        (f"{HEAD}description:\n{WHEELS}", "no value"), (f'{HEAD}description: "a\\tb"\n{WHEELS}', "tab"),
        (f"{HEAD}description: __import__('os')\n{WHEELS}", "__import__"),
        (f"{HEAD}description: a: b\n{WHEELS}", "a second ':'"),
        (f"{HEAD}description: @a\n{WHEELS}", "cannot begin a value"), (f"{HEAD}a: &x 1\n", "anchor"),
        (f"{HEAD}a: *x\n", "alias"), (f"{HEAD}a: !!int 1\n", "tag"), (f"{HEAD}a: !x 1\n", "tag"),
        (f"{HEAD}? [a]\n: 1\n", "short word"), (f"{HEAD}? {{a: 1}}\n: 1\n", "short word"),
        (f"%YAML 1.1\n---\n{HEAD}", "directive"), (f"%TAG ! x\n---\n{HEAD}", "directive"),
        (f"{robot()}---\n{robot()}", "second document"), (f"{robot()}...\nfoo\n", "document"),
        ("\tname: x", "tab"), (f"{HEAD}wheels: [\n", "missing|not closed"),
        (f'{HEAD}description: "a\n', "never closed"), (f"{robot()} foo\n", "indentation|without"),
        ("wmrgen: 1\nname: bot\nwheels:\n  - name: a\n   type: fixed\n", "indentation"),
        (f'{HEAD}description: "\\UFFFFFFFF"\n', "not YAML"), (f'{HEAD}description: "\\q"\n', "escape"),
        (f'{HEAD}description: "\\ud800"\n', "surrogate U\\+D800"),
        (f"{HEAD}description: \ud800\n", "surrogate U\\+D800"),
        (f'{HEAD}description: "\\x07"\n', "control character U\\+0007"),
        (f"{HEAD}description: \x07\n", "control character"),
        (f"{HEAD}description: \x85\n", "control character"), (f"{HEAD}# \u202e\n{WHEELS}", "bidirectional"),
        (f'{HEAD}description: "\\u2066"\n', "bidirectional"), (f"{HEAD}# \ufeff\n", "invisible"),
        (f"{HEAD}# \u2028\n", "invisible"), (f"{HEAD}# \U000e0041\n", "invisible"),
        (f"{HEAD}description: \uffff\n", "invisible"), ("[" * 100_000, "deeper than 16"),
        ("{" * 100_000, "deeper than 16"), ("- " * 50_000, "deeper than 16"),
        ("? " * 50_000, "deeper than 16"), ("[1, " * 20 + "]", "deeper than 16"),
        ("x" * (300 * 1024), "larger than 256 KiB"),
        (f"{'k' * 200}: 1\n", "short word|without"), ("a" * 200_000, "must be a mapping"),
    ],
)  # fmt: skip
def test_refused_files(text: str, message: str) -> None:
    with pytest.raises(RobotFileError, match=message) as caught:
        read(text)
    str(caught.value).encode()
    assert caught.value.exit_code == 2


TURNS = {"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"}  # bidirectional classes of controls
TURNING = ("LEFT-TO-RIGHT MARK", "RIGHT-TO-LEFT MARK", "ARABIC LETTER MARK")


def test_characters_are_refused_as_unicode_classes_them() -> None:
    """Controls but for tab and newline, halves of characters, what turns the direction of reading, what none sees."""
    for c in map(
        chr, chain(range(0x700), range(0x2000, 0x2100), range(0xD7F0, 0xE010), range(0xFD00, 0x10000))
    ):
        category = unicodedata.category(c)
        kind = {"Cc": "control character", "Cs": "lone surrogate"}.get(category)
        if unicodedata.bidirectional(c) in TURNS or unicodedata.name(c, "") in TURNING:
            kind = "bidirectional control"
        refused = refused_character(f"ab{c}")
        if refused and not kind:
            kind = "invisible character"
            assert category in ("Cf", "Cn", "Zl", "Zp")
        wanted = (2, f"{kind} U+{ord(c):04X}") if kind and c not in "\t\n" else None
        assert (refused and refused[:2]) == wanted


FIELDS = [
    "wmrgen: 1", "name: bot", "description: text", "source: text", "angles: rad", "snap: true", "p: 0.1",
    "value: 1", "tunable: true", "name: a", "type: castor", "x: 0", "y: 0", "heading: 0", "d: 1",
    "offset_y: 0", "r: 1", "actuated: [spin]", "sensed: [spin]", "spin: 1", "vx: 1",
    "equal: [a.spin, b.spin]",
]  # fmt: skip
FULL = (
    "wmrgen: 1\nname: bot\ndescription: text\nsource: text\nangles: rad\nsnap: true\n"
    "parameters:\n  p: 0.1\n  q:\n    value: 1\n    tunable: true\n"
    "wheels:\n  - name: a\n    type: castor\n    x: 0\n    y: 0\n    heading: 0\n"
    "    d: 1\n    offset_y: 0\n    r: 1\n"
    "    actuated: [spin]\n    sensed: [spin]\n    limits:\n      spin: 1\n"
    "  - {name: b, type: fixed, l: 1, alpha: 0, beta: 0, r: 1}\n"
    "couplings:\n  - equal: [a.spin, b.spin]\nlimits:\n  vx: 1\n"
)


@pytest.mark.parametrize("attack", ["__import__('os')", "[__import__('os')]", "{__import__('os'): 1}"])
@pytest.mark.parametrize("line", FIELDS)
def test_code_in_any_field_is_refused(line: str, attack: str) -> None:
    read(FULL)
    assert f"{line}\n" in FULL
    with pytest.raises(RobotFileError):
        read(FULL.replace(f"{line}\n", f"{line.split(':')[0]}: {attack}\n", 1))
    with pytest.raises(RobotFileError):
        read(FULL.replace(f"{line}\n", f"__import__('os'): {line.split(': ')[1]}\n", 1))


@pytest.mark.parametrize(
    "name",
    [
        "1bot", "my-bot", "my bot", "é", "a" * 32, "", "double", "class", "template", "lambda",
        "yield", "sin", "printf", "malloc", "pose_t", "a__b", "con", "com1", "nul", "lpt9", "main", "../x",
        "a.b", "a/b", "y1", "_a", "Double", "CON", "Lpt9", "None", "EOF", "FL__x",
    ],
)  # fmt: skip
def test_refused_names_of_robot_wheel_and_parameter(name: str) -> None:
    for text in (
        f"wmrgen: 1\nname: '{name}'\n{WHEELS}",
        robot(wheel(f"'{name}'")),
        robot(top=f"parameters: {{'{name}': 1}}\n"),
    ):
        with pytest.raises(RobotFileError, match=r"not a valid|reserved|has no value|is empty"):
            read(text)


@pytest.mark.parametrize(
    "name",
    [
        "left",
        "front_left",
        "w1",
        "a",
        "a" * 31,
        "x",
        "y",
        "no",
        "on",
        "FL",
        "frontLeft",
        "A",
        "A" * 31,
        "R_2",
        "Bot_",
    ],
)
def test_ordinary_wheel_names(name: str) -> None:
    assert read(robot(wheel(name))).wheels[0].name == name


@pytest.mark.parametrize(
    "name", ["math", "numpy", "stdio", "Math", "std", "fork", "rclcpp", "Textbook", "loop"]
)
def test_a_robot_must_not_shadow_a_header_or_module(name: str) -> None:
    with pytest.raises(RobotFileError, match="reserved"):
        read(f"wmrgen: 1\nname: {name}\n{WHEELS}")


def test_paths_that_are_no_robot_file(tmp_path: Path) -> None:
    for path, message in (
        (tmp_path / "none.yaml", "no such file\n = Give the path"),
        ("nowhere/lekiwi.yaml", "`wmrgen new lekiwi --from lekiwi -o nowhere/lekiwi.yaml` begins it"),
        (tmp_path, "is a directory"),
        ("a\0b", "cannot be read|no such file"),
        (tmp_path / ("x" * 5000), "cannot be read"),
    ):
        with pytest.raises(RobotFileError, match=message):
            read_robot(path)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root reads everything")
def test_an_unreadable_file(tmp_path: Path) -> None:
    path = tmp_path / "bot.yaml"
    path.write_text(robot())
    path.chmod(0)
    with pytest.raises(RobotFileError, match="cannot be read"):
        read_robot(path)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"\xff\xfew\0", "UTF-16"), (b"wmrgen: 1\nname: b\xe9\n", "byte 0xe9 is not UTF-8"),
        (b"\xed\xa0\x80", "not UTF-8"), (b"x" * (300 * 1024), "larger than 256 KiB"),
        (b"\0" * 100, "control character"), (b"", "is empty"), (b"\x89PNG\r\n", "not UTF-8"),
    ],
)  # fmt: skip
def test_bytes_that_are_no_robot_file(data: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "bot.yaml"
    path.write_bytes(data)
    with pytest.raises(RobotFileError, match=message) as caught:
        read_robot(path)
    str(caught.value).encode()


def test_the_bad_byte_is_marked(tmp_path: Path) -> None:
    path = tmp_path / "bot.yaml"
    path.write_bytes(b"wmrgen: 1\nname: b\xe9c\n")
    with pytest.raises(RobotFileError) as caught:
        read_robot(path)
    mark = caught.value.mark
    assert mark is not None and (mark.line, mark.column) == (2, 8)


def test_every_error_names_file_line_column_and_shows_the_line() -> None:
    with pytest.raises(RobotFileError) as caught:
        read(robot(wheel("a", type="fixd")))
    lines = str(caught.value).split("\n")
    assert lines == [
        "error[WMR104]: unknown wheel type 'fixd'",
        " --> bot.yaml:4:21",
        "4 |   - {name: a, type: fixd, x: 0, y: 0.1, heading: 0, r: 0.05}",
        "  |                     ^",
        "  = The types are fixed steered castor swedish spherical.",
        "  = Did you mean fixed?",
    ]


def test_the_schema_lists_every_type_and_refuses_unknown_keys() -> None:
    schema = json_schema()
    names = [item["$ref"].rsplit("/", 1)[1] for item in schema["properties"]["wheels"]["items"]["oneOf"]]
    assert names == list(WHEEL_TYPES)
    for name in names:
        wheel_schema = schema["$defs"][name]
        assert wheel_schema["additionalProperties"] is False
        assert set(wheel_schema["required"]) <= set(wheel_schema["properties"])
    assert "γ" in schema["$defs"]["swedish"]["properties"]
    assert "d" not in schema["$defs"]["steered"]["properties"]


@pytest.mark.parametrize("key", ["parameters", "limits"])
def test_a_table_may_be_empty(key: str) -> None:
    assert read(robot(top=f"{key}: {{}}\n")).parameters == ()
