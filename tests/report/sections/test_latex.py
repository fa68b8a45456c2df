"""Formulas of the report: LaTeX has the value of what it shows, and collects as one would by hand."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from typing import get_args

import pytest
import sympy

from tests.report.sections.reading import read
from wmrgen.geometry import notation
from wmrgen.geometry.exact.evaluate import cos_sin, sqrt_poly
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.symbolic import Expr, expression, parameter, signal
from wmrgen.report.sections.latex import WIDE, broken, latex, width
from wmrgen.report.sections.markdown import matrix

A, B, R = (Poly.gen("param", name) for name in ("a", "half_track", "r_1"))
PI = Poly.gen("pi")
COS, SIN = Poly.gen("cos", "front"), Poly.gen("sin", "front")
VX, VY, OMEGA = (Poly.gen("input", name) for name in ("vx", "vy", "omega"))
SPIN, RATE = Poly.gen("input", "left.spin"), Poly.gen("input", "front.steer_rate")
NUMBERS = {
    parameter("a"): 0.7, parameter("half_track"): 0.31, parameter("r_1"): 0.11, signal("front.steer"): -0.4,
    signal("vx"): 0.9, signal("vy"): -0.6, signal("omega"): 1.7, signal("left.spin"): 3.1,
    signal("front.steer_rate"): -0.8,
}  # fmt: skip
SYMBOLS = {
    "a": 0.7, r"\mathit{half\_track}": 0.31, "r_{1}": 0.11, r"\psi_{\mathrm{front}}": -0.4, "v_x": 0.9, "v_y": -0.6,
    r"\omega": 1.7, r"\dot{\varphi}_{\mathrm{left}}": 3.1, r"\dot{\psi}_{\mathrm{front}}": -0.8,
    r"\pi": 3.141592653589793,
}  # fmt: skip
FUNCTIONS = [
    (A * A + 1).inverse(), sqrt_poly(A + B), *cos_sin(A + R), Poly.gen("atan2", "", B, A), Poly.gen("tan", "", A - 2),
]  # fmt: skip
FACTORS = [A, B, R, PI, COS, SIN, VX, VY, OMEGA, SPIN, RATE, *FUNCTIONS]

CHANCE = random.Random(7)


def drawn_number() -> Exact:
    kind = CHANCE.randrange(4)
    if kind == 0:
        return Exact(CHANCE.choice([-12, -3, -2, -1, 1, 2, 7, 100]))
    if kind == 1:
        return Exact(Fraction(CHANCE.randint(1, 40) * CHANCE.choice([-1, 1]), CHANCE.randint(1, 12)))
    if kind == 2:
        return Exact(Fraction(CHANCE.randint(1, 20000) * CHANCE.choice([-1, 1]), 1000))
    return Exact(*(Fraction(CHANCE.randint(-6, 6), CHANCE.choice([1, 1, 2, 3])) for _ in range(4)))


def drawn_product(count: int, factors: list[Poly], powers: list[int]) -> Poly:
    result = Poly.of(drawn_number())
    for _ in range(count):
        base, power = CHANCE.choice(factors), CHANCE.choice(powers)
        result = result * (base**power if power > 0 else base.inverse() ** -power)
    return result


def drawn() -> Poly:
    total = Poly.sum(
        drawn_product(CHANCE.randint(0, 3), FACTORS, [1, 1, 2, 3]) for _ in range(CHANCE.randint(1, 5))
    )
    return total * drawn_product(CHANCE.randint(0, 2), FACTORS[:4], [-2, -1, 1, 2])


POLYNOMIALS = [drawn() for _ in range(80)]


def at(expr: Expr) -> float:
    return float(sympy.N(expr.xreplace(NUMBERS)))


def close(actual: float, wanted: float, poly: Poly) -> None:
    """Six digits of each number are shown."""
    size = sum(abs(at(expression(Poly({m: c})))) for m, c in poly.terms.items())
    assert actual == pytest.approx(wanted, abs=1.1e-5 * size)


@pytest.mark.parametrize("write", [latex, broken])
def test_latex_has_the_value_of_the_polynomial(write: Callable[[Poly], str]) -> None:
    for poly in POLYNOMIALS:
        text = write(poly)
        close(read(text, SYMBOLS), at(expression(poly)), poly)
        assert not text.startswith("+") and "+-" not in text and "--" not in text


def test_a_long_sum_is_broken_before_a_sign() -> None:
    for poly in POLYNOMIALS:
        lines = broken(poly).split("\\\\\n&\\qquad ")
        assert all(line[0] in "+-" for line in lines[1:])
        assert len(lines) > 1 or width(latex(poly)) <= WIDE or "+" not in lines[0][1:].replace("-", "+")


def test_a_long_sum_in_brackets_is_broken_inside_them() -> None:
    names = [Poly.gen("param", f"parameter_{n}") for n in "abcdefghijk"]
    first, *_, last = (notation.parameter(f"parameter_{n}") for n in "abcdefghijk")
    for factor, head in ((-1, "-"), (3, "3"), (-3, "-3")):
        text = broken(Poly.sum(names).scale(factor))
        assert (
            text.startswith(rf"{head}\Bigl({first}+")
            and text.endswith(rf"+{last}\Bigr)")
            and "&\\qquad" in text
        )


def test_a_sum_of_roots_before_brackets_has_brackets() -> None:
    names = Poly.sum(Poly.gen("param", f"parameter_{n}") for n in "abcdefghijk")
    assert broken(names.scale(Exact(-1, 1))).startswith(r"\left(\sqrt{2}-1\right)\Bigl(")


def test_formulas_of_symbols_have_their_value() -> None:
    ports = {
        n.replace(".", "_"): n for n in ("vx", "vy", "omega", "left.spin", "front.steer_rate", "front.steer")
    }
    for poly in POLYNOMIALS:
        expr = expression(poly)
        if not expr.has(sympy.tan):
            close(read(latex(expr, ports), SYMBOLS), at(expr), poly)


@pytest.mark.parametrize(
    ("poly", "shown"),
    [
        (Poly({}), "0"),
        (Poly.of(1), "1"),
        (-A, "-a"),
        (VX - A * OMEGA, r"v_x-a\;\omega"),
        (A * OMEGA - VX, r"-v_x+a\;\omega"),
        (VY * 2 + OMEGA * A * B, r"2\;v_y+a\,\mathit{half\_track}\;\omega"),
        (VX * COS + VY * SIN, r"\cos\psi_{\mathrm{front}}\;v_x+\sin\psi_{\mathrm{front}}\;v_y"),
        (VX * COS + VX * A, r"v_x\left(\cos\psi_{\mathrm{front}}+a\right)"),
        (VX * A.inverse(), r"\frac{v_x}{a}"),
        (VX * 2 * A.inverse(), r"\frac{2}{a}\;v_x"),
        ((VX - A * OMEGA) * R.inverse(), r"\frac{v_x-a\;\omega}{r_{1}}"),
        (A * A * B, r"{a}^{2}\,\mathit{half\_track}"),
        (COS * COS, r"\cos^{2}\psi_{\mathrm{front}}"),
        (A.scale(Fraction(1, 2)), r"\frac{a}{2}"),
        (A.scale(Fraction(-3, 8)), "-0.375\\,a"),
        (Poly.of(Exact(0, Fraction(1, 2))), r"\frac{\sqrt{2}}{2}"),
        (Poly.of(Exact(1, -1)) * A, r"-\left(\sqrt{2}-1\right)\,a"),
        (Poly.of(Exact(1, -1)), r"-\left(\sqrt{2}-1\right)"),
        (Poly.of(Exact(-1, 1)) + A, r"\sqrt{2}-1+a"),
        (Poly.of(Exact(1, 1)) - A, r"1+\sqrt{2}-a"),
        (A.inverse() + (A * A).inverse(), r"\frac{1+\frac{1}{a}}{a}"),
        (A.scale(123), r"123\,a"),
        (A.scale(12345678), r"1.23457\cdot 10^{7}\,a"),
        (A + VX, "v_x+a"),
        (OMEGA + VY + VX, r"v_x+v_y+\omega"),
        (-A - B, r"-\left(a+\mathit{half\_track}\right)"),
        (SPIN - RATE, r"\dot{\varphi}_{\mathrm{left}}-\dot{\psi}_{\mathrm{front}}"),
        (RATE - SPIN, r"\dot{\psi}_{\mathrm{front}}-\dot{\varphi}_{\mathrm{left}}"),
        (cos_sin(A)[0] * COS * B, r"\mathit{half\_track}\,\cos\psi_{\mathrm{front}}\,\cos a"),
        (sqrt_poly(A + B) * R, r"r_{1}\,\sqrt{a+\mathit{half\_track}}"),
        (PI * A, r"\pi\,a"),
        # lengths before one sine, divisors of their own size
        (A * COS - COS.scale(Fraction(11, 100)) + B * SIN,
         r"\mathit{half\_track}\,\sin\psi_{\mathrm{front}}+\left(a-0.11\right)\cos\psi_{\mathrm{front}}"),
        (VX * (Poly.of(1) - A.scale(Fraction(100, 11))).inverse(), r"-\frac{0.11}{a-0.11}\;v_x"),
        # one style of numbers in a sum: decimals, fractions, a root that all have before it
        (VX.scale(Fraction(1, 2)) + VY.scale(Fraction(3, 10)), r"0.5\;v_x+0.3\;v_y"),
        (VX.scale(Fraction(1, 3)) - VY.scale(Fraction(3, 10)), r"0.333333\;v_x-0.3\;v_y"),
        (VX.scale(Fraction(25, 2)) + VY.scale(Exact(0, 0, Fraction(1, 2))),
         r"\frac{25}{2}\;v_x+\frac{\sqrt{3}}{2}\;v_y"),
        (VX.scale(Exact(0, Fraction(1, 2))) - OMEGA.scale(Exact(0, Fraction(1, 5))),
         r"\frac{\sqrt{2}}{2}\left(v_x-0.4\;\omega\right)"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)  # fmt: skip
def test_as_one_would_write_it(poly: Poly, shown: str) -> None:
    assert latex(poly) == shown


def test_matrices() -> None:
    """Rows of fractions stand farther apart."""
    plain = matrix([[A, Poly.of(0)], ["x", Poly.of(-1)]])
    assert plain == "\\begin{bmatrix}\na & 0 \\\\\nx & -1\n\\end{bmatrix}"
    assert matrix([[A.inverse()], [A]]) == "\\begin{bmatrix}\n\\frac{1}{a} \\\\[4pt]\na\n\\end{bmatrix}"


def test_magnitudes_have_their_value() -> None:
    for number in (drawn_number() for _ in range(200)):
        if number:
            for style in get_args(notation.Style):
                above, below, _ = notation.magnitude(number, style)
                value = read(above or "1", {}) / read(below or "1", {})
                assert abs(value) == pytest.approx(abs(float(number)), rel=5e-6)
                assert not above.startswith("1\\") and "+1\\" not in above and "-1\\" not in above


def test_joint_rates_with_equal_factors_are_collected() -> None:
    """In a sum with other rates too, as in sums of which all rates have one factor. Twists are not collected."""
    one, two, three = (Poly.gen("input", f"w{k}.spin") for k in (1, 2, 3))
    rates = [rf"\dot{{\varphi}}_{{\mathrm{{w{k}}}}}" for k in (1, 2, 3)]
    assert latex(A * one - A * two) == rf"a\left({rates[0]}-{rates[1]}\right)"
    assert latex(A * one + B * two - A * three) == (
        rf"a\left({rates[0]}-{rates[2]}\right)+\mathit{{half\_track}}\;{rates[1]}"
    )
    assert latex(one + A * two - three) == rf"{rates[0]}-{rates[2]}+a\;{rates[1]}"
    assert latex(A * VX + B * VY + A * OMEGA) == r"a\;v_x+\mathit{half\_track}\;v_y+a\;\omega"


def test_products_of_two_angles_are_collected_by_the_one_that_most_share() -> None:
    """As in a component of the same vector of which all terms share it."""
    c, s = Poly.gen("cos", "rear"), Poly.gen("sin", "rear")
    front, rear = r"\psi_{\mathrm{front}}", r"\psi_{\mathrm{rear}}"
    all_share = latex(A * COS * c + B * COS * s)
    assert all_share.startswith(rf"\cos{front}\left(") and all_share.endswith(r"\right)")
    assert latex(A * COS * c + B * COS * s + R * SIN * c) == rf"{all_share}+r_{{1}}\,\sin{front}\,\cos{rear}"
