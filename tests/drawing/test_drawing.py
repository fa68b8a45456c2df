"""The top view: well-formed, byte-stable, everything where the layout says."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from functools import cache
from math import cos, hypot, sin
from pathlib import Path

import pytest

from tests.report.common import FACTS, ROBOTS, derivation, derived
from wmrgen.backends import drawing
from wmrgen.backends.drawing.example import example
from wmrgen.backends.drawing.marks import contact

SVG = "{http://www.w3.org/2000/svg}"


@cache
def root(name: str) -> ET.Element:
    return ET.fromstring(drawing.emit(derivation(name), FACTS)["layout.svg"])


def frame(svg: ET.Element) -> tuple[float, float, float]:
    """Scale [px/m] and the place of P on paper."""
    x, y = (float(v) for v in svg.attrib["data-origin"].split(","))
    return float(svg.attrib["data-scale"]), x, y


def tyre(group: ET.Element) -> tuple[float, float, float]:
    """Centre and length of the wheel's shape on paper."""
    for e in group.iter():
        if e.attrib.get("class", "").startswith("wheel"):
            if e.tag == f"{SVG}circle":
                return float(e.attrib["cx"]), float(e.attrib["cy"]), 2 * float(e.attrib["r"])
            x, y, w, h = (float(e.attrib[k]) for k in ("x", "y", "width", "height"))
            return x + w / 2, y + h / 2, h
    raise AssertionError("no wheel in the group")


@pytest.mark.parametrize("name", ROBOTS)
def test_wheels_stand_where_the_layout_says(name: str) -> None:
    svg, robot = root(name), derivation(name).robot
    scale, px, py = frame(svg)
    shown = example(robot, derivation(name).mobility)
    groups = {g.attrib["data-wheel"]: g for g in svg.iter(f"{SVG}g") if "data-wheel" in g.attrib}
    assert list(groups) == [w.name for w in robot.wheels]
    for w in robot.wheels:
        cx, cy, length = tyre(groups[w.name])
        x, y = contact(w, shown.headings[w.name])
        assert hypot((py - cy) / scale - x, (px - cx) / scale - y) < 0.01
        assert length / scale == pytest.approx(2 * float(w.nominal.r), abs=0.01)
        if not w.nominal.d and not w.nominal.o:
            assert hypot(x - float(w.nominal.x), y - float(w.nominal.y)) < 1e-9


@pytest.mark.parametrize("name", ROBOTS)
def test_names_overlap_nothing(name: str) -> None:
    """Boxes of names against each other, and inside the page."""
    svg = root(name)
    width = float(svg.attrib["width"])
    boxes = []
    for e in svg.iter(f"{SVG}text"):
        if e.attrib["class"] == "name":
            x, y, half = float(e.attrib["x"]), float(e.attrib["y"]), len(e.text or "") * 3.6
            boxes.append((x - half, y - 10, x + half, y + 2))
    assert len(boxes) == len(derivation(name).robot.wheels)
    for i, a in enumerate(boxes):
        assert a[0] > 0 and a[2] < width
        for b in boxes[i + 1 :]:
            assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]


@pytest.mark.parametrize("name", ROBOTS)
def test_axles_meet_in_the_icr(name: str) -> None:
    robot, mobility = derivation(name).robot, derivation(name).mobility
    shown = example(robot, mobility)
    if shown.icr is None:
        return
    for w in robot.wheels:
        if w.type in ("fixed", "steered"):
            h = shown.headings[w.name]
            away = (shown.icr[0] - float(w.nominal.x)) * cos(h) + (shown.icr[1] - float(w.nominal.y)) * sin(h)
            assert abs(away) < 1e-6


@pytest.mark.parametrize(
    "name", ["ackermann_car", "bicycle", "jpl_osr", "pr2", "wpilib_swervebot", "textbook_two_steer"]
)
def test_the_icr_is_drawn_where_it_exists(name: str) -> None:
    assert any(e.text == "ICR" for e in root(name).iter(f"{SVG}text"))


@pytest.mark.parametrize(
    "name", ["pioneer3dx", "kuka_youbot", "synchro_drive", "locked_bicycle", "office_chair"]
)
def test_no_icr_where_none_is_fixed(name: str) -> None:
    assert not any(e.text == "ICR" for e in root(name).iter(f"{SVG}text"))


def test_steering_limits_are_kept() -> None:
    robot = derivation("ackermann_car").robot
    shown = example(robot, derivation("ackermann_car").mobility)
    for w in robot.wheels:
        if "steer" in w.limits:
            assert (
                float(w.limits["steer"].low)
                <= shown.headings[w.name] - w.heading
                <= float(w.limits["steer"].high)
            )


def test_rollers_lean_as_they_do_at_the_ground() -> None:
    """youBot, front left: gamma = -45 deg, so the axes run from back left to front right."""
    svg = root("kuka_youbot")
    group = next(g for g in svg.iter(f"{SVG}g") if g.attrib.get("data-wheel") == "fl")
    lines = [e for e in group.iter(f"{SVG}line") if e.attrib["class"] == "roller"]
    assert len(lines) > 3
    for e in lines:
        dx = float(e.attrib["x2"]) - float(e.attrib["x1"])
        dy = float(e.attrib["y2"]) - float(e.attrib["y1"])
        assert dx * dy < 0  # on paper y points down


def test_sixty_four_wheels(tmp_path: Path) -> None:
    wheels = "".join(
        f"  - {{name: w{k}, type: steered, l: 2, alpha: 2*pi*{k}/64, beta: 0, r: 0.05}}\n" for k in range(64)
    )
    many = derived(tmp_path, f"wmrgen: 1\nname: many\nwheels:\n{wheels}")
    svg = ET.fromstring(drawing.emit(many, FACTS)["layout.svg"])
    assert len([g for g in svg.iter(f"{SVG}g") if "data-wheel" in g.attrib]) == 64
