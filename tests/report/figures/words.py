"""Where a browser draws the words of a figure."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

from tests.report.pages.chromium import opened

Box = tuple[float, float, float, float]  # left, top, right and bottom [px]
_TOUCH = 1.0  # px: boxes of letters contain some space, so they may overlap by so much
_SCRIPT = """
const svg = document.querySelector("svg");
const to = svg.getScreenCTM().inverse();
const words = [];
for (const text of svg.querySelectorAll("text")) {
    const box = text.getBoundingClientRect();
    const a = new DOMPoint(box.left, box.top).matrixTransform(to);
    const b = new DOMPoint(box.right, box.bottom).matrixTransform(to);
    words.push([text.textContent, [a.x, a.y, b.x, b.y]]);
}
const size = svg.viewBox.baseVal;
return [words, [size.width, size.height]];"""


def mistakes(svg: str, folder: Path) -> list[str]:
    """Words that are outside of the figure, and pairs of words that overlap."""
    (words, (wide, high)), console = opened(f"<!doctype html><body>{svg}</body>", _SCRIPT, folder)
    assert words and console == []
    found = []
    for text, (left, top, right, bottom) in words:
        if left < 0 or top < -_TOUCH or right > wide or bottom > high + _TOUCH:
            found.append(f"{text} is outside")
    for (first, a), (second, b) in combinations(words, 2):
        if min(a[2], b[2]) - max(a[0], b[0]) > _TOUCH and min(a[3], b[3]) - max(a[1], b[1]) > 3 * _TOUCH:
            found.append(f"{first} overlaps {second}")
    return found
