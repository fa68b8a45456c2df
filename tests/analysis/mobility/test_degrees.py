"""Degrees, ranks, null space and growth vector of one robot are consistent; both sides of their thresholds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import wmrgen
from tests.analysis.mobility.test_couplings import AXLE
from tests.laws.common import NAMES, derived, gallery
from tests.oracle.compare import consistent
from wmrgen.analysis.mobility.configure import spin_row
from wmrgen.analysis.mobility.ranks import bracket, null_basis, numeric_rank
from wmrgen.robotfile.load import read_text

# Campion's five types and two degenerate robots: dimensions of the bracket filtration of pose and steering angles
GROWTH = {
    "pioneer3dx": (2, 3),
    "bicycle": (2, 3, 4),
    "festo_robotino": (3,),
    "textbook_omni_steer": (3, 4),
    "textbook_two_steer": (3, 5),
    "synchro_drive": (2, 3),
    "locked_bicycle": (1,),
}


@pytest.mark.parametrize("name", NAMES)
def test_degrees_of_the_gallery(name: str) -> None:
    derivation = gallery(name)[0].derivation
    consistent(derivation.mobility)
    data = derivation.model()
    assert data["ddof"] == data["degree_of_mobility"] == len(derivation.null_space.T.tolist())
    assert data["ddof"] <= data["dof"] <= 3


@pytest.mark.parametrize(("gap", "rank"), [(1e-7, 2), (1e-8, 2), (4e-9, 2), (4e-10, 1), (1e-12, 1)])
def test_the_rank_is_taken_at_a_billionth(gap: float, rank: int) -> None:
    rows = np.array([[0.0, 1.0, 0.0], [0.0, 1.0, gap]])
    assert numeric_rank(rows)[0] == rank
    assert len(null_basis(rows)) == 3 - rank


@pytest.mark.parametrize(("gap", "mobility"), [("1e-7", 1), ("1e-8", 1), ("1e-10", 2)])
def test_axles_apart_by_more_than_rounding_are_two(gap: str, mobility: int) -> None:
    """Two parallel axles a tenth of a micrometre apart lock the turn; a tenth of a nanometre is rounding."""
    wheels = [AXLE[0], AXLE[1] | {"text": {"x": gap}}]
    m = derived({"wheels": wheels, "couplings": []}, extra="tolerance: 0\n").derivation.mobility
    assert m.degree_of_mobility == mobility == 3 - m.rank_C1f.value
    assert m.rank_C1f.exact == 2


@pytest.mark.parametrize("name", GROWTH)
def test_known_growth_vectors(name: str) -> None:
    m = gallery(name)[0].derivation.mobility
    assert m.growth_vector == GROWTH[name]
    assert m.degree_of_nonholonomy == len(GROWTH[name])


def test_the_bracket_is_the_commutator_of_motions() -> None:
    """[A, B] of the 3 x 3 matrices of two twists."""

    def matrix(t: Any) -> Any:
        return np.array([[0.0, -t[2], t[0]], [t[2], 0.0, t[1]], [0.0, 0.0, 0.0]])

    a, b = np.array([0.3, -0.7, 1.1]), np.array([-0.4, 0.9, 0.6])
    wanted = matrix(a) @ matrix(b) - matrix(b) @ matrix(a)
    np.testing.assert_allclose(matrix(bracket(a, b)), wanted, atol=1e-15)


@pytest.mark.parametrize("gamma", [0.0, np.pi / 4, -np.pi / 4, 0.3, -np.pi / 3])
@pytest.mark.parametrize("heading", [0.0, np.pi / 2, -2.2])
def test_spins_that_couplings_compare_are_those_of_the_rolling_equation(gamma: float, heading: float) -> None:
    """[sin(a + b + g), -cos(a + b + g), -l cos(b + g)] xi = r cos g spin, with rollers and without."""
    robot = wmrgen.robot_of(read_text(f"""
wmrgen: 1
name: pair
wheels:
  - {{name: own, type: swedish, x: 0.3, y: -0.2, heading: {heading!r}, gamma: {gamma!r}, r: 0.05}}
  - {{name: plain, type: fixed, x: 0.1, y: 0.4, heading: {heading!r}, r: 0.07}}
""", "pair.yaml"))  # fmt: skip
    for w, g, r in zip(robot.wheels, (gamma, 0.0), (0.05, 0.07), strict=True):
        turned, alpha = heading + np.pi / 2 + g, np.angle(w.pivot)
        row = np.array([np.sin(turned), -np.cos(turned), -abs(w.pivot) * np.cos(turned - alpha)])
        assert spin_row(robot, w.index, {}) == pytest.approx(row / (r * np.cos(g)))
