"""The example in boxes: rows, ranks, rates, measurements and pose, against the oracle and velocities of this file."""

from __future__ import annotations

import cmath
import re
from math import radians

import numpy as np
import pytest

from tests.oracle import oracle
from tests.oracle.robot_file import read
from tests.report.sections.common import page_of, page_written
from tests.robots import ROBOTS, of_gallery

NUMBER = r"(−?\d+(?:\.\d+)?(?:e[−+]?\d+)?)"


def boxes(name: str) -> dict[str, str]:
    """The box of each section, by the number of the section."""
    found = {}
    for part in re.split(r"\n## (?=\d)", page_of(name))[1:]:
        quoted = re.findall(r"(?m)^> (.*?) *$", part)
        if quoted:
            found[part.split()[0]] = "\n".join(quoted)
    return found


def number(text: str) -> float:
    return float(text.replace("−", "-"))


def twist_in(text: str) -> list[float]:
    (shown,) = re.findall(r"(?<!₁ )ξ = \((.*?)\)", text)
    return [number(n) for n in shown.split(", ")]


def value(text: str) -> float:
    """The value of products and quotients with sums, without brackets inside each other."""
    plain = text.replace("−", "-").replace(" ", "")
    total = 0.0
    for sign, summand in re.findall(r"([+-]?)((?:\(-?[\d.e]+\)|[\d.]+(?:e-?\d+)?|[·/])+)", plain):
        product = 1.0
        for operator, factor in re.findall(r"([·/]?)\(?(-?[\d.]+(?:e-?\d+)?)\)?", summand):
            product = product / float(factor) if operator == "/" else product * float(factor)
        total += -product if sign == "-" else product
    return total


@pytest.mark.parametrize("name", ROBOTS)
def test_one_example_runs_through_all_sections(name: str) -> None:
    """Every robot that drives has boxes in sections 3, 6 and 8; both sides of every equation in numbers are equal."""
    found = boxes(name)
    assert found.keys() <= set("23456789") and ({"3", "6", "8"} <= found.keys()) == (name != "office_chair")
    d = of_gallery(name)
    if found:
        assert ("4" in found) == (0 < d.mobility.degree_of_mobility < 3)
        several = d.mobility.degree_of_maneuverability > 2  # the robot can then turn about a steered wheel
        assert ("9" in found) >= (several and any(w.kind.steers for w in d.robot.wheels))
    twists = {tuple(twist_in(text)) for section, text in found.items() if section in "2346"}
    assert len(twists) <= 1
    sums = rf"((?:{NUMBER}|[·+/() −])+) = {NUMBER}"
    checked = 0
    for text in found.values():
        sums_only = text.partition("compatibility: ")[
            0
        ]  # its own test knows how far the digits of a sum of 0 go
        for expression, *_, shown in re.findall(sums, sums_only):
            if re.search(r"[·/]", expression):
                assert value(expression) == pytest.approx(number(shown), rel=2e-5, abs=2e-6), (
                    name,
                    expression,
                )
                checked += 1
    assert checked >= 2 or name == "office_chair"


@pytest.mark.parametrize("name", ROBOTS)
def test_rows_and_rates_are_velocities_of_wheels(name: str) -> None:
    found, d = boxes(name), of_gallery(name)
    if "2" not in found:
        return
    vx, vy, omega = twist_in(found["2"])
    angles = {n: radians(number(psi)) for n, psi in re.findall(rf"`(\w+)`: .*?ψ = {NUMBER}°", found["6"])}
    lines = re.findall(r"(?m)^`(\w+)`: rolling (.*?)(?:; sliding (.*))?\.$", found["2"])
    assert lines
    for wheel, rolling, sliding in lines:
        w = d.robot.wheel(wheel)
        at_wheel = complex(vx, vy) + 1j * omega * complex(float(w.nominal.x), float(w.nominal.y))
        heading = w.heading + angles.get(wheel, 0.0) + (w.gamma if w.kind.rollers else 0.0)
        along = at_wheel * cmath.exp(-1j * heading)
        offset = float(w.nominal.o) * omega
        assert number(rolling.rpartition("= ")[2]) == pytest.approx(along.real - offset, rel=1e-4, abs=1e-5)
        if sliding:
            assert number(sliding.rpartition("= ")[2]) == pytest.approx(along.imag, abs=1e-5)
    for wheel, rate in re.findall(rf"`(\w+)`: .*?φ̇ = (?:.*? = )?{NUMBER} rad/s", found["6"]):
        said = re.search(rf"\b{wheel}\.spin ?= ?(-?[\d.]+)", page_of(name))
        assert said and number(rate) == pytest.approx(float(said[1]), rel=1e-5)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_pose_is_that_of_the_result(name: str) -> None:
    found = boxes(name)
    if "8" not in found:
        return
    vx, vy, omega = twist_in(found["6"])
    x, y, theta = (number(re.findall(rf"{letter}' = (?:.* = )?{NUMBER}", found["8"])[0]) for letter in "xyθ")
    steps = 200_000
    moved = sum(cmath.exp(1j * omega * (k + 0.5) / steps) for k in range(steps)) * complex(vx, vy) / steps
    assert complex(x, y) == pytest.approx(moved, abs=2e-6) and theta == pytest.approx(omega)


def test_the_residual_of_a_twist_that_is_measured_is_0() -> None:
    assert all("is 0." in boxes(name)["7"] for name in ("pioneer3dx", "wpilib_swervebot", "ackermann_car"))


def vectors(text: str) -> list[list[float]]:
    """Every vector of a text that is written out in full."""
    return [[number(n) for n in v.split(", ")] for v in re.findall(r"\(((?:[−\d.e]+, )+[−\d.e]+)\)", text)]


DRIVEN = tuple(name for name in ROBOTS if name != "office_chair")


@pytest.mark.parametrize("name", DRIVEN)
def test_matrices_in_numbers_are_those_of_the_oracle(name: str) -> None:
    """Rows of C1 at the steering angles of the twist, speeds of wheels, the null space and ranks."""
    layout, found = read(ROBOTS[name]), boxes(name)
    twist = np.array(twist_in(found["3"]))
    angles = {w["name"]: oracle.steering(w, twist, 0.0) for w in layout["wheels"] if w["type"] == "steered"}
    for psi, wheel in re.findall(rf"{NUMBER}° \(`(\w+)`\)", found["3"]):
        assert number(psi) == pytest.approx(np.degrees(angles[wheel]), abs=6e-4)
    sliding = np.vstack([oracle.sliding_rows(layout, kind, angles) for kind in ("fixed", "steered")])
    first, _, second = found["3"].rpartition("\n")
    shown = vectors(first.partition("C₁ has")[2])
    assert bool(shown) == bool(len(sliding)) == ("C₁ ξ = 0" in second)
    for row in shown:
        digits = 7e-6 * max(1.0, np.abs(sliding).max())  # six digits of entries, and of angles
        assert np.abs(sliding - row).max(axis=1).min() < digits
    rolling = []
    for w in layout["wheels"]:
        rows = oracle.wheel_rows(w, angles.get(w["name"], 0.0))
        rolling += [row @ twist for kind, row, *_ in rows if kind == "rolling"]
    speeds = [number(n) for n in re.findall(NUMBER, second.partition("J₁ ξ = ")[2].partition(" m/s")[0])]
    assert len(speeds) == min(len(rolling), 6) and speeds == pytest.approx(rolling[:6], abs=6e-5)
    if "C₁ = " in found.get("5", ""):
        assert int(found["5"].partition("rank C₁ = ")[2][0]) == oracle.rank(sliding, 1e-4)


@pytest.mark.parametrize("name", DRIVEN)
def test_the_twist_is_a_combination_of_the_null_space(name: str) -> None:
    layout, found = read(ROBOTS[name]), boxes(name)
    if "4" not in found:
        return
    columns, last = found["4"].splitlines()
    combination, _, centre = last.partition(" The ICR")
    twist = np.array(twist_in(found["4"]))
    basis = np.array(vectors(columns))
    angles = {w["name"]: oracle.steering(w, twist, 0.0) for w in layout["wheels"] if w["type"] == "steered"}
    free = oracle.null(oracle.constraint(layout, angles), 1e-4)
    assert basis.shape == free.shape[::-1]
    assert basis - basis @ free @ free.T == pytest.approx(0 * basis, abs=2e-5 * np.abs(basis).max())
    eta = [number(n) for n in re.findall(NUMBER, combination.partition("η = ")[2].rstrip("."))]
    assert np.array(eta) @ basis == pytest.approx(twist, abs=1e-5)
    assert bool(centre) == (len(eta) == 1 and bool(twist[2]))
    for point in vectors(centre):
        assert oracle.point_velocity(np.array(point), twist) == pytest.approx([0, 0], abs=1e-4)


@pytest.mark.parametrize("name", DRIVEN)
def test_rates_are_compatible_and_pivots_move(name: str) -> None:
    layout, found = read(ROBOTS[name]), boxes(name)
    for text in re.findall(r"compatibility: (.*) = 0\.", found.get("5", "")):
        spins = re.findall(r"\.spin ?= ?(-?[\d.]+)", page_of(name))
        largest = max(abs(value(product)) for product in re.split(r" [+−] ", text))
        assert value(text) == pytest.approx(0, abs=2e-5 * largest)  # six digits of each factor
        shown = {round(abs(number(n)), 3) for n in re.findall(NUMBER, text)}
        assert len({round(abs(float(spin)), 3) for spin in spins} & shown) >= 1
    pivots = {w["name"]: np.array([w["x"], w["y"]]) for w in layout["wheels"]}
    twist = np.array(twist_in(found["3"]))
    speeds = {wheel: np.hypot(*oracle.point_velocity(p, twist)) for wheel, p in pivots.items()}
    shown = re.findall(rf"`(\w+)`: \|v<sub>A</sub>\| = {NUMBER} m/s", found.get("9", ""))
    for wheel, speed in shown:
        assert number(speed) == pytest.approx(speeds[wheel], abs=1e-6)
        steered = [w["name"] for w in layout["wheels"] if w["type"] == "steered"]
        assert speeds[wheel] <= min(speeds[w] for w in steered) + 1e-6
    assert len(shown) == found.get("9", "").count("|v<sub>A</sub>|")


def test_a_steered_wheel_without_a_drive_points_along_its_velocity() -> None:
    wheels = "".join(
        f"  - {{name: {name}, type: {kind}, x: {x}, y: {y}, heading: 0, r: 0.1{more}}}\n"
        for name, kind, x, y, more in (
            ("left", "fixed", 0, 0.2, ""),
            ("right", "fixed", 0, -0.2, ""),
            ("front", "steered", 0.5, 0, ", actuated: []"),
        )
    )
    page = page_written(f"wmrgen: 1\nname: sample\nwheels:\n{wheels}")
    vx, _, omega = twist_in(page.partition("is the example twist")[0].rpartition("**Example.** ")[2])
    (angle,) = re.findall(rf"At ψ = {NUMBER}° \(`front`\)", page)
    assert radians(number(angle)) == pytest.approx(np.arctan2(0.5 * omega, vx), abs=1e-5)
