"""Tzafestas (2.6)-(2.8b): symbolic generalised inverses with their condition, on any matrix and on robots."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import sympy

import wmrgen
from tests.conftest import ROOT
from textbook import generalised_inverse, penrose
from wmrgen.errors import NotDerivableError

a, b, t = (sympy.Symbol(n, real=True) for n in "abt")
TALL = sympy.Matrix([[1, 2], [3, -1], [2, 5]])
TURNED = sympy.Matrix([[sympy.cos(t), sympy.cos(t)], [sympy.sin(t), sympy.sin(t)], [1 / a, -1 / a]])
DEFICIENT = sympy.Matrix([[1, 2, 3], [2, 4, 6], [0, 1, 1]])


@pytest.mark.parametrize(
    ("J", "kind", "rank"),
    [
        (TALL, "left", 2),
        (TALL.T, "right", 2),
        (sympy.Matrix([[a, 1], [0, b]]), "inverse", 2),
        (TURNED, "left", 2),
        (sympy.Matrix([[a, b, 1]]), "right", 1),
    ],
)
def test_penrose(J: sympy.Matrix, kind: str, rank: int) -> None:
    found = generalised_inverse(J)
    assert (found.kind, found.rank) == (kind, rank)
    assert all(sympy.simplify(e) == 0 for m in penrose(J, found.matrix) for e in m)
    assert str(rank) in found.condition or kind == "inverse"


def test_the_condition_is_said() -> None:
    assert "full column rank 2" in generalised_inverse(TALL).condition
    assert "det(J J^T) is not 0" in generalised_inverse(sympy.Matrix([[a, b, 0]])).condition
    assert "det J is not 0" in generalised_inverse(sympy.Matrix([[a, 1], [0, b]])).condition
    with pytest.raises(NotDerivableError, match="rank 2 has neither a left inverse"):
        generalised_inverse(DEFICIENT)


@pytest.mark.parametrize(
    "J",
    [DEFICIENT, sympy.Matrix([[a, 2 * a], [b, 2 * b]]), sympy.zeros(2, 3), sympy.Matrix([[1, 1], [1, 1]])],
)
def test_rank_deficient(J: sympy.Matrix) -> None:
    found = generalised_inverse(J, full=True)
    assert found.kind == "full"
    assert all(sympy.simplify(e) == 0 for m in penrose(J, found.matrix) for e in m)
    if not J.free_symbols:
        np.testing.assert_allclose(
            np.array(found.matrix, float), np.linalg.pinv(np.array(J, float)), atol=1e-12
        )


def test_tzafestas_footnote_3_and_2_82() -> None:
    """J+ of the differential drive and of four mecanum wheels, from the texts' own matrices."""
    half = sympy.Matrix(
        [[sympy.cos(t) / 2, sympy.cos(t) / 2], [sympy.sin(t) / 2] * 2, [1 / (2 * a), -1 / (2 * a)]]
    )
    expected = sympy.Matrix([[sympy.cos(t), sympy.sin(t), a], [sympy.cos(t), sympy.sin(t), -a]])
    assert sympy.simplify(generalised_inverse(half).matrix - expected) == sympy.zeros(2, 3)
    s = a + b
    inverse = sympy.Matrix([[-1, 1, s], [1, 1, -s], [-1, 1, -s], [1, 1, s]])
    forward = sympy.Matrix([[-1, 1, -1, 1], [1, 1, 1, 1], [1 / s, -1 / s, -1 / s, 1 / s]]) / 4
    assert sympy.simplify(generalised_inverse(inverse).matrix - forward) == sympy.zeros(3, 4)


@pytest.mark.parametrize("name", ["kuka_youbot", "lekiwi", "festo_robotino"])
def test_of_a_robot(name: str) -> None:
    """The generalised inverse of a robot's J1 gives its forward kinematics."""
    path: Path = ROOT / "robots" / f"{name}.yaml"
    d = wmrgen.derive(wmrgen.load(path))
    found = generalised_inverse(d.J1)
    assert found.rank == 3 and found.kind in ("left", "inverse")
    numbers = {s: sympy.Rational(*p.nominal.rational().as_integer_ratio()) for s in d.J1.free_symbols
               for p in d.robot.parameters if p.name == s.name}  # fmt: skip
    J = np.array(d.J1.xreplace(numbers), float)
    np.testing.assert_allclose(np.array(found.matrix.xreplace(numbers), float), np.linalg.pinv(J), atol=1e-10)
