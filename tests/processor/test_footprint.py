"""Bytes of code and stack with the GNU compilers of five processors, for every robot of the gallery."""

from __future__ import annotations

import pytest

from benchmarks.emulator.gcc import PROCESSORS
from benchmarks.flavours import DEFAULT
from benchmarks.footprint import SHOWN, Footprint, measure
from tests.c.harness import gallery
from tests.tools import need


@pytest.mark.slow
@pytest.mark.parametrize("key", SHOWN)
def test_the_gallery_compiles_and_its_stack_is_known(key: str) -> None:
    """No function has a stack that depends on its input: `measure` refuses that."""
    need(PROCESSORS[key].compiler)
    found = measure(gallery(), PROCESSORS[key])
    assert {f"{m.name}_{f.name}" for m in gallery() for f in m.functions if f.outputs} <= set(found)
    assert all(0 < print_.text < 12000 and print_.stack < 1024 for print_ in found.values())


@pytest.mark.slow
def test_small_robots_need_no_stack() -> None:
    need(PROCESSORS["m4f"].compiler)
    names = ("textbook_differential", "clearpath_do100", "lekiwi")
    found = measure([m for m in gallery() if m.name in names], PROCESSORS["m4f"])
    for name in names:
        for function in ("inverse", "forward"):
            assert found[f"{name}_{function}"].stack == 0


@pytest.mark.slow
@pytest.mark.skipif(DEFAULT != "inline", reason="this wmrgen has no --math inline")
def test_four_wheels_in_1450_bytes() -> None:
    need(PROCESSORS["m4f"].compiler)
    (module,) = (m for m in gallery() if m.name == "wpilib_swervebot")
    found = measure([module], PROCESSORS["m4f"])["wpilib_swervebot_forward"]
    assert found.text <= 1450


def test_a_footprint_is_printed_as_code_and_stack() -> None:
    assert str(Footprint(84, 0)) == "84 / 0"
