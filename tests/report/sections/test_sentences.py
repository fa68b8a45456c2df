"""Sentences of the report are true: each is compared with a computation, or with robots for which it is false."""

from __future__ import annotations

import math
import re
from itertools import pairwise

import numpy as np
import pytest

from tests.report.sections.common import (
    keyed_page_of,
    keyed_page_written,
    keys_of,
    keys_of_numerics,
    keys_written,
    numerics_of,
    page_of,
    page_written,
    sentence,
)
from tests.robots import ROBOTS, of_gallery, of_text
from tests.work import arguments
from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.kinematics.pose import WORST_ERROR
from wmrgen.analysis.mobility.analyse import analyse
from wmrgen.derivation.emit import artifacts, wheel_lines
from wmrgen.geometry.constraints import pfaffian
from wmrgen.ir.lower import lower
from wmrgen.report.sections.markdown import keys


@pytest.mark.parametrize("name", ROBOTS)
def test_which_twists_are_admissible(name: str) -> None:
    """Every twist, at any time: that is degree of mobility 3. At the right steering angles: maneuverability 3."""
    said, m = keys_of(name), of_gallery(name).mobility
    assert "slip.every_twist" not in said or m.degree_of_mobility == 3
    assert "slip.some_angles" not in said or m.degree_of_mobility < m.degree_of_maneuverability == 3


def test_the_slip_of_a_swerve_drive() -> None:
    assert "slip.some_angles" in keys_of("wpilib_swervebot") and "slip.every_twist" in keys_of("kuka_youbot")


def test_slip_is_not_called_0_where_limits_make_some() -> None:
    wheels = "".join(
        f"  - {{name: w{k}, type: steered, x: {x}, y: 0.2, heading: 0, r: 0.1, limits: {{steer: [-30 deg, 30 deg]}}}}\n"
        for k, x in enumerate((0.3, -0.3))
    )
    assert "slip.unless_limited" in keys_written(f"wmrgen: 1\nname: sample\nwheels:\n{wheels}")
    assert "slip.unless_limited" not in keys_of("wpilib_swervebot")


@pytest.mark.parametrize(("heading", "letter"), [(0, "y"), (180, "y"), (90, "x")])
def test_what_slides_is_said_once_and_without_a_sign(heading: int, letter: str) -> None:
    across = {"y": ("0", "0.2"), "x": ("0.2", "0")}[letter]
    wheels = [f"{{name: w{k}, type: fixed, x: {sign}{across[0]}, y: {sign}{across[1]}, heading: {heading} deg, r: 0.1}}"
              for k, sign in enumerate(("", "-"))]  # fmt: skip
    text = page_written(f"wmrgen: 1\nname: sample\nwheels: [{', '.join(wheels)}]\n").partition("## 6 ")[2]
    assert f"`slip` is √2 |v<sub>{letter}</sub>|" in text and text.count("`slip`") == 2 and "|-" not in text


def test_one_steered_wheel_chooses_no_icr_but_a_line_that_it_lies_on() -> None:
    omni, car = keys_of("textbook_omni_steer"), keys_of("ackermann_car")
    assert "column.rotation_about_point" in omni and "column.rotation_about_icr" not in omni
    assert not any(key.startswith("mobility.axles") for key in omni) and "mobility.axles_meet" in car


@pytest.mark.parametrize(
    ("turned", "more", "slides", "cannot_turn"),
    [(0, "couplings: [{equal: [f.steer, g.steer]}]", True, True), (0, "", False, False), (4, "", True, False)],
)  # fmt: skip
def test_where_a_robot_slides_that_rolls_in_one_motion(
    turned: int, more: str, slides: bool, cannot_turn: bool
) -> None:
    """One steering angle for two wheels beside each other: straight ahead alone rolls. Toe-in: turning on the spot."""
    wheels = [f"{{name: {n}, type: fixed, x: 0, y: {y}, heading: {h} deg, r: 0.1}}"
              for n, y, h in (("l", 0.3, -turned), ("r", -0.3, turned))]  # fmt: skip
    wheels += [
        f"{{name: {n}, type: steered, x: 0.8, y: {y}, heading: 0, r: 0.1}}"
        for n, y in (("f", 0.3), ("g", -0.3))
    ]
    said = keys_written(
        f"wmrgen: 1\nname: sample\nwheels: [{', '.join(wheels[: 2 if turned else 4])}]\n{more}\n"
    )
    assert ("model.while_sliding" in said) == slides
    assert ("motion.cannot_turn" in said) == cannot_turn
    assert ("singular.shared_angle" in said) == ("equal" in more)


def test_the_error_of_the_series_in_units_in_the_last_place() -> None:
    unit = math.ulp(math.nextafter(1.0, 0.0))
    assert unit == 2**-53 and unit / 2 < WORST_ERROR < unit
    assert "numerics.series_error" in keys_of_numerics("pioneer3dx") and "2⁻⁵³" in numerics_of("pioneer3dx")


@pytest.mark.parametrize("name", ["pioneer3dx", "clearpath_a200", "unicycle", "andino"])
def test_equal_matrices_have_equal_singular_values(name: str) -> None:
    """No wheel steers: C1 is C1f, rows that say the same included."""
    m = of_gallery(name).mobility
    assert m.rank_C1f.singular_values == m.rank_C1.singular_values
    fixed, every = re.findall(r"(?m)^\| C.*?\| (?:\d|no).*$", numerics_of(name))
    assert fixed.split("|")[2:] == every.split("|")[2:]


def test_singular_values_are_those_of_all_rows() -> None:
    """Wheels ahead have sliding rows (0, 1, x): the squares of all entries add up to those of the values."""
    d = of_gallery("clearpath_a200")
    squares = sum(1 + float(w.nominal.x) ** 2 for w in d.robot.wheels)
    assert sum(s * s for s in d.mobility.rank_C1.singular_values) == pytest.approx(squares)


@pytest.mark.parametrize("name", ROBOTS)
def test_h_is_free_for_a_parameter(name: str) -> None:
    """No report has a quantity h of its own."""
    own = any("h" in (p.name, p.symbol) for p in of_gallery(name).robot.parameters)
    assert bool(re.search(r"(?<![\w\\{.])h(?![\w_])", page_of(name))) == own


@pytest.mark.parametrize("name", ROBOTS)
def test_a_text_without_dimensions_is_no_source_of_them(name: str) -> None:
    assert "Source of the geometry" not in page_of(name)
    assert name != "textbook_two_steer" or "\nSource: " in page_of(name)


LEAN = "layout.rollers_lean"


@pytest.mark.parametrize("name", ROBOTS)
def test_only_rollers_at_an_angle_lean(name: str) -> None:
    assert (LEAN in keys_of(name)) == any(w.kind.rollers and w.gamma for w in of_gallery(name).robot.wheels)


def test_the_heading_of_a_synchro_drive_is_constant() -> None:
    page, said = page_of("synchro_drive"), keys_of("synchro_drive")
    assert "integrability.in_part" in said and "integrability.none" not in said
    assert "column.translation" in said and "column.rotation_about_icr" not in said
    assert r"N = \begin{bmatrix}" + "\n\\cos\\psi_{\\mathrm{w1}}" in page
    null = of_gallery("synchro_drive").null_space
    assert all(null[2, j] == 0 for j in range(null.cols))


@pytest.mark.parametrize("name", ROBOTS)
def test_minus_signs_and_code(name: str) -> None:
    """No number of a sentence has a hyphen for its sign, no code stands between backticks that are escaped."""
    words = re.sub(r"```math.*?```|`[^`]*`|\n\|[^\n]*", "", page_of(name), flags=re.DOTALL)
    assert not re.search(r"(?<![\w.)])-(?=\d)", words) and "\\`" not in page_of(name)


def test_a_negative_ratio_has_a_minus_sign() -> None:
    wheels = "".join(
        f"  - {{name: w{k}, type: fixed, x: 0, y: {y}, heading: 0, r: 0.1}}\n"
        for k, y in enumerate((0.2, -0.2))
    )
    text = (
        f"wmrgen: 1\nname: sample\nwheels:\n{wheels}couplings:\n"
        "  - {equal: [w0.spin, w1.spin], ratios: [1, -5/6]}\n"
    )
    page = keyed_page_written(text)
    assert "1 : −5/6" in sentence(page, "layout.couplings") and "1 : −5/6" in sentence(
        page, "inverse.one_speed"
    )
    assert page.count("−5/6") == 2 and "-5/6" not in page


@pytest.mark.parametrize("name", ROBOTS)
def test_what_constraints_integrate_to(name: str) -> None:
    page, said, m = page_of(name), keys_of(name), of_gallery(name).mobility
    assert ("integrability.in_part" in said) == (m.ddof < m.dof == 2)
    assert ("integrability.none" in said) == (m.ddof < m.dof == 3 and r"\mathrm{curl}" in page)


@pytest.mark.parametrize("name", ROBOTS)
def test_words(name: str) -> None:
    """Castor, degree of freedom, slip, measurement: the field's terms."""
    page = re.sub(r"`[^`]*`|```math.*?```", "", page_of(name), flags=re.DOTALL)
    names = [w.name.replace("_", "\\_") for w in of_gallery(name).robot.wheels]
    for own in sorted(names, key=len, reverse=True):
        page = page.replace(own, "")
    assert not re.search(r"\bcasters?\b", page.split("## 1 ")[1])
    for before, word in pairwise(re.findall(r"\w+", page)):
        assert word not in ("freedom", "freedoms") or before == "of"


@pytest.mark.parametrize("name", ROBOTS)
def test_headers_say_it_of_the_same_robots(name: str) -> None:
    lines = wheel_lines(of_gallery(name).robot)
    assert any("lean the other way" in line for line in lines) == (LEAN in keys_of(name))


CORNERS = ((0.3, 0.25), (0.3, -0.25), (-0.1, 0.25), (-0.1, -0.25))
SKIDDING = "\n".join([
    "wmrgen: 1", "name: sample", "effective_track: 0.8", "wheels:",
    *(f"  - {{name: w{k}, type: fixed, x: {x}, y: {y}, heading: 0, r: 0.1}}" for k, (x, y) in enumerate(CORNERS)), "",
])  # fmt: skip


def test_no_stage_is_computed_twice() -> None:
    """Of a robot that skids: its mobility and that of the drive it turns as are analysed, twists are projected on the
    motions of that drive, and `inverse` is lowered for code and example. Nobody asked for its Pfaffian matrix."""
    d = of_text(SKIDDING)
    done = arguments(lambda: artifacts(d), analyse, project, lower, pfaffian)
    names = [name for name, _ in done]
    assert names.count("analyse") == 2 and "pfaffian" not in names
    assert names.count("project") == 4  # for code, two sections of the report and all examples
    assert [f.name for name, f in done if name == "lower"].count("inverse") == 1


def test_a_robot_that_skids() -> None:
    """Without slip it goes straight; its model is not holonomic. Two relations are counted and written."""
    page, said = keyed_page_written(SKIDDING), keys_written(SKIDDING)
    drive = sentence(page, "skid.drive")
    assert "mobility.without_slip" in said and "DDOF = 2 " in drive and "DOF = 3" in drive
    assert said.count("mobility.actuation") == 1 and " 2 relations " in sentence(page, "mobility.actuation")
    relations = page.partition("\0mobility.compatible\0")[2].partition("```math")[2].partition("```")[0]
    assert relations.count("0 &= ") == 2 and "```math\nT_e = 0.8\n```" in page
    assert "type.skids" in keys(page.partition("## 1 ")[0])
    assert "motion.for_control" in said and "motion.ideal_rolling" not in said
    alone = keys_written(re.sub("effective_track: .*", "", SKIDDING))
    assert "motion.ideal_rolling" in alone and "motion.cannot_turn" in alone


@pytest.mark.parametrize("name", ROBOTS)
def test_a_track_is_between_wheels_that_roll_forward(name: str) -> None:
    wheels = [w for w in of_gallery(name).robot.wheels if w.kind.constrains or w.kind.rolls_across]
    pairs = [
        (a, b)
        for k, a in enumerate(wheels)
        for b in wheels[k + 1 :]
        if a.type == b.type and abs(a.pivot - b.pivot.conjugate()) < 1e-12 and abs(a.pivot.imag) > 1e-12
    ]
    ahead = any(abs(math.sin(a.heading)) < 1e-9 and abs(math.sin(b.heading)) < 1e-9 for a, b in pairs)
    assert ("layout.track" in keys_of(name)) == ahead


def test_each_track_is_said() -> None:
    """A figure has the widest one, so that the text must not call another one the track."""
    wheels = "".join(
        f"  - {{name: w{k}, type: swedish, x: {x}, y: {y}, heading: 0, gamma: {'-' * (x * y > 0)}45 deg, r: 0.1}}\n"
        for k, (x, y) in enumerate(((0.3, 0.21), (0.3, -0.21), (-0.2, 0.25), (-0.2, -0.25)))
    )
    said = sentence(keyed_page_written(f"wmrgen: 1\nname: sample\nwheels:\n{wheels}"), "layout.track")
    assert re.findall(r"[\d.]+ m|`\w+`", said) == ["0.42 m", "`w0`", "`w1`", "0.5 m", "`w2`", "`w3`"]


@pytest.mark.parametrize("name", ROBOTS)
def test_who_stands_still_with_its_icr_on_a_pivot(name: str) -> None:
    """A car, whose ICR stays on its fixed axle; a swerve drive turns about the pivot."""
    d = of_gallery(name)
    if not any(s.kind == "icr_on_pivot" for s in d.mobility.singularities):
        return
    turns = [np.exp(-1j * w.heading) for w in d.robot.wheels if w.kind.fixed_axle]
    pivots = [w.pivot for w in d.robot.wheels if w.kind.fixed_axle]
    rows = [[z.imag, z.real, (p * z).real] for z, p in zip(turns, pivots, strict=True)]
    rows += [[0.0, 0.0, 1.0]] * (name == "synchro_drive")  # its couplings keep it from turning
    ranks = [
        np.linalg.matrix_rank(np.array([*rows, [1, 0, -w.pivot.imag], [0, 1, w.pivot.real]]), tol=1e-9)
        for w in d.robot.wheels
        if w.kind.steers
    ]
    assert ("singular.at_standstill" in keys_of(name)) == (min(ranks) == 3)


@pytest.mark.parametrize("name", ROBOTS)
def test_names_of_wheels_are_code(name: str) -> None:
    """Names that are no words: with a low line or a digit."""
    prose = re.sub(r"(?s)```.*?```|`[^`\n]*`|!\[.*?\]\(.*?\)|(?m:^\|.*$)", "", page_of(name)).replace(
        "\\_", "_"
    )
    words = set(re.findall(r"\w+", prose))
    assert not {w.name for w in of_gallery(name).robot.wheels if re.search(r"[_\d]", w.name)} & words


@pytest.mark.parametrize("name", ["office_chair", "unicycle", "pioneer3dx"])
def test_models_in_rates_of_joints_need_enough_of_them(name: str) -> None:
    lacking = any(balance.lacking for balance in of_gallery(name).mobility.actuation)
    assert ("(`posture`)" in sentence(keyed_page_of(name), "model.forms")) != lacking
    assert ("`eta` and `posture`" in sentence(keyed_page_of(name), "model.eta_for_few_drives")) == lacking


@pytest.mark.parametrize("name", ROBOTS)
def test_speeds_of_wheels_beside_their_steering_axis_are_those_at_a_constant_angle(name: str) -> None:
    offset = any(w.kind.steers and w.nominal.o for w in of_gallery(name).robot.wheels)
    assert ("inverse.steering_rate" in keys_of(name)) == offset


@pytest.mark.parametrize("name", ROBOTS)
def test_columns_of_the_null_space_are_called_what_they_are(name: str) -> None:
    """Whether they turn, against N at an angle: a translation has no yaw rate, a rotation has one."""
    columns = of_gallery(name).mobility.null_space
    told = [key for key in keys_of(name) if key.startswith("column.")]
    assert len(told) == len(columns)
    assert [("rotation" in key) for key in told] == [bool(c[2]) for c in columns]
    assert [key == "column.rotation_about_p" for key in told] == [
        bool(c[2]) and not c[0] and not c[1] for c in columns
    ]


@pytest.mark.parametrize("name", ROBOTS)
def test_no_condition_has_a_fraction(name: str) -> None:
    """What is 0, of speeds of wheels and of singular models, is cleared of denominators."""
    assert not [line for line in page_of(name).split("\n") if line.startswith("0 &=") and "frac" in line]


@pytest.mark.parametrize("name", ROBOTS)
def test_a_growth_vector_says_what_it_counts(name: str) -> None:
    m = of_gallery(name).mobility
    assert not m.ddof or ("growth.steering" in keys_of(name)) == bool(m.degree_of_steerability)


LOCKED = """wmrgen: 1
name: sample
wheels:
  - {name: a, type: fixed, x: 0.3, y: 0.2, heading: 0.4, r: 0.1}
  - {name: b, type: fixed, x: -0.3, y: 0.1, heading: 0, r: 0.1}
  - {name: c, type: fixed, x: 0.1, y: -0.3, heading: 1.2, r: 0.1}
"""
SPINNING = """wmrgen: 1
name: sample
wheels:
  - {name: l, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}
  - {name: q, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.12}
  - {name: f, type: steered, x: 0.5, y: 0, heading: 0, r: 0.1, actuated: [steer], sensed: [steer]}
couplings: [{equal: [l.spin, q.spin], ratios: [1, -5/6]}]
"""
PARALLEL = """wmrgen: 1
name: sample
wheels:
  - {name: fl, type: steered, x: 0.5, y: 0.3, heading: 0, r: 0.1}
  - {name: fr, type: steered, x: 0.5, y: -0.3, heading: 0, r: 0.1}
  - {name: rl, type: fixed, x: -0.5, y: 0.3, heading: 0, r: 0.1}
  - {name: rr, type: fixed, x: -0.5, y: -0.3, heading: 0, r: 0.1}
couplings: [{equal: [fl.steer, fr.steer]}]
"""
OMNI = """wmrgen: 1
name: sample
wheels:
  - {name: drive, type: swedish, x: 0.1, y: 0, heading: 0, gamma: 0, r: 0.05}
  - {name: ball, type: spherical, x: -0.1, y: 0.1, r: 0.02}
"""
REACH = """wmrgen: 1
name: sample
wheels:
  - {name: drive, type: steered, x: -1.5, y: 0, heading: 0, r: 0.12}
  - {name: l, type: fixed, x: 0, y: 0.45, heading: 0, r: 0.05, actuated: []}
  - {name: q, type: fixed, x: 0, y: -0.45, heading: 0, r: 0.05, actuated: []}
"""
# Found by Atheris: of the model's forms it has the twist alone.
STUCK = """wmrgen: 1
name: sample
wheels:
  - {name: a, type: steered, x: 4, y: 0, heading: 0, r: 4}
  - {name: b, type: steered, x: 0.2, y: 0.3, heading: 0, r: 0.1}
  - {name: c, type: steered, x: 0, y: 0, heading: 0, r: 0.1}
couplings: [{equal: [a.steer, b.steer, c.steer]}, {equal: [a.spin, b.spin, c.spin]}]
"""


CHAIN = """wmrgen: 1
name: sample
wheels:
  - {name: rear, type: fixed, x: -0.5, y: 0, heading: 0, r: 0.3}
  - {name: ball, type: fixed, x: -0.5, y: 0.2, heading: 0, r: 0.3}
  - {name: front, type: steered, x: 0.6, y: 0, heading: 0, r: 0.3}
couplings: [{equal: [rear.spin, front.spin]}]
"""
SIDES = """wmrgen: 1
name: sample
effective_track: 0.9
wheels:
  - {name: a, type: fixed, x: 0.3, y: 0.3, heading: 0, r: 0.1}
  - {name: b, type: fixed, x: -0.3, y: 0.3, heading: 0, r: 0.1}
  - {name: c, type: fixed, x: 0.3, y: -0.3, heading: 0, r: 0.1}
  - {name: e, type: fixed, x: -0.3, y: -0.3, heading: 0, r: 0.1}
couplings: [{equal: [a.spin, b.spin]}, {equal: [c.spin, e.spin]}]
"""
LIMITED = """wmrgen: 1
name: sample
wheels:
  - {name: rear, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.3}
  - {name: front, type: steered, x: 0.6, y: 0, heading: 0, r: 0.3, limits: {steer: [-60 deg, 60 deg]}}
"""
POWERED = """wmrgen: 1
name: sample
wheels:
  - {name: a, type: castor, x: 0.3, y: 0, d: -0.03, r: 0.05, actuated: [spin, steer]}
  - {name: b, type: castor, x: -0.3, y: 0, d: -0.03, r: 0.05, actuated: [spin, steer]}
"""
TANK = SIDES.replace("effective_track: 0.9\n", "").partition("couplings")[0]
DRIVEN = f"{POWERED}couplings: [{{equal: [a.steer, b.steer]}}]\n"
APART = DRIVEN.replace("x: -0.3, y: 0, d: -0.03", "x: -0.3, y: 0, d: -0.04")
TILTED = """wmrgen: 1
name: sample
parameters: {g: 25 deg}
wheels:
  - {name: a, type: swedish, l: 0.2, alpha: 0, beta: 0, gamma: g, r: 0.05}
  - {name: b, type: swedish, l: 0.2, alpha: 120 deg, beta: 0, gamma: g, r: 0.05}
  - {name: c, type: swedish, l: 0.2, alpha: -120 deg, beta: 0, gamma: g, r: 0.05}
"""
ROUND = """wmrgen: 1
name: sample
wheels:
  - {name: a, type: steered, l: 0.35, alpha: 0, beta: 90 deg, r: 0.05}
  - {name: b, type: steered, l: 0.35, alpha: 120 deg, beta: 90 deg, r: 0.05}
"""
SHIFTED = """wmrgen: 1
name: sample
parameters: {p: {value: 0.3, tunable: true}}
wheels:
  - {name: a, type: fixed, x: p - 0.3, y: 0.2, heading: 0, r: 0.1}
  - {name: b, type: fixed, x: p - 0.3, y: -0.2, heading: 0, r: 0.1}
"""


# The letter e stands in sentences before the name does; C1 is a matrix, too.
NAMES = """wmrgen: 1
name: sample
limits: {omega: 2}
wheels:
  - {name: left, type: fixed, x: 0.0004, y: 0.2, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
  - {name: e, type: steered, x: 0.5, y: 0, heading: 0, r: 0.1, actuated: [steer]}
  - {name: C1, type: castor, x: 0.3, y: 0.1, d: 0.04, r: 0.05}
"""
LETTERS = """\
wmrgen: 1
name: letters
parameters: {r: 0.3, d: 0.2, L: 0.05}
wheels:
  - {name: a, type: fixed, x: r, y: d, heading: 0, r: L}
  - {name: b, type: fixed, x: 0.03, y: -d, heading: 0, r: L}
couplings: [{equal: [a.spin, b.spin]}]
"""
ROOTS = """\
wmrgen: 1
name: roots
parameters: {a: 0.41, r: 0.05}
wheels:
  - {name: front, type: steered, x: a, y: 0, heading: 0, r: 0.075}
  - {name: omni, type: swedish, x: 0, y: 0.26, heading: 30 deg, r: r}
"""


@pytest.mark.parametrize(
    ("robot", "shown", "absent"),
    [
        (LETTERS, "\\begin{bmatrix}\n1 \\\\\n0 \\\\\n0\n\\end", "3-100"),  # cleared of 0.03 - r
        (ROOTS, r"-2\,r\;\dot{\varphi}_{\mathrm{omni}}}{0.26\sqrt{3}+a}", "52}"),  # lengths keep their size
        (STUCK, "## 9 Singular configurations", "In the textbooks"),
        (SPINNING, r"\dot{x} &= 0 \\", r"\left(0\right)"),
        (SPINNING, r"\mathrm{slip} = \sqrt{2\left[ v_y^2 + v_x^2 \right]}", "2\\,"),
        (CHAIN, r"\mathrm{slip} = \sqrt{2\,\left(v_y-\frac{\omega}{2}\right)^2 + \sum \varepsilon^2}", "square of"),
        (LIMITED, r"\mathrm{slip} = \sqrt{v_y^2 + v_\perp^2}", "is added to"),
        (TILTED, r"\frac{\tan g\;v_x-v_y-0.2\;\omega}{0.05}", r"\left(g\right)"),
        (ROUND, r"\sqrt{3}\,\cos\psi_{\mathrm{a}}-\sin\psi_{\mathrm{a}} &= 0", "mobility.axles"),
        (NAMES, "\n* The axle lines of `left` and `right` are 0.4 mm apart", ". The axle lines"),
        (NAMES, "`C1` imposes no sliding constraint", "`C₁`"),
        (LOCKED, "DDOF = DOF = 0", r"\mathrm{slip} = \sqrt{{"),  # the residual is too wide for a page
    ],
)  # fmt: skip
def test_formulas_of_robots_that_few_have(robot: str, shown: str, absent: str) -> None:
    page = page_written(robot)
    assert shown in page and absent not in page


@pytest.mark.parametrize(
    ("robot", "key", "parts", "absent"),
    [
        (NAMES, "model.limits_of_others", ["`omega`", "is neither"], ""),
        (NAMES, "model.singular", ["`left.spin`"], ""),
        (LETTERS, "layout.letters_of_parameters", ["`r` and `d`"], ""),
        (LETTERS, "layout.typewriter", ["`L`", "a parameter"], ""),
        (ROOTS, "type.steering_adds", [], "layout.letters_of_parameters"),
        (STUCK, "model.forms", ["(`twist`)"], "model.eta_for_few_drives"),
        (STUCK, "model.state_space", ["`twist`"], ""),
        (LOCKED, "forward.residual", ["`slip`"], "mobility.holonomic_only"),
        (LOCKED, "type.cannot_move", [], "type.steering_adds"),
        (PARALLEL, "mobility.actuation", ["3 relations"], "mobility.compatible"),  # they hold straight ahead alone
        (OMNI, "mobility.actuation", [], "type.steering_adds"),
        (SIDES, "layout.couplings", ["`a` and `b`", "`c` and `e`"], "inverse.mean_rate"),
        (LIMITED, "slip.parts", ["`slip` [m/s]"], "forward.rigid_rule"),
        (LIMITED, "slip.across", ["`front`", "a limit"], "inverse.compromise_angle"),
        (SHIFTED, "column.rotation_about_p", ["nominal"], ""),
        (DRIVEN, "inverse.one_swivel_rate", ["`a` and `b`"], "inverse.compromise_angle"),
        (APART, "column.rotation_about_point", ["castors"], ""),
        (TANK, "mobility.compatible_while_sliding", [], "mobility.compatible"),
        (TANK, "motion.followers", ["`b.spin`, `c.spin` and `e.spin`"], ""),
        (POWERED, "motion.eta_is_twist", ["η = ξ"], "motion.twist_of_eta"),
        (REACH, "car.steers_behind", ["L is negative"], "car.ackermann"),
    ],
)  # fmt: skip
def test_sentences_of_robots_that_few_have(robot: str, key: str, parts: list[str], absent: str) -> None:
    said, page = keys_written(robot), keyed_page_written(robot)
    assert key in said and absent not in said
    assert [part for part in parts if part not in sentence(page, key)] == []
