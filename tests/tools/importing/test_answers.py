"""Answers to questions: from the command line, and from an earlier robot file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import Outcome
from tests.tools.importing.urdf import pair, robot, wheel

Cli = Callable[..., Outcome]
CORNERS = {"fl": (0.3, 0.25), "fr": (0.3, -0.25), "rl": (-0.3, 0.25), "rr": (-0.3, -0.25)}


def four_driven(ahead: str = "0.3") -> str:
    wheels = "".join(wheel(name, f"{x} {y} 0.1") for name, (x, y) in CORNERS.items())
    joints = "".join(f'<joint name="{n}_joint"><command_interface name="velocity"/></joint>' for n in CORNERS)
    return robot(wheels.replace('"0.3 ', f'"{ahead} '), f"<ros2_control>{joints}</ros2_control>")


@pytest.fixture
def description(tmp_path: Path) -> Path:
    path = tmp_path / "probe.urdf"
    path.write_text(four_driven(), encoding="utf-8")
    return path


def test_one_answer_is_written_for_all_its_wheels(wmrgen_cli: Cli, description: Path) -> None:
    out = description.with_suffix(".yaml")
    done = wmrgen_cli("import", description, "-o", out, "--answer", "fl.type=fixed")
    assert done.code == 0 and "open" not in done.err
    assert [w.type for w in wmrgen.load(out).wheels] == ["fixed"] * 4


@pytest.mark.parametrize(
    "word", ["fl.r=0.1", "left.type=fixed", "fl.type", "type=fixed", "fl.type=a: b", "fl.type={}"]
)
def test_answers_to_no_question_are_refused(wmrgen_cli: Cli, description: Path, word: str) -> None:
    out = description.with_suffix(".yaml")
    assert wmrgen_cli("import", description, "-o", out, "--answer", word).code == 2
    assert not out.exists()


def test_answers_of_an_earlier_file_are_kept(wmrgen_cli: Cli, description: Path) -> None:
    earlier, out = description.with_name("earlier.yaml"), description.with_name("out.yaml")
    assert wmrgen_cli("import", description, "-o", earlier, "--answer", "fl.type=fixed").code == 0
    description.write_text(four_driven("0.4"), encoding="utf-8")
    assert wmrgen_cli("import", description, "-o", out, "--update", earlier).code == 0
    assert [float(w.nominal.x) for w in wmrgen.load(out).wheels] == [0.4, 0.4, -0.3, -0.3]


def test_questions_that_the_earlier_file_leaves_open_stay_open(wmrgen_cli: Cli, description: Path) -> None:
    earlier, out = description.with_name("earlier.yaml"), description.with_name("out.yaml")
    assert wmrgen_cli("import", description, "-o", earlier).code == 0
    assert wmrgen_cli("import", description, "-o", out, "--update", earlier).code == 0
    assert out.read_text(encoding="utf-8").count("type: TODO") == 4


def test_an_earlier_file_keeps_no_value_that_the_description_says(wmrgen_cli: Cli, description: Path) -> None:
    description.write_text(robot(pair()), encoding="utf-8")
    earlier, out = description.with_name("earlier.yaml"), description.with_name("out.yaml")
    assert wmrgen_cli("import", description, "-o", earlier).code == 0
    earlier.write_text(earlier.read_text(encoding="utf-8").replace("r: 0.1", "r: 0.2"), encoding="utf-8")
    assert wmrgen_cli("import", description, "-o", out, "--update", earlier).code == 0
    assert [float(w.nominal.r) for w in wmrgen.load(out).wheels] == [0.1, 0.1]


def test_a_type_may_be_answered_with_the_keys_that_it_needs(wmrgen_cli: Cli, description: Path) -> None:
    out = description.with_suffix(".yaml")
    keys = {"type": "castor", "d": "-0.03", "actuated": "[]"}
    words = [part for key, value in keys.items() for part in ("--answer", f"caster.{key}={value}")]
    tail = wheel("caster", "-0.3 0 0.04", '<cylinder radius="0.04" length="0.02"/>')
    driven = (
        '<ros2_control><joint name="left_joint"><command_interface name="velocity"/></joint></ros2_control>'
    )
    description.write_text(robot(pair(), tail, driven), encoding="utf-8")
    assert wmrgen_cli("import", description, "-o", out, *words).code == 0
    wheel_of = wmrgen.load(out).wheel("caster")
    assert (wheel_of.type, float(wheel_of.nominal.d)) == ("castor", -0.03)


@pytest.mark.parametrize(
    ("name", "written"),
    [("-left_wheel_joint", None), ("null", "null"), ("12", "'12'"), ("a/b.c", "a/b.c"), ("a: b", "'a: b'")],
)
def test_a_name_of_a_joint_is_text_and_no_sign(
    tmp_path: Path, wmrgen_cli: Cli, name: str, written: str | None
) -> None:
    """A name that begins with a minus sign would turn the joint round in the robot file, so it is left out."""
    robot, description = tmp_path / "a.yaml", tmp_path / "a.urdf"
    text = "".join(
        f"  - {{name: {side}, type: fixed, x: 0, y: {y}, heading: 0, r: 0.1}}\n"
        for side, y in (("left", 0.2), ("right", -0.2))
    )
    robot.write_text(f"wmrgen: 1\nname: a\nwheels:\n{text}", encoding="utf-8")
    assert wmrgen_cli("export", robot, "--to", "urdf", "-o", tmp_path).code == 0
    source = description.read_text(encoding="utf-8")
    description.write_text(source.replace("left_spin", name), encoding="utf-8")
    assert wmrgen_cli("import", description, "-o", robot).code == 0
    imported = robot.read_text(encoding="utf-8")
    assert (f"joints: {{spin: {written}}}" in imported) == (written is not None)
    assert wmrgen_cli("compare", robot, description).code == 0
