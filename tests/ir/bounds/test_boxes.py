"""Bounds of whole functions: they exist for robots with unusual formulas, and hold where operands cancel."""

from __future__ import annotations

import numpy as np
import pytest

from tests.ir.bounds.gallery import LIBM_C
from tests.ir.bounds.observe import choices, draw
from tests.ir.bounds.search import shares
from tests.robots import of_text
from wmrgen.ir.bounds.analysis import analysed
from wmrgen.ir.bounds.assumptions import LIBM
from wmrgen.ir.bounds.robot import functions
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Op, Port, Role

ROBOTS = {
    # (vx, vy) are no part of the residual, omega alone is.
    "castors anywhere": """
  - {name: a, type: castor, x: 0.5, y: 0.5, heading: 0, d: -0.1, r: 0.1, actuated: [spin, steer]}
  - {name: b, type: castor, x: -0.3, y: 0.1, heading: 0, d: 0.1, r: 0.1, actuated: [spin, steer]}
  - {name: c, type: castor, x: 0.1, y: -0.3, heading: 0, d: 0.05, r: 0.1, actuated: [spin, steer]}
limits: {vx: 1, omega: 1}
""",
    # A quotient, and no sine.
    "one wheel, hardly steered": """
  - {name: a, type: steered, x: 0.4, y: 0.3, heading: pi, r: 0.1}
limits: {vx: 1, omega: 1, steer_rate: 5, steer: [-0.01, 0.01]}
""",
}


@pytest.mark.parametrize("name", ROBOTS)
def test_bounds_are_found_and_hold(name: str) -> None:
    derivation = of_text(f"wmrgen: 1\nname: robot\nwheels:{ROBOTS[name]}")
    printed = {f.name: f for f in functions(derivation.c_module)}
    found = [b for b in derivation.bounds_of(LIBM_C).functions if not b.unknown and b.inputs]
    assert found
    for bound in found:
        function = printed[bound.name]
        points = draw(bound.inputs | choices(function), 3000, 1)
        for output, share in shares(function, bound, points).items():
            assert share.max() <= 1, f"{bound.name}: {output}"


def _inputs(*names: str) -> tuple[Builder, dict[str, int], tuple[Port, ...]]:
    b = Builder()
    return b, {n: b.input(n) for n in names}, tuple(Port(n, Role.COMMAND, "1", "an input") for n in names)


def test_what_cancels_in_every_part_of_a_length_counts_nothing() -> None:
    b, at, ports = _inputs("x", "y", "z")
    part = b.make(Op.SUB, [b.make(Op.ADD, [at["x"], at["y"]]), at["x"]])
    f = b.function(
        "length", ports, ports[:1], [b.sqrt(b.add(b.square(part), b.square(b.add(at["y"], at["z"]))))]
    )
    ranges = dict.fromkeys(at, (-1.0, 1.0))
    (claim,) = analysed(f, ranges, LIBM).claims
    assert 5**0.5 <= claim.high < 5**0.5 + 0.7


@pytest.mark.parametrize("size", [3, 3000, 30000])
def test_choices_between_large_numbers_keep_their_room(size: int) -> None:
    """5 or 7 less h, chosen by h + size < size: rounding decides for |h| far below the spacing of floats there."""
    b, at, ports = _inputs("vx")
    h = b.add(at["vx"], b.mul(at["vx"], at["vx"]))
    large = b.const(size)
    x = b.select(b.make(Op.ADD, [h, large]), large, b.const(5), b.const(7))
    f = b.function("chosen", ports, ports, [b.sin(b.sub(x, h))])
    ranges = {"vx": (-0.5, 0.5)}
    (claim,) = analysed(f, ranges, LIBM).claims
    values = np.linspace(-0.5, 0.5, 20001).astype(np.float32)
    h32 = values + values * values
    chosen = np.where(h32 + np.float32(size) < np.float32(size), np.float32(5), np.float32(7)) - h32
    sines = np.sin(chosen.astype(np.float64))
    assert claim.low <= sines.min() and sines.max() <= claim.high
