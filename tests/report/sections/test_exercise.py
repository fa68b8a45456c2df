"""Exercises: the solution against the numbers of the statement, computed here from the layout table alone."""

from __future__ import annotations

import cmath
import re
from functools import cache
from math import cos, degrees, pi, radians
from typing import NamedTuple

import numpy as np
import pytest

from tests.report.pages.katex import mistakes
from tests.report.sections.test_boxes import NUMBER, number, value
from tests.robots import ROBOTS, of_gallery, of_text
from wmrgen.errors import UsageError
from wmrgen.report.sections.exercise import BLANK, exercise, exercise_motions
from wmrgen.report.sections.markdown import page

pytestmark = pytest.mark.slow

CHECKED = (
    "textbook_differential", "pioneer3dx", "unicycle", "textbook_omnidirectional", "textbook_tribolo", "lekiwi",
    "bicycle", "textbook_two_steer", "ackermann_car", "wpilib_swervebot", "kuka_youbot", "nexus_4wd",
)  # fmt: skip
SEEDS = (0, 7)
BLANKS = re.compile(rf"{BLANK}|\\ldots")
DIGITS = 2e-5  # relative: the statement and the solution are rounded to six significant digits


@cache
def text_of(name: str, seed: int, solved: bool) -> str:
    return page(exercise(of_gallery(name), seed, solved))


class Wheel(NamedTuple):
    """A wheel as the statement describes it, at its steering angle."""

    name: str
    kind: str
    x: float
    y: float
    heading: float  # rad
    gamma: float  # rad
    r: float
    d: float

    @property
    def rolling(self) -> list[float]:
        e = cmath.exp(1j * (self.heading + self.gamma))
        return [e.real, e.imag, self.x * e.imag - self.y * e.real]

    @property
    def sliding(self) -> list[float]:
        n = 1j * cmath.exp(1j * self.heading)
        return [n.real, n.imag, self.x * n.imag - self.y * n.real + self.d]


def wheels_in(statement: str) -> list[Wheel]:
    table = re.findall(r"(?m)^\| (.*) \|$", statement.partition("## 1 ")[2].partition("## 2 ")[0])
    head, _, *rows = [line.split(" | ") for line in table]
    angles = {n: radians(number(psi)) for n, psi in re.findall(rf"\* `(\w+)`: ψ = {NUMBER}°", statement)}
    wheels = []
    for row in rows:
        cells = dict(zip(head, row, strict=True))
        if cells["heading"] == "—":
            continue  # a ball that is not driven has no rows
        name = cells["wheel"].strip("`")
        x, y, r, d = (0.0 if cells.get(k, "—") == "—" else number(cells[k]) for k in ("x", "y", "r", "d"))
        heading, gamma = (radians(number(cells.get(k, "0°").rstrip("°"))) for k in ("heading", "γ"))
        wheels.append(Wheel(name, cells["type"], x, y, heading + angles.get(name, 0.0), gamma, r, d))
    return wheels


def twist_in(text: str) -> np.ndarray:
    return np.array([number(n) for n in re.findall(r"ξ = \(([^v]*?)\)", text)[0].split(", ")])


def section(text: str, k: int) -> str:
    return text.partition(f"\n## {k} ")[2].partition("\n## ")[0]


def matrix_in(text: str, name: str) -> np.ndarray:
    body = re.findall(rf"{name} = \\begin{{bmatrix}}\n(.*?)\n\\end", text, re.DOTALL)
    rows = body[0].split(r" \\" + "\n") if body else []
    return np.array([[float(entry) for entry in row.split(" & ")] for row in rows]).reshape(-1, 3)


def constraining(wheels: list[Wheel]) -> list[Wheel]:
    """The wheels with a row of C1, in its order."""
    return [w for kind in ("fixed", "steered") for w in wheels if w.kind == kind]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", CHECKED)
def test_matrices_and_degrees(name: str, seed: int) -> None:
    wheels, solution = wheels_in(text_of(name, seed, False)), text_of(name, seed, True)
    own, mobility = section(solution, 4), section(solution, 5)
    np.testing.assert_allclose(matrix_in(own, "J_1"), [w.rolling for w in wheels], rtol=DIGITS, atol=2e-6)
    radii = [float(r) for r in re.findall(r"diag}\\left\((.*?)\\right", own)[0].split(", ")]
    np.testing.assert_allclose(radii, [w.r * cos(w.gamma) for w in wheels], rtol=DIGITS)
    c1 = np.array([w.sliding for w in constraining(wheels)]).reshape(-1, 3)
    np.testing.assert_allclose(matrix_in(own, "C_1"), c1, rtol=DIGITS, atol=2e-6)
    fixed = np.array([w.sliding for w in wheels if w.kind == "fixed"]).reshape(-1, 3)
    ranks = [int(np.linalg.matrix_rank(rows, tol=1e-4)) if len(rows) else 0 for rows in (fixed, c1)]
    assert [int(r) for r in re.findall(r"C_\{?1f?\}? = (\d)[,\n]", mobility)] == ranks
    shown = [int(n) for n in re.findall(r"\\delta_[msM] &= .* = (\d) &&", mobility)]
    assert shown == [3 - ranks[1], ranks[1] - ranks[0], 3 - ranks[0]]
    assert ("Omnidirectional: yes." in mobility) == (ranks[1] == 0)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", CHECKED)
def test_rates(name: str, seed: int) -> None:
    statement, solution = text_of(name, seed, False), text_of(name, seed, True)
    wheels, twist = {w.name: w for w in wheels_in(statement)}, twist_in(statement)
    rows = re.findall(r"(?m)^\| `(\w+)` \| (rolling|sliding) \| (.*?) \| (.*?) \|$", section(solution, 6))
    kinds = {w: [kind for own, kind, *_ in rows if own == w] for w in wheels}
    assert all(
        k == (["rolling"] if wheels[w].kind in ("Swedish", "driven ball") else ["rolling", "sliding"])
        for w, k in kinds.items()
    )
    for wheel, kind, shown, rate in rows:
        w = wheels[wheel]
        speed = float(np.dot(w.rolling if kind == "rolling" else w.sliding, twist))
        expression, _, result = shown.rpartition("= ")
        assert number(result) == pytest.approx(speed, rel=DIGITS, abs=1e-5)
        assert value(expression or result) == pytest.approx(speed, rel=DIGITS, abs=1e-5)
        if kind == "sliding" and w.kind != "castor":
            assert speed == pytest.approx(0, abs=1e-5) and rate == "—"
        else:
            expected = speed / (w.r * cos(w.gamma)) if kind == "rolling" else -speed / w.d
            (found,) = re.findall(rf"= {NUMBER} rad/s", rate)
            assert number(found) == pytest.approx(expected, rel=5e-5, abs=1e-4)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", CHECKED)
def test_the_wrong_encoder(name: str, seed: int) -> None:
    statement, solution = text_of(name, seed, False), text_of(name, seed, True)
    wheels, twist = wheels_in(statement), twist_in(statement)
    question = section(statement, 7)
    (wrong, error) = re.findall(rf"encoder of `(\w+)` shows {NUMBER} rad/s", question)[0]
    measured = re.findall(r"`(\w+)\.spin`", question)
    assert wrong in measured
    rows, z = [], []
    for w in wheels:
        if w.name in measured:
            rows.append(w.rolling)
            rate = float(np.dot(w.rolling, twist))
            z.append(rate + (number(error) * w.r * cos(w.gamma) if w.name == wrong else 0.0))
    for w in constraining(wheels):
        rows.append(w.sliding)
        z.append(0.0)
    found = np.linalg.lstsq(np.array(rows), np.array(z), rcond=1e-5)[0]
    residual = float(np.linalg.norm(np.array(z) - np.array(rows) @ found))
    answer = section(solution, 7)
    np.testing.assert_allclose(twist_in(answer), found, rtol=1e-4, atol=2e-5)
    assert number(re.findall(rf"H ξ\| = {NUMBER} m/s", answer)[0]) == pytest.approx(
        residual, rel=1e-4, abs=1e-5
    )


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", CHECKED)
def test_the_pose(name: str, seed: int) -> None:
    vx, vy, omega = twist_in(text_of(name, seed, False))
    answer = section(text_of(name, seed, True), 8)
    assert omega, "exercises of these robots turn"
    (seconds,) = (number(n) for n in re.findall(rf"Δt = {NUMBER} s", answer))
    assert seconds * abs(omega) == pytest.approx(pi / 2, rel=DIGITS)
    steps = 100_000
    dt = pi / 2 / abs(omega) / steps
    moved = sum(cmath.exp(1j * omega * (k + 0.5) * dt) for k in range(steps)) * complex(vx, vy) * dt
    x, y = (number(re.findall(rf"{letter} = {NUMBER} m", answer)[0]) for letter in "xy")
    assert complex(x, y) == pytest.approx(moved, rel=DIGITS, abs=1e-6)
    theta = number(re.findall(rf"θ = {NUMBER}°", answer)[0])
    assert theta == pytest.approx(degrees(omega * seconds), rel=DIGITS)
    centre = [number(n) for n in re.findall(r"ICR = \((.*?)\) m", answer)[0].split(", ")]
    # The velocity of the point of the body at the centre is 0.
    assert vx - omega * centre[1] == pytest.approx(0, abs=1e-5)
    assert vy + omega * centre[0] == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_statement_is_the_solution_with_blanks(name: str) -> None:
    """The text between the blanks is that of the solution, and no rate, pose or residual is in it."""
    statement, solution = text_of(name, 7, False), text_of(name, 7, True)
    assert not BLANKS.search(solution)
    pieces = BLANKS.split(statement.partition("\n")[2])
    assert len(pieces) > 10
    pattern = "(.+?)".join(map(re.escape, pieces))
    assert re.fullmatch(pattern, solution.partition("\n")[2], re.DOTALL)
    for k in range(3, 9):
        given = re.findall(r"[=|·] *-?−?\d", section(statement, k).replace("C₁ ξ = 0 (3.26)", ""))
        assert not given, "a number after an equals sign is a result"
    results = re.findall(r"[φψ]̇ = −?(\d+\.\d{4,}) rad/s", solution)
    assert not [n for n in results if n in section(statement, 1) + section(statement, 2)]


@pytest.mark.parametrize("name", ["pioneer3dx", "textbook_omnidirectional", "bicycle", "kuka_youbot"])
def test_seeds_give_different_motions(name: str) -> None:
    seeds = [*range(5), 7, 47]
    motions = {section(text_of(name, seed, False), 2) for seed in seeds}
    assert len(motions) == len(seeds)


@pytest.mark.parametrize("name", ROBOTS)
def test_seeds_are_no_mirror_images(name: str) -> None:
    """The twists of seeds 1 to 20 differ in more than signs."""
    motions = exercise_motions(of_gallery(name).driven)
    twists = {tuple(abs(float(v)) for v in motion.twist.values()) for motion in motions[1:21]}
    assert len(twists) == 20


@pytest.mark.parametrize("name", ROBOTS)
def test_the_layout_says_nothing_about_code(name: str) -> None:
    assert "code" not in section(text_of(name, 1, False), 1)


@pytest.mark.parametrize("name", ["pioneer3dx", "textbook_omnidirectional", "bicycle", "kuka_youbot"])
def test_the_numbers_of_the_motion_are_short(name: str) -> None:
    for seed in range(8):
        given = section(text_of(name, seed, False), 2)
        functions = re.findall(rf"(?:cos|sin) ψ = {NUMBER}", given)
        assert all(len(n.lstrip("−")) <= 4 for n in functions)
        assert all(len(f"{abs(v):.9g}") <= 6 for v in twist_in(given))


def test_formulas_parse() -> None:
    fence = re.compile(r"```math\n(.*?)\n```", re.DOTALL)
    texts = [text_of(name, 7, solved) for name in ROBOTS for solved in (False, True)]
    assert mistakes([formula for text in texts for formula in fence.findall(text)]) == []


def test_a_robot_that_cannot_move_has_no_exercise() -> None:
    wheels = "".join(
        f"  - {{name: w{k}, type: fixed, x: {x}, y: {y}, heading: {h} deg, r: 0.1}}\n"
        for k, (x, y, h) in enumerate([(0.3, 0.1, 10), (-0.3, 0.2, 50), (0.1, -0.4, 200)])
    )
    with pytest.raises(UsageError):
        exercise(of_text(f"wmrgen: 1\nname: stuck\nwheels:\n{wheels}"), 0, False)


def test_a_robot_that_skids_is_an_exercise_on_its_model() -> None:
    wheels = "".join(
        f"  - {{name: w{k}, type: fixed, x: {x}, y: {y}, heading: 0, r: 0.1}}\n"
        for k, (x, y) in enumerate([(0.3, 0.25), (0.3, -0.25), (-0.1, 0.25), (-0.1, -0.25)])
    )
    d = of_text(f"wmrgen: 1\nname: skids\neffective_track: 0.8\nwheels:\n{wheels}")
    statement, solution = (page(exercise(d, 1, solved)) for solved in (False, True))
    places = re.findall(rf"(?m)^\| `w\d` \| {NUMBER} \| {NUMBER} \|$", section(statement, 1))
    assert [(number(x), number(y)) for x, y in places] == [(0.1, 0.4), (0.1, -0.4)] * 2
    vx, vy, omega = twist_in(statement)
    assert omega and vy == pytest.approx(-0.1 * omega), "the axle does not slide"
    rates = [number(n) for n in re.findall(rf"φ̇ = {NUMBER} rad/s", solution)]
    assert rates == pytest.approx([(vx + side * 0.4 * omega) / 0.1 for side in (-1, 1, -1, 1)], rel=5e-5)
