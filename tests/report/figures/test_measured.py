"""Words in a browser: measured there, none touches another or leaves its figure, and the estimate is no less."""

from __future__ import annotations

from html import escape
from pathlib import Path

import pytest

from tests.report.figures.common import ODD, robot
from tests.report.pages.chromium import seen
from tests.robots import ROBOTS, of_gallery
from wmrgen.report.figures.paper import LETTER, SIZE, width

pytestmark = pytest.mark.slow
MEASURE = """
const result = {};
for (const place of document.querySelectorAll("[data-figure]")) {
  const page = place.querySelector("svg").getBoundingClientRect();
  result[place.dataset.figure] = [...place.querySelectorAll("text")].map((text) => {
    const box = text.getBoundingClientRect();
    const pixel = page.width / place.querySelector("svg").viewBox.baseVal.width;
    const sides = [box.left - page.left, box.top - page.top, box.right - page.left, box.bottom - page.top];
    return [text.textContent, text.getAttribute("class"), ...[...sides, page.width, page.height].map((v) => v / pixel)];
  });
}
return result;
"""
POLICY = (
    "<meta http-equiv='Content-Security-Policy' content=\"default-src 'none'; style-src 'unsafe-inline'\">"
)
Text = tuple[str, str, float, float, float, float, float, float]


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Text]]:
    """Every text of every figure in headless Chromium: itself, its class, its box, size of the page."""
    folder: Path = tmp_path_factory.mktemp("figures")
    figures = {
        f"{name} {file}": svg for name in ROBOTS for file, (_, svg) in of_gallery(name).figures.items()
    }
    for name in ODD:
        drawn = robot(ODD[name]).figures
        figures |= {f"{name} {file}": svg for file, (_, svg) in drawn.items()}
    blocks = "".join(f'<div data-figure="{escape(key)}">{svg}</div>' for key, svg in figures.items())
    page = f"<!doctype html><meta charset=utf-8>{POLICY}<body>{blocks}</body>"
    texts, console = seen(page, MEASURE, folder)
    assert not console
    found: dict[str, list[Text]] = {key: [tuple(t) for t in boxes] for key, boxes in texts.items()}
    assert found.keys() == figures.keys() and len(figures) > 130
    return found


def test_no_word_touches_another_or_leaves_its_figure(measured: dict[str, list[Text]]) -> None:
    """A line of words is as high as its letters: the box of a browser has room for accents and deep letters, too."""
    wrong = []
    for figure, texts in measured.items():
        boxes = [(t[2], t[3] + 3, t[4], t[5] - 3) for t in texts]
        for (left, top, right, bottom), t in zip(boxes, texts, strict=True):
            if left < 0 or top < 0 or right > t[6] or bottom > t[7]:
                wrong.append(f"{figure}: {t[0]!r} leaves it")
        for i, a in enumerate(boxes):
            for k in range(i):
                b = boxes[k]
                if a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]:
                    wrong.append(f"{figure}: {texts[i][0]!r} touches {texts[k][0]!r}")
    assert wrong == []


def test_words_are_no_wider_than_they_are_taken_for(measured: dict[str, list[Text]]) -> None:
    wrong = set()
    for texts in measured.values():
        for text, classes, left, _, right, *_ in texts:
            size = LETTER if "letter" in classes else SIZE
            if right - left > width(text, size) * (1.1 if "title" in classes else 1.0) + 0.5:
                wrong.add((text, round(right - left, 1), round(width(text, size), 1)))
    assert not wrong
