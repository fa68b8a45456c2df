"""The codes of differences between files, for `explain` and docs/lint.md."""

from __future__ import annotations

from wmrgen.tools.lint.record import PAIR, Rule

DIFF = "drive:\n  type: diff_drive_controller/DiffDriveController\n"
STEERING = (
    "car:\n  type: tricycle_steering_controller/TricycleSteeringController\n  traction_wheels_radius: 0.3\n"
)
MECANUM = """
wheels:
  - {name: front_left,  type: swedish, x: 0.3,  y: 0.2,  heading: 0, r: 0.1, gamma: -45 deg}
  - {name: front_right, type: swedish, x: 0.3,  y: -0.2, heading: 0, r: 0.1, gamma: 45 deg}
  - {name: rear_left,   type: swedish, x: -0.3, y: 0.2,  heading: 0, r: 0.1, gamma: 45 deg}
  - {name: rear_right,  type: swedish, x: -0.3, y: -0.2, heading: 0, r: 0.1, gamma: -45 deg}
"""
CAR = """
wheels:
  - {name: front, type: steered, x: 1.5, y: 0, heading: 0, r: 0.3, actuated: [steer]}
  - {name: left,  type: fixed, x: 0, y: 0.6,  heading: 0, r: 0.3}
  - {name: right, type: fixed, x: 0, y: -0.6, heading: 0, r: 0.3}
"""
CAR_WITH_TWO = """
wheels:
  - {name: rear_left,   type: fixed, x: 0, y: 0.4,  heading: 0, r: 0.3}
  - {name: rear_right,  type: fixed, x: 0, y: -0.4, heading: 0, r: 0.3}
  - {name: front_left,  type: steered, x: 1.5, y: 0.4,  heading: 0, r: 0.3, actuated: [steer]}
  - {name: front_right, type: steered, x: 1.5, y: -0.4, heading: 0, r: 0.3, actuated: [steer]}
"""
ACKERMANN = """car:
  type: ackermann_steering_controller/AckermannSteeringController
  wheelbase: 1.5
  traction_track_width: 0.8
  traction_wheels_radius: 0.3
  traction_joints_names: [rear_right_spin, rear_left_spin]
"""
BELTS = """
wheels:
  - {name: front_left,  type: fixed, x: 0.3,  y: 0.2,  heading: 0, r: 0.1}
  - {name: front_right, type: fixed, x: 0.3,  y: -0.2, heading: 0, r: 0.1}
  - {name: rear_left,   type: fixed, x: -0.3, y: 0.2,  heading: 0, r: 0.1}
  - {name: rear_right,  type: fixed, x: -0.3, y: -0.2, heading: 0, r: 0.1}
couplings:
  - {equal: [rear_left.spin, front_left.spin]}
  - {equal: [rear_right.spin, front_right.spin]}
"""
CASTOR = PAIR + "  - {name: tail, type: castor, x: -0.3, y: 0, heading: 0, d: -0.04, r: 0.05}\n"
BETWEEN: dict[str, Rule] = {}


def _between(code: str, title: str, text: str, robot: str, wrong: str, right: str) -> None:
    """Enter a rule; its examples are a robot, without the first two lines of its file, and a second file."""
    bad, good = (f"{robot.strip()}\n---\n{other.strip()}\n" for other in (wrong, right))
    BETWEEN[code] = Rule(code, title, " ".join(text.split()), bad, good, lambda _: iter(()))


_between(
    "WMR040",
    "another track",
    """The distance between the left and the right wheels decides how fast the robot turns. If the track in the
    controller is 4 % too short, the robot turns 4 % less than commanded, and odometry reports 4 % too much. If the
    track is half or double, track and half-track were likely confused. The track is multiplied by
    wheel_separation_multiplier. For a robot that skids, this is done only if the robot file has an `effective_track`
    to compare with.""",
    PAIR,
    f"{DIFF}  wheel_separation: 0.2\n  wheel_radius: 0.1",
    f"{DIFF}  wheel_separation: 0.4\n  wheel_radius: 0.1",
)
_between(
    "WMR041",
    "another wheelbase",
    """The distance from the rear to the front wheels decides how far a car steers for a curve. With a wheelbase that is
    too short, the car steers too little and turns less than commanded.""",
    CAR,
    f"{STEERING}  wheelbase: 1.2",
    f"{STEERING}  wheelbase: 1.5",
)
_between(
    "WMR042",
    "another wheel radius",
    """With a radius that is too large in the controller the wheels turn too slowly: the robot drives and turns less
    than commanded. Double the radius is the diameter.""",
    PAIR,
    f"{DIFF}  wheel_separation: 0.4\n  wheel_radius: 0.2",
    f"{DIFF}  wheel_separation: 0.4\n  wheel_radius: 0.1",
)
_between(
    "WMR043",
    "another lx + ly, or distance of the wheels from the centre",
    """The yaw rate of a mecanum robot follows from half the wheelbase plus half the track. The yaw rate of an omni
    robot follows from the distance of its wheels from the centre. Both are measured to the middle of the wheel.""",
    MECANUM,
    "base:\n  type: mecanum_drive_controller/MecanumDriveController\n  kinematics:\n    wheels_radius: 0.1\n"
    "    sum_of_robot_center_projection_on_X_Y_axis: 1.0",
    "base:\n  type: mecanum_drive_controller/MecanumDriveController\n  kinematics:\n    wheels_radius: 0.1\n"
    "    sum_of_robot_center_projection_on_X_Y_axis: 0.5",
)
_between(
    "WMR044",
    "another place of a wheel, or of the origin",
    """Track and wheelbase do not explain the position of a wheel: wheels have exchanged names, a joint is given in
    another frame, or the two files have different origins. Or a controller expects a joint on the other side: then the
    robot turns the wrong way.""",
    PAIR,
    "wheels:\n  - {name: left,  type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}\n"
    "  - {name: right, type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}",
    PAIR,
)
_between(
    "WMR045",
    "another sign, or heading",
    """A joint that counts in the other direction turns its wheel backwards. If motors are mounted mirrored, both files
    must have the sign.""",
    PAIR,
    PAIR.replace("heading: 0, r: 0.1}\n  - {name: right", "heading: pi, r: 0.1}\n  - {name: right"),
    PAIR,
)
_between(
    "WMR046",
    "another roller angle",
    """The rollers of a mecanum wheel lean in one direction at the ground and in the other on top, where they are seen.
    With all four angles read from above, the robot strafes the wrong way.""",
    MECANUM,
    MECANUM.replace("-45", "+45").replace(" 45", " -45").replace("+45", "45"),
    MECANUM,
)
_between(
    "WMR047",
    "another order of wheels",
    """Programs that know the wheels by number, such as arrays of joints and the enumeration in the C, send each command
    to another wheel.""",
    PAIR,
    "wheels:\n  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}\n"
    "  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}",
    PAIR,
)
_between(
    "WMR048",
    "a wheel or joint that only one file has",
    """A controller that names a joint that the robot does not have does not start. A joint with a motor that is not
    commanded, and a commanded joint without one, are reported, too. Wheels that constrain no motion, such as ball
    castors, get a note.""",
    PAIR,
    f"{PAIR.rstrip()}\n  - {{name: middle, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}}",
    PAIR,
)
_between(
    "WMR049",
    "parameters or wheels of another kind",
    """The controller is made for other wheels than the robot has: a differential drive cannot use rollers.""",
    MECANUM,
    f"{DIFF}  wheel_separation: 0.4\n  wheel_radius: 0.1",
    "base: {type: mecanum_drive_controller/MecanumDriveController, wheel_radius: 0.1}",
)
_between(
    "WMR050",
    "another offset of the contact from the steering axis",
    """The castor offset, or the distance of a steered wheel from its steering axis along the axle. It changes the speed
    of a driven castor or steered wheel, and the angle of a castor without a motor.""",
    CASTOR,
    CASTOR.replace("-0.04", "-0.03"),
    CASTOR,
)
_between(
    "WMR051",
    "another coupling of joints",
    """A shaft, a belt or gears make joints turn together: the first has the motor, and commands of the others have no
    effect. A program without the coupling, or with another ratio, commands a motion that the robot cannot do.""",
    BELTS,
    BELTS.replace(
        "equal: [rear_left.spin, front_left.spin]", "equal: [rear_left.spin, front_left.spin], ratios: [1, 2]"
    ),
    BELTS,
)
_between(
    "WMR052",
    "wrong command of a joint",
    """The controller's own formula gives a joint another rate or angle than the robot's inverse kinematics, and no
    length explains it. Usual causes are lists in another order, an axis that points down, rollers of the other form,
    and an offset of the base frame. Steering controllers take the right joint first.""",
    CAR_WITH_TWO,
    f"{ACKERMANN}  steering_joints_names: [front_left_steer, front_right_steer]",
    f"{ACKERMANN}  steering_joints_names: [front_right_steer, front_left_steer]",
)
_between(
    "WMR053",
    "a limit beyond the robot's",
    """The controller lets the robot drive faster, or accelerate more, than the limits of the robot file allow.""",
    f"limits: {{vx: 1.0, omega: 2.0}}\n{PAIR.strip()}",
    f"{DIFF}  wheel_separation: 0.4\n  wheel_radius: 0.1\n  linear: {{x: {{max_velocity: 5.0}}}}",
    f"{DIFF}  wheel_separation: 0.4\n  wheel_radius: 0.1\n  linear: {{x: {{max_velocity: 1.0}}}}",
)
_between(
    "WMR054",
    "a parameter of another release of ROS 2",
    """The release that `--distro` names, here rolling, does not read the parameter. Kilted and later releases have
    traction_joints_names and steering_joints_names, Humble has front_wheels_names and rear_wheels_names. A controller
    without a required parameter does not start.""",
    CAR_WITH_TWO,
    f"{ACKERMANN}  front_wheels_names: [front_right_steer, front_left_steer]",
    f"{ACKERMANN}  steering_joints_names: [front_right_steer, front_left_steer]",
)
