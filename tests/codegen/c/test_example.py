"""The example that comes with a robot drives its figure, its modules stay where they are at rest, and it is a program
only if a macro asks for one."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from tests.codegen.c import physics
from tests.codegen.c.example import DT, STEPS, WHEELS, driven, integrated, recorded, written
from tests.codegen.c.harness import COMPILERS
from tests.depth import EVERYDAY, GALLERY, everyday
from tests.robots import of_gallery, of_text
from wmrgen.derivation.facade import Derivation

pytestmark = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
PASSIVE = {"office_chair"}  # it has no joints to command or to measure, and no example
ODD = Path(__file__).with_name("odd_robots.yaml").read_text(encoding="utf-8").split("---\n")[1:]
STRAIGHT = {  # robots that drive no curve: wheels would slide, or motors do not command it
    *("clearpath_a200", "locked_bicycle", "unicycle", "textbook_omni_steer"),
    *("one_wheel_gyro", "in_line", "in_line_offset", "skid", "omni_steer"),
}
UNMOTORED = {"unicycle", "textbook_omni_steer", "one_wheel_gyro", "one_wheel_off", "omni_steer"}
STANDING = {"one_wheel_off", "crossed_axles"}  # the first may turn freely; the second can only turn


def check_figures(robots: list[Derivation], folder: Path) -> None:
    """The motion for the commands is the figure: wheels do not slide, and the robot drives curves if it can."""
    wrong = {}
    for d, rows in zip(robots, physics.driven(robots, folder), strict=True):
        name, found = d.robot.name, physics.drive(d, rows)
        swings = bool((np.ptp(rows[:, :3], axis=0) > 1e-3).sum() > 1)
        if (
            found.off > 0.01
            or found.turned > 0.02
            or found.slides > 0.01
            or (found.length > 1.0) == (name in STANDING)
            or found.determined == (name in UNMOTORED)
            or swings == (name in STRAIGHT | STANDING)
        ):
            wrong[name] = found
    assert not wrong


def test_robots_drive_their_figures(tmp_path: Path) -> None:
    check_figures([of_gallery(name) for name in sorted(EVERYDAY)], tmp_path)


@pytest.mark.slow
def test_every_other_robot_of_the_gallery_drives_its_figure(tmp_path: Path) -> None:
    check_figures([of_gallery(name) for name in sorted(GALLERY - EVERYDAY - PASSIVE)], tmp_path)


@pytest.mark.slow
def test_odd_robots_drive_their_figures(tmp_path: Path) -> None:
    robots = [of_text(text) for text in ODD]
    assert len(robots) >= 40
    check_figures(robots, tmp_path)


@pytest.mark.parametrize("robot", everyday(WHEELS, ["swerve"]))
def test_what_is_measured_is_the_figure(robot: str, tmp_path: Path) -> None:
    """The measured path is within a thousandth of the length of the figure, also with encoders, limits and castors."""
    rows = recorded(tmp_path, driven(robot, tmp_path))
    assert len(rows) == STEPS
    figure = integrated(rows[:, 3:])
    length = np.hypot(*np.diff(figure[:, :2], axis=0).T).sum()
    off = rows[:, :3] - figure
    assert length > 2.0 and np.hypot(*off[:, :2].T).max() < 0.001 * length
    assert np.abs(np.angle(np.exp(1j * off[:, 2]))).max() < 0.02


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
    """After half a minute; the encoders round toward zero, and a count is 30 microradians."""
    angles = recorded(tmp_path, driven("swerve", tmp_path), program=REST)
    assert angles.shape == (round(30 / DT), 2)
    assert np.ptp(angles, axis=0).max() < 0.01


def test_it_leaves_a_main_in_an_archive_alone(tmp_path: Path) -> None:
    """Arduino and PlatformIO build firmware from every file of a folder."""
    files = written(tmp_path, driven("pair", tmp_path), "")
    (tmp_path / "core.c").write_text("int main(void) { return 7; }\n")

    def run(*words: str) -> None:
        subprocess.run(words, cwd=tmp_path, check=True)

    run(COMPILERS[0], "-std=c99", "-c", "core.c", "-o", "core.o")
    run("ar", "rcs", "libcore.a", "core.o")
    swept = (files[0], "driven_checked.c", "test/driven_selftest.c", "example/main.c")
    run(COMPILERS[0], "-std=c99", "-Wpedantic", "-Werror", *swept, "libcore.a", "-lm", "-o", "firmware")
    assert subprocess.run([tmp_path / "firmware"]).returncode == 7
