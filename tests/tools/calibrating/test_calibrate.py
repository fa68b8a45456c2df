"""`wmrgen calibrate`: real drives within their recorded tolerances, simulated robots exactly, bad logs in words."""

from __future__ import annotations

import json
import math
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml

import wmrgen
from tests.conftest import Outcome
from tests.tools.calibrating.simulated import LAYOUTS, Encoders, Layout, Tracker, Twist, csv, drive
from wmrgen.errors import UsageError
from wmrgen.tools.calibrating.calibrate import (
    Calibration,
    Estimate,
    _held_out,
    _passed_over,
    calibrate,
    problem_of,
)
from wmrgen.tools.calibrating.certainty import fit
from wmrgen.tools.calibrating.drifts import Drift
from wmrgen.tools.calibrating.fit import Problem, residuals, serial, start_of, sums, unit_of
from wmrgen.tools.calibrating.logs import names, read
from wmrgen.tools.calibrating.notes import _drifting, _far_off, _late, notes
from wmrgen.tools.calibrating.observability import courses, offers, plan
from wmrgen.tools.calibrating.path import Reckoning, passed, reckoned
from wmrgen.tools.calibrating.picture import _ERRORS, _PATHS, _errors, _key, _paths, _values
from wmrgen.tools.calibrating.starts import _found, laid
from wmrgen.tools.calibrating.written import told, with_values

LOGS = Path(__file__).parent / "logs"
REAL = sorted(path.name for path in LOGS.iterdir() if path.is_dir())


def derivation_of(tmp_path: Path, layout: Layout) -> wmrgen.Derivation:
    path = tmp_path / "robot.yaml"
    path.write_text(layout.text, encoding="utf-8")
    return wmrgen.derive(wmrgen.load(path))


def written(tmp_path: Path, layout: Layout, **options: Any) -> list[Path]:
    """Logs of all drives of a layout, each with its truth beside it."""
    paths = []
    for index, twist in enumerate(layout.drives):
        recorded = drive(layout, twist, seed=index, **options)
        path = tmp_path / f"run-{index}.csv"
        path.write_text(csv(recorded.log), encoding="utf-8")
        path.with_suffix(".truth.csv").write_text(csv(recorded.truth), encoding="utf-8")
        paths.append(path)
    return paths


@pytest.mark.parametrize("name", REAL)
def test_real_drives_give_the_recorded_parameters(name: str) -> None:
    """OptiOdom's robots: within the tolerances of a reference that shares no code; weak directions named; no part of a
    drive is left out (corners of squares were, where the truth's clock drifts, so that the wheelbase was lost)."""
    folder = LOGS / name
    expected = json.loads((folder / "expected.json").read_text(encoding="utf-8"))
    derivation = wmrgen.derive(wmrgen.load(folder / "robot.yaml"))
    result = calibrate(derivation, [folder / f"{run}.csv" for run in expected["runs"]], [])
    for parameter, tolerance in expected["tolerance"].items():
        if tolerance is not None:
            estimate = result.parameters[parameter]
            assert abs(estimate.value - expected["reference"][parameter]) < tolerance
            assert estimate.observable
    assert {n for group in result.unobservable for n in group} == set(expected["not_demanded"])
    assert result.after.position < 0.75 * result.before.position
    assert not result.outliers


def test_logs_of_one_name_are_told_apart_by_numbers() -> None:
    logs = [Path(f"{day}/{name}.csv") for day in "abc" for name in ("run", "turn")]
    assert names(logs) == ["run", "turn", "run (2)", "turn (2)", "run (3)", "turn (3)"]


@pytest.mark.parametrize(("nominal", "unit"), [(0.4, 0.04), (-0.4, 0.04), (0.0, 0.1)])
def test_the_prior_is_a_tenth_of_a_parameter(nominal: float, unit: float) -> None:
    assert unit_of(nominal) == pytest.approx(unit)


@pytest.mark.parametrize("name", ["differential", pytest.param("tricycle", marks=pytest.mark.slow)])
def test_large_logs_are_fitted_by_all_readings_in_the_end_alone(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And give what all readings give; fewer tell slips, and how much parameters differ without each drive."""
    derivation = derivation_of(tmp_path, LAYOUTS[name])
    tracker = Tracker(0.04 - 0.07j, late=0.13, noise=(0.001, 0.002))
    encoders = Encoders(resolution=2 * np.pi / 1000, slip=0.003)
    logs = written(tmp_path, LAYOUTS[name], tracker=tracker, encoders=encoders)
    whole = calibrate(derivation, logs, [])
    seen = list[int]()

    def each(problem: Problem, unknowns: Any, task: Any) -> Any:
        seen.append(sum(len(drive.t) for drive in problem.drives))
        return serial(problem, unknowns, task)

    monkeypatch.setattr("wmrgen.tools.calibrating.calibrate._ENOUGH", 500)
    monkeypatch.setattr("wmrgen.tools.calibrating.calibrate._COARSE", 0.13)
    begun = calibrate(derivation, logs, [], each)
    fine = [count > 0.7 * max(seen) for count in seen]
    assert min(seen) < 0.3 * max(seen)
    assert all(fine[fine.index(True) :]) and sum(fine) < 8
    for parameter, estimate in begun.parameters.items():
        other = whole.parameters[parameter]
        assert abs(estimate.value - other.value) < 0.1 * other.sigma
        assert 0.5 < estimate.sigma / other.sigma < 2
    assert begun.unobservable == whole.unobservable


@pytest.mark.parametrize(
    ("step", "count", "times"),
    [(2**-7, 400_000, 4), (2**-7, 2_000_000, 7), (2**-4, 400_000, 0), (2**-7, 90_000, 0)],
)
def test_fewer_readings_do_where_they_are_many_and_often(step: float, count: int, times: int) -> None:
    drives = [SimpleNamespace(t=step * np.arange(count // 2))] * 2
    assert _passed_over(SimpleNamespace(drives=drives)) == times


def test_a_coarser_drive_goes_as_far(tmp_path: Path) -> None:
    """In as long a time, by as large angles, as often as the readings are no multiple of the steps."""
    layout = LAYOUTS["tricycle"]
    (log, *_) = written(tmp_path, layout)
    joints = problem_of(derivation_of(tmp_path, layout)).increments.joints
    fine = read(log, log.with_suffix(".truth.csv"), joints, {})
    for times in (2, 7, 100):
        coarse = fine.coarser(times, 0.25)
        assert len(coarse.t) == -(-(len(fine.t) - 1) // times) + 1
        assert (coarse.t[0], coarse.t[-1]) == (fine.t[0], fine.t[-1])
        lasting, finely = np.diff(coarse.t), np.diff(fine.t)
        for joint, column in coarse.columns.items():
            if joint.endswith(".steer"):
                assert column @ lasting == pytest.approx(fine.columns[joint] @ finely, rel=2e-2, abs=1e-2)
            else:
                assert column.sum() == pytest.approx(fine.columns[joint].sum())
        often = min(times, 6)  # of rows 0.04 s apart, one in 0.25 s at least
        assert np.array_equal(coarse.truth.t, fine.truth.t[::often])
        assert np.array_equal(fine.coarser(times, 0.01).truth.t, fine.truth.t)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name == "mecanum" else pytest.mark.slow) for name in LAYOUTS]
)
def test_clean_drives_give_the_true_parameters(tmp_path: Path, name: str) -> None:
    """Unequal wheels, a tracked point beside the robot's own, a clock that is off: each is told from the others."""
    layout = LAYOUTS[name]
    derivation = derivation_of(tmp_path, layout)
    result = calibrate(derivation, written(tmp_path, layout, tracker=Tracker(0.04 - 0.07j, late=0.13)), [])
    for parameter, value in layout.true.items():
        weak = parameter in layout.together
        assert result.parameters[parameter].observable != weak
        if not weak:
            assert result.parameters[parameter].value == pytest.approx(value, rel=3e-4, abs=2e-4)
    assert {n for group in result.unobservable for n in group} == set(layout.together)
    if not layout.together:
        assert result.fit.mount == pytest.approx((0.04, -0.07, 0.0), abs=2e-3)
    assert result.fit.offsets == pytest.approx([0.13] * len(layout.drives), abs=3e-3)
    assert result.held_out is not None and result.held_out.position < 0.01


def test_derivatives_are_those_of_the_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Against differences, of every layout, at parameters that are not nominal; and steps of a path that is reckoned
    in blocks, of which the last is shorter and one has none of them, begin and end where those of the whole do. So
    of what joints disagree by, in spans that are no blocks."""
    monkeypatch.setattr("wmrgen.tools.calibrating.path._BLOCK", 64)
    steps = np.array([0, 0, 5, 63, 64, 65, 150, 199])
    for name, layout in LAYOUTS.items():
        folder = tmp_path / name
        folder.mkdir()
        increments = problem_of(derivation_of(folder, layout)).increments
        random = np.random.default_rng(3)
        columns = {joint: 0.1 * random.standard_normal(200) for joint in increments.joints}
        values = np.array([layout.true[parameter] for parameter in increments.parameters])
        path = reckoned(increments(columns, values))
        ends = passed(increments, columns, values, steps)
        for part in ("position", "heading", "position_by", "heading_by"):
            whole = getattr(path, part)
            assert np.allclose(getattr(ends, part)[..., 0, :], whole[..., steps], rtol=1e-12, atol=1e-13)
            assert np.allclose(getattr(ends, part)[..., 1, :], whole[..., steps + 1], rtol=1e-12, atol=1e-13)
        each, *by = increments.joint_residuals(columns, values, np.arange(200))
        spans = increments.joint_residuals(columns, values, np.array([0, 1, 63, 100, 130]))[0]
        assert np.allclose(spans[:, 2], each[:, 63:100].sum(axis=1), rtol=1e-9, atol=1e-12)
        way = 1e-6 * random.standard_normal(len(values))
        more, less = (
            increments.joint_residuals(columns, values + sign * way, np.arange(200))[0] for sign in (1, -1)
        )
        assert np.allclose((more - less) / 2e-6, np.einsum("p,p...->...", way / 1e-6, by), atol=1e-6)
        for index in range(len(values)):
            step = 1e-6 * np.eye(len(values))[index]
            high = reckoned(increments(columns, values + step))
            low = reckoned(increments(columns, values - step))
            assert np.allclose((high.position - low.position) / 2e-6, path.position_by[index], atol=1e-6)
            assert np.allclose((high.heading - low.heading) / 2e-6, path.heading_by[index], atol=1e-6)


@pytest.mark.parametrize("omega", [0.0, 1e-6, 1.99e-4, 2.01e-4, -2.01e-4, 0.3, -3.0])
def test_a_step_goes_along_its_arc_and_by_omega_as_far(omega: float) -> None:
    """(e^(i omega) - 1) / (i omega), which is 1 + i omega / 2 - omega^2 / 6 - ..., and its derivative."""
    one, terms = np.ones(1), [1j**k / math.factorial(k + 1) for k in range(40)]
    step = Reckoning(one + 0j, omega * one, np.zeros((1, 1), complex), np.ones((1, 1)))
    path = reckoned(step)
    assert path.position[1] == pytest.approx(sum(c * omega**k for k, c in enumerate(terms)), rel=1e-12)
    by = sum(k * c * omega ** (k - 1) for k, c in enumerate(terms) if k)
    assert path.position_by[0, 1].real == pytest.approx(by.real, rel=1e-6, abs=1e-16)
    assert path.position_by[0, 1].imag == pytest.approx(by.imag, rel=1e-6)


@pytest.mark.parametrize(("omega", "off"), [(0.0, 1e-12), (0.1, 1e-4), (-0.4, 2e-3)])
def test_between_two_readings_the_robot_goes_along_an_arc(omega: float, off: float) -> None:
    """Of a metre and a turn; pace and derivatives are those of the way there."""
    turn, share = np.array([omega]), np.array([[0.0], [0.3], [0.7], [1.0], [1.5]])
    step = Reckoning(np.ones(1) + 0j, turn, np.ones((1, 1)) + 0.1j, np.full((1, 1), 0.2))
    ends = reckoned(step).at(np.array([[0], [1]]))
    for over in share:
        there, whole = ends.within(over), reckoned(step).position[1]
        part = Reckoning(over * step.position, over * turn, over * step.position_by, over * step.heading_by)
        true = reckoned(part).position[1] if over <= 1 else over * whole
        assert there.position == pytest.approx(true, abs=off)
        assert there.heading == pytest.approx(over * turn)
        later, before = (ends.within(over + s).position for s in (1e-6, -1e-6))
        if 0 < over < 1:
            assert ends.pace(over)[0] == pytest.approx((later - before) / 2e-6, abs=1e-9)
        more, less = (
            reckoned(replace(step, position=step.position + h * (1 + 0.1j), heading=turn + 0.2 * h))
            .at(np.array([[0], [1]]))
            .within(over)
            for h in (1e-6, -1e-6)
        )
        assert there.position_by[0] == pytest.approx((more.position - less.position) / 2e-6, abs=1e-8)


def test_what_only_appears_as_a_sum_is_named(tmp_path: Path) -> None:
    """Half length and half width of mecanum wheels: no drive tells them apart."""
    text = LAYOUTS["mecanum"].text.replace("x: 0.25", "x: half_length").replace("x: -0.25", "x: -half_length")
    text = text.replace("parameters:\n", "parameters:\n  half_length: {value: 0.25, tunable: true}\n")
    text = text.replace("  tilt: {value: 0.7, tunable: true}\n", "  tilt: pi/4\n")
    truth = LAYOUTS["mecanum"]
    layout = Layout(text, truth.wheels, {**truth.true, "tilt": np.pi / 4}, truth.drives)
    derivation = derivation_of(tmp_path, layout)
    result = calibrate(derivation, written(tmp_path, layout), [])
    assert [set(group) for group in result.unobservable] == [{"half_length", "half_width"}]
    assert result.parameters["r"].value == pytest.approx(truth.true["r"], rel=1e-4)
    assert sum(result.parameters[n].value for n in ("half_length", "half_width")) == pytest.approx(
        0.25 + truth.true["half_width"], rel=1e-3
    )
    (note,) = notes(derivation, result)
    assert note == (
        "half_width and half_length scale together on these drives, so that their values hold only together: no drive "
        "tells them apart; measure one of them, and delete its tunable: true"
    )
    for off, kept in (
        (0.0, True),
        (29.0, True),
        (31.0, False),
        (-7.0, True),
        (-9.999, False),
        (-10.001, False),
    ):
        e = result.parameters["half_width"]  # so many tenths off; no length is negative, or nearly nothing
        lost = {**result.parameters, "half_width": replace(e, value=e.nominal * (1 + 0.1 * off))}
        values = told(replace(result, parameters=lost))
        assert {"r", *(("half_width", "half_length") if kept else ())} == values.keys() & {
            "r",
            "half_width",
            "half_length",
        }
    (note,) = notes(derivation, replace(result, parameters=lost))
    assert note.startswith(
        "these drives do not tell half_width and half_length, so that they are not written: "
    )


def test_straight_lines_do_not_tell_a_track(tmp_path: Path) -> None:
    """And the drive that is added for it is one with turns."""
    layout = LAYOUTS["differential"]
    same = Layout(layout.text, layout.wheels, {**layout.true, "r_left": 0.1, "r_right": 0.1},
                  (lambda t: (0.3 + 0 * t, 0 * t, 0 * t), lambda t: (0.1 * np.sin(t) - 0.2, 0 * t, 0 * t)))  # fmt: skip
    derivation = derivation_of(tmp_path, same)
    result = calibrate(derivation, written(tmp_path, same), [])
    assert ("half_track",) in result.unobservable
    assert result.parameters["half_track"].value == pytest.approx(0.2, abs=1e-6)
    assert result.parameters["r_left"].observable and result.parameters["r_right"].observable
    (note,) = notes(derivation, result)
    assert note == (
        "these drives do not tell half_track, so that it is not written: add four turns on the spot, two each way"
    )


@pytest.mark.slow
def test_plans_hold_what_they_promise(tmp_path: Path) -> None:
    """The proposed courses, and no shorter set of them, make every parameter certain to the precision asked for."""
    for name, layout in LAYOUTS.items():
        folder = tmp_path / name
        folder.mkdir()
        derivation = derivation_of(folder, layout)
        problem = problem_of(derivation)
        choices = offers(problem, derivation)
        chosen = plan(problem, choices, 0.01)
        assert chosen, name
        finer = plan(problem, choices, 0.001)
        assert finer is None or sum(c.seconds for c in finer) >= sum(c.seconds for c in chosen)
        assert all(course in courses(problem, derivation) for course in chosen)


@pytest.mark.parametrize(("name", "count"), [("differential", 4), ("three_omni", 5)])
def test_every_course_ends_where_it_began(tmp_path: Path, name: str, count: int) -> None:
    """And turns as far to one side as to the other; at half of the speeds that it may have."""
    derivation = derivation_of(tmp_path, LAYOUTS[name])
    proposed = courses(problem_of(derivation), derivation)
    assert len(proposed) == count
    for course in proposed:
        place, heading = 0j, 0.0
        for (vx, vy, omega), seconds in ((s.twist, s.seconds) for s in course.segments):
            assert max(abs(vx), abs(vy)) in (0, 0.5) and abs(omega) <= 1
            fine = heading + omega * seconds * (np.arange(1000) + 0.5) / 1000
            place += complex(vx, vy) * seconds * np.exp(1j * fine).mean()
            heading += omega * seconds
        assert (abs(place), heading) == pytest.approx((0, 0), abs=1e-9), course.name


@pytest.mark.parametrize(
    "text",
    ["r_right: {value: 0.05, tunable: true}   # mm\r\n", 'r_right:\n    value: "50 mm"\n    tunable: true\n'],
)
def test_the_robot_file_keeps_every_other_character(tmp_path: Path, text: str) -> None:
    path = tmp_path / "r.yaml"
    wheel = "{name: w, type: fixed, x: a, y: 0.05, heading: 0, r: r_right}"
    whole = f"wmrgen: 1\nname: r\nparameters:\n  {text}  a: 0.05\nwheels:\n  - {wheel}\n"
    path.write_bytes(whole.encode())
    new = with_values(path, {"r_right": 0.0512345})
    assert new == whole.replace("50 mm", "0.0512345").replace("value: 0.05,", "value: 0.0512345,")


def test_a_range_that_the_value_leaves_is_widened(tmp_path: Path) -> None:
    path = tmp_path / "r.yaml"
    whole = (
        "wmrgen: 1\nname: r\nparameters:\n  r: {value: 0.05, tunable: [49 mm, 0.051]}\n"
        "  half: {tunable: [0.04, 0.06], value: 0.05}\nwheels:\n"
        "  - {name: w, type: fixed, x: 0, y: half, heading: 0, r: r}\n"
    )
    path.write_text(whole)
    new = with_values(path, {"r": 0.0512345, "half": 0.055})
    assert new == whole.replace("value: 0.05, tunable: [49 mm, 0.051]", "value: 0.0512345, tunable: [49 mm, 0.0512345]"
                                ).replace("value: 0.05}", "value: 0.055}")  # fmt: skip
    lower = with_values(path, {"r": 0.04, "half": 0.02})
    assert lower == whole.replace("value: 0.05, tunable: [49 mm", "value: 0.04, tunable: [0.04").replace(
        "[0.04, 0.06], value: 0.05", "[0.02, 0.06], value: 0.02"
    )
    path.write_text(lower)
    assert [float(p.low) for p in wmrgen.load(path).tunable] == [0.04, 0.02]


def _rows(text: str) -> tuple[str, np.ndarray]:
    header, *rows = text.strip().split("\n")
    return header, np.array([[float(cell or "nan") for cell in row.split(",")] for row in rows])


def _text(header: str, rows: np.ndarray) -> str:
    return csv(dict(zip(header.split(","), rows.T, strict=True)))


MISTAKES: dict[str, tuple[Callable[[np.ndarray, np.ndarray], None], str]] = {
    "theta in degrees": (
        lambda log, truth: _times(truth, 3, 180 / np.pi),
        "theta of the truth .* in degrees",
    ),
    "x and y in millimetres": (lambda log, truth: _times(truth, slice(1, 3), 1000), "in millimetres"),
    "x and y in centimetres": (lambda log, truth: _times(truth, slice(1, 3), 100), "in centimetres"),
    "x and y in feet": (lambda log, truth: _times(truth, slice(1, 3), 1 / 0.3048), "in feet"),
    "wheels in metres": (
        lambda log, truth: _times(log, slice(1, None), 0.042),
        "turn 2[345].* times .* metres at the rim",
    ),
    "theta in turns": (lambda log, truth: _times(truth, 3, 0.5 / np.pi), "theta of the truth .* in turns"),
    "the truth mirrored": (
        lambda log, truth: _times(truth, slice(2, 4), -1),
        "with y and theta of the truth counted the other way",
    ),
    "counts of 4096": (
        lambda log, truth: _times(log, slice(1, None), 4096 / 2 / np.pi),
        "counts of an encoder, about 4[012]",
    ),
    "every wheel the other way": (
        lambda log, truth: _times(log, slice(1, None), -1),
        "every wheel counted the other way",
    ),
    "times of the log in steps": (lambda log, truth: _times(log, 0, 20.0), "which t is not in seconds"),
    "theta the other way": (
        lambda log, truth: _times(truth, 3, -1),
        "theta of the truth counted the other way",
    ),
    "x and y exchanged": (lambda log, truth: _exchanged(truth, 1, 2), "x and y of the truth exchanged"),
    "joints in degrees": (
        lambda log, truth: _times(log, slice(1, None), 180 / np.pi),
        "angles of the (wheels|joints) .* in degrees",
    ),
    "joints in turns": (lambda log, truth: _times(log, slice(1, None), 0.5 / np.pi), "wheels .* in turns"),
    "the first joint the other way": (
        lambda log, truth: _times(log, 1, -1),
        r"(left|right)\.spin counted the other way",
    ),
    "the first joint still": (
        lambda log, truth: _times(log, 1, 0),
        r"right\.spin of run-0[12] is 0 from the first reading to the last",
    ),
    "the first two joints exchanged": (
        lambda log, truth: _exchanged(log, 1, 2),
        "spin exchanged|exchanged with",
    ),
}


def _times(rows: np.ndarray, column: int | slice, factor: float) -> None:
    rows[:, column] *= factor


def _exchanged(rows: np.ndarray, a: int, b: int) -> None:
    rows[:, [a, b]] = rows[:, [b, a]]


def mistaken(paths: list[Path], mistake: str) -> str:
    """Write a mistake into the logs and their truths; what has to be said of it."""
    change, said = MISTAKES[mistake]
    for path in paths:
        truth = path.with_suffix(".truth.csv")
        (header, log), (truth_header, poses) = (
            _rows(file.read_text(encoding="utf-8")) for file in (path, truth)
        )
        change(log, poses)
        path.write_text(_text(header, log), encoding="utf-8")
        truth.write_text(_text(truth_header, poses), encoding="utf-8")
    return said


SLOW_MISTAKES = [
    *((mistake, "diff-square") for mistake in MISTAKES),
    ("the first two joints exchanged", "tricycle-circle"),
    ("the first two joints exchanged", "omni3-square"),
    ("joints in degrees", "tricycle-circle"),
]


@pytest.mark.parametrize(
    ("mistake", "name"),
    [
        ("joints in degrees", "differential"),
        *(pytest.param(*case, marks=pytest.mark.slow) for case in SLOW_MISTAKES),
    ],
)
def test_a_mistake_in_logs_is_named(tmp_path: Path, mistake: str, name: str) -> None:
    """Of two drives, simulated and real."""
    if name in LAYOUTS:
        paths, robot = written(tmp_path, LAYOUTS[name])[:2], derivation_of(tmp_path, LAYOUTS[name])
    else:
        paths, robot = [], wmrgen.derive(wmrgen.load(LOGS / name / "robot.yaml"))
        for run in ("run-01", "run-02"):
            paths.append(tmp_path / f"{run}.csv")
            for end in (".csv", ".truth.csv"):
                shutil.copy(LOGS / name / f"{run}{end}", paths[-1].with_suffix(end))
    with pytest.raises(UsageError, match=mistaken(paths, mistake)):
        calibrate(robot, paths, [])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mistake", "name", "times"),
    [
        *(
            (m, "differential", 1)
            for m in ("joints in degrees", "x and y in millimetres", "the truth mirrored")
        ),
        ("the truth mirrored", "differential", 3),
        ("joints in degrees", "mecanum", 1),
        ("the truth mirrored", "mecanum", 1),
    ],
)
def test_a_mistake_in_the_last_of_three_or_nine_logs_is_named(
    tmp_path: Path, mistake: str, name: str, times: int
) -> None:
    """Those before agree under other readings, too: as they are, or with all wheels the other way."""
    layout = replace(LAYOUTS[name], drives=times * LAYOUTS[name].drives)
    paths = written(tmp_path, layout, seconds=20, encoders=Encoders(slip=0.01))
    run = paths[-1].stem
    said = f"the others agree without {run}: they would agree .*{mistaken(paths[-1:], mistake)}"
    with pytest.raises(UsageError, match=said):
        calibrate(derivation_of(tmp_path, layout), paths, [])


@pytest.mark.slow
@pytest.mark.parametrize(("name", "count"), [("differential", 3), ("tricycle", 2)])
def test_truths_of_two_drives_that_are_exchanged_are_named(tmp_path: Path, name: str, count: int) -> None:
    """A tricycle's would also agree, by far less, with angles counted the other way."""
    paths = written(tmp_path, LAYOUTS[name], seconds=24.0, encoders=Encoders(slip=0.01))[:count]
    first, second = (path.with_suffix(".truth.csv") for path in paths[:2])
    texts = first.read_text(encoding="utf-8"), second.read_text(encoding="utf-8")
    first.write_text(texts[1], encoding="utf-8")
    second.write_text(texts[0], encoding="utf-8")
    with pytest.raises(UsageError, match=r"the truths of run-[01] and run-[01] exchanged"):
        calibrate(derivation_of(tmp_path, LAYOUTS[name]), paths, [])


@pytest.mark.slow
def test_joints_that_hold_under_other_parameters_than_the_truth_are_refused(tmp_path: Path) -> None:
    """Steering angles from the left in place of ahead: all were left nominal, with the paths metres from the truth."""
    paths = written(tmp_path, LAYOUTS["swerve"], seconds=24.0, rate=20.0, encoders=Encoders(slip=0.01))[:2]
    for path in paths:
        header, log = _rows(path.read_text(encoding="utf-8"))
        log[:, [name.endswith(".steer") for name in header.split(",")]] += np.pi / 2
        path.write_text(_text(header, log), encoding="utf-8")
    with pytest.raises(UsageError, match=r"zero_a is -1.* and zero_b is -1"):
        calibrate(derivation_of(tmp_path, LAYOUTS["swerve"]), paths, [])


@pytest.mark.parametrize(
    ("value", "sigma", "nominal", "observable", "far"),
    [
        (0.0676, 1e-4, 0.1, True, True),
        (-0.1, 1e-4, 0.1, True, True),
        (0.116, 1e-4, 0.1, True, True),
        (0.114, 1e-4, 0.1, True, False),  # as a soft tyre is
        (0.12, 7e-3, 0.1, True, False),
        (0.12, 1e-4, 0.1, False, False),
        (0.3, 1e-4, 0.0, True, False),  # an angle of which nobody knew
    ],
)
def test_a_length_that_no_tape_measure_gives_is_told(
    value: float, sigma: float, nominal: float, observable: bool, far: bool
) -> None:
    assert _far_off(Estimate(value, sigma, nominal, observable)) == far


@pytest.mark.slow
def test_a_clock_that_runs_away_is_no_slip(tmp_path: Path) -> None:
    """A wheel that counts the other way in one drive of three: least errors had its clock 31 s off, where log and truth
    hardly overlap, and most of the drive was left out as slips."""
    paths = written(tmp_path, LAYOUTS["differential"], tracker=Tracker(0.03 - 0.02j, late=0.1, noise=(0.002, 0.003)),
                    encoders=Encoders(2 * np.pi / 400, slip=0.01))  # fmt: skip
    said = "the others agree without run-2: they would agree with "
    said += mistaken(paths[2:], "the first joint the other way")
    with pytest.raises(UsageError, match=said):
        calibrate(derivation_of(tmp_path, LAYOUTS["differential"]), paths, [])


@pytest.mark.slow
@pytest.mark.parametrize(
    "mistake", ["joints in degrees", "theta in degrees", "the first joint the other way"]
)
def test_a_mistake_beside_headings_alone_is_named(tmp_path: Path, mistake: str) -> None:
    """No ways of the truth tell how many counts would be a turn."""
    paths = written(tmp_path, LAYOUTS["differential"])
    _truths(paths, lambda rows: rows * (1, np.nan, np.nan, 1))
    with pytest.raises(UsageError, match=f"they would agree with {mistaken(paths, mistake)}$"):
        calibrate(derivation_of(tmp_path, LAYOUTS["differential"]), paths, [])


def test_clocks_of_a_fleet_are_told_in_one_line() -> None:
    """Those of a few drives one by one. What circles at one speed make of an offset, which is a start that is farther
    along them, is within three standard deviations: such offsets were told, of a second and more."""
    clocks = {f"run-{k}": 0.01 * k - 0.02 for k in range(12)}
    (line,) = _late(clocks, dict.fromkeys(clocks, 0.001))
    assert line == "the truth's clocks of 7 of 12 drives are off, by +0.030 to +0.090 s"
    assert _late(clocks, dict.fromkeys(clocks, 0.026)) == [
        "run-10: the truth's clock is +0.080 +- 0.03 s off", "run-11: the truth's clock is +0.090 +- 0.03 s off"
    ]  # fmt: skip
    assert _late({"a": -0.021, "b": 0.02}, {"a": 0.0, "b": 0.0}) == [
        "a: the truth's clock is -0.021 +- 0 s off"
    ]


@pytest.mark.parametrize(
    ("drift", "said"),
    [
        (
            Drift("a", 14.0, 18.0, 0.7, 0.0, True),
            "the truth's clock jumps by -0.70 s from t = 14.0 to 18.0 s: each part is fitted alone",
        ),
        (
            Drift("a", 2.0, 42.0, -0.4, 0.0),
            "the truth's clock drifts by +0.40 s from t = 2.0 to 42.0 s, so parameters may be wrong",
        ),
        (
            Drift("a", 2.0, 42.0, 0.0, -0.08),
            "the truth's heading drifts by -0.080 rad from t = 2.0 to 42.0 s, so parameters may be wrong",
        ),
    ],
)
def test_what_is_said_of_drifts(drift: Drift, said: str) -> None:
    assert _drifting(drift) == f"a: {said}"


def _truths(paths: list[Path], change: Callable[[np.ndarray], np.ndarray]) -> None:
    """Rewrite the rows (t, x, y, theta) of each truth."""
    for path in (path.with_suffix(".truth.csv") for path in paths):
        header, rows = _rows(path.read_text(encoding="utf-8"))
        path.write_text(_text(header, change(rows)), encoding="utf-8")


def test_ends_of_drives_that_turn_by_more_than_half_a_turn(
    tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """Headings between -pi and pi, at start and end alone: whole turns between them come from the joints. Of three
    drives, unknowns are as many as measurements: no standard deviation is told, and that is said."""
    layout = LAYOUTS["differential"]
    (tmp_path / "robot.yaml").write_text(layout.text, encoding="utf-8")
    paths = written(tmp_path, layout)
    turns = []

    def ends(rows: np.ndarray) -> np.ndarray:
        turns.append(np.ptp(rows[[0, -1], 3]))
        rows[:, 3] = (rows[:, 3] + np.pi) % (2 * np.pi) - np.pi
        return rows[[0, -1]]

    _truths(paths, ends)
    assert max(turns) > 2 * np.pi
    outcomes = [wmrgen_cli("calibrate", tmp_path / "robot.yaml", *paths, *more) for more in ((), ("--json",))]
    assert outcomes[0].out.count(" +- ?   nominal ") == len(layout.true)
    data = json.loads(outcomes[1].out)
    # Two wheels tell no more than a twist: they disagree by what is rounded, of which nothing is said.
    assert max(data["residuals"]["by_joint"].values()) < 1e-9 and "disagree" not in outcomes[0].out
    for parameter, value in layout.true.items():
        estimate = data["parameters"][parameter]
        assert abs(estimate["value"] - value) < 0.02 * value and estimate["sigma"] is None
    (note,) = (
        note for note in data["notes"] if note.startswith("as many unknowns as measurements: no standard")
    )
    assert note in outcomes[0].err and note.endswith("; add drives, or poses between start and end")


def test_one_drive_of_two_poses_leaves_nothing_to_compare_with(tmp_path: Path) -> None:
    """Of which no part can be left out: nothing is certain."""
    layout = LAYOUTS["differential"]
    robot, paths = derivation_of(tmp_path, layout), written(tmp_path, layout)[:1]
    _truths(paths, lambda rows: rows[[0, -1]])
    result = calibrate(robot, paths, [])
    assert result.held_out is None
    assert all(np.isinf(estimate.sigma) for estimate in result.parameters.values())


def test_the_solver_halts_where_readings_are_rough(tmp_path: Path) -> None:
    """Quantised angles make the cost rough in the clock: 13 evaluations do, where going on to no gradient takes 27."""
    layout = LAYOUTS["differential"]
    derivation = derivation_of(tmp_path, layout)
    encoders = Encoders(resolution=2 * np.pi / 400)
    paths = written(tmp_path, layout, tracker=Tracker(noise=(0.002, 0.003)), encoders=encoders)
    evaluations = []

    def each(problem: Problem, unknowns: Any, task: Any) -> Any:
        if task is sums:
            evaluations.append(unknowns)
        return serial(problem, unknowns, task)

    problem = problem_of(derivation)
    drive = read(paths[0], paths[0].with_suffix(".truth.csv"), problem.increments.joints, {})
    ready = laid(replace(problem, drives=(drive,)))
    best = fit(ready, each, start_of(ready))
    assert len(evaluations) < 20
    half_track = best.values[problem.increments.parameters.index("half_track")]
    assert half_track == pytest.approx(layout.true["half_track"], rel=2e-3)


@pytest.mark.parametrize("measured", [True, False], ids=["headings", "places alone"])
def test_pieces_are_looked_at_where_odometry_loses_its_way(tmp_path: Path, measured: bool) -> None:
    """As with a third of the track, and not with true parameters: headings and places are those of the truth."""
    layout = LAYOUTS["differential"]
    paths, problem = written(tmp_path, layout), problem_of(derivation_of(tmp_path, layout))
    run = read(paths[0], paths[0].with_suffix(".truth.csv"), problem.increments.joints, {})
    if not measured:
        run = replace(run, truth=replace(run.truth, theta=np.full_like(run.truth.theta, np.nan)))
    for share, near in ((1.0, True), (1 / 3, False)):
        track = {"half_track": share * layout.true["half_track"]}
        nominal = ({**layout.true, **track}[name] for name in problem.increments.parameters)
        ready = laid(replace(problem, nominal=tuple(nominal), drives=(run,)))
        assert _found(ready, start_of(ready), 0) == near


SLIPS = ((7.0, 7.6, 1.8), (20.0, 20.4, 0.3))


SLIPPING = [
    pytest.param(name, marks=[] if name == "mecanum" else pytest.mark.slow)
    for name in ("mecanum", "car", "swerve", "tricycle")
]


@pytest.mark.parametrize("name", SLIPPING)
def test_slips_are_found_and_left_out(tmp_path: Path, name: str) -> None:
    """A wheel that spins and one that is held: where they stand, by the joints or by the path, and nowhere else."""
    layout = LAYOUTS[name]
    first = next(iter(layout.wheels(layout.true)))
    episodes = tuple((start, end, first, factor) for start, end, factor in SLIPS)
    encoders = Encoders(2 * np.pi / 400, slip=0.01, episodes=episodes)
    tracker = Tracker(0.04, 0.1, noise=(0.003, 0.005), every=2)
    clean = [replace(encoders, episodes=()), encoders, encoders]
    paths = []
    for index, readings in enumerate(clean):
        recorded = drive(layout, layout.drives[index], tracker=tracker, encoders=readings, seed=index)
        paths.append(tmp_path / f"run-{index}.csv")
        paths[-1].write_text(csv(recorded.log), encoding="utf-8")
        paths[-1].with_suffix(".truth.csv").write_text(csv(recorded.truth), encoding="utf-8")
    result = calibrate(derivation_of(tmp_path, layout), paths, [])
    assert {slip.drive for slip in result.outliers} == {"run-1", "run-2"}
    for slip in result.outliers:
        assert any(slip.start < end and start < slip.end for start, end, _ in SLIPS)
    for parameter, value in layout.true.items():
        estimate = result.parameters[parameter]
        assert abs(estimate.value - value) < 3 * estimate.sigma


def test_a_long_drive_with_large_slips(tmp_path: Path) -> None:
    """Where they turn the robot by more than a radian in all, clocks ran away, and the drive was refused."""
    layout, tracker = LAYOUTS["differential"], Tracker(0.04, late=0.9, noise=(0.002, 0.003), every=2)
    episodes = ((13.3, 14.4, "right", 2.5), (31.0, 31.8, "right", 2.5), (61.0, 62.1, "right", 2.5))
    encoders = Encoders(2 * np.pi / 1000, slip=0.005, episodes=episodes)
    one = replace(layout, drives=layout.drives[:1])
    logs = written(tmp_path, one, seconds=80, rate=20, tracker=tracker, encoders=encoders)
    result = calibrate(derivation_of(tmp_path, layout), logs, [])
    assert result.clocks["run-0"] == pytest.approx(0.9, abs=0.02)
    assert abs(result.clocks["run-0"] - 0.9) < 3 * result.clock_deviations["run-0"] < 0.1
    assert len(result.outliers) == len(episodes)
    for slip, (start, end, *_) in zip(result.outliers, episodes, strict=True):
        assert slip.start < end and start < slip.end
    for parameter, value in layout.true.items():
        estimate = result.parameters[parameter]
        assert abs(estimate.value - value) < 3 * estimate.sigma < 0.03 * value


@pytest.mark.parametrize(
    "tracker", [Tracker(noise=(0.008, 0.003)), Tracker(0.03 - 0.02j)], ids=["noisy", "exact"]
)
def test_a_turn_on_the_spot_alone_tells_how_lengths_go_together(tmp_path: Path, tracker: Tracker) -> None:
    """The truth extends over a tracker's noise alone. Slips make the only way that odometry goes, so least errors are
    those of no lengths at all: such lengths were written, or the drive refused."""
    layout = replace(LAYOUTS["differential"], drives=(lambda t: (0 * t, 0 * t, 0.5 + 0 * t),))
    logs = written(tmp_path, layout, seconds=20, tracker=tracker, encoders=Encoders(slip=0.01))
    result = calibrate(derivation_of(tmp_path, layout), logs, [])
    assert result.after.position < 0.016
    assert {"r_left", "r_right", "half_track"} <= {n for group in result.unobservable for n in group}
    value = {name: estimate.value for name, estimate in result.parameters.items()}
    assert value["half_track"] / (value["r_left"] + value["r_right"]) == pytest.approx(
        0.2071 / 0.2007, rel=0.003
    )
    for parameter, true in layout.true.items():
        estimate = result.parameters[parameter]
        assert abs(estimate.value - true) < 3 * estimate.sigma < 0.4 * true


def test_straight_lines_that_slips_bend_tell_radii(tmp_path: Path) -> None:
    """Slips are all that odometry turns by, so least errors have half_track 1.3 m: headings of the truth in turns
    were proposed."""
    layout = replace(
        LAYOUTS["differential"], drives=(lambda t: (0.3 + 0.1 * np.sin(0.5 * t), 0 * t, 0 * t),) * 3
    )
    options = {"seconds": 40.0, "rate": 20.0, "encoders": Encoders(2 * np.pi / 400, slip=0.01)}
    logs = written(tmp_path, layout, tracker=Tracker(0.03 - 0.02j, noise=(0.002, 0.003)), **options)
    result = calibrate(derivation_of(tmp_path, layout), logs, [])
    assert ("half_track",) in result.unobservable
    for parameter in ("r_left", "r_right"):
        estimate = result.parameters[parameter]
        assert estimate.observable and abs(estimate.value - layout.true[parameter]) < 3 * estimate.sigma


@pytest.mark.slow
def test_straight_lines_of_a_swerve_drive_tell_its_radii(tmp_path: Path) -> None:
    """Slips alone tell where all modules look and how far apart they are, and joints went where these led: such drives
    were refused, "joints tell other parameters than the truth"."""
    layout = LAYOUTS["swerve"]
    lines = tuple(partial(_line, speed=speed) for speed in (0.3, -0.3))
    options = {"seconds": 40.0, "rate": 10.0, "encoders": Encoders(2 * np.pi / 400, slip=0.01)}
    logs = written(
        tmp_path,
        replace(layout, drives=lines),
        tracker=Tracker(0.03 - 0.02j, noise=(0.002, 0.003)),
        **options,
    )
    result = calibrate(derivation_of(tmp_path, layout), logs, [])
    assert ("half",) in result.unobservable
    assert {"zero_a", "zero_b"} in map(set, result.unobservable)
    for parameter, value in layout.true.items():
        estimate = result.parameters[parameter]
        assert abs(estimate.value - value) < 3 * estimate.sigma
        if parameter.startswith("r_"):
            assert estimate.observable and estimate.value == pytest.approx(value, rel=0.003)
    zeros = [result.parameters[name].value for name in ("zero_a", "zero_b")]
    assert zeros[1] - zeros[0] == pytest.approx(0.05, abs=0.005)  # joints tell it: [rad]


def _line(t: np.ndarray, speed: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return speed + 0.1 * np.sin(0.5 * t), 0 * t, 0 * t


@pytest.mark.parametrize(("count", "folds"), [(1, 5), (2, 2)])
def test_drives_are_held_out_each_and_one_drive_by_parts(
    tmp_path: Path, count: int, folds: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    layout, parts = LAYOUTS["differential"], []
    monkeypatch.setattr(
        "wmrgen.tools.calibrating.calibrate._held_out",
        lambda best, others: parts.append((len(best.problem.drives), len(others))) or _held_out(best, others),
    )
    paths = written(tmp_path, layout, tracker=Tracker(noise=(0.002, 0.003)))
    result = calibrate(derivation_of(tmp_path, layout), paths[:count], [])
    assert parts == [(folds, folds)]
    assert result.held_out is not None and result.held_out.position < 0.01
    assert [drive.name for drive in result.fit.problem.drives] == [f"run-{k}" for k in range(count)]


def test_headings_alone(tmp_path: Path) -> None:
    """As a gyro gives them: they tell ratios of radii to the track, and not the scale of all."""
    layout = LAYOUTS["differential"]
    paths = written(tmp_path, layout)
    _truths(paths, lambda rows: rows * (1, np.nan, np.nan, 1))
    result = calibrate(derivation_of(tmp_path, layout), paths, [])
    assert [set(group) for group in result.unobservable] == [set(layout.true)]
    value = {name: estimate.value for name, estimate in result.parameters.items()}
    for name in ("r_left", "r_right"):
        expected = layout.true[name] / layout.true["half_track"]
        assert value[name] / value["half_track"] == pytest.approx(expected, rel=1e-3)


TURNED = [(name, turned) for name in LAYOUTS for turned in (np.pi / 2, np.pi, -1.8)]


@pytest.mark.parametrize(
    ("name", "turned"),
    [
        pytest.param(n, a, marks=[] if (n, a) == ("differential", np.pi) else pytest.mark.slow)
        for n, a in TURNED
    ],
)
def test_a_tracker_that_is_turned_on_the_robot(tmp_path: Path, name: str, turned: float) -> None:
    """By any angle, far beside the robot, its clock late, the drive anywhere: no radius becomes negative."""
    layout = LAYOUTS[name]
    tracker = Tracker(-0.3 + 0.5j, turned, late=-0.3, every=5, start=(3 - 2j, 2.6))
    result = calibrate(derivation_of(tmp_path, layout), written(tmp_path, layout, tracker=tracker), [])
    for parameter in set(layout.true) - set(layout.together):
        assert result.parameters[parameter].value == pytest.approx(layout.true[parameter], rel=3e-4, abs=2e-4)
    if "zero" not in layout.together:
        assert np.cos(result.fit.mount[2] - turned) == pytest.approx(1, abs=1e-5)
    assert result.after.position < 0.005


MOVING: dict[str, tuple[Callable[[np.ndarray], np.ndarray], str]] = {
    "clock jumps": (lambda rows: rows + 0.8 * (rows[:, :1] > 14) * (1, 0, 0, 0), "clock jumps by"),
    "clock runs": (lambda rows: rows * (1.03, 1, 1, 1), "clock drifts by"),
    "heading drifts": (lambda rows: rows + 0.01 * rows[:, :1] * (0, 0, 0, 1), "heading drifts by"),
    "nothing moves": (lambda rows: rows, ""),
}


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.slow) for n in ("tricycle", "swerve")])
def test_a_truth_that_drifts_or_jumps_is_named(
    tmp_path: Path, wmrgen_cli: Callable[..., Outcome], name: str
) -> None:
    """Its clock, in two of the drives at least, or its heading, in each; and none where nothing moves; parameters stay
    within three standard deviations where a clock jumps."""
    layout = LAYOUTS[name]
    (tmp_path / "robot.yaml").write_text(layout.text, encoding="utf-8")
    tracker, encoders = Tracker(0.04, late=0.1, noise=(0.002, 0.003)), Encoders(2 * np.pi / 400, slip=0.01)
    for change, said in MOVING.values():
        paths = written(tmp_path, layout, tracker=tracker, encoders=encoders)
        _truths(paths, change)
        outcome = wmrgen_cli("calibrate", str(tmp_path / "robot.yaml"), *map(str, paths), "--json")
        data = json.loads(outcome.out)
        notes = [note for note in data["notes"] if "drifts" in note or "jumps" in note]
        assert all(said in note for note in notes) and (len(notes) > 1) == bool(said)
        if "jumps" in said:
            for parameter, value in layout.true.items():
                estimate = data["parameters"][parameter]
                assert abs(estimate["value"] - value) < 3 * estimate["sigma"]


@pytest.mark.slow
def test_exchanged_columns_are_named(tmp_path: Path) -> None:
    layout = LAYOUTS["mecanum"]
    paths = written(tmp_path, layout)
    for path in paths:
        path.write_text(path.read_text(encoding="utf-8").replace("fl.angle,fr.angle", "fr.angle,fl.angle"))
    with pytest.raises(UsageError, match=r"fl\.spin and fr\.spin exchanged"):
        calibrate(derivation_of(tmp_path, layout), paths, [])


def test_one_clock_is_not_estimated(tmp_path: Path) -> None:
    """So starts and ends of drives tell their lengths though nobody stood still there: with clocks of their own these
    would be anything."""
    layout = LAYOUTS["tricycle"]
    derivation = derivation_of(tmp_path, layout)
    encoders = Encoders(resolution=2 * np.pi / 400, steer=0.002, slip=0.01)
    paths = written(tmp_path, layout, encoders=encoders)
    _truths(paths, lambda rows: rows[[0, -1]])
    free, one = (calibrate(derivation, paths, [], one_clock=held) for held in (False, True))
    assert max(map(abs, one.clocks.values())) < 1e-4 < 0.01 < max(map(abs, free.clocks.values()))
    assert one.fit.freedom - free.fit.freedom == len(paths)
    for name, value in layout.true.items():
        assert abs(one.parameters[name].value - value) < 3 * one.parameters[name].sigma
        assert (
            3 * one.parameters[name].sigma < 0.1 < free.parameters[name].sigma
        )  # of three drives nothing is certain


@pytest.mark.parametrize("error", [1e-5, 1.0])
def test_a_first_pose_counts_by_its_error(tmp_path: Path, error: float) -> None:
    """Drives begin there as near as it is known. An error that is larger than that of all poses changes nothing; parts
    of a drive that begin later have none."""
    layout = LAYOUTS["differential"]
    derivation = derivation_of(tmp_path, layout)
    paths = written(tmp_path, layout, tracker=Tracker(noise=(0.002, 0.003)), encoders=Encoders(slip=0.01))
    free = calibrate(derivation, paths, [])
    known = calibrate(derivation, paths, [], start_error=error)

    def starts(result: Calibration) -> list[float]:
        fit = result.fit
        every = (residuals(fit.problem, fit.unknowns, index) for index in range(len(paths)))
        return [float(np.max(np.abs(rows.values[:, 0]))) for rows in every]

    assert max(starts(free)) > 1e-4
    if error < 1e-3:
        assert max(starts(known)) < error
    else:
        for name, estimate in free.parameters.items():
            assert known.parameters[name].value == pytest.approx(estimate.value, rel=1e-4)
    whole = known.fit.problem.drives[0]
    assert [part.start_error for part in (whole, whole.part(0, 300), whole.part(300, 600))] == [
        error,
        error,
        np.inf,
    ]


def _square(way: int) -> Twist:
    """Two metres a side, with turns on the spot, once; a second of rest before and after."""

    def twist(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        within, driven = np.mod(t - 1, 9.0), (t > 1) & (t < 37)
        ahead = driven & (within < 5)
        return 0.4 * ahead, 0 * t, way * np.pi / 8 * (driven & ~ahead)

    return twist


@pytest.mark.parametrize(
    "name", ["differential", *(pytest.param(n, marks=pytest.mark.slow) for n in ("three_omni", "mecanum"))]
)
def test_squares_of_which_the_ends_are_measured_tell_how_lengths_go_together(
    tmp_path: Path, name: str
) -> None:
    """UMBmark: the robot comes back to where it began, whatever its size is, so least errors have radii of 0. They stay
    about nominal, and what they make together is told; no other reading of the columns is proposed for it."""
    layout = LAYOUTS[name]
    derivation = derivation_of(tmp_path, layout)
    squares = replace(layout, drives=tuple(_square(way) for way in (1, -1) * 3))
    encoders = Encoders(resolution=2 * np.pi / 400, slip=0.01)
    paths = written(tmp_path, squares, seconds=38.0, tracker=Tracker(late=0.1), encoders=encoders)
    _truths(paths, lambda rows: rows[[0, -1]])
    result = calibrate(derivation, paths, [])
    assert result.unobservable
    for e in result.parameters.values():
        assert abs(e.value / e.nominal - 1) < 0.06 and 0.02 < e.sigma / e.nominal < 0.2
    assert result.held_out is not None and result.held_out.position < 0.02
    if name == "differential":
        ratio = result.parameters["r_left"].value / result.parameters["r_right"].value
        assert ratio == pytest.approx(layout.true["r_left"] / layout.true["r_right"], rel=0.002)


@pytest.mark.slow
def test_partial_truth(tmp_path: Path) -> None:
    """Start and end alone, with the heading at the start alone: two drives of it tell a radius."""
    layout = LAYOUTS["differential"]
    derivation = derivation_of(tmp_path, layout)
    paths = written(tmp_path, layout)
    for path in paths:
        header, *rows = path.with_suffix(".truth.csv").read_text(encoding="utf-8").strip().split("\n")
        last = rows[-1].split(",")
        kept = [header, rows[0], f"{last[0]},{last[1]},{last[2]},"]
        path.with_suffix(".truth.csv").write_text("\n".join(kept) + "\n", encoding="utf-8")
    result: Calibration = calibrate(derivation, paths, [])
    assert np.isfinite(result.fit.rms[0])
    assert result.fit.rms[0] < 0.05


@pytest.mark.slow
def test_the_command(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    """What design fixes of `--json`, and the new robot file."""
    layout = LAYOUTS["differential"]
    (tmp_path / "robot.yaml").write_text(layout.text, encoding="utf-8")
    paths = [str(path) for path in written(tmp_path, layout)]
    new = tmp_path / "new.yaml"
    outcome = wmrgen_cli("calibrate", str(tmp_path / "robot.yaml"), *paths, "--json", "-o", str(new))
    assert outcome.code == 0, outcome.err
    data = json.loads(outcome.out)
    assert set(data["parameters"]) == set(layout.true)
    assert all({"value", "sigma", "observable"} <= set(entry) for entry in data["parameters"].values())
    assert data["unobservable"] == [] and data["rms"] < 0.001
    tuned = {p.name: float(p.nominal) for p in wmrgen.load(new).tunable}
    assert tuned == pytest.approx(layout.true, rel=3e-4)
    tenths = data["residuals"]["by_time"]["run-0"]
    assert len(tenths) == 10 and max(row["position"] for row in tenths) < 0.002
    told = wmrgen_cli("calibrate", str(tmp_path / "robot.yaml"), *paths)
    assert "half_track = 0.207" in told.out and told.code == 0
    robot, certain = tmp_path / "robot.yaml", "the drives make every parameter certain to 1 % already\n"
    assert wmrgen_cli("calibrate", robot, *paths, "--plan").out == told.out + certain
    assert json.loads(wmrgen_cli("calibrate", robot, *paths, "--plan", "--json").out) == {**data, "plan": []}
    planned = wmrgen_cli("calibrate", robot, "--plan", "--precision", "0.03").out
    assert planned == "a straight line of 4 m and back: 16 s\nfour turns on the spot, two each way: 25 s\n"
    finer = wmrgen_cli("calibrate", robot, "--plan", "--precision", "1e-6").out
    assert finer == "none of the drives makes every parameter certain to 0.0001 %\n"
    assert wmrgen_cli("calibrate", robot).code == 2
    held = json.loads(
        wmrgen_cli("calibrate", robot, *paths, "--json", "--one-clock", "--start-error", "0.001").out
    )
    assert max(map(abs, held["clock_offsets"].values())) < 1e-4
    assert held["clock_sigmas"].keys() == held["clock_offsets"].keys()
    for wrong in ("0", "-1", "nan"):
        refused = wmrgen_cli("calibrate", robot, *paths, f"--start-error={wrong}")
        assert refused.code == 2 and "it has to be above 0" in refused.err


@pytest.mark.slow
@pytest.mark.parametrize("name", LAYOUTS)
def test_nominal_values_far_off_and_long_drives(tmp_path: Path, name: str) -> None:
    """Nominal odometry loses its way within the drive; short pieces of it lead to the parameters."""
    layout = LAYOUTS[name]
    far = re.sub(r"value: (0\.\d+)", lambda m: f"value: {1.25 * float(m[1]):.6g}", layout.text)
    assert far != layout.text
    far_off = replace(layout, text=far)
    encoders = Encoders(resolution=2 * np.pi / 1000, slip=0.003)
    tracker = Tracker(0.03 - 0.02j, 1.0, noise=(0.002, 0.003), start=(2j, -1.0))
    paths = written(tmp_path, far_off, seconds=120, tracker=tracker, encoders=encoders)
    result = calibrate(derivation_of(tmp_path, far_off), paths, [])
    for parameter in set(layout.true) - set(layout.together):
        estimate = result.parameters[parameter]
        assert abs(estimate.value - layout.true[parameter]) < 3.5 * estimate.sigma
        assert estimate.sigma < 0.03 * max(estimate.value, 0.2)


def test_a_truth_that_lasts_longer_than_the_log(tmp_path: Path) -> None:
    """Where the robot was before the first and after the last reading says nothing."""
    layout = LAYOUTS["differential"]
    paths = written(tmp_path, layout)
    for path in paths:
        header, rows = _rows(path.read_text(encoding="utf-8"))
        path.write_text(_text(header, rows[(rows[:, 0] > 6) & (rows[:, 0] < 24)]), encoding="utf-8")
    result = calibrate(derivation_of(tmp_path, layout), paths, [])
    for parameter, value in layout.true.items():
        assert result.parameters[parameter].value == pytest.approx(value, rel=3e-4)


def test_files_for_others(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    """A picture of all drives and each parameter, what diff_drive_controller reads, and a macro for the C."""
    layout = LAYOUTS["differential_with_castor"]
    (tmp_path / "robot.yaml").write_text(layout.text, encoding="utf-8")
    paths = [str(path) for path in written(tmp_path, layout)]
    texts = []
    for name in ("one", "two"):
        folder = tmp_path / name
        outcome = wmrgen_cli("calibrate", str(tmp_path / "robot.yaml"), *paths, "--files", str(folder))
        assert outcome.code == 0, outcome.err
        texts.append({path.name: path.read_text(encoding="utf-8") for path in sorted(folder.iterdir())})
    assert texts[0] == texts[1]
    files = texts[0]
    picture = ElementTree.fromstring(files["differential_with_castor_calibration.svg"])
    drawn = [e.get("class") for e in picture.iter("{http://www.w3.org/2000/svg}polyline")]
    assert (drawn.count("truth"), drawn.count("before"), drawn.count("after")) == (1 + 3, 1 + 6, 1 + 6)
    assert {"radius", "track"} <= {e.text for e in picture.iter("{http://www.w3.org/2000/svg}text")}
    assert float((picture.get("viewBox") or "").split()[2]) <= 480  # words of 12 px are 10 px high at 400
    ros = yaml.safe_load(files["differential_with_castor_controllers.yaml"])
    parameters = ros["base_controller"]["ros__parameters"]
    assert parameters["wheel_separation"] == pytest.approx(layout.true["track"], rel=1e-3)
    assert parameters["wheel_radius"] == pytest.approx(layout.true["radius"], rel=1e-3)
    macro = re.search(r"_CALIBRATED \{(.*)\}", files["differential_with_castor_calibrated.h"])
    assert macro is not None
    entries = dict(entry.strip().removeprefix(".").split(" = ") for entry in macro[1].split(","))
    assert {name: float(value) for name, value in entries.items()} == pytest.approx(layout.true, rel=1e-3)


def test_a_picture_has_each_estimate_in_the_middle_of_its_interval() -> None:
    """The change from nominal to scale: 5 % is half of 10 %, to the other side of a parameter that got smaller."""
    estimates = {"a": Estimate(1.1, 0.001, 1.0, True), "b": Estimate(1.9, 0.001, 2.0, True)}
    picture = ElementTree.fromstring(f"<svg>{''.join(_values(estimates))}</svg>")
    dots = [float(e.attrib["cx"]) for e in picture.iter("circle")]
    (axis, *intervals) = [(float(e.attrib["x1"]), float(e.attrib["x2"])) for e in picture.iter("line")]
    assert dots == pytest.approx([sum(ends) / 2 for ends in intervals], abs=0.1)
    assert dots[0] - axis[0] == pytest.approx(-2 * (dots[1] - axis[0]), abs=0.1)


@pytest.mark.parametrize("count", [2, 299, 300, 1000])
def test_curves_of_a_picture_fill_their_frames(count: int) -> None:
    """Errors from the corner at the left below to that at the right above, paths to one scale of both axes; no line of
    more than 600 points."""
    share = np.linspace(0, 1, count)
    d: Any = SimpleNamespace(
        t=5 + 2 * share, off=(0.3 * share,), true=(4 + 3j) * share, place=(4 + 3j) * share
    )
    for drawn, (left, top, right, bottom) in (
        (_errors([d], [d]), _ERRORS),
        (_paths([d], [d]), (_PATHS[0], _PATHS[3] - 240, _PATHS[0] + 320, _PATHS[3])),
    ):
        for curve in ElementTree.fromstring(f"<svg>{''.join(drawn)}</svg>").iter("polyline"):
            x, y = np.array([[*map(float, p.split(","))] for p in curve.attrib["points"].split()]).T
            assert len(x) <= 600 and (x[0], y[0]) == (left, bottom)
            assert x[-1] == pytest.approx(right, abs=2) and y[-1] == pytest.approx(top, abs=2)
            assert (x - left) / (right - left) == pytest.approx((bottom - y) / (bottom - top), abs=0.01)


def test_the_key_of_a_picture_has_a_dash_before_each_word() -> None:
    picture = ElementTree.fromstring(f"<svg>{''.join(_key())}</svg>")
    dashes = [[float(p.split(",")[0]) for p in e.attrib["points"].split()] for e in picture.iter("polyline")]
    words = [float(e.attrib["x"]) for e in picture.iter("text")]
    assert [b - a for a, b in dashes] == [30] * 3 and [
        w - b for (_, b), w in zip(dashes, words, strict=True)
    ] == [6] * 3


def test_a_tracker_that_glitches(tmp_path: Path) -> None:
    """One pose in a hundred is metres off: it moves no parameter, and no standard deviation by much."""
    layout = LAYOUTS["differential"]
    paths = written(tmp_path, layout, tracker=Tracker(noise=(0.001, 0.002)), encoders=Encoders(0.002))
    clean = calibrate(derivation_of(tmp_path, layout), paths, [])
    _truths(paths, lambda rows: rows + 5 * np.outer(np.arange(len(rows)) % 97 == 3, (0, 1, 0, 0)))
    result = calibrate(derivation_of(tmp_path, layout), paths, [])
    assert not result.unobservable
    for parameter, value in layout.true.items():
        estimate = result.parameters[parameter]
        assert abs(estimate.value - value) < 3 * estimate.sigma < 30 * clean.parameters[parameter].sigma


def test_counts_and_radius_are_told_as_one(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    """A radius of 2 % too much is an encoder of 2 % too few counts: both are said, and so are exchanged motors."""
    layout = LAYOUTS["differential_with_castor"]
    encoder = "encoder: {spin: {counts: 1000, gear: 2, bits: 32}}\n"
    (tmp_path / "robot.yaml").write_text(layout.text + encoder, encoding="utf-8")
    paths = written(tmp_path, layout, tracker=Tracker(0.04, turned=np.pi))
    for path in paths:
        header, rows = _rows(path.read_text(encoding="utf-8"))
        rows[:, 1:] *= 2000 / (2 * np.pi)
        path.write_text(_text(header.replace("angle", "counts"), rows), encoding="utf-8")
    outcome = wmrgen_cli("calibrate", str(tmp_path / "robot.yaml"), *map(str, paths), "--json")
    data = json.loads(outcome.out)
    counts = 2000 * 0.033 / layout.true["radius"]
    assert data["counts_per_turn"] == pytest.approx({"left.spin": counts, "right.spin": counts}, rel=1e-4)
    (note,) = (note for note in data["notes"] if "left and right are exchanged" in note)
    assert "turned by 180 deg" in note or "turned by -180 deg" in note


@pytest.mark.slow
def test_what_is_told_as_a_sum_is_written(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    """Neither half length nor half width is told, their sum is: with nominal ones new radii would be wrong."""
    folder = LOGS / "diff-square"
    text = (folder / "robot.yaml").read_text(encoding="utf-8")
    split = text.replace(
        "half_track: {value: 0.1,", "outer: {value: 0.05, tunable: true}\n  inner: {value: 0.05,"
    )
    split = split.replace("y: -half_track", "y: -outer - inner").replace("y: half_track", "y: outer + inner")
    (tmp_path / "robot.yaml").write_text(split, encoding="utf-8")
    logs = [str(folder / f"run-0{k}.csv") for k in (1, 2)]
    new = tmp_path / "new.yaml"
    outcome = wmrgen_cli("calibrate", str(tmp_path / "robot.yaml"), *logs, "--json", "-o", str(new))
    assert [set(group) for group in json.loads(outcome.out)["unobservable"]] == [{"outer", "inner"}]
    tuned = {p.name: float(p.nominal) for p in wmrgen.load(new).tunable}
    assert tuned["outer"] + tuned["inner"] == pytest.approx(0.10037, abs=4e-4)
