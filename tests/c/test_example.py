"""The example that comes with a robot drives its figure, its modules stay where they are at rest, and it is a program
only if a macro asks for one."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from tests.c.example import DT, STEPS, WHEELS, driven, integrated, recorded, written
from tests.c.harness import COMPILERS
from tests.depth import everyday
from tests.robots import ROBOTS, of_gallery
from wmrgen.robot import Derivation

pytestmark = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
PASSIVE = {"office_chair"}  # nothing to command or to measure: it has no example
STRAIGHT = {  # as far as their wheels can command and measure
    "clearpath_a200": "it turns by skidding",
    "locked_bicycle": "its axles are parallel",
    "unicycle": "one wheel does not determine the yaw rate",
}


def assert_on_figure(d: Derivation, folder: Path, share: float) -> np.ndarray:
    """The wanted twists. The measured path is within this ``share`` of the figure's length from the figure."""
    rows = recorded(folder, d)
    path, twists = rows[:, :3], rows[:, 3:]
    assert len(rows) == STEPS
    figure = integrated(twists)
    length = np.hypot(*np.diff(figure[:, :2], axis=0).T).sum()
    assert length > 2.0
    off = path - figure
    assert np.hypot(*off[:, :2].T).max() < share * length
    assert np.abs(np.angle(np.exp(1j * off[:, 2]))).max() < 0.02
    return twists


@pytest.mark.parametrize("name", everyday(sorted(ROBOTS.keys() - PASSIVE), ["ackermann_car"]))
def test_every_robot_drives_its_figure(name: str, tmp_path: Path) -> None:
    twists = assert_on_figure(of_gallery(name), tmp_path, 0.01)
    assert (np.ptp(twists[:, 1:]) == 0) == (name in STRAIGHT)


@pytest.mark.parametrize("robot", everyday(WHEELS, ["swerve"]))
def test_with_encoders_limits_and_castors(robot: str, tmp_path: Path) -> None:
    assert_on_figure(driven(robot, tmp_path), tmp_path, 0.001)


REST = """
#include <stdio.h>
static void record(void) {}
int main(void)
{
    int k;
    (void)drive();
    wanted.vx = wanted.vy = wanted.omega = 0;
    for (k = 0; k < 3000; ++k) {
        step();
        printf("%.9g %.9g\\n", (double)commands.fl.steer, (double)commands.br.steer);
    }
    return 0;
}
"""


def test_modules_do_not_creep_at_rest(tmp_path: Path) -> None:
    """Half a minute; the encoders round toward zero. A count of theirs is 30 microradians."""
    angles = recorded(tmp_path, driven("swerve", tmp_path), program=REST)
    assert angles.shape == (round(30 / DT), 2)
    assert np.ptp(angles, axis=0).max() < 0.01


def test_it_leaves_a_main_in_an_archive_alone(tmp_path: Path) -> None:
    """As firmware has it that is built by Arduino or PlatformIO from every file of a folder."""
    files = written(tmp_path, driven("pair", tmp_path), "")
    (tmp_path / "core.c").write_text("int main(void) { return 7; }\n")

    def run(*words: str) -> None:
        subprocess.run(words, cwd=tmp_path, check=True)

    run(COMPILERS[0], "-std=c99", "-c", "core.c", "-o", "core.o")
    run("ar", "rcs", "libcore.a", "core.o")
    swept = (files[0], "driven_checked.c", "test/driven_selftest.c", "example/main.c")
    run(COMPILERS[0], "-std=c99", "-Wpedantic", "-Werror", *swept, "libcore.a", "-lm", "-o", "firmware")
    assert subprocess.run([tmp_path / "firmware"]).returncode == 7
