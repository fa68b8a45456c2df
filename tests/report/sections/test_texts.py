"""Every formula of a report names its equation; layouts are said to be in a text where they are, and nowhere else."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from tests.oracle.harness import robot_text
from tests.report.sections.common import FACTS, keyed_page_of
from tests.robots import ROBOTS, of_text
from tests.seeds import layouts
from wmrgen.functions.registry import declaration, names
from wmrgen.report.sections import emit
from wmrgen.report.sections.markdown import keys
from wmrgen.report.sections.mobility import integrability
from wmrgen.report.sections.texts import citations

TEXTS = ("Tzafestas", "Konstantinov", "Kelly", "Siegwart", "AA274", "ours")
SEEDS = Path(__file__).parents[3] / "textbook" / "cases.json"
CASES = {c["id"]: c for c in json.loads(SEEDS.read_text(encoding="utf-8"))["cases"]}
CITED = {
    "S-3.33": "Siegwart (3.32)-(3.34)",
    "S-3.29": "Siegwart (3.29), (3.30)",
    "K-5": "Konstantinov (5)",
    "K-4": "Konstantinov (3), (4)",
    "T-2.74b": "Tzafestas (2.73), (2.74)",
    "T-2.72-N5": "Tzafestas (2.72)",
    "T-2.84-xfwd": "Tzafestas (2.82), (2.84)",
    "T-2.37d": "Tzafestas (2.34)-(2.37), (2.41c)",
    "T-Ex2.2-b-IK": "Tzafestas Example 2.2",
    "T-2.28c": "Tzafestas (2.26)-(2.28)",
    "KE-4ws-HQ": "Kelly (4.62)",
    "KE-genbike-ik": "Kelly Box 4.2",
    "KE-ack-inv": "Kelly, Ackermann",
    "S-lockbike-phi": "Siegwart (3.39), 3.4.2",
    "S-xr4000-ik": "Siegwart (3.17), (3.18)",
}


def cited(layout: dict[str, Any]) -> set[str]:
    return {c.equation for c in citations(of_text(robot_text(layout, polar=True)).robot)}


@pytest.mark.parametrize("case", sorted(CITED))
def test_cited(case: str) -> None:
    layout, _ = layouts.of(CASES[case], "polar")
    assert CITED[case] in cited(layout)


@pytest.mark.parametrize("case", ["S-3.33", "S-3.29", "K-5", "T-2.74b", "T-2.84-xfwd", "T-2.37d", "T-2.28c"])
@pytest.mark.parametrize("key", ["x", "heading"])
def test_another_geometry_is_not(case: str, key: str) -> None:
    layout, _ = layouts.of(CASES[case], "polar")
    layout["wheels"][0][key] += 0.01
    assert CITED[case] not in cited(layout)


@pytest.mark.parametrize("case", ["S-3.33", "K-5", "K-4", "T-2.74b", "T-2.72-N5"])
def test_rollers_that_stand_aslant_alike_are_not(case: str) -> None:
    layout, _ = layouts.of(CASES[case], "polar")
    for wheel in layout["wheels"]:
        wheel["gamma"] = 0.4
    assert CITED[case] not in cited(layout)


@pytest.mark.parametrize(("case", "key"), [
    ("S-3.29", "integrability.none"), ("S-lockbike-phi", "integrability.whole"), ("S-3.33", None),
])  # fmt: skip
def test_frobenius_is_printed(case: str, key: str | None) -> None:
    layout, _ = layouts.of(CASES[case], "polar")
    page = " ".join(integrability(of_text(robot_text(layout, polar=True))))
    if key is None:
        assert page == ""
    else:
        assert keys(page) == [key]
        assert r"-\sin^2\chi - \cos^2\chi = -1" in page


def test_every_function_has_its_source() -> None:
    for name in names():
        assert any(text in declaration(name).source for text in TEXTS), name


def test_the_report_shows_it() -> None:
    text = ROBOTS["unicycle"].read_text(encoding="utf-8").split("functions:")[0]
    pages = emit(of_text(text + "functions: [motion, circle, goto_pose, icr]\n"), FACTS)
    page, numerics = (pages[name].decode() for name in ("report.md", "numerics.md"))
    assert "`motion`, `circle`, `goto_pose` and `icr`" in page.partition("**Files**")[2]
    parts = re.split(r"^### ", numerics.split("## Further functions")[1].split("\n## ")[0], flags=re.M)[1:]
    assert len(parts) == 4
    for part in parts:
        assert "Source: " in part and any(t in part for t in TEXTS)


@pytest.mark.parametrize(
    ("robot", "key", "condition"),
    [
        ("festo_robotino", "forward.square", "Tzafestas (2.7)"),
        ("kuka_youbot", "forward.overdetermined", "det(HᵀH) ≠ 0"),
        ("ackermann_car", "forward.always_regular", "Tzafestas (2.8a)"),
        ("nomad_xr4000", "forward.both_rows", "Kelly Box 4.2"),
    ],
)
def test_the_condition_on_the_rank_is_said(robot: str, key: str, condition: str) -> None:
    section = keyed_page_of(robot).split("## 7 Forward kinematics")[1].split("\n## ")[0]
    assert key in keys(section) and condition in section


AXLE = (
    "wmrgen: 1\nname: sample\nwheels:\n"
    "  - {name: l, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1EXTRA}\n"
    "  - {name: q, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1EXTRA}\n"
)
FRONT = "  - {name: f, type: steered, x: 0.5, y: 0, heading: 0, r: 0.1, actuated: [steer]}\n"
SHAFT = "couplings: [{equal: [l.spin, q.spin], ratios: [1, -1]}]\n"


@pytest.mark.parametrize(
    ("text", "there"),
    [
        (AXLE.replace("EXTRA", ""), True),
        (AXLE.replace("EXTRA", ", actuated: [], sensed: [spin]"), False),
        (AXLE.replace("EXTRA", ", sensed: []"), False),
        (AXLE.replace("EXTRA", "") + FRONT, True),
        (AXLE.replace("EXTRA", "") + FRONT + SHAFT, False),
    ],
)
def test_what_no_text_has_is_not_cited(text: str, there: bool) -> None:
    """An axle that nothing drives, or nothing measures; wheels on one shaft that turn the robot on the spot."""
    assert bool(citations(of_text(text).robot)) == there


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("", "", True),
        ("alpha: 2*pi/3,  heading: 0", "alpha: 3*pi/4,  heading: 0", True),
        ("  - equal: [w1.spin, w2.spin, w3.spin]\n", "", True),
        ("  - equal: [w1.steer, w2.steer, w3.steer]\n", "", False),  # it turns on the spot, too
        ("alpha: 2*pi/3,  heading: 0", "alpha: 2*pi/3,  heading: 1", False),
        ("alpha: 2*pi/3,  heading: 0, r: r", "alpha: 2*pi/3,  heading: 0, r: 2*r", False),
    ],
)
def test_a_synchro_drive_is_one_whose_wheels_steer_and_roll_alike(old: str, new: str, said: bool) -> None:
    """On whatever places: then it translates alone."""
    text = ROBOTS["synchro_drive"].read_text(encoding="utf-8")
    assert old in text
    derivation = of_text(text.replace(old, new, 1))
    assert ("Siegwart 3.3.3" in {c.equation for c in citations(derivation.robot)}) == said
    if said:
        assert derivation.mobility.robot_type == (1, 1) and derivation.mobility.dof == 2
