"""The cases without a layout of their own kind, and that every case of cases.json is run somewhere."""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.oracle.harness import Model, robot_text
from tests.seeds import layouts
from tests.seeds.test_seeds import CASES, RUN
from textbook.index.table import ROWS as TABLE

BY_ID = {c["id"]: c for c in CASES}
HERE = Path(__file__).parents[1]


def model(case: dict[str, Any], folder: Path) -> Model:
    return Model.of(robot_text(layouts.of(case, "polar")[0], polar=True), folder)


def test_ke_ack_fwd(tmp_path: Path) -> None:
    """Kelly, Ackermann forward: a front wheel with velocity v_f at L tells vx and omega."""
    case = BY_ID["KE-ack-fwd"]
    (a, b), length = case["given"]["v_f"], case["given"]["L"]
    found = Model.of(
        "wmrgen: 1\nname: car\nwheels:\n"
        "  - {name: rear, type: fixed, x: 0, y: 0, heading: 0, r: 0.1, actuated: []}\n"
        f"  - {{name: front, type: steered, x: {length}, y: 0, heading: 0, r: 0.1}}\n",
        tmp_path,
    ).call("forward", {"front.spin": math.hypot(a, b) / 0.1, "front.steer": math.atan2(b, a)})
    assert found["vx"] == pytest.approx(case["expect"]["v_x"], abs=case["tol"])
    assert found["omega"] == pytest.approx(case["expect"]["omega"], abs=case["tol"])
    assert found["slip"] == pytest.approx(0, abs=case["tol"])


def test_s_3_22_y(tmp_path: Path) -> None:
    """Siegwart (3.22): a sphere under motion along y; beta = direction + pi/2 - alpha modulo pi."""
    case = BY_ID["S-3.22-y"]
    vx, vy, omega = case["given"]["twist_body"]
    found = model(case, tmp_path).call("contacts", {"vx": vx, "vy": vy, "omega": omega})["b.direction"]
    beta = (found + math.pi / 2 - case["given"]["alpha"]) % math.pi
    assert beta == pytest.approx(case["expect"]["beta_mod_pi"], abs=case["tol"])


def test_s_3_44(tmp_path: Path) -> None:
    """Siegwart (3.44), as the case gives it, is the engine's rolling row times -1, for any wheel."""
    case = BY_ID["S-3.44"]
    assert case["expect"]["holds"]
    rng = random.Random(44)
    a, b, l, r = (rng.uniform(0.1, 1.0) for _ in range(4))
    vx, vy, w, f = (rng.uniform(-1.0, 1.0) for _ in range(4))
    engine = Model.of(
        f"wmrgen: 1\nname: one\nwheels:\n  - {{name: w, type: fixed, l: {l}, alpha: {a}, beta: {b}, r: {r}}}\n",
        tmp_path,
    )
    j1, j2 = engine.matrix("J1")[0], engine.matrix("J2")[0, 0]
    values = dict(zip(case["given"]["symbols"], (a, b, l, vx, vy, w, r, f), strict=True))
    for side in ("lhs", "rhs"):
        printed = eval(case["given"][side], {"sin": math.sin, "cos": math.cos}, values)
        assert printed == pytest.approx(-(j1 @ [vx, vy, w] - j2 * f), abs=case["tol"])


def test_t_2_81_printed_singular(tmp_path: Path) -> None:
    """Tzafestas (2.81) as printed with d1 = d2: the rank of the inverse is 2, and it is reported."""
    case = BY_ID["T-2.81-printed-singular"]
    engine = model(case, tmp_path)
    assert np.linalg.matrix_rank(engine.matrix("J1"), tol=1e-9) == case["expect"]["rank_IK"]
    mobility = engine.derivation.mobility
    assert any(balance.lacking == 1 for balance in mobility.actuation)
    assert any(f.kind == "rolling_rank" and "rank 2" in f.meaning for f in mobility.singularities)


# Run by a rule over the start of their names.
BY_START = {"S-3.6": "functions/control/test_polar.py", "S-F3.20": "functions/control/test_polar.py"}


def test_every_case_is_run_somewhere() -> None:
    """Each id is in a test module that runs it, in the list of test_seeds, or in the table of places in the texts."""
    folders = (HERE, HERE.parent / "textbook" / "tests")
    modules = [p for f in folders for p in sorted(f.rglob("*.py")) if p.parent.name != "report"]
    text = "\n".join(p.read_text(encoding="utf-8") for p in modules)
    for start, module in BY_START.items():
        assert f'n.startswith("{start}")' in (HERE / module).read_text(encoding="utf-8")
    run = {c["id"] for c in CASES if c in RUN or c["id"].startswith(tuple(BY_START))}
    run |= {row.case for row in TABLE}
    assert not [c["id"] for c in CASES if c["id"] not in run and f'"{c["id"]}"' not in text]
