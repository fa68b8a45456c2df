"""Wheels that count more or less in `forward`: against numpy's lstsq of rows times the roots of their weights."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.conftest import ROOT
from tests.oracle import oracle, weighted
from tests.oracle.agreement import refused
from tests.oracle.compare import evaluated
from tests.oracle.draw import robot
from tests.oracle.harness import Model, robot_text
from tests.oracle.weighted import LAYOUTS, WEIGHTS
from tests.robots import of_text
from wmrgen import load
from wmrgen.analysis.kinematics.forward import forward
from wmrgen.errors import RobotFileError
from wmrgen.geometry.exact.number import Exact


def _compare(layout: dict[str, Any], model: Model, seed: str) -> None:
    rng = random.Random(seed)
    for _ in range(3):
        sensed = {name: rng.uniform(-2, 2) for name in model.ports("forward")[0]}
        rows = np.vstack([oracle.measured_rows(layout, sensed)[0], np.zeros((1, 3))])
        sizes = np.linalg.svd(rows, compute_uv=False)
        if any(1e-9 < s / max(sizes[0], 1e-9) < 0.05 for s in sizes):
            continue  # near a lost rank, which is taken for one
        twist, slip = weighted.forward(layout, sensed)
        for backend, result in evaluated(model, "forward", sensed).items():
            values = [result[k] for k in ("vx", "vy", "omega", "slip")]
            assert values == pytest.approx([*twist, slip], rel=1e-8, abs=1e-8), backend


@pytest.mark.parametrize("name", LAYOUTS)
def test_weighted_least_squares(name: str, tmp_path: Path) -> None:
    layout = LAYOUTS[name]
    _compare(layout, Model.of(robot_text(layout), tmp_path), name)


DRAWN = [("none", seed) for seed in range(12)] + [
    (k, s) for k in ("steer", "fixed spin", "mixed") for s in (0, 1)
]


@pytest.mark.parametrize(("kind", "seed"), DRAWN)
def test_random_robots_with_weights(kind: str, seed: int, tmp_path: Path) -> None:
    layout = robot(seed, kind)
    rng = random.Random(seed)
    for w in layout["wheels"]:
        w["weight"] = rng.choice(WEIGHTS[:4])
    if not refused(layout):
        _compare(layout, Model.of(robot_text(layout), tmp_path), f"{kind} {seed}")


def test_tunable_geometry_is_weighted_step_by_step(tmp_path: Path) -> None:
    """Sums of tunable lengths are not written out; the weights stand in them all the same."""
    rows = [("a", "p + q + s", "0.2"), ("b", "p - q", "s - 0.3"), ("c", "-p - s", "0.1 + q")]
    text = "wmrgen: 1\nname: tuned\nparameters:\n" + "".join(
        f"  {n}: {{value: {v}, tunable: true}}\n" for n, v in (("p", 0.3), ("q", 0.07), ("s", 0.11))
    )
    text += "wheels:\n" + "".join(
        f"  - {{name: {n}, type: steered, x: {x}, y: {y}, heading: 0, r: 0.05, weight: {w}}}\n"
        for (n, x, y), w in zip(rows, WEIGHTS, strict=False)
    )
    places = ((0.48, 0.2), (0.23, -0.19), (-0.41, 0.17))
    layout = weighted.layout(*({"type": "steered", "x": x, "y": y} for x, y in places))
    for w, (name, _, _) in zip(layout["wheels"], rows, strict=True):
        w["name"] = name
    model = Model.of(text, tmp_path)
    sensed = {name: 0.3 + 0.2 * i for i, name in enumerate(n for n in model.ports("forward")[0] if "." in n)}
    twist, slip = weighted.forward(layout, sensed)
    result = model.call("forward", sensed)
    assert [result[k] for k in ("vx", "vy", "omega", "slip")] == pytest.approx([*twist, slip], rel=1e-9)


@pytest.mark.parametrize("name", ["pioneer3dx", "wpilib_swervebot", "nomad_xr4000", "jpl_osr"])
def test_equal_weights_change_nothing(name: str) -> None:
    plain = load(ROOT / "robots" / f"{name}.yaml")
    weighted = replace(plain, wheels=tuple(replace(w, weight=Exact(5)) for w in plain.wheels))
    assert forward(weighted) == forward(plain)


@pytest.mark.parametrize(
    ("weight", "code"),
    [("0", "WMR109"), ("-1", "WMR109"), ("1e-4", "WMR109"), ("2000", "WMR109"), ("p", "WMR109"), ("nan", "WMR104")],
)  # fmt: skip
def test_weights_that_make_no_sense(weight: str, code: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(
        "wmrgen: 1\nname: robot\nparameters: {p: {value: 1, tunable: true}}\nwheels:\n"
        f"  - {{name: a, type: fixed, x: 0, y: 1, heading: 0, r: 0.1, weight: {weight}}}\n"
    )
    with pytest.raises(RobotFileError) as caught:
        load(path)
    mark = caught.value.mark
    assert caught.value.code == code and weight in caught.value.what
    assert mark is not None and mark.line == 5 and mark.text[mark.column - 1 :].startswith(weight)


def test_a_weight_may_be_an_expression(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(
        "wmrgen: 1\nname: robot\nparameters: {ratio: 3}\nwheels:\n"
        "  - {name: a, type: fixed, x: 0, y: 1, heading: 0, r: 0.1, weight: 1/ratio**2}\n"
        "  - {name: b, type: fixed, x: 0, y: -1, heading: 0, r: 0.1, weight: 1000}\n"
    )
    assert [w.weight for w in load(path).wheels] == [Exact(1) / 9, Exact(1000)]


@pytest.mark.parametrize(("count", "shared"), [(4, 0), (5, 3)])
def test_a_residual_of_one_relation_is_that_relation(count: int, shared: int) -> None:
    """Those of several take the fitted twist: fewer operations than sums of all spins."""
    wheels = "".join(
        f"  - {{name: w{k}, type: swedish, l: 0.3, alpha: {k}*2*pi/{count}, beta: 0, gamma: 0, r: 0.1}}\n"
        for k in range(count)
    )
    d = of_text(f"wmrgen: 1\nname: ring\nwheels:\n{wheels}")
    assert len(d.formula("forward").locals) == shared
