"""Degrees of freedom equal the dimensions that motions reach, also if castor angles determine the motions."""

from __future__ import annotations

import pytest

from tests.analysis.mobility.test_couplings import AXLE, wheel
from tests.laws.common import derived
from tests.oracle import reach
from tests.oracle.draw import robot
from tests.oracle.freedom import castor_angles, freedom

CASTOR = wheel("c", "castor", -0.4, 0.15, d=0.2)
OTHER = wheel("e", "castor", 0.35, -0.2, d=-0.25)
TURNING = {
    # One motion is left at each angle of the castor, which turns as that motion turns it: a curve.
    "a fixed wheel and a castor on one shaft": ([AXLE[0], CASTOR], [("spin", ["a", "c"])], (1, 0, 1), (1,)),
    # First brackets turn castors alone: their twists are admissible ones.
    "two castors on one shaft": ([CASTOR, OTHER], [("spin", ["c", "e"])], (2, 0, 3), (2, 2, 3)),
    "two castors on one belt": ([CASTOR, OTHER], [("steer", ["c", "e"])], (2, 0, 3), (2, 3)),
    "two castors on one belt, and a wheel that steers": (
        [CASTOR, OTHER, wheel("s", "steered", 0.5, 0.4)], [("steer", ["c", "e"])], (1, 1, 3), (2, 3, 4)),
    "two castors on one shaft, and a wheel that steers": (
        [CASTOR, OTHER, wheel("s", "steered", 0.5, 0.4)], [("spin", ["c", "e"])], (1, 1, 3), (2, 3, 3, 4)),
    "shaft and belt": (
        [CASTOR, OTHER], [("spin", ["c", "e"]), ("steer", ["c", "e"])], (1, 0, 1), (1,)),
}  # fmt: skip


@pytest.mark.parametrize("case", TURNING)
def test_castors_turn_as_the_motion_turns_them(case: str) -> None:
    wheels, couplings, degrees, vector = TURNING[case]
    layout = {"wheels": wheels, "couplings": couplings}
    m = derived(layout).derivation.mobility
    found = freedom(layout)
    assert (m.degree_of_mobility, m.degree_of_steerability, m.dof) == degrees
    assert (found.mobility, found.steerability, found.dof) == degrees
    assert m.growth_vector == vector
    assert m.holonomic == (degrees[0] == degrees[2])


@pytest.mark.parametrize("seed", [0, 1, 2, 5, 8, 10, 13, 33])
@pytest.mark.parametrize("kind", ["castor steer", "castor spin", "none", "spin"])
def test_degrees_of_random_robots_are_the_ends_of_their_growth_vectors(kind: str, seed: int) -> None:
    m = derived(robot(seed, kind)).derivation.mobility
    assert m.ddof == m.degree_of_mobility == m.growth_vector[0] - m.degree_of_steerability
    assert m.dof == m.growth_vector[-1] - m.degree_of_steerability


@pytest.mark.parametrize("seed", [3, 10, 27, 33])
def test_two_admissible_twists_reach_what_a_simulation_reaches(seed: int) -> None:
    layout = robot(seed, "castor spin")
    m, castors = derived(layout).derivation.mobility, castor_angles(layout, seed)
    assert reach.free_twists(layout, castors).shape[1] == m.degree_of_maneuverability
    assert m.dof == reach.dof(layout, castors)
