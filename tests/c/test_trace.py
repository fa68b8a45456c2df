"""Comments of generated C: what they call a value is that value, also where nobody looked for it."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tests.robots import of_gallery
from wmrgen.backends.c99.emit import printed, sources, unit
from wmrgen.backends.c99.trace import places_in, quantity, traced
from wmrgen.backends.registry import Facts
from wmrgen.ir.calls import by_name, with_places
from wmrgen.ir.interpret import FLOAT64, evaluate, evaluate_nodes
from wmrgen.ir.nodes import Role, contract

ROBOTS = ("wpilib_swervebot", "nomad_xr4000", "ackermann_car", "pioneer3dx")


@pytest.mark.parametrize("robot", ROBOTS)
def test_names_are_true(robot: str) -> None:
    """At random points, in float64: the named node of the code and the named result of the formula agree."""
    derivation = of_gallery(robot)
    raw = {f.name: f for f in derivation.raw_module.functions}
    module = traced(derivation.c_module, derivation.raw_module.functions)
    random = np.random.default_rng(4)
    seen = 0
    for function in module.functions:
        formula = raw[function.variant_of or function.name]
        place = dict(formula.named)
        for _ in range(20):
            case = {port.name: float(random.uniform(-2, 2)) for port in contract(formula)}
            known = dict(case)
            if module.prepare and any(port.role is Role.PREPARED for port in function.inputs):
                known |= evaluate(module.prepare, {}, FLOAT64)
            plain, at = with_places(function, by_name(module.kernels))
            values = evaluate_nodes(plain, known, FLOAT64)
            code, exact = [values[k] for k in at], evaluate_nodes(formula, case, FLOAT64)
            for name, node in function.named:
                assert code[node] == pytest.approx(exact[place[name]], rel=1e-9, abs=1e-9), name
                seen += 1
    assert seen >= 20 * 4


def test_comments_and_lines() -> None:
    derivation = of_gallery("wpilib_swervebot")
    functions = unit(derivation.c_module, formulas=derivation.raw_module.functions)
    source = printed(functions, Facts())[1]
    assert re.search(r"const float \w+ = .*; /\* front_left: a, back_left: a \*/$", source, flags=re.M)
    lines = source.splitlines()
    found = {p.function: p for p in places_in("wpilib_swervebot.c", source)}
    inverse = found["wpilib_swervebot_inverse"]
    assert lines[inverse.line - 1].startswith("void wpilib_swervebot_inverse(")
    texts = {text for text, _ in inverse.quantities}
    assert "front_left.spin" in texts and sum("front_left: " in text for text in texts) >= 2
    for text, number in inverse.quantities:
        assert text in lines[number - 1]


def test_without_formulas_nothing_is_named() -> None:
    derivation = of_gallery("wpilib_swervebot")
    source = sources(derivation.c_module)[1]
    assert "; /*" not in source


def test_quantities() -> None:
    assert quantity("left_front_along") == "left_front: u"
    assert quantity("half_turn") == "h" and quantity("n01") == "HtH[0][1]" and quantity("b2") == "Htz[2]"
    assert quantity("over_c1") == "over c1"
