"""Every seed case of kind deltas, and of kinds matrix, ik and fk with a layout, through the public interface.

Cases without a layout are not about a robot. Cases of a function that the texts write out as their equation are run
there, exactly, in CasADi and in C, and not here as well.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import ROOT
from tests.oracle.harness import Model, robot_text
from tests.seeds import handlers, layouts

FILE = ROOT / "textbook" / "cases.json"
CASES: list[dict[str, Any]] = json.loads(FILE.read_text(encoding="utf-8"))["cases"]
KINDS = ("deltas", "matrix", "ik", "fk")
ELSEWHERE = {
    "functions/models/test_seeds.py": (
        "T-2.28c T-Ex2.2-b-IK T-Ex2.2-b-M T-Ex2.2-slip-J T-2.46 T-2.51b T-2.55 T-2.56a A-disk-M"
    ).split(),
    "functions/motion/test_seeds.py": (
        "T-2.37d T-2.41c T-2.36 T-2.75 T-2.75-ik T-2.84-2.85 S-2.3.2.2-diag K-4 K-4-detail K-5 KE-4ws-HQ KE-4ws-vc "
        "S-3.33-world"
    ).split(),
}
_THERE = {name for names in ELSEWHERE.values() for name in names}
RUN = [c for c in CASES if c["kind"] in KINDS and c["layout"] and c["id"] not in _THERE]


def test_every_case_is_run() -> None:
    assert len(CASES) == 151 and len(RUN) == 48
    assert len({c["id"] for c in RUN} | _THERE) == 70
    for module, names in ELSEWHERE.items():
        text = (Path(__file__).parents[1] / module).read_text(encoding="utf-8")
        assert not [name for name in names if f'"{name}"' not in text]


@pytest.mark.parametrize("style", layouts.STYLES)
@pytest.mark.parametrize("case", RUN, ids=lambda c: c["id"])
def test_seed(case: dict[str, Any], style: str, tmp_path: Path) -> None:
    layout, steer = layouts.of(case, style)
    layout = handlers.ADAPT[case["id"]](layout) if case["id"] in handlers.ADAPT else layout
    model = Model.of(robot_text(layout, polar=style == "polar"), tmp_path)
    handlers.handler(case)(handlers.Seed(case, model, layout, steer))
