"""The check sheet: signs against contact velocities, faults against least squares, arrows against signs."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from math import atan2, cos, degrees, pi, remainder, sin

import numpy as np
import pytest

from tests.report.sections.common import FACTS, keys_of_wiring, pages_of, sentence
from tests.robots import ROBOTS, of_gallery, of_text
from wmrgen.geometry.layout.records import Wheel
from wmrgen.report.sections.markdown import keys
from wmrgen.report.sections.wiring import wiring
from wmrgen.report.wiring import motions

HEAD = re.compile(r"(?m)^\| joint \|(.*)\|\n.*\n((?:\|.*\n)*)")
SIGNS = {"+": 1, "−": -1, "0": 0}


def sheet(name: str) -> dict[str, list[str]]:
    """The cells of every joint."""
    found = HEAD.search(pages_of(name)["wiring.md"])
    rows = [line.strip("| ").split(" | ") for line in found[2].splitlines()] if found else []
    return {row[0].strip("`"): row[1:] for row in rows}


def rim(w: Wheel, twist: tuple[float, float, float], steer: float) -> tuple[float, float, float]:
    """Rolling speed along the wheel, and the velocity of the pivot."""
    vx, vy, omega = twist
    a, b = vx - float(w.nominal.y) * omega, vy + float(w.nominal.x) * omega
    gamma = float(w.gamma) if w.kind.rollers else 0.0
    h = float(w.heading) + steer + gamma
    return (a * cos(h) + b * sin(h)) / cos(gamma), a, b


@pytest.mark.parametrize("name", ROBOTS)
def test_every_sign(name: str) -> None:
    robot, cells = of_gallery(name).robot, sheet(name)
    possible = [m for m in motions(of_gallery(name)) if m.joints]
    assert bool(cells) == any(w.actuated for w in robot.wheels)
    for k, motion in enumerate(possible):
        vx, vy, omega = (float(v) for v in motion.twist.values())
        for w in robot.wheels:
            steer = 0.0
            _, a, b = rim(w, (vx, vy, omega), 0.0)
            if f"{w.name}.steer" in cells and w.kind.steers:
                steer = np.radians(float(cells[f"{w.name}.steer"][k].replace("−", "-").removesuffix("°")))
                off = degrees(remainder(atan2(b, a) - float(w.heading) - steer, pi))
                assert abs(off) < 0.1, (w.name, motion.title)
            if f"{w.name}.spin" in cells and not (w.kind.swivels and w.nominal.o):
                speed = rim(w, (vx, vy, omega), steer)[0] - (
                    float(w.nominal.o) * omega if w.kind.steers else 0.0
                )
                sign = SIGNS[cells[f"{w.name}.spin"][k]]
                assert sign * speed > 1e-6 if sign else abs(speed) < 1e-9, (w.name, motion.title)


def test_what_cannot_be_driven_is_said() -> None:
    def forbidden(name: str) -> list[str]:
        page = "\n\n".join(wiring(of_gallery(name), FACTS))
        return re.findall(r"\+[xyω]", sentence(page, "wiring.forbidden"))

    assert forbidden("pioneer3dx") == ["+y"] and forbidden("kuka_youbot") == []
    car = pages_of("ackermann_car")["wiring.md"]
    assert "a curve to the left" in car and forbidden("ackermann_car") == ["+y"]
    assert "+ω, counter-clockwise" in pages_of("clearpath_a200")["wiring.md"]  # it skids
    for name, turn in (("f1tenth", "+ω, a curve to the left"), ("andino", "+ω, counter-clockwise")):
        text = pages_of(name)["wiring.md"]  # P lies off the axle about whose points they turn
        assert turn in text and forbidden(name) == ["+y"] and " vy=" in text
    assert keys_of_wiring("office_chair") == ["wiring.nothing_driven"]


WORDS = {"forward": (0, 1), "backward": (0, -1), "to the left": (1, 1), "to the right": (1, -1),
         "turns left": (2, 1), "turns right": (2, -1)}  # fmt: skip


@pytest.mark.parametrize("name", ["pioneer3dx", "kuka_youbot", "lekiwi"])
def test_faults(name: str) -> None:
    """What the least-squares twist of wrong wheel speeds is, in words."""
    robot, text = of_gallery(name).robot, pages_of(name)["wiring.md"]
    wheels = [w for w in robot.wheels if w.actuated]
    rows = []
    for w in wheels:
        h = float(w.heading) + (float(w.gamma) if w.kind.rollers else 0.0)
        x, y = float(w.nominal.x), float(w.nominal.y)
        rows.append(
            np.array([cos(h), sin(h), x * sin(h) - y * cos(h)])
            / (cos(float(w.gamma)) if w.kind.rollers else 1.0)
        )
    rows = np.array(rows) if wheels[0].kind.rollers else np.array([*rows, [0.0, 1.0, 0.0]])
    size = max(abs(w.pivot) for w in wheels)
    seen = re.findall(r"(?m)^\| (`.*?(?:backwards|exchanged)) \| (.*) \|$", text)
    assert len(seen) == len(wheels) + len(wheels) * (len(wheels) - 1) // 2
    possible = [np.array([float(v) for v in m.twist.values()]) for m in motions(of_gallery(name)) if m.joints]
    for fault, cells in seen:
        own = [next(k for k, w in enumerate(wheels) if w.name == n) for n in re.findall("`(.*?)`", fault)]
        for twist, cell in zip(possible, cells.split(" | "), strict=True):
            speeds = rows @ twist
            if len(own) == 1:
                speeds[own[0]] *= -1
            else:
                speeds[own] = speeds[own[::-1]]
            moved = np.linalg.lstsq(rows, speeds, rcond=None)[0] * np.array([1.0, 1.0, size])
            largest = np.abs(moved).max()
            if largest < 1e-9:
                assert cell == "stands still"
                continue
            expected = {word for word, (i, sign) in WORDS.items() if sign * moved[i] > 0.2 * largest}
            assert {word for word in WORDS if word in cell} == expected, (fault, twist)


@pytest.mark.parametrize("name", ["pioneer3dx", "kuka_youbot", "wpilib_swervebot"])
def test_arrows(name: str) -> None:
    """As many as there are signs in the table."""
    root = ET.fromstring(of_gallery(name).figures["wiring.svg"][1])
    arrows = [e for e in root.iter() if e.get("class") == "velocity" and e.tag.endswith("line")]
    signs = [c for n, row in sheet(name).items() if n.endswith(".spin") for c in row if c in "+−"]
    assert len(arrows) == len(signs) > 3


def test_large_wheels_do_not_hide_their_arrows() -> None:
    """Heads stand beyond the tyres of two wheels whose radius is more than a quarter of the robot's size."""
    root = ET.fromstring(of_gallery("pioneer3dx").figures["wiring.svg"][1])
    shapes = [(e.attrib.get("class", ""), e) for e in root.iter()]
    tyres = [e for kind, e in shapes if kind == "wheel fixed"]
    heads = [e.attrib["points"].split() for kind, e in shapes if kind == "velocity head"]
    assert len(tyres) == len(heads) == 4
    top, high = float(tyres[0].attrib["y"]), float(tyres[0].attrib["height"])
    assert all(not top - 1 < float(p.split(",")[1]) < top + high + 1 for head in heads for p in head)


@pytest.mark.parametrize("name", ["lekiwi", "pioneer3dx", "f1tenth", "nomad_xr4000"])
def test_angles_are_0_where_there_are_some(name: str) -> None:
    turns = any(w.turns and w.actuated for w in of_gallery(name).robot.wheels)
    assert ("wiring.angles_at_zero" in keys_of_wiring(name)) == turns


PAIR = """wmrgen: 1
name: pair
wheels:
  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1%s}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
encoder: {spin: {counts: 48, reversed: %s}}
"""
UP = ", encoder: {spin: {counts: 48}}"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (PAIR % ("", "false"), ["wiring.counts_up"]),
        (PAIR % ("", "true"), ["wiring.counts_down"]),
        (PAIR % (UP, "true"), ["wiring.some_count_down"]),
        (PAIR % ("", "true") + "couplings: [{equal: [left.spin, right.spin]}]",
         ["wiring.coupled", "wiring.counts_down"]),
        (PAIR % ("", "true") + "couplings: [{equal: [left.spin, right.spin], ratios: [1, -1]}]",
         ["wiring.coupled", "wiring.negative_ratio", "wiring.counts_down"]),
    ],
)  # fmt: skip
def test_encoders_that_count_down_and_wheels_that_turn_together(text: str, told: list[str]) -> None:
    page = "\n\n".join(wiring(of_text(text), FACTS))
    assert [key for key in keys(page) if key != "wiring.forbidden"] == told
    assert ("`right`" in sentence(page, "wiring.some_count_down")) == ("wiring.some_count_down" in told)
    assert ("`left` and `right`" in sentence(page, "wiring.coupled")) == ("wiring.coupled" in told)
