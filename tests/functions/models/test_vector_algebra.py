"""Vector fields as polynomials: what formulas mean is kept, derivatives are those of sympy, at random points."""

from __future__ import annotations

import random
import re
from fractions import Fraction

import pytest
import sympy

from tests.functions.models.robots import UNICYCLE, derived, p, s
from tests.functions.refusals import refused
from tests.robots import of_gallery, of_text
from wmrgen.analysis.mobility.ranks import generic
from wmrgen.functions.models import growth as growth_of
from wmrgen.functions.models.growth import MOST_STATES, growth, robot_growth
from wmrgen.functions.models.vector_fields import (
    Field,
    Slopes,
    at_point,
    bracket_by,
    by_state,
    generic_point,
    to_poly,
    value_at,
)
from wmrgen.functions.registry import Reason
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.ports import Port, Role
from wmrgen.geometry.symbolic import Expr, expression

A, B, L = s("a"), s("b.theta"), p("length")
AT = {A: 0.7, B: -0.4, L: 1.3}


def unevaluated(*terms: Expr) -> Expr:
    return sympy.Add(*terms, evaluate=False)


ANGLES = [
    A, 2 * A, unevaluated(A, B), unevaluated(A, -B), unevaluated(-A, B), unevaluated(-B, A), unevaluated(-A, -B),
    unevaluated(-A, 2 * B), unevaluated(B, -3 * A),
]  # fmt: skip
EXPRESSIONS = [
    *(wave(angle, evaluate=False) for wave in (sympy.sin, sympy.cos, sympy.tan) for angle in ANGLES),
    sympy.Rational(3, 7), L, A * B - 2 * L, (A + L) ** 3, (A + 2) ** -2, sympy.sqrt(L + A**2),
    (L + 2 * A) ** sympy.Rational(3, 2),
    1 / sympy.sqrt(A**2 + 1), sympy.tan(A) * sympy.cos(B) / L, sympy.sin(A) ** 3 * sympy.cos(A - B) ** 2 / (L + B),
]  # fmt: skip


def at(expr: Expr) -> float:
    return float(sympy.N(expr.xreplace(AT)))


@pytest.mark.parametrize("expr", EXPRESSIONS, ids=str)
def test_a_polynomial_means_its_formula(expr: Expr) -> None:
    assert at(expression(to_poly(expr))) == pytest.approx(at(expr), rel=1e-12)


@pytest.mark.parametrize("expr", EXPRESSIONS, ids=str)
def test_derivatives_by_states(expr: Expr) -> None:
    poly = to_poly(expr)
    for state, symbol in (("a", A), ("b.theta", B)):
        wanted = at(sympy.diff(expr.doit(), symbol))
        assert at(expression(by_state(poly, state))) == pytest.approx(wanted, rel=1e-9, abs=1e-12)
    assert not by_state(poly, "c")


def test_angles_of_either_sign_are_one_generator() -> None:
    one, other = unevaluated(A, -B), unevaluated(-A, B)
    cosine, sine = (wave(one, evaluate=False) for wave in (sympy.cos, sympy.sin))
    assert to_poly(cosine) == to_poly(sympy.cos(other, evaluate=False))
    assert to_poly(sympy.cos(A)) == Poly.gen("cosf", "", to_poly(A)), "the first coefficient is positive"
    assert to_poly(sine) == -to_poly(sympy.sin(other, evaluate=False))
    assert to_poly(unevaluated(cosine**2, sine**2)) == 1


@pytest.mark.parametrize("expr", [sympy.exp(A), A ** sympy.Rational(1, 3), 2**A, sympy.Symbol("q")], ids=str)
def test_what_is_no_polynomial_is_refused(expr: Expr) -> None:
    with pytest.raises(ValueError, match=re.escape(str(expr))):
        to_poly(expr)


def test_values_at_points() -> None:
    """States are numbers, in waves the tangents of half the angles."""
    point = {"a": Exact(Fraction(1, 2)), "b_theta": Exact(Fraction(-1, 3))}
    numbers = {"length": Exact(Fraction(5, 4))}
    cos_a, sin_a, cos_b, sin_b = Fraction(3, 5), Fraction(4, 5), Fraction(4, 5), Fraction(-3, 5)
    for expr, value in (
        (A * L - B, Fraction(5, 8) + Fraction(1, 3)),
        (sympy.cos(A), cos_a),
        (sympy.sin(B), sin_b),
        (sympy.cos(unevaluated(A, B), evaluate=False), cos_a * cos_b - sin_a * sin_b),
        (sympy.sin(unevaluated(A, -B), evaluate=False), sin_a * cos_b - cos_a * sin_b),
        (sympy.cos(2 * A), cos_a**2 - sin_a**2),
        (1 / (A + L), Fraction(4, 7)),
        (sympy.sqrt(A + L + sympy.Rational(1, 2)), Fraction(3, 2)),
    ):
        poly = to_poly(expr)
        assert at_point(poly, point, numbers) == Poly.of(value)
        assert value_at(poly, point, numbers) == value


def test_generic_points_differ_in_every_state_and_from_seed_to_seed() -> None:
    state = tuple(Port(name, Role.STATE, "rad", "an angle") for name in ("x", "y", "front.steer"))
    points = [generic_point(state, seed) for seed in range(4)]
    assert set(points[0]) == {"x", "y", "front_steer"}
    values = [value for point in points for value in point.values()]
    assert len(set(values)) == len(values) and all(values)


def test_generic_angles_are_angles() -> None:
    """Exactly, and no two wheels have the same: ranks decided there are generic."""
    robot = of_gallery("jpl_osr").robot
    points = [generic(robot)(w.name) for w in robot.wheels]
    assert all(c * c + s * s == Exact(1) for c, s in points)
    assert len({*points}) == len(robot.wheels)


def test_a_bracket_is_its_definition() -> None:
    chance, slopes = random.Random(2), Slopes(("a", "b.theta"))

    def bracket(f: Field, g: Field) -> Field:
        return bracket_by(f, slopes.jacobian(f), g, slopes.jacobian(g))

    fields = [
        tuple(to_poly(e) for e in pair) for pair in ((sympy.cos(B), A * B), (A**2 + L, sympy.sin(A - B)))
    ]
    f, g = ([expression(c) for c in field] for field in fields)
    wanted = [
        sum(sympy.diff(g[i], q) * f[k] - sympy.diff(f[i], q) * g[k] for k, q in enumerate((A, B)))
        for i in range(2)
    ]
    for _ in range(3):
        numbers = {symbol: chance.uniform(-2, 2) for symbol in AT}
        for component, expr in zip(bracket(*fields), wanted, strict=True):
            assert float(sympy.N(expression(component).xreplace(numbers))) == pytest.approx(
                float(sympy.N(expr.xreplace(numbers))), rel=1e-9
            )
    swapped = bracket(*fields[::-1])
    assert all(not one + other for one, other in zip(bracket(*fields), swapped, strict=True))


def test_brackets_are_formed_up_to_a_number_of_states() -> None:
    assert MOST_STATES == 10
    many = derived(UNICYCLE, "trailers: [" + ", ".join("{length: 1}" for _ in range(8)) + "]")
    with refused(Reason.TOO_LONG, "11 states", "10"):
        growth(many.system("trailer", symbolic=True))


DRIVEN_CASTORS = """wmrgen: 1
name: sample
wheels:
  - {name: a, type: swedish, x: -0.241, y: 0.423, heading: -0.53, r: 0.074, gamma: pi/4}
  - {name: b, type: castor, x: 0.532, y: 0.646, heading: 1.21, r: 0.183, d: -0.107, sensed: [steer]}
  - {name: c, type: castor, x: 0.806, y: 0.799, heading: 1.21, r: 0.183, d: 0.161, offset_y: 0.172,
     actuated: [spin, steer], sensed: []}
  - {name: d, type: castor, x: 0.073, y: 0.393, heading: 1.21, r: 0.183, d: -0.053, actuated: [spin, steer]}
  - {name: e, type: swedish, x: 1.067, y: -0.086, heading: -pi/4, r: 0.04, gamma: pi/4}
couplings:
  - equal: [b.steer, c.steer]
trailers: [{length: 0.9}, {length: 0.7, hitch: 0.2}]
"""


@pytest.mark.slow
def test_brackets_of_many_terms_are_refused_before_they_are_formed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Terms of its fields hold polynomials of their own, so that 5,700 products count three times."""
    d = of_text(DRIVEN_CASTORS)
    monkeypatch.setattr(growth_of, "bracket_by", lambda *fields: pytest.fail("a bracket is formed"))
    with refused(Reason.TOO_LONG, "hitch"):
        robot_growth(d.robot, d.mobility, most=16_000)
