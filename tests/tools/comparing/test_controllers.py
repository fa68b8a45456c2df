"""Controllers that drive a robot wrongly are found by the commands of their joints, whatever their lengths are.

Each robot and each controller is a small input; a test names the code, the joint, and the numbers of the wrong command.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import Outcome
from wmrgen.derivation.emit import artifacts
from wmrgen.tools.comparing.compare import compare
from wmrgen.tools.comparing.record import Comparison
from wmrgen.tools.comparing.sources import layouts
from wmrgen.tools.controllers.record import Distro

DD = """limits: {vx: 1.0, omega: 2.0}
wheels:
  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
"""
FRONT = """wheels:
  - {name: rear_left, type: fixed, x: 0, y: 0.39, heading: 0, r: 0.18}
  - {name: rear_right, type: fixed, x: 0, y: -0.39, heading: 0, r: 0.18}
  - {name: front_left, type: steered, x: 1.5, y: 0.46, heading: 0, r: 0.18, actuated: [steer]}
  - {name: front_right, type: steered, x: 1.5, y: -0.46, heading: 0, r: 0.18, actuated: [steer]}
"""
TRUCK = """wheels:
  - {name: front_left, type: fixed, x: 0, y: 0.39, heading: 0, r: 0.18}
  - {name: front_right, type: fixed, x: 0, y: -0.39, heading: 0, r: 0.18}
  - {name: rear_left, type: steered, x: -1.5, y: 0.39, heading: 0, r: 0.18, actuated: [steer]}
  - {name: rear_right, type: steered, x: -1.5, y: -0.39, heading: 0, r: 0.18, actuated: [steer]}
"""
OMNI = """wheels:
  - {name: a, type: swedish, l: 0.2, alpha: 60 deg, beta: 0, r: 0.05}
  - {name: b, type: swedish, l: 0.2, alpha: 180 deg, beta: 0, r: 0.05}
  - {name: c, type: swedish, l: 0.2, alpha: -60 deg, beta: 0, r: 0.05}
"""
CORNERS = {"front_left": (1, 1), "front_right": (1, -1), "rear_left": (-1, 1), "rear_right": (-1, -1)}


def mecanum(sign: int = 1, x: float = 0.0) -> str:
    """A mecanum robot whose rollers form an O at the ground, with ``sign`` -1 an X; ``x``: its middle [m]."""
    lines = ["wheels:"]
    for name, (a, b) in CORNERS.items():
        place = f"x: {x + a * 0.2:g}, y: {b * 0.15:g}, heading: 0, r: 0.05"
        lines.append(f"  - {{name: {name}, type: swedish, {place}, gamma: {-45 * a * b * sign} deg}}")
    return "\n".join(lines) + "\n"


def controller(type_: str, *parameters: str) -> str:
    name = "".join(part.title() for part in type_.split("_"))
    lines = ["base:", "  ros__parameters:", f"    type: {type_}/{name}", *(f"    {p}" for p in parameters)]
    return "\n".join(lines) + "\n"


def diff(left: str = "left_spin", right: str = "right_spin", *more: str) -> str:
    names = (f"left_wheel_names: [{left}]", f"right_wheel_names: [{right}]")
    return controller("diff_drive_controller", *names, "wheel_separation: 0.4", "wheel_radius: 0.1", *more)


def ackermann(traction: str, steering: str, *more: str) -> str:
    """An Ackermann controller in the names of Humble, its traction axle behind."""
    return controller(
        "ackermann_steering_controller",
        "front_steering: true",
        f"rear_wheels_names: [{traction}]",
        f"front_wheels_names: [{steering}]",
        *(more or LENGTHS),
    )


NAMES = ("rear_wheels_names", "front_wheels_names")
LENGTHS = (
    "wheelbase: 1.5",
    "front_wheel_track: 0.92",
    "rear_wheel_track: 0.78",
    "front_wheels_radius: 0.18",
    "rear_wheels_radius: 0.18",
)
TRACTION, STEERING = "rear_right_spin, rear_left_spin", "front_right_steer, front_left_steer"


def mecanum_controller(*more: str) -> str:
    names = [f"{corner}_wheel_command_joint_name: {corner}_spin" for corner in CORNERS]
    sizes = "wheels_radius: 0.05, sum_of_robot_center_projection_on_X_Y_axis: 0.35"
    kinematics = ", ".join((sizes, *more))
    return controller("mecanum_drive_controller", *names, f"kinematics: {{{kinematics}}}")


def omni(names: str, offset: float) -> str:
    return controller(
        "omni_wheel_drive_controller",
        f"wheel_names: [{names}]",
        f"wheel_offset: {offset}",
        "robot_radius: 0.2",
        "wheel_radius: 0.05",
    )


def written(folder: Path, robot: str, parameters: str) -> tuple[Path, Path]:
    first, second = folder / "robot.yaml", folder / "controllers.yaml"
    first.write_text(f"wmrgen: 1\nname: tried\n{robot}", encoding="utf-8")
    second.write_text(parameters, encoding="utf-8")
    return first, second


def compared(folder: Path, robot: str, parameters: str, distro: Distro | None = None) -> Comparison:
    first, second = written(folder, robot, parameters)
    (a,), (b,) = layouts(first), layouts(second, distro=distro)
    return compare(a, b)


RIGHT = {
    "differential": (DD, diff()),
    "differential, radius by a multiplier": (DD, diff().replace("radius: 0.1", "radius: 0.2")
                                             + "    left_wheel_radius_multiplier: 0.5\n"
                                             + "    right_wheel_radius_multiplier: 0.5\n"),
    "ackermann": (FRONT, ackermann(TRACTION, STEERING)),
    "mecanum": (mecanum(), mecanum_controller()),
    "mecanum, origin elsewhere": (mecanum(x=0.1), mecanum_controller("base_frame_offset: {x: -0.1}")),
    "omni": (OMNI, omni("a_spin, b_spin, c_spin", math.pi / 3)),
    "omni, from another wheel": (OMNI, omni("b_spin, c_spin, a_spin", math.pi)),
}  # fmt: skip


@pytest.mark.parametrize("case", RIGHT)
def test_a_right_controller_has_no_difference(case: str, tmp_path: Path) -> None:
    result = compared(tmp_path, *RIGHT[case])
    assert (result.differences, result.compared) == ((), True)
    assert [e.ratio for e in result.effects] == pytest.approx([1.0] * len(result.effects))


WRONG = {  # robot, controller -> joints or wheels with the codes of what is wrong
    "left and right exchanged": (
        DD, diff("right_spin", "left_spin"), {("WMR044", "left"), ("WMR044", "right")},
    ),
    "half the radius": (
        DD, diff() + "    wheel_radius_multiplier: 0.5\n", {("WMR042", "")},
    ),
    "steering exchanged": (
        FRONT, ackermann(TRACTION, "front_left_steer, front_right_steer"),
        {("WMR052", "front_left"), ("WMR052", "front_right")},
    ),
    "traction of the wrong axle": (
        FRONT, ackermann("front_right_spin, front_left_spin", STEERING),
        {("WMR048", f"{end}_{side}") for end in ("front", "rear") for side in ("left", "right")}
        | {("WMR044", "front_left"), ("WMR044", "front_right")},
    ),
    "rear steering": (
        TRUCK,
        ackermann("rear_right_steer, rear_left_steer", "front_right_spin, front_left_spin", "wheelbase: 1.5",
                  "front_wheel_track: 0.78", "rear_wheel_track: 0.78", "front_wheels_radius: 0.18",
                  "rear_wheels_radius: 0.18").replace("front_steering: true", "front_steering: false"),
        {("WMR052", "rear_left"), ("WMR052", "rear_right")},
    ),
    "offset of 60 degrees": (
        OMNI, omni("a_spin, b_spin, c_spin", 0.0), {("WMR052", name) for name in "abc"},
    ),
    "reversed order": (
        OMNI, omni("c_spin, b_spin, a_spin", math.pi / 3), {("WMR047", ""), ("WMR052", "a"), ("WMR052", "c")},
    ),
    "X under O": (mecanum(-1), mecanum_controller(), {("WMR052", name) for name in CORNERS}),
    "base frame turned": (
        mecanum(), mecanum_controller("base_frame_offset: {x: 0, y: 0, theta: 1.5707963}"),
        {("WMR052", name) for name in CORNERS},
    ),
    "base frame moved": (
        mecanum(), mecanum_controller("base_frame_offset: {x: 0.1, y: 0, theta: 0}"),
        {("WMR052", name) for name in CORNERS},
    ),
    "limits of five times": (
        DD, diff() + "    linear: {x: {max_velocity: 5.0, min_velocity: -1.0}}\n"
        "    angular: {z: {max_velocity: 10.0, min_velocity: -2.0}}\n", {("WMR053", "")},
    ),
    "three joints for two": (
        FRONT, ackermann(f"{TRACTION}, front_left_spin", STEERING), {("WMR048", "")},
    ),
    "a steering joint for a traction joint": (
        FRONT, ackermann("rear_right_spin, front_left_steer", STEERING),
        {("WMR048", "front_left"), ("WMR048", "rear_left")},
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_controller_is_found(case: str, tmp_path: Path) -> None:
    robot, parameters, expected = WRONG[case]
    result = compared(tmp_path, robot, parameters)
    assert {(d.code, d.wheel) for d in result.differences} == expected


def test_the_numbers_of_a_wrong_command(tmp_path: Path) -> None:
    """A rear steered wheel needs the opposite angle: atan of wheelbase times curvature, both wheels 0.39 m aside."""
    result = compared(tmp_path, *WRONG["rear steering"][:2])
    found = {d.wheel: (d.a, d.b) for d in result.differences}
    size = math.hypot(1.5, 0.78)
    tight = math.atan(1.5 / (4 * size - 0.39))
    for needed, commanded in found.values():
        assert isinstance(needed, float) and isinstance(commanded, float)
        assert commanded == pytest.approx(-needed) and abs(needed) == pytest.approx(tight)
    limits = compared(tmp_path, *WRONG["limits of five times"][:2]).differences
    assert [(d.a, d.b) for d in limits] == [(1.0, 5.0), (2.0, 10.0)]


def test_releases_differ_in_names_and_formula(tmp_path: Path) -> None:
    """Kilted has no `front_wheels_names`; Humble steers by the track of the traction wheels."""
    robot, parameters = RIGHT["ackermann"]
    assert compared(tmp_path, robot, parameters, "jazzy").differences == ()
    humble = compared(tmp_path, robot, parameters, "humble").differences
    assert {(d.code, d.wheel) for d in humble} == {("WMR052", "front_left"), ("WMR052", "front_right")}
    for distro in ("kilted", "rolling"):
        differences = compared(tmp_path, robot, parameters, distro).differences
        assert {d.code for d in differences} == {"WMR054"}
        assert {d.b for d in differences} == {line.split(":")[0] for line in (*NAMES, *LENGTHS)} - {
            "wheelbase"
        }


def test_joint_names_that_the_robot_lacks_are_not_compared(tmp_path: Path) -> None:
    result = compared(tmp_path, DD, diff("joint_1", "joint_2"))
    assert result.differences == () and result.compared
    assert any("joint_1, joint_2" in words for words in result.unsaid)
    exchanged = compared(tmp_path, DD, diff("base_right_wheel_joint", "base_left_wheel_joint"))
    assert {(d.code, d.wheel) for d in exchanged.differences} == {("WMR052", "left"), ("WMR052", "right")}


def test_a_length_of_other_software_does_not_hide_exchanged_joints(tmp_path: Path) -> None:
    parameters = ackermann(TRACTION, "front_left_steer, front_right_steer") + "    robot_radius: 0.5\n"
    codes = {(d.code, d.wheel) for d in compared(tmp_path, FRONT, parameters).differences}
    assert codes >= {("WMR052", "front_left"), ("WMR052", "front_right")}


def test_a_generated_header_has_the_joints_of_its_robot(tmp_path: Path) -> None:
    robot, parameters = WRONG["reversed order"][:2]
    first, second = written(tmp_path, robot, parameters)
    header = tmp_path / "tried.h"
    header.write_bytes(artifacts(wmrgen.derive(wmrgen.load(first)))["tried.h"])
    (a,), (b,) = layouts(header), layouts(second)
    assert {d.wheel for d in compare(a, b).differences if d.code == "WMR052"} == {"a", "c"}


CAR = """<robot name="car"><link name="base_link"/>
{links}
<ros2_control name="c" type="system">{controls}</ros2_control></robot>"""
LINK = """<link name="{n}_link"><collision><origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.18"
length="0.1"/></geometry></collision></link>
<joint name="{n}" type="continuous"><parent link="{p}"/><child link="{n}_link"/><origin xyz="{at}"/><axis xyz="0 1 0"/>
</joint>"""
STEER = """<link name="{n}_link"/><joint name="{n}" type="revolute"><parent link="base_link"/><child link="{n}_link"/>
<origin xyz="{at}"/><axis xyz="0 0 {z}"/><limit lower="-0.7" upper="0.7" effort="1" velocity="1"/></joint>"""


def car(z: int) -> str:
    """A car as a URDF; ``z``: where its steering axes point."""
    links, controls = [], []
    for side, y in (("left", 0.39), ("right", -0.39)):
        links.append(LINK.format(n=f"rear_{side}_spin", p="base_link", at=f"0 {y} 0.18"))
        links.append(STEER.format(n=f"front_{side}_steer", at=f"1.5 {y} 0.18", z=z))
        links.append(LINK.format(n=f"front_{side}_spin", p=f"front_{side}_steer_link", at="0 0 0"))
        controls.append(f'<joint name="rear_{side}_spin"><command_interface name="velocity"/></joint>')
        controls.append(f'<joint name="front_{side}_steer"><command_interface name="position"/></joint>')
    return CAR.format(links="\n".join(links), controls="".join(controls))


@pytest.mark.parametrize(("z", "wrong"), [(1, set()), (-1, {"front_left", "front_right"})])
def test_steering_axes_that_point_down(z: int, wrong: set[str], tmp_path: Path) -> None:
    urdf, parameters = tmp_path / "car.urdf", tmp_path / "controllers.yaml"
    urdf.write_text(car(z), encoding="utf-8")
    lengths = [line.replace("0.92", "0.78") for line in LENGTHS]
    parameters.write_text(ackermann(TRACTION, STEERING, *lengths), encoding="utf-8")
    (a,), (b,) = layouts(urdf), layouts(parameters)
    result = compare(a, b)
    assert {d.code for d in result.differences} == ({"WMR052"} if wrong else set())
    joints = {d.words.split(":")[0].removesuffix("_steer") for d in result.differences}
    assert joints == wrong
    for d in result.differences:
        assert isinstance(d.a, float) and d.b == pytest.approx(-d.a)


PLUGIN = """<gazebo><plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
<left_joint>{left}</left_joint><right_joint>{right}</right_joint>
<wheel_separation>0.78</wheel_separation><wheel_radius>0.18</wheel_radius></plugin></gazebo></robot>"""


@pytest.mark.parametrize("swapped", [False, True])
def test_a_plugin_with_exchanged_joints(swapped: bool, tmp_path: Path) -> None:
    names = [f"rear_{side}_spin" for side in ("left", "right")]
    left, right = reversed(names) if swapped else names
    links = [
        LINK.format(n=n, p="base_link", at=f"0 {y} 0.18") for n, y in zip(names, (0.39, -0.39), strict=True)
    ]
    controls = [f'<joint name="{n}"><command_interface name="velocity"/></joint>' for n in names]
    text = CAR.format(links="\n".join(links), controls="".join(controls)).removesuffix("</robot>")
    path = tmp_path / "base.urdf"
    path.write_text(text + PLUGIN.format(left=left, right=right), encoding="utf-8")
    robot, plugin = layouts(path)
    result = compare(robot, plugin)
    assert {e.motion: e.ratio for e in result.effects} == pytest.approx(
        {"straight": 1, "turn": -1 if swapped else 1}
    )
    assert bool(result.differences) is swapped


def test_the_limits_of_a_plugin(tmp_path: Path) -> None:
    robot = FRONT.split("  - {name: front")[0]
    first, _ = written(tmp_path, f"limits: {{vx: 1.0}}\n{robot}", "")
    plugin = PLUGIN.format(left="rear_left_spin", right="rear_right_spin")
    limit = "<max_linear_velocity>5</max_linear_velocity></plugin>"
    links = "".join(
        LINK.format(n=f"rear_{s}_spin", p="base_link", at=f"0 {y} 0.18")
        for s, y in (("left", 0.39), ("right", -0.39))
    )
    path = tmp_path / "base.urdf"
    text = CAR.format(links=links, controls="").removesuffix("</robot>") + plugin
    path.write_text(text.replace("</plugin>", limit), encoding="utf-8")
    (own,), (_, read) = layouts(first), layouts(path)
    (difference,) = compare(own, read).differences
    assert (difference.code, difference.a, difference.b) == ("WMR053", 1.0, 5.0)


def test_files_with_nothing_in_common(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    paths = written(tmp_path, DD, controller("diff_drive_controller", "publish_rate: 50.0"))
    done = wmrgen_cli("compare", *paths)
    assert done.code == 3
    done = wmrgen_cli("compare", *paths, "--json")
    (found,) = json.loads(done.out)["comparisons"]
    assert (found["compared"], found["equal"], found["differences"]) == (False, None, [])
    assert wmrgen_cli("compare", *written(tmp_path, DD, diff())).code == 0
    assert wmrgen_cli("compare", *written(tmp_path, DD, diff()), "--distro", "humble").code == 0
