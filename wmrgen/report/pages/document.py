"""Write a self-contained HTML file: styles, KaTeX with its fonts, figures, and a robot to drive.

Its content security policy allows only the scripts in the file, by their digests. The file loads nothing else.
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from html import escape
from itertools import count
from pathlib import Path
from typing import Any

from markdown_it import MarkdownIt
from markdown_it.token import Token

from wmrgen.codegen.render import render
from wmrgen.robotfile.shipped import shipped

REPORT = "report.md"
_FACE = re.compile(r"@font-face\{[^}]*?url\(fonts/([\w-]+)\.woff2\)[^}]*\}")


@dataclass(frozen=True, slots=True)
class Report:
    """The contents of a page about one robot."""

    name: str
    files: Mapping[str, bytes]  # files of the back ends, by name
    robot: Mapping[str, Any] = field(default_factory=dict)  # the robot of the live figure, as JSON
    code: str = "{}"  # its functions, as a JavaScript expression


def page(reports: Sequence[Report], version: str = "") -> str:
    """Return the page of some robots, with their live figures side by side.

    A page with a ``version`` reloads when the script ``version.js`` next to it has another version.
    """
    ids = {"live"}
    return _document(
        " and ".join(report.name for report in reports),
        [_body(report, ids) for report in reports],
        _live([report for report in reports if report.robot]),
        version,
    )


def _live(reports: Sequence[Report]) -> str:
    """Return the script of the live figures; "" if there are none."""
    if not reports:
        return ""
    code = ", ".join(report.code for report in reports)
    data = json.dumps([report.robot for report in reports]).replace("<", "\\u003c")  # no tag ends the script
    return f"(() => {{\nconst robots = [{code}];\nconst data = {data};\n{_asset('live.js')}}})();"


def broken(text: str, version: str = "") -> str:
    """Return the page of a robot file that has an error. ``text``: the error."""
    return _document("error", [f"<pre class='error'>{escape(text)}</pre>"], "", version)


def _body(report: Report, ids: set[str]) -> str:
    figures = {
        name: content.decode().strip() for name, content in report.files.items() if name.endswith(".svg")
    }
    places = {name: free(f"{report.name}-{name}", ids) for name in chapters(report.files)}
    texts = {name: html(report.files[name].decode(), figures, ids) for name in places}
    for name, place in places.items():  # links between them stay in the page
        texts = {key: text.replace(f'href="{name}"', f'href="#{place}"') for key, text in texts.items()}
    parts = {key: f'<section id="{places[key]}">\n{text}</section>' for key, text in texts.items()}
    return "\n".join(
        part if key == REPORT else f"<details><summary>{key.removesuffix('.md')}</summary>\n{part}</details>"
        for key, part in parts.items()
    )


def chapters(files: Iterable[str]) -> list[str]:
    """Return the Markdown pages among ``files``, the report first."""
    return sorted((name for name in files if name.endswith(".md")), key=lambda name: name != REPORT)


def _document(title: str, bodies: Sequence[str], live: str, version: str) -> str:
    reload = _asset("reload.js").replace("VERSION", json.dumps(version)) if version else ""
    scripts = [script for script in (_katex_script(), live, reload) if script]
    policy = " ".join(f"'sha256-{_digest(script)}'" for script in scripts) + (" file:" if version else "")
    return render(
        "html/page.html.j2",
        title=escape(title),
        policy=policy,
        style=_style(),
        bodies=bodies,
        scripts=scripts,
        driven=bool(live),
    )


def _digest(script: str) -> str:
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()


def _path(name: str) -> Path:
    return shipped("templates") / "html" / name


@cache
def _asset(name: str) -> str:
    return _path(name).read_text(encoding="utf-8")


@cache
def _style() -> str:
    """Return the styles of KaTeX, with its fonts embedded, and our own styles."""

    def face(match: re.Match[str]) -> str:
        font = _path(f"katex/fonts/{match[1]}.woff2")
        if not font.is_file():
            return ""
        data = base64.b64encode(font.read_bytes()).decode()
        source = f'src:url(data:font/woff2;base64,{data}) format("woff2")'
        return re.sub(r"src:[^;}]*", lambda _: source, match[0])

    return _FACE.sub(face, _asset("katex/katex.min.css")) + _asset("style.css")


@cache
def _katex_script() -> str:
    licence = f"/* KaTeX, https://katex.org\n\n{_asset('katex/LICENSE')}*/\n"
    return licence + _asset("katex/katex.min.js").rstrip("\n") + "\n" + _asset("formulas.js")


# ---- Markdown of reports as HTML.

_OURS = re.compile(r"(</?(?:sub|sup|details|summary)>|<br>)")


def html(text: str, figures: Mapping[str, str], ids: set[str] | None = None) -> str:
    """Convert Markdown to HTML.

    Args:
        text: the Markdown. Only HTML tags that reports use are kept; other tags become text.
        figures: SVG by file name. These images are embedded; other images become their descriptions.
        ids: ids that the page has; those of the headings are added.

    Returns:
        The HTML.
    """
    markdown = MarkdownIt("commonmark", {"html": True}).enable("table")
    for name, rule in _RULES.items():
        markdown.add_render_rule(name, rule)
    return str(markdown.render(text, {"figures": figures, "ids": set() if ids is None else ids}))


def tokens(text: str) -> list[Any]:
    """Return the tokens of Markdown, for another format than HTML."""
    return list(MarkdownIt("commonmark", {"html": True}).enable("table").parse(text))


def _tags(_: Any, tokens: Sequence[Token], index: int, *rest: Any) -> str:
    """Keep the HTML tags that reports use; escape all others."""
    parts = _OURS.split(tokens[index].content)
    return "".join(part if _OURS.fullmatch(part) else escape(part) for part in parts)


def _fence(_: Any, tokens: Sequence[Token], index: int, *rest: Any) -> str:
    token = tokens[index]
    if token.info.strip() == "math":
        return f'<div class="math">{escape(token.content)}</div>\n'
    return f"<pre><code>{escape(token.content)}</code></pre>\n"


def _image(_: Any, tokens: Sequence[Token], index: int, options: Any, env: Any) -> str:
    token = tokens[index]
    figure = env["figures"].get(str(token.attrs["src"]))
    return f'<span class="figure">{figure}</span>' if figure else escape(token.content)


def _heading(_: Any, tokens: Sequence[Token], index: int, options: Any, env: Any) -> str:
    """Return a heading with the anchor that GitHub would give it."""
    words = "".join(c for c in tokens[index + 1].content.lower() if c.isalnum() or c in " -_")
    return f'<{tokens[index].tag} id="{free(words.replace(" ", "-"), env["ids"])}">'


def free(name: str, ids: set[str]) -> str:
    """Return ``name``, with a number if it is among ``ids``, and add the result to ``ids``."""
    numbered = (f"{name}-{number}" if number else name for number in count())
    first = next(word for word in numbered if word not in ids)
    ids.add(first)
    return first


_RULES: Mapping[str, Any] = {
    "html_inline": _tags,
    "html_block": _tags,
    "fence": _fence,
    "image": _image,
    "heading_open": _heading,
    "table_open": lambda *_: '<div class="wide"><table>\n',
    "table_close": lambda *_: "</table></div>\n",
}
