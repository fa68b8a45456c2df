"""The example in boxes: rows, rates, measurements and pose, each against velocities of this file."""

from __future__ import annotations

import cmath
import re
from math import radians

import pytest

from tests.report.sections.common import page_of
from tests.robots import ROBOTS, of_gallery

NUMBER = r"(−?[\d.]+(?:e[−+]?\d+)?)"


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
    (shown,) = re.findall(r"ξ = \((.*?)\)", text)
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
    """Every robot that drives has boxes in sections 6 and 8; both sides of every equation in numbers are equal."""
    found = boxes(name)
    assert found.keys() <= {"2", "6", "7", "8"} and ({"6", "8"} <= found.keys()) == (name != "office_chair")
    twists = {tuple(twist_in(text)) for section, text in found.items() if section in "26"}
    assert len(twists) <= 1
    sums = rf"((?:{NUMBER}|[·+/() −])+) = {NUMBER}"
    checked = 0
    for text in found.values():
        for expression, *_, shown in re.findall(sums, text):
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
    lines = re.findall(r"(?m)^`(\w+)`: rolling (.*?)(?:; sliding (.*))?$", found["2"])
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
