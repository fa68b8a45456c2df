"""Every formula of the result is the end of a derivation: sections 6 and 7 lead from rows to it."""

from __future__ import annotations

import cmath
import re

import pytest

from tests.report.sections.common import keys_of, page_of, part
from tests.report.sections.reading import read
from tests.robots import ROBOTS, of_gallery

FENCE = re.compile(r"```math\n(.*?)\n```", re.DOTALL)
RESULTS = {"6": ("Inverse", "Forward"), "7": ("Forward", "An example")}


def equations(text: str) -> list[str]:
    """The equations in displayed formulas, in their order. A broken sum is one equation."""
    found = []
    for block in FENCE.findall(text.replace(r"\Bigl", r"\left").replace(r"\Bigr", r"\right")):
        joined = block.replace("\\\\\n&\\qquad ", "")
        for line in re.split(r"\\\\(?:\[4pt\])?\n|, \\qquad ", joined):
            plain = line.replace(r"\begin{aligned}", "").replace(r"\end{aligned}", "").strip()
            if "=" in plain:
                found.append(plain)
    return found


def section(name: str, number: str) -> str:
    return page_of(name).partition(f"\n## {number} ")[2].partition("\n## ")[0]


def derivation(name: str, number: str) -> str:
    """The section up to the first paragraph with a title: limits, couplings, slip, residual."""
    return section(name, number).partition("\n\n**")[0]


@pytest.mark.parametrize("number", RESULTS)
@pytest.mark.parametrize("name", ROBOTS)
def test_every_formula_of_the_result_ends_a_derivation(name: str, number: str) -> None:
    """Values of factors, such as r / 2 = 0.05, are no formulas of the result: their left side has no rate."""
    stated = [
        e
        for e in equations(part(name, *RESULTS[number]))
        if re.match(r"(\\dot|\\tan|v_|v =|\\omega|\\xi)", e)
    ]
    derived = equations(derivation(name, number))
    assert set(stated) <= set(derived), set(stated) - set(derived)
    if stated:
        assert derived[-1] == stated[-1]
        first = min(derived.index(e) for e in stated)
        assert first > 0, "stated, not derived"
    else:
        assert name == "office_chair", "no joint is driven or sensed"


@pytest.mark.parametrize("name", ["pioneer3dx", "kuka_youbot", "ackermann_car", "nomad_xr4000"])
def test_the_velocity_of_a_wheel_along_e_and_n(name: str) -> None:
    """v + ω ẑ × A of random places, by complex numbers: i e is n, and i A is ẑ × A."""
    text = page_of(name).partition("\n## 2 ")[2].partition("\n**")[0].replace(r"\beta(t)", r"\beta")
    text = re.sub(r"(?<!left)\(", r"\\left(", re.sub(r"(?<!right)\)", r"\\right)", text))
    heads = {e.partition(" &=")[0]: e for e in text.split("\n") if "&=" in e}
    for alpha, beta, length in ((0.3, -1.1, 2.0), (-2.0, 0.4, 0.7)):
        values = {r"\alpha": alpha, r"\beta": beta, "l": length}
        place = cmath.rect(length, alpha)
        e = cmath.exp(1j * (alpha + beta - cmath.pi / 2))
        vectors = re.findall(r"= \\left\((.*?), (.*?)\\right\)(?=, &| \\\\)", heads["e"])
        shown = [complex(read(x, values), read(y, values)) for x, y in vectors]
        assert shown == pytest.approx([e, 1j * e])
        for axis, direction in (("e", e), ("n", 1j * e)):
            turning = (1j * place * direction.conjugate()).real
            _, *sides = re.split(
                r"&&?= ", heads[rf"{axis}\cdot\left(\hat{{z}}\times A\right)"].removesuffix(r"\\").strip()
            )
            assert [read(side.strip(), values) for side in sides] == pytest.approx([turning, turning])


def test_terms_of_a_contact_point_off_the_pivot() -> None:
    said = {name: "rows.off_the_pivot" in keys_of(name) for name in ("pioneer3dx", "kelly_4ws", "lekiwi")}
    assert said == {"pioneer3dx": True, "kelly_4ws": True, "lekiwi": False}


@pytest.mark.parametrize("name", ["car_with_trailers", "tractor_off_axle"])
def test_trailers_follow_from_the_sliding_row_of_their_axle(name: str) -> None:
    """The coupling as a complex velocity, seen along and across a trailer; L and h are drawn here."""
    text = section(name, "8")
    lines = [line for line in text.split("\n") if line.startswith(r"\dot{\theta}_i &= ")]
    (line,) = lines
    line = re.sub(r"\(([^()]*)\)", r"\\left(\1\\right)", line)
    shown_turn, shown_speed = line.partition(r"\dot{\theta}_i &= ")[2].split(r", & v_i &= ")
    hitched = "b_i" in line
    assert hitched == any(t.hitch.nominal for t in of_gallery(name).robot.trailers)
    front, own, speed, turn, hitch, length = 0.7, 0.2, 1.3, -0.4, 0.25 if hitched else 0.0, 1.1
    values = {r"\theta_{i-1}": front, r"\theta_i": own, "v_{i-1}": speed, r"\dot{\theta}_{i-1}": turn}
    values |= {"b_i": hitch, "L_i": length}
    coupling = (speed - 1j * hitch * turn) * cmath.exp(1j * front)
    seen = coupling * cmath.exp(-1j * own)
    assert read(shown_turn, values) == pytest.approx(seen.imag / length)
    assert read(shown_speed, values) == pytest.approx(seen.real)
    axle = coupling - 1j * length * read(shown_turn, values) * cmath.exp(1j * own)
    assert (axle * cmath.exp(-1j * own)).imag == pytest.approx(0)
