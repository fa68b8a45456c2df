"""Same robot file and version, same bytes: whatever the hash seed, folder, locale and time zone."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import jinja2
import pytest

from tests.conftest import ROOT, process, tree
from wmrgen.codegen import render

ROBOTS = [
    ROOT / "robots" / f"{name}.yaml"
    for name in ("pioneer3dx", "pr2", "kuka_youbot", "office_chair", "synchro_drive")
]
SURROUNDINGS = [
    {"PYTHONHASHSEED": "0", "LC_ALL": "C", "TZ": "UTC"},
    {"PYTHONHASHSEED": "1", "LC_ALL": "tr_TR.UTF-8", "TZ": "Asia/Kathmandu"},
    {"PYTHONHASHSEED": "271828", "LC_ALL": "de_DE.ISO-8859-1", "TZ": "America/St_Johns", "PYTHONUTF8": "0"},
    {
        "PYTHONHASHSEED": "4294967295",
        "LC_ALL": "POSIX",
        "LANGUAGE": "fr",
        "COLUMNS": "20",
        "SOURCE_DATE_EPOCH": "1",
    },
]


@pytest.mark.slow
def test_same_bytes_everywhere(tmp_path: Path) -> None:
    made = []
    for k, env in enumerate(SURROUNDINGS):
        folder = tmp_path / f"somewhere {k}" / ("deep/" * k)
        folder.mkdir(parents=True)
        robots = [r.relative_to(ROOT) for r in ROBOTS] if k == 0 else ROBOTS
        cwd = ROOT if k == 0 else folder
        outcome = process("derive", *robots, "-o", folder / "out", cwd=cwd, env=env)
        assert outcome.code == 0, outcome.err
        made.append(tree(folder / "out"))
    assert len(made[0]) > 5 * len(ROBOTS)
    for other in made[1:]:
        assert other.keys() == made[0].keys()
        assert [name for name in other if other[name] != made[0][name]] == []


@pytest.mark.slow
def test_order_and_company_do_not_matter(tmp_path: Path) -> None:
    """A robot derived after others, in the same process, has the bytes it has alone."""
    together, alone = tmp_path / "together", tmp_path / "alone"
    assert process("derive", *reversed(ROBOTS), "-o", together).code == 0
    assert process("derive", ROBOTS[0], "-o", alone).code == 0
    assert tree(together / "pioneer3dx") == tree(alone / "pioneer3dx")


@pytest.mark.slow
def test_nothing_of_this_machine_stands_in_the_output(tmp_path: Path) -> None:
    outcome = process("derive", ROBOTS[0], "-o", tmp_path)
    assert outcome.code == 0, outcome.err
    for name, content in tree(tmp_path).items():
        for word in (str(ROOT), str(tmp_path), str(Path.home())):
            if len(word) > 5:
                assert word.encode() not in content, name


@pytest.mark.parametrize("robot", ROBOTS[:1], ids=lambda p: p.stem)
@pytest.mark.slow
def test_deriving_again_touches_nothing(tmp_path: Path, robot: Path) -> None:
    assert process("derive", robot, "-o", tmp_path).code == 0
    before = {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*")}
    again = process("derive", robot, "-o", tmp_path)
    assert "all up to date" in again.out
    assert {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*") if p.is_file()} == {
        p: t for p, t in before.items() if p.is_file()
    }


def test_what_templates_are_compiled_to_is_kept_while_they_and_jinja_stay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    monkeypatch.setattr(sys, "pycache_prefix", None)
    monkeypatch.setattr(render, "shipped", lambda _: tmp_path)
    template, jinja = tmp_path / "a.txt.j2", tmp_path / "jinja.py"
    jinja.write_text("")
    compiled: list[str] = []
    really = render._Source.source_to_code
    monkeypatch.setattr(
        render._Source, "source_to_code", lambda *words, **_: compiled.append(words[2]) or really(*words)
    )

    def text(anew: int) -> str:
        compiled.clear()
        shown = render._Templates().load(render._environment(), template.name).render(x=1)
        assert compiled == [str(template)] * anew
        return shown

    template.write_text("{{ x }} one")
    assert [text(anew=1), text(anew=0)] == ["1 one", "1 one"]
    template.write_text("{{ x }} two")
    os.utime(template, (0, 0))
    assert [text(anew=1), text(anew=0)] == ["1 two", "1 two"]
    monkeypatch.setattr(jinja2, "__file__", str(jinja))  # newer than what was compiled
    assert [text(anew=1), text(anew=0)] == ["1 two", "1 two"]
    (kept,) = (tmp_path / "__pycache__").iterdir()
    kept.unlink()
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    assert [text(anew=1), text(anew=1)] == ["1 two", "1 two"]
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    kept.parent.rmdir()
    kept.parent.write_text("in the way")
    assert [text(anew=1), text(anew=1)] == ["1 two", "1 two"]
