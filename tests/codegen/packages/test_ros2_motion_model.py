"""The motion model for Nav2's MPPI controller, with a stand-in for Nav2's header in ``stubs/ros2``.

Expected: closed forms of the least turning radius, the sideways velocity of an axle that is not at P, and twists that
the robot can drive, which do not change.
"""

from __future__ import annotations

import subprocess
from math import pi, tan
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.codegen.packages.made import files_of, of_gallery, run
from tests.conftest import ROOT, put
from tests.depth import GALLERY
from tests.external_tools import need
from wmrgen import derive, load

HERE = Path(__file__).parent
WARNINGS = ("-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
Twist = tuple[float, float, float]  # vx, vy [m/s], omega [rad/s]


ROBOTS = ROOT / "robots"


class Made(NamedTuple):
    """What the motion model makes of twists."""

    uses_vy: bool
    alone: list[list[float]]
    sequence: list[list[float]]
    predicted: list[list[float]]


def made_of(folder: Path, path: Path, twists: list[Twist], scalar: str = "float") -> Made:
    """Return what the motion model of a robot file makes of twists."""
    need("gcc", "g++")
    robot = path.stem
    put(folder, files_of(path, "ros2", scalar=scalar))
    run(folder, "gcc", "-std=c99", "-O1", "-c", f"src/{robot}.c")
    words = [f'-DMODEL="{folder}/nav2/{robot}_motion_model.hpp"', f"-DROBOT={robot}_kinematics"]
    stubs = f"-I{HERE / 'stubs' / 'ros2'}"
    run(
        folder,
        "g++",
        *WARNINGS,
        stubs,
        *words,
        HERE / "motion_driver.cpp",
        f"{robot}.o",
        "-lm",
        "-o",
        "motion",
    )
    text = "\n".join(" ".join(map(repr, twist)) for twist in twists)
    done = subprocess.run([folder / "motion"], input=text, capture_output=True, text=True, check=True)
    first, *lines = done.stdout.splitlines()
    rows = [[float(value) for value in line.split()] for line in lines]
    assert len(rows) == len(twists)
    parts = ([row[start : start + 3] for row in rows] for start in (0, 3, 6))
    return Made(first == "1", *parts)


@pytest.mark.slow
@pytest.mark.parametrize("scalar", ["float", "double"])
def test_an_axle_that_is_not_at_p_moves_p_sideways(scalar: str, tmp_path: Path) -> None:
    front, rear, limit = 0.15875, 0.17145, 24 * pi / 180
    most = tan(limit) / (front + rear)  # rad/m: curvature of the path of the rear wheel
    twists: list[Twist] = [
        (1.0, 0.0, 0.5),
        (1.0, 0.0, 5.0),
        (-1.0, 0.3, 5.0),
        (0.0, 0.0, 1.0),
        (2.0, 0.0, 0.0),
    ]
    made = made_of(tmp_path, ROBOTS / "f1tenth.yaml", twists, scalar)
    wanted = [(1.0, 0.5), (1.0, most), (-1.0, most), (0.0, 0.0), (2.0, 0.0)]
    assert made.uses_vy
    for got, (vx, omega) in zip(made.alone, wanted, strict=True):
        assert got == pytest.approx([vx, rear * omega, omega], abs=1e-5)
    for got, row, sample in zip(made.alone, made.sequence, made.predicted, strict=True):
        assert row == sample == pytest.approx(got, rel=1e-6)  # both are float


@pytest.mark.slow
def test_cars_keep_their_least_turning_radius(tmp_path: Path) -> None:
    """The inner wheel reaches its limit first. The robot may turn 1 % more, because its wheels may slip by 1 %."""
    radius = 2.5 / tan(40 * pi / 180) + 0.75
    twists: list[Twist] = [
        (1.0, 0.0, 5.0),
        (-3.0, 0.0, 5.0),
        (1.0, 0.0, -5.0),
        (5.0, 0.0, 0.9 * 5.0 / radius),
    ]
    made = made_of(tmp_path, ROBOTS / "ackermann_car.yaml", twists)
    assert not made.uses_vy
    for got, wanted in zip(made.alone, (1 / radius, 3 / radius, -1 / radius, 4.5 / radius), strict=True):
        assert got[2] == pytest.approx(wanted, rel=0.011)
    assert [row[0] for row in made.alone] == pytest.approx([1.0, -3.0, 1.0, 5.0], rel=1e-3)


@pytest.mark.slow
def test_tunable_parameters_have_their_nominal_values(tmp_path: Path) -> None:
    text = (ROBOTS / "bicycle.yaml").read_text()
    path = tmp_path / "bicycle.yaml"
    path.write_text(text.replace("wheelbase: 1.1", "wheelbase: {value: 1.1, tunable: true}"))
    assert path.read_text() != text
    for robot in (ROBOTS / "bicycle.yaml", path):
        bicycle = made_of(tmp_path / robot.parent.name, robot, [(2.0, 0.0, 50.0)])
        assert bicycle.alone[0] == pytest.approx([2.0, 0.0, 2.0 * tan(60 * pi / 180) / 1.1], abs=1e-4)


@pytest.mark.slow
def test_a_rover_turns_on_the_spot_and_a_synchro_drive_does_not_turn(tmp_path: Path) -> None:
    twists: list[Twist] = [(0.0, 0.0, 1.0), (0.3, 0.0, -0.7), (0.3, 0.2, 0.0)]
    rover = made_of(tmp_path / "rover", ROBOTS / "jpl_osr.yaml", twists)
    assert not rover.uses_vy
    for got, wanted in zip(rover.alone, [*twists[:2], (0.3, 0.0, 0.0)], strict=True):
        assert got == pytest.approx(wanted, abs=1e-5)
    synchro = made_of(tmp_path / "synchro", ROBOTS / "synchro_drive.yaml", twists)
    assert synchro.uses_vy
    for got, wanted in zip(synchro.alone, [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), twists[2]], strict=True):
        assert got == pytest.approx(wanted, abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("robot", sorted(GALLERY - {"office_chair"}))
def test_robots_whose_steering_alone_chooses_the_turn_have_a_motion_model(robot: str, tmp_path: Path) -> None:
    files = of_gallery(robot, "ros2")
    own = [name for name in files if "motion_model" in name]
    steers = derive(load(ROOT / "robots" / f"{robot}.yaml")).mobility.robot_type == (1, 1)
    assert len(own) == (3 if steers else 0)
    assert (b"nav2_mppi_controller" in files["CMakeLists.txt"]) == steers
    if steers:
        need("g++")
        put(tmp_path, files)
        stubs = f"-I{HERE / 'stubs' / 'ros2'}"
        run(tmp_path, "g++", "-fsyntax-only", *WARNINGS, stubs, f"nav2/{robot}_motion_model.cpp")
