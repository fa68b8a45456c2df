"""Every function of a report names its equation, and least squares its condition on the rank."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import ROOT
from wmrgen.backends.registry import BACKENDS
from wmrgen.emit import facts
from wmrgen.functions.registry import declaration, names
from wmrgen.ir.kernels.choice import DEFAULT

TEXTS = ("Tzafestas", "Konstantinov", "Kelly", "Siegwart", "AA274", "ours")


def report(path: Path) -> str:
    d = wmrgen.derive(wmrgen.load(path))
    return str(BACKENDS["report"].load().emit(d, facts(d, DEFAULT, b""))["report.md"].decode())


def test_every_function_has_its_source() -> None:
    for name in names():
        assert any(text in declaration(name).source for text in TEXTS), name


def test_the_report_shows_it(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    text = (ROOT / "robots" / "unicycle.yaml").read_text(encoding="utf-8").split("functions:")[0]
    path.write_text(text + "functions: [motion, circle, goto_pose, icr]\n", encoding="utf-8")
    page = report(path)
    for part in re.split(r"^### ", page.split("## 11 ")[1].split("\n## ")[0], flags=re.M)[1:]:
        assert "In the texts: " in part and any(t in part for t in TEXTS)


@pytest.mark.parametrize(
    ("robot", "count", "condition"),
    [
        ("festo_robotino", "As many rows as unknowns", "full column rank 3 (Tzafestas (2.8a))"),
        ("kuka_youbot", "More rows than unknowns", "det(HᵀH) ≠ 0:"),
        ("ackermann_car", "", "Tzafestas (2.8a)"),
        ("nomad_xr4000", "", "Kelly Box 4.2"),
    ],
)
def test_the_condition_on_the_rank_is_said(robot: str, count: str, condition: str) -> None:
    page = report(ROOT / "robots" / f"{robot}.yaml")
    section = page.split("## 7 Forward kinematics")[1].split("\n## ")[0]
    assert count in section and condition in section
