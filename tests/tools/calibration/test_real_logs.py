"""Logs of real robots give the parameters that estimators without shared code have found in them."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import pytest

import wmrgen
from tests.tools.calibration.drives import LOGS, REAL
from wmrgen.tools.calibration.calibrate import Calibration, calibrate


@cache
def expected(name: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((LOGS / name / "expected.json").read_text(encoding="utf-8"))
    return data


@cache
def result_of(name: str) -> Calibration:
    robot = wmrgen.load(LOGS / name / "robot.yaml")
    return calibrate(robot, [LOGS / name / f"{run}.csv" for run in expected(name)["runs"]])


@pytest.mark.parametrize("name", REAL)
def test_parameters_are_within_recorded_tolerances(name: str) -> None:
    result = result_of(name)
    for parameter, tolerance in expected(name)["tolerance"].items():
        if tolerance is not None:
            estimate = result.parameters[parameter]
            assert abs(estimate.value - expected(name)["reference"][parameter]) < tolerance
            assert estimate.observable and estimate.sigma is not None
            assert abs(estimate.value - expected(name)["reference"][parameter]) < 3 * estimate.sigma


@pytest.mark.parametrize("name", REAL)
def test_what_the_logs_do_not_determine_is_named(name: str) -> None:
    result = result_of(name)
    named = {n for group in result.unobservable for n in group if not n.startswith("mount.")}
    assert named == set(expected(name)["not_demanded"])
    for parameter in named:
        assert not result.parameters[parameter].observable and result.parameters[parameter].sigma is None


@pytest.mark.parametrize("name", REAL)
def test_odometry_is_better_than_before(name: str) -> None:
    result = result_of(name)
    assert result.after.position < 0.75 * result.before.position
    assert result.after.heading < 0.75 * result.before.heading


@pytest.mark.parametrize(("name", "position"), [("diff-square", 0.0056), ("omni3-square", 0.0242)])
def test_parameters_predict_drives_that_were_left_out(name: str, position: float) -> None:
    """Errors [m] on drives that were left out are about those of the fit, over the same poses as nominal ones."""
    verdict = result_of(name).verdict
    assert verdict is not None and verdict.better and not verdict.blind
    assert verdict.held_out.position < position < 0.5 * verdict.nominal.position
    assert verdict.nominal == result_of(name).before


@pytest.mark.parametrize("name", [name for name in REAL if name.endswith("square")])
def test_no_corner_of_a_square_is_left_out(name: str) -> None:
    """All of these robots turn at the corners of squares, which determines the wheelbase and the track."""
    assert not result_of(name).slips
