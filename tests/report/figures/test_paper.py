"""The page of a drawing: plain geometry, elements as text, and names that keep clear of what is drawn."""

from __future__ import annotations

import math
import random

import pytest

from wmrgen.report.figures.paper import (
    FIRM,
    HEIGHT,
    Box,
    Paper,
    Point,
    along,
    arc,
    arrow,
    bar,
    bounds,
    circle,
    clip,
    distance,
    hull,
    line,
    middle,
    num,
    overlap,
    pair,
    polygon,
    text,
    unit,
    width,
    wrapped,
)

CHANCE = random.Random(11)
BOX: Box = (2.0, 3.0, 10.0, 7.0)


def inside(p: Point, box: Box, slack: float = 1e-9) -> bool:
    return box[0] - slack <= p[0] <= box[2] + slack and box[1] - slack <= p[1] <= box[3] + slack


def test_points() -> None:
    assert along((1.0, 2.0), (0.6, -0.8), 5.0) == pytest.approx((4.0, -2.0))
    assert distance((1.0, 2.0), (4.0, -2.0)) == 5.0
    assert unit((1.0, 2.0), (4.0, -2.0)) == pytest.approx((0.6, -0.8))
    assert unit((1.0, 2.0), (1.0, 2.0)) == (0.0, -1.0)
    assert middle(BOX) == (6.0, 5.0)
    assert bounds([(2.0, 7.0), (10.0, 3.0), (4.0, 5.0)]) == BOX
    assert bounds([(2.0, 7.0), (10.0, 3.0)], 1.0) == (1.0, 2.0, 11.0, 8.0)


def test_common_areas() -> None:
    assert overlap(BOX, (4.0, 4.0, 6.0, 20.0)) == 6.0 == overlap((4.0, 4.0, 6.0, 20.0), BOX)
    assert overlap(BOX, BOX) == 32.0
    for other in ((10.0, 3.0, 12.0, 7.0), (0.0, 3.0, 2.0, 7.0), (2.0, 7.0, 10.0, 9.0), (2.0, 0.0, 10.0, 3.0)):
        assert overlap(BOX, other) == 0.0, "they touch"
        assert overlap(other, BOX) == 0.0
    assert overlap(BOX, (9.0, 6.0, 12.0, 9.0)) == 1.0


def test_the_part_of_a_line_in_a_box() -> None:
    """Both ends lie on its border and on the line; a line that misses it has no part."""
    parts = 0
    for _ in range(200):
        p = CHANCE.uniform(-5, 15), CHANCE.uniform(-5, 15)
        angle = CHANCE.uniform(0, 2 * math.pi)
        way = math.cos(angle), math.sin(angle)
        part = clip(p, way, BOX)
        samples = [along(p, way, k / 50) for k in range(-2000, 2000)]
        assert any(inside(q, BOX, -0.05) for q in samples) <= (part is not None)
        if part is None:
            continue
        parts += 1
        for end in part:
            assert inside(end, BOX) and not inside(end, BOX, -1e-9)
            assert (end[0] - p[0]) * way[1] - (end[1] - p[1]) * way[0] == pytest.approx(0, abs=1e-9)
        assert (part[1][0] - part[0][0]) * way[0] + (part[1][1] - part[0][1]) * way[1] > 0
    assert 40 < parts < 160
    assert clip((5.0, 4.0), (1.0, 0.0), BOX) == ((2.0, 4.0), (10.0, 4.0))
    assert clip((5.0, 4.0), (0.0, -1.0), BOX) == ((5.0, 7.0), (5.0, 3.0))
    for p, way in (
        ((5.0, 2.0), (1.0, 0.0)),
        ((5.0, 8.0), (1.0, 0.0)),
        ((1.0, 4.0), (0.0, 1.0)),
        ((11.0, 4.0), (0.0, 1.0)),
    ):
        assert clip(p, way, BOX) is None


def test_the_hull_holds_all_points_and_turns_one_way() -> None:
    for _ in range(20):
        points = [(CHANCE.randint(0, 9) / 2, CHANCE.randint(0, 9) / 2) for _ in range(12)]
        corners = hull(points)
        assert set(corners) <= set(points)
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
            turns = [(b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]) for q in points]
            assert min(turns) >= 0, "every point lies on one side of every edge"
            on = [q for q, t in zip(points, turns, strict=True) if t == 0]
            assert all(q in (a, b) or distance(a, q) < distance(a, b) for q in on)
    assert hull([(1.0, 1.0)] * 3) == [(1.0, 1.0)]
    assert hull([(1.0, 1.0), (0.0, 0.0)]) == [(0.0, 0.0), (1.0, 1.0)]
    assert len(hull([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)])) == 2


def test_elements() -> None:
    assert [num(v) for v in (12.5, -3.0, -0.001, 0.0, 1.005, 2.344, 2.346, 100.0)] == [
        "12.5", "-3", "0", "0", "1", "2.34", "2.35", "100",
    ]  # fmt: skip
    assert pair((1.25, -2.0)) == "1.25,-2"
    assert line((1.0, 2.0), (3.5, 4.0), "axle") == '<line x1="1" y1="2" x2="3.5" y2="4" class="axle"/>'
    assert circle((1.0, 2.0), 3.0, "dot") == '<circle cx="1" cy="2" r="3" class="dot"/>'
    assert polygon([(0.0, 0.0), (1.0, 2.0)], "x") == '<polygon points="0,0 1,2" class="x"/>'
    assert text((1.0, 2.0), "a<b", "name") == '<text x="1" y="2" class="name">a&lt;b</text>'
    box = '<rect x="-1" y="-1" width="4" height="6" rx="0.5" class="wheel"'
    assert bar((1.0, 2.0), (2.0, 3.0), 0.5, 0.0, "wheel") == f"{box}/>"
    assert bar((1.0, 2.0), (2.0, 3.0), 0.5, 30.0, "wheel") == f'{box} transform="rotate(30 1 2)"/>'
    shaft, head = arrow((0.0, 0.0), (0.0, 20.0), "roll", 4.0)
    assert shaft == line((0.0, 0.0), (0.0, 14.0), "roll")
    assert head == polygon([(0.0, 20.0), (-2.48, 14.0), (2.48, 14.0)], "roll head")


def placed(paper: Paper, words: str, target: Box, away: Point) -> Box | None:
    """The box of a name on a page; None where it is left out."""
    before = len(paper.boxes)
    elements = paper.put(words, target, away)
    assert bool(elements) == (len(paper.boxes) > before)
    return paper.boxes[-1] if elements else None


def test_names_keep_clear_of_each_other() -> None:
    paper = Paper((0.0, 0.0, 400.0, 300.0))
    target = (190.0, 140.0, 210.0, 160.0)
    paper.boxes.append(target)
    names = [placed(paper, f"wheel_{k}", target, (0.0, 0.0)) for k in range(12)]
    for k, box in enumerate(names):
        assert box is not None and inside(box[:2], paper.area) and inside(box[2:], paper.area)
        assert box[2] - box[0] == pytest.approx(width(f"wheel_{k}") + 2) and box[3] - box[1] == HEIGHT
        assert overlap(box, target) == 0 and all(overlap(box, other) == 0 for other in names[:k] if other)


@pytest.mark.parametrize("away", [(0.0, 150.0), (400.0, 150.0), (200.0, 0.0), (200.0, 300.0)])
def test_a_name_stands_on_the_far_side(away: Point) -> None:
    """At the least gap, where the page is free; to the right where the target is the middle itself."""
    paper, target = Paper((0.0, 0.0, 400.0, 300.0)), (190.0, 140.0, 210.0, 160.0)
    box = placed(paper, "left", target, away)
    assert box is not None
    outward = unit(away, middle(target))
    way = unit(middle(target), middle(box))
    assert way == pytest.approx(outward, abs=1e-9)
    gap = (target[0] - box[2], box[0] - target[2], target[1] - box[3], box[1] - target[3])
    assert max(gap) == pytest.approx(4.0)
    own = placed(Paper(paper.area), "left", target, middle(target))
    assert own is not None and own[0] == pytest.approx(214.0)


def test_a_name_far_off_has_a_line_to_its_wheel() -> None:
    paper, target = Paper((0.0, 0.0, 400.0, 300.0)), (190.0, 140.0, 210.0, 160.0)
    paper.boxes.append((150.0, 115.0, 250.0, 185.0))
    elements = paper.put("left", target, (0.0, 150.0))
    assert [e[:5] for e in elements] == ["<line", "<text"] and 'class="leader"' in elements[0]
    ((a, b),) = paper.segments
    box = paper.boxes[-1]
    assert inside(a, box) and not inside(a, box, -1e-6) and inside(b, target) and not inside(b, target, -1e-6)


def test_names_stay_on_the_page_and_off_lines() -> None:
    page = (0.0, 0.0, 400.0, 300.0)
    corner = (0.0, 0.0, 20.0, 20.0)
    box = placed(Paper(page), "front_left_wheel", corner, (200.0, 150.0))
    assert box is not None and inside(box[:2], page) and inside(box[2:], page)
    target = (190.0, 140.0, 210.0, 160.0)
    crossed = Paper(page, segments=[((212.0, 100.0), (260.0, 200.0)), ((260.0, 100.0), (212.0, 200.0))])
    free = placed(Paper(page), "left", target, (0.0, 150.0))
    moved = placed(crossed, "left", target, (0.0, 150.0))
    assert free != moved


def test_a_name_without_a_place_is_left_out() -> None:
    full = (0.0, 0.0, 60.0, 60.0)
    target = (28.0, 28.0, 32.0, 32.0)
    assert placed(Paper(full, boxes=[full]), "wheel", target, (0.0, 0.0)) is None
    assert placed(Paper(full), "a_name_as_wide_as_the_page", target, (0.0, 0.0)) is None
    assert placed(Paper(full), "wheel", target, (0.0, 0.0)) is not None


def test_lines_of_words() -> None:
    lines = wrapped("one two three four", width("one two") + 1)
    assert lines == ["one two", "three", "four"]
    assert wrapped("a_long_word of", 10.0) == ["a_long_word", "of"]
    assert wrapped(f"vx{FIRM}1 m", width("vx")) == ["vx 1", "m"]


@pytest.mark.parametrize(("turn", "flags"), [(1.0, "0 0"), (-1.0, "0 1"), (4.0, "1 0"), (-4.0, "1 1")])
def test_an_arc_goes_the_way_that_is_said(turn: float, flags: str) -> None:
    """Counter-clockwise as seen: y points down on paper."""
    end = math.cos(turn), -math.sin(turn)
    shape = arc((0.0, 0.0), (1.0, 0.0), end, turn, "angle")
    assert shape == f'<path d="M1,0 A1,1 0 {flags} {pair(end)}" class="angle"/>'
