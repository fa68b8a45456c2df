"""Formulas that double with each part of the robot: they are derived, or refused in words."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Outcome
from tests.functions.common import PAIR
from tests.work import ends

TRAIN = PAIR.replace("name: pair", "name: train") + "functions: [trailer]\ntrailers:\n"


def written(folder: Path, trailers: int) -> Path:
    path = folder / "train.yaml"
    lines = (f"  - {{length: {0.5 + 0.05 * i:.2f}, hitch: 0.1}}\n" for i in range(trailers))
    path.write_text(TRAIN + "".join(lines), encoding="utf-8")
    return path


@pytest.mark.slow
def test_fourteen_trailers(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    """What is too long to be written out is said to be so, and stands in the code."""
    with ends():
        assert wmrgen_cli("derive", written(tmp_path, 14), "-o", tmp_path / "out").code == 0
    model = json.loads((tmp_path / "out" / "train" / "model.json").read_text(encoding="utf-8"))
    conditions = [d["condition"] for d in model["singular_models"]["trailer"]]
    assert len(conditions) == 14
    assert "trailer1_theta" in conditions[0] and conditions[-1].startswith("(too long to write out")


@pytest.mark.parametrize(
    "trailers", [2, 7, pytest.param(5, marks=pytest.mark.slow), pytest.param(6, marks=pytest.mark.slow)]
)
@pytest.mark.slow
def test_brackets_of_trailers(trailers: int, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    with ends():
        done = wmrgen_cli("structure", written(tmp_path, trailers), "--json")
    found = json.loads(done.out)
    if trailers <= 5:
        assert found["growth_vector"] == {2: [2, 3, 5], 5: [2, 3, 5, 8]}[trailers]
    else:
        assert found["growth_vector"] == [] and "too many terms" in found["brackets"]


@pytest.mark.slow
def test_a_model_of_motion_that_is_too_long_is_refused(
    tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """A following wheel whose velocity has hundreds of terms; what needs no model of motion is there."""
    path = tmp_path / "robot.yaml"
    path.write_text(
        "wmrgen: 1\nname: robot\nsnap: false\nparameters:\n"
        + "".join(f"  {n}: {{value: {v}, tunable: true}}\n" for n, v in (("a", 0.5), ("b", 0.55), ("c", 0.7)))
        + "wheels:\n"
        "  - {name: w0, type: steered, x: -1.18+sqrt(a**2+b**2), y: 0.17+sqrt(a**2+a**2), "
        "heading: a/2, r: 0.1, offset_y: a/4}\n"
        "  - {name: w1, type: steered, x: c/2, y: 0.1+sqrt(b**2+b**2), heading: 0-2*c, r: 0.1}\n"
        "  - {name: w2, type: steered, x: 0.41, y: b+b/4, heading: pi/3-2*b, r: 0.1}\n",
        encoding="utf-8",
    )
    with ends():
        assert wmrgen_cli("derive", path, "-o", tmp_path / "out").code == 0
        done = wmrgen_cli("eval", path, "posture")
    assert done.code == 3 and "the velocity of w" in done.err and "terms in the parameters" in done.err
