"""A Dask cluster gives what one process gives."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from distributed import Client, LocalCluster

from tests.conftest import Outcome
from tests.tools.calibrating.simulated import LAYOUTS, Encoders, Tracker
from tests.tools.calibrating.test_calibrate import derivation_of, written
from wmrgen.tools.calibrating.calibrate import calibrate
from wmrgen.tools.calibrating.cluster import cluster

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as local:
        yield local.scheduler_address


@pytest.mark.parametrize("name", ["differential", "swerve"])
def test_equal_to_one_process(tmp_path: Path, address: str, name: str) -> None:
    layout = LAYOUTS[name]
    derivation = derivation_of(tmp_path, layout)
    tracker = Tracker(0.03, noise=(0.002, 0.003))
    paths = written(tmp_path, layout, tracker=tracker, encoders=Encoders(0.01, slip=0.01))
    alone = calibrate(derivation, paths, [])
    with cluster(address) as each:
        together = calibrate(derivation, paths, [], each)
    for parameter, estimate in alone.parameters.items():
        other = together.parameters[parameter]
        assert other.value == pytest.approx(estimate.value, rel=1e-12)
        assert other.sigma == pytest.approx(estimate.sigma, rel=1e-9)
        assert other.observable == estimate.observable


def test_the_command(tmp_path: Path, address: str, wmrgen_cli: Callable[..., Outcome]) -> None:
    layout = LAYOUTS["differential"]
    (tmp_path / "robot.yaml").write_text(layout.text, encoding="utf-8")
    paths = [str(path) for path in written(tmp_path, layout)]
    alone = wmrgen_cli("calibrate", str(tmp_path / "robot.yaml"), *paths)
    together = wmrgen_cli("calibrate", str(tmp_path / "robot.yaml"), *paths, "--scheduler", address)
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
    paths = [str(path) for path in written(tmp_path, layout)]
    refused = wmrgen_cli(
        "calibrate", str(tmp_path / "robot.yaml"), *paths, "--scheduler", "tcp://127.0.0.1:9"
    )
    assert refused.code == 4 and "no Dask scheduler answers" in refused.err
