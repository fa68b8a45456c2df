"""Models of the gallery and of random layouts, and the admissible motions that laws are stated on."""

from __future__ import annotations

import json
import os
import tempfile
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import HealthCheck, settings
from numpy.typing import NDArray

from tests import conftest
from tests.depth import examples as drawn
from tests.oracle import oracle, robot_file
from tests.oracle.harness import Model, named, robot_text, twist_of

Array = NDArray[np.float64]
Layout = dict[str, Any]
EXPLORE = int(
    os.environ.get("WMRGEN_EXPLORE", "0")
)  # how many times as many random layouts, new ones each time
ROBOTS = sorted((Path(__file__).parents[2] / "robots").glob("*.yaml"))
NAMES = [p.stem for p in ROBOTS]


def law(examples: int) -> settings:
    """Settings of a law on random layouts: the same layouts in every run, unless WMRGEN_EXPLORE asks for more."""
    return settings(
        derandomize=not EXPLORE, database=None, max_examples=drawn(examples) * max(EXPLORE, 1),
        suppress_health_check=[HealthCheck.too_slow],
    )  # fmt: skip


@cache
def gallery(name: str) -> tuple[Model, Layout]:
    """A gallery robot's model and the oracle's own reading of its file."""
    path = next(p for p in ROBOTS if p.stem == name)
    return Model(path), robot_file.read(path)


@lru_cache(maxsize=4)
def _derived(text: str) -> Model:
    with tempfile.TemporaryDirectory() as folder:
        return Model.of(text, Path(folder))


def derived(layout: Layout, polar: bool = False, extra: str = "") -> Model:
    """The model of a random layout; polar ones unsnapped, as any decimal alpha may lie near a multiple of pi/12."""
    return _derived(robot_text(layout, polar=polar, extra=f"snap: false\n{extra}" if polar else extra))


def turning(layout: Layout) -> list[str]:
    return [w["name"] for w in layout["wheels"] if w["type"] in ("steered", "castor")]


def admissible(layout: Layout, weights: Array) -> Array:
    """A twist that every wheel can follow: in null(C1f), and pure translation where couplings demand it."""
    basis = oracle.null(oracle.sliding_rows(layout, "fixed", {}))
    if oracle.admissible_steering(layout) is not None and not _agrees(
        layout, basis @ weights[: basis.shape[1]]
    ):
        basis = basis @ oracle.null(np.array([[0.0, 0.0, 1.0]]) @ basis)
    return np.asarray(basis @ weights[: basis.shape[1]])


def _agrees(layout: Layout, twist: Array) -> bool:
    """True when coupled wheels want the same steering angle."""
    angle = {w["name"]: oracle.steering(w, twist, 0.0) for w in layout["wheels"] if w["type"] == "steered"}
    groups = [names for joint, names in layout["couplings"] if joint == "steer"]
    return all(abs(np.sin(angle[n] - angle[g[0]])) < 1e-9 for g in groups for n in g)


def coupled(layout: Layout, present: dict[str, float]) -> dict[str, float]:
    """Coupled wheels stand alike."""
    for joint, names in layout["couplings"]:
        if joint == "steer":
            present = present | {f"{n}.steer": present[f"{names[0]}.steer"] for n in names}
    return present


def sensed(model: Model, joints: dict[str, float]) -> dict[str, float]:
    """The joints that ``forward`` has as inputs; a joint nobody commands rests."""
    tunable = {p.name for p in model.robot.tunable}
    return {n: joints.get(n, 0.0) for n in model.ports("forward")[0] if n not in tunable}


def drive(
    model: Model, layout: Layout, twist: Array, present: dict[str, float]
) -> tuple[dict[str, float], Array, float]:
    """Joint commands of a twist, and what forward kinematics makes of them: (joints, twist, slip)."""
    joints = model.call(
        "inverse", named(twist) | {k: v for k, v in present.items() if k in model.ports("inverse")[0]}
    )
    state = present | {k: v for k, v in joints.items() if k != "slip"}
    back = model.call("forward", sensed(model, state))
    return joints, twist_of(back), back["slip"]


def command_line(
    path: Path, function: str, cases: list[dict[str, float]], backend: str, folder: Path
) -> list[dict[str, float]]:
    """``wmrgen eval --cases`` in this process."""
    file = folder / "cases.json"
    file.write_text(json.dumps(cases), encoding="utf-8")
    result = conftest.command_line("eval", path, function, "--cases", file, "--backend", backend)
    assert result.code == 0, result.err
    found: list[dict[str, float]] = json.loads(result.out)
    return found
