"""``python -m tests.packaging.moving_picture`` writes the moving picture of README."""

from __future__ import annotations

from pathlib import Path

from tests.conftest import ROOT, command_line

PICTURE = ROOT / "docs" / "figures" / "drives" / "pioneer3dx.svg"


def write(path: Path) -> None:
    """Draw a drive to a goal, within the limits of the robot."""
    robot = ROOT / "robots" / "pioneer3dx.yaml"
    done = command_line("simulate", robot, "--goal", "1.5,1,0", "--law", "pursuit", "--svg", path)
    assert done.code == 0, done.err


if __name__ == "__main__":
    PICTURE.parent.mkdir(exist_ok=True)
    write(PICTURE)
