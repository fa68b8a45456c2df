"""Determinants, adjugates and derivatives of polynomials against sympy's; powers and sines of exact numbers."""

from __future__ import annotations

import math
import random
from fractions import Fraction

import mpmath
import pytest
import sympy

from tests.depth import everyday
from wmrgen.functions.models.polynomials import by_angle
from wmrgen.geometry.exact.evaluate import circle, rounded, twelfths
from wmrgen.geometry.exact.linalg import adjugate, determinant, inverse
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Gen, Poly, derivative
from wmrgen.geometry.symbolic import expression

NAMES = ("a", "b", "c")


def poly(source: random.Random) -> Poly:
    """Up to three terms in a, b, c, powers from -1 to 2."""
    terms = (
        Poly.of(Fraction(source.randint(-9, 9), source.randint(1, 5)))
        * Poly.gen("param", source.choice(NAMES)) ** source.randint(0, 2)
        * Poly.gen("param", source.choice(NAMES)) ** source.choice((-1, 0, 1))
        for _ in range(source.randint(0, 3))
    )
    return Poly.sum(terms)


@pytest.mark.parametrize("size", everyday([0, 1, 2, 3, 4], [0, 1, 2, 3]))
def test_determinants(size: int) -> None:
    source = random.Random(size)
    for _ in range(10):
        m = [[poly(source) for _ in range(size)] for _ in range(size)]
        expected = sympy.Matrix(size, size, [expression(p) for row in m for p in row]).det(method="berkowitz")
        assert sympy.expand(expression(determinant(m)) - expected) == 0


@pytest.mark.parametrize("size", [1, 2, 3, 4])
def test_a_matrix_times_its_adjugate_is_its_determinant(size: int) -> None:
    source = random.Random(10 + size)
    m = [[poly(source) for _ in range(size)] for _ in range(size)]
    adj, det = adjugate(m), determinant(m)
    for i in range(size):
        for j in range(size):
            entry = Poly.sum(m[i][k] * adj[k][j] for k in range(size))
            assert entry == (det if i == j else Poly({}))


def test_the_inverse_of_numbers() -> None:
    m = [[Poly.of(v) for v in row] for row in ((2, 1, 0), (1, 3, 1), (0, 1, 4))]
    expected = sympy.Matrix(3, 3, [2, 1, 0, 1, 3, 1, 0, 1, 4]).inv()
    assert sympy.Matrix(3, 3, [expression(p) for row in inverse(m) for p in row]) == expected


@pytest.mark.parametrize("n", range(-3, 4))
def test_powers_of_numbers(n: int) -> None:
    """Of all four parts; what is to the power 0 is 1, 0 too."""
    x = Exact(Fraction(1, 2), 2, -1, 3)
    assert x**n == math.prod([x if n > 0 else x.inverse()] * abs(n), start=Exact(1))
    assert n < 0 or Exact(0) ** n == (n == 0)


@pytest.mark.parametrize("k", range(-13, 37))
def test_multiples_of_a_twelfth_of_half_a_turn(k: int) -> None:
    """Exactly on the circle, and where the angle is."""
    c, s = twelfths(k)
    assert c * c + s * s == 1
    assert (float(c), float(s)) == pytest.approx((math.cos(k * math.pi / 12), math.sin(k * math.pi / 12)))


def test_derivatives_by_a_generator() -> None:
    source = random.Random(3)
    a = Gen("param", "a")
    for _ in range(30):
        p = poly(source)
        slope = derivative(p, lambda g: Poly.of(int(g == a)))
        symbol = expression(Poly.gen("param", "a"))
        assert sympy.expand(expression(slope) - sympy.diff(expression(p), symbol)) == 0


def test_derivatives_by_an_angle() -> None:
    """d/dt of a polynomial in (cos t, sin t), at rational points of the circle."""
    source, t = random.Random(4), sympy.Symbol("t")
    cosine, sine = Gen("cos", "w"), Gen("sin", "w")
    for _ in range(20):
        powers = [(source.randint(-5, 5), source.randint(0, 3), source.randint(0, 3)) for _ in range(3)]
        p = Poly.sum(Poly.gen("cos", "w") ** i * Poly.gen("sin", "w") ** j * Poly.of(k) for k, i, j in powers)
        exact = sympy.diff(sum(k * sympy.cos(t) ** i * sympy.sin(t) ** j for k, i, j in powers), t)
        half = Fraction(source.randint(-7, 7), source.randint(1, 7))
        c, s = circle(half)
        value = by_angle(p, cosine, sine).substitute(lambda g, c=c, s=s: Poly.of(c if g == cosine else s))
        number = value.constant
        assert number is not None
        angle = {sympy.cos(t): sympy.Rational(str(c)), sympy.sin(t): sympy.Rational(str(s))}
        assert sympy.Rational(str(number)) == sympy.sympify(exact).subs(angle)


@pytest.mark.parametrize("exponent", [-7, -1, 0, 1, 39, 40, 55])
def test_reals_become_fractions_of_forty_digits(exponent: int) -> None:
    """The last of them rounded; of a power of ten, there is one."""
    power = Fraction(10) ** exponent
    with mpmath.workdps(80):
        ten = mpmath.mpf(10) ** exponent
        thirds = [rounded(k * ten / 3) for k in (1, -2)]
        assert rounded(ten) == Exact(power)
    assert thirds == [Exact(int(digits) * power / 10**40) for digits in ("3" * 40, "-" + "6" * 39 + "7")]
    assert rounded(mpmath.mpf(0)) == Exact(0)
