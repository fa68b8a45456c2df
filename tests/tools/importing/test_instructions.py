"""What parameters of controllers say of a description: motors and rollers, never lengths."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import Outcome
from tests.tools.importing.urdf import pair, robot, wheel

Cli = Callable[..., Outcome]
Import = Callable[..., dict[str, Any]]
CORNERS = {"fl": (0.3, 0.25), "fr": (0.3, -0.25), "rl": (-0.3, 0.25), "rr": (-0.3, -0.25)}
FOUR = "".join(wheel(n, f"{x} {y} 0.1") for n, (x, y) in CORNERS.items())
DIFFERENTIAL = """
drive:
  ros__parameters:
    type: diff_drive_controller/DiffDriveController
    left_wheel_names: [left_joint]
    right_wheel_names: [right_joint]
    wheel_separation: {track}
    wheel_radius: 0.1
"""
MECANUM = "\n".join(
    ["drive:", "  ros__parameters:", "    type: mecanum_drive_controller/MecanumDriveController"]
    + [f"    {place}_wheel_command_joint_name: {n}_joint" for place, n in
       (("front_left", "fl"), ("front_right", "fr"), ("rear_left", "rl"), ("rear_right", "rr"))]
    + ["    kinematics:", "      wheels_radius: 0.1", "      sum_of_robot_center_projection_on_X_Y_axis: 0.55"]
)  # fmt: skip


@pytest.fixture
def read(wmrgen_cli: Cli, tmp_path: Path) -> Import:
    def call(text: str, parameters: str) -> dict[str, Any]:
        (tmp_path / "probe.urdf").write_text(text, encoding="utf-8")
        (tmp_path / "drive.yaml").write_text(parameters, encoding="utf-8")
        files = (
            tmp_path / "probe.urdf",
            "--controller",
            tmp_path / "drive.yaml",
            "-o",
            tmp_path / "probe.yaml",
        )
        done = wmrgen_cli("import", *files, "--json")
        assert done.code == 0, done.err
        said = json.loads(done.out)
        text = (tmp_path / "probe.yaml").read_text(encoding="utf-8")
        return {**said, "wheels": {w["name"]: w for w in said["wheels"]}, "notes": done.err, "text": text}

    return call


def test_joints_that_a_controller_names_are_driven(read: Import) -> None:
    """The third wheel is not, and nobody need be asked."""
    said = read(robot(pair(), wheel("third", "-0.3 0 0.1")), DIFFERENTIAL.format(track=0.5))
    assert [w["actuated"] for w in said["wheels"].values()] == [["spin"], ["spin"], []]
    assert said["questions"] == [] and "differs" not in said["notes"]


def test_a_prefix_may_stand_before_a_name(read: Import) -> None:
    parts = (
        pair().replace('"left_joint"', '"robot_left_joint"').replace('"right_joint"', '"robot_right_joint"')
    )
    said = read(robot(parts), DIFFERENTIAL.format(track=0.5))
    assert [w["actuated"] for w in said["wheels"].values()] == [["spin"], ["spin"]]
    said = read(
        robot(pair(), wheel("third", "-0.3 0 0.1")),
        DIFFERENTIAL.format(track=0.5).replace("right_", "no_", 2),
    )
    assert "names the joint 'no_joint', which the file has not" in said["notes"]


def test_a_length_that_differs_is_told_and_not_taken(read: Import) -> None:
    said = read(robot(pair()), DIFFERENTIAL.format(track=0.52))
    assert [w["y"] for w in said["wheels"].values()] == [0.25, -0.25]
    assert "0.5 m -> 0.52 m" in said["notes"] and "0.52 m" in said["text"]


def test_a_length_that_the_description_lacks_is_a_hint(read: Import) -> None:
    mesh = robot(pair(geometry='<mesh filename="package://x/wheel.stl"/>'))
    said = read(mesh, DIFFERENTIAL.format(track=0.5))
    assert {w["r"] for w in said["wheels"].values()} == {None}
    assert said["questions"][0]["hints"] == ["0.1 by 'wheel_radius'"]


def test_a_mecanum_controller_drives_wheels_with_rollers(read: Import) -> None:
    said = read(robot(FOUR), MECANUM)
    assert {(w["type"], *w["actuated"]) for w in said["wheels"].values()} == {("swedish", "spin")}
    assert [(q["answer"], len(q["also"])) for q in said["questions"]] == [("rollers", 3)]


SKID = """
drive:
  ros__parameters:
    type: diff_drive_controller/DiffDriveController
    wheel_separation: 0.5
    wheel_separation_multiplier: {factor}
    wheel_radius: 0.1
"""


def test_the_multiplier_of_a_skid_steer_is_its_effective_track(
    read: Import, wmrgen_cli: Cli, tmp_path: Path
) -> None:
    """0.5 m times 1.875; the file is derived, and its own controller agrees with it."""
    said = read(robot(FOUR), SKID.format(factor=1.875))
    assert "\neffective_track: 0.9375\n" in said["text"]
    comment = " ".join(said["text"].replace("#", "").split())
    assert "'wheel_separation' 0.5 times 'wheel_separation_multiplier' 1.875; drive.yaml, line 6" in comment
    path = tmp_path / "probe.yaml"
    path.write_text(said["text"].replace("TODO", "[spin]"), encoding="utf-8")
    done = wmrgen_cli("compare", path, tmp_path / "drive.yaml")
    assert done.code == 0 and "does not count" not in done.out


def test_a_multiplier_of_the_track_that_the_description_has(read: Import) -> None:
    """Controllers of ROS 1 take it from there; of wheels on four lines it is not sure which."""
    parameters = SKID.format(factor=1.5).replace("    wheel_separation: 0.5\n", "")
    assert "\neffective_track: 0.75\n" in read(robot(FOUR), parameters)["text"]
    aslant = robot(*(wheel(n, f"{x} {y + x / 9:.3f} 0.1") for n, (x, y) in CORNERS.items()))
    assert "effective_track" not in read(aslant, parameters)["text"]


@pytest.mark.parametrize(
    ("parts", "parameters"),
    [
        (FOUR, SKID.format(factor=1)),  # nothing is said
        (FOUR, SKID.format(factor=1.5).replace("_multiplier", "_x")),
        (pair(), SKID.format(factor=1.5)),  # one axle: it does not skid
        (FOUR, SKID.format(factor=1.5) + SKID.format(factor=1.2).replace("drive:", "other:")),  # two say two
        (FOUR, SKID.format(factor=1.5).replace("diff_drive_controller/DiffDriveController", "mecanum_drive")),
    ],
)
def test_where_it_is_not_sure_no_effective_track_is_written(
    read: Import, parts: str, parameters: str
) -> None:
    assert "effective_track" not in read(robot(parts), parameters)["text"]


def test_a_file_that_is_no_yaml(wmrgen_cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "probe.urdf").write_text(robot(pair()), encoding="utf-8")
    (tmp_path / "drive.yaml").write_text("a: [", encoding="utf-8")
    for name in ("drive.yaml", "none.yaml"):
        done = wmrgen_cli("import", tmp_path / "probe.urdf", "--controller", tmp_path / name)
        assert done.code == 2 and name in done.err
