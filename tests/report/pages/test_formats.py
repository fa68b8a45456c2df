"""`derive --html` and `--pdf`: one file that needs no other, fresh and told of, in which texts are texts."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Callable
from functools import partial
from html.parser import HTMLParser
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome
from tests.external_tools import missing, need, tool
from tests.report.pages.katex import mistakes
from tests.robots import of_gallery, of_text
from wmrgen.codegen.compiler import _BROWSERS, _TEX, print_pages
from wmrgen.report.pages import live
from wmrgen.report.pages.document import Report, html, page

Cli = Callable[..., Outcome]
TRAILER = "trailers: [{length: 0.9, hitch: 0.1}]\n"


class Elements(HTMLParser):
    """The tags of a page with their attributes, and the texts of its scripts."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: dict[str, list[str]] = {}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        if self.tags:
            self.texts.setdefault(self.tags[-1][0], []).append(data)

    def attributes(self, name: str) -> list[str]:
        return [str(attrs[name]) for _, attrs in self.tags if name in attrs]


def test_html_is_one_file_and_stays_fresh(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    out, words = tmp_path / "out", ("derive", robot_file, "-o", tmp_path / "out")
    assert wmrgen_cli(*words, "--html").code == 0
    text = (out / "pair" / "report.html").read_text(encoding="utf-8")
    assert len(text.encode()) < 1_500_000
    elements = Elements(text)
    assert not elements.attributes("src")
    assert not [a for a in elements.attributes("href") if re.match(r"(\w+:)?//", a)]
    assert not re.findall(r"url\((?!data:)", text) and text.count("url(data:font/woff2;base64,") == 9
    assert sum(tag == "svg" for tag, _ in elements.tags) >= 1
    ids = elements.attributes("id")
    assert len(ids) == len(set(ids))
    assert "</section>" in text and "@media print" in text and "prefers-color-scheme: dark" in text
    assert "report.html" in json.loads((out / "pair" / "manifest.json").read_text())["files"]
    assert wmrgen_cli("check", robot_file, "-o", out).code == 0
    before = text
    assert wmrgen_cli(*words, "--html").code == 0
    assert (out / "pair" / "report.html").read_text(encoding="utf-8") == before
    (out / "pair" / "report.html").write_text("mine")
    assert (
        "report.html: not what the robot file gives today" in wmrgen_cli("check", robot_file, "-o", out).out
    )
    without = wmrgen_cli(*words)
    assert (without.code, "removed report.html" in without.err) == (0, True)
    assert wmrgen_cli("check", robot_file, "-o", out).code == 0


@pytest.mark.slow
@pytest.mark.parametrize("programs", ["tex", "browser"])
def test_pdf(
    programs: str, wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All pages on A4, with a fixed date, by TeX or by Chromium."""
    if programs == "tex":
        tool("lualatex")
        tool("rsvg-convert")
    else:
        monkeypatch.setattr("wmrgen.codegen.compiler._TEX", ())
        if not any(shutil.which(name) for name in _BROWSERS):
            missing("no Chromium")
    out, words = tmp_path / "out", ("derive", robot_file, "-o", tmp_path / "out", "--pdf")
    assert wmrgen_cli(*words).code == 0
    printed = (out / "pair" / "report.pdf").read_bytes()
    assert printed.startswith(b"%PDF-") and not (out / "pair" / "report.html").exists()
    assert re.search(rb"\(D:20000101000000(\+00'00'|Z)\)", printed)
    assert b"(D:20" not in re.sub(rb"\(D:2000", b"", printed)
    assert len(printed) > 100_000  # figures and fonts are in it
    assert wmrgen_cli("check", robot_file, "-o", out).code == 0
    (out / "pair" / "report.pdf").write_bytes(b"mine")
    assert wmrgen_cli("check", robot_file, "-o", out).code == 1


@pytest.mark.skipif(os.name != "posix", reason="a script of sh is the browser")
def test_what_a_browser_prints_has_no_date(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A browser that copies the page which it is given."""
    browser = tmp_path / _BROWSERS[0]
    browser.write_text('#!/bin/sh\nfor page; do :; done\ncp "${page#file://}" page.pdf\n', encoding="utf-8")
    browser.chmod(0o755)
    monkeypatch.setattr("wmrgen.codegen.compiler._TEX", ())
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    page = "%PDF-1.4 /CreationDate (D:20261124043000+00'00') /ModDate(D:2026) text"
    then = b"(D:20000101000000+00'00')"
    printed = print_pages("", page, {})
    assert printed == b"%PDF-1.4 /CreationDate " + then + b" /ModDate" + then + b" text"


@pytest.mark.skipif(os.name != "posix", reason="scripts of sh are the tools")
def test_tex_prints_the_document_with_its_figures(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A TeX that copies the document and says what stands beside it."""
    scripts = {
        "rsvg-convert": '#!/bin/sh\ncp "$3" "${2#--output=}"\n',
        _TEX[1]: "#!/bin/sh\n(echo %PDF; cat page.tex; echo *) > page.pdf\n",
    }
    for name, script in scripts.items():
        (tmp_path / name).write_text(script, encoding="utf-8")
        (tmp_path / name).chmod(0o755)
    monkeypatch.setattr("shutil.which", partial(shutil.which, path=str(tmp_path)))
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out", "--pdf", "--tex")
    assert done.code == 0, done.err
    told = (tmp_path / "out" / "pair" / "report.pdf").read_text(encoding="utf-8")
    assert told.count(r"\section*{") == 3 and told.count("\\clearpage\n") == 2
    alone = (tmp_path / "out" / "pair" / "report.tex").read_text(encoding="utf-8")
    assert alone.partition(r"\end{document}")[0] in told
    assert {"layout.pdf", "motion.pdf"} <= set(told.splitlines()[-1].split())


def test_without_a_program_that_prints(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("shutil.which", lambda *_, **__: None)
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out", "--pdf")
    assert done.code == 4 and "apt-get install chromium" in done.err
    assert not (tmp_path / "out").exists()


HOSTILE = (
    "<script>pwned()</script>", "<img src=x onerror=pwned()>", "</script><script>pwned()</script>",
    "<!-- pwned <script>", "</title></style><svg onload=pwned()>", "<details open ontoggle=pwned()>",
    "<sub onclick=pwned()>", "$\\input{pwned}$", "`a` | b", "[pwned](javascript:pwned())",
    "![pwned](http://127.0.0.1:9/x.png)", "<javascript:pwned()>", "*/ pwned()",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("text", HOSTILE)
def test_texts_are_texts(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, text: str) -> None:
    plain = robot_file.read_text().replace("wheels:", f"description: {json.dumps(text)}\nwheels:", 1)
    robot_file.write_text(plain)
    assert wmrgen_cli("derive", robot_file, "-o", tmp_path / "out", "--html").code == 0
    harmless_page((tmp_path / "out" / "pair" / "report.html").read_text(encoding="utf-8"))


@pytest.mark.parametrize("text", HOSTILE)
def test_texts_of_markdown_are_texts(text: str) -> None:
    """Were a report ever to let one through."""
    files = {
        "report.md": f"# a\n\n{text}\n\n```math\n{text}\n```\n\n{text}\n".encode(),
        "layout.svg": b"<svg></svg>",
    }
    harmless_page(page([Report("a", files)]))
    harmless_page(page([Report("a", files, {"name": text}, "{}")]))


def harmless_page(text: str) -> None:
    elements = Elements(text)
    scripts = [tag for tag, _ in elements.tags if tag == "script"]
    assert len(scripts) == text.count("<script>") == len(re.findall("sha256-", text))
    assert not [name for _, attrs in elements.tags for name in attrs if name.startswith("on")]
    assert not [a for a in (*elements.attributes("src"), *elements.attributes("href")) if "pwned" in a]
    assert not any(tag in ("img", "iframe", "object", "base", "link", "form") for tag, _ in elements.tags)


def test_markdown_of_reports() -> None:
    text = html(
        "# A `b`\n\n## A b\n\n## A b\n\nv<sub>x</sub> <b>\n\n<details>\n<summary>S</summary>\n\n*in*\n\n</details>\n\n"
        "![top](layout.svg) ![other](x.svg)\n\n|a|\n|-|\n|1|\n\n```math\na < b\n```\n",
        {"layout.svg": "<svg></svg>"},
    )
    assert '<h1 id="a-b">A <code>b</code></h1>' in text and '<h2 id="a-b-2">' in text
    assert "v<sub>x</sub> &lt;b&gt;" in text and "<details>\n<summary>S</summary>\n<p><em>in</em></p>" in text
    assert '<span class="figure"><svg></svg></span> other' in text
    assert '<div class="wide"><table>' in text and '<div class="math">a &lt; b\n</div>' in text


def test_chapters_link_each_other() -> None:
    files = {"report.md": b"[costs](numerics.md)", "numerics.md": b"# Costs\n\n[up](report.md) [c](a.h)"}
    elements = Elements(page([Report("a", files)]))
    assert elements.attributes("href") == ["#a-numerics.md", "#a-report.md", "a.h"]
    assert {"a-report.md", "a-numerics.md"} <= set(elements.attributes("id"))


_MATH = re.compile(  # in turn: formulas and code, of which only the former is in a group
    r"^```math\n(.*?)^```|^```.*?^```|\$\$(.+?)\$\$|\$`([^`]+)`\$|`[^`\n]*`|(?<!\\)\$([^$\n]+)\$",
    re.DOTALL | re.MULTILINE,
)


@pytest.mark.slow
def test_every_formula_is_one_to_katex() -> None:
    """Strict, in every report and page that is checked in."""
    need("node")
    pages = [
        ROOT / "README.md",
        *sorted((ROOT / "docs").glob("*.md")),
        *sorted((ROOT / "generated").rglob("*.md")),
    ]
    assert mistakes([r"a+\frac{1}{2}", r"\foo", r"a ü"]) != [] and mistakes([r"a+\frac{1}{2}"]) == []
    texts = [path.read_text(encoding="utf-8") for path in pages]
    formulas = [formula for text in texts for groups in _MATH.findall(text) if (formula := "".join(groups))]
    assert len(formulas) > 900
    assert mistakes(formulas) == []


def test_trailers_of_a_robot_without_a_model_of_motion_are_not_towed() -> None:
    """Two steered wheels with one speed: their angles are tied, and no model has free steering rates."""
    wheels = "".join(
        f"  - {{name: {name}, type: steered, x: {x}, y: {y}, heading: {h}, r: {r}, actuated: [{driven}]}}\n"
        for name, x, y, h, r, driven in (
            ("a", 0.8, 0.1, -0.43, 0.156, ""),
            ("b", -0.1, 0.7, 2.3, 0.068, "spin"),
        )
    )
    d = of_text(
        f"wmrgen: 1\nname: sample\nwheels:\n{wheels}couplings:\n  - equal: [a.spin, b.spin]\n" + TRAILER
    )
    assert live.robot(d)["trailers"] == [] and "towed" not in live.code(d)
    free = of_text(f"wmrgen: 1\nname: sample\nwheels:\n{wheels}" + TRAILER)
    assert len(live.robot(free)["trailers"]) == 1 and "towed" in live.code(free)


@pytest.mark.parametrize("name", ["nomad_xr4000", "pioneer3dx", "clearpath_do100"])
def test_a_page_drives_the_robot_of_model_json(name: str) -> None:
    model, shown = of_gallery(name).model(), live.robot(of_gallery(name))
    assert shown["omnidirectional"] == model["omnidirectional"]
    absent = {"d": 0.0, "offset_y": 0.0, "gamma": None}
    for drawn, wheel in zip(shown["wheels"], model["wheels"], strict=True):
        drawn = {**drawn, "offset_y": drawn["o"]}
        assert {key: drawn[key] for key in absent.keys() | (wheel.keys() & drawn)} == absent | {
            key: wheel[key] for key in wheel.keys() & drawn
        }
