"""Markdown of reports as HTML: formulas for KaTeX, figures in place, tags of ours and no others."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from html import escape
from itertools import count
from typing import Any

from markdown_it import MarkdownIt
from markdown_it.token import Token

_OURS = re.compile(r"(</?(?:sub|sup|details|summary)>|<br>)")


def html(text: str, figures: Mapping[str, str], ids: set[str] | None = None) -> str:
    """``text`` as HTML; an image that ``figures`` has (name -> SVG) stands in it, any other is its description.

    ``ids``: those that the page has, to which those of the headings are added."""
    markdown = MarkdownIt("commonmark", {"html": True}).enable("table")
    for name, rule in _RULES.items():
        markdown.add_render_rule(name, rule)
    return str(markdown.render(text, {"figures": figures, "ids": set() if ids is None else ids}))


def _tags(_: Any, tokens: Sequence[Token], index: int, *rest: Any) -> str:
    """Of HTML only what reports write; the rest is text."""
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
    """An anchor as GitHub calls it."""
    words = "".join(c for c in tokens[index + 1].content.lower() if c.isalnum() or c in " -_")
    return f'<{tokens[index].tag} id="{free(words.replace(" ", "-"), env["ids"])}">'


def free(name: str, ids: set[str]) -> str:
    """``name``, with a number where it is among ``ids``, to which it is added."""
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
