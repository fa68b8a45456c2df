"""One random robot against the oracle: degrees, inverse and forward, in exact arithmetic, CasADi and NumPy."""

from __future__ import annotations

import math
import random
from typing import Any

import pytest

from tests.oracle import oracle
from tests.oracle.agreement import CAMPION, check_forward, check_inverse
from tests.oracle.freedom import Freedom, freedom
from tests.oracle.harness import Model
from wmrgen.errors import NotDerivableError
from wmrgen.ir.interpret import EXACT, evaluate_module

Layout = dict[str, Any]
Case = dict[str, float]
ODD = (0.0, -0.0, 1.0, -1.0)
QUARTERS = (0.0, -0.0, math.pi / 2, -math.pi / 2, math.pi)


def compare(layout: Layout, model: Model, seed: int, cases: int = 3) -> None:
    """AssertionError where anything disagrees."""
    free = degrees(layout)
    check_mobility(layout, model, free)
    rng = random.Random(seed)
    for k in range(cases):
        case = case_of(layout, model, "inverse", rng, odd=k == cases - 1)
        for backend, found in evaluated(model, "inverse", case).items():
            try:
                check_inverse(layout, free, case, found, 1e-7)
            except AssertionError as e:
                raise AssertionError(backend, "inverse", case, found, *e.args) from e
        sensed = case_of(layout, model, "forward", rng, odd=False)
        for backend, found in evaluated(model, "forward", sensed).items():
            try:
                check_forward(layout, sensed, found, 1e-8)
            except AssertionError as e:
                raise AssertionError(backend, "forward", sensed, found, *e.args) from e


def degrees(layout: Layout) -> Freedom:
    """By Newton's method where joints are coupled, else by ranks alone."""
    if layout["couplings"]:
        return freedom(layout)
    degree = oracle.mobility(layout)
    return Freedom(degree["degree_of_mobility"], degree["degree_of_steerability"], -1)


def check_mobility(layout: Layout, model: Model, free: Freedom) -> None:
    """Degrees, ranks, type and null space, and that they fit each other."""
    m = model.derivation.mobility
    found = (m.degree_of_mobility, m.degree_of_steerability, m.dof)
    wanted = (free.mobility, free.steerability, free.dof if free.dof >= 0 else m.dof)
    assert found == wanted, ("degrees", found, wanted)
    assert m.rank_C1f.value == oracle.rank(oracle.sliding_rows(layout, "fixed", {}))
    consistent(m)
    check_growth(model)


def check_growth(model: Model) -> None:
    """The brackets of the posture model are those of the mobility, where its steering angles are free."""
    m = model.derivation.mobility
    if m.degree_of_mobility == 0 or len(m.basis_wheels) > m.degree_of_steerability:
        with pytest.raises(NotDerivableError):
            _ = model.derivation.growth
    elif not {g.name for column in m.null_space for p in column for g in p.generators} - set(m.basis_wheels):
        assert model.derivation.growth.vector == m.growth_vector


def consistent(m: Any) -> None:
    """What holds of the degrees of any robot."""
    assert m.ddof == m.degree_of_mobility == 3 - m.rank_C1.value == len(m.null_space)
    assert m.degree_of_maneuverability == m.degree_of_mobility + m.degree_of_steerability <= 3
    assert m.ddof <= m.dof <= 3 and m.degree_of_maneuverability <= m.dof
    assert (m.ddof == 0) == (m.dof == 0)
    assert m.holonomic == (m.ddof == m.dof) and m.omnidirectional == (m.ddof == 3)
    assert m.degenerate == ((m.degree_of_mobility, m.degree_of_steerability) not in CAMPION)
    assert (m.robot_type is None) == m.degenerate
    assert list(m.growth_vector) == sorted(m.growth_vector)
    assert m.growth_vector[0] == m.degree_of_maneuverability
    assert m.growth_vector[-1] - m.degree_of_steerability == m.dof
    if m.degree_of_mobility:
        assert any(f"= {m.degree_of_mobility}; delta_M" in reason for reason in m.reasons)


def case_of(layout: Layout, model: Model, function: str, rng: random.Random, odd: bool) -> Case:
    """Inputs, parameters apart; coupled joints stand and turn alike. ``odd``: zeros of both signs and quarter turns."""
    lead = {
        j: oracle.leaders(layout, "spin" if j == "spin" else "steer") for j in ("spin", "steer", "steer_rate")
    }
    drawn: Case = {}
    inputs = [name for name in model.ports(function)[0] if name not in model.nominal]
    for name in inputs:
        wheel, _, joint = name.partition(".")
        key = f"{lead[joint][wheel]}.{joint}" if joint and function == "inverse" else name
        if key not in drawn:
            drawn[key] = rng.choice(QUARTERS if joint else ODD) if odd else rng.randint(-2000, 2000) / 1000
        drawn[name] = drawn[key]
    return {name: drawn[name] for name in inputs}


def evaluated(model: Model, function: str, case: Case) -> dict[str, Case]:
    """The function in every backend that evaluates."""
    exact = evaluate_module(model.derivation.raw_module, function, case, EXACT)
    numpy = getattr(model.numpy, function)(**case)
    return {
        "exact": {k: float(v) for k, v in exact.items()},
        "casadi": model.call(function, case),
        "numpy": {k: float(v) for k, v in numpy.items()},
    }
