"""The rigid fit from sums over pivots equals the fit about the mean of the contacts."""

from __future__ import annotations

import random
from fractions import Fraction
from pathlib import Path

import pytest

from tests.conftest import ROOT
from wmrgen import load
from wmrgen.analysis.kinematics import rigid
from wmrgen.analysis.kinematics.forward import forward
from wmrgen.analysis.kinematics.records import Formula, Locals
from wmrgen.analysis.kinematics.sensing import measurements
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.lower import lower
from wmrgen.ir.nodes import Op
from wmrgen.ir.pipeline import optimise

WIDE = ("nomad_xr4000", "neobotix_mpo_700", "kelly_4ws", "pr2", "tidybot2")


def robot(name: str) -> Robot:
    return load(ROOT / "robots" / f"{name}.yaml")


def about_the_mean(robot: Robot) -> Formula:
    """`forward` of a robot with the fit about the mean of its contacts."""
    names, formula = Locals(), forward(robot)
    twist, slip = rigid.fit_centred(measurements(robot, names).contacts, names)
    ports = (port for port, _ in formula.outputs)
    return names.formula("forward", formula.inputs, zip(ports, (*twist, slip), strict=True), formula.text)


@pytest.mark.parametrize("name", WIDE)
def test_the_same_twist_and_residual(name: str) -> None:
    collapsed, centred = lower(forward(robot(name))), lower(about_the_mean(robot(name)))
    assert collapsed != centred
    source = random.Random(name)
    for _ in range(50):
        given = {p.name: source.uniform(-4, 4) for p in centred.inputs if p.default is None}
        found, wanted = (evaluate(f, given, FLOAT64) for f in (collapsed, centred))
        assert found == pytest.approx(wanted, rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("name", WIDE)
def test_fewer_operations(name: str) -> None:
    def size(formula: Formula) -> int:
        (function,) = optimise((lower(formula),), name).functions
        return sum(node.op in (Op.ADD, Op.SUB, Op.MUL, Op.DIV) for node in function.nodes)

    assert size(forward(robot(name))) < size(about_the_mean(robot(name)))


def test_pivots_near_each_other_are_fitted_about_the_mean(tmp_path: Path) -> None:
    text = """
wmrgen: 1
name: narrow
wheels:
  - {{name: a, type: castor, x: {x}, y: 0, heading: 0, d: 0.1, r: 0.05, actuated: [spin, steer]}}
  - {{name: b, type: castor, x: -{x}, y: 0, heading: 0, d: 0.1, r: 0.05, actuated: [spin, steer]}}
"""
    path = tmp_path / "narrow.yaml"
    found = []
    for x in ("0.15", "0.25", "0.9"):
        path.write_text(text.format(x=x))
        found.append(rigid.spread(measurements(load(path)).contacts))
    assert found[0] is None
    for case, x in zip(found[1:], (Fraction(5, 2), Fraction(9)), strict=True):
        assert case is not None
        assert case.unit == Exact(Fraction(1, 10))
        assert case.away == ((Exact(x), Exact(0)), (Exact(-x), Exact(0)))
        assert case.least == Exact(x * x / 2)


def test_intervals_prove_a_positive_inertia() -> None:
    cosine = Poly.gen("cos", "a")
    assert rigid.surely_positive(10 - cosine * 3, [cosine, cosine])
    assert not rigid.surely_positive(10 - cosine * 5, [cosine, cosine])
    assert not rigid.surely_positive(10 - cosine, [cosine * 2, cosine * 2])
