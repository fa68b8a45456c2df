"""Rules: each finds its mistake and nothing in the mended robot; findings of the gallery are defended in its files."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import GALLERY, ROOT
from wmrgen.tools.lint import RULES, Finding, Rule, Subject, findings

HEAD = "wmrgen: 1\nname: tried\n"
EACH = pytest.mark.parametrize("rule", RULES.values(), ids=RULES)


def linted(path: Path) -> list[Finding]:
    spec, robot = wmrgen.read(path)
    return findings(Subject(spec, robot, wmrgen.derive(robot).mobility))


def codes(path: Path, text: str) -> list[str]:
    path.write_text(HEAD + text, encoding="utf-8")
    return [f.code for f in linted(path)]


@EACH
def test_the_wrong_example_has_the_finding_and_the_right_one_none(rule: Rule, tmp_path: Path) -> None:
    assert set(codes(tmp_path / "wrong.yaml", rule.wrong)) == {rule.code}
    assert codes(tmp_path / "right.yaml", rule.right) == []


@EACH
def test_a_comment_beside_the_line_ignores_that_finding_alone(rule: Rule, tmp_path: Path) -> None:
    path = tmp_path / "wrong.yaml"
    path.write_text(HEAD + rule.wrong, encoding="utf-8")
    lines = path.read_text(encoding="utf-8").split("\n")
    for finding in linted(path):
        lines[finding.mark.line - 1] += f"   # wmrgen: ignore {rule.code}"
    kept = "\n".join(lines)
    path.write_text(kept, encoding="utf-8")
    assert linted(path) == []
    path.write_text(kept.replace(f"ignore {rule.code}", "ignore WMR999"), encoding="utf-8")
    assert {f.code for f in linted(path)} == {rule.code}


def test_codes_of_several_rules_stand_in_one_comment(tmp_path: Path) -> None:
    wheel = "  - {name: left, type: fixed, x: 0.1, y: 0, heading: 0, r: 0.1}"
    bad = f"wheels:\n{wheel}"
    assert codes(tmp_path / "a.yaml", f"{bad}\n") == ["WMR014", "WMR020"]
    assert codes(tmp_path / "a.yaml", f"{bad}  # wmrgen: ignore WMR014, WMR020\n") == []
    assert codes(tmp_path / "a.yaml", f"{bad}  # wmrgen: ignore WMR020\n") == ["WMR014"]
    assert codes(tmp_path / "a.yaml", f"{bad}  # WMR014 WMR020\n") == ["WMR014", "WMR020"]


@pytest.mark.parametrize("path", GALLERY, ids=lambda path: path.stem)
def test_nothing_in_the_gallery(path: Path) -> None:
    assert [str(f) for f in linted(path)] == []


def test_every_comment_of_the_gallery_is_needed(tmp_path: Path) -> None:
    for path in GALLERY:
        text = path.read_text(encoding="utf-8")
        bare = tmp_path / path.name
        bare.write_text(text.replace("# wmrgen: ignore", "#"), encoding="utf-8")
        there = {(f.mark.line, f.code) for f in linted(bare)}
        said = {
            (n, code)
            for n, line in enumerate(text.split("\n"), 1)
            if "# wmrgen: ignore" in line
            for code in line.split("ignore")[1].split()
        }
        assert there == said, path


def test_the_page_is_printed_from_the_table() -> None:
    from tests.tools.lint.page import page

    assert (ROOT / "docs" / "lint.md").read_text(encoding="utf-8") == page(), (
        "python -m tests.tools.lint.page"
    )


@pytest.mark.parametrize(
    ("wheel", "joint"),
    [
        ("type: fixed, actuated: []", "spin to actuated of b"),
        ("type: castor, d: -0.1", "spin to actuated of b"),
        ("type: spherical", ""),  # every joint is driven already
    ],
)
def test_too_few_motors_name_a_joint_that_has_none(tmp_path: Path, wheel: str, joint: str) -> None:
    place = "" if "spherical" in wheel else ", heading: 0, r: 0.1"
    path = tmp_path / "a.yaml"
    path.write_text(
        "wmrgen: 1\nname: bot\nwheels:\n  - {name: a, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}\n"
        f"  - {{name: b, {wheel}, x: 0, y: -0.2{place}}}\n"
    )
    (finding,) = (f for f in linted(path) if f.code == "WMR020")
    assert joint in finding.instead
    assert bool(joint) == (" of b" in finding.instead)


@pytest.mark.parametrize(
    ("length", "r", "unit"),
    [(330, 97, "mm"), (11.5, 2, "cm or in"), (14.5, 3, "cm or in"), (60, 5, "mm or cm")],
)
def test_a_size_is_of_the_units_in_which_robots_have_it(
    tmp_path: Path, length: float, r: float, unit: str
) -> None:
    path = tmp_path / "a.yaml"
    path.write_text(
        "wmrgen: 1\nname: bot\nwheels:\n"
        f"  - {{name: left, type: fixed, x: 0, y: {length}, heading: 0, r: {r}}}\n"
        f"  - {{name: right, type: fixed, x: 0, y: -{length}, heading: 0, r: {r}}}\n"
    )
    assert [f.instead for f in linted(path) if f.code == "WMR003"] == [
        f"Did you mean {unit}? Write the unit."
    ]


def test_joints_that_drive_the_same_motion(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    wheels = "".join(f"  - {{name: {n}, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}}\n" for n in "ab")
    path.write_text(f"wmrgen: 1\nname: bot\nwheels:\n{wheels}")
    (finding,) = (f for f in linted(path) if f.code == "WMR020")
    assert finding.mark.line == 4
    assert "actuated of" not in finding.instead  # no joint is left that could be driven


def test_of_wheels_that_steer_the_one_that_does_not_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    places = ((1, 1, "[steer]"), (1, -1, "[steer]"), (-1, 1, "[steer]"), (-1, -1, "[spin]"))
    text = "".join(
        f"  - {{name: w{k}, type: steered, x: {x}, y: {y}, heading: 0, r: 0.1, actuated: {joints}}}\n"
        for k, (x, y, joints) in enumerate(places)
    )
    path.write_text(f"{HEAD}wheels:\n{text}")
    (finding,) = (f for f in linted(path) if f.code == "WMR021")
    assert finding.mark.line == 7
    assert re.findall(r"\b\d\b", finding.what) == ["3", "2", "1", "1"]  # joints, freedoms, surplus, relations
    assert re.findall(r"\bw\d\b", finding.what) == ["w3"]


def test_one_wheel_of_four_without_gamma(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    corners = {"fl": (1, 1, 0), "fr": (1, -1, 45), "bl": (-1, 1, 45), "br": (-1, -1, -45)}
    wheels = (
        f"  - {{name: {name}, type: swedish, x: {x}, y: {y}, heading: 0, r: 0.1, gamma: {gamma} deg}}\n"
        for name, (x, y, gamma) in corners.items()
    )
    path.write_text("wmrgen: 1\nname: bot\nwheels:\n" + "".join(wheels))
    (told,) = (f for f in linted(path) if f.code == "WMR032")
    assert told.mark.line == 4 and told.what.startswith("fl ")
