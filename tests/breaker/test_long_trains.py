"""Trains of trailers coupled off the axle, whose formulas double with each: an end within ten seconds."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Outcome

SECONDS = 10
PAIR = """\
wmrgen: 1
name: train
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
functions: [trailer]
trailers:
"""


def written(folder: Path, trailers: int) -> Path:
    path = folder / "train.yaml"
    lines = (f"  - {{length: {0.5 + 0.05 * i:.2f}, hitch: 0.1}}\n" for i in range(trailers))
    path.write_text(PAIR + "".join(lines), encoding="utf-8")
    return path


def test_fourteen_trailers(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    """What is too long to be written out is said to be so, and stands in the code."""
    begin = time.process_time()
    assert wmrgen_cli("derive", written(tmp_path, 14), "-o", tmp_path / "out").code == 0
    assert time.process_time() - begin < SECONDS
    model = json.loads((tmp_path / "out" / "train" / "model.json").read_text(encoding="utf-8"))
    conditions = [d["condition"] for d in model["singular_models"]["trailer"]]
    assert len(conditions) == 14
    assert "trailer1_theta" in conditions[0] and conditions[-1].startswith("(too long to write out")


@pytest.mark.parametrize(
    "trailers", [2, 7, pytest.param(5, marks=pytest.mark.slow), pytest.param(6, marks=pytest.mark.slow)]
)
def test_brackets_of_trailers(trailers: int, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    begin = time.process_time()
    done = wmrgen_cli("structure", written(tmp_path, trailers), "--json")
    assert time.process_time() - begin < SECONDS
    found = json.loads(done.out)
    if trailers <= 5:
        assert found["growth_vector"] == {2: [2, 3, 5], 5: [2, 3, 5, 8]}[trailers]
    else:
        assert found["growth_vector"] == [] and "too many terms" in found["brackets"]
