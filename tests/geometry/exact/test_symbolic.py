"""Polynomials and operations as sympy expressions: the same values, over real symbols."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
import sympy

from wmrgen.analysis.kinematics.records import substituted
from wmrgen.functions.models.sheet import tidy
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.symbolic import (
    AtLeast,
    Clamp,
    Compensated,
    Expr,
    Nearest,
    WithSignOf,
    add,
    expression,
    local,
    number,
    over,
    parameter,
    root,
    rotated,
    rotated_back,
    signal,
    square,
    subtract,
    times,
)

X, Y, Z = (signal(name) for name in "xyz")


@pytest.mark.parametrize("symbol", [parameter("length"), signal("left.spin"), local("left.rim")])
def test_symbols_are_real(symbol: Expr) -> None:
    assert symbol.is_real and "." not in symbol.name
    assert sympy.sqrt(symbol**2) == sympy.Abs(symbol)


@pytest.mark.parametrize("parts", [(0, 0, 0, 0), (1, 0, 0, 0), (2, -1, 0, 0), (0, 0, 3, -5), (1, 2, 3, 4)])
def test_numbers_of_the_field(parts: tuple[int, ...]) -> None:
    roots = (1, sympy.sqrt(2), sympy.sqrt(3), sympy.sqrt(6))
    assert sympy.expand(number(Exact(*parts)) - sum(p * r for p, r in zip(parts, roots, strict=True))) == 0


def test_generators_keep_their_meaning() -> None:
    a, b = Poly.gen("param", "a"), Poly.gen("input", "b")
    numbers = {parameter("a"): 0.75, signal("b"): -1.25, local("c"): 0.5, signal("w.steer"): 0.4}
    cases = [
        (a * b - 3, 0.75 * -1.25 - 3),
        (Poly.gen("local", "c") * Poly.gen("pi"), 0.5 * sympy.pi),
        (Poly.gen("cos", "w") + 2 * Poly.gen("sin", "w"), sympy.cos(0.4) + 2 * sympy.sin(0.4)),
        (Poly.gen("sqrt", "", a), sympy.sqrt(0.75)),
        (Poly.gen("inv", "", b), -0.8),
        (Poly.gen("tan", "", a), sympy.tan(0.75)),
        (Poly.gen("cosf", "", b) - Poly.gen("sinf", "", a), sympy.cos(1.25) - sympy.sin(0.75)),
        (Poly.gen("atan2", "", b, a), sympy.atan2(-1.25, 0.75)),
        (a.generators[0].alone ** 3, 0.75**3),
    ]
    for poly, value in cases:
        assert float(expression(poly).subs(numbers)) == pytest.approx(float(value), rel=1e-12)


def test_small_builders() -> None:
    chance = random.Random(4)
    for _ in range(8):
        at = {s: Fraction(chance.randrange(1, 9), chance.randrange(1, 5)) for s in (X, Y, Z)}
        numbers = {s: sympy.Rational(v.numerator, v.denominator) for s, v in at.items()}
        x, y, z = at[X], at[Y], at[Z]
        for built, value in (
            (add(X, Y, Z), x + y + z),
            (subtract(X, Y), x - y),
            (times(X, Y, Z), x * y * z),
            (over(X, Y), x / y),
            (over(X, sympy.Integer(4)), x / 4),
            (square(X), x * x),
            (square(root(X)), x),
            (Compensated(X, times(3, Y)), x + 3 * y),
            *zip(rotated(X, Y, Z, sympy.S.One), (z * x - y, z * y + x), strict=True),
            *zip(rotated_back(X, Y, Z, sympy.S.One), (x * z + y, x - y * z), strict=True),
        ):
            assert built.xreplace(numbers).doit() == sympy.Rational(value.numerator, value.denominator)


def test_neutral_elements_are_not_written() -> None:
    zero, one = sympy.S.Zero, sympy.S.One
    assert add() == zero and times() == one
    assert add(zero, X) == X and times(one, X) == X
    assert times(X, zero, Y) == zero
    assert add(X, X).args == (X, X) and times(X, X).args == (X, X), "a sum stays as it stands"


@pytest.mark.parametrize(
    ("operation", "a", "b", "value"),
    [
        (Clamp, 3, 2, 2), (Clamp, -3, 2, -2), (Clamp, 1, 2, 1), (Clamp, 2, 2, 2),
        (AtLeast, 3, 2, 3), (AtLeast, -3, 2, -3), (AtLeast, 1, 2, 2), (AtLeast, -1, 2, -2), (AtLeast, 0, 2, 2),
        (WithSignOf, 3, -2, -3), (WithSignOf, 3, 2, 3), (WithSignOf, 3, 0, 3), (WithSignOf, -3, -1, 3),
    ],
)  # fmt: skip
def test_operations_of_numbers(operation: type, a: int, b: int, value: int) -> None:
    assert operation(sympy.Integer(a), sympy.Integer(b)) == value


def test_operations_of_what_is_not_known_stay() -> None:
    two = sympy.Integer(2)
    for operation in (Clamp, AtLeast):
        kept = operation(X, two)
        assert isinstance(kept, operation) and kept.args == (X, two)
        assert isinstance(operation(two, X), operation)
    assert isinstance(WithSignOf(two, X), WithSignOf)
    assert WithSignOf(X, -two) == -X and WithSignOf(X, two) == X


def test_the_nearest_number_is_whole_and_flat() -> None:
    nearest = Nearest(X)
    assert nearest.is_integer and nearest.is_real and sympy.diff(nearest, X) == 0
    assert isinstance(Nearest(sympy.Rational(5, 2)), Nearest), "nothing evaluates it"


def test_a_substitution_evaluates_nothing() -> None:
    whole = Compensated(sympy.Max(X, Y, evaluate=False), times(3, Z))
    put = substituted(whole, {X: local("a"), Z: sympy.Integer(2)}, {})
    assert isinstance(put, Compensated)
    assert put.xreplace({local("a"): sympy.Integer(5), Y: sympy.Integer(1)}).doit() == 11
    clamped = substituted(Clamp(X, Y), {X: sympy.Integer(3), Y: sympy.Integer(2)}, {})
    assert isinstance(clamped, Clamp)


def test_what_is_tidied_is_what_sympy_evaluates() -> None:
    rng = random.Random(13)
    pool = [
        X,
        Y,
        -X,
        X * Y,
        sympy.sqrt(2) * Z,
        X / 3,
        1 / Y,
        X**2,
        sympy.sin(Y),
        sympy.cos(Z),
        sympy.pi,
        X + Y,
    ]
    for _ in range(200):
        parts = [
            rng.choice((-2, -1, 1, sympy.Rational(1, 3))) * rng.choice(pool)
            for _ in range(rng.randrange(1, 6))
        ]
        parts += [sympy.Integer(rng.randrange(-2, 3))]
        assert tidy(add(*parts)) == sympy.Add(*parts)
        assert tidy(times(*parts)) == sympy.Mul(*parts)
