"""Both sides of the thresholds that the analysis decides by, and known values that a wrong term would change."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest

from tests.laws.common import derived, gallery
from tests.laws.test_couplings import STEERED, wheel
from tests.oracle.harness import named
from wmrgen.kinematics.odometry import SWITCH, WORST_ERROR
from wmrgen.mobility.ranks import bracket, null_basis, numeric_rank

ASKEW = [wheel("a", "fixed", 0.0, 0.2), wheel("b", "fixed", 0.0, -0.2)]
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


@pytest.mark.parametrize(("gap", "rank"), [(1e-7, 2), (1e-8, 2), (4e-9, 2), (4e-10, 1), (1e-12, 1)])
def test_the_rank_is_taken_at_a_billionth(gap: float, rank: int) -> None:
    rows = np.array([[0.0, 1.0, 0.0], [0.0, 1.0, gap]])
    assert numeric_rank(rows)[0] == rank
    assert len(null_basis(rows)) == 3 - rank


@pytest.mark.parametrize(("gap", "mobility"), [("1e-7", 1), ("1e-8", 1), ("1e-10", 2)])
def test_axles_apart_by_more_than_rounding_are_two(gap: str, mobility: int) -> None:
    """Two parallel axles a tenth of a micrometre apart lock the turn; a tenth of a nanometre is rounding."""
    wheels = [ASKEW[0], ASKEW[1] | {"text": {"x": gap}}]
    m = derived({"wheels": wheels, "couplings": []}).derivation.mobility
    assert m.degree_of_mobility == mobility == 3 - m.rank_C1f.value
    assert m.rank_C1f.exact == 2


@pytest.mark.parametrize(
    ("degrees", "snapped"), [(0.05, True), (0.0571, True), (0.0575, False), (0.2, False)]
)
@pytest.mark.parametrize("side", [1, -1])
def test_an_angle_snaps_within_a_thousandth(degrees: float, snapped: bool, side: int) -> None:
    """1 mrad is 0.0573 degrees."""
    angle = side * math.radians(degrees)
    wheels = [ASKEW[0], ASKEW[1] | {"heading": angle}]
    model = derived({"wheels": wheels, "couplings": []})
    assert model.robot.wheels[1].heading == pytest.approx(0.0 if snapped else angle, abs=1e-12)
    assert any("taken as 0" in note for note in model.robot.notes) == snapped


def test_the_centroid_of_belt_steered_wheels_keeps_its_velocity() -> None:
    """Rotation is taken away about the wheels' centroid, here (0.4, 0.5): v + omega z x c, by hand."""
    shifted: list[Any] = [w | {"x": w["x"] + 13 / 30, "y": w["y"] + 0.5} for w in STEERED]
    texts = [{"x": f"{w['x']} + 13/30", "y": f"{w['y']} + 1/2"} for w in STEERED]
    wheels = [w | {"text": t} for w, t in zip(shifted, texts, strict=True)]
    model = derived({"wheels": wheels, "couplings": [("steer", ["a", "b", "c"])]})
    found = model.call("inverse", named([0.3, -0.2, 0.7]))
    v = complex(0.3 - 0.7 * 0.5, -0.2 + 0.7 * 0.4)
    for n in "abc":
        along = (
            found[f"{n}.spin"] * 0.1 * complex(math.cos(found[f"{n}.steer"]), math.sin(found[f"{n}.steer"]))
        )
        assert abs(along - v) < 1e-12
    places = [complex(w["x"] - 0.4, w["y"] - 0.5) for w in shifted]
    assert found["slip"] == pytest.approx(0.7 * math.sqrt(sum(abs(p) ** 2 for p in places) / 3))


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


def test_the_series_of_odometry_is_as_good_as_the_quotient() -> None:
    """The chord is sinc(h) to a few units in the last place, the series as far as it is used included."""
    assert float(SWITCH) ** 8 / math.factorial(9) <= 2.0**-53 and WORST_ERROR <= 2.0**-53
    model, _ = gallery("unicycle")
    for k in range(1, 400):
        h = Fraction(k, 2000)
        out = model.call("odometry", {"vx": 1.0, "omega": float(2 * h), "dt": 1.0})
        with mpmath.workdps(30):
            half = mpmath.mpf(float(2 * h)) / 2
            chord = mpmath.sin(half) / half
        assert math.hypot(out["x"], out["y"]) == pytest.approx(float(chord), rel=0, abs=3.4e-16), h
