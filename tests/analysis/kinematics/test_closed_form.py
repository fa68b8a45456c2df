"""Closed forms with symbolic geometry: textbook formulas, the square solve, and residuals, against numpy."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
import pytest
import sympy

from tests.robots import of_text
from wmrgen.analysis.kinematics.closed_form import merge, solve_symbolic, written_out
from wmrgen.analysis.kinematics.records import Locals
from wmrgen.analysis.kinematics.sensing import measurements
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.geometry.exact.poly import Poly, Row
from wmrgen.geometry.symbolic import parameter, signal
from wmrgen.ir.interpret import EXACT, FLOAT32, evaluate, evaluate_module
from wmrgen.ir.lower import lower

MECANUM = [("fl", "a", "b", -1), ("fr", "a", "-b", 1), ("rl", "-a", "b", 1), ("rr", "-a", "-b", -1)]


def robot(parameters: dict[str, Any], wheels: list[str], tunable: bool = True) -> Derivation:
    given = "".join(
        f"  {n}: {{value: {v}, tunable: {str(tunable).lower()}}}\n" for n, v in parameters.items()
    )
    lines = "".join(f"  - {{{w}}}\n" for w in wheels)
    return of_text(f"wmrgen: 1\nname: sample\nsnap: false\nparameters:\n{given}wheels:\n{lines}")


def mecanum(angle: str, **more: float) -> Derivation:
    wheels = [
        f"name: {n}, type: swedish, x: {x}, y: {y}, heading: 0, r: r, gamma: {'' if s > 0 else '-'}{angle}"
        for n, x, y, s in MECANUM
    ]
    return robot({"a": 0.25, "b": 0.2, "r": 0.05, **more}, wheels)


def omni(count: int, spread: float = math.tau) -> Derivation:
    parameters: dict[str, float] = {}
    wheels = []
    for i in range(count):
        parameters |= {
            f"l{i}": 0.2 + 0.01 * i,
            f"r{i}": 0.05 + 0.001 * i,
            f"a{i}": round(0.1 + spread * i / count, 3),
        }
        wheels.append(f"name: w{i}, type: swedish, l: l{i}, alpha: a{i}, beta: 0, gamma: 0, r: r{i}")
    return robot(parameters, wheels)


def outputs(d: Derivation) -> dict[str, sympy.Expr]:
    return d.formula("forward").closed()


def same(found: sympy.Expr, wanted: sympy.Expr) -> bool:
    return sympy.simplify(sympy.expand_trig(found - wanted)) == 0


def test_mecanum_is_the_formula_of_the_books() -> None:
    found = outputs(mecanum("45 deg"))
    a, b, r = (parameter(n) for n in "abr")
    fl, fr, rl, rr = (signal(f"{n}.spin") for n, *_ in MECANUM)
    assert same(found["vx"], r / 4 * (fl + fr + rl + rr))
    assert same(found["omega"], r / (4 * (a + b)) * (-fl + fr - rl + rr))
    assert sympy.denom(sympy.together(found["omega"])) in (4 * (a + b), 4 * a + 4 * b)
    # No product of lengths is left: a + b divides what the normal equations have.
    assert same(found["slip"], abs(sympy.sqrt(2) / 4 * r * (fl + fr - rl - rr))) or same(
        found["slip"], abs(sympy.sqrt(2) / 4 * r * (-fl - fr + rl + rr))
    )


def test_mecanum_with_a_roller_angle() -> None:
    found = outputs(mecanum("g", g=0.7))
    a, b, r, g = (parameter(n) for n in "abrg")
    fl, fr, rl, rr = (signal(f"{n}.spin") for n, *_ in MECANUM)
    assert same(found["vy"], r / (4 * sympy.tan(g)) * (-fl + fr + rl - rr))
    assert same(found["omega"], r / (4 * (a * sympy.tan(g) + b)) * (-fl + fr - rl + rr))


@pytest.mark.parametrize("count", [3, 4, 5, 6, 7])
def test_values_are_those_of_least_squares(count: int) -> None:
    """Away from nominal parameters, with every length and angle of its own."""
    d, rng = omni(count), random.Random(count)
    for _ in range(3):
        case = {p.name: float(p.nominal) * rng.uniform(0.9, 1.1) for p in d.robot.parameters}
        case |= {f"w{i}.spin": rng.uniform(-3, 3) for i in range(count)}
        rows, z = [], []
        for i in range(count):
            a, l = case[f"a{i}"], case[f"l{i}"]
            rows.append([math.sin(a), -math.cos(a), -l])
            z.append(case[f"r{i}"] * case[f"w{i}.spin"])
        H = np.array(rows)
        wanted = np.linalg.lstsq(H, np.array(z), rcond=None)[0]
        left = np.linalg.norm(np.array(z) - H @ wanted)
        found = d.casadi()["forward"](**case)
        assert [float(found[k]) for k in ("vx", "vy", "omega", "slip")] == pytest.approx(
            [*wanted, left], abs=1e-9
        )


def test_three_rows_are_solved_without_their_squares() -> None:
    """75, 90 and 107 degrees: HᵀH would square a condition number of 100, which float32 does not bear."""
    wheels = [f"name: w{i}, type: swedish, l: l, alpha: a{i}, beta: 0, gamma: 0, r: r" for i in range(3)]
    d = robot({"a0": "75 deg", "a1": "90 deg", "a2": "107 deg", "l": 0.2, "r": 0.05}, wheels)
    case = {"w0.spin": 3.0, "w1.spin": 4.1, "w2.spin": 2.0}
    exact = evaluate_module(d.raw_module, "forward", case, EXACT)
    short = evaluate_module(d.raw_module, "forward", case, FLOAT32)
    assert not exact["slip"] and not short["slip"]
    for name in ("vx", "vy", "omega"):
        assert float(short[name]) == pytest.approx(float(exact[name]), rel=3e-6)


def test_equal_rows_are_one_row_of_their_mean() -> None:
    one, zero, length = Poly.of(1), Poly({}), Poly.gen("param", "a")
    row: Row = (one, zero, length)
    u, v = (Poly.gen("input", f"{n}.spin") for n in "uv")
    merged = merge(
        [(row, u, ONE), ((-one - one, zero, (-length).scale(2)), v, ONE), ((zero, one, length), u, ONE)]
    )
    (first, mean, weight), (second, *_) = merged.rows
    assert first == row and second == (zero, one, length) and weight == 5
    assert mean == (u - v.scale(2)).scale(Exact(1) / 5)
    ((difference, counts),) = merged.differences
    assert difference == -(v.scale(Exact(1) / 2)) - u and counts == Exact(4) / 5


def test_double_wheels_report_what_they_contradict_each_other_by() -> None:
    """A differential drive with two motors on the left: three rows, and a residual of two spins."""
    wheels = [
        "name: a, type: fixed, x: 0, y: h, heading: 0, r: r",
        "name: b, type: fixed, x: 0, y: h, heading: 0, r: r",
        "name: c, type: fixed, x: 0, y: -h, heading: 0, r: r",
    ]
    d = robot({"h": 0.2, "r": 0.05}, wheels)
    found = d.casadi()["forward"](**{"a.spin": 2.0, "b.spin": 3.0, "c.spin": 4.0})
    assert float(found["slip"]) == pytest.approx(0.05 / math.sqrt(2))
    assert float(found["vx"]) == pytest.approx(0.05 * (2.5 + 4) / 2)
    assert float(found["omega"]) == pytest.approx(0.05 * (4 - 2.5) / 0.4)


@pytest.mark.parametrize(("count", "most"), [(3, 0), (3, 10**9), (4, 0), (4, 10**9), (6, 0)])
def test_both_sides_of_the_size_have_equal_values(count: int, most: int) -> None:
    """Nothing written out, and all of it."""
    case = {f"w{i}.spin": 0.5 * i - 0.75 for i in range(count)}
    d, names = omni(count), Locals()
    wanted = evaluate_module(d.raw_module, "forward", case, EXACT)
    assert (written_out(measurements(d.robot).rows, most) is None) == (most == 0)
    twist, slip, own = solve_symbolic(measurements(d.robot, names).rows, names, most)
    ports, inputs = (port for port, _ in d.formula("forward").outputs), d.formula("forward").inputs
    formula = own.formula("forward", inputs, zip(ports, (*twist, slip), strict=True), "")
    found = evaluate(lower(formula), case, EXACT)
    for name, value in wanted.items():
        assert float(found[name]) == pytest.approx(float(value), abs=1e-12)


@pytest.mark.parametrize(("half_track", "chosen"), [("[0.7, 0.9]", False), ("[-0.1, 0.9]", True)])
def test_a_car_decides_its_rank_when_it_is_derived(half_track: str, chosen: bool) -> None:
    """Two fixed wheels apart see every twist, whatever the steering does. If they may meet, code has to choose."""
    d = of_text(f"""
wmrgen: 1
name: car
parameters:
  base: {{value: 2.5, tunable: true}}
  half_track: {{value: 0.8, tunable: {half_track}}}
wheels:
  - {{name: rl, type: fixed, x: 0, y: half_track, heading: 0, r: 0.3}}
  - {{name: rr, type: fixed, x: 0, y: -half_track, heading: 0, r: 0.3}}
  - {{name: fl, type: steered, x: base, y: half_track, heading: 0, r: 0.3, actuated: [steer]}}
  - {{name: fr, type: steered, x: base, y: -half_track, heading: 0, r: 0.3, actuated: [steer]}}
""")
    assert any(e.has(sympy.Piecewise) for e in outputs(d).values()) == chosen
