"""A N = 0 exactly, and ranks that do not depend on how they are found."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given

from tests.laws.common import NAMES, derived, gallery, law, turning
from tests.laws.layouts import layouts
from tests.oracle import oracle
from tests.oracle.harness import Model, rank

Layout = dict[str, Any]
CIRCLE = [Fraction(2, 7), Fraction(-5, 3)]  # half-angle tangents: rational points of the unit circle


def at_point(matrix: sympy.Matrix, model: Model, half: Fraction) -> sympy.Matrix:
    """The matrix with every steering angle at another exact point of the circle, parameters exact."""
    values: dict[Any, Any] = {}
    order = [w.name + "_steer" for w in model.robot.wheels]
    for symbol in matrix.free_symbols:
        t = half + Fraction(order.index(symbol.name), 11) if symbol.name in order else half
        c, s = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        values[sympy.cos(symbol)] = sympy.Rational(c.numerator, c.denominator)
        values[sympy.sin(symbol)] = sympy.Rational(s.numerator, s.denominator)
        parameter = {p.name: p.nominal for p in model.robot.parameters}.get(symbol.name)
        if parameter is not None:
            values[symbol] = sympy.Add(*(
                sympy.Rational(q.numerator, q.denominator) * sympy.sqrt(n)
                for q, n in zip(parameter.parts, (1, 2, 3, 6), strict=True)
            ))  # fmt: skip
    return matrix.xreplace(values)


def check_null_space(model: Model, layout: Layout) -> None:
    """Exactly zero for every row that holds at any steering; zero at the ICR for the rest."""
    d = model.derivation
    assert d.null_space.shape == (3, d.mobility.degree_of_mobility)
    chosen = [w.name for w in model.robot.wheels if w.type == "steered"]
    basis = [d.C1s[i, :] for i, n in enumerate(chosen) if n in d.mobility.basis_wheels]
    exact = d.C1f.col_join(sympy.Matrix.vstack(*basis)) if basis else d.C1f
    if exact.rows and d.null_space.cols and d.mobility.rank_C1f.exact == d.mobility.rank_C1f.value:
        for half in CIRCLE:
            product = at_point(exact, model, half) * at_point(d.null_space, model, half)
            assert all(sympy.expand(entry) == 0 for entry in product)
    steer = oracle.admissible_steering(layout)
    if steer is not None:
        found = np.vstack([model.evaluate(d.C1f, steer), model.evaluate(d.C1s, steer)])
        null = model.evaluate(d.null_space, steer)
        if found.size and null.size:
            assert np.abs(found @ null).max() <= 1e-9 * max(1.0, np.abs(null).max())
        assert rank(null) in (d.mobility.degree_of_mobility, 0)


def check_ranks(model: Model, layout: Layout) -> None:
    m = model.derivation.mobility
    found = {k: getattr(m, k) for k in ("degree_of_mobility", "degree_of_steerability")}
    found |= {"rank_C1f": m.rank_C1f.value, "rank_C1": m.rank_C1.value}
    assert found == oracle.mobility(layout)
    assert all(
        r.exact in (None, r.value) for r in (m.rank_C1f, m.rank_C1)
    )  # no layout here is near a singular one
    assert m.degree_of_maneuverability == m.degree_of_mobility + m.degree_of_steerability
    assert m.ddof == m.degree_of_mobility <= m.dof <= 3
    assert m.holonomic == (m.ddof == m.dof) and m.omnidirectional == (m.ddof == 3)


@pytest.mark.parametrize("name", NAMES)
def test_null_space_of_the_gallery(name: str) -> None:
    check_null_space(*gallery(name))


@pytest.mark.parametrize("name", NAMES)
def test_ranks_of_the_gallery(name: str) -> None:
    check_ranks(*gallery(name))


@law(40)
@given(layouts())
def test_null_space(layout: Layout) -> None:
    check_null_space(derived(layout), layout)


@law(40)
@given(layouts())
def test_ranks(layout: Layout) -> None:
    check_ranks(derived(layout), layout)


@law(20)
@given(layouts())
def test_rows_are_contact_velocities(layout: Layout) -> None:
    """J1, J2 and C1 at random steering angles against the oracle's rows."""
    model = derived(layout)
    steer = {n: 0.3 * (i + 1) for i, n in enumerate(turning(layout))}
    rows = {
        w["name"]: {kind: r for kind, *r in oracle.wheel_rows(w, steer.get(w["name"], 0.0))}
        for w in layout["wheels"]
    }
    rolls = [w["name"] for w in layout["wheels"] if w["type"] != "spherical" or "driven" in w]
    rolling: list[Any] = [rows[name]["rolling"] for name in rolls]
    d = model.derivation
    pairs = [
        (d.J1, np.array([r[0] for r in rolling]).reshape(-1, 3)),
        (d.J2, np.diag([-r[1] for r in rolling])),
        (d.C1f, oracle.sliding_rows(layout, "fixed", steer)),
        (d.C1s, oracle.sliding_rows(layout, "steered", steer)),
    ]
    for matrix, rows_found in pairs:
        np.testing.assert_allclose(model.evaluate(matrix, steer), rows_found, atol=1e-12)
