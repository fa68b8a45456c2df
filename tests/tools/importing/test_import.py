"""Robot descriptions to robot files: wheels by geometry, values as written, questions for what is not said.

What is expected was worked out by hand. The descriptions are written in the spirit of published ones, each with the
peculiarity that it tests.
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import Outcome
from tests.tools.importing.urdf import cylinder, joint, link, pair, robot, wheel
from wmrgen.tools.importing.robot_file import near_wheel_names

Cli = Callable[..., Outcome]
Import = Callable[..., dict[str, Any]]
SWIVEL = link("fork") + joint("swivel", "base_link", "fork", "-0.3 0 0.2", axis="0 0 1")
MESH = '<mesh filename="package://x/wheel.stl"/>'
CORNERS = {"fl": (0.3, 0.25), "fr": (0.3, -0.25), "rl": (-0.3, 0.25), "rr": (-0.3, -0.25)}


@pytest.fixture
def read(wmrgen_cli: Cli, tmp_path: Path) -> Import:
    """What `wmrgen import --json` says of a text, wheels by name."""

    def call(text: str, *options: str) -> dict[str, Any]:
        (tmp_path / "probe.urdf").write_text(text, encoding="utf-8")
        done = wmrgen_cli(
            "import", tmp_path / "probe.urdf", "-o", tmp_path / "probe.yaml", "--json", *options
        )
        assert done.code == 0, done.err
        said = json.loads(done.out)
        return {**said, "wheels": {w["name"]: w for w in said["wheels"]}, "notes": done.err}

    return call


def keys(said: dict[str, Any]) -> list[tuple[str, str]]:
    """Wheel and key of each question, but of what carries a pair of wheels that stands alone."""
    return [(q["wheel"], q["key"]) for q in said["questions"] if q["wheel"] != "support"]


def four(**by_name: str) -> str:
    return "".join(wheel(name, f"{x} {y} 0.1") + by_name.get(name, "") for name, (x, y) in CORNERS.items())


def test_a_pair_is_written_as_the_file_has_it(read: Import, wmrgen_cli: Cli, tmp_path: Path) -> None:
    said = read(robot(pair()))
    assert (said["base"], said["questions"]) == ("base_link", [])
    assert said["wheels"]["left"] == {
        "name": "left", "joint": "left_joint", "steer_joint": None, "type": "fixed", "x": 0.05, "y": 0.25,
        "heading": 0.0, "r": 0.1, "d": None, "offset_y": None, "gamma": None, "actuated": None,
    }  # fmt: skip
    lines = (tmp_path / "probe.yaml").read_text(encoding="utf-8").splitlines()
    assert "    y: 0.25" in lines
    assert "    r: 0.1   # collision cylinder of joint 'left_joint'" in lines
    assert lines.count("    heading: 0   # axis of joint 'left_joint'") == 1
    done = wmrgen_cli("derive", tmp_path / "probe.yaml", "-o", tmp_path / "out", "--json")
    assert done.code == 0 and json.loads(done.out)["robot_type"] == [2, 0]


def test_an_axis_whose_sign_differs_is_kept_and_said_to_be_reversed(read: Import, tmp_path: Path) -> None:
    right = wheel("right", "0 -0.25 0.1", axis="0 -1 0")
    said = read(robot(wheel("left", "0 0.25 0.1"), right))
    assert [w["heading"] for w in said["wheels"].values()] == [0.0, pytest.approx(math.pi)]
    remark = (
        "    heading: pi   # axis of joint 'right_joint', reversed: it rolls backward for a positive rate\n"
    )
    assert remark in (tmp_path / "probe.yaml").read_text(encoding="utf-8")


def test_decimals_are_added_not_floats(read: Import, tmp_path: Path) -> None:
    """0.1 + 0.2 is 0.3, across a rotated link and noise of a printer of floats."""
    plate = link("plate") + joint("plate", "base_link", "plate", "0.1 0 0", "fixed", rpy="0 0 1.57079632679")
    wheels = "".join(
        wheel(n, f"{y} -0.20000000000000001 0.1", parent="plate", axis="1 0 0")
        for n, y in (("a", 0.3), ("b", -0.3))
    )
    said = read(robot(plate, wheels.replace(cylinder("0.1"), '<sphere radius="0.1"/>')))
    assert "    x: 0.3 " in (tmp_path / "probe.yaml").read_text(encoding="utf-8")
    assert [w["y"] for w in said["wheels"].values()] == [0.3, -0.3]


def test_1_57_is_snapped_before_frames_are_composed(read: Import) -> None:
    """A chassis turned by 1.57 and back by -1.5708: wheels 2.8 m ahead of it must not leave the axle."""
    chassis = link("chassis") + joint("c", "base_link", "chassis", "0 0 0", "fixed", rpy="0 0 1.57")
    wheels = "".join(
        wheel(n, f"{y} -2.86 0.1", parent="chassis", axis="1 0 0", rpy="0 0 0")
        for n, y in (("a", 0.7), ("b", -0.7))
    )
    said = read(robot(chassis, wheels.replace('rpy="1.57 0 0"', 'rpy="0 1.57 0"')))
    assert [(w["x"], w["y"], w["heading"]) for w in said["wheels"].values()] == [
        (2.86, 0.7, 0.0),
        (2.86, -0.7, 0.0),
    ]


@pytest.mark.parametrize(("axis", "heading"), [("0 1 0", 0), ("0 -2 0", math.pi), ("1 0 0", -math.pi / 2)])
def test_the_sign_of_the_joint_is_kept(read: Import, axis: str, heading: float) -> None:
    """Heading is axis x z; nothing is flipped forward."""
    wheels = pair(axis=axis).replace(cylinder("0.1"), '<sphere radius="0.1"/>')
    assert {w["heading"] for w in read(robot(wheels))["wheels"].values()} == {heading}


def test_steered_castor_and_offset(read: Import, tmp_path: Path) -> None:
    castor = SWIVEL + wheel("tail", "-0.04 0 -0.1", parent="fork")
    side = link("arm") + joint("turn", "base_link", "arm", "0.5 0 0.3", axis="0 0 -1")
    said = read(robot(pair(), castor, side, wheel("front", "0 0.03 -0.2", parent="arm")))["wheels"]
    tail, front = said["tail"], said["front"]
    assert (tail["type"], tail["x"], tail["d"], tail["steer_joint"]) == ("castor", -0.3, -0.04, "swivel")
    assert (front["type"], front["x"], front["y"]) == ("steered", 0.5, 0.0)
    assert (front["d"], front["offset_y"]) == (0.0, 0.03)
    text = (tmp_path / "probe.yaml").read_text(encoding="utf-8")
    assert "type: TODO" not in text and "'turn' points down: its angle is -front.steer" in text


@pytest.mark.parametrize(("control", "type_"), [("", "castor"), ("turn", "steered")])
def test_a_small_trail_is_a_castor_unless_something_steers_it(read: Import, control: str, type_: str) -> None:
    arm = link("arm") + joint("turn", "base_link", "arm", "0.5 0 0.3", axis="0 0 1")
    names = "".join(f'<transmission><joint name="{n}"/></transmission>' for n in ("left_joint", control))
    said = read(robot(pair(), arm, wheel("front", "0.006 0 -0.2", parent="arm"), names))
    assert said["wheels"]["front"]["type"] == type_
    assert [q["key"] for q in said["questions"]] == ["type"] * (type_ == "steered")


def test_what_drives(read: Import) -> None:
    """ros2_control by its command interfaces, a plugin; one that only publishes states drives nothing."""
    control = '<ros2_control><joint name="left_joint"><command_interface name="velocity"/></joint>'
    control += '<joint name="right_joint"><state_interface name="velocity"/></joint></ros2_control>'
    states = '<gazebo><plugin filename="libjoint_state_publisher.so"><j>right_joint</j></plugin></gazebo>'
    said = read(robot(pair(), control, states))["wheels"]
    assert (said["left"]["actuated"], said["right"]["actuated"]) == (["spin"], [])
    plugin = '<gazebo><plugin filename="diff.so"><left> right_joint </left></plugin></gazebo>'
    assert read(robot(pair(), plugin))["wheels"]["right"]["actuated"] == ["spin"]
    measured = plugin.replace("</left>", "</left><encoderWheelJoint>left_joint</encoderWheelJoint>")
    assert read(robot(pair(), measured))["wheels"]["left"]["actuated"] == []


def test_a_silent_car_is_asked_what_drives_it(read: Import) -> None:
    arms = "".join(
        link(f"{n}_arm") + joint(f"{n}_turn", "base_link", f"{n}_arm", f"1 {y} 0.1", "revolute", "0 0 1",
                                 more='<limit lower="-0.6" upper="0.6"/>')
        + wheel(f"{n}_front", "0 0 0", parent=f"{n}_arm")
        for n, y in (("l", 0.25), ("r", -0.25))
    )  # fmt: skip
    said = read(robot(pair(), arms))
    assert [(q["wheel"], q["key"]) for q in said["questions"]] == [
        ("l_front", "actuated"),
        ("r_front", "actuated"),
    ]


def test_only_what_stands_on_the_ground_and_turns_level_is_a_wheel(read: Import) -> None:
    """Not: a driver's steering wheel, an arm's roll joint, a lidar, what carries moving parts, what has limits."""
    decoys = (
        wheel("steering_wheel", "0.2 0 0.9")
        + wheel("lidar", "0 0 0.1", axis="0 0 1")
        + wheel("hip", "0.3 0.1 0.1")
        + wheel("knee", "0 0 0", parent="hip_link", kind="prismatic")
        + wheel("flap", "0.3 0 0.1", kind="revolute", more='<limit lower="-7.85" upper="7.85"/>')
    )
    assert list(read(robot(pair(), decoys))["wheels"]) == ["left", "right"]


@pytest.mark.parametrize(
    ("kind", "limits"),
    [("continuous", "-1 1"), ("continuous", "0 0"), ("revolute", "-1e16 1e16"), ("revolute", "0 0")],
)
def test_limits_that_do_not_stop_a_wheel(read: Import, kind: str, limits: str) -> None:
    low, high = limits.split()
    more = f'<limit lower="{low}" upper="{high}"/>'
    assert len(read(robot(pair(kind=kind, more=more)))["wheels"]) == 2


def test_suspension_is_taken_at_zero_and_told(read: Import) -> None:
    strut = link("strut") + joint("spring", "base_link", "strut", "0.2 0.3 0", "prismatic", axis="0 0 1")
    said = read(robot(pair(), strut, wheel("sprung", "0 0 0.1", parent="strut")))
    sprung = said["wheels"]["sprung"]
    assert (sprung["type"], sprung["x"], sprung["y"], sprung["steer_joint"]) == ("fixed", 0.2, 0.3, None)
    assert "'spring' moves above wheels and is taken at zero" in said["notes"]


def test_the_wheel_is_where_its_largest_cylinder_is(read: Import) -> None:
    """Off the joint along the axle; a smaller hub, a visual and what is not coaxial do not count."""
    body = '<link name="odd">' + "".join(
        f'<{role}><origin xyz="{xyz}" rpy="{rpy}"/><geometry>{cylinder(r)}</geometry></{role}>'
        for role, xyz, rpy, r in (
            ("visual", "0 0 0", "1.5708 0 0", "0.5"), ("collision", "0 0 0", "1.5708 0 0", "0.04"),
            ("collision", "0 0.045 0", "1.5708 0 0", "0.1"), ("collision", "0 0 0", "0 0 0", "0.3"),
        )
    ) + "</link>"  # fmt: skip
    odd = read(robot(pair(), body, joint("odd", "base_link", "odd", "-0.2 0.3 0.1")))["wheels"]["odd"]
    assert (odd["y"], odd["r"]) == (0.345, 0.1)


def test_the_middle_of_two_sides_is_the_wheels(read: Import) -> None:
    """A wheel of two plates, as many with rollers are drawn."""
    plates = "".join(
        f'<collision><origin xyz="0 {y} 0" rpy="1.57 0 0"/><geometry>{cylinder("0.1")}</geometry></collision>'
        for y in (0.03, -0.02)
    )
    one = pair().replace('<link name="left_link">', f'<link name="left_link">{plates}', 1)
    own = link("", cylinder("0.1")).removeprefix('<link name="">').removesuffix("</link>")
    assert read(robot(one.replace(f"{plates}{own}", plates)))["wheels"]["left"]["y"] == pytest.approx(0.255)


def test_joints_that_move_all_of_a_robot_stand_above_its_frame(read: Import) -> None:
    """Simulators push robots about by two that slide and one that turns."""
    slides = joint("sx", "world", "x", "0 0 0", "prismatic", "1 0 0") + joint(
        "sy", "x", "y", "0 0 0", "prismatic"
    )
    turns = joint("yaw", "y", "platform", "0.3 0 0", axis="0 0 1")
    links = "".join(map(link, ("world", "x", "y"))) + link("platform", cylinder("0.3"), rpy="0 0 0")
    own = pair().replace("base_link", "platform")
    said = read(f'<robot name="probe">{links}{slides}{turns}{own}</robot>')
    assert said["base"] == "platform" and "taken at zero" not in said["notes"]
    assert {(w["type"], w["x"]) for w in said["wheels"].values()} == {("fixed", 0.05)}


def test_a_robot_fixed_to_the_world_has_a_frame_of_its_own(read: Import) -> None:
    stand = link("world") + joint("stand", "world", "trunk", "3 1 0.2", "fixed", rpy="0 0 1")
    own = pair().replace("base_link", "trunk")
    said = read(f'<robot name="probe">{link("trunk")}{stand}{own}</robot>')
    assert said["base"] == "trunk" and said["wheels"]["left"]["y"] == 0.25


def test_a_mesh_leaves_the_radius_open(read: Import, wmrgen_cli: Cli, tmp_path: Path) -> None:
    foot = link("a_base_footprint") + joint("foot", "a_base_footprint", "base_link", "0 0 0", "fixed")
    said = read(robot(pair(geometry=MESH), foot))
    assert said["base"] == "base_link" and said["wheels"]["left"]["r"] is None
    assert keys(said) == [("left", "r"), ("right", "r")]
    assert said["questions"][0]["hints"] == [
        "the axle is 0.1 m above a_base_footprint, which may be the ground"
    ]
    path = tmp_path / "probe.yaml"
    done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
    assert done.code == 2 and "r is an open question" in done.err
    assert not (tmp_path / "out").exists()
    text = path.read_text(encoding="utf-8").replace("r: TODO", "r: 0.1")
    path.write_text(text[: text.index("  - name: support")], encoding="utf-8")
    assert wmrgen_cli("derive", path, "-o", tmp_path / "out").code == 0


def friction(name: str, direction: str, where: str = ' expressed_in="base_link"') -> str:
    return f'<gazebo reference="{name}_link"><mu1>1.0</mu1><mu2>0</mu2><fdir1{where}>{direction}</fdir1></gazebo>'


def test_gamma_is_the_direction_of_full_friction(read: Import) -> None:
    directions = {"fl": "1 -1 0", "fr": "1 1 0", "rl": "1 1 0", "rr": "-1 1 0"}
    wheels = four(**{name: friction(name, d) for name, d in directions.items()})
    said = read(robot(wheels))
    assert said["questions"] == [] and {w["type"] for w in said["wheels"].values()} == {"swedish"}
    assert [said["wheels"][n]["gamma"] * 4 / math.pi for n in CORNERS] == pytest.approx([-1, 1, 1, -1])


@pytest.mark.parametrize("why", ["plugin", "turning fdir1"])
def test_gamma_is_never_guessed(read: Import, wmrgen_cli: Cli, tmp_path: Path, why: str) -> None:
    plugin = '<gazebo><plugin filename="libmecanum.so" name="drive"/></gazebo>'
    turning = four(**{name: friction(name, "1 -1 0", "") for name in CORNERS})
    said = read(robot(four() + plugin if why == "plugin" else turning))
    assert {(w["type"], w["gamma"]) for w in said["wheels"].values()} == {("swedish", None)}
    assert [q["key"] for q in said["questions"]] == ["gamma"] * 4
    path = tmp_path / "probe.yaml"
    assert wmrgen_cli("derive", path, "-o", tmp_path / "out").code == 2
    text = path.read_text(encoding="utf-8")
    for sign in ("-", "", "", "-"):
        text = text.replace("gamma: TODO", f"gamma: {sign}pi/4", 1)
    path.write_text(text, encoding="utf-8")
    done = wmrgen_cli("derive", path, "-o", tmp_path / "out", "--json")
    assert json.loads(done.out)["robot_type"] == [3, 0]


def test_rollers_in_the_file_say_gamma(read: Import) -> None:
    """Six rollers on the rim: the axis of the lowest, at the ground. They are no wheels themselves. Of those that have
    their origins on the axle none is the lowest."""
    rollers = ""
    for k in range(6):
        a = math.pi * k / 3
        rollers += link(f"r{k}") + joint(f"r{k}", "third_link", f"r{k}", f"{0.1 * math.cos(a)} 0 {0.1 * math.sin(a)}",
                                         axis=f"{-math.sin(a)} 0 {math.cos(a)}")  # fmt: skip
    rollers = rollers.replace(f"0 {0.1 * math.sin(4 * math.pi / 3)}", "0 -0.101")  # the lowest of the six
    said = read(robot(pair(), wheel("third", "-0.3 0 0.1"), rollers))
    assert list(said["wheels"]) == ["left", "right", "third"]
    third = said["wheels"]["third"]
    assert third["type"] == "swedish" and third["gamma"] == pytest.approx(0, abs=1e-9)
    for place in ("0 0 0", "0 0.02 0", "1e-17 0.02 1e-4"):  # as frames that turn round it
        centred = re.sub(r'(<child link="r\d"/><origin xyz=)"[^"]*"', rf'\1"{place}"', rollers)
        said = read(robot(pair(), wheel("third", "-0.3 0 0.1"), centred))
        assert said["wheels"]["third"]["gamma"] is None and ("third", "gamma") in keys(said)


def test_meshes_stand_beside_wheels_that_are_drawn(read: Import) -> None:
    """A car whose rear wheels are cylinders and whose front wheels are meshes; its bumper turns at the ground."""
    rear = "".join(
        wheel(f"r{side}", f"0 {y} 0.33", cylinder("0.34")) for side, y in (("l", 0.7), ("r", -0.7))
    )
    front = "".join(
        link(f"s{side}")
        + joint(f"s{side}", "base_link", f"s{side}", f"2.5 {y} 0.33", kind="revolute", axis="0 0 1")
        + wheel(f"f{side}", "0 0 0", MESH, parent=f"s{side}")
        for side, y in (("l", 0.7), ("r", -0.7))
    )
    bumper = wheel("bumper", "0 0 0", MESH, axis="1 0 0")
    said = read(robot(rear, front, bumper, wheel("lever", "0.5 0 1", MESH)))
    assert {n: w["type"] for n, w in said["wheels"].items()} == dict.fromkeys(
        ("rl", "rr"), "fixed"
    ) | dict.fromkeys(("fl", "fr"), "steered")


@pytest.mark.parametrize(("height", "stands"), [("0.15", True), ("0.151", False), ("0.5", False)])
def test_a_mesh_is_a_wheel_where_its_axle_is_no_higher_than_the_largest_wheel_reaches(
    read: Import, height: str, stands: bool
) -> None:
    """Beside wheels of 0.1 m; 0.05 m more, for one that is a little larger."""
    said = read(robot(pair(), wheel("drawn", f"0.5 0 {height}", MESH)))
    assert ("drawn" in said["wheels"]) == stands


def test_rigid_wheels_beside_wheels_that_turn_are_asked_about(read: Import) -> None:
    """A car of which only the front wheels turn. A castor, a smaller wheel and a tyre are none."""
    rear = "".join(
        wheel(f"r{side}_wheel", f"-0.6 {y} 0.1", kind="fixed", axis="")
        for side, y in (("l", 0.25), ("r", -0.25))
    )
    castor = wheel("castor_wheel", "-0.9 0 0.1", kind="fixed", axis="")
    small = wheel("small_wheel", "-0.7 0 0.03", cylinder("0.03"), kind="fixed", axis="")
    tyre = wheel("tyre_wheel", "0 0.2 0", parent="left_link", kind="fixed", axis="")
    said = read(robot(pair(), rear, castor, small, tyre))
    assert list(said["wheels"]) == ["left", "right", "rl", "rr"]
    assert [(q["wheel"], q["key"]) for q in said["questions"][:2]] == [("rl", "type"), ("rr", "type")]


def test_a_wheel_drawn_too_small_stands_where_its_mirror_image_does(read: Import) -> None:
    """Its radius and whether it is a wheel are asked: the drawing is wrong somewhere."""
    small = wheel("tiny", "-0.3 0.25 0.1", cylinder("0.01")) + wheel("large", "-0.3 -0.25 0.1")
    said = read(robot(pair(), small, wheel("lever", "-0.3 0.1 0.1", cylinder("0.01"))))
    assert list(said["wheels"]) == ["left", "right", "tiny", "large"]
    assert said["wheels"]["tiny"]["r"] is None
    assert {q["key"] for q in said["questions"] if q["wheel"] == "tiny"} == {"type", "r", "actuated"}


def test_three_axles_that_meet_are_omni_wheels_with_a_question(read: Import) -> None:
    turns = (0.0, 2 * math.pi / 3, -2 * math.pi / 3)
    axes = [(math.cos(a), math.sin(a)) for a in turns]
    wheels = "".join(
        wheel(f"w{k}", f"{0.2 * x} {0.2 * y} 0.1", geometry=MESH, axis=f"{x} {y} 0")
        for k, (x, y) in enumerate(axes)
    )
    said = read(robot(wheels))
    assert {w["type"] for w in said["wheels"].values()} == {"swedish"}
    assert [w["heading"] for w in said["wheels"].values()] == pytest.approx(
        [-math.pi / 2, math.pi / 6, 5 * math.pi / 6]
    )
    assert {key for _, key in keys(said)} == {"gamma", "r"}


def test_wheels_on_fixed_joints_are_asked_about(read: Import) -> None:
    said = read(robot(pair(kind="fixed", axis="").replace("left", "left_hub").replace("right", "right_hub")))
    assert [(w["joint"], w["heading"], w["r"]) for w in said["wheels"].values()] == [(None, 0.0, 0.1)] * 2
    assert [key for _, key in keys(said)] == ["type", "type"]
    drawn = "".join(
        link(f"{n}_hub", cylinder("0.1"), xyz=f"0.2 {y} 0")
        + joint(n, "base_link", f"{n}_hub", "0 0 0.1", "fixed", axis="")
        for n, y in (("left", 0.25), ("right", -0.25))
    )  # away from their joints
    assert {(w["x"], w["y"], w["r"]) for w in read(robot(drawn))["wheels"].values()} == {
        (0.2, y, 0.1) for y in (0.25, -0.25)
    }
    rollers = "swedish, with gamma, where it has rollers"
    assert said["questions"][0]["hints"] == ["fixed, where it is one", rollers]


def test_a_fixed_joint_with_an_axis_alone_is_no_wheel(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """Those of cameras have one in many files."""
    cameras = "".join(
        link(n) + joint(n, "base_link", n, "0 0 0.3", "fixed") for n in ("left_eye", "right_eye")
    )
    (tmp_path / "probe.urdf").write_text(robot(cameras), encoding="utf-8")
    done = wmrgen_cli("import", tmp_path / "probe.urdf")
    assert done.code == 2 and "0 joints are wheels" in done.err


@pytest.mark.parametrize(
    ("this", "that", "note"),
    [
        ('rpy="1.57 0 0"', 'rpy="90 0 0"', "rpy is '90 0 0', in radians more than a turn; degrees were likely meant"),
        ('radius="0.1"', 'radius="-0.1"', "link 'left_link': collision: a radius of -0.1 is not read"),
        ('<parent link="base_link"/><child link="tail', '<child link="tail', "'tail' has no <parent>, and is not read"),
    ],
)  # fmt: skip
def test_slips_are_noted(read: Import, this: str, that: str, note: str) -> None:
    text = robot(pair(), link("tail"), joint("tail", "base_link", "tail", "-0.3 0 0.1"))
    assert text != (slip := text.replace(this, that)) and note in read(slip)["notes"]
    right = "7.853981633974483 0 0"  # a quarter more than a turn
    assert "more than a turn" not in read(text.replace("1.57 0 0", right))["notes"]


def test_a_file_of_two_bytes_to_a_character_is_shown(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """As Windows writes what another program prints."""
    path = tmp_path / "wide.urdf"
    text = robot(pair()).replace("0.05 0.25", "0.05 O").replace("><", ">\n<")
    path.write_bytes(text.encode("utf-16"))
    done = wmrgen_cli("import", path)
    assert done.code == 2 and '<origin xyz="0.05 O 0.1"' in done.err


def test_a_cylinder_across_the_axle_is_a_hint(read: Import) -> None:
    said = read(robot(pair().replace('rpy="1.57 0 0"', 'rpy="0 1.57 0"')))
    hints = [q["hints"] for q in said["questions"] if q["key"] == "r"]
    assert hints == [["0.1 by a collision cylinder, which does not lie along the axle"]] * 2


def test_a_missing_axis_is_asked_about(read: Import) -> None:
    """1 0 0 by the rules of URDF, across the cylinder's, whose axis is taken till then, also where 1 0 0 is upright;
    one of which nothing is drawn; and a swivel without one, which would roll."""
    for rpy in ("0 0 0", "0 1.5707963268 0"):
        said = read(robot(pair(), wheel("odd", "-0.2 0 0.1", axis="", rpy=rpy)))
        assert said["wheels"]["odd"]["heading"] == 0.0
        assert ("odd", "heading") in keys(said)
    said = read(robot(pair(), link("bare"), joint("bare", "base_link", "bare", "-0.2 0 0.05", axis="")))
    assert {w["type"] for w in said["wheels"].values()} == {"fixed"} and ("bare", "heading") in keys(said)
    silent = SWIVEL.replace('<axis xyz="0 0 1"/>', "")
    lying = silent.replace('rpy="0 0 0"', 'rpy="1.5707963268 0 0"')  # its z axis is level
    assert silent != lying
    for swivel, at, axis in ((silent, "-0.04 0 -0.1", "0 1 0"), (lying, "-0.04 -0.1 0", "0 0 -1")):
        body = wheel("tail", at, "<sphere radius='0.1'/>", parent="fork", axis=axis)
        said = read(robot(pair(), swivel + body))
        assert (said["wheels"]["tail"]["type"], said["wheels"]["tail"]["d"]) == ("castor", -0.04)
        assert [(q["wheel"], q["key"]) for q in said["questions"]] == [("tail", "type")]
        assert "moves above wheels" not in said["notes"]


@pytest.mark.parametrize(("kind", "axis"), [("fixed", ""), ("revolute", "0 0 1")])
def test_the_base_link_of_a_hand_is_none_of_the_robot(read: Import, kind: str, axis: str) -> None:
    """One that moves and carries little is an arm's. Beside the root a small one may be the robot's frame."""
    frame = link("hand_base_link") + joint("wrist", "trunk", "hand_base_link", "0.4 0 1", kind, axis)
    wheels = pair().replace('"base_link"', '"trunk"')
    base = read(f'<robot name="probe">{link("trunk")}{frame}{wheels}</robot>')["base"]
    assert base == ("trunk" if kind == "revolute" else "hand_base_link")


@pytest.mark.parametrize(("root", "base"), [("base_footprint", "base_footprint"), ("cad", "base_link")])
def test_a_base_link_upside_down_in_the_frame_of_the_ground_is_no_base(
    read: Import, root: str, base: str
) -> None:
    """x forward, y right, z down, as in ships; other roots say as little of what is up."""
    foot = link(root) + joint("foot", root, "base_link", "0 0 0.1", "fixed", rpy="3.14159265 0 0")
    said = read(robot(foot, wheel("left", "0 -0.2 0"), wheel("right", "0 0.2 0")))
    side = -1 if base == "base_link" else 1
    assert said["base"] == base and said["wheels"]["left"]["y"] == side * 0.2


@pytest.mark.parametrize("count", [0, 2])
@pytest.mark.parametrize(("root", "base"), [("odom", "odom"), ("cad", "base_link")])
def test_links_between_ground_and_base_change_no_frame(
    read: Import, root: str, base: str, count: int
) -> None:
    """It is the root of all, not the link next to it, that says what is up; whichever joint turns it over."""
    names = [root, *(f"mount{k}" for k in range(count)), "base_link"]
    over = "3.14159265 0 0"
    for turned in range(len(names) - 1):
        chain = "".join(
            link(above) + joint(f"j{k}", above, below, "0 0 0", "fixed", rpy=over if k == turned else "0 0 0")
            for k, (above, below) in enumerate(pairwise(names))
        )
        assert read(robot(chain, wheel("left", "0 -0.2 0"), wheel("right", "0 0.2 0")))["base"] == base


def test_the_frame_of_a_robot_that_moves_in_its_world_is_its_base_link(read: Import) -> None:
    world = link("world") + joint("slide", "world", "base_link", "1 2 3", "prismatic", axis="1 0 0")
    assert read(robot(pair(), world))["base"] == "base_link"


def test_base_is_the_callers_choice(read: Import) -> None:
    deck = link("deck") + joint("deck", "base_link", "deck", "0.05 0 0.4", "fixed", rpy="0 0 3.14159265")
    said = read(robot(pair(), deck), "--base", "deck")
    assert (said["base"], said["wheels"]["left"]["y"], said["wheels"]["left"]["heading"]) == (
        "deck",
        -0.25,
        math.pi,
    )


def test_hyphens_in_comments_are_no_harm(read: Import, wmrgen_cli: Cli, tmp_path: Path) -> None:
    """XML forbids --, and the readers of simulators do not; what is no XML is told at its own line."""
    comment = "<!--\nrun with --levels\n-->"
    assert list(read(robot(comment + pair()))["wheels"]) == ["left", "right"]
    path = tmp_path / "broken.urdf"
    path.write_text(f"<robot name='a'>\n{comment}\n<link name='b'>\n</robot>\n", encoding="utf-8")
    done = wmrgen_cli("import", path)
    assert done.code == 2 and done.err.splitlines()[1] == f" --> {path}:6:3"


def test_mimic_one_to_one_is_a_coupling(read: Import, tmp_path: Path) -> None:
    read(
        robot(
            pair().replace("</joint>", "</joint>", 1)
            + wheel("back", "-0.3 0.25 0.1", more='<mimic joint="left_joint"/>')
        )
    )
    assert "  - {equal: [left.spin, back.spin]}" in (tmp_path / "probe.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        (pair() + wheel("left", "0.3 0 0.1").replace('"left_link"', '"again_link"'), "several joints have this name"),
        (pair() + joint("second", "right_link", "left_link", "0 0 0"), "has a parent already"),
        (pair() + link("deck") + joint("deck", "base_link", "deck", "", "fixed"), "xyz is empty"),
        (pair().replace('<origin xyz="0.05 0.25', '<origin xzy="1 1 1" xyz="0.05 0.25'), "'xzy'"),
        (pair() + '<gazebo reference="left_link"><fdir1>0 1 0"</fdir1></gazebo>', "this fdir1 is not read"),
        (pair() + '<mobile type="x"/>' + joint("odd", "base_link", "o", "0 0 0", "screw") + link("o"), "'screw'"),
    ],
)  # fmt: skip
def test_mistakes_in_files_are_told_and_do_not_stop(read: Import, parts: str, words: str) -> None:
    assert words in read(robot(parts))["notes"] and words not in read(robot(pair()))["notes"]


def test_a_radius_of_next_to_nothing_is_none(read: Import) -> None:
    said = read(robot(pair()).replace('radius="0.1"', 'radius="1e-9999"'))
    assert [w["r"] for w in said["wheels"].values()] == [None, None]
    beside = read(robot(pair().replace("0.05 ", "-1e-9999 ")))
    assert [w["x"] for w in beside["wheels"].values()] == [0, 0]


LAUGHS = '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;">]><robot name="&b;"/>'
OUTSIDE = '<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/hostname">]><robot name="&a;"/>'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not XML"),
        ("<robot>", "not XML"),
        (LAUGHS, "document type"),
        (OUTSIDE, "document type"),
        ('<sdf version="1.6"/>', "no model of it has a joint"),
        ("<html/>", "not <robot> or <sdf>"),
        ('<robot name="empty"/>', "has no link"),
        (robot(), "0 joints are wheels"),
        (robot(wheel("left", "0 0 0.1")), "'left_joint' alone is a wheel"),
        (robot(pair()).replace('radius="0.1"', 'radius="1e99"'), "too large"),
        (robot(pair()).replace('radius="0.1"', 'radius="1e999999999"'), "not a number"),
        (robot(pair()).replace('radius="0.1"', 'radius="__import__(1)"'), "not a number"),
        (robot(pair()).replace('"0.05 0.25 0.1"', '"0.05 0.25"'), "three numbers"),
        (robot(pair(), joint("lost", "base_link", "nowhere", "0 0 0")), "no link 'nowhere'"),
        (robot(link("a"), link("b"), joint("a", "a", "b", "0 0 0"), joint("b", "b", "a", "0 0 0")), "circle"),
        (robot(pair(more='<mimic joint="left_joint"/>')), "mimics itself"),
        (robot(wheel("a", "0 1 0.1", more='<mimic joint="b_joint"/>'),
               wheel("b", "0 -1 0.1", more='<mimic joint="a_joint"/>')), "mimics itself"),
        (robot("<a>" * 70 + "</a>" * 70), "deeper than 64"),
        (robot("<a/>" * 100_001), "100000 elements"),
        (robot(" " * 4_200_000), "larger than 4 MiB"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_refused_and_nothing_written(
    wmrgen_cli: Cli, tmp_path: Path, text: str, words: str
) -> None:
    (tmp_path / "probe.urdf").write_text(text, encoding="utf-8")
    done = wmrgen_cli("import", tmp_path / "probe.urdf", "-o", tmp_path / "probe.yaml")
    assert (done.code, done.out) == (2, "") and words in done.err, done.err
    assert not (tmp_path / "probe.yaml").exists()


@pytest.mark.parametrize("options", [("--base", "no"), ("--package", "x"), ("a=1",), ("a:=1",)])
def test_bad_words(wmrgen_cli: Cli, tmp_path: Path, options: tuple[str, ...]) -> None:
    (tmp_path / "probe.urdf").write_text(robot(pair()), encoding="utf-8")
    assert wmrgen_cli("import", tmp_path / "probe.urdf", *options).code == 2


def test_names_of_the_file_stay_in_their_comments(read: Import, tmp_path: Path) -> None:
    """A line end in a name does not end its comment; the file is read all the same."""
    read(robot(pair().replace("left_joint", "left&#10;evil: [&#x202e;"), name="a&#10;b"))
    text = (tmp_path / "probe.yaml").read_text(encoding="utf-8")
    assert "\nevil" not in text and "\u202e" not in text and "\nname: a_b\n" in text


@pytest.mark.parametrize("before", ["\n", "  \n\n", "<!-- a licence -->\n"])
def test_what_stands_before_the_declaration_is_read_over_and_places_stay(
    read: Import, wmrgen_cli: Cli, tmp_path: Path, before: str
) -> None:
    text = before + robot(pair())
    assert list(read(text)["wheels"]) == ["left", "right"]
    (tmp_path / "probe.urdf").write_text(
        text.replace("0.05 0.25 0.1", "0.05, 0.25, 0.1", 1), encoding="utf-8"
    )
    done = wmrgen_cli("import", tmp_path / "probe.urdf")
    assert done.code == 2 and f"probe.urdf:{1 + before.count(chr(10))}:" in done.err
    assert "'0.05,' is not a number" in done.err and "separated by spaces" in done.err


@pytest.mark.parametrize(
    ("joints", "names"),
    [
        (("rear-left_joint", "rear/right wheel"), ["rear_left", "rear_right"]),
        (("frontLeftWheelJoint", "frontRightWheelJoint"), ["frontLeft", "frontRight"]),
        (("FL_JOINT", "fl_joint"), ["FL", "fl_2"]),
        (("2_joint", "while_joint"), ["wheel_1", "while_2"]),
        (("vorne_links_aber_mit_einem_sehr_langen_namen_1", "vorne_links_aber_mit_einem_sehr_langen_namen_2"),
         ["namen_1", "namen_2"]),
    ],
)  # fmt: skip
def test_names_are_as_near_to_the_files_as_they_may_be(
    read: Import, joints: tuple[str, str], names: list[str]
) -> None:
    """Letters may be lowered where capital ones are no names."""
    parts = pair().replace('"left_joint"', f'"{joints[0]}"').replace('"right_joint"', f'"{joints[1]}"')
    said = list(read(robot(parts))["wheels"])
    assert [n.lower() for n in said] == [n.lower() for n in names]
    assert said == names or said == [n.lower() for n in names]


def test_a_file_that_is_not_there(wmrgen_cli: Cli, tmp_path: Path) -> None:
    assert wmrgen_cli("import", tmp_path / "none.urdf").code == 2


def test_an_upright_wheel_below_a_steering_joint_is_asked_about(read: Import) -> None:
    arm = link("arm") + joint("turn", "base_link", "arm", "0.5 0 0.1", axis="0 0 1")
    said = read(robot(pair(), arm, wheel("front", "0 0 0", parent="arm", axis="0 0 1")))
    front = said["wheels"]["front"]
    assert (front["type"], front["x"], front["heading"], front["r"]) == ("steered", 0.5, 0.0, None)
    assert {"heading", "r"} <= {q["key"] for q in said["questions"]}


def test_a_wheel_that_only_steers_is_no_silence(read: Import) -> None:
    """A limited upright joint that carries a wheel fixed to it: found, and asked about. One in the air is none."""
    steered = wheel(
        "front", "0.5 0 0.1", kind="revolute", axis="0 0 1", more='<limit lower="-0.6" upper="0.6"/>'
    )
    mast = steered.replace("front", "mast").replace("0.5 0 0.1", "0 0 0.9")
    said = read(robot(pair(), steered, mast))
    front = said["wheels"]["front"]
    assert list(said["wheels"]) == ["left", "right", "front"]
    assert (front["joint"], front["steer_joint"], front["type"]) == (None, "front_joint", "steered")
    assert (front["x"], front["heading"], front["r"], front["d"]) == (0.5, 0.0, 0.1, 0.0)
    assert ("front", "type") in [(q["wheel"], q["key"]) for q in said["questions"]]


@pytest.mark.parametrize(
    ("shape", "height", "asked"), [("sphere", "0.098", 2), ("sphere", "0.0995", 0), ("cylinder", "0.098", 0)]
)
def test_a_sphere_and_a_height_that_differ_are_asked_about(
    read: Import, tmp_path: Path, shape: str, height: str, asked: int
) -> None:
    wheels = pair().replace("cylinder", shape).replace('0.25 0.1"', f'0.25 {height}"')
    said = read(robot(wheels))
    assert [key for _, key in keys(said)] == ["r"] * asked
    assert {w["r"] for w in said["wheels"].values()} == {0.1}
    text = (tmp_path / "probe.yaml").read_text(encoding="utf-8")
    assert ("the axle is 0.098 m above" in text) == (height == "0.098")


def test_a_hub_is_driven_by_the_fixed_joint_that_carries_it(read: Import) -> None:
    rims = "".join(
        link(f"{n}_rim") + joint(f"{n}_rim", "base_link", f"{n}_rim", f"0 {y} 0.1", "fixed", axis="")
        + wheel(f"{n}_hub", "0 0 0", parent=f"{n}_rim", kind="fixed", axis="")
        for n, y in (("left", 0.2), ("right", -0.2))
    )  # fmt: skip
    plugin = '<gazebo><plugin filename="diff.so"><a>left_rim</a><b>right_rim</b></plugin></gazebo>'
    assert [w["actuated"] for w in read(robot(rims, plugin))["wheels"].values()] == [["spin"], ["spin"]]


def test_without_the_packages_that_read(
    wmrgen_cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "defusedxml.common", None)
    (tmp_path / "probe.urdf").write_text(robot(pair()), encoding="utf-8")
    done = wmrgen_cli("import", tmp_path / "probe.urdf")
    assert done.code == 4 and "pip install 'wmrgen[import]'" in done.err


def test_of_names_that_are_too_long_the_words_of_all_are_left_out_but_one() -> None:
    long = "_".join(["part"] * 10)
    assert near_wheel_names([long]) == ["part"] and near_wheel_names([long, f"{long}_two"]) == [
        "part",
        "part_two",
    ]
