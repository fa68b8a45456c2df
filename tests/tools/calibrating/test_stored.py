"""Logs that are too large for memory: read one at a time, with the same results."""

from __future__ import annotations

import gc
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from tests.tools.calibrating.simulated import LAYOUTS, Encoders, Tracker, csv, drive
from tests.tools.calibrating.test_calibrate import derivation_of, written
from wmrgen.tools.calibrating.calibrate import _coarser, calibrate
from wmrgen.tools.calibrating.drawn import by_joint, by_time
from wmrgen.tools.calibrating.stored import Stored, changed

TRACKER = Tracker(0.04 - 0.07j, late=0.13, noise=(0.002, 0.003))
ENCODERS = Encoders(2 * np.pi / 400, slip=0.01, episodes=((7.0, 7.6, "fl", 1.8),))


@pytest.mark.slow
def test_results_are_those_of_drives_in_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """To the last bit, with slips left out and parts of drives."""
    layout = LAYOUTS["mecanum"]
    derivation = derivation_of(tmp_path, layout)
    logs = written(tmp_path, layout, tracker=TRACKER, encoders=ENCODERS)
    whole = calibrate(derivation, logs, [])
    monkeypatch.setattr("wmrgen.tools.calibrating.calibrate._LARGE", 0)
    in_turn = calibrate(derivation, logs, [])
    assert isinstance(in_turn.fit.problem.drives, Stored) and whole.outliers
    assert whole.clocks == pytest.approx({log.stem: TRACKER.late for log in logs}, abs=0.02)
    for name, value in (("_ENOUGH", 100), ("_COARSE", 1.0)):
        monkeypatch.setattr(f"wmrgen.tools.calibrating.calibrate.{name}", value)
    for fit in (whole.fit, in_turn.fit):  # what is changed stays where it is
        drives, coarser = fit.problem.drives, _coarser(fit.problem).drives
        assert type(changed(drives, lambda _, each: [each])) is type(coarser) is type(drives)
        assert sum(len(drive.t) for drive in coarser) < 0.1 * sum(len(drive.t) for drive in drives)
    for name in ("parameters", "unobservable", "before", "after", "held_out", "clocks"):
        assert getattr(in_turn, name) == getattr(whole, name)
    assert str(in_turn.outliers) == str(whole.outliers)  # nan among them
    assert by_time(in_turn.fit) == by_time(whole.fit)
    assert by_joint(derivation, in_turn.fit) == by_joint(derivation, whole.fit)


@pytest.mark.slow
def test_drives_are_not_held_in_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is held beside a result does not grow with the number of logs."""
    monkeypatch.setattr("wmrgen.tools.calibrating.calibrate._LARGE", 0)
    layout = LAYOUTS["differential"]
    derivation = derivation_of(tmp_path, layout)
    recorded = drive(layout, layout.drives[0], 40, 100, TRACKER, ENCODERS)
    log, truth = csv(recorded.log), csv({name: column[::10] for name, column in recorded.truth.items()})
    held = []
    for count in (2, 8):
        paths = [tmp_path / f"{count}-{k}.csv" for k in range(count)]
        for path in paths:
            path.write_text(log, encoding="utf-8")
            path.with_suffix(".truth.csv").write_text(truth, encoding="utf-8")
        tracemalloc.start()
        result = calibrate(derivation, paths, [])
        gc.collect()
        held.append(tracemalloc.get_traced_memory()[0])
        tracemalloc.stop()
        assert len(result.fit.problem.drives) == count
    assert held[1] < 1.5 * held[0]
