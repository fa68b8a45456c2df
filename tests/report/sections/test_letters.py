"""Forward kinematics in the named parameters: the least-squares twist of rows written down here."""

from __future__ import annotations

import re
from math import atan2, cos, pi, sin

import numpy as np
import pytest

from tests.report.sections.common import (
    between,
    keyed_page_of,
    keys_of_numerics,
    numerics_of,
    page_of,
    page_written,
    sentence,
)
from tests.report.sections.reading import formulas, lengths_in_formulas, read
from tests.robots import ROBOTS, of_gallery, of_text
from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.inputs import posture_motion
from wmrgen.geometry import notation
from wmrgen.report.sections.forward import closed_forward
from wmrgen.report.sections.inverse import closed_inverse
from wmrgen.report.sections.markdown import keys
from wmrgen.report.sections.motion import motion


def test_the_yaw_rate_of_a_mecanum_base() -> None:
    page = page_of("clearpath_do100")
    factor = r"\frac{\mathit{radius}}{4\,\left(\mathit{half\_track}+\mathit{half\_wheelbase}\right)}"
    assert rf"\omega &= {factor}" in page
    assert rf"{factor} = \frac{{125}}{{4954}} \approx 0.0252321" in page
    assert r"\det(H^T H) = 8\,{\left(\mathit{half\_track}+\mathit{half\_wheelbase}\right)}^{2}" in page


@pytest.mark.parametrize(
    ("r", "kind", "spin"),
    [
        ("0.0331", "fixed", r"\frac{v_x-0.2\;\omega}{0.0331}"),
        ("0.125", "fixed", r"\frac{v_x-0.2\;\omega}{0.125}"),
        ("0.12", "swedish, gamma: 45 deg", r"\frac{v_x+v_y-0.2\;\omega}{0.12}"),
    ],
)
def test_a_radius_that_is_a_number_divides(r: str, kind: str, spin: str) -> None:
    """Above the line stands what the layout table has, also of wheels with rollers."""
    wheels = (
        f"{{name: {n}, type: {kind}, x: 0, y: {y}, heading: 0, r: {r}}}" for n, y in (("a", 0.2), ("b", -0.2))
    )
    lines = closed_inverse(of_text(f"wmrgen: 1\nname: two\nwheels: [{', '.join(wheels)}]\n"))
    assert f"&= {spin} " in "\n".join(lines)


def speeds(name: str) -> str:
    return keyed_page_of(name).partition("\0motion.in_wheel_speeds\0")[2].partition(r"\end{aligned")[0]


# Robots whose driven wheels command every freedom, in a formula that is short.
DRIVEN = (
    "ackermann_car", "andino", "bicycle", "clearpath_a200", "clearpath_do100", "clearpath_r100", "f1tenth",
    "festo_robotino", "jpl_osr", "kuka_youbot", "lekiwi", "locked_bicycle", "mir_100", "neobotix_mp_400", "nexus_4wd",
    "pioneer3dx", "ssl_parsian", "synchro_drive", "textbook_differential", "textbook_omnidirectional",
    "textbook_tricycle", "tractor_off_axle", "turtlebot3_burger",
)  # fmt: skip


@pytest.mark.slow
def test_who_has_a_model_in_wheel_speeds() -> None:
    """And the car with trailers, whose model has a virtual wheel, and the two robots on driven balls."""
    others = {"car_with_trailers", "textbook_tribolo", "textbook_two_spheres"}
    assert {n for n in ROBOTS if speeds(n)} == {*DRIVEN, *others}


@pytest.mark.parametrize("name", DRIVEN)
def test_the_posture_model_in_wheel_speeds(name: str) -> None:
    """Wheels turn as an admissible twist wants it; the model gives the velocity of that twist in the world."""
    robot, theta = of_gallery(name).robot, 0.6
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    rows = [[-sin(h), cos(h), float(w.nominal.x) * cos(h) + float(w.nominal.y) * sin(h)]
            for w in fixed for h in [float(w.heading)]]  # fmt: skip
    basis = (
        np.linalg.svd(np.array(rows))[2][np.linalg.matrix_rank(np.array(rows), tol=1e-9) :]
        if rows
        else np.eye(3)
    )
    twist = np.array([0.8, 0.5, -0.3])[: len(basis)] @ basis
    if robot.couplings:
        twist = np.array([0.8, 0.3, 0.0])
    values = {r"\theta": theta} | lengths_in_formulas(robot)
    for w in robot.wheels:
        if not w.kind.directed or not w.has_spin or w.kind.swivels:
            continue
        a, b = twist[0] - float(w.nominal.y) * twist[2], twist[1] + float(w.nominal.x) * twist[2]
        turned, share = float(w.heading), 1.0
        if w.kind.steers:
            psi = (atan2(b, a) - turned + pi / 2) % pi - pi / 2  # the heading nearest to its zero
            values[notation.port(f"{w.name}.steer")], turned = psi, turned + psi
        if w.kind.rollers:
            turned, share = turned + float(w.gamma), cos(float(w.gamma))
        rim = (a * cos(turned) + b * sin(turned)) / share
        values[notation.port(f"{w.name}.spin")] = rim / float(w.nominal.r)
    c, s = cos(theta), sin(theta)
    rates = {
        r"\dot{x}": c * twist[0] - s * twist[1], r"\dot{y}": s * twist[0] + c * twist[1],
        r"\dot{\theta}": twist[2], "v_x": twist[0], "v_y": twist[1],
    }  # fmt: skip
    sides = formulas(speeds(name))
    assert [a for a, _ in sides if a.startswith(r"\dot")][:3] == list(rates)[:3]
    for a, right in sides:
        if a in rates:  # the turn of a tractor is that of its trailer, too
            right = right.removeprefix(r"\omega = ")
            assert read(right, values) == pytest.approx(rates[a], rel=1e-6, abs=1e-12), (a, right)
            values |= {a: rates[a]} if a.startswith("v") else {}


def test_the_posture_model_of_a_differential_drive_is_factored() -> None:
    """Tzafestas (2.36)."""
    speed = (
        r"\frac{\mathit{radius}}{2}\left(\dot{\varphi}_{\mathrm{left}}+\dot{\varphi}_{\mathrm{right}}\right)"
    )
    assert rf"\dot{{x}} &= {speed}\cos\theta" in speeds("pioneer3dx")


def test_trailers_turn_as_their_hitch_is_pulled() -> None:
    """Tzafestas (2.70), the hitch h behind the axle: L theta' = v sin(delta) - h omega cos(delta)."""
    text, robot = speeds("tractor_off_axle"), of_gallery("tractor_off_axle").robot
    (cart,) = robot.trailers
    values = lengths_in_formulas(robot)
    values |= {r"\theta_{\mathrm{cart}}": 0.3, r"\theta": 0.9, "v_x": 0.7, r"\omega": 0.2}
    shown = re.search(r"\\dot\{\\theta\}_\{\\mathrm\{cart\}\} &= (.*)", text)
    length, hitch = float(cart.length.nominal), float(cart.hitch.nominal)
    assert shown and read(shown[1], values) == pytest.approx(
        (0.7 * sin(0.6) - hitch * 0.2 * cos(0.6)) / length
    )


def test_ackermann() -> None:
    """The cotangents of the front wheels on a circle, from their places."""
    page = page_of("ackermann_car")
    shown = re.search(r"\\cot\\psi.*front\\_right.* - .*front\\_left.* = ([\d.]+)$", page, re.MULTILINE)
    assert shown
    wheels = {w.name: w for w in of_gallery("ackermann_car").robot.wheels}
    for radius in (6.0, -4.0, 30.0):
        cot = {
            n: (radius - float(w.nominal.y)) / float(w.nominal.x) for n, w in wheels.items() if w.kind.steers
        }
        assert cot["front_right"] - cot["front_left"] == pytest.approx(float(shown[1]))
    assert r"\tan\psi &= \frac{\omega\,L}{v_x} = \frac{L}{R}, \qquad L = 2.5" in page
    assert r"\tan\psi_{\mathrm{front}} &= \frac{\omega\,L}{v_x} = \frac{L}{R}" in page_of("bicycle")
    assert "Ackermann)" not in page_of("bicycle") and "Ackermann)" not in page_of("wpilib_swervebot")


def test_a_differential_drive_is_stacked_as_in_the_book() -> None:
    """Siegwart (3.29): the rolling rows of the right wheel and the left one, then the sliding row."""
    rows = "1 & 0 & \\mathit{half\\_track} \\\\\n1 & 0 & -\\mathit{half\\_track} \\\\\n0 & 1 & 0"
    section = page_of("pioneer3dx").partition("## 7 ")[2]
    assert rows in section and r"\det H = 2\,\mathit{half\_track}" in section


def test_square_systems() -> None:
    """(3.31) where three rolling rows are all there is; a determinant of those rows."""
    for name in ("lekiwi", "festo_robotino", "textbook_omnidirectional"):
        page = page_of(name)
        assert (
            r"\xi = H^{-1} z = J_1^{-1} J_2\,\dot{\varphi}\;\;(3.31)" in page and r"(H^T H)^{-1}" not in page
        )
        robot = of_gallery(name).robot
        rows = [[cos(h), sin(h), float(w.nominal.x) * sin(h) - float(w.nominal.y) * cos(h)]
                for w in robot.wheels for h in [float(w.heading)]]  # fmt: skip
        shown = re.search(r"\\det H = (.*)", page)
        values = lengths_in_formulas(robot)
        assert shown and read(shown[1], values) == pytest.approx(np.linalg.det(np.array(rows)), rel=1e-5)


@pytest.mark.parametrize("name", ["car_with_trailers", "tractor_off_axle", "pioneer3dx", "wpilib_swervebot"])
def test_the_growth_vector_is_that_of_wmrgen_structure(name: str) -> None:
    d, page = of_gallery(name), keyed_page_of(name)
    vector = tuple(d.growth.vector)
    said = sentence(page, "growth.vector")
    assert f" ({', '.join(map(str, vector))})" in said and said.endswith(f" {len(vector)}.")
    assert ("growth.trailers" in keys(page)) == bool(d.robot.trailers)
    assert ("growth.steering" in keys(page)) == (vector[-1] - 3 > len(d.robot.trailers))


@pytest.mark.parametrize("name", ["car_with_trailers", "tractor_off_axle"])
def test_trailers_are_listed_and_derived(name: str) -> None:
    page, robot = page_of(name), of_gallery(name).robot
    for t in robot.trailers:
        assert f"| `{t.name}` | {float(t.length.nominal):g} | {float(t.hitch.nominal):g} |" in page
        assert (
            rf"\dot{{\theta}}_{{\mathrm{{{t.name}}}}} &=" in page.partition("## 8 ")[2].partition("## 9 ")[0]
        )


def test_further_functions_without_names_of_the_code() -> None:
    further = numerics_of("car_with_trailers").partition("## Further functions")[2].partition("\n## ")[0]
    assert "divisor1" not in further and r"\frac{d}{dt} \theta_{\mathrm{trailer2}}" in further
    assert "`trailer1.speed` and `trailer2.speed`" in further
    assert "numerics.rest_in_code" in keys_of_numerics("car_with_trailers")


@pytest.mark.parametrize("name", ["textbook_omni_steer", "unicycle"])
def test_a_model_that_cannot_be_written_in_wheel_speeds_is_written_in_eta(name: str) -> None:
    """Too few joints are driven to determine all rates."""
    d = of_gallery(name)
    with pytest.raises(NotDerivableError):
        posture_motion(d.robot, d.mobility, symbolic=True)
    text = "\n".join(motion(d))
    assert "motion.in_wheel_speeds" not in keys(text)
    assert "motion.twist_of_eta" in keys(text) and r"\eta_{1}" in text


LONG = """wmrgen: 1
name: sample
parameters: {a: 0.3, b: 0.2}
wheels:
  - {name: w0, type: swedish, x: a, y: b, heading: 0.37, r: 0.1, gamma: 0.5}
  - {name: w1, type: swedish, x: -a, y: b, heading: 1.9, r: 0.1, gamma: -0.7}
  - {name: w2, type: swedish, x: b, y: -a, heading: 4.1, r: 0.1, gamma: 0.3}
  - {name: w3, type: fixed, x: b, y: 0.1, heading: 0.37, r: 0.1, sensed: []}
"""


def test_long_numbers_are_not_factored() -> None:
    """Sines of general angles are fractions of forty digits: their common divisors overflow what can be printed."""
    page = page_written(LONG)
    forward = page.partition("**Forward")[2].partition("**An example")[0].partition("**Files")[0]
    assert r"\mathit" not in forward and " a" not in forward.split("```math")[1] and r"\det(H^T H) = " in page
    assert not re.search(r"\d{10,}", page.partition("## 7 ")[2].partition("## 8 ")[0])


ROOTS = """wmrgen: 1
name: sample
wheels:
  - {name: w0, type: castor, x: -0.4, y: 0.16, heading: 7*pi/12, r: 0.276, d: 0.18, actuated: [], sensed: [steer]}
  - {name: w1, type: fixed, x: -0.534, y: 0.043, heading: -pi/6, r: 0.23, actuated: [], sensed: [spin]}
  - {name: w2, type: castor, x: 0.5, y: 0.8, heading: 7*pi/12, r: 0.3, d: -0.16, actuated: [], sensed: [spin, steer]}
"""


@pytest.mark.parametrize(("heading", "factored"), [("7*pi/12", False), ("pi/2", True)])
def test_common_factors_are_looked_for_where_numbers_are_rational(heading: str, factored: bool) -> None:
    """Among roots it took a minute; the rule stands alone there."""
    d = of_text(ROOTS.replace("7*pi/12", heading).replace("-pi/6", "0" if factored else "-pi/6"))
    assert (r"\omega &=" in "\n".join(closed_forward(d))) == factored


@pytest.mark.parametrize(
    ("half", "radius", "shown"),
    [
        ("0.3", "0.1", r"\frac{1}{6} \approx 0.166667"),
        ("0.2", "0.1", None),  # 1/4 needs no other form
        ("half: 0.22256", "0.0625", r"\mathit{half}} \approx 0.140412"),  # 3125/22256 is long
        ("half: 0.2", "0.1", r"\mathit{half}} = 0.25"),
    ],
)
def test_a_rounded_number_is_not_said_to_be_equal(half: str, radius: str, shown: str | None) -> None:
    name, _, value = half.rpartition(": ")
    robot = f"wmrgen: 1\nname: pair\n{f'parameters: {{{half}}}' if name else ''}\nwheels:\n"
    for wheel, y in (("left", name or value), ("right", f"-{name or value}")):
        robot += f"  - {{name: {wheel}, type: fixed, x: 0, y: {y}, heading: 0, r: {radius}}}\n"
    page = page_written(robot).partition("**An example**")[0]
    assert shown in page if shown else r"\frac{1}{4}" not in page


TRICYCLE = """wmrgen: 1
name: trike
parameters: {ahead: 1.05, behind: 0.3, half_track: 0.42}
wheels:
  - {name: front, type: steered, x: ahead, y: 0, heading: 0, r: 0.2}
  - {name: left, type: fixed, x: -behind, y: half_track, heading: 0, r: 0.18, actuated: []}
  - {name: right, type: fixed, x: -behind, y: -half_track, heading: 0, r: 0.18, actuated: [], sensed: [spin]}
trailers: [{name: cart, length: 1.3, hitch: 0.25}]
"""


def test_a_wheelbase_that_is_a_sum_of_lengths() -> None:
    """The wheelbase of a tricycle with P between its axles is ahead + behind, in det(HᵀH) and in the twist."""
    page = page_written(TRICYCLE)
    values = {notation.parameter(n): v for n, v in (("ahead", 1.05), ("behind", 0.3), ("half_track", 0.42))}
    det = re.search(r"\\det\(H\^T H\) = (.*)", page)
    assert det and read(det[1], values) == pytest.approx(3 * 0.42**2 + 4 * 1.35**2)
    shown = dict(formulas(between(page, "Forward", "An example")))
    d = of_text(TRICYCLE)
    rates = {"front.spin": 3.0, "front.steer": 0.5, "right.spin": -2.0}
    values = {notation.port(n): v for n, v in rates.items()}
    values |= lengths_in_formulas(d.robot)
    # Rows of the front wheel (turned into the robot's axes) and of both rear wheels.
    h = [[1, 0, 0], [0, 1, 1.05], [1, 0, 0.42], [0, 1, -0.3], [0, 1, -0.3]]
    twist = np.linalg.lstsq(np.array(h), np.array([0.6 * cos(0.5), 0.6 * sin(0.5), -0.36, 0, 0]), rcond=None)[
        0
    ]
    for name, value in zip(("vx", "vy", "omega"), twist, strict=True):
        text = shown[notation.port(name)]
        assert read(text, values) == pytest.approx(value)


def test_the_yaw_rate_of_a_trailer_whose_length_is_a_number() -> None:
    """Tzafestas (2.70): the velocity of the hitch across the trailer over its length."""
    page = page_written(TRICYCLE)
    shown = re.search(r"\\dot\{\\theta\}_\{\\mathrm\{cart\}\} &= (.*)", page)
    values = {
        r"\theta_{\mathrm{cart}}": 0.3,
        r"\theta": 0.9,
        "v_x": 0.7,
        "v_y": 0.1,
        r"\omega": 0.2,
        r"\mathit{behind}": 0.3,
    }
    pulled = 0.7 * sin(0.6) + (0.1 - 0.55 * 0.2) * cos(0.6)
    assert shown and read(shown[1], values) == pytest.approx(pulled / 1.3)


def test_what_is_divided_by_a_sum_of_lengths_has_their_size() -> None:
    """1 - 100 ahead / 11 is ahead - 0.11."""
    text = """wmrgen: 1
name: two
parameters: {ahead: 0.62, behind: 0.35}
wheels:
  - {name: front, type: steered, x: ahead, y: 0.05, heading: 0, r: 0.09}
  - {name: rear, type: steered, x: -behind, y: -0.03, heading: 0, r: 0.08}
  - {name: mid, type: fixed, x: 0.11, y: 0.2, heading: 0, r: 0.08}
"""
    page = page_written(text)
    model = page.partition("In the speed of `front`, with which ")[2].partition("where the")[0]
    sides = dict(formulas(model))
    own = {r"\psi_{\mathrm{front}}": 0.4, r"\dot{\varphi}_{\mathrm{front}}": 2.0, r"\mathit{ahead}": 0.62}
    omega = 0.18 * sin(0.4) / (0.62 - 0.11)  # of the front wheel across the axle of the fixed one
    assert read(sides[r"\dot{\theta}"], own) == pytest.approx(omega)
    assert read(sides["v_x"], own) == pytest.approx(0.18 * cos(0.4) + 0.05 * omega)
    assert read(sides["v_y"], own) == pytest.approx(-0.11 * omega)
    assert model.count(r"}{\mathit{ahead}-0.11}") == 3
