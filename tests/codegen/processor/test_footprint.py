"""Bytes of code and stack with the GNU compilers of five processors, for every robot of the gallery."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from benchmarks.emulator.gcc import PROCESSORS
from benchmarks.footprint import SHOWN, Footprint, measure
from tests.codegen.c.harness import gallery
from tests.codegen.processor.test_small import LATER
from tests.external_tools import need
from tests.robots import of_gallery
from wmrgen.ir.nodes import Module


@pytest.mark.slow
@pytest.mark.parametrize("key", SHOWN)
def test_the_gallery_compiles_and_its_stack_is_known(key: str) -> None:
    """No function has a stack that depends on its input; `measure` would fail."""
    need(PROCESSORS[key].compiler)
    found = measure(gallery(), PROCESSORS[key])
    assert {f"{m.name}_{f.name}" for m in gallery() for f in m.functions if f.outputs} <= set(found)
    assert all(0 < print_.text < 12000 and print_.stack < 1024 for print_ in found.values())


@pytest.mark.slow
def test_small_robots_need_no_stack() -> None:
    need(PROCESSORS["m4f"].compiler)
    names = ("textbook_differential", "clearpath_do100", "lekiwi")
    found = measure([of_gallery(name).c_module for name in names], PROCESSORS["m4f"])
    for name in names:
        for function in ("inverse", "forward"):
            assert found[f"{name}_{function}"].stack == 0


@pytest.mark.parametrize("way", [False, True], ids=["inlined", "called"])
@pytest.mark.parametrize("function", ["inverse", "forward"])
def test_a_swerve_with_called_kernels(way: bool, function: str) -> None:
    """With -DWMRGEN_SMALL at most 600 bytes, kernels included."""
    need(PROCESSORS["m4f"].compiler)
    found = on_m4f("wpilib_swervebot", way)[f"wpilib_swervebot_{function}"]
    assert (found.text <= 600) == way
    if way:
        assert found.stack <= 120
        assert found.text > found.own > 100


@cache
def on_m4f(robot: str, small: bool) -> dict[str, Footprint]:
    return measure([of(robot)], PROCESSORS["m4f"], small=small)


def of(robot: str) -> Module:
    return of_gallery(robot).c_module


@pytest.mark.slow
@pytest.mark.parametrize("key", SHOWN)
def test_called_kernels_are_never_larger(key: str) -> None:
    """The kinematics of a robot get smaller, those of the swerve drive to at most three quarters."""
    need(PROCESSORS[key].compiler)
    for robot, most in (("wpilib_swervebot", 0.79), ("lekiwi", 1.0)):
        module = of(robot)
        module = replace(module, functions=tuple(f for f in module.functions if f.name not in LATER))
        usual, small = (measure([module], PROCESSORS[key], small=way) for way in (False, True))
        assert sum(f.own for f in small.values()) <= most * sum(f.own for f in usual.values())


@pytest.mark.parametrize("robot", ["wpilib_swervebot", "agilex_ranger"])
def test_four_wheels_as_usual(robot: str) -> None:
    """The function forward takes at most 1450 bytes, with 64 bytes of stack."""
    need(PROCESSORS["m4f"].compiler)
    found = on_m4f(robot, False)[f"{robot}_forward"]
    assert found.text <= 1450
    assert found.stack <= 64


def test_a_footprint_is_printed_as_code_and_stack() -> None:
    assert str(Footprint(84, 0)) == "84 / 0"
