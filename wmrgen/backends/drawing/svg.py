"""SVG elements as finished lines. Coordinates have two decimals, whatever the locale."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from wmrgen.backends.drawing.view import Point, along, unit


def num(value: float) -> str:
    """At most two decimals, no negative zero: ``12.5``, ``-3``."""
    text = f"{round(value, 2) + 0.0:.2f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def pair(p: Point) -> str:
    """``x,y``"""
    return f"{num(p[0])},{num(p[1])}"


def line(a: Point, b: Point, cls: str) -> str:
    return f'<line x1="{num(a[0])}" y1="{num(a[1])}" x2="{num(b[0])}" y2="{num(b[1])}" class="{cls}"/>'


def circle(c: Point, r: float, cls: str) -> str:
    return f'<circle cx="{num(c[0])}" cy="{num(c[1])}" r="{num(r)}" class="{cls}"/>'


def polygon(points: Iterable[Point], cls: str) -> str:
    return f'<polygon points="{" ".join(pair(p) for p in points)}" class="{cls}"/>'


def bar(centre: Point, half: Point, radius: float, degrees: float, cls: str) -> str:
    """A rounded rectangle, turned clockwise by ``degrees`` on paper."""
    rotate = f' transform="rotate({num(degrees)} {num(centre[0])} {num(centre[1])})"'
    turn = rotate if num(degrees) != "0" else ""
    return (
        f'<rect x="{num(centre[0] - half[0])}" y="{num(centre[1] - half[1])}" width="{num(2 * half[0])}" '
        f'height="{num(2 * half[1])}" rx="{num(radius)}" class="{cls}"{turn}/>'
    )


def text(p: Point, words: str, cls: str) -> str:
    return f'<text x="{num(p[0])}" y="{num(p[1])}" class="{cls}">{escape(words)}</text>'


def arrow(a: Point, b: Point, cls: str, head: float = 5.0) -> list[str]:
    """A shaft from a towards b with a filled head that ends in b."""
    ux, uy = unit(a, b)
    root = along(b, (ux, uy), -1.5 * head)
    tip = (b, along(root, (-uy, ux), 0.62 * head), along(root, (uy, -ux), 0.62 * head))
    return [line(a, root, cls), polygon(tip, f"{cls} head")]
