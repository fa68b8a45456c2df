"""Wheels that look plain and may be of another type: each reason is asked about, once."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import Outcome
from tests.tools.importing.urdf import cylinder, joint, link, pair, robot, wheel

Cli = Callable[..., Outcome]
Read = Callable[..., dict[str, Any]]
CORNERS = {"fl": (0.3, 0.25), "fr": (0.3, -0.25), "rl": (-0.3, 0.25), "rr": (-0.3, -0.25)}
DRIVEN = "<ros2_control>{}</ros2_control>"
JOINT = '<joint name="{}"><command_interface name="velocity"/></joint>'
PLUGIN = '<gazebo><plugin filename="{}" name="drive">{}</plugin></gazebo>'


@pytest.fixture
def read(wmrgen_cli: Cli, tmp_path: Path) -> Read:
    """Return what `wmrgen import --json` prints of a text, with the lines of the robot file."""

    def call(text: str) -> dict[str, Any]:
        (tmp_path / "probe.urdf").write_text(text, encoding="utf-8")
        out = tmp_path / "probe.yaml"
        done = wmrgen_cli("import", tmp_path / "probe.urdf", "-o", out, "--json")
        assert done.code == 0, done.err
        return {**json.loads(done.out), "text": out.read_text(encoding="utf-8"), "notes": done.err}

    return call


def types(said: dict[str, Any]) -> list[list[str]]:
    """Return the wheels of each question about a type."""
    return [[q["wheel"], *q["also"]] for q in said["questions"] if q["key"] == "type"]


def driven(*names: str) -> str:
    return DRIVEN.format("".join(JOINT.format(f"{name}_joint") for name in names))


def four(corners: dict[str, tuple[float, float]]) -> str:
    return "".join(wheel(name, f"{x} {y} 0.1") for name, (x, y) in corners.items())


def castor(swivel: str, name: str = "caster") -> str:
    fork = link(f"{name}_fork") + joint(
        f"{name}_swivel", "base_link", f"{name}_fork", "-0.3 0 0.1", swivel, "0 0 1"
    )
    return fork + wheel(f"{name}_wheel", "-0.04 0 -0.06", cylinder("0.04"), f"{name}_fork")


def test_castor_with_fixed_swivel(read: Read) -> None:
    drives = driven("left", "right")
    assert types(read(robot(pair(), castor("fixed"), drives))) == [["caster"]]
    assert types(read(robot(pair(), castor("continuous"), drives))) == []
    assert types(read(robot(pair(), castor("fixed", "tail"), drives))) == []


def test_four_driven_wheels_in_a_rectangle_are_one_question(read: Read) -> None:
    said = read(robot(four(CORNERS), driven(*CORNERS)))
    assert types(said) == [list(CORNERS)]
    assert said["text"].count("type: TODO") == 4
    assert {w["type"] for w in said["wheels"]} == {"fixed"}


@pytest.mark.parametrize(
    "parts",
    [
        (four(CORNERS), driven("fl", "fr")),
        (four(CORNERS), driven(*CORNERS), PLUGIN.format("libgazebo_ros_diff_drive.so", "")),
        (four(CORNERS), driven(*CORNERS), PLUGIN.format("libgazebo_ros_skid_steer_drive.so", "")),
        (four({**CORNERS, "fl": (0.3, 0.2), "fr": (0.3, -0.2)}), driven(*CORNERS)),
        (pair(), driven("left", "right")),
    ],
)
def test_what_says_that_four_wheels_are_plain(read: Read, parts: tuple[str, ...]) -> None:
    assert types(read(robot(*parts))) == []


def test_steering_that_a_plugin_has_and_the_file_has_not(read: Read) -> None:
    plugin = PLUGIN.format("gz-sim-ackermann-steering-system", "<left_joint>rl_joint</left_joint>")
    assert types(read(robot(four(CORNERS), driven("rl", "rr"), plugin))) == [["fl", "fr"]]


def test_wheels_of_tracks_are_one_question(read: Read) -> None:
    corners = {f"{end}_track_{side}": at for (end, side), at in zip(CORNERS, CORNERS.values(), strict=True)}
    said = read(robot(four(corners), driven(*corners)))
    assert types(said) == [[w["name"] for w in said["wheels"]]]


def test_two_links_of_one_name_are_refused_at_the_second(wmrgen_cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "probe.urdf").write_text(robot(pair(), "\n", link("left_link")), encoding="utf-8")
    done = wmrgen_cli("import", tmp_path / "probe.urdf")
    assert done.code == 2 and "probe.urdf:2:" in done.err


def test_a_revolute_joint_with_limits_of_zero_is_noted(read: Read) -> None:
    said = read(robot(pair(kind="revolute", more='<limit lower="0" upper="0"/>'), driven("left", "right")))
    assert said["notes"].count("limits from 0 to 0") == 2 and said["questions"] == []


@pytest.mark.parametrize(("rise", "notes"), [("0", 0), ("-0.02", 1), ("0.02", 1)])
def test_a_frame_of_the_ground_that_contradicts_the_cylinders_is_noted_once(
    read: Read, rise: str, notes: int
) -> None:
    foot = link("base_footprint") + joint("foot", "base_footprint", "base_link", f"0 0 {rise}", "fixed")
    said = read(robot(foot, pair(), driven("left", "right")))
    assert said["notes"].count("above base_footprint") == notes
    assert {w["r"] for w in said["wheels"]} == {0.1}
