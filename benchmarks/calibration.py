"""``python -m benchmarks coverage``: true parameters against standard deviations, over many random drives of robots
that share no code with wmrgen."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import wmrgen
from tests.tools.calibration.simulated import LAYOUTS, Encoders, Layout, Reals, Tracker, Twist, csv, drive
from wmrgen.tools.calibration.calibrate import calibrate

DRIVES = 3  # of each run
SEED = 20


@dataclass(frozen=True, slots=True)
class Coverage:
    """The runs of a layout."""

    name: str
    runs: int
    within: int  # runs in which every true parameter is within three standard deviations
    named: int  # runs in which all parameters that no drive determines are named
    open: int  # runs in which a parameter that other drives determine has no deviation
    errors: tuple[float, ...]  # of all parameters with a deviation, in deviations


def random_twist(random: np.random.Generator, layout: Layout) -> Twist:
    """Return a smooth random twist: speeds oscillate about a mean, forwards or backwards, with curves both ways."""
    pace, phase = random.uniform(0.2, 0.8, 4), random.uniform(0, 2 * np.pi, 3)
    mean = random.uniform(0.2, 0.4) * random.choice([-1, 1])

    def twist(t: Reals) -> tuple[Reals, Reals, Reals]:
        omega = pace[3] * np.sin(pace[2] * t + phase[2])
        vx = mean + 0.1 * np.sin(pace[0] * t + phase[0])
        if not layout.turns:
            return vx * np.cos(3 * omega), vx * np.sin(3 * omega), 0 * t
        return vx, 0.25 * layout.slides * np.cos(pace[1] * t + phase[1]), layout.bends * omega

    return twist


def logs(folder: Path, random: np.random.Generator, layout: Layout, rate: float = 20.0) -> list[Path]:
    """Write drives of 30 s with counts of 400 a turn, wheels that slip by 1 % of each step, a tracker's noise of 2 mm
    and 3 mrad, and clocks up to 0.3 s apart.

    Args:
        folder: Where logs and reference poses are written.
        random: Draws them.
        layout: The robot.
        rate: Of readings and poses [1/s].

    Returns:
        The logs.
    """
    paths = []
    for index in range(DRIVES):
        tracker = Tracker(0.03 - 0.02j, late=random.uniform(-0.3, 0.3), noise=(0.002, 0.003))
        recorded = drive(
            layout, random_twist(random, layout), 30, rate, tracker,
            Encoders(resolution=2 * np.pi / 400, slip=0.01), seed=int(random.integers(1 << 30)),
        )  # fmt: skip
        paths.append(folder / f"run-{index}.csv")
        paths[-1].write_text(csv(recorded.log), encoding="utf-8")
        paths[-1].with_suffix(".truth.csv").write_text(csv(recorded.truth), encoding="utf-8")
    return paths


def coverage(name: str, runs: int, seed: int = SEED, rate: float = 20.0) -> Coverage:
    """Calibrate one of the simulated layouts from random drives.

    Args:
        name: The layout.
        runs: How often.
        seed: Of the drives.
        rate: Of readings and poses [1/s].
    """
    layout, random = LAYOUTS[name], np.random.default_rng([seed, len(name), *map(ord, name)])
    within, named, left_open, errors = 0, 0, 0, list[float]()
    with tempfile.TemporaryDirectory() as folder:
        robot = Path(folder) / "robot.yaml"
        robot.write_text(layout.text, encoding="utf-8")
        derivation = wmrgen.derive(wmrgen.load(robot))
        for _ in range(runs):
            result = calibrate(derivation, logs(Path(folder), random, layout, rate))
            of_run = []
            for parameter in set(layout.true) - set(layout.together):
                estimate = result.parameters[parameter]
                if estimate.sigma is not None:
                    of_run.append((estimate.value - layout.true[parameter]) / estimate.sigma)
            within += max(map(abs, of_run), default=0.0) < 3
            left_open += len(of_run) < len(set(layout.true) - set(layout.together))
            named += set(layout.together) <= {n for group in result.unobservable for n in group}
            errors += of_run
    return Coverage(name, runs, within, named, left_open, tuple(errors))


def table(count: int) -> Iterator[str]:
    """Yield a row for each layout."""
    yield "| layout | runs | within 3 sigma | errors in sigma, rms | named | not determined |"
    yield "|---|---|---|---|---|---|"
    for name in LAYOUTS:
        row = coverage(name, count)
        rms = float(np.sqrt(np.mean(np.square(row.errors))))
        share = 100 * row.within / row.runs
        yield f"| {name} | {row.runs} | {share:.1f} % | {rms:.2f} | {row.named} | {row.open} |"
