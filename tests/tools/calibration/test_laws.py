"""The result of a calibration does not depend on what carries no information."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.tools.calibration.drives import change_rows, derived, written
from tests.tools.calibration.simulated import LAYOUTS, Encoders, Reals, Tracker
from wmrgen.tools.calibration.calibrate import Calibration, calibrate

LAYOUT = LAYOUTS["differential"]
SMALL = 0.02  # standard deviations: the solver stops where a step changes the cost by 1e-6


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    tracker = Tracker(0.03 - 0.02j, late=0.1, noise=(0.002, 0.003))
    encoders = Encoders(2 * np.pi / 400, slip=0.01)
    folder = tmp_path_factory.mktemp("logs")
    return written(folder, LAYOUT, seconds=20, rate=10, tracker=tracker, encoders=encoders)


@pytest.fixture(scope="module")
def plain(logs: list[Path]) -> Calibration:
    return calibrate(derived(LAYOUT.text), logs)


def check_same(one: Calibration, other: Calibration, most: float = SMALL) -> None:
    """Check that values agree to a part of their deviations, and the deviations to a hundredth."""
    assert one.unobservable == other.unobservable
    for estimates, others in ((one.parameters, other.parameters), (one.mount, other.mount)):
        for (name, a), b in zip(estimates.items(), others.values(), strict=True):
            assert a.sigma is not None and b.sigma is not None
            assert abs(a.value - b.value) < most * a.sigma, name
            assert b.sigma == pytest.approx(a.sigma, rel=0.01), name
    for a, b in zip((one.before, one.after), (other.before, other.after), strict=True):
        assert (b.position, b.heading) == pytest.approx((a.position, a.heading), rel=1e-3)
    assert one.verdict is not None and other.verdict is not None
    assert other.verdict.held_out.position == pytest.approx(one.verdict.held_out.position, rel=0.01)


def copies(
    folder: Path,
    logs: list[Path],
    poses: Callable[[Reals], Reals],
    readings: Callable[[Reals], Reals] = np.array,
) -> list[Path]:
    """Write changed copies of logs and of their reference poses."""
    paths = []
    for log in logs:
        path = folder / log.name
        for old, new, change in (
            (log, path, readings),
            (log.with_suffix(".truth.csv"), path.with_suffix(".truth.csv"), poses),
        ):
            new.write_bytes(old.read_bytes())
            change_rows(new, change)
        paths.append(path)
    return paths


def test_the_order_of_logs(logs: list[Path], plain: Calibration) -> None:
    other = calibrate(derived(LAYOUT.text), logs[::-1])
    check_same(plain, other, 1e-6)
    for name, clock in plain.clocks.items():
        assert other.clocks[name].value == pytest.approx(clock.value, abs=1e-6)


def test_one_log_twice_is_no_news(logs: list[Path], plain: Calibration) -> None:
    """A copy moves no value by much, and a deviation falls at most as by one more drive like it."""
    other = calibrate(
        derived(LAYOUT.text), [*logs, *logs], [log.with_suffix(".truth.csv") for log in (*logs, *logs)]
    )
    for name, estimate in plain.parameters.items():
        twice = other.parameters[name]
        assert estimate.sigma is not None and twice.sigma is not None
        assert abs(twice.value - estimate.value) < 0.1 * estimate.sigma
        assert twice.sigma > 0.65 * estimate.sigma


@pytest.mark.parametrize(("turn", "shift"), [(0.0, 5 - 3j), (np.pi / 2, 0j), (-np.pi, 100 + 20j)])
def test_the_frame_of_the_world(
    tmp_path: Path, logs: list[Path], plain: Calibration, turn: float, shift: complex
) -> None:
    def moved(rows: Reals) -> Reals:
        place = shift + np.exp(1j * turn) * (rows[:, 1] + 1j * rows[:, 2])
        return np.column_stack([rows[:, 0], place.real, place.imag, rows[:, 3] + turn])

    check_same(plain, calibrate(derived(LAYOUT.text), copies(tmp_path, logs, moved)))


@pytest.mark.parametrize("later", [-7.0, 1.0e6])
def test_a_common_shift_of_times(tmp_path: Path, logs: list[Path], plain: Calibration, later: float) -> None:
    def shifted(rows: Reals) -> Reals:
        return rows + later * (np.arange(rows.shape[1]) == 0)

    check_same(plain, calibrate(derived(LAYOUT.text), copies(tmp_path, logs, shifted, shifted)))


def test_names(tmp_path: Path, logs: list[Path], plain: Calibration) -> None:
    """Other names of wheels and parameters, in another alphabetic order."""
    names = {"left": "zz", "right": "aa", "r_zz": "q_two", "r_aa": "q_one", "half_track": "b"}
    text = LAYOUT.text
    for old, new in names.items():
        text = text.replace(old, new)
    paths = copies(tmp_path, logs, np.array)
    for path in paths:
        path.write_text(path.read_text(encoding="utf-8").replace("left.", "zz.").replace("right.", "aa."))
    other = calibrate(derived(text), paths)
    check_same(plain, other, 1e-6)
    assert list(other.parameters) == ["q_two", "q_one", "b"]
    assert other.covariance == pytest.approx(plain.covariance, rel=1e-6)
