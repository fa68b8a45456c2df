"""The site that `make docs` builds: every link leads somewhere, and pages open in headless Chromium without an error.

`.ci/run` builds it before the tests; elsewhere it is opened where it stands and is no older than its sources.
"""

from __future__ import annotations

from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlsplit

import pytest

from tests.conftest import ROOT
from tests.external_tools import missing
from tests.report.pages.chromium import opened

pytestmark = pytest.mark.slow
SITE = ROOT / "build" / "docs"
# Pages, and how many formulas they have at least.
OPENED = {
    "docs/index.html": 0, "docs/mathematics.html": 3, "docs/python.html": 0, "README.html": 6,
    "generated/errata.html": 100, "generated/wpilib_swervebot/report.html": 15,
}  # fmt: skip


@pytest.fixture(scope="module")
def pages() -> list[Path]:
    """All pages of the site."""
    sources = [*(ROOT / "docs").glob("*.*"), *(ROOT / "generated").glob("*/*.md"), *ROOT.glob("*.md")]
    index = SITE / "docs" / "index.html"
    if not index.is_file() or index.stat().st_mtime < max(path.stat().st_mtime for path in sources):
        missing("no site of these sources: make docs")
    return sorted(SITE.rglob("*.html"))


class Page(HTMLParser):
    """What a page links to, and the places in it that can be linked to."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.places: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if value and name in ("href", "src"):
                self.links.append(value)
            elif value and (name == "id" or (name == "name" and tag == "a")):
                self.places.add(value)


@cache
def read(path: Path) -> Page:
    page = Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def dead(path: Path) -> list[str]:
    """Links of a page into this site that lead nowhere."""
    wrong = []
    for link in read(path).links:
        address, place = urldefrag(link)
        if urlsplit(link).scheme or link.startswith("//"):
            continue
        target = (path.parent / unquote(urlsplit(address).path)).resolve() if address else path
        there = target.is_file() and target.is_relative_to(SITE)
        if not there or (place and target.suffix == ".html" and unquote(place) not in read(target).places):
            wrong.append(link)
    return wrong


def test_every_link_leads_somewhere(pages: list[Path]) -> None:
    assert len(pages) > 120
    assert sum(len(read(path).links) for path in pages) > 50 * len(pages)
    wrong = {path.relative_to(SITE).as_posix(): links for path in pages if (links := dead(path))}
    assert not wrong


def test_a_dead_link_is_seen(pages: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.report.pages.test_site.SITE", tmp_path)
    (tmp_path / "a.html").write_text(
        "<p id=here><a href='b.html'>b</a> <a href='#there'>c</a> <a href='a.html#here'>"
    )
    assert dead(tmp_path / "a.html") == ["b.html", "#there"]


@pytest.mark.parametrize("name", OPENED)
def test_pages_open(name: str, pages: list[Path], tmp_path: Path) -> None:
    """Nothing on the console, pictures seen, every formula typeset, nothing wider than the page but what scrolls."""
    script = """
    window.onload = () => document.title = JSON.stringify((() => {
    const math = [...document.querySelectorAll(".math")];
    const images = [...document.images].filter((image) => image.loading !== "lazy");
    return {
      bare: math.filter((e) => !e.querySelector(".katex")).map((e) => e.textContent),
      wrong: [...document.querySelectorAll(".katex-error")].map((e) => e.title),
      blind: images.filter((image) => !image.naturalWidth).map((image) => image.src),
      styled: getComputedStyle(document.body).fontFamily,
      overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth,
      formulas: math.length,
    }; })());"""
    path = SITE / name
    text = path.read_text(encoding="utf-8").replace("<head>", f'<head><base href="{path.as_uri()}">', 1)
    result, console = opened(text, script, tmp_path)
    assert console == [] and not result["bare"] and not result["wrong"] and not result["blind"]
    assert result["overflow"] <= 0 and "sans-serif" in result["styled"]
    assert result["formulas"] >= OPENED[name]
