"""The example that comes with a robot drives a figure of eight: its odometry is within 1 mm of a simulation."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.c.example import WHEELS, poses, simulated
from tests.c.harness import COMPILERS
from tests.depth import everyday

pytestmark = pytest.mark.skipif(not COMPILERS, reason="no C compiler here")


@pytest.mark.parametrize("robot", everyday(WHEELS, ["car", "swerve"]))
def test_a_figure_of_eight(robot: str, tmp_path: Path) -> None:
    path, wanted = poses(tmp_path, robot), simulated(robot)
    assert path.shape == wanted.shape
    assert np.ptp(wanted[:, 1]) > 4.5 and np.ptp(wanted[:, 0]) > 2.2  # two circles of 1.2 m
    # Castors swing on between two steps, where the example holds their rates.
    assert np.hypot(*(path - wanted)[:, :2].T).max() < (4e-3 if robot == "castors" else 1e-3)
    turned = np.abs(np.angle(np.exp(1j * (path - wanted)[:, 2])))
    assert turned.max() < 2e-3
