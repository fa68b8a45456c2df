"""Symbols, singular configurations, reachable twists, against plain geometry in NumPy."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from tests.report.figures.common import (
    MECANUM,
    PAIR,
    SVG,
    mecanum,
    numbers,
    of_class,
    page,
    panels,
    parsed,
    points,
    robot,
)
from tests.robots import ROBOTS, of_gallery, of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.layout.records import Wheel
from wmrgen.report.figures.reach import simplified

# ---- the velocity of a wheel


def test_the_velocity_of_a_pivot_is_the_sum_of_two_arrows() -> None:
    """The drawn sum ends where v, drawn again at A, and the arrow across P A end; n is 90 degrees to the left of e."""
    root = parsed(of_gallery("unicycle"), "contact.svg")
    ends = {}
    for cls in ("velocity", "way", "roll"):
        lines = [e for e in of_class(root, cls) if e.tag == f"{SVG}line"]
        heads = [points(e)[0] for e in of_class(root, cls) if e.tag == f"{SVG}polygon"]
        starts = [numbers(line, "x1", "y1") for line in lines]
        ends[cls] = [complex(*head) - complex(*start) for start, head in zip(starts, heads, strict=True)]
    (v, total), (turned,), (e, n) = ends["velocity"], ends["way"], ends["roll"]
    assert abs(v + turned - total) < 0.1
    assert abs(n / e + 1j) < 0.01  # y is down on paper
    (arm,) = [line for line in of_class(root, "line") if line.tag == f"{SVG}line"]
    x1, y1, x2, y2 = numbers(arm, "x1", "y1", "x2", "y2")
    assert abs((turned / complex(x2 - x1, y2 - y1)).real) < 0.01


# ---- symbols


def symbols(d: Derivation) -> dict[str, ET.Element]:
    root = parsed(d, "symbols.svg")
    return {g.attrib["data-symbols"]: g for g in root.iter(f"{SVG}g") if "data-symbols" in g.attrib}


def way(line: ET.Element) -> float:
    """The direction of a line [rad], from x, which is up on paper, counter-clockwise as seen."""
    x1, y1, x2, y2 = numbers(line, "x1", "y1", "x2", "y2")
    return math.atan2(x1 - x2, y1 - y2)


def same(a: float, b: float) -> bool:
    return abs(math.remainder(a - b, 2 * math.pi)) < 0.01


@pytest.mark.parametrize("name", ROBOTS)
def test_there_is_one_wheel_of_each_type_and_its_angles_are_true(name: str) -> None:
    d = of_gallery(name)
    drawn = symbols(d)
    assert sorted(d.robot.wheel(n).type for n in drawn) == sorted({w.type for w in d.robot.wheels})
    for n, g in drawn.items():
        w = d.robot.wheel(n)
        texts = [e.text or "" for e in g.iter(f"{SVG}text")]
        letters = {t.partition(" ")[0] for t in texts}
        wanted = (
            {"P", "x"} | ({"l", "α"} if w.l else set()) | ({"β", "heading"} if w.kind.directed else set())
        )
        wanted |= ({"ψ"} if w.turns else set()) | ({"γ"} if w.kind.rollers else set())
        wanted |= ({"d"} if w.nominal.d else set()) | ({"o"} if w.nominal.o else set())
        assert wanted <= letters, (n, texts)
        if w.l:
            (arm,) = [e for e in of_class(g, "line") if e.tag == f"{SVG}line"]
            assert same(way(arm), w.alpha)
        if w.kind.directed:
            assert same(way(of_class(g, "axle")[0]), w.alpha + w.beta)
            shaft = next(e for e in of_class(g, "roll") if e.tag == f"{SVG}line")
            assert same(way(shaft), w.heading + (math.radians(28) if w.turns else 0))
        for arc in (e for e in of_class(g, "angle") if e.tag == f"{SVG}path"):
            assert swept(arc) in swept_by(w)


def swept(arc: ET.Element) -> float:
    """The angle of an arc, counter-clockwise as seen, in whole degrees."""
    values = [float(v) for v in re.findall(r"-?[\d.]+", arc.attrib["d"])]
    start, r, large, sweep, end = values[:2], values[2], values[5], values[6], values[7:]
    chord = math.dist(start, end) / 2 / r
    size = 2 * math.asin(min(1.0, chord))
    size = 2 * math.pi - size if large else size
    return round(math.degrees(-size if sweep else size) / 2)


def swept_by(w: Wheel) -> set[float]:
    angles = (w.alpha, w.beta, w.gamma, math.radians(28))
    return {
        round(math.degrees(math.remainder(a, 2 * math.pi)) / 2) + k for a in angles for k in (-1, 0, 1)
    } | {-90, 90}


# ---- singular configurations


def test_of_several_wheels_of_a_type_the_one_that_shows_most_is_drawn() -> None:
    wheel = "{{name: {0}, type: castor, x: 0.2, y: {1}, heading: 0, d: 0.04, r: 0.05{2}}}"
    first, second = wheel.format("plain", 0.1, ""), wheel.format("shifted", -0.1, ", offset_y: 0.02")
    assert set(symbols(of_text(f"wmrgen: 1\nname: sample\nwheels: [{first}, {second}]\n"))) == {"shifted"}


def test_who_has_singular_configurations_to_draw() -> None:
    """Not a car: the ICR gets onto a front pivot only at standstill."""
    assert "singular.svg" not in of_gallery("ackermann_car").figures
    assert "singular.svg" not in of_gallery("pioneer3dx").figures
    assert {t.text for t in of_class(page("bicycle", "singular.svg"), "title")} == {
        "driven wheels stand still"
    }
    two = {t.text for t in of_class(page("wpilib_swervebot", "singular.svg"), "title")}
    assert two == {"ICR on a pivot", "axles on one line"}


def icrs(root: ET.Element) -> list[tuple[np.ndarray, ET.Element]]:
    """Each panel's ICR in the robot frame [m]."""
    found = []
    for g, scale, (px, py) in panels(root):
        x, y = map(float, g.attrib["data-icr"].split(","))
        found.append((np.array([py - y, px - x]) / scale, g))
    return found


@pytest.mark.parametrize("name", ["wpilib_swervebot", "textbook_two_steer", "care_o_bot_4", "pr2"])
def test_the_icr_stands_on_a_pivot_and_on_a_line_through_two(name: str) -> None:
    d = of_gallery(name)
    (first, _), (second, _) = icrs(page(name, "singular.svg"))
    kinds = {s.kind: s for s in reversed(d.mobility.singularities)}
    (on,) = kinds["icr_on_pivot"].wheels
    w = d.robot.wheel(on)
    assert first == pytest.approx([float(w.nominal.x), float(w.nominal.y)], abs=2e-3)
    a, b = (d.robot.wheel(n).pivot for n in kinds["shared_axle"].wheels)
    line = (b - a) / abs(b - a)
    assert (line.conjugate() * (complex(*second) - a)).imag == pytest.approx(0, abs=3e-3)
    assert min(abs(complex(*second) - a), abs(complex(*second) - b)) > 0.1 * abs(a - b)


@pytest.mark.parametrize("middle", [("0", "0"), ("0.1", "-0.04"), ("-0.03", "0.3")])
def test_mecanum_rollers_in_an_x_meet_in_the_icr(middle: tuple[str, str]) -> None:
    """There the robot turns, and no wheel: J1 (vx, vy, omega) = 0."""
    d = robot(mecanum(*middle))
    ((icr, _),) = icrs(parsed(d, "singular.svg"))
    twist = np.array([icr[1], -icr[0], 1.0])
    rows = []
    for w in d.robot.wheels:
        axis = w.heading + w.gamma
        rows.append(
            [math.cos(axis), math.sin(axis), w.pivot.real * math.sin(axis) - w.pivot.imag * math.cos(axis)]
        )
    assert np.abs(np.array(rows) @ twist).max() < 3e-3


# ---- reachable twists


def reached(d: Derivation) -> list[tuple[tuple[str, str], np.ndarray]]:
    """Planes of the figure, and the corners of the set in SI units."""
    found = []
    for g in parsed(d, "reach.svg").iter(f"{SVG}g"):
        if "data-plane" in g.attrib:
            up, left = g.attrib["data-plane"].split(",")
            most = [float(v) for v in g.attrib["data-most"].split(",")]
            x, y = map(float, g.attrib["data-origin"].split(","))
            half = float(g.attrib["data-half"])
            (shape,) = of_class(g, "reach")
            corners = np.array(points(shape))
            values = np.stack(
                [(y - corners[:, 1]) / half * most[0], (x - corners[:, 0]) / half * most[1]], axis=1
            )
            found.append(((up, left), values))
    return found


def inside(corners: np.ndarray, p: np.ndarray) -> bool:
    """Whether a point lies in a polygon: winding by crossings."""
    a, b = corners, np.roll(corners, -1, axis=0)
    crossing = (a[:, 1] > p[1]) != (b[:, 1] > p[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        x = (b[:, 0] - a[:, 0]) * (p[1] - a[:, 1]) / (b[:, 1] - a[:, 1]) + a[:, 0]
    return bool(np.sum(crossing & (p[0] < x)) % 2)


def allowed(d: Derivation, twist: np.ndarray, slack: float) -> bool:
    """By plain geometry: limits of the twist, spin of every commanded wheel, angle of every steered one."""
    limits = {"vy": d.robot.limits.get("vx"), **d.robot.limits}
    for name, value in zip(("vx", "vy", "omega"), twist, strict=True):
        if (limit := limits.get(name)) and not float(limit.low) * slack <= value <= float(limit.high) * slack:
            return False
    for w in d.robot.wheels:
        v = np.array([twist[0] - w.pivot.imag * twist[2], twist[1] + w.pivot.real * twist[2]])
        h, spin, steer = w.heading, d.robot.limit(w, "spin"), d.robot.limit(w, "steer")
        if w.kind.steers and np.linalg.norm(v) > 1e-9:
            h = math.atan2(v[1], v[0])
            turn = [math.remainder(h + k * math.pi - w.heading, 2 * math.pi) for k in (0, 1)]
            if steer and not any(float(steer.low) - 1e-9 <= t <= float(steer.high) + 1e-9 for t in turn):
                return False
        if (spin and w.kind.constrains) or (spin and w.kind.rollers):
            speed = v @ np.array([math.cos(h + w.gamma), math.sin(h + w.gamma)])
            if abs(speed / float(w.nominal.r) / math.cos(w.gamma)) > float(spin.high) * slack:
                return False
    return True


WITH_REACH = ["ackermann_car", "kuka_youbot", "pioneer3dx", "wpilib_swervebot", "f1tenth"]


@pytest.mark.parametrize("name", WITH_REACH)
def test_the_set_is_what_the_limits_allow(name: str) -> None:
    """A grid over each plane: what lies inside the shape by 2 % is allowed, what lies outside by as much is not."""
    d = of_gallery(name)
    for plane, corners in reached(d):
        most = np.abs(corners).max(axis=0)
        both = {True: 0, False: 0}
        for a in np.linspace(-1.17, 1.13, 24):
            for b in np.linspace(-1.13, 1.17, 24):
                p = np.array([a, b]) * most
                deep, far = inside(corners, p * 1.02), not inside(corners, p / 1.02)
                if deep == far:
                    continue
                twist = np.zeros(3)
                for value, component in zip(p, plane, strict=True):
                    twist[("vx", "vy", "omega").index(component)] = value
                if plane == ("vx", "omega") and name == "f1tenth":
                    twist[1] = 0.17145 * twist[2]  # its axle stands 0.17145 m behind P
                assert allowed(d, twist, 1.0) == deep, (plane, p)
                both[deep] += 1
        assert min(both.values()) > 50


def test_an_outline_keeps_its_corners_alone() -> None:
    """Wherever it begins and whichever way it goes: not what stands twice, by and large, or on a line between two."""
    corners = [(10.0, 10.0), (90.0, 20.0), (80.0, 70.0), (20.0, 90.0)]
    outline = []
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        between = [(a[0] + k * (b[0] - a[0]) / 5, a[1] + k * (b[1] - a[1]) / 5) for k in range(5)]
        outline += [point for at in between for point in (at, (at[0] + 0.01, at[1]), at)]
    for k in range(0, len(outline), 3):
        for way in (1, -1):
            kept = [(round(x), round(y)) for x, y in simplified((outline[k:] + outline[:k])[::way])]
            assert sorted(kept) == sorted(corners), k


def test_no_figure_where_the_set_is_a_box_or_open() -> None:
    for limits, drawn in (
        ("", False), ("{vx: 1, omega: 2}", False), ("{vx: 1}", False), ("{spin: 9}", True),
        ("{vx: 1, omega: 2, spin: 9}", True), ("{vx: 1, omega: 2, spin: 900}", False),
    ):  # fmt: skip
        d = robot(PAIR, f"limits: {limits}\n" if limits else "")
        assert ("reach.svg" in d.figures) == drawn, limits


def test_two_wheels_and_a_limit_of_spin_make_a_diamond() -> None:
    """|vx -+ 0.2 omega| <= 0.9: corners at 0.9 m/s and 4.5 rad/s."""
    ((plane, corners),) = reached(robot(PAIR, "limits: {spin: 9}\n"))
    assert plane == ("vx", "omega") and len(corners) == 4
    wanted = [(0.9, 0), (0, 4.5), (-0.9, 0), (0, -4.5)]
    assert all(np.abs(corners - w).max(axis=1).min() < 0.01 for w in wanted)


def test_a_limit_of_vx_holds_for_vy_too() -> None:
    """|vx| + |vy| <= 0.6 of the wheels, cut at 0.4 both ways, as limit_twist does."""
    wheels = MECANUM.replace("-pi/4", "PI/4").replace("gamma: pi/4", "gamma: -pi/4").replace("PI/4", "pi/4")
    planes = dict(reached(robot(wheels, "limits: {vx: 0.4, spin: 12}\n")))
    corners = planes["vx", "vy"]
    wanted = [(a * x, b * y) for x, y in ((0.4, 0.2), (0.2, 0.4)) for a in (1, -1) for b in (1, -1)]
    assert len(corners) == 8 and all(np.abs(corners - w).max(axis=1).min() < 0.01 for w in wanted)


# ---- robots that skid

SKID = """effective_track: 0.8
limits: {spin: 9}
"""
FOUR = "".join(
    f"  - {{name: w{k}, type: fixed, x: {x}, y: {y}, heading: 0, r: 0.1}}\n"
    for k, (x, y) in enumerate(((0.3, 0.25), (0.3, -0.25), (-0.1, 0.25), (-0.1, -0.25)))
)


def test_a_robot_that_skids_turns_in_its_figures() -> None:
    """About a point on the line through the middle of its wheels, past which all its axles lead; the twists within its
    limits are those of the drive that turns as it does, |vx -+ 0.4 omega| <= 0.9."""
    d = robot(FOUR, SKID)
    figure = parsed(d, "motion.svg")
    first = next(panel for panel in panels(figure) if "data-icr" in panel[0].attrib)
    x, y = map(float, first[0].attrib["data-icr"].split(","))
    ahead, aside = (first[2][1] - y) / first[1], (first[2][0] - x) / first[1]
    assert ahead == pytest.approx(0.1, abs=0.01) and abs(aside) > 0.1
    axles = [numbers(e, "x1", "y1", "x2", "y2") for e in of_class(figure, "axle")]
    assert len(axles) == 2 and all(y1 == y2 and abs(y1 - y) > 10 for _, y1, _, y2 in axles)
    assert "wheels slide" in "".join(e.text or "" for e in figure.iter(f"{SVG}text"))
    ((plane, corners),) = reached(d)
    assert plane == ("vx", "omega")
    for wanted in ((0.9, 0), (0, 2.25), (-0.9, 0), (0, -2.25)):
        assert np.abs(corners - wanted).max(axis=1).min() < 0.01
