"""Standard deviations against true errors: many random drives of robots that share no code with wmrgen."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wmrgen
from tests.calibrating.simulated import ANYWHERE, LAYOUTS, Layout, Twist, csv, drive
from wmrgen.calibrating.calibrate import calibrate

_RUNS = 25  # of each layout
_DRIVES = 3  # of each run
_SLIP = 0.01  # standard deviation of each step's slip, relative to the step


def _random_twist(random: np.random.Generator, layout: Layout, name: str) -> Twist:
    """A smooth twist: speeds that swing about a mean, forwards or backwards, and curves both ways."""
    pace, phase = random.uniform(0.2, 0.8, 4), random.uniform(0, 2 * np.pi, 3)
    mean, aside = random.uniform(0.2, 0.4) * random.choice([-1, 1]), 0.25 * (layout.drives == ANYWHERE)
    behind = 0.03 * (name == "differential")  # of the axle, along which nothing slides

    def twist(t: float) -> tuple[float, float, float]:
        omega = float(pace[3] * np.sin(pace[2] * t + phase[2]))
        vx = float(mean + 0.1 * np.sin(pace[0] * t + phase[0]))
        return vx, float(aside * np.cos(pace[1] * t + phase[1])) - behind * omega, omega

    return twist


def _logs(folder: Path, random: np.random.Generator, layout: Layout, name: str) -> list[Path]:
    """Drives with counts of 400 a turn, slipping wheels, a tracker's noise of 2 mm and 3 mrad, and clocks apart."""
    paths = []
    for index in range(_DRIVES):
        recorded = drive(
            layout, _random_twist(random, layout, name), seconds=30, rate=20, mount=0.03 - 0.02j,
            late=random.uniform(-0.3, 0.3), resolution=2 * np.pi / 400, noise=(0.002, 0.003),
            seed=int(random.integers(1 << 30)),
        )  # fmt: skip
        for column in [column for column in recorded.log if column.endswith(".angle")]:
            steps = np.diff(recorded.log[column], prepend=0.0)
            recorded.log[column] = np.cumsum(steps * (1 + _SLIP * random.standard_normal(len(steps))))
        paths.append(folder / f"run-{index}.csv")
        paths[-1].write_text(csv(recorded.log), encoding="utf-8")
        paths[-1].with_suffix(".truth.csv").write_text(csv(recorded.truth), encoding="utf-8")
    return paths


@pytest.mark.slow
def test_true_parameters_lie_within_three_standard_deviations(tmp_path: Path) -> None:
    """Of 100 runs of four layouts in 92 at least, every parameter of a run counted; and standard deviations are not
    large for it: errors are between 0.6 and 1.4 of them."""
    random = np.random.default_rng(20)
    within, errors = [], []
    for name, layout in LAYOUTS.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(layout.text, encoding="utf-8")
        derivation = wmrgen.derive(wmrgen.load(path))
        for run in range(_RUNS):
            folder = tmp_path / f"{name}-{run}"
            folder.mkdir()
            result = calibrate(derivation, _logs(folder, random, layout, name), [])
            z = [
                (result.parameters[p].value - v) / result.parameters[p].sigma for p, v in layout.true.items()
            ]
            assert not result.unobservable
            within.append(max(map(abs, z)) < 3)
            errors.extend(z)
    assert np.mean(within) >= 0.92
    assert 0.6 < np.sqrt(np.mean(np.square(errors))) < 1.4
