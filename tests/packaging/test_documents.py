"""What README and the documents show is what wmrgen does, and every link leads somewhere."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import yaml

from tests.conftest import ROOT, Outcome
from tests.packaging.blocks import blocks
from wmrgen import __version__
from wmrgen.functions.registry import names

DOCUMENTS = (
    *(p for p in sorted(ROOT.glob("*.md"))),
    *sorted((ROOT / "docs").glob("*.md")),
    ROOT / "tests" / "README.md",
    ROOT / "examples" / "README.md",
    *sorted((ROOT / "generated").rglob("*.md")),
)
SHOWN = "\n".join((ROOT / name).read_text(encoding="utf-8") for name in ("README.md", "docs/commands.md"))
_LINK = re.compile(r"\]\(([^()\s]+)\)")


def prose(path: Path) -> str:
    """A document without its fenced blocks and code spans."""
    text = re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"`[^`\n]+`", "", re.sub(r"\[`[^`\n]+`\]", "[code]", text))


def headings(path: Path) -> set[str]:
    """The anchors that GitHub gives to the headings of a document."""
    titles = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", t.lower()).replace(" ", "-") for t in titles}


def broken(path: Path) -> list[str]:
    """Links of a document that lead nowhere in the repository."""
    found = []
    for link in _LINK.findall(prose(path)):
        if link.startswith(("http://", "https://")):
            continue
        place, _, anchor = link.partition("#")
        target = (path.parent / place).resolve() if place else path
        if (
            not target.exists()
            or not target.is_relative_to(ROOT)
            or (anchor and anchor not in headings(target))
        ):
            found.append(f"{path.name}: {link}")
    return found


def test_every_link_leads_somewhere() -> None:
    assert not [link for path in DOCUMENTS for link in broken(path)]


def test_a_broken_link_is_found(tmp_path: Path) -> None:
    page = ROOT / "docs" / "ARCHITECTURE.md"
    assert page in DOCUMENTS and _LINK.findall(prose(page))
    assert "how-to-add" in headings(page)
    text = tmp_path / "page.md"
    text.write_text("[a](nowhere.md) `[b](c)` [`d`](nor.md), [`e`](here.md)\n```c\nx[1](y)\n```\n")
    assert broken(text) == ["page.md: nowhere.md", "page.md: nor.md", "page.md: here.md"]


def test_the_front_page_is_short() -> None:
    page = ROOT / "README.md"
    assert page.stat().st_size <= 6000
    assert page.read_text(encoding="utf-8").index("## Start") < 1200


def test_modules_named_on_the_page_of_the_architecture_exist() -> None:
    text = (ROOT / "docs" / "ARCHITECTURE.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`((?:\w+/)*\w+(?:\.py|/))`", text))
    assert len(named) > 20
    missing = {n for n in named if not (ROOT / n).exists() and not (ROOT / "wmrgen" / n).exists()}
    assert not missing


def test_words_of_the_glossary_are_names_in_the_code() -> None:
    text = (ROOT / "docs" / "GLOSSARY.md").read_text(encoding="utf-8")
    rows = [line.split("|") for line in text.splitlines() if line.startswith("| ") and "`" in line]
    source = "\n".join(p.read_text(encoding="utf-8") for p in sorted((ROOT / "wmrgen").rglob("*.py")))
    words = set(re.findall(r"\w+", source)) | {p.stem for p in (ROOT / "wmrgen").rglob("*")}
    assert len(rows) > 60 and all(row[4].strip() for row in rows)
    assert not [w for row in rows for w in re.findall(r"`(\w+)`", row[2]) if w not in words]


def test_every_function_is_on_the_page_of_functions() -> None:
    text = (ROOT / "docs" / "functions.md").read_text(encoding="utf-8")
    assert not [name for name in names() if f"`{name}`" not in text]


def test_every_verb_is_on_the_page_of_commands(wmrgen_cli: Callable[..., Outcome]) -> None:
    listed = re.findall(r"^  (\w+)  ", wmrgen_cli("--help").out, re.MULTILINE)
    assert len(listed) > 10
    assert not [verb for verb in listed if f"wmrgen {verb}" not in SHOWN]


def test_the_robot_file_is_the_gallery_s() -> None:
    first, shown = (b.text for b in blocks(ROOT / "README.md") if b.language == "yaml")
    assert len(first.splitlines()) == 5
    kept = (ROOT / "robots" / "pioneer3dx.yaml").read_text(encoding="utf-8").partition("wmrgen: 1\n")[2]
    said = [line for line in kept.splitlines() if not line.startswith(("description:", "source:"))]
    assert shown.splitlines() == ["wmrgen: 1", *said] and len(said) < 10


def test_the_citation_is_of_this_version() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert {"cff-version", "message", "title", "authors"} <= set(citation) and citation["license"] == "MIT"
    assert citation["version"] == __version__
