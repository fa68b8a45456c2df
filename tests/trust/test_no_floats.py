"""No binary float enters the derivation: the matrices and expressions of every robot hold exact numbers only."""

from __future__ import annotations

import pytest
import sympy

from tests.robots import ROBOTS, of_gallery


@pytest.mark.parametrize("name", ROBOTS)
def test_no_float_in_any_stage(name: str) -> None:
    d = of_gallery(name)
    matrices = (d.J1, d.J2, d.C1f, d.C1s, d.pfaffian, d.null_space)
    functions = (d.inverse, d.forward, d.odometry, d.dynamics)
    for shown in (*matrices, *(e for outputs in functions for e in outputs.values())):
        assert not shown.atoms(sympy.Float)


@pytest.mark.parametrize("name", ["pioneer3dx", "pr2"])
def test_notebooks_show_formula_and_picture(name: str) -> None:
    d = of_gallery(name)
    assert d._repr_latex_().startswith("$$") and d._repr_latex_().endswith("$$")
    assert d._repr_svg_().startswith("<svg")
