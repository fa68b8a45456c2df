"""Parameters that are computed from a tunable one: they follow it in every back end."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import Outcome
from tests.depth import everyday
from wmrgen.errors import RobotFileError

PAIR = """\
wmrgen: 1
name: pair
parameters:
{0}wheels:
  - {{name: left,  type: fixed, x: 0, y: half, heading: 0, r: 0.1}}
  - {{name: right, type: fixed, x: 0, y: -half, heading: 0, r: 0.1}}
"""
MECANUM = """\
wmrgen: 1
name: four
parameters:
{0}functions: [accelerations]
wheels:
  - {{name: a, type: swedish, x: 0.3, y: half, heading: turned, gamma: 45 deg, r: 0.1}}
  - {{name: b, type: swedish, x: 0.3, y: -half, heading: 0, gamma: -45 deg, r: 0.1}}
  - {{name: c, type: swedish, x: -0.3, y: half, heading: 0, gamma: -45 deg, r: 0.1}}
  - {{name: e, type: steered, x: -0.3, y: -half, heading: 0, r: radius}}
"""
COMPUTED = """\
  quarter: half/2
  half: sqrt(track**2)/2
  track: {value: 0.4, tunable: true}
  turned: quarter_turn/3
  quarter_turn: atan2(half, quarter*2)
  radius: 0.1*half/quarter
"""


def plain(value: str) -> str:
    return COMPUTED.replace("{value: 0.4, tunable: true}", value)


def written(folder: Path, text: str) -> Path:
    path = folder / "robot.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("layout", everyday([PAIR, MECANUM], [PAIR]), ids=["pair", "four"])
def test_a_tunable_parameter_has_the_results_of_a_number(
    layout: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """All backends at track = 0.7, through chains, roots and angles, against the file with 0.7 in it."""
    functions = ["inverse", "forward"] + (["accelerations"] if layout is MECANUM else [])
    for function in functions:
        fixed = written(tmp_path, layout.format(plain("0.7")))
        inputs = [p.name for p in wmrgen.derive(wmrgen.load(fixed)).formula(function).inputs]
        values = [f"{name}={0.25 + 0.125 * k}" for k, name in enumerate(inputs)]
        wanted = json.loads(wmrgen_cli("eval", fixed, function, *values, "--json").out)
        tunable = written(tmp_path, layout.format(COMPUTED))
        for backend in ("exact", "casadi", "c"):
            done = wmrgen_cli("eval", tunable, function, *values, "track=0.7", "--backend", backend, "--json")
            found = json.loads(done.out)
            assert found == pytest.approx(wanted, rel=2e-6, abs=2e-6), (function, backend)
        numbers = {name.replace(".", "_"): float(v) for name, v in (item.split("=") for item in values)}
        found = getattr(wmrgen.derive(wmrgen.load(tunable)).numpy(), function)(**numbers, track=0.7)
        assert {k: float(v) for k, v in found.items()} == pytest.approx(wanted, rel=1e-9, abs=1e-9)


def test_the_report_says_what_is_computed(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    file = written(tmp_path, PAIR.format("  track: {value: 0.4, tunable: true}\n  half: track/2\n"))
    assert wmrgen_cli("derive", file, "-o", tmp_path / "out").code == 0
    report = (tmp_path / "out" / "pair" / "report.md").read_text(encoding="utf-8")
    assert "`half` = 0.2, computed from the tunable `track`." in report


@pytest.mark.parametrize(
    ("more", "limits", "named", "line"),
    [
        ("  b: {value: half, tunable: true}\n", "", {"b", "track"}, 6),
        ("", "limits: {omega: 2*half}\n", {"omega", "half", "track"}, 9),
    ],
)
def test_what_cannot_follow_is_refused(
    more: str, limits: str, named: set[str], line: int, tmp_path: Path
) -> None:
    top = "  track: {value: 0.4, tunable: true}\n  half: track/2\n" + more
    with pytest.raises(RobotFileError) as caught:
        wmrgen.load(written(tmp_path, PAIR.format(top) + limits))
    error = caught.value
    assert error.code == "WMR109" and error.mark and error.mark.line == line
    assert named <= {*re.findall(r"\w+", error.what)}
