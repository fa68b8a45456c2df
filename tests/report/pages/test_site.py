"""The site that `make docs` builds: every link leads somewhere, and pages open in headless Chromium without an error.

`.ci/run` builds it before the tests; elsewhere it is opened where it stands and is no older than its sources.
"""

from __future__ import annotations

import re
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urldefrag, urlsplit

import pytest

from tests.conftest import GALLERY, ROOT
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
    """What a page links to, from its sidebar and from its text, and the places in it that can be linked to."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.sidebar: list[str] = []
        self.text: list[str] = []
        self.places: set[str] = set()
        self._open: list[str] = []  # classes of the open divisions, and articles

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        named = dict(attrs)
        if tag in ("div", "article"):
            self._open.append(tag if tag == "article" else named.get("class") or "")
        elif tag == "a" and (link := named.get("href")):
            if "sidebar-tree" in self._open:
                self.sidebar.append(link)
            elif "article" in self._open:
                self.text.append(link)
        for name, value in attrs:
            if value and name in ("href", "src"):
                self.links.append(value)
            elif value and (name == "id" or (name == "name" and tag == "a")):
                self.places.add(value)

    def handle_endtag(self, tag: str) -> None:
        if tag in ("div", "article"):
            self._open.pop()


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


def target(path: Path, link: str) -> Path:
    """The file of this site that a link of a page leads to; the page itself if it leads elsewhere."""
    address = urldefrag(link)[0]
    return path if not address or urlsplit(link).scheme else (path.parent / unquote(address)).resolve()


def test_the_sidebar_is_short_and_in_four_parts(pages: list[Path]) -> None:
    """Tutorials, how-to, reference, explanation. Texts link to the other pages; the gallery links to reports."""
    index = SITE / "docs" / "index.html"
    listed = {target(index, link) for link in read(index).sidebar}
    assert 25 <= len(read(index).sidebar) == len(listed) <= 40
    captions = re.findall(r'class="caption-text">([^<]*)<', index.read_text(encoding="utf-8"))
    assert [caption.lower() for caption in captions[:4]] == [
        "tutorials",
        "how-to",
        "reference",
        "explanation",
    ]
    reached, new = {index}, {index, *listed}
    while new:
        linked = {target(page, link) for page in new for link in read(page).text}
        new = (linked & set(pages)) - reached
        reached |= new
    assert not set(pages) - reached - listed - {SITE / "genindex.html", SITE / "search.html"}


def test_the_first_page_links_to_robots_to_drive(pages: list[Path]) -> None:
    index = SITE / "docs" / "index.html"
    live = {path for link in read(index).text if "live/" in link and (path := target(index, link)).is_file()}
    assert len(live) >= 6 and all('id="live"' in path.read_text(encoding="utf-8") for path in live)


def test_the_gallery_links_to_pages(pages: list[Path]) -> None:
    gallery = SITE / "generated" / "README.html"
    reports = {target(gallery, link) for link in read(gallery).text if "report" in link}
    assert reports == {SITE / "generated" / path.stem / "report.html" for path in GALLERY}


NARROW = 390  # px: the width of a usual telephone
WIDTHS = """
window.onload = () => {
  const found = {};
  for (const frame of document.querySelectorAll("iframe")) {
    const page = frame.contentDocument;
    const out = [];
    const edge = page.documentElement.clientWidth;
    const scrolls = (e) => e && e !== page.body
      && (getComputedStyle(e).overflowX !== "visible" || scrolls(e.parentElement));
    for (const e of page.querySelectorAll("article *, main *, #live *")) {
      const box = e.getBoundingClientRect();
      if (box.width && box.right > edge + 1 && !scrolls(e.parentElement)) out.push(e.outerHTML.slice(0, 120));
    }
    found[frame.title] = { over: page.documentElement.scrollWidth - edge, edge, out };
  }
  document.title = JSON.stringify(found);
};"""


def widths(pages: list[Path], folder: Path) -> Any:
    """Every page in a frame as wide as a telephone: by how many pixels it is wider, and elements that stick out."""
    frames = "".join(
        f'<iframe title="{path.relative_to(SITE).as_posix()}" src="{path.as_uri()}" width={NARROW} height=800 '
        'style="border: 0"></iframe>' for path in pages
    )  # fmt: skip
    page = f"<!doctype html><meta charset=utf-8><title></title><body>{frames}</body>"
    # One page may read another one of the same folder only with this option.
    return opened(page, WIDTHS, folder, flags=("--allow-file-access-from-files", "--hide-scrollbars"))


def test_every_page_fits_a_telephone(pages: list[Path], tmp_path: Path) -> None:
    """Wide tables, code and formulas scroll by themselves, the page does not."""
    found, console = widths(pages, tmp_path)
    assert console == [] and len(found) == len(pages)
    assert {page["edge"] for page in found.values()} == {NARROW}
    wide = {name: page for name, page in found.items() if page["over"] > 0 or page["out"]}
    assert not wide


def test_a_page_that_is_too_wide_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.report.pages.test_site.SITE", tmp_path)
    wide = tmp_path / "wide.html"
    wide.write_text("<!doctype html><article><p style='width: 500px'>a</p></article>")
    found, _ = widths([wide], tmp_path)
    assert found["wide.html"]["over"] > 0 and len(found["wide.html"]["out"]) == 1


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
