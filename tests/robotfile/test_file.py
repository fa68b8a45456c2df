"""The file as a whole: bytes, characters, YAML, top keys, names, free text."""

from __future__ import annotations

import os
import unicodedata
from itertools import chain
from pathlib import Path

import pytest

from tests.robotfile.files import HEAD, places, read, refused, robot, wheel
from wmrgen.errors import Code, RobotFileError
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
    ("text", "where"),
    [
        ("", "WMR101 1:1"), ("# nothing\n", "WMR101 1:1"), ("---\n", "WMR101 1:1"), ("null", "WMR104 1:1"),
        ("- 1", "WMR104 1:1"), (f"name: bot\n{WHEELS}", "WMR103 1:1"),
        (f"wmrgen: 2\nname: bot\n{WHEELS}", "WMR104 1:9"), (f"wmrgen: 1\n{WHEELS}", "WMR103 1:1"),
        (HEAD, "WMR103 1:1"), (f"{HEAD}wheels: []\n", "WMR104 3:9"), (f"{HEAD}wheels: 3\n", "WMR104 3:9"),
        (f"{HEAD}wheels:\n", "WMR104 3:8"), (f"{HEAD}whels: 1\n{WHEELS}", "WMR102 3:1"),
        (f"{HEAD}x: 1\n{WHEELS}", "WMR102 3:1"), (f"{HEAD}name: b\n{WHEELS}", "WMR106 3:1"),
        (f"{HEAD}angles: degrees\n{WHEELS}", "WMR104 3:9"),
        (f"{HEAD}snap: maybe\n{WHEELS}", "WMR104 3:7"),
        (f"{HEAD}description: [1]\n{WHEELS}", "WMR104 3:14"),
        (f"{HEAD}description: {'x' * 2001}\n{WHEELS}", "WMR104 3:14"),
        (f"{HEAD}description:\n{WHEELS}", "WMR104 3:13"), (f'{HEAD}description: "a\\tb"\n{WHEELS}', "WMR104 3:14"),
        (f"{HEAD}description: __import__('os')\n{WHEELS}", "WMR104 3:14"),
        (f"{HEAD}description: a: b\n{WHEELS}", "WMR101 3:15"),
        (f"{HEAD}description: @a\n{WHEELS}", "WMR101 3:14"), (f"{HEAD}a: &x 1\n", "WMR101 3:4"),
        (f"{HEAD}a: *x\n", "WMR101 3:4"), (f"{HEAD}a: !!int 1\n", "WMR101 3:4"), (f"{HEAD}a: !x 1\n", "WMR101 3:4"),
        (f"{HEAD}? [a]\n: 1\n", "WMR101 3:3"), (f"{HEAD}? {{a: 1}}\n: 1\n", "WMR101 3:3"),
        (f"%YAML 1.1\n---\n{HEAD}", "WMR101 1:1"), (f"%TAG ! x\n---\n{HEAD}", "WMR101 1:1"),
        (f"{robot()}---\n{robot()}", "WMR101 5:1"), (f"{robot()}...\nfoo\n", "WMR101 6:1"),
        ("\tname: x", "WMR101 1:1"), (f"{HEAD}wheels: [\n", "WMR101 3:10"),
        (f'{HEAD}description: "a\n', "WMR101 3:14"), (f"{robot()} foo\n", "WMR101 5:2"),
        ("wmrgen: 1\nname: bot\nwheels:\n  - name: a\n   type: fixed\n", "WMR101 5:4"),
        (f'{HEAD}description: "\\UFFFFFFFF"\n', "WMR101 3:17"), (f'{HEAD}description: "\\q"\n', "WMR101 3:16"),
        (f'{HEAD}description: "\\ud800"\n', "WMR101 3:14"),
        (f"{HEAD}description: \ud800\n", "WMR101 3:14"),
        (f'{HEAD}description: "\\x07"\n', "WMR101 3:14"),
        (f"{HEAD}description: \x07\n", "WMR101 3:14"),
        (f"{HEAD}description: \x85\n", "WMR101 3:14"), (f"{HEAD}# \u202e\n{WHEELS}", "WMR101 3:3"),
        (f'{HEAD}description: "\\u2066"\n', "WMR101 3:14"), (f"{HEAD}# \ufeff\n", "WMR101 3:3"),
        (f"{HEAD}# \u2028\n", "WMR101 3:3"), (f"{HEAD}# \U000e0041\n", "WMR101 3:3"),
        (f"{HEAD}description: \uffff\n", "WMR101 3:14"), ("[" * 100_000, "WMR101 1:17"),
        ("{" * 100_000, "WMR101 1:17"), ("- " * 50_000, "WMR101 1:35"),
        ("? " * 50_000, "WMR101 1:35"), ("[1, " * 20 + "]", "WMR101 1:65"),
        ("x" * (300 * 1024), "WMR110"),
        (f"{'k' * 200}: 1\n", "WMR101 1:1"), ("a" * 200_000, "WMR104 1:1"),
    ],
)  # fmt: skip
def test_refused_files(text: str, where: str) -> None:
    error = refused(text)
    assert (places(error), error.exit_code) == (where, 2)


BIDIRECTIONAL = {"LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI"}  # classes of Unicode
TURNING = ("LEFT-TO-RIGHT MARK", "RIGHT-TO-LEFT MARK", "ARABIC LETTER MARK")


def test_refused_characters_follow_the_classes_of_unicode() -> None:
    """Controls except tab and newline, surrogates, bidirectional controls, and invisible characters."""
    for c in map(
        chr, chain(range(0x700), range(0x2000, 0x2100), range(0xD7F0, 0xE010), range(0xFD00, 0x10000))
    ):
        category = unicodedata.category(c)
        kind = {"Cc": "control character", "Cs": "lone surrogate"}.get(category)
        if unicodedata.bidirectional(c) in BIDIRECTIONAL or unicodedata.name(c, "") in TURNING:
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
    texts = (
        f"wmrgen: 1\nname: '{name}'\n{WHEELS}",
        robot(wheel(f"'{name}'")),
        robot(top=f"parameters: {{'{name}': 1}}\n"),
    )
    codes = [refused(text).code for text in texts]
    assert codes == ([Code.NAME] * 3 if name else [Code.FORM, Code.FORM, Code.NAME])


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
    assert places(refused(f"wmrgen: 1\nname: {name}\n{WHEELS}")) == "WMR105 2:7"


def test_paths_that_cannot_be_read(tmp_path: Path) -> None:
    for path in (tmp_path / "none.yaml", "nowhere/lekiwi.yaml", tmp_path, "a\0b", tmp_path / ("x" * 5000)):
        with pytest.raises(RobotFileError) as caught:
            read_robot(path)
        assert caught.value.code == Code.FILE and caught.value.instead
        gallery = "lekiwi" in str(path)
        assert ("wmrgen new lekiwi --from lekiwi -o nowhere/lekiwi.yaml" in caught.value.instead) is gallery


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root reads everything")
def test_an_unreadable_file(tmp_path: Path) -> None:
    path = tmp_path / "bot.yaml"
    path.write_text(robot())
    path.chmod(0)
    with pytest.raises(RobotFileError) as caught:
        read_robot(path)
    assert caught.value.code == Code.FILE


@pytest.mark.parametrize(
    ("data", "where"),
    [
        (b"\xff\xfew\0", "WMR110"), (b"wmrgen: 1\nname: b\xe9\n", "WMR101 2:8"),
        (b"\xed\xa0\x80", "WMR101 1:1"), (b"x" * (300 * 1024), "WMR110"),
        (b"\0" * 100, "WMR101 1:1"), (b"", "WMR101 1:1"), (b"\x89PNG\r\n", "WMR101 1:1"),
    ],
)  # fmt: skip
def test_bytes_that_are_not_a_robot_file(data: bytes, where: str, tmp_path: Path) -> None:
    path = tmp_path / "bot.yaml"
    path.write_bytes(data)
    with pytest.raises(RobotFileError) as caught:
        read_robot(path)
    str(caught.value).encode()
    assert places(caught.value) == where


def test_the_bad_byte_is_marked(tmp_path: Path) -> None:
    path = tmp_path / "bot.yaml"
    path.write_bytes(b"wmrgen: 1\nname: b\xe9c\n")
    with pytest.raises(RobotFileError) as caught:
        read_robot(path)
    mark = caught.value.mark
    assert mark is not None and (mark.line, mark.column) == (2, 8)


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
