"""The keys of a robot file: the one table for reading, messages, the JSON Schema and the reference page."""

from __future__ import annotations

from wmrgen.robotfile.fields import (
    YES,
    Amount,
    Choice,
    Field,
    Interval,
    Letter,
    ListOf,
    Mapped,
    Name,
    OneOf,
    OuterName,
    Section,
    Text,
    Version,
    Word,
)
from wmrgen.robotfile.numbers import Kind

# ---- joints and other parts

LIMITS = Section(
    "limits",
    "limits: {omega: 4.0}",
    (
        Field(
            "vx",
            Interval(Kind.SPEED),
            "forward speed of P",
            aliases=dict.fromkeys(
                ("v", "speed", "velocity", "linear", "max_speed", "max_velocity"),
                "Write vx: for the forward speed, vy: for the speed to the left, omega: for the yaw rate.",
            ),
            example="1.2 m/s",
        ),
        Field("vy", Interval(Kind.SPEED), "speed of P to the left", example="0.5 m/s"),
        Field(
            "omega",
            Interval(Kind.RATE),
            "yaw rate",
            aliases=dict.fromkeys(("w", "wz", "yaw", "yaw_rate", "angular", "turn"), ""), example="180 deg/s",
        ),
        Field(
            "vx_rate",
            Interval(Kind.ACCELERATION),
            "acceleration along x: at most high when the speed increases, at most -low when it decreases (braking); "
            "for "
            "limit_acceleration and setpoint", example="[-1.5, 0.6]",
        ),
        Field("vy_rate", Interval(Kind.ACCELERATION), "acceleration along y, as vx_rate", example="0.6"),
        Field("omega_rate", Interval(Kind.ANGULAR_ACCELERATION), "yaw acceleration, as vx_rate", example="200 deg/s^2"),
        Field("spin", Interval(Kind.RATE), "rate of a wheel about its axle", joint="spin", example="120 rpm"),
        Field(
            "steer",
            Interval(Kind.ANGLE),
            "steering angle; inverse commands only angles in this range. Coupled wheels must satisfy the limits of "
            "all of "
            "them",
            joint="steer", example="[-35 deg, 40 deg]",
        ),
        Field(
            "steer_rate",
            Interval(Kind.RATE),
            "rate of a steering angle, which steer_toward does not exceed",
            joint="steer", example="90 deg/s",
        ),
        Field(
            "spin_rate", Interval(Kind.ANGULAR_ACCELERATION), "angular acceleration of a wheel about its axle",
            joint="spin",
            aliases=dict.fromkeys(("spin_acceleration", "wheel_acceleration"), ""), example="60",
        ),
        Field(
            "steer_acceleration", Interval(Kind.ANGULAR_ACCELERATION), "angular acceleration of a steering angle",
            joint="steer",
            aliases=dict.fromkeys(("steer_rate_rate", "steering_acceleration"), ""), example="500 deg/s^2",
        ),
    ),
)  # fmt: skip


def _noise_of(kind: Kind, constant: str, example: str) -> Section:
    """Return the section for the noise of joints.

    Args:
        kind: The quantity of the constant part.
        constant: An example of the constant part.
        example: An example of the section.
    """
    return Section(
        "the noise of a joint",
        example,
        (
            Field(
                "proportional", Amount(Kind.ANY, "1"), "standard deviation as a share of the value",
                default="0", example="0.02", aliases=dict.fromkeys(("relative", "scale", "percent"), ""),
            ),
            Field(
                "constant", Amount(kind), "standard deviation that does not depend on the value", default="0",
                example=constant,
                aliases=dict.fromkeys(("sigma", "std", "stddev", "absolute"), ""),
            ),
        ),
    )  # fmt: skip


RATE_NOISE = _noise_of(Kind.RATE, "0.01 rad/s", "spin: {proportional: 0.02, constant: 0.01 rad/s}")
ANGLE_NOISE = _noise_of(Kind.ANGLE, "0.5 deg", "steer: {constant: 0.5 deg}")
NOISE = Section(
    "noise",
    "noise: {spin: {proportional: 0.02, constant: 0.01 rad/s}, steer: {constant: 0.5 deg}}",
    (
        Field("spin", RATE_NOISE, "noise of measured wheel speeds", joint="spin"),
        Field("steer", ANGLE_NOISE, "noise of measured steering angles", joint="steer"),
        Field("steer_rate", RATE_NOISE, "noise of measured steering rates", joint="steer"),
    ),
)

GYRO = Section(
    "gyro",
    "gyro: {constant: 0.005 rad/s}",
    (
        *RATE_NOISE.fields,
        Field(
            "weight", Amount(Kind.ANY, "1"),
            "weight in the least squares of forward: 1 is the weight of a wheel at the mean distance of the sensed "
            "wheels from their centre, 100 that of a sensor with a tenth of the noise",
            default="1", example="100",
        ),
    ),
)  # fmt: skip

WRAPS = Choice(
    (("bits",), ("modulus",)),
    ("Both give the count at which the counter wraps.", "Keep one of them."),
    optional=True,
)
_COUNTER = (
    Field(
        "counts", Amount(Kind.ANY, "1"),
        "counts per turn of the encoder's shaft; for a quadrature encoder, count all four edges",
        required=True, example="4096", aliases=dict.fromkeys(("cpr", "ticks", "resolution", "ppr", "lines"), ""),
        missing=("joints_from_counts needs it.", "Write counts: and the counts per turn, such as counts: 4096."),
    ),
    Field(
        "gear", Amount(Kind.ANY, "1"), "turns of the encoder's shaft per turn of the joint", default="1",
        example="30", aliases=dict.fromkeys(("ratio", "gear_ratio", "gearing", "reduction"), ""),
    ),
    Field(
        "reversed", Word(YES, "false"), "the counter counts down when the joint turns in its positive direction",
        aliases=dict.fromkeys(("inverted", "invert", "reverse"), ""),
    ),
    Field(
        "bits", Amount(Kind.ANY, "1"), "width of the counter, from 8 to 32 bits: it wraps at 2**bits", default="32",
        example="16",
    ),
    Field(
        "modulus", Amount(Kind.ANY, "1"),
        "for a counter that does not wrap at a power of two: it counts from 0 to modulus - 1",
        example="9000", aliases=dict.fromkeys(("wraps", "wrap", "rollover"), ""),
    ),
)  # fmt: skip
COUNTER = Section("the encoder of a joint", "spin: {counts: 4096, gear: 30}", _COUNTER, (WRAPS,))
STEERING_COUNTER = Section(
    "the encoder of a steering angle",
    "steer: {counts: 16384, offset: 512}",
    (
        *_COUNTER,
        Field(
            "offset", Amount(Kind.ANY, "1"),
            "reading of an absolute encoder at steer = 0; the reading wraps at counts, after one turn of the shaft, "
            "unless bits or modulus is given. Without offset the encoder is incremental, and the angle starts from the "
            "one in wheels",
            example="512", aliases=dict.fromkeys(("zero", "absolute", "home"), ""),
        ),
    ),
    (WRAPS,),
)  # fmt: skip
ENCODER = Section(
    "encoder",
    "encoder: {spin: {counts: 4096, gear: 30, reversed: true, bits: 16}, steer: {counts: 16384}}",
    (
        Field("spin", COUNTER, "encoder on the motor or the axle of the wheel", joint="spin"),
        Field(
            "steer", STEERING_COUNTER, "encoder of the steering angle, incremental or absolute", joint="steer"
        ),
    ),
)

JOINTS = Section(
    "joints",
    "joints: {spin: left_wheel_joint, steer: left_steering_joint}",
    (
        Field(
            "spin", OuterName(True),
            "name of the joint about the axle in descriptions, controllers and logs. A minus sign before it, as in "
            "`-left_wheel_joint`, means that a positive rate of that joint rolls the wheel backward",
            default="`<wheel>_spin`", example="left_wheel_joint", joint="spin",
        ),
        Field(
            "steer", OuterName(True),
            "name of the steering joint. A minus sign before it means that the axis of that joint points down: a "
            "positive angle steers to the right",
            default="`<wheel>_steer`", example="-left_steering_joint", joint="steer",
        ),
    ),
)  # fmt: skip

LAG = Section(
    "lag",
    "lag: {steer: 150 ms}",
    (
        Field(
            "steer", Amount(Kind.TIME),
            "time constant with which a steering angle follows its command: steer' = (command - steer)/lag",
            joint="steer", example="150 ms",
        ),
    ),
)  # fmt: skip

_LENGTH, _GAIN = Amount(Kind.LENGTH), Amount(Kind.ANY, "1/s")
_WHEELS = ListOf(
    OneOf("wheel"), "[front_left, front_right]", least=1, once=True,
    few=("{key} names no wheel", "", "Write {key}: [front_left, front_right]."),
)  # fmt: skip
_MIDDLE = "the centre of its wheels"
_X_AND_Y = "A position needs both x and y.", "Write both, or neither."
_ROLE = "A virtual wheel represents wheels that steer together, or wheels that drive together."
A_NAME = (
    "Names become identifiers in the generated code.",
    "Write name: and a name, such as name: front_left.",
)

COUPLING = Section(
    "a coupling",
    "{equal: [a.steer, b.steer]}",
    (
        Field(
            "equal", ListOf(
                OneOf("wheel.joint"), "[a.spin, b.spin]", least=2, once=True,
                few=("a coupling of {n} joint{s}", "It needs at least two.", "Write equal: [a.steer, b.steer]."),
            ), "joints of one kind whose angles a mechanism keeps equal", required=True,
            aliases=dict.fromkeys(("joints", "belt", "chain", "gear", "gears", "shaft", "same", "coupled"), ""),
        ),
        Field(
            "ratios", ListOf(Amount(Kind.ANY, "1"), "[1, -17/42]"),
            "turns of each joint per turn of a common shaft, negative in the other direction. Spins may have any "
            "ratios, steering angles are equal or opposite ([1, -1]: front and rear wheels steer in opposite "
            "directions)",
            default="all 1",
        ),
    ),
)  # fmt: skip

VIRTUAL = Section(
    "a virtual wheel",
    "{name: front, steers: [front_left, front_right]}",
    (
        Field("name", Name(), "name of the virtual wheel", required=True, missing=A_NAME, example="front"),
        Field("steers", _WHEELS, "wheels that its angle, `name.steer`, steers (an Ackermann pair)"),
        Field("drives", _WHEELS, "wheels that its speed, `name.speed`, drives"),
        Field("x", _LENGTH, "its position forward of P; with y", default=_MIDDLE, missing=_X_AND_Y, example="0.3"),
        Field("y", _LENGTH, "its position left of P; with x", default=_MIDDLE, missing=_X_AND_Y, example="0"),
    ),
    (
        Choice(
            (("steers",), ("drives",)),
            (_ROLE, "Keep one of them."),
            ("has neither steers nor drives", _ROLE,
             "Write steers: [front_left, front_right] or drives: [rear_left, rear_right]."),
        ),
        Choice((("x", "y"),), optional=True),
    ),
)  # fmt: skip

TRAILER = Section(
    "a trailer",
    "{length: 1.1, hitch: 0}",
    (
        Field("name", Name(), "name of the trailer", default="trailer1, trailer2, …", example="cart"),
        Field(
            "length",
            _LENGTH,
            "distance from its hitch to its axle",
            required=True,
            aliases=dict.fromkeys(("l", "wheelbase", "drawbar"), ""),
            example="1.1",
        ),
        Field("hitch", _LENGTH, "distance of its hitch behind the axle in front", default="0", example="0.3"),
    ),
)

CG = Section(
    "cg",
    "cg: {x: 0, y: 0, z: 0.3}",
    (
        Field("x", _LENGTH, "position forward of P", required=True, example="0.05"),
        Field("y", _LENGTH, "position left of P", required=True, example="0"),
        Field("z", _LENGTH, "height above the ground", required=True, example="0.3"),
    ),
)

GAINS = Section(
    "gains",
    "gains: {k_rho: 3, k_alpha: 8, k_beta: -1.5}",
    (
        Field("k_rho", _GAIN, "speed per distance to the goal, for goto_pose", default="3", example="2"),
        Field("k_alpha", _GAIN, "yaw rate per bearing of the goal, for goto_pose", default="8", example="6"),
        Field(
            "k_beta",
            _GAIN,
            "yaw rate per heading error at the goal, for goto_pose",
            default="-1.5",
            example="-1",
        ),
    ),
)


# ---- parameters, wheels and the file

_ANGLE = Amount(Kind.ANGLE)
_JOINTS = ListOf(OneOf("joint"), "[spin]", once=True)
_POLAR, _CARTESIAN = "A position needs both l and alpha.", "A position needs both x and y."
_NO_STEERING_AXIS = "Delete it, and give the position of the contact point by l, alpha or x, y."
_NO_ROLLERS = "Write type: swedish for an omni or mecanum wheel, or delete"

PARAMETER = Section(
    "a parameter",
    "{value: 0.1, tunable: true}",
    (
        Field(
            "value", Amount(Kind.ANY), "the value, which may use other parameters", required=True,
            example="0.1",
        ),
        Field(
            "tunable", Word(YES, "false", interval=Kind.ANY),
            "the parameter remains an input of the generated code, with values from low to high; true: within 10 % of "
            "the value, or within 0.01 (m, rad) if the value is 0", example="[0.09, 0.11]",
        ),
        Field(
            "symbol", Letter(), "its letter in the formulas of reports: a Latin or Greek letter, with or without an "
            "index", default="its name", example="h",
        ),
    ),
)  # fmt: skip

WHEEL = Section(
    "a wheel",
    "{name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.05}",
    (
        Field(
            "name", Name(), "name of the wheel and of its joints, `name.spin` and `name.steer`", required=True,
            missing=A_NAME, example="left",
        ),
        Field(
            "type", OneOf("type"), "type of the wheel", required=True, aliases={"kind": ""},
            missing=("The type decides which motions the wheel allows.", "Write type: and one of {types}."),
        ),
        Field(
            "l", _LENGTH, "distance from the robot's origin P to the wheel's pivot; with alpha",
            aliases={"distance": ""},
            missing=(_POLAR, "Write l: and the distance from the origin to the pivot."), example="12 cm",
        ),
        Field(
            "alpha", _ANGLE, "direction of the pivot seen from P, 0 is forward, pi/2 left; with l", greek="α",
            missing=(_POLAR, "Write alpha: and the direction of the pivot from the origin."), example="60 deg",
        ),
        Field(
            "x", _LENGTH, "pivot position forward of P; with y",
            aliases=dict.fromkeys(("pos", "position", "pose", "xy"), "Write x: and y:.")
            | dict.fromkeys(("pos_x", "position_x", "x_pos"), ""),
            missing=(_CARTESIAN, "Write x: and the distance forward of the origin."), example="20 cm",
        ),
        Field(
            "y", _LENGTH, "pivot position left of P; with x",
            aliases=dict.fromkeys(("pos_y", "position_y", "y_pos"), ""),
            missing=(_CARTESIAN, "Write y: and the distance left of the origin."), example="-15 cm",
        ),
        Field(
            "beta", _ANGLE, "angle of the axle from the line from P to the pivot; for a steered wheel, at steer = 0",
            greek="β", example="pi",
        ),
        Field(
            "heading", _ANGLE, "rolling direction in the robot frame, alpha + beta - pi/2; instead of beta",
            aliases=dict.fromkeys(("theta", "yaw", "orientation", "angle", "direction"), ""), example="90 deg",
        ),
        Field(
            "r", _LENGTH, "wheel radius, not diameter", example="50 mm",
            aliases={
                **dict.fromkeys(("radius", "wheel_radius"), ""),
                **dict.fromkeys(("diameter", "dia"), "Did you mean r? It is the radius: half the diameter."),
            },
            missing=("The speed of the wheel is its spin times r.", "Write r: and the radius, such as r: 50 mm."),
        ),
        Field(
            "gamma", _ANGLE,
            "angle from the wheel plane to the roller axis at the ground: 0 for omni, 45 or -45 deg for mecanum wheels",
            greek="γ", default="0",
            aliases={"roller_angle": "", "rollers": "Did you mean gamma? It is an angle: 45 deg."},
            misfit=(
                "gamma is the angle of the rollers; only swedish wheels have rollers.",
                f"{_NO_ROLLERS} gamma.",
            ),
            example="-45 deg",
        ),
        Field(
            "d", _LENGTH,
            "castor offset: distance from the steering axis to the contact point, along the rolling direction",
            aliases=dict.fromkeys(("trail", "offset", "offset_x", "castor_offset"), ""),
            missing=(
                "d is the distance from the steering axis to the contact point, along the rolling direction. With d = "
                "0 "
                "the wheel would be a steered wheel.",
                "Write d: -40 mm for a wheel that trails its steering axis by 40 mm, or type: steered.",
            ),
            misfit=("d is the offset of a castor from its steering axis; this wheel has none.", _NO_STEERING_AXIS),
            example="-40 mm",
        ),
        Field(
            "offset_y", _LENGTH, "distance of the contact point left of the steering axis, along the axle", default="0",
            aliases=dict.fromkeys(("lateral_offset", "scrub", "axle_offset"), ""),
            misfit=(
                "offset_y is the lateral offset from the steering axis; this wheel has no steering axis.",
                _NO_STEERING_AXIS,
            ),
            example="15 mm",
        ),
        Field(
            "per_steer", Amount(Kind.ANY, "1"),
            "coupling of a swerve module: rotation of the drive joint, as seen at the wheel, for 1 rad of steering "
            "while "
            "the wheel does not roll",
            default="0", aliases=dict.fromkeys(("coupling_ratio", "azimuth_coupling", "couple_ratio"), ""),
            misfit=(
                "per_steer couples a drive to the steering of its wheel; this wheel does not steer.",
                _NO_STEERING_AXIS,
            ),
            example="0.25",
        ),
        Field(
            "r_sw", _LENGTH, "roller radius; the function contacts needs it",
            aliases=dict.fromkeys(("roller_radius", "r_roller"), ""),
            misfit=("r_sw is the roller radius; only swedish wheels have rollers.", f"{_NO_ROLLERS} r_sw."),
            example="6 mm",
        ),
        Field(
            "driven",
            ListOf(
                Amount(Kind.ANGLE), "[0, 90 deg]", most=2,
                many=(
                    "{n} driven directions", "A ball on the ground rolls in two independent directions.",
                    "Write at most two directions.",
                ),
            ),
            "directions in the robot frame in which a ball is driven, without slip. One direction has the joint "
            "`<name>.spin`, two directions have the joints `<name>_1.spin` and `<name>_2.spin`",
            default="none",
            misfit=(
                "driven lists the directions in which a ball is driven; this wheel is not a ball.",
                "Write actuated: [spin], or actuated: [].",
            ),
        ),
        Field(
            "actuated", _JOINTS, "joints that are driven", default="the driven joints of the wheel type",
            aliases=dict.fromkeys(
                ("powered", "drive", "motor", "passive"), "Write actuated: [spin], or actuated: []."
            ),
        ),
        Field("sensed", _JOINTS, "joints that are measured", default="those that are driven"),
        Field(
            "weight", Amount(Kind.ANY, "1"),
            "weight of the wheel in the least squares of forward: 1/4 means twice the noise of a wheel with weight 1",
            default="1", example="1/4",
        ),
        Field("limits", LIMITS, "this wheel's limits; they replace the limits of the robot", example="{spin: 20}"),
        Field("noise", NOISE, "noise of this wheel's joints; it replaces the noise of the robot"),
        Field("encoder", ENCODER, "encoders of this wheel's joints; they replace the encoders of the robot"),
        Field("lag", LAG, "lag of this wheel's joints; it replaces the lag of the robot"),
        Field("joints", JOINTS, "names of this wheel's joints in other tools", aliases={"joint": ""}),
    ),
    (
        Choice(
            (("l", "alpha"), ("x", "y")),
            ("Both give the position of the wheel.", "Keep l and alpha, or x and y."),
            ("has no position", "The kinematics needs the pivot of each wheel in the robot frame (x forward, y left).",
             "Write x: and y:, or l: and alpha: (distance and direction from the origin)."),
        ),
        Choice(
            (("beta",), ("heading",)),
            ("Both give the orientation: heading = alpha + beta - pi/2.", "Keep one of them."),
            ("has no beta or heading",
             "The rolling direction decides which motions the wheel allows; a steered wheel has it at steer = 0.",
             "Write heading: 0 for a wheel that rolls forward, or beta: 0 for a wheel whose axle points to the "
             "origin."),
            optional=True,  # except for wheel types that are `oriented`
        ),
    ),
)  # fmt: skip

ROBOT = Section(
    "a robot file",
    "wmrgen: 1, then name: and wheels:",
    (
        Field(
            "wmrgen", Version("1"), "version of the format", required=True,
            aliases={"version": "Write wmrgen: 1."},
            missing=("It is the version of the format.", "Begin the file with wmrgen: 1."),
        ),
        Field(
            "name", Name(), "name of the robot and of its files", required=True, missing=A_NAME,
            aliases=dict.fromkeys(("robot", "title", "model"), ""), example="my_robot",
        ),
        Field(
            "description", Text(2_000), "description of the robot; the banner and the report print it",
            example="warehouse cart, second prototype",
        ),
        Field("source", Text(2_000), "source of the dimensions", example="drawing 17-3, measured under load"),
        Field(
            "frame", OuterName(False), "name of the robot frame in other tools", default="`base_link`",
            example="chassis_base", aliases=dict.fromkeys(("base", "base_frame", "base_link", "frame_id"), ""),
        ),
        Field(
            "angles",
            Word(
                {"rad": False, "deg": True}, "rad",
                {"degrees": "Did you mean deg?", "radians": "Did you mean rad?"},
            ),
            "unit of angles that are written without a unit",
        ),
        Field(
            "snap", Word(YES, "true"),
            "angles within 2e-3 rad of a multiple of pi/12 are replaced by that multiple",
        ),
        Field(
            "tolerance", _LENGTH,
            "fixed axles that are at most this far apart are treated as one axle; 0: only axles on exactly one line",
            default="1 mm per metre of the robot's size", example="2 mm",
        ),
        Field("parameters", Mapped(PARAMETER, 256), "named lengths, angles and numbers"),
        Field(
            "wheels", ListOf(
                WHEEL, least=1, most=64,
                few=("the list of wheels is empty", "A robot without wheels has no kinematics.", "Add a wheel."),
                many=(
                    "{n} wheels", "At most {most} are derived.",
                    "Leave out passive castors and balls: they do not restrict the motion.",
                ),
            ), "the wheels", required=True,
            missing=("A robot without wheels has no kinematics.", "Write wheels: and a list of wheels."),
        ),
        Field("couplings", ListOf(COUPLING), "joints that a mechanism couples"),
        Field(
            "limits", LIMITS,
            "limits of the robot and of each commanded joint: checked functions accept values in these ranges, prove "
            "assumes them, desaturate enforces them. A passive joint has only the limits of its own wheel",
        ),
        Field(
            "noise", NOISE,
            "noise of each measured joint, independent between joints and between steps, for forward_covariance; the "
            "variance is (proportional * value)**2 + constant**2",
        ),
        Field(
            "deadband", Amount(Kind.ANY, "1"),
            "share of the limits of vx, vy and omega below which limit_twist treats a twist as standstill", default="0",
            example="0.02",
        ),
        Field(
            "gyro", GYRO,
            "noise of a yaw-rate sensor, which forward, forward_covariance and odometry_from_angles then use",
            aliases=dict.fromkeys(("imu", "yaw_rate_sensor", "gyroscope"), ""),
        ),
        Field("encoder", ENCODER, "encoders of each sensed joint, for joints_from_counts"),
        Field("lag", LAG, "lag of each commanded joint, which the state-space model includes"),
        Field(
            "effective_track", _LENGTH,
            "for fixed wheels on several parallel axles, which skid in curves: the robot turns like a differential "
            "drive "
            "with this track, and steered wheels follow. It is measured, and is 1.2 to 2 times the track of the wheels",
            aliases={"skid_track": ""}
            | dict.fromkeys(
                ("track", "track_width", "wheel_separation", "wheelbase", "wheel_base"),
                "Write x: and y: of each wheel; y of a left wheel is half the track.",
            ),
            example="0.6",
        ),
        Field("virtual", ListOf(VIRTUAL), "virtual wheels, each of which represents several real wheels"),
        Field("trailers", ListOf(TRAILER, most=16), "trailers, from the robot backwards"),
        Field(
            "slip", Word(YES, "false"),
            "slip of each wheel, along and across: adds the function slip_inverse and columns of the Pfaffian matrix",
        ),
        Field(
            "precise", Word(YES, "false"),
            "velocities of pivots with more digits than a float has, at the cost of more instructions; for headings "
            "when "
            "the centre of rotation is less than 0.1 mm from a steered wheel",
        ),
        Field("cg", CG, "centre of gravity; the function stability needs it"),
        Field("gains", GAINS, "gains of the control laws"),
        Field(
            "functions", ListOf(OneOf("function"), "[dynamics]", once=True),
            "functions to generate in addition to those that every robot has",
            example="[limit_twist, desaturate]",
        ),
    ),
)  # fmt: skip

# Title in the reference -> section.
SECTIONS = {
    "The file": ROBOT,
    "Each of `wheels`": WHEEL,
    "`limits`, of the robot or of a wheel": LIMITS,
    "`noise`, of the robot or of a wheel": NOISE,
    "`spin` and `steer_rate` of `noise`": RATE_NOISE,
    "`steer` of `noise`": ANGLE_NOISE,
    "`encoder`, of the robot or of a wheel": ENCODER,
    "`spin` of `encoder`": COUNTER,
    "`steer` of `encoder`": STEERING_COUNTER,
    "`gyro`": GYRO,
    "`lag`, of the robot or of a wheel": LAG,
    "`joints` of a wheel": JOINTS,
    "A parameter with more than a value": PARAMETER,
    "Each of `couplings`": COUPLING,
    "Each of `virtual`": VIRTUAL,
    "Each of `trailers`": TRAILER,
    "`cg`": CG,
    "`gains`": GAINS,
}
