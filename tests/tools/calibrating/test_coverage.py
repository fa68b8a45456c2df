"""Standard deviations against true errors: many random drives of robots that share no code with wmrgen."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import wmrgen
from benchmarks.calibration import coverage, logs
from tests.tools.calibrating.simulated import ANYWHERE, LAYOUTS, Layout, Wheel
from wmrgen.tools.calibrating.calibrate import calibrate, problem_of
from wmrgen.tools.calibrating.certainty import fit, fit_at
from wmrgen.tools.calibrating.fit import serial, start_of
from wmrgen.tools.calibrating.joints import settled
from wmrgen.tools.calibrating.logs import read
from wmrgen.tools.calibrating.observability import deviations
from wmrgen.tools.calibrating.starts import laid


@pytest.mark.slow
def test_true_parameters_lie_within_three_standard_deviations() -> None:
    """Of 52 runs of 13 layouts in 48 at least, every parameter of a run counted; standard deviations are not large
    for it: errors are between 0.6 and 1.4 of them. What no drive tells is named every time."""
    rows = [coverage(name, 4) for name in LAYOUTS]
    assert sum(row.runs - row.within for row in rows) <= 4
    assert 0.6 < np.sqrt(np.mean(np.square([error for row in rows for error in row.errors]))) < 1.4
    assert [row.name for row in rows if row.named < row.runs] == []


@pytest.mark.slow
def test_an_angle_that_no_drive_tells_is_no_mistake_of_the_logs(tmp_path: Path) -> None:
    """The base never turns, so the zero of its steering would come out as it likes, here beyond a radian: that is no
    reason to refuse the drives, which tell the radius, and the zero stays nominal."""
    layout = LAYOUTS["synchro"]
    (tmp_path / "robot.yaml").write_text(layout.text, encoding="utf-8")
    derivation = wmrgen.derive(wmrgen.load(tmp_path / "robot.yaml"))
    result = calibrate(derivation, logs(tmp_path, np.random.default_rng(8), layout)[:2], [])
    assert abs(result.parameters["zero"].value) < 1e-3 and ("zero",) in result.unobservable
    radius = result.parameters["r"]
    assert abs(radius.value - layout.true["r"]) < 3 * radius.sigma


PLACES = {"fl": (0.3, 0.25), "fr": (0.3, -0.25), "rl": (-0.3, 0.25), "rr": (-0.3, -0.25)}
MODULES = Layout(
    "wmrgen: 1\nname: modules\nparameters:\n"
    + "".join(f"  r_{n}: {{value: 0.05, tunable: true}}\n" for n in PLACES)
    + "".join(f"  zero_{n}: {{value: 0, tunable: true}}\n" for n in PLACES)
    + "wheels:\n"
    + "".join(
        f"  - {{name: {n}, type: steered, x: {x}, y: {y}, heading: zero_{n}, r: r_{n}}}\n"
        for n, (x, y) in PLACES.items()
    ),
    lambda p: {n: Wheel(x, y, p[f"zero_{n}"], p[f"r_{n}"], steered=True) for n, (x, y) in PLACES.items()},
    {
        **{f"r_{n}": r for n, r in zip(PLACES, (0.050975, 0.05014, 0.049715, 0.049675), strict=True)},
        **{f"zero_{n}": zero for n, zero in zip(PLACES, (0.0164, 0.0232, 0.001, 0.0144), strict=True)},
    },
    ANYWHERE,
)


@pytest.mark.slow
def test_what_the_truth_does_not_tell_is_sought_from_nominal_values_on(tmp_path: Path) -> None:
    """The paths of a swerve drive alone leave five directions of eight parameters open, in which their fit may come to
    lie half a radius off: that is no start for what joints disagree by, from which zeros came out 40 mrad off."""
    (tmp_path / "robot.yaml").write_text(MODULES.text, encoding="utf-8")
    problem = problem_of(wmrgen.derive(wmrgen.load(tmp_path / "robot.yaml")))
    paths = logs(tmp_path, np.random.default_rng(3), MODULES)
    drives = [read(path, path.with_suffix(".truth.csv"), problem.increments.joints, {}) for path in paths]
    ready = laid(replace(problem, drives=tuple(drives)))
    best = fit(ready, serial, start_of(ready))
    unknowns, count = best.unknowns.copy(), len(best.values)
    unknowns[:count] += 5 * deviations(best.problem, best.information, best.noise)[1][:, 0]
    values = settled(fit_at(best.problem, unknowns, serial), serial).values
    for name, value in zip(problem.increments.parameters, values, strict=True):
        assert value == pytest.approx(MODULES.true[name], abs=1e-3)
