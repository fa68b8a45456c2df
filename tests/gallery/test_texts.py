"""The second gallery, robots/texts/: layouts of the five texts, with the degrees that our notes of them have."""

from __future__ import annotations

from pathlib import Path

import pytest

import wmrgen
from tests.conftest import ROOT, Outcome, command_line
from tests.packaging.textbook_robots import PICTURES
from textbook.index.records import facts
from textbook.index.table import ROWS
from wmrgen.cli.gallery import gallery, robots_of_texts

FILES = sorted((ROOT / "robots" / "texts").glob("*.yaml"))
NAMES = [path.stem for path in FILES]
# Author's name in `source` by the beginning of the file's name.
AUTHORS = {
    "siegwart": "Siegwart",
    "tzafestas": "Tzafestas",
    "konstantinov": "Konstantinov",
    "kelly": "Kelly",
    "aa274": "AA274",
}


def test_the_gallery_is_complete() -> None:
    """Each file is in the table of places, and no name is in both galleries."""
    used = {row.robot.removeprefix("texts/") for row in ROWS if row.robot.startswith("texts/")}
    assert set(NAMES) == used == set(robots_of_texts()) and len(NAMES) >= 50
    assert not set(NAMES) & set(gallery())


@pytest.mark.parametrize("path", FILES, ids=NAMES)
def test_the_file_names_its_source(path: Path) -> None:
    robot = wmrgen.load(path)
    assert robot.name == path.stem and robot.description
    assert AUTHORS[path.stem.partition("_")[0]] in robot.source
    first, second = path.read_text(encoding="utf-8").splitlines()[:2]
    assert first.endswith("$schema=../robot.schema.json") and second.startswith("# ")


def test_no_file_has_findings() -> None:
    """What `lint` questions is kept by a comment on its line."""
    done: Outcome = command_line("lint", *FILES)
    assert done.code == 0, done.out


@pytest.mark.parametrize("path", FILES, ids=NAMES)
def test_degrees(path: Path) -> None:
    """Degrees, ranks, DDOF and DOF of the layouts that our notes list; every robot derives and has its picture."""
    derivation = wmrgen.derive(wmrgen.load(path))
    m = derivation.mobility
    drawn = derivation.figures["layout.svg"][1].encode()
    assert drawn == (PICTURES / f"{path.stem}.svg").read_bytes(), (
        "run: python -m tests.packaging.textbook_robots"
    )
    assert m.degree_of_maneuverability == m.degree_of_mobility + m.degree_of_steerability
    cases = {row.case for row in ROWS if row.robot == f"texts/{path.stem}" and row.case}
    for expected in (known for case in cases if "degrees" in (known := facts(case))):
        assert [m.degree_of_mobility, m.degree_of_steerability, m.degree_of_maneuverability] == expected[
            "degrees"
        ]
        assert (m.ddof, m.dof, m.holonomic) == (expected["ddof"], expected["dof"], expected["holonomic"])
        assert (m.rank_C1f.value, m.rank_C1.value) == (expected["rank_C1f"], expected["rank_C1"])


@pytest.mark.parametrize("name", ["siegwart_piaggio", "konstantinov"])
def test_a_robot_file_starts_from_a_layout(name: str, tmp_path: Path) -> None:
    done = command_line("new", "mine", "--from", name, "-o", tmp_path / "mine.yaml")
    assert done.code == 0, done.err
    assert len(wmrgen.load(tmp_path / "mine.yaml").wheels) == len(
        wmrgen.load(ROOT / f"robots/texts/{name}.yaml").wheels
    )
