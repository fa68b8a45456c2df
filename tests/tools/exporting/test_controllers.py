"""Parameters of controllers, Gazebo's systems and WPILib's constants give the wheel speeds of the inverse kinematics.

The formulas are those of their documentation (ros2_controllers: Wheeled Mobile Robot Kinematics; Gazebo and WPILib: the
pages of each class), written here anew.
"""

from __future__ import annotations

import json
import math
import re
from math import atan, atan2, cos, pi, sin, tan
from pathlib import Path
from random import Random
from typing import Any

import pytest
import yaml

import wmrgen
from tests.conftest import ROOT
from tests.depth import DEEP
from tests.oracle.harness import robot_text
from tests.peers.test_peers import layout
from tests.tools.exporting.common import drives, gallery, load, root, speeds, twists
from wmrgen.errors import NotDerivableError
from wmrgen.geometry.layout.records import Robot
from wmrgen.tools.exporting.ros2_control import ros2_control
from wmrgen.tools.exporting.sdf import sdf
from wmrgen.tools.exporting.wpilib import wpilib

Twist = dict[str, float]
KINDS = list(drives(Random(0)))
SEEDS = range(12 if DEEP else 2)
# What the gallery has: robot, controller (none: refused for the reason that the words name).
GALLERY = {
    "pioneer3dx": "DiffDrive", "andino": "DiffDrive", "mir_100": "DiffDrive", "clearpath_a200": "DiffDrive",
    "clearpath_do100": "MecanumDrive", "kuka_youbot": "MecanumDrive",
    "textbook_omnidirectional": "OmniWheelDrive",
    "textbook_tricycle": "Tricycle", "bicycle": "BicycleSteering", "f1tenth": "BicycleSteering",
    "ackermann_car": "AckermannSteering", "car_with_trailers": "AckermannSteering",
}  # fmt: skip
REFUSED = {
    "nexus_4wd": "'lower_right' rolls backward", "ssl_parsian": "equally spaced about P, not 60, 135, 225, 300 deg",
    "lekiwi": "counter-clockwise", "festo_robotino": "distances of the wheels", "agilex_ranger": "swerve drives",
    "jpl_osr": "not one fixed axle", "kelly_4ws": "beside its steering axis", "pr2": "coupled",
    "synchro_drive": "coupled", "nomad_xr4000": "powered castor", "office_chair": "no motor drives it",
}  # fmt: skip


def parameters(robot: Robot) -> tuple[str, dict[str, Any]]:
    """Class and parameters of the controller."""
    tree = yaml.safe_load(ros2_control(robot)[f"{robot.name}_controllers.yaml"])
    kind = tree["controller_manager"]["ros__parameters"]["base_controller"]["type"]
    package, _, name = kind.partition("/")
    assert package == re.sub("(?<!^)(?=[A-Z])", "_", name).lower()
    return name.removesuffix("Controller"), tree["base_controller"]["ros__parameters"]


def commands(kind: str, p: dict[str, Any], t: Twist) -> dict[str, float]:
    """What a controller sends to the joints."""
    vx, vy, w = t["vx"], t["vy"], t["omega"]
    if kind == "DiffDrive":
        turn = w * p["wheel_separation"] / 2
        left = (vx - turn) / (p["wheel_radius"] * p.get("left_wheel_radius_multiplier", 1.0))
        right = (vx + turn) / (p["wheel_radius"] * p.get("right_wheel_radius_multiplier", 1.0))
        return {**dict.fromkeys(p["left_wheel_names"], left), **dict.fromkeys(p["right_wheel_names"], right)}
    if kind == "MecanumDrive":
        k = p["kinematics"]
        r, length, offset = (
            k["wheels_radius"],
            k["sum_of_robot_center_projection_on_X_Y_axis"],
            k["base_frame_offset"],
        )
        assert offset["theta"] == 0
        vx, vy = vx + offset["y"] * w, vy - offset["x"] * w
        signs = {"front_left": (-1, -1), "front_right": (1, 1), "rear_left": (1, -1), "rear_right": (-1, 1)}
        return {
            p[f"{corner}_wheel_command_joint_name"]: (vx + s * vy + q * length * w) / r
            for corner, (s, q) in signs.items()
        }
    if kind == "OmniWheelDrive":
        step = 2 * pi / len(p["wheel_names"])
        angles = {name: k * step + p["wheel_offset"] for k, name in enumerate(p["wheel_names"])}
        return {
            n: (sin(a) * vx - cos(a) * vy - p["robot_radius"] * w) / p["wheel_radius"]
            for n, a in angles.items()
        }
    base = p["wheelbase"]
    phi = atan(base * w / vx)
    if kind == "Tricycle":
        return {p["steering_joint_name"]: phi, p["traction_joint_name"]: vx / (p["wheel_radius"] * cos(phi))}
    icr = base / tan(phi)
    if kind == "BicycleSteering":
        return {
            p["steering_joints_names"][0]: phi,
            p["traction_joints_names"][0]: vx / p["traction_wheel_radius"],
        }
    half = p["traction_track_width"] / 2
    right, left = p["traction_joints_names"]
    rolled = {
        right: vx * (icr + half) / icr / p["traction_wheels_radius"],
        left: vx * (icr - half) / icr / p["traction_wheels_radius"],
    }
    if kind == "TricycleSteering":
        return {p["steering_joints_names"][0]: phi, **rolled}
    assert kind == "AckermannSteering"
    right, left, kingpins = *p["steering_joints_names"], p["steering_track_width"] / 2
    return {right: atan2(base, icr + kingpins), left: atan2(base, icr - kingpins), **rolled}


def wrapped(name: str, value: float) -> float:
    """A wheel that steers half a turn further rolls the other way: angles are compared modulo pi."""
    return math.remainder(value, pi) if name.endswith("_steer") else value


def agree(robot: Robot, sent: dict[str, float], t: Twist) -> None:
    wanted = speeds(robot, t)
    driven = {f"{w.name}_{part}" for w in robot.wheels for part in w.actuated}
    assert set(sent) == driven
    for name, value in sent.items():
        assert wrapped(name, value) == pytest.approx(wrapped(name, wanted[name]), rel=1e-9, abs=1e-9), name


def axle_of(robot: Robot) -> float | None:
    """Of skid steer, the middle."""
    fixed = [float(w.nominal.x) for w in robot.wheels if w.kind.name == "fixed"]
    return sum(fixed) / len(fixed) if fixed else None


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", KINDS)
def test_drawn_robots_get_their_speeds(tmp_path: Path, kind: str, seed: int) -> None:
    draw = Random(f"{kind}{seed}")
    wheels, more = drives(draw)[kind]
    robot = load(tmp_path, *wheels, more=more)
    controller, p = parameters(robot)
    for twist in twists(draw, axle_of(robot)):
        agree(robot, commands(controller, p, twist), twist)


@pytest.mark.parametrize("name", GALLERY)
def test_robots_of_the_gallery_get_their_speeds(name: str) -> None:
    robot = gallery(name)
    controller, p = parameters(robot)
    assert controller == GALLERY[name]
    for twist in twists(Random(name), axle_of(robot)):
        agree(robot, commands(controller, p, twist), twist)


@pytest.mark.parametrize("name", REFUSED)
def test_what_no_controller_has_is_refused_in_words(name: str) -> None:
    with pytest.raises(NotDerivableError, match=re.escape(REFUSED[name])) as refusal:
        ros2_control(gallery(name))
    assert refusal.value.what.startswith(f"{name}: no controller of ros2_controllers fits: ")
    # A robot with motors has a controller of its own.
    assert ("--package ros2" in refusal.value.instead) == any(w.actuated for w in gallery(name).wheels)


@pytest.mark.parametrize(
    ("kind", "change", "why"),
    [
        ("differential", ("y: -", "y: -1"), "equal distances beside P"),
        ("differential", ("heading: 0", "heading: 0.001"), "does not roll along x"),
        ("mecanum", ("gamma: -45", "gamma: -44.99"), "the formula has -45 deg for the front left wheel"),
        ("mecanum", ("gamma: -45", "gamma: 45"), "gamma = 45 deg at the ground"),
        ("mecanum", ("heading: 0", "heading: pi"), "rolls backward"),
        ("mecanum", (", y: ", ", y: -"), "four wheels, one in each corner"),
        ("omni", ("alpha: ", "alpha: 1"), "equally spaced"),
        ("omni", ("beta: 0", "beta: pi"), "distances of the wheels"),
        ("omni", ("r: 0", "r: 0.001 + 0"), "radii differ"),
        ("bicycle", ("y: 0", "y: 0.001"), "not on the x axis"),
        ("tricycle", ("actuated: [steer]", "actuated: [spin, steer]"), "2 fixed, 1 steered, 3 driven"),
        ("ackermann", ("name: rl", "actuated: [], name: rl"), "2 fixed, 2 steered, 1 driven"),
        ("ackermann", ("actuated: [steer]", "actuated: []"), "not steered by a motor"),
        ("front-wheel", ("name: front", "offset_y: 0.001, name: front"), "beside its steering axis"),
    ],
)  # fmt: skip
def test_what_is_a_little_off_is_refused(
    tmp_path: Path, kind: str, change: tuple[str, str], why: str
) -> None:
    """The first wheel that has it is changed; the robot as it was is exported."""
    wheels, more = drives(Random(7))[kind]
    wheels = [w.replace("heading: pi,", "heading: 0,") for w in wheels]
    ros2_control(load(tmp_path, *wheels, more=more))
    at = next(k for k, w in enumerate(wheels) if change[0] in w)
    wheels[at] = wheels[at].replace(*change)
    with pytest.raises(NotDerivableError, match=re.escape(why)):
        ros2_control(load(tmp_path, *wheels, more=more))


def test_ways_to_turn_of_what_is_not_driven_do_not_matter(tmp_path: Path) -> None:
    wheels, more = drives(Random(7))["front-wheel"]
    turned = [w.replace("heading: 0, r", "heading: pi, r", "fixed" in w) for w in wheels]
    assert turned != wheels
    told, same = (parameters(load(tmp_path, *each, more=more)) for each in (wheels, turned))
    assert told == same


@pytest.mark.parametrize(
    ("wheels", "more", "why"),
    [
        (drives(Random(7))["differential"][0], "couplings:\n  - equal: [a.spin, b.spin]\n",
         "'b' has its spin coupled to that of 'a'"),
        (["name: a, type: steered, x: 0, y: 0, heading: 0, r: 0.1"], "", "two steered wheels or more"),
    ],
)  # fmt: skip
def test_what_has_no_formula_is_refused(tmp_path: Path, wheels: list[str], more: str, why: str) -> None:
    with pytest.raises(NotDerivableError, match=why):
        ros2_control(load(tmp_path, *wheels, more=more))


PEER = [
    v for v in json.loads((ROOT / "tests/peers/vectors.json").read_text(encoding="utf-8"))
    if v["peer"] == "ros-controls/ros2_controllers" and v["kind"] == "ik"
]  # fmt: skip


@pytest.mark.parametrize("vector", PEER, ids=lambda v: v["id"])
def test_the_controllers_own_tests_have_their_numbers(tmp_path: Path, vector: dict[str, Any]) -> None:
    """The robot of a test of ros2_controllers, exported, gets the commands which that test expects."""
    path = tmp_path / "peer.yaml"
    path.write_text(robot_text(layout(vector)), encoding="utf-8")
    controller, p = parameters(wmrgen.load(path))
    sent = commands(controller, p, vector["given"]["twist"])
    wanted = zip(vector["robot"]["order"], vector["expect"]["wheels"], strict=True)
    assert sent == pytest.approx({f"{name}_spin": speed for name, speed in wanted}, abs=1e-3)
    radius = vector["robot"]["wheels"][0]["radius"]
    assert p.get("wheel_radius", p.get("kinematics", {}).get("wheels_radius")) == radius


def test_types_of_parameters_are_those_of_ros(tmp_path: Path) -> None:
    """ROS refuses an integer for a double: whole and small numbers have a point."""
    robot = load(
        tmp_path, "name: a, type: fixed, x: 0, y: 1, heading: 0, r: 0.00001",
        "name: b, type: fixed, x: 0, y: -1, heading: 0, r: 0.00001", more="limits: {vx: 2, vx_rate: [-3, 4]}\n",
    )  # fmt: skip
    _, p = parameters(robot)
    assert (p["wheel_separation"], p["wheel_radius"]) == (2.0, 1e-5)
    assert all(isinstance(p[name], float) for name in ("wheel_separation", "wheel_radius"))
    assert p["linear"]["x"] == {
        "max_velocity": 2.0, "min_velocity": -2.0, "max_acceleration": 4.0, "max_deceleration": -3.0,
        "max_acceleration_reverse": -4.0, "max_deceleration_reverse": 3.0,
    }  # fmt: skip


def test_the_tag_commands_what_the_controller_commands(tmp_path: Path) -> None:
    for kind in KINDS:
        wheels, more = drives(Random(3))[kind]
        robot = load(tmp_path, *wheels, more=more)
        control = root(ros2_control(robot)["drawn.urdf"]).find("ros2_control")
        assert control is not None
        commanded = {j.get("name") for j in control.iter("joint") if j.find("command_interface") is not None}
        assert commanded == {f"{w.name}_{part}" for w in robot.wheels for part in w.actuated}
        for joint in control.iter("joint"):
            interface = joint.find("command_interface")
            steers = str(joint.get("name")).endswith("_steer")
            assert interface is None or interface.get("name") == ("position" if steers else "velocity")


# ---- Gazebo's systems


@pytest.mark.parametrize("kind", KINDS)
def test_systems_of_gazebo_give_the_speeds(tmp_path: Path, kind: str) -> None:
    """A system where Gazebo has one for the robot, else a controller of each joint with a motor."""
    draw = Random(kind)
    wheels, more = drives(draw)[kind]
    if kind == "differential":  # one radius, forward
        wheels = [w.replace("heading: pi,", "heading: 0,") for w in wheels]
        wheels[1] = wheels[1].rpartition("r: ")[0] + "r: " + wheels[0].rpartition("r: ")[2]
    if kind == "mecanum":  # the middle at P
        wheels = [f"name: {n}, type: swedish, x: {0.3 * a}, y: {0.2 * b}, heading: 0, gamma: {c} deg, r: 0.05"
                  for n, a, b, c in
                  (("p", 1, 1, -45), ("q", 1, -1, 45), ("s", -1, 1, 45), ("t", -1, -1, -45))]  # fmt: skip
    robot = load(tmp_path, *wheels, more=more)
    plugins = root(sdf(robot)).findall("model/plugin")
    names = [str(plugin.get("name")).rpartition("::")[2] for plugin in plugins]
    if kind not in ("differential", "mecanum", "ackermann"):
        joints = {(str(p.findtext("joint_name")), n) for p, n in zip(plugins, names, strict=True)}
        kinds = {"spin": "JointController", "steer": "JointPositionController"}
        assert joints == {(f"{w.name}_{part}", kinds[part]) for w in robot.wheels for part in w.actuated}
        return
    (plugin,) = plugins
    size = {e.tag: float(str(e.text)) for e in plugin if not e.tag.endswith("joint")}
    joint = {e.tag.removesuffix("_joint"): str(e.text) for e in plugin if e.tag.endswith("joint")}
    for t in twists(draw, axle_of(robot)):
        vx, vy, w, r = t["vx"], t["vy"], t["omega"], size["wheel_radius"]
        if kind == "mecanum":
            turn = w * (size["wheel_separation"] + size["wheelbase"]) / 2
            sent = {joint["front_left"]: (vx - vy - turn) / r, joint["front_right"]: (vx + vy + turn) / r,
                    joint["back_left"]: (vx + vy - turn) / r, joint["back_right"]: (vx - vy + turn) / r}  # fmt: skip
        else:
            turn = w * size["wheel_separation"] / 2
            sent = {joint["left"]: (vx - turn) / r, joint["right"]: (vx + turn) / r}
        if kind == "ackermann":
            base, half, icr = size["wheel_base"], size["kingpin_width"] / 2, vx / w
            sent[joint["left_steering"]] = atan(base / (icr - half))
            sent[joint["right_steering"]] = atan(base / (icr + half))
        agree(robot, sent, t)


def test_gazebo_turns_no_tighter_than_the_steering_limits(tmp_path: Path) -> None:
    """Its least turning radius is wheel_base / sin(steering_limit): there, the inner wheel is at its limit."""
    wheels, more = drives(Random(5))["ackermann"]
    plugin = root(sdf(load(tmp_path, *wheels, more=more))).find("model/plugin")
    assert plugin is not None
    size = {e.tag: float(str(e.text)) for e in plugin if not e.tag.endswith("joint")}
    least = size["wheel_base"] / sin(size["steering_limit"])
    inner = atan(size["wheel_base"] / (least - size["kingpin_width"] / 2))
    assert inner == pytest.approx(1.1, abs=1e-9) or (least == size["wheel_base"] and inner < 1.1)


# ---- WPILib


def constants(text: str) -> dict[str, str]:
    return dict(re.findall(r"static final \w+ (\w+) =\s+(.*);", text))


@pytest.mark.parametrize("kind", ["differential", "mecanum", "swerve"])
@pytest.mark.parametrize("seed", SEEDS)
def test_wpilib_gets_its_speeds(tmp_path: Path, kind: str, seed: int) -> None:
    """m/s at the ground, against joint rates by radius and sign; modules by angle."""
    draw = Random(f"{kind}{seed}")
    if kind == "swerve":
        count = 2 + seed % 4
        wheels = [f"name: m{k}, type: steered, x: {draw.uniform(-1, 1):.4f}, y: {draw.uniform(-1, 1):.4f}, "
                  f"heading: {draw.uniform(-3, 3):.4f}, r: {draw.uniform(0.02, 0.1):.4f}"
                  for k in range(count)]  # fmt: skip
    else:
        wheels, _ = drives(draw)[kind]
        wheels = [w.replace("heading: 0,", f"heading: {draw.choice(('0', 'pi'))},") for w in wheels]
    robot = load(tmp_path, *wheels)
    files = wpilib(robot)
    assert set(files) == {"DrawnConstants.java", "DrawnConstants.h"}
    c = constants(files["DrawnConstants.java"])
    kinematics = re.fullmatch(r"new (\w+)DriveKinematics\((.*)\)", c["KINEMATICS"])
    assert kinematics is not None and kinematics[1].lower() == kind
    for t in twists(draw, axle_of(robot)):
        vx, vy, w = t["vx"], t["vy"], t["omega"]
        wanted = speeds(robot, t)
        if kind == "differential":
            track = float(c["TRACK_WIDTH"])
            flows = {"a": vx - track / 2 * w, "b": vx + track / 2 * w}
        else:
            order = [name.removesuffix("_LOCATION").lower() for name in kinematics[2].split(", ")]
            places = [
                tuple(map(float, re.findall(r"[-\d.e]+(?=[,)])", c[f"{n.upper()}_LOCATION"]))) for n in order
            ]
        if kind == "mecanum":
            (flx, fly), (frx, fry), (rlx, rly), (rrx, rry) = places
            rows = [(-1, -(flx + fly)), (1, frx - fry), (1, rlx - rly), (-1, -(rrx + rry))]
            flows = {n: vx + a * vy + b * w for n, (a, b) in zip(order, rows, strict=True)}
        if kind == "swerve":
            for n, (x, y) in zip(order, places, strict=True):
                sx, sy = vx - w * y, vy + w * x
                angle = wanted[f"{n}_steer"] + float(c[f"{n.upper()}_ZERO"])
                roll = wanted[f"{n}_spin"] * float(c[f"{n.upper()}_RADIUS"])
                assert (roll * cos(angle), roll * sin(angle)) == pytest.approx((sx, sy), abs=1e-9)
            continue
        for n, flow in flows.items():
            sign = -1 if c[f"{n.upper()}_INVERTED"] == "true" else 1
            assert sign * float(c[f"{n.upper()}_RADIUS"]) * wanted[f"{n}_spin"] == pytest.approx(
                flow, abs=1e-9
            )


@pytest.mark.parametrize(
    ("names", "called"),
    [
        (("frontLeft", "rear_right", "M3"), ["FRONT_LEFT", "REAR_RIGHT", "M3"]),
        (("frontLeft", "front_left", "M3"), ["FRONTLEFT", "FRONT_LEFT", "M3"]),
    ],
)
def test_constants_are_called_as_java_calls_them(
    tmp_path: Path, names: tuple[str, ...], called: list[str]
) -> None:
    wheels = [
        f"name: {name}, type: steered, x: {k}, y: 1, heading: 0, r: 0.1" for k, name in enumerate(names)
    ]
    text = wpilib(load(tmp_path, *wheels))["DrawnConstants.java"]
    assert [name.removesuffix("_ZERO") for name in constants(text) if name.endswith("_ZERO")] == called


@pytest.mark.parametrize(
    ("name", "why"),
    [("ackermann_car", "there is none for ackermann drives"), ("ssl_parsian", "none for omni drives")],
)
def test_what_wpilib_has_not_is_refused_in_words(name: str, why: str) -> None:
    with pytest.raises(NotDerivableError, match=f"{name}: no kinematics of WPILib fits: .*{why}"):
        wpilib(gallery(name))
