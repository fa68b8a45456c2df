"""Data files that want to harm: cases of ``eval``, manifests and models that stand in an output folder."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.conftest import DIFFERENTIAL, tree
from tests.hostile.attempts import LINUX, Server, everyday, harmless, refused

pytestmark = LINUX
CASES: dict[str, str | bytes] = {
    "depth": "[" * 100_000,
    "depth of objects": '{"a":' * 100_000,
    "closed depth": "[" * 900 + "]" * 900,
    "depth in a value": '[{"vx": ' + "[" * 500 + "]" * 500 + "}]",
    "NaN": '[{"vx": NaN}]',
    "infinity": '[{"vx": -Infinity}]',
    "duplicate keys": '[{"vx": 1, "vx": 2}]',
    "1e400": '[{"vx": 1e400}]',
    "a huge exponent": '[{"vx": 1e999999999}]',
    "a huge exponent in a text": '[{"vx": "1e999999999"}]',
    "digits": '[{"vx": ' + "9" * 1_000_000 + "}]",
    "digits in a text": '[{"vx": "' + "9" * 1_000_000 + '"}]',
    "a tower": '[{"vx": "9**9**9"}]',
    "brackets": '[{"vx": "' + "(" * 10_000 + '"}]',
    "a sum": '[{"vx": "' + "1+" * 10_000 + '1"}]',
    "a division by zero": '[{"vx": "1/0"}]',
    "Python": '[{"vx": "__import__(\'os\')"}]',
    "an unknown unit": '[{"vx": "1 parsec"}]',
    "one bad of many": "[" + '{"vx": 1},' * 20_000 + '{"vx": "x"}]',
    "too large": "[" + " " * (17 << 20) + "]",
    "an object": '{"vx": 1}',
    "null": "null",
    "true": '[{"vx": true}]',
    "a null": '[{"vx": null}]',
    "a list": '[{"vx": [1, 2, 3]}]',
    "a long list": '[{"vx": [' + "1," * 100_000 + "1]}]",
    "a class": '[{"__class__": 1}]',
    "a long name": '[{"' + "a" * 1_000_000 + '": 1}]',
    "many names": "[{" + ",".join(f'"k{k}": 1' for k in range(100_000)) + "}]",
    "a surrogate": '[{"\\ud800": 1}]',
    "an escape sequence": '[{"\\u001b]0;pwned\\u0007": 1}]',
    "UTF-16": '[{"vx": nope}]'.encode("utf-16"),
    "no UTF-8": b'[{"vx\xff": 1}]',
    "NUL": b"\0",
    "nothing": b"",
    "more after the end": '[{"vx": 1}]x',
    "a comment": '[{"vx": 1}] // one',
}


_ALIASES = "\n".join(["a0: &a0 [1, 1]", *(f"a{k}: &a{k} [*a{k - 1}, *a{k - 1}]" for k in range(1, 20))])
CONTROLLERS: dict[str, str] = {
    "depth": "".join(f"{'  ' * k}k{k}:\n" for k in range(100)),
    "depth in brackets": "[" * 100_000,
    "aliases": f"{_ALIASES}\nwheel_separation: 0.4\n",
    "an alias of itself": "a: &a [*a]\nwheel_separation: 0.4\n",
    "a tag": "drive: {wheel_separation: !!python/name:os.system 1}\n",
    "NaN": "drive: {wheel_separation: .nan}\n",
    "1e400": "drive: {wheel_separation: 1e400}\n",
    "digits": f"drive: {{wheel_separation: {'9' * 100_000}}}\n",
    "true": "drive: {wheel_separation: true}\n",
    "an escape sequence": 'drive: {wheel_separation: "0.4\\e[31m"}\n',
    "keys of dots": f"{'a.b.' * 10_000}: {{wheel_separation: x}}\n",
    "very many": "".join(f"c{k}: {{wheel_separation: 0.4}}\n" for k in range(3000)),
}


@pytest.mark.parametrize("content", everyday(CONTROLLERS, "an alias of itself", "very many"))
def test_controllers(server: Server, tmp_path: Path, content: str) -> None:
    (tmp_path / "robot.yaml").write_text(DIFFERENTIAL)
    (tmp_path / "control.yaml").write_text(content)
    refused(server, tmp_path, "compare", "robot.yaml", "control.yaml", says=r"control\.yaml:\d+:\d+")


@pytest.mark.parametrize("name", ["a" * 50_000 + "!", "aA1_" * 12_000 + "$", "left_" * 10_000])
def test_long_names_of_joints_cost_no_time(server: Server, tmp_path: Path, name: str) -> None:
    (tmp_path / "robot.yaml").write_text(DIFFERENTIAL)
    (tmp_path / "control.yaml").write_text(f'drive: {{wheel_radius: 0.1, left_wheel_names: ["{name}"]}}\n')
    harmless(server.run(tmp_path, "compare", "robot.yaml", "control.yaml"))


@pytest.mark.parametrize("content", everyday(CASES, "depth", "1e400"))
def test_cases(server: Server, tmp_path: Path, content: str | bytes) -> None:
    (tmp_path / "robot.yaml").write_text(DIFFERENTIAL)
    (tmp_path / "cases.json").write_bytes(content if isinstance(content, bytes) else content.encode())
    words = ("eval", "robot.yaml", "inverse", "--cases")
    attempt = refused(server, tmp_path, *words, "cases.json")
    assert "cases.json" in attempt.err or "given twice" in attempt.err
    piped = server.run(tmp_path, *words, "-", stdin=tmp_path / "cases.json")
    assert (piped.code, piped.out, piped.changes) == (2, "", ())


NAMES = (
    "../../victim",
    "/etc/hostname",
    "a/../../../victim",
    "sub",
    "sub/../../../victim",
    "",
    ".",
    "..",
    "con",
    "a\\b",
    "\x00",
)
MANIFESTS: dict[str, str | bytes] = {
    "depth": "[" * 100_000,
    "no JSON": "{",
    "a list": "[]",
    "null": "null",
    "names elsewhere": '{"files": {' + ", ".join(f'"{name}": ""' for name in NAMES[:-2]) + "}}",
    "names as a list": '{"files": ["../../victim"]}',
    "a backslash": '{"files": {"..\\\\..\\\\victim": ""}}',
    "NUL": '{"files": {"\\u0000": ""}}',
    "a surrogate": '{"files": {"\\ud800": ""}}',
    "a number": '{"files": 5}',
    "a folder of the user": '{"files": {"sub": ""}}',
    "itself": '{"files": {"manifest.json": ""}}',
    "a long name": '{"files": {"' + "a" * 100_000 + '": ""}}',
    "many names": '{"files": {' + ", ".join(f'"f{k}": ""' for k in range(100_000)) + "}}",
    "options as a list": '{"made_with": [1], "files": {}}',
    "unknown options": '{"made_with": {"scalar": "int", "math": "$(id)", "target": "../../x", "y": "z"}, "files": {}}',
    "options as objects": '{"made_with": {"scalar": {"a": 1}}, "files": {}}',
    "NaN": '{"format": NaN, "files": {}}',
    "digits": '{"format": ' + "9" * 100_000 + "}",
    "50 MiB": '"' + "a" * (50 << 20) + '"',
    "UTF-16": '{"files": {}}'.encode("utf-16"),
}


@pytest.fixture(scope="module")
def derived(server: Server, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A robot file, a file of the user, and what `derive` wrote into ``out``."""
    place = tmp_path_factory.mktemp("derived")
    (place / "robot.yaml").write_text(DIFFERENTIAL)
    (place / "victim").write_text("mine")
    assert server.run(place, "derive", "robot.yaml", "-o", "out").code == 0
    return place


@pytest.mark.slow
@pytest.mark.parametrize("name", ["manifest.json", "model.json"])
@pytest.mark.parametrize("case", MANIFESTS)
def test_what_stands_in_the_output_folder(
    server: Server, derived: Path, tmp_path: Path, case: str, name: str
) -> None:
    """`check` says that it is stale, `derive` makes it what it should be; files of the user stay."""
    content = MANIFESTS[case]
    shutil.copytree(derived, tmp_path, dirs_exist_ok=True)
    folder = tmp_path / "out" / "pair"
    right = tree(folder)
    (folder / "sub").mkdir()
    (folder / "sub" / "mine").write_text("mine")
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    checked = server.run(tmp_path, "check", "robot.yaml", "-o", "out")
    assert checked.code == 1 and checked.changes == () and f"out/pair/{name}" in checked.out
    harmless(checked)
    again = server.run(tmp_path, "derive", "robot.yaml", "-o", "out")
    assert again.code == 0, again
    harmless(again)
    assert tree(folder) == {**right, "sub/mine": b"mine"} and (tmp_path / "victim").exists()
