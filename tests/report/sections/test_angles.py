"""Addition theorems, columns without fractions and angles of singular sets: the same values as before."""

from __future__ import annotations

from fractions import Fraction
from math import cos, radians, sin, tan

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tests.report.sections.common import page_of
from tests.report.sections.reading import lengths_in_formulas, read
from tests.robots import ROBOTS, of_gallery
from wmrgen.geometry import notation
from wmrgen.geometry.exact.evaluate import sqrt_poly
from wmrgen.geometry.exact.poly import Poly
from wmrgen.report.sections.latex import equation, gathered, readable, roots, terms, upright
from wmrgen.report.sections.rows import quotient

ANGLES = {"a": 0.7, "b": -1.3, "c": 2.9}
VALUES = {rf"\psi_{{\mathrm{{{n}}}}}": v for n, v in ANGLES.items()} | {"l": 0.37}
numbers = st.sampled_from([Fraction(n, d) for n in (-3, -1, 1, 2) for d in (1, 2)])


def trig(kind: str, name: str) -> Poly:
    return Poly.gen(kind, name)


def worth(p: Poly) -> float:
    total = 0.0
    for monomial, c in p.terms.items():
        value = float(c)
        for g, n in monomial:
            at = {"cos": cos, "sin": sin}[g.kind](ANGLES[g.name]) if g.kind != "param" else VALUES[g.name]
            value *= at**n
        total += value
    return total


@st.composite
def products(draw: st.DrawFn) -> Poly:
    count = draw(st.integers(1, 3))
    factors = [
        trig(draw(st.sampled_from(["cos", "sin"])), draw(st.sampled_from("abc"))) for _ in range(count)
    ]
    p = Poly.of(draw(numbers)) * (Poly.gen("param", "l") if draw(st.booleans()) else Poly.of(1))
    for f in factors:
        p = p * f
    return p


@given(st.lists(products(), min_size=1, max_size=6))
def test_a_sum_keeps_its_value(summands: list[Poly]) -> None:
    p = Poly.sum(summands)
    if p:
        assert read(readable(p), VALUES) == pytest.approx(worth(p), abs=1e-12)
        assert len(gathered(terms(p))) <= len(p.terms)


@pytest.mark.parametrize(("first", "second"), [("sc", "cs"), ("cs", "sc"), ("cc", "ss"), ("ss", "cc")])
@pytest.mark.parametrize("signs", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_every_addition_theorem(first: str, second: str, signs: tuple[int, int]) -> None:
    kinds = {"s": "sin", "c": "cos"}
    p = Poly.sum(
        trig(kinds[k[0]], "a") * trig(kinds[k[1]], "b") * Poly.of(sign)
        for k, sign in zip((first, second), signs, strict=True)
    )
    assert len(gathered(terms(p))) == 1
    assert read(readable(p), VALUES) == pytest.approx(worth(p), abs=1e-15)


def test_what_only_looks_alike_stays() -> None:
    a, b, c = (trig("sin", n) for n in "abc")
    for p in (
        trig("cos", "a") * b + a * trig("cos", "c"),  # another angle
        trig("cos", "a") * b + (a * trig("cos", "b")).scale(2),  # another number
        trig("cos", "a") * trig("cos", "a") - a * a,  # one angle
        a * b + b * c,
    ):
        assert len(gathered(terms(p))) == 2


@given(st.lists(products(), max_size=4), st.lists(products(), min_size=1, max_size=3))
@example(
    [trig("cos", "b").scale(-3), (trig("cos", "b") * Poly.gen("param", "l")).scale(-1)], [trig("cos", "a")]
)
def test_a_quotient_keeps_its_value(above: list[Poly], below: list[Poly]) -> None:
    """Whatever cancels; its sign stands before the line where all above it is one product, and only there."""
    top, bottom = Poly.sum(above), Poly.sum(below)
    if bottom:
        text = quotient(top, bottom)
        assert read(text, VALUES) * worth(bottom) == pytest.approx(worth(top), rel=1e-9, abs=1e-12)


def test_columns_without_fractions() -> None:
    """Whole numbers; a column that turns does so at 1, unless that halves a named length."""
    half, third = Poly.of(Fraction(1, 2)), Poly.of(Fraction(-2, 3))
    column = upright((half * trig("cos", "a"), third, Poly({})))
    assert [worth(p) for p in column] == pytest.approx([3 * cos(0.7), -4, 0])
    length, one = Poly.gen("param", "half"), Poly.of(1)
    assert upright((Poly.of(50) * length, one, Poly.of(-50))) == (-length, Poly.of(Fraction(-1, 50)), one)
    assert upright((length, one, Poly.of(2))) == (length, one, Poly.of(2))
    assert upright((one, length, -trig("sin", "a"))) == (-one, -length, trig("sin", "a"))
    turning = Poly.of(2) - sqrt_poly(Poly.of(3))
    assert upright((turning, half * turning, -turning)) == (Poly.of(-1), -half, one)


@pytest.mark.parametrize(("name", "behind", "across", "track"), [
    ("f1tenth", 0.17145, 0.3302, 0.0), ("ackermann_car", 0.0, 2.5, 0.75), ("bicycle", 0.0, None, 0.0)
])  # fmt: skip
def test_where_a_car_turns(name: str, behind: float, across: float | None, track: float) -> None:
    """The axles of the fixed wheels and of the steered wheel at (x, y) meet ``behind`` P: at y + cot psi of their
    distance. No sine stands above itself."""
    page = page_of(name).partition("x_{ICR} = ")[2].partition("```")[0]
    x, y = page.strip().split(r", \qquad y_{ICR} = ")
    robot = of_gallery(name).robot
    steered = next(w for w in robot.wheels if w.kind.steers)
    wheelbase = float(steered.nominal.x) + behind
    assert across is None or wheelbase == pytest.approx(across)
    values = lengths_in_formulas(robot)
    for psi in (-0.4, 0.1, 1.2):
        values[notation.port(f"{steered.name}.steer")] = psi
        assert read(x, values) == pytest.approx(-behind)
        assert read(y, values) == pytest.approx(track + wheelbase / tan(psi))
    assert r"\sin" not in x + y


@pytest.mark.parametrize(
    ("numbers", "sign"),
    [((-1, 2, 3), 1), ((2, -1, -3), -1), ((-2, 1, 0), -1), ((2, -1, 0), 1), ((-2, 0, 0), -1)],
)
def test_an_equation_has_the_sign_of_most_of_its_terms(numbers: tuple[int, ...], sign: int) -> None:
    """Of two that differ that of the first."""
    p = Poly.sum(trig("cos", name).scale(n) for name, n in zip("abc", numbers, strict=True))
    assert worth(equation(p)) * worth(p) * sign > 0


@pytest.mark.parametrize("a", [-2, 0, Fraction(3, 5), 1])
@pytest.mark.parametrize("b", [-1, 0, Fraction(3, 5)])
def test_roots_are_roots(a: Fraction, b: Fraction) -> None:
    p = trig("cos", "a").scale(a) + trig("sin", "a").scale(b)
    text = roots(p)
    if not p:
        assert text == ""
        return
    found = [float(part.partition("^")[0]) for part in text.partition(" = ")[2].split(r"\;\mathrm{or}\;")]
    assert found[1] - found[0] == pytest.approx(180, abs=1e-3)
    for angle in found:
        assert -180 < angle <= 180
        assert float(a) * cos(radians(angle)) + float(b) * sin(radians(angle)) == pytest.approx(0, abs=1e-5)


def test_no_roots_of_what_has_two_angles_or_more_than_angles() -> None:
    a, b = trig("sin", "a"), trig("sin", "b")
    for p in (a + b, a * b, a * a, a + Poly.of(1), a + Poly.gen("param", "l") * trig("cos", "a")):
        assert roots(p) == ""


def test_an_equation_has_no_common_number() -> None:
    a, b = trig("sin", "a"), trig("sin", "b")
    assert equation((a + b).scale(Fraction(-3, 7))) == a + b
    assert equation((a.scale(2) + b).scale(-1)) == a.scale(2) + b
    assert equation(a.scale(5)) == a


@pytest.mark.parametrize("name", ROBOTS)
def test_no_column_of_n_has_a_half(name: str) -> None:
    matrix = page_of(name).partition("\nN = ")[2].partition("```")[0]
    assert "}{2}" not in matrix


def test_the_singular_set_of_a_square_swerve_drive() -> None:
    page = page_of("wpilib_swervebot").partition("## 9 ")[2]
    psi = r"\psi_{\mathrm{front\_left}}"
    assert rf"\cos{psi}+\sin{psi} &= 0, & {psi} = -45^{{\circ}}\;\mathrm{{or}}\;135^{{\circ}}" in page
