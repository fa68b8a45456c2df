"""What the report says in words is so: each sentence against a computation, or against robots of which it is false."""

from __future__ import annotations

import math
import re
from itertools import pairwise

import numpy as np
import pytest

from tests.report.sections.common import numerics_of, page_of, page_written
from tests.robots import ROBOTS, of_gallery, of_text
from tests.work import arguments
from wmrgen.analysis.kinematics.least_squares import project
from wmrgen.analysis.kinematics.pose import WORST_ERROR
from wmrgen.analysis.mobility.analyse import analyse
from wmrgen.derivation.emit import artifacts, wheel_lines
from wmrgen.geometry.constraints import pfaffian
from wmrgen.ir.lower import lower

EVERY_TWIST = "Every twist is admissible"
SOME_ANGLES = "for every twist there are angles at which it is"


@pytest.mark.parametrize("name", ROBOTS)
def test_which_twists_are_admissible(name: str) -> None:
    """Every twist, at any time: that is degree of mobility 3. At the right steering angles: maneuverability 3."""
    page, m = page_of(name), of_gallery(name).mobility
    assert EVERY_TWIST not in page or m.degree_of_mobility == 3
    assert SOME_ANGLES not in page or m.degree_of_mobility < m.degree_of_maneuverability == 3


def test_the_slip_of_a_swerve_drive() -> None:
    assert SOME_ANGLES in page_of("wpilib_swervebot") and EVERY_TWIST in page_of("kuka_youbot")


def test_slip_is_not_called_0_where_limits_make_some() -> None:
    wheels = "".join(
        f"  - {{name: w{k}, type: steered, x: {x}, y: 0.2, heading: 0, r: 0.1, limits: {{steer: [-30 deg, 30 deg]}}}}\n"
        for k, x in enumerate((0.3, -0.3))
    )
    page = page_written(f"wmrgen: 1\nname: sample\nwheels:\n{wheels}")
    assert "is 0, unless a limit or a coupling keeps a wheel from its angle." in page
    assert "keeps a wheel from" not in page_of("wpilib_swervebot")


@pytest.mark.parametrize(("heading", "letter"), [(0, "y"), (180, "y"), (90, "x")])
def test_what_slides_is_said_once_and_without_a_sign(heading: int, letter: str) -> None:
    across = {"y": ("0", "0.2"), "x": ("0.2", "0")}[letter]
    wheels = [f"{{name: w{k}, type: fixed, x: {sign}{across[0]}, y: {sign}{across[1]}, heading: {heading} deg, r: 0.1}}"
              for k, sign in enumerate(("", "-"))]  # fmt: skip
    text = page_written(f"wmrgen: 1\nname: sample\nwheels: [{', '.join(wheels)}]\n").partition("## 6 ")[2]
    assert (
        f"`slip` is √2 |v<sub>{letter}</sub>|, the norm" in text
        and text.count("`slip`") == 2
        and "|-" not in text
    )


def test_one_steered_wheel_chooses_no_icr_but_a_line_that_it_lies_on() -> None:
    page, car = page_of("textbook_omni_steer"), page_of("ackermann_car")
    assert "a rotation about a point that the steering angles choose" in page and "the ICR that" not in page
    assert (
        "for which all axles" not in page and "at steering angles for which all axles meet in one ICR" in car
    )


@pytest.mark.parametrize(
    ("turned", "more", "slides"),
    [(0, "couplings: [{equal: [f.steer, g.steer]}]", "as they do in every curve."), (0, "", ""),
     (4, "", "as they do in every motion but one.")],
)  # fmt: skip
def test_where_a_robot_slides_that_rolls_in_one_motion(turned: int, more: str, slides: str) -> None:
    """One steering angle for two wheels beside each other: straight ahead alone rolls. Toe-in: turning on the spot."""
    wheels = [f"{{name: {n}, type: fixed, x: 0, y: {y}, heading: {h} deg, r: 0.1}}"
              for n, y, h in (("l", 0.3, -turned), ("r", -0.3, turned))]  # fmt: skip
    wheels += [
        f"{{name: {n}, type: steered, x: 0.8, y: {y}, heading: 0, r: 0.1}}"
        for n, y in (("f", 0.3), ("g", -0.3))
    ]
    page = page_written(
        f"wmrgen: 1\nname: sample\nwheels: [{', '.join(wheels[: 2 if turned else 4])}]\n{more}\n"
    )
    assert re.findall(r"as they do in every [^.]*\.", page) == [slides] * bool(slides)
    assert ("so the robot cannot turn: a controller integrates `twist`" in page) == ("curve" in slides)
    assert ("a shared angle also where" in page) == ("equal" in more)


def test_the_error_of_the_series_in_units_in_the_last_place() -> None:
    unit = math.ulp(math.nextafter(1.0, 0.0))
    assert unit == 2**-53 and unit / 2 < WORST_ERROR < unit
    assert "less than one unit in the last place of a double just below 1, 2⁻⁵³" in numerics_of("pioneer3dx")


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
def test_h_is_the_heading_and_nothing_else(name: str) -> None:
    """Section 6 says what h is; no other section has a quantity of that name."""
    sections = re.split(r"(?m)^## ", page_of(name))
    others = "".join(s for s in sections if not s.startswith("6 "))
    assert not re.search(r"(?<![\w\\{.])h(?!\w)", others)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_text_without_dimensions_is_no_source_of_them(name: str) -> None:
    assert "Source of the geometry" not in page_of(name)
    assert name != "textbook_two_steer" or "\nSource: " in page_of(name)


LEAN = "the rollers on top lean the other way"


@pytest.mark.parametrize("name", ROBOTS)
def test_only_rollers_at_an_angle_lean(name: str) -> None:
    assert (LEAN in page_of(name)) == any(w.kind.rollers and w.gamma for w in of_gallery(name).robot.wheels)


def test_the_heading_of_a_synchro_drive_is_constant() -> None:
    page = page_of("synchro_drive")
    assert "ω = 0, which integrates to θ = const." in page and "Nor can" not in page
    assert "Steering `w1` chooses the direction of motion" in page and "chooses the ICR" not in page
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
    page = page_written(
        f"wmrgen: 1\nname: sample\nwheels:\n{wheels}couplings:\n"
        "  - {equal: [w0.spin, w1.spin], ratios: [1, -5/6]}\n"
    )
    assert page.count("turn in the ratio 1 : −5/6") == 2 and "-5/6" not in page


@pytest.mark.parametrize("name", ROBOTS)
def test_what_constraints_integrate_to(name: str) -> None:
    page, m = page_of(name), of_gallery(name).mobility
    assert ("θ = const." in page) == (m.ddof < m.dof == 2)
    assert ("Nor can all constraints together" in page) == (m.ddof < m.dof == 3 and "Frobenius" in page)


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
    assert any("lean the other way" in line for line in lines) == (LEAN in page_of(name))


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
    """Without slip it goes straight, as the drive that turns as it does it is not holonomic; two relations are told,
    and two are written."""
    page = page_written(SKIDDING)
    assert (
        "Without slip, one velocity can be chosen" in page and "That drive has DDOF = 2 and DOF = 3" in page
    )
    assert page.count("Driving: ") == 1 and "2 relations must hold between the rates" in page
    relations = page.partition("of compatibility")[2].partition("```math")[2].partition("```")[0]
    assert relations.count("0 &= ") == 2 and "```math\nT_e = 0.8\n```" in page
    assert "In a curve its wheels skid" in page.partition("## 1 ")[0]
    assert "that a predictive controller integrates (`dynamics`)" in page
    alone = page_written(re.sub("effective_track: .*", "", SKIDDING))
    assert "of ideal rolling (`dynamics`)" in alone
    assert "no wheel slides, so the robot cannot turn: a controller integrates `twist`, below." in alone


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
    assert (re.search(r"\(the tracks?\)", page_of(name)) is not None) == ahead


def test_each_track_is_said() -> None:
    """A figure has the widest one, so that the text must not call another one the track."""
    wheels = "".join(
        f"  - {{name: w{k}, type: swedish, x: {x}, y: {y}, heading: 0, gamma: {'-' * (x * y > 0)}45 deg, r: 0.1}}\n"
        for k, (x, y) in enumerate(((0.3, 0.21), (0.3, -0.21), (-0.2, 0.25), (-0.2, -0.25)))
    )
    page = page_written(f"wmrgen: 1\nname: sample\nwheels:\n{wheels}")
    assert (
        "`w0` and `w1` stand 0.42 m and `w2` and `w3` stand 0.5 m apart (the tracks); their y is the half-track"
        in page
    )


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
    assert ("only where the whole robot stands still" in page_of(name)) == (min(ranks) == 3)


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
    page = page_of(name)
    assert ("inputs u are the rates of driven joints (`posture`)" in page) != lacking
    assert ("the coordinates η (`eta` and `posture`: too few joints are driven" in page) == lacking


@pytest.mark.parametrize("name", ROBOTS)
def test_speeds_of_wheels_beside_their_steering_axis_are_those_at_a_constant_angle(name: str) -> None:
    offset = any(w.kind.steers and w.nominal.o for w in of_gallery(name).robot.wheels)
    assert ("while ψ changes, the rolling row takes another −o ψ̇ / r" in page_of(name)) == offset


@pytest.mark.parametrize("name", ROBOTS)
def test_columns_of_the_null_space_are_called_what_they_are(name: str) -> None:
    """Whether they turn, against N at an angle: a translation has no yaw rate, a rotation has one."""
    columns = of_gallery(name).mobility.null_space
    told = re.findall(r"(?:^|\. )(?:The column|Column \d) is ([^.]*)", page_of(name), re.MULTILINE)
    assert len(told) == len(columns)
    assert [("rotation" in words) for words in told] == [bool(c[2]) for c in columns]
    assert [words == "a rotation about P" for words in told] == [
        bool(c[2]) and not c[0] and not c[1] for c in columns
    ]


@pytest.mark.parametrize("name", ROBOTS)
def test_no_condition_has_a_fraction(name: str) -> None:
    """What is 0, of speeds of wheels and of singular models, is cleared of denominators."""
    assert not [line for line in page_of(name).split("\n") if line.startswith("0 &=") and "frac" in line]


@pytest.mark.parametrize("name", ROBOTS)
def test_a_growth_vector_says_what_it_counts(name: str) -> None:
    m = of_gallery(name).mobility
    counted = re.search(r"one order at a time(.*?): the degree", page_of(name))
    assert not m.ddof or (counted and ("steering angles" in counted[1]) == bool(m.degree_of_steerability))


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
    ("robot", "said", "unsaid"),
    [
        (NAMES, "limits `omega`, too, which is neither a state nor an input of", "neither states"),
        (NAMES, "G is unbounded, because `left.spin` no longer determines the motion:", "`e`d"),
        (NAMES, "`C1` imposes no sliding constraint", "`C₁`"),
        (NAMES, "* The axle lines of `left` and `right` are 0.4 mm apart, within", ". The axle lines"),
        (LETTERS, "\\begin{bmatrix}\n1 \\\\\n0 \\\\\n0\n\\end", "3-100"),  # cleared of 0.03 - r
        (LETTERS, "In formulas of this robot `r` and `d` are these parameters; in equations for any", "`l`"),
        (LETTERS, "In formulas typewriter marks `L` as a parameter.", "Mechanical couplings:\n"),
        (ROOTS, r"-2\,r\;\dot{\varphi}_{\mathrm{omni}}}{0.26\sqrt{3}+a}", "52}"),  # lengths keep their size
        (ROOTS, "`a` = 0.41 and `r` = 0.05, constant in the generated code.\n", "In formulas"),
        (STUCK, "inputs u are components of the twist (`twist`). `twist` is the state space", "(`eta`)"),
        (STUCK, "## 9 Singular configurations", "In the textbooks"),
        (LOCKED, "`slip` is the norm of z − H ξ [m/s].", r"\mathrm{slip} = \sqrt{{"),  # too wide for a page
        (LOCKED, "Without slip nothing moves: DDOF = DOF = 0.", "holonomic, but not"),
        (LOCKED, "a degenerate layout, (0, 0): without slip it cannot move.", "steering adds"),
        (SPINNING, r"\dot{x} &= 0 \\", r"\left(0\right)"),
        (SPINNING, r"\mathrm{slip} = \sqrt{2\left[ v_y^2 + v_x^2 \right]}", "2\\,"),
        (PARALLEL, "3 relations must hold", "of compatibility"),  # they hold straight ahead alone
        (PARALLEL, "0 & 1 & 0.5 \\\\\n1 & 0 & 0.3", r"0 & 1 & \frac{1}{2} \\[4pt]" + "\n1 & 0"),
        (
            OMNI,
            "two independent motions of the body turn no wheel, so the wheels cannot drive them",
            "one motion of",
        ),
        (
            CHAIN,
            r"\mathrm{slip} = \sqrt{2\,\left(v_y-\frac{\omega}{2}\right)^2 + \sum \varepsilon^2}",
            "square of",
        ),
        (SIDES, "`a` and `b` turn at one speed; `c` and `e` turn at one speed.", "of their single"),
        (LIMITED, "`slip` [m/s] is made of the sliding speed", "`slip` is |"),
        (LIMITED, "across `front` where a limit keeps it from the heading that rolls:", "a bar being"),
        (LIMITED, r"\mathrm{slip} = \sqrt{v_y^2 + v_\perp^2}", "is added to"),
        (OMNI, "with three degrees of freedom.", "steering adds"),
        (TILTED, r"\frac{\tan g\;v_x-v_y-0.2\;\omega}{0.05}", r"\left(g\right)"),
        (ROUND, r"\sqrt{3}\,\cos\psi_{\mathrm{a}}-\sin\psi_{\mathrm{a}} &= 0", "are parallel,"),
        (SHIFTED, "Column 2 is a rotation about P where the parameters are nominal.", "about P."),
        (DRIVEN, "`a` and `b` swivel at one rate: they share the least-squares rate", "that need not suit"),
        (APART, "a point that the angles of the castors give.", "steering angles choose"),
        (TANK, "Where wheels may slide sideways, speeds of driven wheels", "\nSpeeds of driven"),
        (
            TANK,
            "In the speed of `a`, with which `b.spin`, `c.spin` and `e.spin` must agree, it is",
            "In the speeds",
        ),
        (POWERED, "As N = I, these are the twist itself, η = ξ.", "scaled as in"),
        (REACH, "L is negative, for it steers behind P:", "front wheel"),
    ],
)
def test_robots_that_few_have(robot: str, said: str, unsaid: str) -> None:
    page = page_written(robot)
    assert said in page and unsaid not in page
