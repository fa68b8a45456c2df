"""Every robot file of the gallery: readable, named after its file, and with the mobility that is expected for it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import wmrgen
from tests.conftest import ROOT
from tests.depth import EVERYDAY
from tests.laws.common import gallery
from tests.oracle import oracle, robot_file
from tests.robots import of_gallery
from wmrgen.derivation.artifacts import differences
from wmrgen.derivation.emit import artifacts
from wmrgen.derivation.manifest import recorded_options

ROBOTS = sorted((Path(__file__).parents[2] / "robots").glob("*.yaml"))
# (mobility, steerability, rank C1f, dof): real robots from their sources' geometry, textbook robots from Campion's
# five types and Siegwart 3.3 and 3.4.
EXPECTED = json.loads((Path(__file__).parent / "expected.json").read_text(encoding="utf-8"))
TYPES = [[3, 0], [2, 0], [2, 1], [1, 1], [1, 2]]


def test_gallery_is_complete() -> None:
    assert {p.stem for p in ROBOTS} == set(EXPECTED)
    assert len(ROBOTS) >= 30


@pytest.mark.parametrize("path", ROBOTS, ids=lambda p: p.stem)
def test_file_names_its_robot_and_source(path: Path) -> None:
    robot = wmrgen.load(path)
    assert robot.name == path.stem
    assert robot.description
    if EXPECTED[path.stem]["real"]:
        repo, _, commit = robot.source.partition(" @ ")
        assert "/" in repo and len(commit) == 40


@pytest.mark.parametrize("path", ROBOTS, ids=lambda p: p.stem)
def test_layout_is_what_a_second_reader_reads(path: Path) -> None:
    """Pivot, heading, radius and offsets against `tests.oracle.robot_file`, which shares no code."""
    robot, other = wmrgen.load(path), robot_file.read(path)
    for wheel, w in zip(robot.wheels, other["wheels"], strict=True):
        g = wheel.nominal
        assert (wheel.name, wheel.type) == (w["name"], w["type"])
        found = [g.x, g.y, g.r, g.d, g.o, g.ch, g.sh, g.cg, g.sg]
        wanted = [w["x"], w["y"], w["r"], w["d"], w["o"], np.cos(w["heading"]), np.sin(w["heading"]),
                  np.cos(w["gamma"]), np.sin(w["gamma"])]  # fmt: skip
        if not wheel.kind.directed:
            found, wanted = found[:3], wanted[:3]
        np.testing.assert_allclose([float(v) for v in found], wanted, atol=1e-15)


@pytest.mark.parametrize("path", ROBOTS, ids=lambda p: p.stem)
def test_mobility(path: Path) -> None:
    data, expected = gallery(path.stem)[0].data, EXPECTED[path.stem]
    found = [data["degree_of_mobility"], data["degree_of_steerability"], data["rank_C1f"], data["dof"]]
    assert found == expected["mobility"]
    kind = expected["mobility"][:2]
    assert data["robot_type"] == (kind if kind in TYPES and not expected["degenerate"] else None)
    assert data["degenerate"] == expected["degenerate"]
    assert data["degree_of_maneuverability"] == sum(kind)
    assert data["omnidirectional"] == (kind[0] == 3)
    assert data["holonomic"] == (data["ddof"] == data["dof"])
    assert data["reasons"]


@pytest.mark.parametrize("path", ROBOTS, ids=lambda p: p.stem)
def test_mobility_by_singular_values(path: Path) -> None:
    """The oracle's numbers, from contact velocities at steering angles that meet in one ICR."""
    model, layout = gallery(path.stem)
    for key, value in oracle.mobility(layout).items():
        assert model.data[key] == value, key


@pytest.mark.parametrize("name", sorted(EVERYDAY))
def test_generated_files_are_those_of_today(name: str) -> None:
    """Byte for byte: what changes in them is seen, and committed with what changes it. `make check` runs
    `wmrgen check`, which compares those of every robot."""
    folder = ROOT / "generated" / name
    files = artifacts(of_gallery(name))
    assert [str(unlike) for unlike in differences(folder, files, recorded_options(folder))] == []
