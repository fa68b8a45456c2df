"""Gappa, which shares no code with us, finds the same bounds where it can express the function."""

from __future__ import annotations

import pytest

from tests.external_tools import need
from tests.ir.bounds.gallery import proved
from tests.ir.bounds.gappa import FILE, found, script
from wmrgen.codegen.compiler import run_tool
from wmrgen.ir.bounds.assumptions import LIBM

# Robot -> functions that Gappa checks: linear maps, and those with sines of inputs.
CHECKED = {
    "turtlebot3_burger": ["inverse", "forward"],
    "clearpath_do100": ["inverse", "forward"],
    "clearpath_a200": ["forward"],
    "clearpath_r100": ["forward"],
    "lekiwi": ["inverse", "forward"],
    "festo_robotino": ["inverse", "forward"],
    "mir_100": ["inverse"],
    "wpilib_swervebot": ["forward"],
    "agilex_ranger": ["forward"],
}


def test_script_of_a_sum() -> None:
    robot = proved("turtlebot3_burger")
    inputs = {b.name: b.inputs for _, b in robot.pairs}
    text = script(robot.functions["forward"], inputs["forward"], LIBM)
    assert text is not None
    assert "@rnd = float<ieee_32, ne>;" in text
    assert "rnd= f" in text and "in ?" in text
    assert script(robot.functions["odometry"], inputs["odometry"], LIBM) is None  # it chooses


@pytest.mark.slow
@pytest.mark.parametrize("name", CHECKED)
def test_gappa_agrees(name: str) -> None:
    """Ours is at most 1.1 times Gappa's. Gappa's is at most 2.1 times ours: it counts one power of two more at ends."""
    need("gappa")
    robot = proved(name)
    for f, b in robot.pairs:
        if f.name in CHECKED[name]:
            text = script(f, b.inputs, LIBM)
            assert text is not None
            theirs = found(run_tool(["gappa", FILE], {FILE: text}, both=True), f)
            for o in b.outputs:
                assert o.error <= 1.1 * theirs[o.name] + 1e-12, f"{f.name}: {o.name}"
                if o.name != "slip":  # Gappa knows nothing of the length of a vector that may vanish
                    assert theirs[o.name] <= 2.1 * o.error + 1e-12, f"{f.name}: {o.name}"
