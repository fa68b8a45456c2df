"""What the top view shows of small robots: a steering that rolls, marks of each wheel, a round scale, a legend."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from tests.report.common import FACTS, derived
from wmrgen.backends import drawing
from wmrgen.backends.drawing import _line, _placed
from wmrgen.backends.drawing.example import Example, example, extent
from wmrgen.robot import Derivation

SVG = "{http://www.w3.org/2000/svg}"
PAIR = """\
  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
"""
FRONT = "  - {{name: front, type: steered, x: 0.5, y: 0, heading: {}, r: 0.1}}\n"
THREE = "".join(
    f"  - {{name: s{k}, type: steered, x: {x}, y: {y}, heading: {h}, r: 0.05}}\n"
    for k, (x, y, h) in enumerate(((0.3, 0.0, 0), (-0.2, 0.25, 1), (-0.2, -0.25, -2)))
)
CASTOR = "  - {{name: castor, type: castor, x: -0.3, y: 0, heading: 0, d: {}, r: 0.05}}\n"


def robot(folder: Path, wheels: str, more: str = "") -> Derivation:
    return derived(folder, f"wmrgen: 1\nname: sample\n{more}wheels:\n{wheels}")


def steering(d: Derivation) -> Example:
    return example(d.robot, d.mobility)


def svg(d: Derivation) -> ET.Element:
    return ET.fromstring(drawing.emit(d, FACTS)["layout.svg"])


def of_class(page: ET.Element, name: str) -> list[ET.Element]:
    return [e for e in page.iter() if name in e.attrib.get("class", "").split()]


BEHIND = PAIR.replace("x: 0", "x: 0.1") + FRONT.format(0)


@pytest.mark.parametrize(
    "wheels", [PAIR + FRONT.format(0), BEHIND, PAIR + FRONT.format(2), THREE, THREE + CASTOR.format(0.1)]
)
def test_every_wheel_rolls_about_the_centre_that_is_shown(wheels: str, tmp_path: Path) -> None:
    """It lies to the left, off the pivots; steered wheels turn by a quarter at most."""
    d = robot(tmp_path, wheels)
    shown = steering(d)
    assert shown.icr is not None
    x, y = shown.icr
    middle, size = extent(d.robot.wheels)
    assert y > 0 and math.dist(shown.icr, middle) < 4 * size
    for w in d.robot.wheels:
        h = shown.headings[w.name]
        if w.kind.constrains:
            away = (x - float(w.nominal.x)) * math.cos(h) + (y - float(w.nominal.y)) * math.sin(h)
            assert away == pytest.approx(0, abs=1e-9)
            assert (
                math.dist(shown.icr, (float(w.nominal.x), float(w.nominal.y))) > 0.35 * size
                or not w.kind.steers
            )
        assert abs(h - w.heading) <= (math.pi / 2 + 1e-9 if w.kind.steers else 0)


@pytest.mark.parametrize("steer", ["[-2, 2]", "[1.6, 3.1]", "[-3.1, -1.6]"])
def test_the_opposite_heading_where_only_that_is_within_limits(steer: str, tmp_path: Path) -> None:
    front = FRONT.format(0).replace("r: 0.1}", f"r: 0.1, limits: {{steer: {steer}}}}}")
    low, high = (float(v) for v in steer.strip("[]").split(","))
    assert low <= steering(robot(tmp_path, PAIR + front)).headings["front"] <= high


def test_a_centre_that_the_limits_allow_is_taken(tmp_path: Path) -> None:
    wide = steering(robot(tmp_path, PAIR + FRONT.format(0)))
    narrow = steering(
        robot(tmp_path, PAIR + FRONT.format(0).replace("r: 0.1}", "r: 0.1, limits: {steer: 0.3}}"))
    )
    assert abs(wide.headings["front"]) > 0.3 > abs(narrow.headings["front"]) > 0
    assert wide.icr is not None and narrow.icr is not None and narrow.icr[1] > wide.icr[1]


def test_who_translates_only_goes_25_degrees_to_the_left(tmp_path: Path) -> None:
    belts = "couplings: [{equal: [s0.steer, s1.steer, s2.steer]}]\n"
    shown = steering(
        robot(tmp_path, THREE.replace("heading: 1", "heading: 0").replace("heading: -2", "heading: 0"), belts)
    )
    assert shown.icr is None
    assert [math.degrees(h) for h in shown.headings.values()] == pytest.approx([25, 25, 25])


def test_two_freedoms_leave_the_centre_open(tmp_path: Path) -> None:
    shown = steering(robot(tmp_path, PAIR + CASTOR.format(0.1)))
    assert shown.icr is None and list(shown.headings.values()) == [0, 0, 0]


def test_marks_of_wheels(tmp_path: Path) -> None:
    """A castor has an arm and the circle that it swivels over; a steered wheel without offset a pivot alone."""
    for wheels, arms, pivots, swivels in (
        (PAIR, 0, 0, 0),
        (PAIR + FRONT.format(0), 0, 1, 0),
        (PAIR + CASTOR.format(0.1), 1, 1, 1),
        (PAIR + FRONT.format(0).replace("r: 0.1", "r: 0.1, offset_y: 0.05"), 1, 1, 0),
        (THREE, 0, 3, 0),
    ):
        page = svg(robot(tmp_path, wheels))
        groups = [g for g in page.iter(f"{SVG}g") if "data-wheel" in g.attrib]
        counts = [sum(len(of_class(g, name)) for g in groups) for name in ("arm", "pivot", "swivel")]
        assert counts == [arms, pivots, swivels], wheels
        assert len(of_class(page, "roll")) // 2 == len(groups) + 1, (
            "an arrow of each wheel, and in the legend"
        )


def test_the_legend_explains_what_occurs_and_nothing_else(tmp_path: Path) -> None:
    words = {
        PAIR: ["fixed wheel", "positive rolling", "zero-motion line"],
        PAIR + FRONT.format(0): [
            "fixed wheel", "steered wheel", "positive rolling", "pivot", "zero-motion line",
            "instantaneous centre of rotation",
        ],
        "  - {name: ball, type: spherical, x: 0.3, y: 0, r: 0.1}\n" + PAIR: [
            "fixed wheel", "spherical wheel", "positive rolling", "zero-motion line",
        ],
    }  # fmt: skip
    for wheels, keys in words.items():
        try:
            page = svg(robot(tmp_path, wheels))
        except Exception as error:
            raise AssertionError(wheels) from error
        shown = [e.text for e in of_class(page, "key")]
        assert sorted(str(t).split(" (")[0] for t in shown) == sorted(keys)
        places = [(float(e.attrib["x"]), float(e.attrib["y"])) for e in of_class(page, "key")]
        width = float(page.attrib["width"])
        assert len(set(places)) == len(places) and all(24 < x < width for x, _ in places)


@pytest.mark.parametrize("size", ["0.001", "0.02", "0.3", "1", "7", "45", "1000"])
def test_the_scale_is_a_round_length(size: str, tmp_path: Path) -> None:
    """1, 2 or 5 times a power of ten, 60 to 150 px long, drawn as long as it says."""
    page = svg(robot(tmp_path, PAIR.replace("0.2", f"0.2*{size}").replace("r: 0.1", f"r: 0.1*{size}")))
    scale = float(page.attrib["data-scale"])
    (name,) = of_class(page, "scale-name")
    length, unit = str(name.text).split()
    assert (
        unit == "m" and f"{float(length):.0e}"[0] in "125" and float(f"{float(length):.0e}") == float(length)
    )
    bar, *ticks = of_class(page, "scale")
    left, right = (float(bar.attrib[k]) for k in ("x1", "x2"))
    assert right - left == pytest.approx(float(length) * scale, abs=0.02) and 60 <= right - left <= 150
    assert len(ticks) == 2


def test_wheels_of_one_axle_share_a_line(tmp_path: Path) -> None:
    d = robot(tmp_path, PAIR + "  - {name: back, type: fixed, x: 0, y: -0.4, heading: pi, r: 0.1}\n")
    lines = [_line(_placed(w, w.heading, 100.0, (300.0, 200.0))) for w in d.robot.wheels]
    assert len(set(lines)) == 1
    oblique = "".join(
        f"  - {{name: {n}, type: fixed, x: 0.1 - {k}*sin({h}), y: 0.3 + {k}*cos({h}), heading: {h}, r: 0.1}}\n"
        for n, k, h in (("a", 1, "pi/6"), ("b", 1, "7*pi/6"), ("c", 2, "-5*pi/6"))
    )
    turned = [
        _line(_placed(w, w.heading, 100.0, (300.0, 200.0))) for w in robot(tmp_path, oblique).robot.wheels
    ]
    assert len(set(turned)) == 1
    assert len([e for e in of_class(svg(d), "axle") if e.tag == f"{SVG}line"]) == 2, "and one in the legend"
    moved = robot(tmp_path, PAIR.replace("x: 0, y: -0.2", "x: 0.1, y: -0.2"))
    assert len([e for e in of_class(svg(moved), "axle") if e.tag == f"{SVG}line"]) == 3
