"""Steering next to a singularity: the centre of rotation down to 1e-8 m from a wheel.

Heading within 5e-7 rad, speed within 3 ulp of the true values of the float32 inputs, with and without a fused
multiply-add.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction

import pytest
import sympy

from benchmarks.singularity import HEADING, SPEED, TARGETS, Values, module, nearby, twists, worst
from wmrgen.analysis.kinematics.pivots import components
from wmrgen.analysis.kinematics.records import Locals
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.symbolic import Compensated, expression
from wmrgen.ir.interpret import FLOAT32, evaluate
from wmrgen.ir.kernels import expand
from wmrgen.ir.nodes import Module, Op

CHOICES = [("inline", target) for target in TARGETS] + [("libm", "m4f")]


def predicted(code: Module, name: str, cases: Sequence[Values]) -> list[Values]:
    return [evaluate(code.function(name), case, FLOAT32) for case in cases]


@pytest.mark.parametrize(("math", "target"), CHOICES)
def test_heading_and_speed(math: str, target: str) -> None:
    expanded = expand(module(), "float", math, target)
    heading, speed, near = worst(expanded, twists(150, random.Random(f"{math} {target}")), predicted)
    assert heading <= HEADING
    assert speed <= SPEED
    assert near > 40


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("apart", [1e-4, 1e-2, 1.0])
def test_unless_the_robot_file_asks_errors_are_those_of_pivots_a_hair_away(target: str, apart: float) -> None:
    """Of 0.1 um; and no sum is formed of more than its two terms."""
    plain = module(precise=False)
    assert all(node.op is not Op.COMPENSATED for f in plain.functions for node in f.nodes)
    expanded = expand(plain, "float", "inline", target)
    cases = twists(100, random.Random(f"{apart} {target}"), apart)
    heading, _, _ = worst(expanded, cases, predicted)
    assert heading <= HEADING + 1e-7 / apart


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_compiled(target: str) -> None:
    heading, speed = nearby(target, 20_000)
    assert heading <= HEADING
    assert speed <= SPEED


def _component(name: str, factor: Poly | int) -> Poly:
    return Poly.gen("input", name) * factor


@pytest.mark.parametrize(
    ("velocity", "compensated"),
    [
        # The pivot may stand while the robot turns.
        (
            (_component("vx", 1) - _component("omega", 2), _component("vy", 1) + _component("omega", 3)),
            (True, True),
        ),
        ((_component("vx", 1) - _component("omega", 2), _component("vy", 1)), (True, False)),
        ((_component("vx", -1) - _component("omega", Poly.gen("param", "y")), Poly({})), (True, False)),
        # The other component says that it does not, or makes it small beside itself.
        ((_component("vx", 1) - _component("omega", 2), _component("omega", Fraction(1, 4))), (False, False)),
        ((_component("vx", 1) - _component("omega", 2), _component("omega", Fraction(1, 5))), (True, False)),
        # No sum of two inputs, one as it is.
        ((_component("vx", 2) - _component("omega", 2), _component("vy", 1)), (False, False)),
        ((_component("vx", 1) + _component("vy", 2) - _component("omega", 2), Poly({})), (False, False)),
        ((_component("vx", 1) - _component("omega", Poly.gen("cos", "front")), Poly({})), (False, False)),
        ((_component("vx", 1) - Poly.gen("local", "omega_driven") * 2, Poly({})), (False, False)),
    ],
)
def test_sums_from_whose_ratio_a_direction_is_taken_are_compensated(
    velocity: tuple[Poly, Poly], compensated: tuple[bool, bool]
) -> None:
    names = Locals()
    results = components(velocity, names, ("a", ""), ("b", ""), precise=True)
    values = dict(names.items)
    assert tuple(isinstance(values.get(r), Compensated) for r in results) == compensated
    for result, form in zip(results, velocity, strict=True):
        assert sympy.expand(values.get(result, result) - expression(form)) == 0
