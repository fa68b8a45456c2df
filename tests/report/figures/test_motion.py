"""Motions that figures show: they roll, their ICR is on the page, their paths are arcs."""

from __future__ import annotations

import math
import re
from random import Random

import numpy as np
import pytest

from tests.report.figures.common import (
    CASTOR,
    FRONT,
    PAIR,
    SVG,
    THREE,
    many,
    numbers,
    of_class,
    page,
    panels,
    parsed,
    points,
    robot,
    words,
)  # fmt: skip
from tests.robots import ROBOTS, of_gallery
from wmrgen.derivation.facade import Derivation
from wmrgen.report.figures.example import Example, Twist, example, extent, moving
from wmrgen.report.figures.motion import START, drawn

BEHIND = PAIR.replace("x: 0", "x: 0.1") + FRONT.format(0)


def steering(d: Derivation) -> Example:
    shown = example(d.robot, d.mobility)
    assert shown is not None
    return shown


# ---- the motion that is shown


def test_velocities_of_a_dozen_wheels_are_drawn() -> None:
    for count in (12, 13):
        root = parsed(robot(many(count)), "motion.svg")
        assert bool(of_class(root, "velocity")) == (count == 12)


def axle_misses(d: Derivation, shown: Example) -> dict[str, float]:
    """By wheel with a sliding row: how far the ICR lies from the line of its axle [m]."""
    assert shown.icr is not None
    misses = {}
    for w in d.robot.wheels:
        if w.kind.sliding_row:
            h = shown.headings[w.name]
            e = np.array([math.cos(h), math.sin(h)])
            contact = np.array([float(w.nominal.x), float(w.nominal.y)]) + float(w.nominal.d) * e
            misses[w.name] = float((np.array(shown.icr) - contact) @ e)
    return misses


SLANTED = PAIR.replace("x: 0, y: 0.2, heading: 0", "x: -0.2, y: 0.2, heading: pi/4").replace(
    "x: 0, y: -0.2, heading: 0", "x: 0.2, y: -0.2, heading: pi/4"
)
ROLLING = (
    PAIR + FRONT.format(0), BEHIND, PAIR + FRONT.format(2), THREE, THREE + CASTOR.format(0.1),
    PAIR + CASTOR.format(-0.1), SLANTED,
)  # fmt: skip


@pytest.mark.parametrize("wheels", ROLLING)
def test_every_axle_runs_through_the_centre_that_is_shown(wheels: str) -> None:
    """It lies to the left, off the pivots; steered wheels turn by a quarter at most."""
    d = robot(wheels)
    shown = steering(d)
    assert shown.icr is not None
    middle, size = extent(d.robot.wheels)
    assert shown.icr[1] > 0 and math.dist(shown.icr, middle) < 4 * size
    assert max(map(abs, axle_misses(d, shown).values())) < 1e-9
    for w in d.robot.wheels:
        if w.kind.steers:
            assert math.dist(shown.icr, (w.pivot.real, w.pivot.imag)) > 0.35 * size
            assert abs(shown.headings[w.name] - w.heading) <= math.pi / 2 + 1e-9


@pytest.mark.parametrize("d", [0.1, -0.1])
@pytest.mark.parametrize("omega", [1.0, -1.0, 0.0])
def test_a_castor_trails(d: float, omega: float) -> None:
    """Its contact lies behind its pivot, as the pivot moves."""
    base = robot(PAIR + CASTOR.format(d))
    shown = moving(base.robot, (0.5, 0.0, omega))
    h = shown.headings["castor"]
    velocity = np.array([0.5, -0.3 * omega])
    assert d * (velocity @ np.array([math.cos(h), math.sin(h)])) < 0
    if omega:
        assert abs(axle_misses(base, shown)["castor"]) < 1e-12


def test_castors_on_a_belt_stand_at_their_zero() -> None:
    two = CASTOR.format(-0.1) + CASTOR.format(-0.1).replace("castor,", "other,", 1).replace("y: 0", "y: 0.1")
    belt = "couplings: [{equal: [castor.steer, other.steer]}]\n"
    for more in (belt, ""):
        shown = moving(robot(PAIR + two, more).robot, (0.5, 0.0, 1.0))
        assert (shown.headings["castor"] == 0 == shown.headings["other"]) == bool(more)


@pytest.mark.parametrize("steer", ["[-2, 2]", "[1.6, 3.1]", "[-3.1, -1.6]"])
def test_the_opposite_heading_where_only_that_is_within_limits(steer: str) -> None:
    front = FRONT.format(0).replace("r: 0.1}", f"r: 0.1, limits: {{steer: {steer}}}}}")
    low, high = (float(v) for v in steer.strip("[]").split(","))
    assert low <= steering(robot(PAIR + front)).headings["front"] <= high


def test_a_centre_that_the_limits_allow_is_taken() -> None:
    wide = steering(robot(PAIR + FRONT.format(0)))
    limited = PAIR + FRONT.format(0).replace("r: 0.1}", "r: 0.1, limits: {steer: 0.3}}")
    narrow = steering(robot(limited))
    assert abs(wide.headings["front"]) > 0.3 > abs(narrow.headings["front"]) > 0
    assert wide.icr is not None and narrow.icr is not None and narrow.icr[1] > wide.icr[1]


def test_who_translates_only_goes_25_degrees_to_the_left() -> None:
    belts = "couplings: [{equal: [s0.steer, s1.steer, s2.steer]}]\n"
    alike = THREE.replace("heading: 1", "heading: 0").replace("heading: -2", "heading: 0")
    d = robot(alike, belts)
    assert steering(d).icr is None
    assert [math.degrees(h) for h in steering(d).headings.values()] == pytest.approx([25, 25, 25])
    assert "ICR at infinity" in [text for text, _ in words(parsed(d, "motion.svg"))]


# ---- the ICR on the page


def shown_icr(root_text: str) -> tuple[float, float] | None:
    match = re.search(r'data-icr="([^"]*)"', root_text)
    if match is None:
        return None
    x, y = map(float, match[1].split(","))
    return x, y


@pytest.mark.parametrize("name", ROBOTS)
def test_the_icr_of_the_gallery_is_where_the_twist_says(name: str) -> None:
    """Vanishing velocity there: v = (vx - omega y, vy + omega x)."""
    d = of_gallery(name)
    shown = example(d.robot, d.mobility)
    if shown is None or shown.icr is None:
        return
    x, y = shown.icr
    vx, vy, omega = shown.twist
    assert (vx - omega * y, vy + omega * x) == pytest.approx((0, 0), abs=1e-12)
    root = page(name, "motion.svg")
    (_, scale, (px, py)), _ = panels(root)
    at = shown_icr(d.figures["motion.svg"][1])
    if at:
        assert at == pytest.approx((px - scale * y, py - scale * x), abs=0.02)
    assert any(e.text == "ICR" for e in root.iter(f"{SVG}text")) or of_class(root, "way")


def twists(d: Derivation, count: int, chance: Random) -> list[Twist]:
    """Admissible ones with an ICR from one to 10^5 robot sizes away, and some translations."""
    basis = np.asarray(d.mobility.admissible.basis)
    drawn_twists = []
    for k in range(count):
        t = np.array([chance.gauss(0, 1) for _ in basis]) @ basis
        if len(basis) == 3:
            t[2] *= 10 ** chance.uniform(-5, 1) if k % 20 else 0.0
        drawn_twists.append((float(t[0]), float(t[1]), float(t[2])))
    return drawn_twists


@pytest.mark.parametrize("name", ["kuka_youbot", "pioneer3dx", "ackermann_car", "pr2", "office_chair"])
def test_the_icr_never_leaves_the_page(name: str) -> None:
    """200 motions in all: its mark lies in the panel, or an arrow points there and says how far it is."""
    d, chance = of_gallery(name), Random(name)
    for twist in twists(d, 40, chance):
        shown = moving(d.robot, twist)
        figure = drawn(d.robot, shown)
        at = shown_icr(figure.svg)
        if at:
            assert 8 <= at[0] <= 236 and 24 <= at[1] <= 268
            continue
        texts = re.findall(r"<text[^>]*>([^<]*)</text>", figure.svg)
        if shown.icr is None:
            assert "ICR at infinity" in texts
            continue
        (said,) = (t for t in texts if t.startswith("ICR "))
        away = float(said.split()[1].replace("−", "-"))
        vx, vy, omega = twist
        assert away == pytest.approx(math.hypot(vx, vy) / abs(omega), rel=0.006)
        ((x1, y1, x2, y2),) = re.findall(
            r'<line x1="([^"]*)" y1="([^"]*)" x2="([^"]*)" y2="([^"]*)" class="way"', figure.svg
        )
        way = np.array([float(x2) - float(x1), float(y2) - float(y1)])
        towards = np.array([-shown.icr[1], -shown.icr[0]])
        assert way @ towards / np.linalg.norm(way) / np.linalg.norm(towards) > 0.999
        assert 8 <= float(x2) <= 236 and 24 <= float(y2) <= 268


# ---- the world


@pytest.mark.parametrize("name", ROBOTS)
def test_the_path_is_the_arc_of_the_twist(name: str) -> None:
    """Points on paper, taken back to metres, against steps of the differential equation."""
    d = of_gallery(name)
    shown = example(d.robot, d.mobility)
    if shown is None:
        return
    _, (_, scale, (px, py)) = panels(page(name, "motion.svg"))
    paths = [e for e in of_class(page(name, "motion.svg"), "course") if e.tag == f"{SVG}polyline"]
    if not paths:
        return
    on = np.array(points(paths[0]))
    path = np.stack([(on[:, 0] - px) / scale, (py - on[:, 1]) / scale], axis=1)
    vx, vy, omega = shown.twist
    (said,) = (t for t, _ in words(page(name, "motion.svg")) if t.endswith(" s"))
    time = float(said.split()[-2])
    pose, steps = np.array([0.0, 0.0, START]), 4000
    for _ in range(steps):
        middle = pose[2] + omega * time / steps / 2
        c, s = math.cos(middle), math.sin(middle)
        pose += time / steps * np.array([c * vx - s * vy, s * vx + c * vy, omega])
    assert path[0] == pytest.approx([0, 0], abs=0.02 / scale)
    length = math.hypot(vx, vy) * time
    assert path[-1] == pytest.approx(pose[:2], abs=0.006 * length + 0.02 / scale)


@pytest.mark.parametrize("name", ["pioneer3dx", "ackermann_car", "kuka_youbot"])
def test_the_robot_stands_at_both_ends_of_its_path(name: str) -> None:
    """Its frame begins there, along the path that it drives, and its wheels stand in that frame where they do."""
    root = page(name, "motion.svg")
    path = np.array(points(next(e for e in of_class(root, "course") if e.tag == f"{SVG}polyline")))
    _, (_, scale, _) = panels(root)
    groups = list(root.iter(f"{SVG}g"))
    ghost = next(k for k, g in enumerate(groups) if g.get("class") == "ghost")
    for group, end in ((groups[ghost], path[0]), (groups[ghost + 1], path[-1])):
        axes = [e for e in of_class(group, "frame") if e.tag == f"{SVG}line"]
        ways = [np.array(numbers(e, "x2", "y2")) - numbers(e, "x1", "y1") for e in axes]
        x, y = (way / np.linalg.norm(way) for way in ways)
        assert all(numbers(e, "x1", "y1") == pytest.approx(end, abs=0.02) for e in axes)
        assert x[0] * y[1] - x[1] * y[0] == pytest.approx(-1, abs=0.01)  # on paper y points down
        rects = [e for e in of_class(group, "wheel") if e.tag == f"{SVG}rect"]
        for rect, w in zip(rects, of_gallery(name).robot.wheels, strict=True):
            left, top, width, height = numbers(rect, "x", "y", "width", "height")
            if not w.kind.swivels:
                at = end + scale * (w.pivot.real * x + w.pivot.imag * y)
                assert (left + width / 2, top + height / 2) == pytest.approx(at, abs=0.5)


@pytest.mark.parametrize("name", ["pioneer3dx", "ackermann_car"])
def test_the_heading_at_the_start_is_the_angle_between_its_lines(name: str) -> None:
    """θ: an arc about the start of the path, from the direction of the world's x to that of the robot's."""
    root = page(name, "motion.svg")
    path = np.array(points(next(e for e in of_class(root, "course") if e.tag == f"{SVG}polyline")))
    lines = [e for e in of_class(root, "help") if numbers(e, "x1", "y1") == pytest.approx(path[0], abs=0.02)]
    arcs = [re.findall(r"-?[\d.]+", e.attrib["d"]) for e in of_class(root, "angle") if e.tag == f"{SVG}path"]
    ((x1, y1, *_, x2, y2),) = (map(float, arc) for arc in arcs)
    for line, end, angle in zip(lines, ((x1, y1), (x2, y2)), (0.0, START), strict=True):
        way = np.array([math.cos(angle), -math.sin(angle)])
        assert np.array(end) - path[0] == pytest.approx(30 * way, abs=0.05)
        assert np.array(numbers(line, "x2", "y2")) - path[0] == pytest.approx(40 * way, abs=0.05)


# ---- trailers


def test_trailers_are_on_the_steady_circle() -> None:
    """The axle of each trailer points to the ICR, and is its length behind its coupling."""
    d = of_gallery("car_with_trailers")
    root = parsed(d, "motion.svg")
    (train,) = (g for g in root.iter(f"{SVG}g") if "data-train" in g.attrib)
    _, scale, _ = panels(root)[1]
    bars = [numbers(e, "x1", "y1", "x2", "y2") for e in of_class(train, "bar")]
    pairs = list(zip(bars[::2], bars[1::2], strict=True))  # from coupling to axle, and the axle
    assert len(pairs) == len(d.robot.trailers)
    centre = next(numbers(e, "cx", "cy") for e in of_class(root, "icr")[::-1])
    for (_, _, x2, y2), (ax, ay, bx, by) in pairs:
        direction = complex(bx - ax, by - ay)
        to_centre = complex(centre[0] - x2, centre[1] - y2)
        assert abs((to_centre / direction).imag * abs(direction)) < 1.0  # px: the line passes through the ICR
        assert abs(complex((ax + bx) / 2 - x2, (ay + by) / 2 - y2)) < 0.1
    lengths = [math.dist(bar[:2], bar[2:]) / scale for bar in bars[::2]]
    assert lengths == pytest.approx([float(t.length.nominal) for t in d.robot.trailers], rel=0.02)


def test_trailers_without_a_steady_circle_are_not_drawn() -> None:
    """The cart is longer than the radius of the drawn motion: R**2 + hitch**2 - length**2 is negative."""
    d = of_gallery("tractor_off_axle")
    vx, _, omega = steering(d).twist
    (cart,) = d.robot.trailers
    assert (vx / omega) ** 2 + float(cart.hitch.nominal) ** 2 < float(cart.length.nominal) ** 2
    assert "data-train" not in d.figures["motion.svg"][1]
