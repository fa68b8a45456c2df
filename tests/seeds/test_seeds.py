"""Every seed case of kind deltas, and of kinds matrix, ik and fk with a layout, through the public interface.

Cases without a layout are not about a robot.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.oracle.harness import Model, robot_text
from tests.seeds import handlers, layouts

CASES: list[dict[str, Any]] = json.loads((Path(__file__).parent / "cases.json").read_text(encoding="utf-8"))[
    "cases"
]
KINDS = ("deltas", "matrix", "ik", "fk")
RUN = [c for c in CASES if c["kind"] in KINDS and c["layout"]]


def test_every_case_is_run() -> None:
    assert len(CASES) == 151 and len(RUN) == 70
    assert len({c["id"] for c in RUN}) == 70


@pytest.mark.parametrize("style", layouts.STYLES)
@pytest.mark.parametrize("case", RUN, ids=lambda c: c["id"])
def test_seed(case: dict[str, Any], style: str, tmp_path: Path) -> None:
    layout, steer = layouts.of(case, style)
    layout = handlers.ADAPT[case["id"]](layout) if case["id"] in handlers.ADAPT else layout
    model = Model.of(robot_text(layout, polar=style == "polar"), tmp_path)
    handlers.handler(case)(handlers.Seed(case, model, layout, steer))
