"""Several robots with their checked functions in one translation unit, as in unity builds."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.codegen.c.harness import EACH, STRICT
from tests.conftest import put
from tests.ir.selftest.every import files_of
from wmrgen.codegen.compiler import compile_program, run_program

ROBOTS = ("pioneer3dx", "ackermann_car", "agilex_ranger")
MAIN = """
int main(void)
{
    pioneer3dx_pose pose = {1.0f, 3e38f, 3.0f};
    const pioneer3dx_twist step = {0.1f, 0.0f, 0.5f};
    const ackermann_car_twist drive = {10.0f, 0.0f, 1.0f};
    ackermann_car_wheels wheels = {{0}, {0}, {0.5f}, {3.0f}};
    int wrong = 0;

    wrong += pioneer3dx_odometry_checked(&pose, &step, 0.01f) != PIONEER3DX_OUT_OF_RANGE;
    wrong += (pose.x < 1.0f) || (pose.x > 1.0f);
    wrong += ackermann_car_inverse_checked(&drive, &wheels, &wheels) != ACKERMANN_CAR_OUT_OF_RANGE;
    wrong += (wheels.front_left.steer < 0.5f) || (wheels.front_left.steer > 0.5f);
    wrong += (wheels.front_right.steer < 0.69f) || (wheels.front_right.steer > 0.7f);
    return wrong;
}
"""


@pytest.mark.parametrize("compiler", EACH)
def test_checked_functions_of_several_robots_in_one_unit(compiler: str, tmp_path: Path) -> None:
    for robot in ROBOTS:
        put(tmp_path, files_of(robot))
    included = [f'#include "{robot}{part}.c"' for part in ("", "_checked") for robot in ROBOTS]
    (tmp_path / "unity.c").write_text("\n".join(included) + MAIN)
    assert run_program(compile_program(tmp_path, ["unity.c"], compiler, (*STRICT, "-O1")), "") == ""


@pytest.mark.slow
def test_checked_functions_of_two_scalars_in_one_unit(tmp_path: Path) -> None:
    """The functions are compiled separately; their checked variants may share a unit."""
    put(tmp_path, files_of(ROBOTS[0]))
    put(tmp_path, files_of(ROBOTS[1], "double"))
    included = [f'#include "{robot}_checked.c"' for robot in ROBOTS[:2]]
    (tmp_path / "unity.c").write_text("\n".join(included) + MAIN)
    sources = ["unity.c", *(f"{robot}.c" for robot in ROBOTS[:2])]
    flags = tuple(flag for flag in STRICT if flag != "-Wdouble-promotion")
    assert run_program(compile_program(tmp_path, sources, None, (*flags, "-O1")), "") == ""
