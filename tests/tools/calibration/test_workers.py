"""Logs read in one process, in a pool of processes and on a Dask cluster give equal results."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from distributed import Client, LocalCluster

from tests.conftest import Outcome
from tests.tools.calibration.drives import derived, written
from tests.tools.calibration.simulated import LAYOUTS, Encoders, Tracker
from wmrgen.tools.calibration.calibrate import Calibration, calibrate
from wmrgen.tools.workers import cluster, pool, serial

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as local:
        yield local.scheduler_address


def check_equal(one: Calibration, other: Calibration) -> None:
    assert one.parameters == other.parameters and one.unobservable == other.unobservable
    assert one.mount == other.mount and one.clocks == other.clocks
    np.testing.assert_allclose(one.covariance, other.covariance, rtol=1e-12)


@pytest.mark.parametrize("name", ["differential", "swerve"])
def test_results_are_equal(tmp_path: Path, address: str, name: str) -> None:
    """The requirement is 1e-12; results are equal to the last bit."""
    tracker = Tracker(0.03, noise=(0.002, 0.003))
    layout = LAYOUTS[name]
    paths = written(tmp_path, layout, rate=10, tracker=tracker, encoders=Encoders(0.01, slip=0.01))
    alone = calibrate(derived(layout.text), paths, mapped=serial)
    with cluster(address) as mapped:
        check_equal(alone, calibrate(derived(layout.text), paths, mapped=mapped))
    with pool(2) as mapped:
        check_equal(alone, calibrate(derived(layout.text), paths, mapped=mapped))


def test_the_command(tmp_path: Path, address: str, wmrgen_cli: Callable[..., Outcome]) -> None:
    layout = LAYOUTS["differential"]
    (tmp_path / "robot.yaml").write_text(layout.text, encoding="utf-8")
    paths = written(tmp_path, layout, rate=10)
    alone = wmrgen_cli("calibrate", tmp_path / "robot.yaml", *paths)
    assert alone.code == 0
    for more in (("--scheduler", address), ("--workers", "2")):
        together = wmrgen_cli("calibrate", tmp_path / "robot.yaml", *paths, *more)
        assert together.code == 0 and together.out == alone.out


def test_no_scheduler(
    tmp_path: Path, wmrgen_cli: Callable[..., Outcome], monkeypatch: pytest.MonkeyPatch
) -> None:
    def impatient(address: str, timeout: str, **rest: Any) -> Client:
        assert timeout == "10s"
        return Client(address, timeout="0.5s", **rest)

    monkeypatch.setattr("distributed.Client", impatient)
    layout = LAYOUTS["differential"]
    (tmp_path / "robot.yaml").write_text(layout.text, encoding="utf-8")
    paths = written(tmp_path, layout, seconds=10)
    refused = wmrgen_cli("calibrate", tmp_path / "robot.yaml", *paths, "--scheduler", "tcp://127.0.0.1:9")
    assert refused.code == 4 and "tcp://127.0.0.1:9" in refused.err
