"""What stands in a formula was introduced before, in the named parameters, without what does not occur."""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np
import pytest

from tests.report.sections.common import (
    keyed_page_of,
    keyed_page_written,
    page_of,
    page_written,
    sentence,
)
from tests.report.sections.reading import formulas, lengths_in_formulas, read
from tests.robots import ROBOTS, of_gallery
from wmrgen.geometry import notation
from wmrgen.geometry.exact.number import Exact
from wmrgen.report.sections.markdown import keys


def printed(page: str, name: str, values: dict[str, float]) -> np.ndarray:
    """The matrix that follows ``name =`` in numbers."""
    body = re.search(
        rf"(?<!\\det\(){re.escape(name)} =\s*\\begin{{bmatrix}}(.*?)\\end{{bmatrix}}", page, re.DOTALL
    )
    assert body, name
    rows = re.split(r"\\\\(?:\[4pt\])?", body[1])
    return np.array([[read(entry, values) for entry in row.split("&")] for row in rows])


@pytest.mark.parametrize("name", ROBOTS)
def test_the_normal_matrix_is_that_of_h(name: str) -> None:
    """H as printed gives H^T H as printed; no entry is a decimal where lengths have names."""
    page, robot = page_of(name).partition("## 7 ")[2], of_gallery(name).robot
    if "H = \\begin" not in page or "H^T H =" not in page:
        return
    values = lengths_in_formulas(robot)
    h, normal = printed(page, r"\qquad H", values), printed(page, "H^T H", values)
    assert normal == pytest.approx(h.T @ h, rel=1e-5, abs=1e-9)


INVERSES = {"H^{-1}": "H", "(H^T H)^{-1}": "H^T H", "(H^T H)^{-1} H^T": "H"}


@pytest.mark.parametrize("name", ROBOTS)
def test_inverses_are_inverses_of_the_matrices_as_printed(name: str) -> None:
    """A printed inverse times the printed matrix is 1; a number in front of a matrix counts."""
    page, robot = page_of(name).partition("\n## 7 ")[2].partition("\n## ")[0], of_gallery(name).robot
    values = lengths_in_formulas(robot)
    for head, of in INVERSES.items():
        factor = re.search(rf"(?<!\^){re.escape(head)} =\s*(\\frac{{1}}.*?)?\\begin", page)
        if factor is None:
            continue
        scale = read(factor[1], values) if factor[1] else 1.0
        inverse = scale * printed(page.replace(factor[1] or "\0", ""), head, values)
        assert inverse @ printed(page, rf"\qquad {of}", values) == pytest.approx(np.eye(3), abs=1e-5)


def test_which_inverses_are_written_out() -> None:
    """A differential drive, mecanum wheels, a tricycle with a common denominator, two steered wheels."""
    for name, head in (("pioneer3dx", "H^{-1}"), ("kuka_youbot", "(H^T H)^{-1}"),
                       ("textbook_tricycle", "(H^T H)^{-1}"), ("textbook_two_steer", "(H^T H)^{-1} H^T")):  # fmt: skip
        assert f"{head} = \\" in page_of(name).partition("\n## 7 ")[2], name


@pytest.mark.parametrize(
    ("name", "entry"),
    [
        ("kuka_youbot", r"2\,{\left(l_{x}+l_{y}\right)}^{2}"),
        ("synchro_drive", r"3\,{l}^{2}"),
        ("clearpath_a200", r"{\mathit{track}}^{2}+{\mathit{wheelbase}}^{2}"),
    ],
)
def test_the_normal_matrix_has_names(name: str, entry: str) -> None:
    assert f"0 & 0 & {entry}\n" in page_of(name)


@pytest.mark.parametrize(
    ("name", "condition", "angles"),
    [
        ("kelly_4ws", r"{track}\,\sin{w4}+{base}\,\cos{w4} &= 0", ("-59.0362", "120.9638")),
        ("wpilib_swervebot", r"\cos{back\_right}+\sin{back\_right} &= 0", ("-45", "135")),
    ],
)
def test_singular_configurations_have_names(name: str, condition: str, angles: tuple[str, str]) -> None:
    """Lengths that the robot file names, none that all terms have, and the angles to four decimals."""
    page = page_of(name).partition("## 9 ")[2]
    condition = re.sub(r"(?<=[sn]){(.*?)}", r"\\psi_{\\mathrm{\1}}", condition)
    for short in ("track", "base"):
        condition = condition.replace(
            f"{{{short}}}", rf"\mathit{{half\_{'wheel' * (short == 'base')}{short}}}"
        )
    low, high = angles
    assert condition in page and rf"{low}^{{\circ}}\;\mathrm{{or}}\;{high}^{{\circ}}" in page


@pytest.mark.parametrize("name", ROBOTS)
def test_where_a_form_does_not_hold(name: str) -> None:
    """G is introduced before it is unbounded, conditions are formulas, and each form is told of."""
    page = keyed_page_of(name).partition("## 8 ")[2].partition("## 9 ")[0]
    if "model.forms" not in keys(page):
        return
    assert page.index("q̇ = G(q) u") < page.find("G is unbounded") or "G is unbounded" not in page
    told = []
    for key in ("model.singular", "model.singular_elsewhere", "model.always_holds", "model.while_sliding"):
        for said in re.findall(rf"\0{key}\0([^\n\0]*)", page):  # the forms that a sentence begins with
            told += re.findall(r"\w+", re.match(r"(?:`\w+`(?:, | and )?)+", said)[0].replace(" and ", " "))
    head = page.partition("\0model.forms\0")[2].partition("\0model.state_space\0")[0]
    introduced = re.findall(r"`(posture|twist|eta)`", head)
    assert introduced and set(introduced) == set(told)
    shared = sum(s.kind == "shared_axle" for s in of_gallery(name).mobility.singularities)
    assert keys(page).count("model.singular_elsewhere") == shared
    for formula in re.findall(r"\0model\.singular\0[^\n]*:\n\n```math\n(.*?)```", page, re.DOTALL):
        assert (
            "\\psi" in formula and "0 &= " in formula and "_steer" not in formula and ".steer" not in formula
        )


@pytest.mark.parametrize("name", ROBOTS)
def test_what_has_a_star_is_introduced(name: str) -> None:
    """In the result, of wheels that steer too, before it is used."""
    result = page_of(name).partition("## The result")[2].partition("**Forward")[0]
    for star in ("v_x^{*}", "v_y^{*}", r"\omega^{*}"):
        assert star not in result or result.index(f"{star} &=") == result.index(star)
    assert name != "f1tenth" or r"v_y^{*} &= l_{r}\;\omega" in result


def test_virtual_wheels_are_introduced() -> None:
    page = keyed_page_of("car_with_trailers")
    front, rear = sentence(page, "layout.virtual").split(";")
    assert re.findall(r"`(\w+)`", front) == ["front", "front_left", "front_right"] and "(1.4, 0)" in front
    assert re.findall(r"`(\w+)`", rear) == ["rear", "rear_left", "rear_right"] and "(0, 0)" in rear
    assert "`rear`" in sentence(page, "motion.in_wheel_speeds")
    assert "`front`" in sentence(page, "motion.steering_state")
    assert "irtual" not in page_of("tractor_off_axle")


def test_a_trailer_is_seen_from_what_pulls_it() -> None:
    """Whatever the names: sin(heading ahead - its own), as the texts write it (Tzafestas (2.70))."""
    for first, second in (("a", "z"), ("z", "a")):
        page = page_written(
            f"wmrgen: 1\nname: sample\ntrailers: [{{name: {first}, length: 0.9}}, {{name: {second}, length: 0.7}}]\n"
            "wheels:\n  - {name: l, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1}\n"
            "  - {name: r, type: fixed, x: 0, y: -0.3, heading: 0, r: 0.1}\n"
        )
        own, behind = (rf"\theta_{{\mathrm{{{n}}}}}" for n in (first, second))
        assert rf"\sin\left(\theta-{own}\right)" in page and rf"\sin\left({own}-{behind}\right)" in page


def test_a_contact_moves_as_its_wheels_can() -> None:
    """Offsets and trails stand in the velocity of contacts of robots that have them."""
    for name, velocity in (
        ("agilex_ranger", "r φ̇ e, with"),
        ("pr2", "(r φ̇ + o ψ̇) e, with"),
        ("nomad_xr4000", "r φ̇ e − d ψ̇ n, with"),
    ):
        assert f"v + ω ẑ × B = {velocity}" in page_of(name)


def test_a_wheel_alone_is_one() -> None:
    page = page_of("f1tenth")
    assert "**Steered wheel** (`front`)" in page and "**Fixed wheel** (`rear`)" in page
    assert "\n`rear` " in page  # a sentence about one wheel, in the singular
    assert re.search(r">rear \w", of_gallery("f1tenth").figures["singular.svg"][1])
    assert "**Fixed wheels** (`left` and `right`)" in page_of("tractor_off_axle")


def test_coupled_wheels_have_one_angle() -> None:
    """Speeds of wheels that turn and steer together are equal, whatever the angle; their slip has no root."""
    page = page_of("synchro_drive")
    assert r"0 &= \dot{\varphi}_{\mathrm{w1}}-\dot{\varphi}_{\mathrm{w2}} " in page
    assert r"\mathrm{slip} = \left|\sqrt{3}\,l\;\omega\right|" in page and r"\sqrt{{l}" not in page


@pytest.mark.parametrize("name", ["care_o_bot_4", "kelly_4ws", "textbook_two_steer", "wpilib_swervebot"])
def test_the_twist_of_eta_is_that_of_dynamics(name: str) -> None:
    """In named lengths, with sines of sums of angles."""
    d = of_gallery(name)
    text = (
        keyed_page_of(name)
        .partition("\0motion.twist_of_eta\0")[2]
        .partition("```math")[2]
        .partition("```")[0]
    )
    shown = dict(formulas(text))
    inputs = [p.name for p in d.program.formula("dynamics").inputs]
    values = {n: 0.0 if n == "theta" else 0.2 + 0.3 * k for k, n in enumerate(inputs)}
    rates = d.evaluate("dynamics", {n: Exact(Fraction(v)) for n, v in values.items()})
    known = lengths_in_formulas(d.robot)
    known |= {notation.port(n): v for n, v in values.items()}
    for port, rate in (("vx", "x_rate"), ("vy", "y_rate"), ("omega", "theta_rate")):
        assert read(shown[notation.port(port)], known) == pytest.approx(
            float(rates[rate]), rel=1e-5, abs=1e-9
        )
    assert name != "wpilib_swervebot" or shown[r"\omega"].startswith(
        r"\frac{\sin\left(\psi_{\mathrm{front\_left}}-"
    )


def test_angles_of_wheels_that_follow_are_symbols() -> None:
    """Of two wheels with one steering motor the model has one angle, and no condition that asks for two."""
    page = keyed_page_written(
        "wmrgen: 1\nname: sample\nwheels:\n"
        "  - {name: a, type: steered, x: 0.04, y: -0.49, heading: 0.08, r: 0.2, actuated: [steer]}\n"
        "  - {name: b, type: steered, x: 0.63, y: -0.63, heading: -1.56, r: 0.1}\n"
        "  - {name: o, type: swedish, x: 0.58, y: -0.76, heading: 0, gamma: -pi/4, r: 0.03}\n"
        "couplings: [{equal: [a.steer, b.steer]}]\n"
    )
    assert sentence(page, "model.always_holds").startswith("`twist` and `eta` ")
    assert r"\psi_{\mathrm{b}}" not in page.partition("## 8 ")[2]
    assert not re.search(r"\\(?:cos|sin|tan)[a-z]", page)
