"""Parameters of controllers: each family as its documentation or a real file writes it."""

from __future__ import annotations

from pathlib import Path

import pytest

from wmrgen.errors import RobotFileError
from wmrgen.robotfile.names import role
from wmrgen.tools.importing.controllers import plugin_controllers, read_controllers
from wmrgen.tools.importing.read import parse
from wmrgen.tools.importing.records import Controller

FAMILIES = {
    "diff_drive_controller of ros2_controllers, two wheels a side": (
        """
/**:
  controller_manager:
    ros__parameters:
      update_rate: 100
      drive: {type: diff_drive_controller/DiffDriveController}
      state: {type: joint_state_broadcaster/JointStateBroadcaster}
  drive:
    ros__parameters:
      left_wheel_names: [fl_wheel_joint, rl_wheel_joint]
      right_wheel_names: [fr_wheel_joint, rr_wheel_joint]
      wheel_separation: 0.697
      wheel_radius: 0.1825
      wheel_separation_multiplier: 1.5
      left_wheel_radius_multiplier: 1.0
      linear.x.max_velocity: 2.0
""",
        "drive differential",
        {"track": 0.697, "radius": 0.1825},
        {"track": 1.5, "left_radius": 1.0},
        "fl_wheel_joint: front left, rl_wheel_joint: rear left, "
        "fr_wheel_joint: front right, rr_wheel_joint: rear right",
    ),
    "diff_drive_controller of ROS 1, in a namespace": (
        """
robot/base_controller:
  type: "diff_drive_controller/DiffDriveController"
  left_wheel: '$(arg prefix)left_wheel_joint'
  right_wheel: ['$(arg prefix)right_wheel_joint']
  wheel_separation: 0.4
  wheel_radius: 0   # of the URDF
""",
        "base_controller differential",
        {"track": 0.4},
        {},
        "left_wheel_joint: left, right_wheel_joint: right",
    ),
    "mecanum_drive_controller of ros2_controllers": (
        """
mecanum_drive_controller:
  ros__parameters:
    command_joint_names: [rear_right_joint, front_left_joint]
    front_left_wheel_command_joint_name: front_left_joint
    rear_right_wheel_command_joint_name: rear_right_joint
    kinematics.base_frame_offset: {x: 0.0, y: 0.0, theta: 0.0}
    kinematics:
      wheels_radius: 0.5
      sum_of_robot_center_projection_on_X_Y_axis: 1.25
""",
        "mecanum_drive_controller mecanum",
        {"radius": 0.5, "sum": 1.25},
        {},
        "rear_right_joint: rear right, front_left_joint: front left",
    ),
    "mecanum_drive_controller of ROS 1": (
        """
mobile_base:
  type: mecanum_drive_controller/MecanumDriveController
  front_left_wheel_joint: fl
  back_right_wheel_joint: br
  wheel_separation_x: 0.4
  wheel_separation_y: 0.5
  wheel_radius: 0.1
""",
        "mobile_base mecanum",
        {"wheelbase": 0.4, "track": 0.5, "radius": 0.1},
        {},
        "fl: front left, br: rear right",
    ),
    "ackermann_steering_controller of steering_controllers_library": (
        """
ackermann:
  ros__parameters:
    type: ackermann_steering_controller/AckermannSteeringController
    traction_joints_names: [rear_right, rear_left]
    steering_joints_names: [front_right, front_left]
    wheelbase: 3.24644
    traction_track_width: 1.76868
    steering_track_width: 2.12321
    traction_wheels_radius: 0.45
""",
        "ackermann ackermann",
        {"wheelbase": 3.24644, "rear_track": 1.76868, "front_track": 2.12321, "rear_radius": 0.45},
        {},
        "rear_right: rear right, rear_left: rear left, front_right: front right steers, front_left: front left steers",
    ),
    "bicycle_steering_controller": (
        """
test_bicycle_steering_controller:
  ros__parameters:
    rear_wheels_names: [rear_wheel_joint]
    front_wheels_names: [steering_axis_joint]
    front_steering: true
    wheelbase: 3.24644
    front_wheel_radius: 0.45
    rear_wheel_radius: 0.44
""",
        "test_bicycle_steering_controller bicycle",
        {"wheelbase": 3.24644, "front_radius": 0.45, "rear_radius": 0.44},
        {},
        "rear_wheel_joint: rear, steering_axis_joint: front steers",
    ),
    "ackermann_steering_controller of ROS 1": (
        """
steer:
  type: ackermann_steering_controller/AckermannSteeringController
  rear_wheel: rear_wheel_joint
  front_steer: front_steer_joint
  wheel_separation_h: 0.5
  wheel_separation_h_multiplier: 1.1
  wheel_radius: 0.11
""",
        "steer ackermann",
        {"wheelbase": 0.5, "radius": 0.11},
        {"wheelbase": 1.1},
        "rear_wheel_joint: rear, front_steer_joint: front steers",
    ),
    "four_wheel_steering_controller": (
        """
four:
  type: "four_wheel_steering_controller/FourWheelSteeringController"
  front_wheel: [fl_wheel, fr_wheel]
  front_steering: [fl_steering_joint, fr_steering_joint]
  wheel_separation_w: 1.2
  wheel_steering_y_offset: 0.05
  wheel_base: 2.0
  wheel_radius: 0.3
""",
        "four swerve",
        {"track": 1.2, "offset": 0.05, "wheelbase": 2.0, "radius": 0.3},
        {},
        "fl_wheel: front left, fr_wheel: front right, "
        "fl_steering_joint: front left steers, fr_steering_joint: front right steers",
    ),
    "wheels of a module list, one anchor for two controllers": (
        """
twist_controller:
  type: cob_omni_drive_controller/WheelController
  wheels: &wheels
    - {steer: fl_rotation_joint, drive: fl_wheel_joint}
    - {steer: br_rotation_joint, drive: br_wheel_joint}
odometry_controller:
  type: joint_state_controller/JointStateController
  wheels: *wheels
""",
        "twist_controller swerve",
        {},
        {},
        "fl_rotation_joint: front left steers, fl_wheel_joint: front left, "
        "br_rotation_joint: rear right steers, br_wheel_joint: rear right",
    ),
    "a driver with lengths in a group, a diameter": (
        """
turtle_node:
  ros__parameters:
    opencr: {id: 200}
    wheels: {separation: 0.160, diameter: 0.066}
""",
        "turtle_node ",
        {"track": 0.16, "radius": 0.033},
        {},
        "",
    ),
    "omni wheels on a ring, and the radius of a footprint": (
        """
omni:
  ros__parameters: {wheel_names: [a, b, c], robot_radius: 0.1, wheelRadius: 0.05, gamma: 30.0}
local_costmap:
  local_costmap:
    ros__parameters: {robot_radius: 0.22}
""",
        "omni omni",
        {"ring": 0.1, "radius": 0.05},
        {},
        "a: , b: , c: ",
    ),
    "nothing above the lengths, defaults merged in": (
        "defaults: &d {left_wheel_joint: l, right_wheel_joint: r}\n"
        "wheel_diameter: 0.2\nwheel_track: 0.3\nmotor: {<<: *d, reversed: false}\n",
        " differential",
        {"radius": 0.1, "track": 0.3},
        {},
        "l: left, r: right",
    ),
}


def told(c: Controller) -> str:
    return ", ".join(f"{j.joint}: {j.role}{' steers' * j.steers}" for j in c.joints)


@pytest.mark.parametrize("family", FAMILIES)
def test_a_family(family: str, tmp_path: Path) -> None:
    text, title, lengths, multipliers, joints = FAMILIES[family]
    path = tmp_path / "parameters.yaml"
    path.write_text(text, encoding="utf-8")
    controllers = read_controllers(path)
    assert len(controllers) == 1
    (c,) = controllers
    assert f"{c.name} {c.kind}" == title
    assert {key: float(s.value) for key, s in c.lengths.items()} == lengths
    assert {key: float(s.value) for key, s in c.multipliers.items()} == multipliers
    assert told(c) == joints
    for setting in (*c.lengths.values(), *c.multipliers.values()):  # the mark is that of the value
        assert setting.mark
        line = text.split("\n")[setting.mark.line - 1]
        assert setting.key.rsplit(".", 1)[-1].replace("_", "").lower() in line.replace("_", "").lower()
        shown = float(line[setting.mark.column - 1 :].split(",")[0].split("}")[0].split("#")[0])
        assert shown in (float(setting.value), 2 * float(setting.value))


def test_places_of_modules_and_signs_of_motors_which_are_not_read(tmp_path: Path) -> None:
    path = tmp_path / "parameters.yaml"
    path.write_text(
        """
/**:
  ros__parameters:
    wheel_radius: 0.09
    wheel_lever_arm: 0.045
    drive0: {joint_name: wheel_back_left, rot_sign: -1, gear_ratio: 30.0}
    steer0: {joint_name: caster_back_left, center_pos_x: -0.24, center_pos_y: 0.0, rot_sign: 1}
driver:
  ros__parameters:
    wheel_track: 0.5
    joint_names: [a, b]
    joint_directions: [forward, -1]
""",
        encoding="utf-8",
    )
    modules, driver = read_controllers(path)
    (joint, (x, y)), *others = modules.places.items()
    assert (joint, float(x.value), y.value, others) == ("caster_back_left", -0.24, 0, [])
    assert modules.lengths["offset"].value * 1000 == 45
    assert [joint.joint for joint in driver.joints] == ["a", "b"]


def test_arguments_stand_for_themselves_and_what_is_not_given_is_not_said(tmp_path: Path) -> None:
    path = tmp_path / "parameters.yaml"
    path.write_text(
        "base:\n  type: diff_drive_controller/DiffDriveController\n  left_wheel: $(arg prefix)left\n"
        "  wheel_radius: $(arg radius)\n  wheel_separation: ${track}\n",
        encoding="utf-8",
    )
    (c,) = read_controllers(path, {"prefix": "r1_", "radius": "0.2"})
    assert (c.joints[0].joint, float(c.lengths["radius"].value), len(c.lengths)) == ("r1_left", 0.2, 1)
    (c,) = read_controllers(path)
    assert (c.joints[0].joint, c.lengths) == ("left", {})


def test_units_in_names_null_and_angles_of_ros(tmp_path: Path) -> None:
    path = tmp_path / "parameters.yaml"
    path.write_text(
        "a:\n  wheelbase_m: 0.3\n  track_width_mm: 200\n  wheel_diameter_cm: 12\n  ring: {wheel_radius: null}\n"
        "  pan: {max_velocity: !degrees 120.0, min_velocity: !radians -1}\n"
    )
    (c,) = read_controllers(path)
    assert {key: float(s.value) for key, s in c.lengths.items()} == {
        "wheelbase": 0.3,
        "track": 0.2,
        "radius": 0.06,
    }


def test_an_empty_list_is_no_length(tmp_path: Path) -> None:
    path = tmp_path / "rover.yaml"
    dimensions = "{{d1: 0.1, d2: 0.3, d3: 0.2, d4: {}, wheel_radius: 0.05}}"
    text = f"rover:\n  ros__parameters:\n    rover_dimensions: {dimensions}\n"
    for written, places in (("0.25", 6), ("[]", 4)):
        path.write_text(text.format(written))
        (c,) = read_controllers(path)
        assert float(c.lengths["radius"].value) == 0.05
        assert len(c.places) == places


def test_of_a_key_that_stands_twice_the_last_holds_with_a_note(tmp_path: Path) -> None:
    """As PyYAML, which ROS 1 and launch files read by, and the parser of ROS 2 have it; of whole nodes too."""
    path = tmp_path / "parameters.yaml"
    path.write_text(
        "a:\n  wheel_radius: 0.1\n  track: 0.4\n  wheel_radius: 0.2\nb: {wheel_radius: 1}\nb: {wheel_radius: 2}\n"
    )
    first, second = read_controllers(path)
    assert [float(c.lengths["radius"].value) for c in (first, second)] == [0.2, 2.0]
    assert [note.partition(": ")[0] for note in first.notes] == ["parameters.yaml:4", "parameters.yaml:6"]
    assert "duplicate key 'wheel_radius'" in first.notes[0] and not second.notes
    path.write_text("a: {track: 0.4, name: x, name: y}\n")  # what says nothing of wheels too
    assert "duplicate key 'name'" in read_controllers(path)[0].notes[0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("base:\n  wheel_radius: big\n", ":2:17\n2 |   wheel_radius: big\n"),
        ("base:\n  wheel_radius: 1e999999999\n", "no number"),
        ("base:\n  wheel_radius: .nan\n", "no number"),
        ("base:\n  wheel_radius: *r\n", "nothing above is called '&r'"),
        ("a: &a [x,x,x,x,x,x,x,x]\n" + "".join(
            f"{k}: &{k} [{','.join([f'*{chr(ord(k) - 1)}'] * 8)}]\n" for k in "bcdefg"), "more than 20000 values"),
        ("a: !!python/object:os.system x\n", "a tag"),
        ("base: {wheel_radius: 0.1\n", "closed"),
    ],
)  # fmt: skip
def test_what_is_refused(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "parameters.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RobotFileError) as caught:
        read_controllers(path)
    assert said in str(caught.value)


def test_no_file(tmp_path: Path) -> None:
    with pytest.raises(RobotFileError):
        read_controllers(tmp_path / "none.yaml")


def test_what_gives_no_length_is_no_controller(tmp_path: Path) -> None:
    path = tmp_path / "parameters.yaml"
    for text in (
        "",
        "a: 1\n",
        "sensors: {type: imu_sensor_broadcaster/Imu}\n",
        "costmap: {robot_radius: 0.2}\n",
    ):
        path.write_text(text, encoding="utf-8")
        assert read_controllers(path) == ()


def test_plugins() -> None:
    text = """<robot name="r">
      <mobile type="differential" joints="right_wheel left_wheel" params="0.53 0.1"/>
      <gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="drive">
        <leftJoint>left_hub</leftJoint><rightJoint>right_hub</rightJoint>
        <wheelSeparation>0.158</wheelSeparation><wheelDiameter>0.12</wheelDiameter></plugin></gazebo>
      <gazebo><plugin filename="liblift.so" name="air"><wheelRadius>0.1 m</wheelRadius>
        <turningDirection>cw</turningDirection><wheelBase>1e99</wheelBase></plugin></gazebo>
      <gazebo><plugin filename="gz-sim-mecanum-drive-system" name="gz::sim::systems::MecanumDrive">
        <front_left_joint>fl</front_left_joint><back_right_joint>br</back_right_joint>
        <wheel_separation>1.25</wheel_separation><wheelbase>1.511</wheelbase><wheel_radius>0.3</wheel_radius><track>wide</track>
      </plugin></gazebo>
      <ros2_control name="base"><hardware><plugin>diffdrive/Hardware</plugin>
        <param name="left_wheel_name">l</param><param name="wheelRadius">0.05</param></hardware></ros2_control>
      <gazebo><plugin filename="libgazebo_ros_imu.so" name="imu"><frame_name>imu</frame_name></plugin></gazebo>
      <gazebo><plugin filename="libgazebo_ros_ackerman.so" name="four_diff_controller">
        <wheelSeparation>0.172</wheelSeparation></plugin></gazebo>
    </robot>"""
    mobile, drive, mecanum, hardware, car = plugin_controllers(parse(text.encode(), "r.urdf"))
    kinds = ["differential", "differential", "mecanum", "ackermann"]
    assert [c.kind for c in (mobile, drive, mecanum, car)] == kinds
    assert {k: float(s.value) for k, s in mobile.lengths.items()} == {"track": 0.53, "radius": 0.1}
    assert {k: float(s.value) for k, s in drive.lengths.items()} == {"track": 0.158, "radius": 0.06}
    assert {k: float(s.value) for k, s in mecanum.lengths.items()} == {
        "track": 1.25,
        "wheelbase": 1.511,
        "radius": 0.3,
    }
    assert ({k: float(s.value) for k, s in hardware.lengths.items()}, told(hardware)) == (
        {"radius": 0.05},
        "l: left",
    )
    assert told(mobile) == "right_wheel: right, left_wheel: left"
    assert told(mecanum) == "fl: front left, br: rear right"


@pytest.mark.parametrize(
    ("names", "where"),
    [
        (("front_left_wheel",), "front left"),
        (("backRight",), "rear right"),
        (("FL",), "front left"),
        (("lb_wheel",), "rear left"),
        (("robot_left_front_axle",), "front left"),
        (("front", "left_hub"), "front left"),
        (("rear_left", "front_right"), "rear left"),
        (("middle_r",), "middle right"),
        (("rr_l",), "rear right"),
        (("wheel_r",), ""),  # rear or right
        (("drivewhl_l",), "left"),
        (("L",), "left"),
        (("frontleft",), "front left"),
        (("RIGHTREAR",), "rear right"),
        (("lfront",), "front left"),
        (("flwheel",), "front left"),
        (("wheelBR",), "rear right"),
        (("aft_left",), "rear left"),
        (("fr_left_joint",), "front left"),  # fr is the front, as re is the rear
        (("right_rl",), "rear right"),
        (("Body-FRdrive",), "front right"),
        (("bright",), ""),
        (("leftover",), ""),
        (("wheel1",), ""),
    ],
)
def test_where_a_name_says_that_a_wheel_is(names: tuple[str, ...], where: str) -> None:
    assert role(*names) == where
