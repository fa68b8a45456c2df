"""Write logs of simulated robots, and change the logs that exist."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import wmrgen
from tests.tools.calibration.simulated import Layout, Reals, csv, drive

LOGS = Path(__file__).parent / "logs"  # of real robots
REAL = sorted(path.name for path in LOGS.iterdir() if path.is_dir() and path.name[0] != "_")


@cache
def derived(text: str) -> wmrgen.Derivation:
    """Derive a robot file, once for all tests of a process."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "robot.yaml"
        path.write_text(text, encoding="utf-8")
        return wmrgen.derive(wmrgen.load(path))


def written(folder: Path, layout: Layout, seed: int = 0, **options: Any) -> list[Path]:
    """Write logs of all drives of a layout, each with its reference poses beside it; options as of `drive`."""
    paths = []
    for index, twist in enumerate(layout.drives):
        recorded = drive(layout, twist, seed=seed + index, **options)
        path = folder / f"run-{index}.csv"
        path.write_text(csv(recorded.log), encoding="utf-8")
        path.with_suffix(".truth.csv").write_text(csv(recorded.truth), encoding="utf-8")
        paths.append(path)
    return paths


def copied(folder: Path, name: str, runs: Sequence[str] = ("run-01", "run-02")) -> list[Path]:
    """Copy real logs."""
    paths = []
    for run in runs:
        for end in (".csv", ".truth.csv"):
            shutil.copy(LOGS / name / f"{run}{end}", folder / f"{run}{end}")
        paths.append(folder / f"{run}.csv")
    return paths


def rows_of(path: Path) -> tuple[list[str], Reals]:
    """Return the header and the rows of a CSV file."""
    header, *rows = path.read_text(encoding="utf-8").strip().split("\n")
    return header.split(","), np.array([[float(cell or "nan") for cell in row.split(",")] for row in rows])


def change_rows(path: Path, change: Callable[[Reals], Reals]) -> None:
    """Rewrite the rows of a CSV file."""
    header, rows = rows_of(path)
    path.write_text(csv(dict(zip(header, change(rows).T, strict=True))), encoding="utf-8")


def change_references(paths: Sequence[Path], change: Callable[[Reals], Reals]) -> None:
    """Rewrite the rows (t, x, y, theta) of the reference poses of each log."""
    for path in paths:
        change_rows(path.with_suffix(".truth.csv"), change)
