"""A figure: its file, what is seen on it, and the SVG text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import NamedTuple

from wmrgen.backends.drawing.paper import num, pair
from wmrgen.backends.drawing.view import View
from wmrgen.render import render
from wmrgen.wheels import WHEEL_TYPES

WIDTH, SHOWN = 480.0, 420.0  # of every figure, and how wide it is shown: two side by side, words 10.5 px high
Group = tuple[str, Sequence[str]]  # attributes and elements


class Figure(NamedTuple):
    """``alt``: a sentence that says what is seen."""

    file: str
    alt: str
    svg: str


def figure(file: str, alt: str, height: float, groups: Iterable[Group]) -> Figure:
    """The figure of finished elements."""
    svg = render(
        "drawing/figure.svg.j2", width=num(WIDTH), height=num(height), title=escape(alt),
        shown_width=num(SHOWN), shown_height=num(height * SHOWN / WIDTH), groups=list(groups),
        fills=[(name, kind.glyph.fill) for name, kind in WHEEL_TYPES.items()],
    )  # fmt: skip
    return Figure(file, alt, svg)


def panel(view: View) -> str:
    """Attributes of a group that say where it shows the plane: ``data-scale`` [px/m], ``data-origin`` [px]."""
    return f' data-scale="{view.scale:.6g}" data-origin="{pair(view.origin)}"'


def attribute(name: str, value: str) -> str:
    """An attribute, its value as text."""
    return f' data-{name}="{escape(value)}"'
