"""`forward` and `inverse` as users read them: every named length and angle a symbol, numbers only at nominal values."""

from __future__ import annotations

import math
import random
from dataclasses import replace

import pytest
import sympy

from tests.robots import ROBOTS, of_gallery, of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.exact.readable import with_sines_squared, with_sums_of_angles, with_tangents
from wmrgen.geometry.symbolic import Expr, expression, parameter, signal
from wmrgen.ir.interpret import EXACT, evaluate
from wmrgen.ir.lower import lower
from wmrgen.ir.nodes import Function

MECANUM = """wmrgen: 1
name: base
parameters: {a: 0.2, b: 0.15, r: 0.05, g: 40 deg}
wheels:
  - {name: fl, type: swedish, x: a, y: b, heading: 0, r: r, gamma: -g}
  - {name: fr, type: swedish, x: a, y: -b, heading: 0, r: r, gamma: g}
  - {name: rl, type: swedish, x: -a, y: b, heading: 0, r: r, gamma: g}
  - {name: rr, type: swedish, x: -a, y: -b, heading: 0, r: r, gamma: -g}
"""
EXAMPLE_2_4 = """wmrgen: 1
name: ring
parameters: {D: 0.2, r: 0.05, beta1: 0.3, beta2: 2.2, beta3: 4.4}
wheels:
  - {name: one, type: swedish, l: D, alpha: beta1, beta: pi, r: r, gamma: 0}
  - {name: two, type: swedish, l: D, alpha: beta2, beta: pi, r: r, gamma: 0}
  - {name: three, type: swedish, l: D, alpha: beta3, beta: pi, r: r, gamma: 0}
"""
TURNED = """wmrgen: 1
name: turned
parameters: {w: 0.2, r: 0.05, tilt: 0.3}
wheels:
  - {name: left, type: fixed, x: -w*sin(tilt), y: w*cos(tilt), heading: tilt, r: r}
  - {name: right, type: fixed, x: w*sin(tilt), y: -w*cos(tilt), heading: tilt, r: r}
"""
MIXED = """wmrgen: 1
name: mixed
parameters: {a: 0.31, b: 0.17, r: 0.05, zero: 0.3, off: 0.02, d: 0.03, g: 0.7}
wheels:
  - {name: front, type: steered, x: a, y: b, heading: zero, r: r}
  - {name: back, type: steered, x: -a, y: 0, heading: 0.1, r: r, offset_y: off}
  - {name: tail, type: castor, x: 0, y: -b, heading: zero, d: d, r: r, actuated: [spin, steer]}
  - {name: omni, type: swedish, x: b, y: -a, heading: zero, gamma: g, r: 2*r}
"""
COUPLED = """wmrgen: 1
name: coupled
parameters: {half: 0.4, ahead: 0.33, r: 0.1, q: 0.12, lean: 0.2}
wheels:
  - {name: a, type: fixed, x: ahead, y: half, heading: lean, r: r}
  - {name: b, type: fixed, x: ahead, y: -half, heading: lean, r: q}
  - {name: c, type: swedish, x: -ahead, y: 0, heading: pi/2, gamma: lean, r: r}
couplings: [{equal: [a.spin, b.spin]}]
"""
PAIR = """wmrgen: 1
name: pair
parameters: {{half: 0.2, {0}: 0.05}}
wheels:
  - {{name: left, type: fixed, x: 0, y: half, heading: 0, r: {0}}}
  - {{name: right, type: fixed, x: 0, y: -half, heading: 0, r: {0}}}
"""
WRITTEN = {
    "base": MECANUM,
    "ring": EXAMPLE_2_4,
    "turned": TURNED,
    "mixed": MIXED,
    "coupled": COUPLED,
}


def robot(name: str) -> Derivation:
    return of_text(WRITTEN[name]) if name in WRITTEN else of_gallery(name)


def in_operations(d: Derivation, function: str) -> Function:
    """What users read of a function, as one that can be evaluated at exact values."""
    formula = d.formula_in_symbols(function)
    ports = {port.name: port for port, _ in formula.outputs}
    outputs = ((ports[n], without_tangents(e)) for n, e in getattr(d, function).items())
    return lower(replace(formula, locals=(), calls=(), outputs=tuple(outputs)))


def without_tangents(e: Expr) -> Expr:
    return e.replace(sympy.tan, lambda x: sympy.sin(x) / sympy.cos(x)) if e.has(sympy.tan) else e


@pytest.mark.parametrize("function", ["forward", "inverse"])
@pytest.mark.parametrize("name", [*WRITTEN, *ROBOTS])
def test_at_nominal_values_they_are_what_the_code_computes(name: str, function: str) -> None:
    d, chance = robot(name), random.Random(name)
    read = in_operations(d, function)
    ports = [p for p in d.formula(function).inputs if p.default is None]
    for _ in range(2):
        values = {p.name: Exact.ratio(chance.randint(-300, 300), 97) for p in ports}
        wanted, found = d.evaluate(function, values), evaluate(read, values, EXACT)
        assert found.keys() == wanted.keys()
        for output, value in found.items():
            assert float(value) == pytest.approx(float(wanted[output]), rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("name", ["base", "ring", "turned", "coupled", "pioneer3dx", "kuka_youbot", "lekiwi"])
@pytest.mark.parametrize("function", ["forward", "inverse"])
def test_no_name_became_a_number(name: str, function: str) -> None:
    """Numbers are those of the text: no sine of a named angle, no length."""
    expressions = getattr(robot(name), function).values()
    numbers = {n for e in expressions for n in e.atoms(sympy.Rational)}
    assert all(max(abs(n.p), n.q) < 200 for n in numbers)
    assert not any(e.has(sympy.Float) for e in expressions)


def test_forward_of_a_mecanum_base() -> None:
    """vx = r/4, vy = r/(4 tan g), omega = r/(4 (a tan g + b)) times sums of spins; at 45 degrees tan g = 1."""
    a, b, r, g = map(parameter, "abrg")
    fl, fr, rl, rr = (signal(f"{n}.spin") for n in ("fl", "fr", "rl", "rr"))
    found = robot("base").forward
    wanted = {
        "vx": (r / 4, fl + fr + rl + rr),
        "vy": (r / (4 * sympy.tan(g)), -fl + fr + rl - rr),
        "omega": (r / (4 * (a * sympy.tan(g) + b)), -fl + fr - rl + rr),
    }
    for name, (factor, spins) in wanted.items():
        assert (
            sympy.simplify(found[name].args[0] / factor) == 1
            and sympy.expand(found[name].args[1] - spins) == 0
        )
    straight = of_text(
        MECANUM.replace(", g: 40 deg", "").replace("-g}", "-45 deg}").replace(" g}", " 45 deg}")
    )
    assert str(straight.forward["omega"].args[0]) == "r/(4*(a + b))"
    assert sympy.expand(robot("base").inverse["fl.spin"]) == sympy.expand(
        (signal("vx") - sympy.tan(g) * signal("vy") - (a * sympy.tan(g) + b) * signal("omega")) / r
    )


def test_example_2_4_of_tzafestas_with_named_angles() -> None:
    """(2.75), corrected: u_i = (-sin b_i, cos b_i), spin_i = (u_i v + D omega)/r."""
    d, (b1, b2, b3) = robot("ring"), (parameter(f"beta{k}") for k in (1, 2, 3))
    D, r = parameter("D"), parameter("r")
    vx, vy, omega = (signal(n) for n in ("vx", "vy", "omega"))
    for name, b in zip(("one", "two", "three"), (b1, b2, b3), strict=True):
        wanted = (-sympy.sin(b) * vx + sympy.cos(b) * vy + D * omega) / r
        assert sympy.expand(d.inverse[f"{name}.spin"] - wanted) == 0
    factor = sympy.sin(b2 - b1) + sympy.sin(b3 - b2) + sympy.sin(b1 - b3)
    wanted = sympy.sin(b3 - b2) * signal("one.spin") + sympy.sin(b1 - b3) * signal("two.spin")
    wanted += sympy.sin(b2 - b1) * signal("three.spin")
    at = {b1: 0.3, b2: 2.5, b3: 4.1, D: 0.3, r: 0.1, signal("one.spin"): 3, signal("two.spin"): -2}
    at[signal("three.spin")] = 0.7
    assert float(d.forward["omega"].subs(at)) == pytest.approx(float((r / (D * factor) * wanted).subs(at)))
    assert d.forward["omega"].args[0].has(sympy.sin(b1 - b2)) and not d.forward["omega"].has(sympy.cos)
    assert d.forward["slip"] == 0


def test_a_parameter_with_the_name_of_an_input_keeps_its_number() -> None:
    """`goto_pose` has an input called direction: one symbol would stand for two things."""
    names = [p.name for p in of_text(PAIR.format("direction")).formula_in_symbols("goto_pose").inputs]
    assert "half" not in names and names.count("direction") == 1
    assert "half" in [p.name for p in of_text(PAIR.format("r")).formula_in_symbols("goto_pose").inputs]


def test_what_is_computed_does_not_change() -> None:
    """The code keeps numbers for what is not tunable."""
    d = robot("base")
    before = [p.name for p in d.formula("forward").inputs]
    assert d.forward and [p.name for p in d.formula("forward").inputs] == before
    assert not any(p.name in ("a", "b", "r", "g") for p in d.module.functions[1].inputs)


A, B, C = (Poly.gen("param", n) for n in "abc")


def cosine(p: Poly) -> Poly:
    return Poly.gen("cosf", "", p)


def sine(p: Poly) -> Poly:
    return Poly.gen("sinf", "", p)


def value(p: Poly, at: dict[Expr, float]) -> float:
    return float(expression(p).subs(at))


@pytest.mark.parametrize("seed", range(20))
def test_angles_are_rewritten_without_a_change_of_value(seed: int) -> None:
    """Products of sines and cosines with either sign, and quotients, of angles that may be equal."""
    chance = random.Random(seed)
    at = {parameter(n): chance.uniform(0.2, 1.3) for n in "abc"}
    sin_a, terms = math.sin(at[parameter("a")]), []
    for _ in range(6):
        x, y = chance.choices((A, B, C), k=2)
        f, g = chance.choices((cosine, sine), k=2)
        power = chance.choice((1, 1, -1))
        terms.append(chance.choice((1, -1, 2)) * f(x) * g(y) ** power * chance.choice((A, Poly.of(1))))
    p = Poly.sum(terms)
    assert value(with_tangents(p), at) == pytest.approx(value(p, at), rel=1e-9, abs=1e-9)
    assert value(with_sums_of_angles(p), at) == pytest.approx(value(p, at), rel=1e-9, abs=1e-9)
    squared = p - p * cosine(B) * cosine(B)
    assert value(with_sines_squared(squared), at) == pytest.approx(value(squared, at), rel=1e-9, abs=1e-9)
    assert value(with_tangents(p * sine(A).inverse()), at) == pytest.approx(
        value(p, at) / sin_a, rel=1e-9, abs=1e-9
    )


@pytest.mark.parametrize(
    ("p", "text"),
    [
        (sine(A) * cosine(B) - cosine(A) * sine(B), "sin(a - b)"),
        (sine(A) * cosine(B) + cosine(A) * sine(B), "sin(a + b)"),
        (cosine(A) * cosine(B) + sine(A) * sine(B), "cos(a - b)"),
        (C * cosine(A) * cosine(B) - C * sine(A) * sine(B), "c*cos(a + b)"),
        ((cosine(A) * cosine(B) - sine(A) * sine(B)).inverse(), "1/cos(a + b)"),
    ],
)
def test_sums_of_angles(p: Poly, text: str) -> None:
    assert str(expression(with_sums_of_angles(p))) == text


def test_one_less_a_cosine_squared() -> None:
    assert str(expression(with_sines_squared(C - C * cosine(A) * cosine(A) + B))) == "b + c*sin(a)**2"


@pytest.mark.parametrize(
    ("p", "text"),
    [
        (C * cosine(A) * sine(A).inverse(), "c/tan(a)"),
        (sine(A) * cosine(A).inverse(), "tan(a)"),
        (C * cosine(A) * (B * sine(A) + C * cosine(A)).inverse(), "c/(b*tan(a) + c)"),
        (cosine(A) * (B * sine(A) + C).inverse(), "cos(a)/(b*sin(a) + c)"),
    ],
)
def test_tangents(p: Poly, text: str) -> None:
    assert str(expression(with_tangents(p))) == text
