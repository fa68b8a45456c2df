"""A control law drives inside the limits of the robot file, and along the same path as without limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.conftest import command_line
from tests.tools.simulating.test_simulate import NEEDED, PAIR
from wmrgen import derive, load
from wmrgen.tools.simulating.drive import Drive, simulate
from wmrgen.tools.simulating.model import Model
from wmrgen.tools.simulating.sources import GoToPose, Pursue

LIMITS = "limits: {vx: 0.7, omega: 1.1, spin: 12}\n"
CAR = """\
wmrgen: 1
name: car
limits: {steer: [-30 deg, 30 deg]}
wheels:
  - {name: rear,  type: fixed,   x: 0, y: 0, heading: 0, r: 0.1}
  - {name: front, type: steered, x: 1.2, y: 0, heading: 0, r: 0.1, actuated: [steer]}
"""
STARTS = np.array([(-2.0, 0.3, 0.5), (0.5, 1.0, 1.0), (-1.0, -1.5, -2.0)])


def driven(text: str, folder: Path, law: str = "goto_pose") -> Drive:
    path = folder / "robot.yaml"
    path.write_text(text, encoding="utf-8")
    robot = Model(derive(load(path), [*NEEDED, law]))
    source = GoToPose((0, 0, 0), 0.004, 20.0) if law == "goto_pose" else Pursue((0, 0), 1.5, 0.01, 60.0)
    return simulate(robot, robot.start(STARTS, {}), source)


def extremes(drive: Drive, name: str) -> float:
    return float(np.abs(drive.columns[name]).max())


@pytest.mark.slow
@pytest.mark.parametrize("law", ["goto_pose", "pursuit"])
def test_commands_are_inside_the_limits(law: str, tmp_path: Path) -> None:
    free, limited = (driven(text, tmp_path, law) for text in (PAIR, PAIR + LIMITS))
    most = {"vx": 0.7, "omega": 1.1, "left.spin": 12.0, "right.spin": 12.0}
    assert all(
        extremes(free, name) > limit for name, limit in most.items() if name != "omega" or law == "goto_pose"
    )
    assert all(extremes(limited, name) <= limit * (1 + 1e-12) for name, limit in most.items())
    assert not free.limited_by and set(limited.limited_by) == {"limit_twist", "desaturate"}
    for drive in (free, limited):
        assert drive.arrived is not None and np.isfinite(drive.arrived).all()
    assert (limited.arrived > free.arrived).all()  # type: ignore[operator]


@pytest.mark.slow
def test_the_path_does_not_change(tmp_path: Path) -> None:
    """One factor for all components: the same points are reached, later."""
    free, limited = (driven(text, tmp_path) for text in (PAIR, PAIR + LIMITS))
    for start in range(len(STARTS)):
        way = np.stack([free.columns[name][:, start] for name in ("x", "y")], axis=-1)
        points = np.stack([limited.columns[name][::50, start] for name in ("x", "y")], axis=-1)
        far = [float(np.hypot(*(way - point).T).min()) for point in points]
        assert max(far) < 0.02  # m: steps of the fast drive are up to 4 ms x 7 m/s apart


def test_the_deadband_does_not_end_a_drive(tmp_path: Path) -> None:
    """A deadband of 10 % is 7 cm/s: with k_rho = 3 the robot would stop 2 cm from its goal."""
    drive = driven(PAIR + "limits: {vx: 0.7, omega: 1.1}\ndeadband: 0.1\n", tmp_path)
    assert drive.arrived is not None and np.isfinite(drive.arrived).all()


@pytest.mark.slow
def test_a_car_keeps_its_steering_stops(tmp_path: Path) -> None:
    drive = driven(CAR, tmp_path)
    assert extremes(drive, "front.steer") <= np.radians(30) + 1e-9
    assert drive.columns["slip"].max() < 1e-9
    assert drive.limited_by == ("limit_twist",)


@pytest.mark.parametrize(("words", "code"), [([], 0), (["--time", "0.5"], 1), (["--step", "0.7"], 1)])
def test_a_goal_that_is_not_reached_is_reported(words: list[str], code: int, robot_file: Path) -> None:
    table = robot_file.parent / "drive.csv"
    done = command_line("simulate", robot_file, "--goal", "1,1,0", "--csv", table, *words)
    assert done.code == code and table.exists()
    assert len(done.out.splitlines()) == 2
    assert bool(done.err) == bool(code)
