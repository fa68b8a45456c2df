"""Figures of merit of designs against closed forms, and sweeps."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from distributed import LocalCluster

from tests.conftest import ROOT, command_line
from tests.report.figures.words import mistakes
from wmrgen.tools.designs.figures import _COUNTED

pytestmark = pytest.mark.slow

ROBOTS = ROOT / "robots"
PAIR = """\
wmrgen: 1
name: pair
parameters: {half: 0.2, r: {value: 0.05, tunable: true}}
noise: {spin: {proportional: 0.01}}
limits: {spin: 10}
wheels:
  - {name: left,  type: fixed, x: 0, y: half,  heading: 0, r: r}
  - {name: right, type: fixed, x: 0, y: -half, heading: 0, r: r}
"""
CART = """\
wmrgen: 1
name: cart
cg: {x: 0, y: 0, z: 0.5}
wheels:
  - {name: a, type: steered, x: 0.4,  y: 0.3,  heading: 0, r: 0.1}
  - {name: b, type: steered, x: 0.4,  y: -0.3, heading: 0, r: 0.1}
  - {name: c, type: steered, x: -0.4, y: 0.3,  heading: 0, r: 0.1}
  - {name: d, type: steered, x: -0.4, y: -0.3, heading: 0, r: 0.1}
"""


def run(*words: object, code: int = 0) -> Any:
    done = command_line("designs", *words, "--json")
    assert done.code == code, done.err
    return json.loads(done.out)


@pytest.fixture
def pair(tmp_path: Path) -> Path:
    path = tmp_path / "pair.yaml"
    path.write_text(PAIR)
    return path


def test_a_differential_drive_in_closed_form(pair: Path) -> None:
    (found,) = run(pair)["designs"]
    assert (found["delta_m"], found["delta_s"], found["delta_M"], found["drives"]) == (2, 0, 2, 2)
    assert found["drives_per_freedom"] == 1
    assert found["vx_max"] == pytest.approx(10 * 0.05)
    assert found["vy_max"] == 0
    assert found["omega_max"] == pytest.approx(10 * 0.05 / 0.2)
    # Rows [1 0 -a], [0 1 0], [1 0 a], [0 1 0], and L = a: the columns are orthogonal, and their norms are equal.
    assert found["characteristic_length"] == pytest.approx(0.2)
    assert found["isotropy"] == pytest.approx(1.0)
    # Each wheel rolls 1 m, with a deviation of 1 cm.
    assert found["sigma_x"] == pytest.approx(0.01 / math.sqrt(2))
    assert found["sigma_theta"] == pytest.approx(0.01 * math.sqrt(2) / 0.4)
    assert found["sigma_y"] == pytest.approx(0.01 * math.sqrt(2) / 0.4 / 2)
    assert found["tip_over"] is None and found["flash"] is None
    assert found["operations"] > 10


def test_isotropy_with_another_length(tmp_path: Path) -> None:
    """A third wheel on a ball at distance b makes L longer than half the track: the ratio is a/L."""
    path = tmp_path / "robot.yaml"
    path.write_text(PAIR + "  - {name: ball, type: spherical, x: 0.5, y: 0, r: 0.05}\n")
    (found,) = run(path)["designs"]
    length = math.sqrt((0.2**2 + 0.2**2 + 0.5**2) / 3)
    assert found["characteristic_length"] == pytest.approx(length)
    assert found["isotropy"] == pytest.approx(0.2 / length)


def test_a_robot_tips_over_its_longer_side(tmp_path: Path) -> None:
    path = tmp_path / "cart.yaml"
    path.write_text(CART)
    (found,) = run(path)["designs"]
    assert found["tip_over"] == pytest.approx(math.atan(0.3 / 0.5))
    assert (found["delta_m"], found["delta_s"], found["drives"]) == (1, 2, 8)
    assert found["vx_max"] is None  # no limit
    assert found["sigma_x"] is None  # no noise


@pytest.mark.parametrize(
    ("robot", "degrees", "drives"),
    [
        ("textbook_differential", (2, 0), 2), ("textbook_tricycle", (1, 1), 2), ("synchro_drive", (1, 1), 2),
        ("festo_robotino", (3, 0), 3), ("nomad_xr4000", (3, 0), 8), ("office_chair", (3, 0), 0),
    ],
)  # fmt: skip
def test_degrees_and_drives(robot: str, degrees: tuple[int, int], drives: int) -> None:
    (found,) = run(ROBOTS / f"{robot}.yaml")["designs"]
    assert (found["delta_m"], found["delta_s"]) == degrees and found["drives"] == drives


def test_flash_is_that_of_the_budget(tmp_path: Path) -> None:
    budget = json.loads((ROOT / "generated" / "pioneer3dx" / "budget.json").read_text())
    (found,) = run(ROBOTS / "pioneer3dx.yaml", "-o", ROOT / "generated")["designs"]
    assert found["flash"] == budget["text"]
    changed = tmp_path / "pioneer3dx.yaml"
    changed.write_text((ROBOTS / "pioneer3dx.yaml").read_text() + "# another file\n")
    assert run(changed, "-o", ROOT / "generated")["designs"][0]["flash"] is None


def test_a_sweep_is_a_grid(pair: Path) -> None:
    found = run(pair, "--vary", "half=0.1:0.3:3", "--vary", "r=40 mm:60 mm:2")["designs"]
    assert [(d["half"], d["r"]) for d in found] == [(h, r) for h in (0.1, 0.2, 0.3) for r in (0.04, 0.06)]
    for design in found:
        assert design["omega_max"] == pytest.approx(10 * design["r"] / design["half"])


@pytest.mark.parametrize("words", [("r", "0.03", "0.05"), ("shift", "-0.1", "0.1")])
def test_operations_of_a_sweep_are_those_of_each_design(words: tuple[str, str, str], pair: Path) -> None:
    """``r`` is tunable: its formulas are counted once. ``shift`` is a number of the formulas; 0 saves products."""
    name, low, high = words
    pair.write_text(PAIR.replace("{half: 0.2,", "{half: 0.2, shift: 0.1,").replace("x: 0,", "x: shift,"))
    found = run(pair, "--vary", f"{name}={low}:{high}:3", "--workers", "1")["designs"]
    alone = []
    for value in (facts[name] for facts in found):
        _COUNTED.clear()
        alone.append(run(pair, "--vary", f"{name}={value}:{value}:1")["designs"][0]["operations"])
    assert [facts["operations"] for facts in found] == alone
    assert (len(set(alone)) > 1) == (name == "shift")


def test_an_impossible_design_ends_no_sweep(pair: Path) -> None:
    found = run(pair, "--vary", "r=-0.05:0.05:3")["designs"]
    assert ["error" in d for d in found] == [True, True, False]


def test_workers_compute_the_same(pair: Path) -> None:
    words = [pair, "--vary", "half=0.1:0.3:12"]
    assert run(*words, "--workers", "1") == run(*words, "--workers", "2")


@pytest.fixture
def address() -> Iterator[str]:
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as local:
        yield local.scheduler_address


@pytest.mark.slow
def test_a_cluster_computes_the_same(pair: Path, address: str) -> None:
    words = [pair, "--vary", "half=0.1:0.3:12"]
    assert run(*words, "--workers", "1") == run(*words, "--scheduler", address)


def test_the_picture_and_the_tables(pair: Path, tmp_path: Path) -> None:
    svg = tmp_path / "designs.svg"
    done = command_line("designs", pair, "--vary", "half=0.1:0.3:5", "--svg", svg)
    assert done.code == 0 and len(done.out.splitlines()) == 6
    root = ElementTree.fromstring(svg.read_text(encoding="utf-8"))
    curves = list(root.iter("{http://www.w3.org/2000/svg}polyline"))
    assert curves and all(len(curve.attrib["points"].split()) == 5 for curve in curves)
    done = command_line("designs", pair, ROBOTS / "festo_robotino.yaml", "--svg", svg)
    assert done.code == 0 and done.out.splitlines()[0].split() == ["pair", "festo_robotino"]
    ElementTree.fromstring(svg.read_text(encoding="utf-8"))


def test_ends_of_an_axis_are_different_numbers(pair: Path, tmp_path: Path) -> None:
    """The deviation along the path hardly depends on the radius: three digits would be 0.00711 at both ends."""
    pair.write_text(PAIR.replace("{proportional: 0.01}", "{proportional: 0.01, constant: 0.002 rad/s}"))
    svg = tmp_path / "designs.svg"
    found = run(pair, "--vary", "r=0.050:0.052:3", "--svg", svg)["designs"]
    low, high = sorted(facts["sigma_x"] for facts in (found[0], found[-1]))
    assert f"{low:.3g}" == f"{high:.3g}" and low < high
    texts = [
        element.text
        for element in ElementTree.fromstring(svg.read_text(encoding="utf-8")).iter()
        if element.text
    ]
    assert any("along" in text and "10⁻³" in text for text in texts)
    shown = [float(text) / 1000 for text in texts if re.fullmatch(r"7\.\d+", text)]
    assert len(shown) == 2 and shown[0] != shown[1]
    assert min(shown) == pytest.approx(low, rel=1e-3) and max(shown) == pytest.approx(high, rel=1e-3)


def test_a_picture_of_equal_designs_is_remarked(pair: Path, tmp_path: Path) -> None:
    done = command_line("designs", pair, "--svg", tmp_path / "designs.svg")
    assert done.code == 0 and done.err
    assert not command_line("designs", pair).err


@pytest.mark.parametrize(
    "words",
    [
        ["--vary", "half"], ["--vary", "half=1:2"], ["--vary", "half=1:2:0"], ["--vary", "half=1:2:many"],
        ["--vary", "half=a:2:3"], ["--vary", "track=1:2:3"], ["--vary", "half=1:2:3", "--vary", "half=1:2:3"],
        ["--vary", "half=1:2:99999", "--vary", "r=1:2:9"], ["--workers", "0"], ["none.yaml"],
        ["--workers", "2", "--scheduler", "tcp://127.0.0.1:9"], ["--vary", "half=10 deg:30 deg:2"],
    ],
)  # fmt: skip
def test_wrong_usage_is_refused(words: Sequence[str], pair: Path) -> None:
    assert run(pair, *words, code=2)["exit_code"] == 2


@pytest.mark.parametrize(
    "words",
    [
        ["--vary", "r=1e-7:2e-7:3"], ["--vary", "half=1e-6:1e3:3"], ["--vary", "half=0.2:0.200001:3"],
        [ROBOTS / "festo_robotino.yaml", ROBOTS / "car_with_trailers.yaml"],
    ],
)  # fmt: skip
def test_no_word_of_the_picture_is_cut_or_covered(
    words: Sequence[object], pair: Path, tmp_path: Path
) -> None:
    svg = tmp_path / "designs.svg"
    run(pair, *words, "--svg", svg)
    assert mistakes(svg.read_text(encoding="utf-8"), tmp_path) == []
