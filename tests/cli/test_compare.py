"""compare, and lint over several files: exit codes, table, JSON as one object, every form of file."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome
from tests.tools.importing.urdf import robot, wheel

Cli = Callable[..., Outcome]
PIONEER = ROOT / "robots" / "pioneer3dx.yaml"
CONTROLLER = "drive:\n  type: diff_drive_controller/DiffDriveController\n  left_wheel: left_joint\n"


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    path = tmp_path / "robot.urdf"
    plugin = (
        '<gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="drive"><wheel_separation>0.5</wheel_separation>'
        "<wheel_diameter>0.2</wheel_diameter></plugin></gazebo>"
    )
    path.write_text(robot(wheel("left", "0 0.24 0.1"), wheel("right", "0 -0.24 0.1"), plugin))
    return path


@pytest.fixture
def parameters(tmp_path: Path) -> Path:
    path = tmp_path / "control.yaml"
    path.write_text(f"{CONTROLLER}  wheel_separation: 0.48\n  wheel_radius: 0.12\n")
    return path


def test_a_table_with_codes_places_and_motion(wmrgen_cli: Cli, urdf: Path, parameters: Path) -> None:
    done = wmrgen_cli("compare", urdf, parameters)
    assert (done.code, done.err) == (1, "")
    title, track, turn, second, radius, *motion = done.out.splitlines()
    assert title.startswith(f"{urdf} -> {urdf}: drive (libgazebo_ros_diff_drive.so drive):")
    assert track.split()[:2] == ["WMR040", "track"] and "0.48 m -> 0.5 m (+4.2 %)" in track
    assert turn.split()[0] == "turn:" and "4.2 %" in turn
    assert second.startswith(f"{urdf} -> {parameters}: drive")
    assert "WMR042  radius (wheel_radius) 0.1 m -> 0.12 m (+20.0 %)" in radius
    assert radius.endswith(f"{parameters}:5:17")
    assert [line.split()[0] for line in motion] == ["straight:", "turn:"]
    assert all("16.7 %" in line for line in motion)


def test_lint_reads_xacro_of_other_packages_with_its_arguments(wmrgen_cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "wheels.xacro").write_text(
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="pair" params="y">'
        + wheel("left", "0 -${y} 0.1") + wheel("right", "0 ${y} 0.1") + "</xacro:macro></robot>"
    )  # fmt: skip
    top = tmp_path / "top" / "robot.urdf.xacro"
    top.parent.mkdir()
    top.write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="y" default="0.1"/>'
        '<link name="base_link"/>'
        '<xacro:include filename="$(find parts)/wheels.xacro"/><xacro:pair y="$(arg y)"/></robot>'
    )
    done = wmrgen_cli("lint", top, "--package", f"parts={tmp_path / 'parts'}", "y:=0.2")
    assert done.code == 1 and done.out.count("warning[WMR011]") == 2, done
    assert "--package parts=DIR" in wmrgen_cli("lint", top, "y:=0.2").err


def test_parameters_of_no_wheel_controller_are_told_from_a_robot_file(
    wmrgen_cli: Cli, urdf: Path, tmp_path: Path
) -> None:
    other = tmp_path / "groups.yaml"
    other.write_text(
        "drive:\n  type: velocity_controllers/JointGroupVelocityController\n  joints: [left_joint]\n"
    )
    done = wmrgen_cli("compare", urdf, other)
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith(f"error[WMR111]: {other}: ")
    other.write_text("name: bot\nwheels:\n  - {name: left, type: fixed, x: 0, y: 0.1, r: 0.1}\n")
    assert "error[WMR103]" in wmrgen_cli("compare", urdf, other).err


def test_json_is_one_object(wmrgen_cli: Cli, urdf: Path, parameters: Path) -> None:
    done = wmrgen_cli("compare", parameters, urdf, "--json")  # the robot is the file that has wheels
    told = json.loads(done.out)
    assert (done.code, told["robot"]) == (1, str(urdf))
    first, second = told["comparisons"]
    assert not first["equal"] and first["file"] == str(parameters)
    assert first["controller"] == "drive (diff_drive_controller/DiffDriveController)"
    (d,) = first["differences"]
    assert (d["code"], d["quantity"], d["wheel"], d["a"], d["b"]) == ("WMR042", "radius", "", 0.1, 0.12)
    assert d["marks"] == [{"file": str(parameters), "line": 5, "column": 17}]
    assert first["motion"]["turn"]["ratio"] == pytest.approx(1 / 1.2)
    assert "16.7 %" in first["motion"]["turn"]["words"]
    assert [d["code"] for d in second["differences"]] == ["WMR040"]


def test_equal_files(wmrgen_cli: Cli, tmp_path: Path) -> None:
    header = ROOT / "generated" / "pioneer3dx" / "pioneer3dx.h"
    done = wmrgen_cli("compare", PIONEER, header, PIONEER)
    assert (done.code, done.out) == (0, f"{PIONEER} -> {header}: equal\n{PIONEER} -> {PIONEER}: equal\n")
    edited = tmp_path / "edited.h"
    edited.write_text(header.read_text().replace("LEFT_RADIUS 0.0975f", "LEFT_RADIUS 0.0925f"))
    done = wmrgen_cli("compare", PIONEER, edited, "--json")
    (d,) = json.loads(done.out)["comparisons"][0]["differences"]
    assert done.code == 1 and (d["code"], d["wheel"], d["b"]) == ("WMR042", "left", 0.0925)
    assert "LEFT_RADIUS" in edited.read_text().split("\n")[d["marks"][0]["line"] - 1]


def test_what_one_file_alone_says_is_not_compared(wmrgen_cli: Cli, tmp_path: Path, parameters: Path) -> None:
    """And another file's number stands for it: nothing is said of a motion that it would change."""
    other, meshes, drawn = (tmp_path / name for name in ("radius.yaml", "meshes.urdf", "drawn.urdf"))
    mesh = '<mesh filename="wheel.stl"/>'
    other.write_text(f"{CONTROLLER}  wheel_radius: 0.12\n")
    meshes.write_text(robot(wheel("left", "0 0.24 0.1", mesh), wheel("right", "0 -0.24 0.1", mesh)))
    drawn.write_text(robot(wheel("left", "0 0.24 0.1"), wheel("right", "0 -0.24 0.1")))
    for files, value, source in (
        ((parameters, other), "track", other),
        ((other, parameters), "wheel_separation 0.48 m", other),
        ((meshes, other), "wheel_radius 0.12 m", meshes),
        ((PIONEER, other), "track", other),
        ((drawn, meshes), "radius of left, radius of right", meshes),
    ):
        shown = wmrgen_cli("compare", *files).out.splitlines()
        (comparison,) = json.loads(wmrgen_cli("compare", *files, "--json").out)["comparisons"]
        assert comparison["equal"] == (PIONEER not in files)
        words = [w for w in comparison["not_compared"] if w.startswith(value)]
        assert len(words) == 1 and str(source) in words[0]
        assert f"  not compared: {words[0]}" in shown
        assert PIONEER in files or not any("turn:" in line for line in shown)


def test_places_of_steering_joints_which_a_robot_file_does_not_name(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """A module is known by its end and side; a place that belongs to no wheel is told."""
    modules, drive = tmp_path / "modules.yaml", tmp_path / "robot.yaml"
    ends, sides = (("front", 0.24), ("back", -0.24)), (("left", 1), ("right", -1))
    corners = [(f"{end}_{side}", x, sign) for end, x in ends for side, sign in sides]
    said = "m:\n  ros__parameters:\n    wheel_radius: 0.1\n"
    robot = "wmrgen: 1\nname: swerve\nwheels:\n"
    for n, (name, x, sign) in enumerate(corners):
        said += f"    drive{n}: {{joint_name: wheel_{name}_joint}}\n"
        pivot = f"center_pos_x: {x}, center_pos_y: {0.19 * sign}"
        said += f"    steer{n}: {{joint_name: caster_{name}_joint, {pivot}}}\n"
        robot += f"  - {{name: wheel_{name}, type: steered, x: {x}, y: {0.18 * sign}, heading: 0, r: 0.1}}\n"
    modules.write_text(said)
    drive.write_text(robot)
    done = wmrgen_cli("compare", drive, modules)
    assert done.code == 1 and "WMR040  track 0.36 m -> 0.38 m" in done.out
    modules.write_text(said.replace("caster_back_left_joint", "odd"))
    told = "not compared: steer2.center_pos_x -0.24 m, steer2.center_pos_y 0.19 m"
    assert told in wmrgen_cli("compare", drive, modules).out


@pytest.mark.parametrize(
    ("files", "code", "names"),
    [
        (["none.yaml"], "WMR110", "none.yaml"),
        (["control.yaml"], "WMR112", ""),
        (["robot.yaml"], "WMR112", ""),
        (["robot.yaml", "empty.yaml"], "WMR101", "empty.yaml:1:1"),
        (["robot.yaml", "bad.yaml"], "WMR109", "bad.yaml:1:23"),
        (["robot.yaml", "robot.xml"], "WMR111", "robot.xml:1:15"),
        (["robot.yaml", "header.h"], "WMR111", "header.h"),
        (["robot.yaml", "many.h"], "WMR111", "64"),
    ],
)
def test_bad_files(
    wmrgen_cli: Cli, tmp_path: Path, parameters: Path, files: list[str], code: str, names: str
) -> None:
    (tmp_path / "robot.yaml").write_text(PIONEER.read_text())
    (tmp_path / "empty.yaml").write_text("")
    (tmp_path / "bad.yaml").write_text("drive: {wheel_radius: ten}\n")
    (tmp_path / "robot.xml").write_text("<robot><link/>")
    (tmp_path / "header.h").write_text("#define MINE_WHEELS 2\n")
    many = "".join(f" *   w{k}: fixed, x 0 m, y {k} m\n" for k in range(65))
    (tmp_path / "many.h").write_text(f"/**\n{many}\n#define MINE_WHEELS 65\n")
    done = wmrgen_cli("compare", *(tmp_path / name for name in files))
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith(f"error[{code}]") and names in done.err
    done = wmrgen_cli("compare", *(tmp_path / name for name in files), "--json")
    assert done.code == 2 and [error["code"] for error in json.loads(done.out)["errors"]] == [code]


def test_lint_holds_other_files_against_the_robot_before_them(
    wmrgen_cli: Cli, urdf: Path, parameters: Path, robot_file: Path
) -> None:
    done = wmrgen_cli("lint", urdf, parameters, "--json")
    told = json.loads(done.out)["findings"]
    assert done.code == 1 and [f["code"] for f in told] == ["WMR040", "WMR042"]
    assert (told[1]["file"], told[1]["line"]) == (str(parameters), 5)
    assert told[1]["instead"].count("16.7 %") == 2
    done = wmrgen_cli("lint", robot_file, PIONEER)  # two robots are not compared
    assert done.code == 0
    parameters.write_text(parameters.read_text().replace("0.12", "0.12   # wmrgen: ignore WMR042"))
    done = wmrgen_cli("lint", urdf, parameters, "--json")
    assert [f["code"] for f in json.loads(done.out)["findings"]] == ["WMR040"]
    assert wmrgen_cli("lint", parameters).code == 2
    done = wmrgen_cli("explain", "WMR042", "--json")
    assert done.code == 0 and "---" in json.loads(done.out)["wrong"]


def test_lint_of_descriptions(wmrgen_cli: Cli, urdf: Path, tmp_path: Path) -> None:
    swapped = tmp_path / "swapped.urdf"
    swapped.write_text(robot(wheel("left", "0 -0.24 0.1"), wheel("right", "0 0.24 0.1")))
    done = wmrgen_cli("lint", urdf, swapped, "--json")  # each is a robot of its own
    told = json.loads(done.out)["findings"]
    assert [(Path(f["file"]).name, f["code"]) for f in told] == [
        ("robot.urdf", "WMR040"), ("swapped.urdf", "WMR011"), ("swapped.urdf", "WMR011"),
    ]  # fmt: skip
    same = tmp_path / "same.yaml"
    same.write_text(
        "wmrgen: 1\nname: same\nwheels:\n  - {name: left, type: fixed, x: 0, y: 0.24, heading: 0, r: 0.1}\n"
        "  - {name: right, type: fixed, x: 0, y: -0.24, heading: 0, r: 0.1}\n"
    )
    done = wmrgen_cli("lint", same, swapped, "--json")
    assert [f["code"] for f in json.loads(done.out)["findings"]] == ["WMR044", "WMR044"]


def test_findings_in_xml_have_their_place_and_can_be_kept(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """Names that contradict places stand at their joints, lengths of plugins and hardware at their elements; none
    where a comment has them."""
    value = '<param name="wheel_separation"> 0.5</param>'
    hardware = f'<ros2_control name="c" type="system"><hardware>\n  {value}\n</hardware></ros2_control>'
    path = tmp_path / "robot.urdf"
    right = wheel("right", "0 0.24 0.1")
    text = robot(f"<!-- {right} {hardware} -->", right, "\n", wheel("left", "0 -0.24 0.1"), "\n", hardware)
    path.write_text(text)
    done = wmrgen_cli("lint", path)
    assert done.code == 1
    joints = [(f'<joint name="{side}_joint"', "WMR011") for side in ("right", "left")]
    for needle, code in (*joints, (value, "WMR040")):
        at = text.index(needle, text.index("-->"))
        line, column = text.count("\n", 0, at) + 1, at - text.rfind("\n", 0, at)
        assert f"--> {path}:{line}:{column}\n" in done.out and f"warning[{code}]" in done.out
    beside = "<!-- # wmrgen: ignore WMR011 WMR040 -->\n"
    comment, end, rest = text.partition("-->")
    rest = rest.replace(value, value + beside).replace("<link", f"{beside}<link")
    path.write_text(comment + end + rest.replace("</joint>", f"</joint> {beside}"))
    assert wmrgen_cli("lint", path).code == 0


def test_what_a_macro_makes_stands_where_the_macro_has_it(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """In its own file: findings, and errors of values."""
    space = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    joint = wheel("${side}", "0 ${y} 0.1")
    macro = f"<xacro:macro name='w' params='side y'>\n {joint}</xacro:macro>"
    parts = tmp_path / "parts.xacro"
    parts.write_text(f"<robot {space}>{macro}</robot>")
    calls = "".join(f'<xacro:w side="{side}" y="{y}"/>' for side, y in (("left", "-0.24"), ("right", "0.24")))
    path = tmp_path / "robot.xacro"
    path.write_text(
        robot('<xacro:include filename="parts.xacro"/>', calls).replace("<robot", f"<robot {space}")
    )
    done = wmrgen_cli("lint", path)
    at = joint.index("<joint") + 2
    assert done.code == 1 and done.out.count(f"--> {parts}:2:{at}\n") == 2, done.out + done.err
    parts.write_text(parts.read_text().replace('"0 ${y} 0.1"', '"0 ${y} O"'))
    done = wmrgen_cli("import", path)
    at = joint.index("<origin", at) + 2
    assert done.code == 2 and f"--> {parts}:2:{at}\n" in done.err and "'O'" in done.err
