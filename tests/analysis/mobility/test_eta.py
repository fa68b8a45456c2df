"""The coordinates eta of admissible twists are speeds of the steered wheels' pivots at steering angles of zero."""

from __future__ import annotations

import pytest
import sympy

from tests.robots import of_text
from wmrgen.functions.models.sheet import lines, sheet_of
from wmrgen.geometry.symbolic import signal
from wmrgen.report.sections.rows import null_space


@pytest.mark.parametrize("heading", ["0", "pi/2"])
@pytest.mark.parametrize("rear", ["0", "-0.3", "0.2"])
def test_a_bicycle_moves_its_pivot_at_eta(heading: str, rear: str) -> None:
    """Along its heading, also where P stands or moves at another speed."""
    (vx, vy, omega) = of_text(f"""
wmrgen: 1
name: bicycle
wheels:
  - {{name: rear, type: fixed, x: {rear}, y: 0, heading: 0, r: 0.1}}
  - {{name: front, type: steered, x: 0.8, y: 0, heading: {heading}, r: 0.1}}
""").null_space.subs(signal("front.steer"), 0)
    assert abs(vx) + abs(vy + omega * 0.8) == pytest.approx(1)
    assert (vx == 0) == (heading == "pi/2")


def test_axles_that_are_parallel_by_a_parameter_only_translate() -> None:
    """The yaw rate of the null space, cos(a), vanishes where a is nominal: no column is divided by it."""
    derivation = of_text("""
wmrgen: 1
name: parallel
parameters: {a: {value: pi/2, tunable: true}}
wheels:
  - {name: one, type: fixed, x: -0.2, y: -0.4, heading: a, r: 0.1}
  - {name: two, type: fixed, x: 0.3, y: 0.4, heading: -pi/2, r: 0.1}
""")
    columns = derivation.null_space
    vx, vy, omega = columns.subs(dict.fromkeys(columns.free_symbols, sympy.pi / 2))
    assert (vx, abs(vy), omega) == (0, 1, 0)
    assert "translation in a fixed direction where the parameters are nominal." in "\n".join(
        null_space(derivation)
    )
    assert "with:   a = 1.57079632679" in lines(sheet_of("twist", derivation.system("twist", symbolic=True)))
