"""`wmrgen gallery`: pages of all robots that stand in a directory, made of what stands there."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

from markdown_it import MarkdownIt

from tests.conftest import GALLERY, ROOT, Outcome
from wmrgen.report.pages.overview import overview

Cli = Callable[..., Outcome]


def test_the_checked_in_pages_are_those_of_the_robots() -> None:
    pages = overview(ROOT / "generated")
    for name, content in pages.items():
        assert (ROOT / "generated" / name).read_bytes() == content, name
        places = re.findall(r'(?:src|href)="([^"]+)"|\]\(([^)]+)\)', content.decode())
        assert len(places) >= 2 * len(GALLERY)
        assert not [p for pair in places for p in pair if p and not (ROOT / "generated" / p).is_file()]
    rows = re.findall(r"^\| <img .*$", pages["README.md"].decode(), re.MULTILINE)
    assert [re.findall(r'src="(\w+)/', row)[0] for row in rows] == sorted(p.stem for p in GALLERY)
    (pioneer,) = (row for row in rows if "pioneer3dx" in row)
    assert pioneer.replace("&nbsp;", " ").endswith("| (2, 0), nonholonomic | 2, 0, 2 | 3 | 4, 4, 33 |")


def test_they_are_written_when_asked_for_and_looked_after(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, monkeypatch: object
) -> None:
    out = tmp_path / "generated"
    assert wmrgen_cli("gallery", "-o", out).code == 2
    hostile = "<script>pwned()</script> | `x` <img src=x onerror=pwned()> [a](javascript:pwned())"
    (tmp_path / "robots").mkdir()
    text = robot_file.read_text().replace("wheels:", f"description: {json.dumps(hostile)}\nwheels:", 1)
    (tmp_path / "robots" / "pair.yaml").write_text(text)
    assert wmrgen_cli("derive", tmp_path / "robots" / "pair.yaml", "-o", out).code == 0
    assert sorted(p.name for p in out.iterdir()) == ["pair"]
    monkeypatch.chdir(tmp_path)  # type: ignore[attr-defined]
    assert wmrgen_cli("check").code == 0
    assert json.loads(wmrgen_cli("gallery", "--json").out) == {
        "changed": ["README.md", "index.html"],
        "unchanged": [],
    }
    assert wmrgen_cli("check").code == 0
    html, markdown = ((out / name).read_text(encoding="utf-8") for name in ("index.html", "README.md"))
    assert "<script" not in html and html.count("<img") == 1 and 'href="javascript' not in html
    shown = MarkdownIt("commonmark", {"html": True}).enable("table").render(markdown)
    assert "<script" not in shown and shown.count("<img") == 1 and 'href="javascript' not in shown
    assert shown.count("<td") == 6
    assert html.count('href="pair/layout.svg"') == 2 and html.count('href="pair/report.md"') == 1
    assert wmrgen_cli("derive", tmp_path / "robots" / "pair.yaml", "-o", out, "--html").code == 0
    html = overview(out)["index.html"].decode()
    assert html.count('href="pair/report.html"') == 3 and "report.md" not in html
    (out / "index.html").write_text("mine")
    told = wmrgen_cli("check")
    assert told.code == 1 and "generated/index.html: not what" in told.out
    anew = ["generated/README.md (up to date)", "generated/index.html (new or changed)"]
    assert wmrgen_cli("gallery").out.splitlines() == anew
    (out / "other").mkdir()
    (out / "other" / "model.json").write_text("{}")  # no robot, no row
    assert overview(out)["README.md"].decode() == markdown
