"""Six hundred random robots against the oracle in exact arithmetic, CasADi and NumPy; C for a sample.

A robot with couplings that have no model must be refused in words, and no other one may be.
"""

from __future__ import annotations

import random
import shutil
from pathlib import Path

import pytest

from tests.laws.common import command_line
from tests.oracle.agreement import check_forward, check_inverse, refused
from tests.oracle.compare import case_of, compare, degrees
from tests.oracle.draw import KINDS, moved, robot
from tests.oracle.harness import Model, robot_text
from wmrgen.errors import NotDerivableError

PLAIN, COUPLED = 440, 20  # robots without couplings, and of each kind of coupling
COMPARED = ("inverse", "forward")
WHOLE = 8  # of so many robots one is made with every function: the others take no part in what is compared


def drawn(everyday_plain: int, everyday_coupled: int, step: int = 1) -> list[object]:
    """(kind, seed), the first of each kind every day."""
    found: list[object] = []
    for kind in KINDS:
        count, few = (PLAIN, everyday_plain) if kind == "none" else (COUPLED, everyday_coupled)
        for seed in range(0, count, step):
            marks = [] if seed < few * step else [pytest.mark.slow]
            found.append(pytest.param(kind, seed, marks=marks, id=f"{kind.replace(' ', '_')}_{seed}"))
    return found


@pytest.mark.parametrize(("kind", "seed"), drawn(10, 1))
def test_a_random_robot(kind: str, seed: int, tmp_path: Path) -> None:
    layout = robot(seed, kind)
    if refused(layout):
        with pytest.raises(NotDerivableError, match="cannot be coupled"):
            Model.of(robot_text(layout), tmp_path)
        return
    functions = COMPARED if seed % WHOLE else None
    compare(layout, Model.of(robot_text(layout), tmp_path, functions=functions), seed)


@pytest.mark.parametrize(("kind", "seed"), drawn(6, 1, step=8))
def test_a_random_robot_with_everything_tunable(kind: str, seed: int, tmp_path: Path) -> None:
    """Every length and angle stays a symbol: closed forms in lowest terms have the values of the oracle."""
    layout = robot(seed, kind)
    if refused(layout):
        return
    compare(layout, Model.of(robot_text(layout, tunable=True), tmp_path, functions=COMPARED), seed)


SCALES = (("0.0001", "0"), ("0.001", "0"), ("1000", "0"), ("10000", "0"), ("1", "10000"))


@pytest.mark.parametrize(("kind", "seed"), [("synchro", 6), *drawn(0, 1, step=3)])
def test_degrees_do_not_depend_on_the_unit_of_length(kind: str, seed: int, tmp_path: Path) -> None:
    """The robot from a tenth of a millimetre to ten kilometres, and ten kilometres away from P."""
    layout = robot(seed, kind)
    if refused(layout):
        return
    wanted = _degrees(Model.of(robot_text(layout), tmp_path))
    for scale, shift in SCALES:
        found = _degrees(Model.of(robot_text(moved(layout, scale, shift)), tmp_path))
        assert found == wanted, (scale, shift)


def _degrees(model: Model) -> tuple[object, ...]:
    m = model.derivation.mobility
    return m.degree_of_mobility, m.degree_of_steerability, m.dof, m.growth_vector, m.rank_C1f.value


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
@pytest.mark.parametrize(("kind", "seed"), drawn(0, 0, step=10))
def test_a_random_robot_in_c(kind: str, seed: int, tmp_path: Path) -> None:
    """The C in float, through the command line; twists of ordinary size."""
    layout = robot(seed, kind)
    if refused(layout):
        return
    model = Model.of(robot_text(layout), tmp_path, functions=COMPARED)
    free, rng = degrees(layout), random.Random(seed)
    cases = [case_of(layout, model, "inverse", rng, odd=k == 3) for k in range(4)]
    for case, found in zip(cases, command_line(model.path, "inverse", cases, "c", tmp_path), strict=True):
        check_inverse(layout, free, case, found, 2e-4)
    sensed = [case_of(layout, model, "forward", rng, odd=False) for _ in range(3)]
    for case, found in zip(sensed, command_line(model.path, "forward", sensed, "c", tmp_path), strict=True):
        check_forward(layout, case, found, 1e-4)
