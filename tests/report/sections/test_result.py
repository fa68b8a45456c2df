"""The result on top of a report: its formulas against contact velocities and least squares of this file."""

from __future__ import annotations

import re
from fractions import Fraction
from math import atan, atan2, cos, sin

import numpy as np
import pytest

from tests.report.sections.common import (
    between,
    box,
    keyed_page_of,
    keyed_page_written,
    keys_of,
    keys_written,
    page_written,
    part,
    sentence,
)
from tests.report.sections.reading import formulas, lengths_in_formulas, read
from tests.robots import ROBOTS, of_gallery, of_text
from wmrgen.geometry import notation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.records import Wheel

AGREE = "forward.if_consistent"
# Robots of which the twist is written out, not only the rule that gives it.
WRITTEN = (
    "agilex_ranger", "andino", "bicycle", "care_o_bot_4", "clearpath_a200", "clearpath_do100", "clearpath_r100",
    "f1tenth", "festo_robotino",
    "jpl_osr", "kuka_youbot", "lekiwi", "locked_bicycle", "mir_100", "neobotix_mp_400", "nexus_4wd", "pioneer3dx",
    "ssl_parsian", "synchro_drive", "textbook_differential", "textbook_omni_steer", "textbook_omnidirectional",
    "textbook_tribolo", "textbook_tricycle", "textbook_two_spheres", "textbook_two_steer", "tractor_off_axle",
    "turtlebot3_burger", "unicycle", "wpilib_swervebot",
)  # fmt: skip


def place(w: Wheel) -> tuple[float, float, float]:
    return float(w.nominal.x), float(w.nominal.y), float(w.nominal.r)


@pytest.mark.slow
def test_whose_twist_is_written_out() -> None:
    shown = {n: part(n, "Forward", "An example") for n in ROBOTS}
    told = {n: AGREE in keys_of(n) for n, text in shown.items() if r"\omega &=" in text}
    assert tuple(n for n, agree in told.items() if not agree) == WRITTEN
    assert tuple(n for n, agree in told.items() if agree) == ("ackermann_car", "car_with_trailers")


@pytest.mark.parametrize("name", WRITTEN)
def test_the_twist_of_measured_rates(name: str) -> None:
    """The least-squares twist (the smallest one where a direction is unseen) of rows written down here."""
    robot = of_gallery(name).robot
    rows, rates, values = [], [], lengths_in_formulas(robot)
    for k, w in enumerate(robot.wheels):
        x, y, r = place(w)
        spin, steer = 0.7 - 0.4 * k, 0.3 + 0.2 * k
        values[notation.port(f"{w.name}.spin")] = spin
        values[notation.port(f"{w.name}.steer")] = steer
        gamma = float(w.gamma) if w.kind.rollers else 0.0
        h = float(w.heading) + (steer if w.kind.steers else 0.0) + gamma
        if w.kind.swivels or not w.kind.directed:
            continue
        if "spin" in w.sensed:
            rows.append([cos(h), sin(h), x * sin(h) - y * cos(h)])
            rates.append(r * spin * cos(gamma))
        if w.kind.sliding_row:
            rows.append([-sin(h), cos(h), x * cos(h) + y * sin(h)])
            rates.append(0.0)
    twist = np.linalg.lstsq(np.array(rows), np.array(rates), rcond=None)[0]
    shown = dict(formulas(part(name, "Forward", "An example")))
    for port, value in zip(("vx", "vy", "omega"), twist, strict=True):
        assert read(shown[notation.port(port)], values) == pytest.approx(value, rel=1e-5, abs=1e-7)


CAR = """wmrgen: 1
name: sample
parameters: {half_track: 0.7, wheelbase: 2.5}
wheels:
  - {name: rl, type: fixed, x: 0, y: half_track, heading: 0, r: 0.3}
  - {name: rr, type: fixed, x: 0, y: -half_track, heading: 0, r: 0.3, sensed: [SENSED]}
  - {name: fl, type: steered, x: wheelbase, y: half_track, heading: 0, r: 0.3, actuated: [steer], sensed: [steer]}
  - {name: fr, type: steered, x: wheelbase, y: -half_track, heading: 0, r: 0.3, actuated: [steer], sensed: [steer]}
"""


@pytest.mark.parametrize(("sensed", "angle"), [("spin", False), ("", True)])
def test_the_twist_of_measurements_that_agree(sensed: str, angle: bool) -> None:
    """A car: of both rear wheels, or of one and of a steering angle, with the other rows left out."""
    text = page_written(CAR.replace("SENSED", sensed)).partition("**Forward")[2].partition("**An ")[0]
    assert AGREE in keys_written(CAR.replace("SENSED", sensed)) and "(HᵀH)⁻¹ Hᵀz" in text
    shown = dict(formulas(text))
    for vx, omega in ((1.3, 0.4), (-0.8, 0.1)):
        values = {notation.parameter("half_track"): 0.7, notation.parameter("wheelbase"): 2.5}
        for name, y in (("l", 0.7), ("r", -0.7)):
            values[notation.port(f"r{name}.spin")] = (vx - y * omega) / 0.3
            values[notation.port(f"f{name}.steer")] = atan(2.5 * omega / (vx - y * omega))
        for port, value in zip(("v_x", "v_y", r"\omega"), (vx, 0.0, omega), strict=True):
            assert read(shown[port], values) == pytest.approx(value, rel=1e-9, abs=1e-12)
    assert (r"\psi" in shown[r"\omega"]) == angle


def test_the_rule_that_numbers_come_from() -> None:
    """Where named lengths make lines too long: the rigid motion nearest to the velocities of contacts."""
    text = part("jpl_osr", "Forward", "An example")
    keyed_page = keyed_page_of("jpl_osr")
    assert keyed_page.index("forward.rigid_rule") < keyed_page.index(r"\omega &=")
    values, points, velocities = {}, [], []
    for k, w in enumerate(of_gallery("jpl_osr").robot.wheels):
        x, y, r = place(w)
        spin, steer = 0.7 - 0.4 * k, 0.3 + 0.2 * k
        values |= {notation.port(f"{w.name}.spin"): spin, notation.port(f"{w.name}.steer"): steer}
        points.append(complex(x, y))
        velocities.append(r * spin * np.exp(1j * steer * w.kind.steers))
    b, v = np.array(points), np.array(velocities)
    omega = ((b - b.mean()).conj() @ (v - v.mean())).imag / (abs(b - b.mean()) ** 2).sum()
    own = v.mean() - 1j * omega * b.mean()
    shown = [read(right, values) for _, right in formulas(text)]
    assert shown == pytest.approx([own.real, own.imag, omega], rel=1e-5)


def test_wheels_that_do_not_steer_come_first() -> None:
    """Of six wheels on three axles the middle ones give the twist by themselves."""
    wheels = [("f", "2.5", "spin, steer"), ("b", "-1", "steer")]
    head, _, fixed = CAR.replace("SENSED", "spin").partition("  - {name: fl")[0].partition("  - ")
    text = head + "".join(
        f"  - {{name: {end}{side}, type: steered, x: {x}, y: {sign}0.7, heading: 0, r: 0.3, sensed: [{sensed}]}}\n"
        for end, x, sensed in wheels
        for side, sign in (("l", ""), ("r", "-"))
    )
    text += f"  - {fixed}"
    shown = dict(formulas(page_written(text).partition("**Forward")[2].partition("**An ")[0]))
    assert shown["v_y"] == "0" and "psi" not in shown["v_x"] + shown[r"\omega"]


@pytest.mark.parametrize("name", ROBOTS)
def test_the_joints_of_a_twist(name: str) -> None:
    """Rates of wheels that do not steer, and pivot velocities of those that do, of an admissible twist."""
    robot = of_gallery(name).robot
    twist = np.array([0.5, 0.2, -0.3])
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    if fixed and not of_gallery(name).mobility.degenerate:
        rows = np.array([[-sin(h), cos(h), place(w)[0] * cos(h) + place(w)[1] * sin(h)]
                         for w in fixed for h in [float(w.heading)]])  # fmt: skip
        twist = twist - np.linalg.pinv(rows) @ rows @ twist
    if robot.couplings and name == "synchro_drive":
        twist[2] = 0.0
    vx, vy, omega = map(float, twist)
    values = lengths_in_formulas(robot) | {"v_x": vx, "v_y": vy, r"\omega": omega}
    values |= {rf"{n}^{{*}}": values[n] for n in ("v_x", "v_y", r"\omega")}
    values |= {notation.port(f"{w.name}.steer"): 0.4 for w in robot.wheels}
    text = part(name, "Inverse", "Forward")
    shown = dict(formulas(text))
    for w in robot.wheels:
        x, y, r = place(w)
        a, b = vx - y * omega, vy + x * omega
        if w.kind.steers or (w.kind.swivels and w.actuated):
            (line,) = [
                line for line in text.split("\n")
                if line.startswith("v_{Ax} &=") and notation.wheel(w.name) in line.partition("&& ")[2]
            ]  # fmt: skip
            one, two = re.findall(r"v_{A[xy]} &= (.*?)(?=, & v| &&)", line)
            assert (read(one, values), read(two, values)) == pytest.approx((a, b), rel=1e-5, abs=1e-9)
        elif w.has_spin and w.actuated:
            gamma = float(w.gamma) if w.kind.rollers else 0.0
            h = float(w.heading) + gamma
            rim = (a * cos(h) + b * sin(h)) / cos(gamma)
            own = shown[notation.port(f"{w.name}.spin")]
            assert read(own, values) == pytest.approx(rim / r, rel=1e-5, abs=1e-9)


AXLE = """wmrgen: 1
name: axle
wheels:
  - {name: rl, type: fixed, x: 0, y: 0.4, heading: 0, r: 0.15}
  - {name: rr, type: fixed, x: 0, y: -0.3, heading: 0, r: 0.12}
  - {name: fl, type: steered, x: 1.1, y: 0.4, heading: 0, r: 0.15, actuated: [steer]}
  - {name: fr, type: steered, x: 1.1, y: -0.4, heading: 0, r: 0.15, actuated: [steer]}
"""
ALONE, BENT = "closed.steered_wheels", "closed.steered_wheels_without_couplings"


@pytest.mark.parametrize(
    "coupling", ["{equal: [rl.spin, rr.spin]}", "{equal: [rl.spin, rr.spin], ratios: [1, 2]}"]
)
def test_wheels_of_one_motor_have_one_rate(coupling: str) -> None:
    """What the result says of wheels that do not steer is what `inverse` gives, where that forces them to slide."""
    text = f"{AXLE}couplings: [{coupling}]\n"
    twist = {"vx": 0.5, "vy": 0.1, "omega": 0.2}
    driven = of_text(text).evaluate("inverse", {n: Exact(Fraction(str(v))) for n, v in twist.items()})
    shown = dict(formulas(between(box(page_written(text)), "Inverse", "Forward")))
    values = {notation.port(n): v for n, v in twist.items()}
    for name in ("rl", "rr"):
        own = read(shown[notation.port(f"{name}.spin")], values)
        assert own == pytest.approx(float(driven[f"{name}.spin"]), rel=1e-6)


@pytest.mark.parametrize(
    ("more", "bent"),
    [("", False), ("couplings: [{equal: [fl.steer, fr.steer]}]\n", True),
     ("couplings: [{equal: [rl.spin, rr.spin]}]\n", False), ("couplings: [{equal: [fl.spin, fr.spin]}]\n", True),
     ("couplings: [{equal: [rl.spin, fl.spin]}]\n", True)],
)  # fmt: skip
def test_coupled_wheels_do_not_each_stand_along_their_velocity(more: str, bent: bool) -> None:
    said = keys_written(AXLE + more)
    assert (BENT in said) == bent != (ALONE in said)
    alone = sentence(keyed_page_written(AXLE + more), "closed.rates_without_couplings")
    assert ("`rl`" in alone) == ("[rl.spin, fl.spin]" in more)


@pytest.mark.parametrize("turned", [0.0, 2.5])
def test_a_steered_wheel_rolls_at_both_angles(turned: float) -> None:
    """What is printed for steered wheels: tan psi = v_Ay / v_Ax, and the speed along the wheel."""
    text = part("wpilib_swervebot", "Inverse", "Forward")
    assert r"\tan\psi &= \frac{v_{Ay}}{v_{Ax}}, & " in text
    vx, vy, r = -0.3, 0.7, 0.0508
    psi = atan2(vy, vx) + (np.pi if turned else 0.0)
    values = {"v_{Ax}": vx, "v_{Ay}": vy, notation.parameter("radius"): r, r"\psi": psi}
    spin = read(text.partition(r"\dot{\varphi} &= ")[2].partition("\n")[0], values)
    assert (spin * r * cos(psi), spin * r * sin(psi)) == pytest.approx((vx, vy))


COUPLED = """wmrgen: 1
name: coupled
parameters: {half: 0.3}
wheels:
  - {name: fl, type: steered, x: half, y: half, heading: 0, r: half/3}
  - {name: fr, type: steered, x: half, y: -half, heading: 0, r: half/3}
  - {name: bl, type: steered, x: -half, y: half, heading: 0, r: half/3}
  - {name: br, type: steered, x: -half, y: -half, heading: 0, r: half/3}
couplings: [{equal: [fl.steer, fr.steer]}, {equal: [bl.steer, br.steer]}]
"""


def test_roots_and_radii_that_are_one_length() -> None:
    page = page_written(COUPLED)
    assert r"\frac{v_{Ax}\cos\psi + v_{Ay}\sin\psi}{r}" in page
    assert r"\mathrm{slip} = \left|2\sqrt{2}\,\mathit{half}\;\omega\right|" in page


def test_no_letter_of_a_result_has_two_meanings() -> None:
    """A robot whose half-lengths are a and b, whose wheels have the sizes that its file says, or different ones."""
    text = part("textbook_two_steer", "Inverse", "Forward")
    assert r"v_{Ax} &= v_x-b\;\omega, & v_{Ay} &= v_y+a\;\omega && (\mathrm{front})" in text
    assert r"\dot{\varphi} &= \frac{v_{Ax}\cos\psi + v_{Ay}\sin\psi}{0.1}" in text
    wheels = "".join(
        f"  - {{name: w{k}, type: steered, x: {x}, y: 0, heading: 0, r: {r}, offset_y: 0.02}}\n"
        for k, (x, r) in enumerate(((0.3, 0.1), (-0.3, 0.2)))
    )
    page = page_written(f"wmrgen: 1\nname: sample\nwheels:\n{wheels}")
    assert r"\frac{v_{Ax}\cos\psi + v_{Ay}\sin\psi - 0.02\,\omega}{r}" in page


@pytest.mark.parametrize("name", ["nomad_xr4000", "tidybot2"])
def test_the_rates_of_a_driven_castor(name: str) -> None:
    """With them the contact, d along and o across, neither slides nor slips."""
    text = part(name, "Inverse", "Forward")
    shown = re.search(r"\\dot\{\\psi\} &= (.*), & \\dot\{\\varphi\} &= (.*)", text)
    assert shown
    a, b, omega, r, d, o, psi, h = 0.4, -0.3, 0.7, 0.05, -0.04, 0.02, 0.6, 2.1
    if "b_{y}" not in shown[2]:
        o = 0.0
    if "h+" not in shown[2]:
        h = 0.0
    values = {
        "v_{Ax}": a,
        "v_{Ay}": b,
        r"\omega": omega,
        "r": r,
        r"\psi": psi,
        "h": h,
        "b_{x}": d,
        "b_{y}": o,
    }
    values[notation.parameter("trail")] = -d
    rate = read(shown[1], values)
    spin = read(shown[2], values | {r"\dot{\psi}": rate})
    along, left = np.array([cos(h + psi), sin(h + psi)]), np.array([-sin(h + psi), cos(h + psi)])
    arm = d * along + o * left
    contact = np.array([a, b]) + (omega + rate) * np.array([-arm[1], arm[0]])
    assert (contact @ left, contact @ along) == pytest.approx((0.0, r * spin))


@pytest.mark.parametrize("name", ROBOTS)
def test_the_factors_as_numbers(name: str) -> None:
    """radius / (2 half_track) = 195/662, about 0.294562: each side is worth the same."""
    robot = of_gallery(name).robot
    for line in re.findall(
        r"```math\n(\\frac.*? (?:=|\\approx).*)\n```", part(name, "Forward", "An example")
    ):
        for equation in line.split(r", \qquad "):
            sides = [read(side, lengths_in_formulas(robot)) for side in re.split(r" = | \\approx ", equation)]
            assert len(sides) > 1 and sides == pytest.approx([sides[0]] * len(sides), rel=1e-5)


@pytest.mark.parametrize("name", ROBOTS)
def test_compatible_wheel_speeds(name: str) -> None:
    """Speeds of the driven wheels of an admissible twist satisfy every condition that is printed, steered wheels
    standing as they must."""
    text = re.split(r"\0mobility\.compatible\w*\0", keyed_page_of(name))[-1].partition("## 6 ")[0]
    told = any(key.startswith("mobility.compatible") for key in keys_of(name))
    text = text if told else ""
    lines = [right for left, right in formulas(text) if left == "0"]
    assert told == bool(lines)
    d = of_gallery(name)
    robot, values = d.robot, lengths_in_formulas(d.robot)
    if not lines:
        return
    vx, vy, omega = (float(v) for v in d.mobility.admissible.sample)
    for w in robot.wheels:
        x, y, r = place(w)
        gamma = float(w.gamma) if w.kind.rollers else 0.0
        a, b = vx - omega * y, vy + omega * x
        turned = atan2(b, a) - float(w.heading) if w.kind.steers else 0.0
        values[notation.port(f"{w.name}.steer")] = turned
        h = float(w.heading) + gamma + turned
        rim = (a * cos(h) + b * sin(h)) / cos(gamma) - float(w.nominal.o) * omega
        values[notation.port(f"{w.name}.spin")] = rim / r
    for right in lines:
        assert read(right, values) == pytest.approx(0.0, abs=1e-6 * max(map(abs, values.values())))
        for port in (p for p in (notation.port(f"{w.name}.spin") for w in robot.wheels) if p in right):
            assert abs(read(right, values | {port: values[port] + 1.0})) > 1e-3


OFFSET = "{name: a, type: steered, x: 0.2, y: 0, heading: 0, r: 0.1, offset_y: 0.02%s}"
CASTOR = "{name: a, type: castor, x: 0.2, y: 0, heading: 0, r: 0.1, d: 0.02, actuated: [spin, steer]%s}"
SWERVE = "{name: a, type: steered, x: 0.2, y: 0, heading: 0, r: 0.1%s}"


@pytest.mark.parametrize(
    ("weighted", "other", "counts"),
    [
        (OFFSET, OFFSET.replace("a,", "b,").replace("x: 0.2", "x: -0.2"), True),
        (CASTOR, "{name: b, type: swedish, x: -0.2, y: 0, heading: pi/2, r: 0.1}", False),
        (CASTOR, "{name: b, type: fixed, x: -0.2, y: 0, heading: 0, r: 0.1}", True),
        (SWERVE, SWERVE.replace("a,", "b,").replace("x: 0.2", "x: -0.2"), False),
    ],
    ids=["means", "as many rows as unknowns", "least squares", "numbers that have the weights in them"],
)
def test_the_rule_for_the_twist_says_that_wheels_count_by_weights(
    weighted: str, other: str, counts: bool
) -> None:
    for weight in ("", ", weight: 4"):
        wheels = "".join(f"  - {w}\n" for w in (weighted % weight, other.replace("%s", "")))
        told = keys_written(f"wmrgen: 1\nname: robot\nwheels:\n{wheels}")
        assert ("forward.weighted_result" in told) == (counts and bool(weight))
