"""Figures of the gallery and of odd robots: all stands where the layout says, words apart and on the page."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from tests.depth import everyday, examples
from tests.oracle.draw import KINDS, moved
from tests.oracle.draw import robot as drawn_robot
from tests.oracle.harness import robot_text
from tests.report.figures.common import (
    FILES,
    ODD,
    SVG,
    apart,
    numbers,
    of_class,
    page,
    panels,
    parsed,
    robot,
    words,
)  # fmt: skip
from tests.robots import ROBOTS, of_gallery, of_text
from wmrgen import derive, load
from wmrgen.errors import NotDerivableError
from wmrgen.report.figures.instant import singular
from wmrgen.report.figures.motion import motion
from wmrgen.report.figures.reach import reach
from wmrgen.report.figures.symbols import wheel_symbols
from wmrgen.report.figures.top import top_view
from wmrgen.report.figures.wiring import wiring

OKABE_ITO = {"000000", "e69f00", "56b4e9", "009e73", "f0e442", "0072b2", "d55e00", "cc79a7"}


def well_set(figures: Mapping[str, tuple[str, str]]) -> None:
    """No text touches another or leaves its figure; no number is broken."""
    for file, (alt, svg) in figures.items():
        root = ET.fromstring(svg)
        assert "nan" not in svg and "inf" not in re.sub("infinity", "", svg) and alt.endswith(".")
        width, height = (float(v) for v in root.attrib["viewBox"].split()[2:])
        assert width == 480 and height < 1200 and numbers(root, "width") == [420]
        boxes = list(words(root))
        for text, box in boxes:
            assert box[0] >= 0 and box[1] >= 0 and box[2] <= width and box[3] <= height, (file, text)
        for (one, a), (other, b) in combinations(boxes, 2):
            assert apart(a, b), f"{file}: {one!r} touches {other!r}"


@pytest.mark.parametrize("name", ROBOTS)
def test_words_keep_apart_and_on_the_page(name: str) -> None:
    well_set(of_gallery(name).figures)


@pytest.mark.parametrize("name", everyday(ODD, [name for name in ODD if not name.startswith("64 long")]))
def test_odd_robots_have_sane_figures(name: str) -> None:
    d = robot(ODD[name])
    well_set(d.figures)
    groups = [g for g in parsed(d).iter(f"{SVG}g") if "data-wheel" in g.attrib]
    assert len(groups) == len(d.robot.wheels)


@pytest.mark.slow
def test_random_robots_have_sane_figures() -> None:
    """Every wheel type and kind of coupling, millimetres and 10 km, P far away; limits of twists, speeds and angles."""
    limits = (
        "",
        "{vx: 1, vy: 1, omega: 2, spin: 9}",
        "{vx: 1, omega: 2, steer: 0.9}",
        "{spin: [-2, 5], steer_rate: 3}",
    )
    sizes = (("1", "0"), ("0.001", "0"), ("10000", "0"), ("1", "300"))
    drawn = 0
    for seed in range(examples(60)):
        layout = moved(drawn_robot(seed, KINDS[seed % len(KINDS)]), *sizes[seed // 2 % 4])
        chosen = limits[seed % 4]
        text = robot_text(layout) + (f"limits: {chosen}\n" if chosen else "")
        try:
            figures = of_text(text).figures
        except NotDerivableError:
            continue
        well_set(figures)
        drawn += 1
    assert drawn > 0.8 * examples(60)


@pytest.mark.parametrize("name", ROBOTS)
def test_every_wheel_is_named_and_stands_where_the_layout_says(name: str) -> None:
    """At steering angle 0: contact and length of each tyre, in the robot's frame."""
    root, layout = page(name), of_gallery(name).robot
    ((_, scale, (px, py)),) = panels(root)
    groups = {g.attrib["data-wheel"]: g for g in root.iter(f"{SVG}g") if "data-wheel" in g.attrib}
    assert list(groups) == [w.name for w in layout.wheels]
    assert {w.name for w in layout.wheels} <= {e.text for e in of_class(root, "words")}
    for w in layout.wheels:
        g, h = w.nominal, w.heading
        e, n = np.array([np.cos(h), np.sin(h)]), np.array([-np.sin(h), np.cos(h)])
        wanted = np.array([float(g.x), float(g.y)]) + float(g.d) * e + float(g.o) * n
        (shape,) = of_class(groups[w.name], "wheel")
        if shape.tag == f"{SVG}circle":
            x, y, half = numbers(shape, "cx", "cy", "r")
        else:
            left, top, wide, high = numbers(shape, "x", "y", "width", "height")
            x, y, half = left + wide / 2, top + high / 2, high / 2
        assert np.abs(np.array([py - y, px - x]) / scale - wanted).max() < 0.02 / scale + 1e-9
        assert half / scale == pytest.approx(float(g.r), abs=0.01 / scale) or half == 2.5
        contact = [float(v) for v in groups[w.name].attrib["data-contact"].split(",")]
        assert contact == pytest.approx([x, y], abs=0.011)


@pytest.mark.parametrize("name", ROBOTS)
def test_figures_are_few_and_described(name: str) -> None:
    d = of_gallery(name)
    assert set(d.figures) <= set(FILES) and 3 <= len(d.figures) <= 7 and next(iter(d.figures)) == "layout.svg"
    for alt, svg in d.figures.values():
        assert name in alt and ET.fromstring(svg).findtext(f"{SVG}title") == alt
    assert ("motion.svg" in d.figures) == (d.mobility.degree_of_mobility > 0)


DARK = "@media screen and (prefers-color-scheme: dark) {"
_RULE = re.compile(r"^(\.wmrgen [^{]*) {(.*)}$", re.MULTILINE)


def cascade(*styles: str) -> dict[str, dict[str, str]]:
    """The colours of each selector after all styles: selector -> property -> six hexadecimal digits."""
    found: dict[str, dict[str, str]] = {}
    for style in styles:
        for selectors, declarations in _RULE.findall(style):
            colours = dict(re.findall(r"(fill|stroke): #(\w{6})", declarations))
            for selector in selectors.split(", "):
                found.setdefault(selector.removeprefix(".wmrgen ").removeprefix("."), {}).update(colours)
    return found


@pytest.mark.parametrize("name", ROBOTS)
def test_colours_are_those_of_okabe_and_ito_and_greys(name: str) -> None:
    """Lines and letters stand out from the page by 3 to 1 at least, letters by 4.5: on white, and on the dark page."""
    for _, svg in of_gallery(name).figures.values():
        colours = set(re.findall(r"#([0-9a-f]{6})\b", svg))
        greys = {c for c in colours if c[:2] == c[2:4] == c[4:]}
        assert colours - greys <= OKABE_ITO
        light, dark = svg.partition("<style>")[2].partition("</style>")[0].split(DARK)
        for seen in (cascade(light), cascade(light, dark)):
            page = seen["page"]["fill"]
            for selector, drawn in seen.items():
                if "stroke" in drawn and selector not in ("chassis", "halo", "text"):
                    assert contrast(drawn["stroke"], page) >= 3, (selector, drawn)
                if selector.endswith((".head", "dot", "fixed")):
                    assert contrast(drawn["fill"], page) >= 3, (selector, drawn)
            assert all(seen[words]["fill"] != page for words in ("text", "key"))
            assert min(contrast(seen[words]["fill"], page) for words in ("text", "key")) >= 4.5
            # What hides the lines below it has the colour of the page.
            assert {seen[s][p] for s, p in {"text": "stroke", "halo": "stroke", "pivot": "fill"}.items()} == {
                page
            }


def test_dark_pages_are_dark() -> None:
    _, svg = of_gallery("pioneer3dx").figures["layout.svg"]
    light, dark = svg.split(DARK)
    assert contrast(cascade(light)["page"]["fill"], "000000") > 20
    assert contrast(cascade(dark)["page"]["fill"], "ffffff") > 15


def contrast(one: str, other: str) -> float:
    """Of two colours, by WCAG 2."""
    brightness = sorted(luminance(colour) for colour in (one, other))
    return (brightness[1] + 0.05) / (brightness[0] + 0.05)


def luminance(colour: str) -> float:
    parts = (int(colour[k : k + 2], 16) / 255 for k in (0, 2, 4))
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("name", ROBOTS)
def test_numbers_have_two_decimals_and_figures_are_the_same_again(name: str) -> None:
    d = of_gallery(name)
    again = derive(load(ROBOTS[name]))
    for file, (_, svg) in d.figures.items():
        body = re.sub(
            r"<(title|text)\b.*?</\1>|<style>.*?</style>| data-(scale|most)=\"[^\"]*\"",
            "",
            svg,
            flags=re.DOTALL,
        )
        assert not re.search(r"\d\.\d{3}|\de[-+]\d|\D-0(?![.\d])", body), file
        assert again.figures[file][1] == svg


def test_names_are_text_and_no_markup() -> None:
    d = of_gallery("tractor_off_axle")
    bad = '<script>alert("1")</script>&'
    renamed = replace(
        d.robot, name=bad, wheels=tuple(replace(w, name=f"{bad}{w.index}") for w in d.robot.wheels),
        trailers=tuple(replace(t, name=bad) for t in d.robot.trailers),
    )  # fmt: skip
    d = derive(renamed)
    drawn = (top_view(d), wheel_symbols(renamed), motion(d), singular(d), reach(d))
    sheet = wiring(
        derive(replace(of_gallery("pioneer3dx").robot, name=bad))
    )  # it computes: wheels as files have them
    for svg in (f.svg for f in (sheet, *drawn) if f):
        root = ET.fromstring(svg)
        assert not list(root.iter(f"{SVG}script")) and bad in (root.findtext(f"{SVG}title") or "")
    groups = [g.attrib["data-wheel"] for g in root.iter(f"{SVG}g") if "data-wheel" in g.attrib]
    assert groups == [] or groups[0] == f"{bad}0"


def test_rollers_lean_as_they_do_at_the_ground() -> None:
    """youBot, front left: gamma = -45 deg, so the axes run from back left to front right."""
    group = next(g for g in page("kuka_youbot").iter(f"{SVG}g") if g.attrib.get("data-wheel") == "fl")
    lines = of_class(group, "roller")
    assert len(lines) > 3
    for e in lines:
        x1, y1, x2, y2 = numbers(e, "x1", "y1", "x2", "y2")
        assert (x2 - x1) * (y2 - y1) < 0  # on paper y points down
