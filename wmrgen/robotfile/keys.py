"""The keys of a robot file: the one table for reading, messages, the JSON Schema and the reference page."""

from __future__ import annotations

from wmrgen.robotfile.fields import (
    YES,
    Amount,
    Choice,
    Field,
    Interval,
    ListOf,
    Mapped,
    Name,
    OneOf,
    Section,
    Text,
    Version,
    Word,
)
from wmrgen.robotfile.numbers import Kind

# ---- of joints

LIMITS = Section(
    "limits",
    "limits: {omega: 4.0}",
    (
        Field(
            "vx",
            Interval(Kind.SPEED),
            "speed of P forward",
            aliases=dict.fromkeys(
                ("v", "speed", "velocity", "linear", "max_speed", "max_velocity"),
                "Write vx: for the speed forward, vy: to the left, omega: for the yaw rate.",
            ),
        ),
        Field("vy", Interval(Kind.SPEED), "speed of P to the left"),
        Field(
            "omega",
            Interval(Kind.RATE),
            "yaw rate",
            aliases=dict.fromkeys(("w", "wz", "yaw", "yaw_rate", "angular", "turn"), ""),
        ),
        Field(
            "vx_rate",
            Interval(Kind.ACCELERATION),
            "how fast vx may go towards 0 (braking, -low) and away from it (high), for limit_acceleration and setpoint",
        ),
        Field("vy_rate", Interval(Kind.ACCELERATION), "the same of vy"),
        Field("omega_rate", Interval(Kind.ANGULAR_ACCELERATION), "the same of omega"),
        Field("spin", Interval(Kind.RATE), "rate of a wheel about its axle", joint="spin"),
        Field(
            "steer",
            Interval(Kind.ANGLE),
            "steering angle; inverse commands no other (coupled wheels keep the limits of all of them)",
            joint="steer",
        ),
        Field(
            "steer_rate",
            Interval(Kind.RATE),
            "rate of a steering angle, which steer_toward keeps",
            joint="steer",
        ),
        Field(
            "spin_rate", Interval(Kind.ANGULAR_ACCELERATION), "acceleration of a wheel about its axle", joint="spin",
            aliases=dict.fromkeys(("spin_acceleration", "wheel_acceleration"), ""),
        ),
        Field(
            "steer_acceleration", Interval(Kind.ANGULAR_ACCELERATION), "how fast steer_rate may change", joint="steer",
            aliases=dict.fromkeys(("steer_rate_rate", "steering_acceleration"), ""),
        ),
    ),
)  # fmt: skip


def _noise_of(kind: Kind, example: str) -> Section:
    return Section(
        "the noise of a joint",
        example,
        (
            Field(
                "proportional", Amount(Kind.ANY, "1"), "standard deviation in proportion to the value",
                default="0", example="0.02", aliases=dict.fromkeys(("relative", "scale", "percent"), ""),
            ),
            Field(
                "constant", Amount(kind), "standard deviation at any value", default="0",
                aliases=dict.fromkeys(("sigma", "std", "stddev", "absolute"), ""),
            ),
        ),
    )  # fmt: skip


RATE_NOISE = _noise_of(Kind.RATE, "spin: {proportional: 0.02, constant: 0.01 rad/s}")
ANGLE_NOISE = _noise_of(Kind.ANGLE, "steer: {constant: 0.5 deg}")
_WHOSE = "of measured"
NOISE = Section(
    "noise",
    "noise: {spin: {proportional: 0.02, constant: 0.01 rad/s}, steer: {constant: 0.5 deg}}",
    (
        Field("spin", RATE_NOISE, f"{_WHOSE} wheel speeds", joint="spin"),
        Field("steer", ANGLE_NOISE, f"{_WHOSE} steering angles", joint="steer"),
        Field("steer_rate", RATE_NOISE, f"{_WHOSE} steering rates", joint="steer"),
    ),
)

GYRO = Section(
    "gyro",
    "gyro: {constant: 0.005 rad/s}",
    (
        *RATE_NOISE.fields,
        Field(
            "weight", Amount(Kind.ANY, "1"),
            "how much it counts in forward: 1 is as much as a wheel at the mean distance of the sensed wheels from "
            "their middle; 100 is taken for a tenth of that noise",
            default="1",
        ),
    ),
)  # fmt: skip

WRAPS = Choice(
    (("bits",), ("modulus",)),
    ("has {keys}", "Both say where the counter wraps.", "Keep one of them."),
    optional=True,
)
_COUNTER = (
    Field(
        "counts", Amount(Kind.ANY, "1"), "counts per turn of the encoder's shaft, all four edges of a quadrature",
        required=True, example="4096", aliases=dict.fromkeys(("cpr", "ticks", "resolution", "ppr", "lines"), ""),
        missing=("It turns counts into an angle.", "Write counts: and the counts per turn, such as counts: 4096."),
    ),
    Field(
        "gear", Amount(Kind.ANY, "1"), "turns of the encoder's shaft per turn of the joint", default="1",
        example="30", aliases=dict.fromkeys(("ratio", "gear_ratio", "gearing", "reduction"), ""),
    ),
    Field(
        "reversed", Word(YES, "false"), "it counts down where the joint turns in its positive direction",
        aliases=dict.fromkeys(("inverted", "invert", "reverse"), ""),
    ),
    Field(
        "bits", Amount(Kind.ANY, "1"), "width of the counter, from 8 to 32: it wraps at 2**bits", default="32",
        example="16",
    ),
    Field(
        "modulus", Amount(Kind.ANY, "1"), "where a counter wraps that wraps elsewhere: it counts from 0 to modulus - 1",
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
            "what an absolute encoder shows where steer is 0; it wraps at counts, after a turn of its shaft, unless "
            "bits or modulus says otherwise. Without it the encoder is incremental, and the angle starts from that in "
            "wheels",
            example="512", aliases=dict.fromkeys(("zero", "absolute", "home"), ""),
        ),
    ),
    (WRAPS,),
)  # fmt: skip
ENCODER = Section(
    "encoder",
    "encoder: {spin: {counts: 4096, gear: 30, reversed: true, bits: 16}, steer: {counts: 16384}}",
    (
        Field("spin", COUNTER, "on the motor or the axle of the wheel", joint="spin"),
        Field("steer", STEERING_COUNTER, "of the steering angle, incremental or absolute", joint="steer"),
    ),
)

LAG = Section(
    "lag",
    "lag: {steer: 150 ms}",
    (
        Field(
            "steer", Amount(Kind.TIME),
            "time constant with which a steering angle follows its command: steer' = (command - steer)/lag",
            joint="steer",
        ),
    ),
)  # fmt: skip

_LENGTH, _GAIN = Amount(Kind.LENGTH), Amount(Kind.ANY, "1/s")
_WHEELS = ListOf(
    OneOf("wheel"), "[front_left, front_right]", least=1, once=True,
    few=("{key} names no wheel", "", "Write {key}: [front_left, front_right]."),
)  # fmt: skip
_MIDDLE = "the middle of its wheels"
_X_AND_Y = "It has one of x and y.", "Write both or none."
_ROLE = "It stands for wheels that steer together, or for wheels that drive together."
A_NAME = "Names become identifiers in the generated code.", "Write name: and a word such as front_left."

COUPLING = Section(
    "a coupling",
    "{equal: [a.steer, b.steer]}",
    (
        Field(
            "equal", ListOf(
                OneOf("wheel.joint"), "[a.spin, b.spin]", least=2, once=True,
                few=("a coupling of {n} joint{s}", "It takes two to be equal.", "Write equal: [a.steer, b.steer]."),
            ), "joints of one kind whose angles a mechanism keeps equal", required=True,
            aliases=dict.fromkeys(("joints", "belt", "chain", "gear", "gears", "shaft", "same", "coupled"), ""),
        ),
        Field(
            "ratios", ListOf(Amount(Kind.ANY, "1"), "[1, -17/42]"),
            "turns of each joint per turn of a common shaft, negative against it: spins in any proportion, steering "
            "angles equal or opposite ([1, -1]: front and rear wheels steered against each other)",
            default="all 1",
        ),
    ),
)  # fmt: skip

VIRTUAL = Section(
    "a virtual wheel",
    "{name: front, steers: [front_left, front_right]}",
    (
        Field("name", Name(), "name of the virtual wheel", required=True, missing=A_NAME),
        Field("steers", _WHEELS, "its angle, `name.steer`, steers these wheels (an Ackermann pair)"),
        Field("drives", _WHEELS, "its speed, `name.speed`, drives these wheels"),
        Field("x", _LENGTH, "its place forward of P; with y", default=_MIDDLE, missing=_X_AND_Y),
        Field("y", _LENGTH, "its place left of P; with x", default=_MIDDLE, missing=_X_AND_Y),
    ),
    (
        Choice(
            (("steers",), ("drives",)),
            ("has {keys}", _ROLE, "Keep one of them."),
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
        Field("name", Name(), "name of the trailer", default="trailer1, trailer2, …"),
        Field(
            "length",
            _LENGTH,
            "from its hitch to its axle",
            required=True,
            aliases=dict.fromkeys(("l", "wheelbase", "drawbar"), ""),
        ),
        Field("hitch", _LENGTH, "how far its hitch lies behind the axle in front", default="0"),
    ),
)

CG = Section(
    "cg",
    "cg: {x: 0, y: 0, z: 0.3}",
    (
        Field("x", _LENGTH, "forward of P", required=True),
        Field("y", _LENGTH, "left of P", required=True),
        Field("z", _LENGTH, "above the ground", required=True),
    ),
)

GAINS = Section(
    "gains",
    "gains: {k_rho: 3, k_alpha: 8, k_beta: -1.5}",
    (
        Field("k_rho", _GAIN, "speed per distance to the goal; goto_pose", default="3"),
        Field("k_alpha", _GAIN, "yaw rate per bearing of the goal; goto_pose", default="8"),
        Field("k_beta", _GAIN, "yaw rate per heading left over at the goal; goto_pose", default="-1.5"),
    ),
)


# ---- of a wheel

_LENGTH, _ANGLE = Amount(Kind.LENGTH), Amount(Kind.ANGLE)
_JOINTS = ListOf(OneOf("joint"), "[spin]", once=True)
_PLACE = "A place is l with alpha.", "A place is x with y."
_NO_STEERING_AXIS = "Put the contact point itself in l, alpha or x, y."
_NO_ROLLERS = "Write type: swedish for an omni or mecanum wheel, or delete"

PARAMETER = Section(
    "a parameter",
    "{value: 0.1, tunable: true}",
    (
        Field(
            "value", Amount(Kind.ANY), "the value, which may use other parameters", required=True, example="0.1",
        ),
        Field(
            "tunable", Word(YES, "false", interval=Kind.ANY),
            "the parameter stays an input of the generated code, for values from low to high; true: within 10 % of the "
            "value, 0.01 (m, rad) where that is 0", example="[0.09, 0.11]",
        ),
    ),
)  # fmt: skip

WHEEL = Section(
    "a wheel",
    "{name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.05}",
    (
        Field("name", Name(), "name of the wheel, which its joints bear", required=True, missing=A_NAME),
        Field(
            "type", OneOf("type"), "type of the wheel", required=True, aliases={"kind": ""},
            missing=("It decides what the wheel constrains.", "Write type: and one of {types}."),
        ),
        Field(
            "l", _LENGTH, "distance from the robot's origin P to the wheel's pivot; with alpha",
            aliases={"distance": ""},
            missing=(_PLACE[0], "Write l: and the distance from the origin to the pivot."),
        ),
        Field(
            "alpha", _ANGLE, "direction of the pivot seen from P, 0 is forward, pi/2 left; with l", greek="α",
            missing=(_PLACE[0], "Write alpha: and the direction of the pivot from the origin."),
        ),
        Field(
            "x", _LENGTH, "pivot position forward of P; with y",
            aliases=dict.fromkeys(("pos", "position", "pose", "xy"), "Write x: and y:.")
            | dict.fromkeys(("pos_x", "position_x", "x_pos"), ""),
            missing=(_PLACE[1], "Write x: and the distance forward of the origin."),
        ),
        Field(
            "y", _LENGTH, "pivot position left of P; with x",
            aliases=dict.fromkeys(("pos_y", "position_y", "y_pos"), ""),
            missing=(_PLACE[1], "Write y: and the distance left of the origin."),
        ),
        Field(
            "beta", _ANGLE, "angle of the axle from the line P to pivot, for steering wheels at zero steer",
            greek="β",
        ),
        Field(
            "heading", _ANGLE, "rolling direction in the robot frame, alpha + beta - pi/2; instead of beta",
            aliases=dict.fromkeys(("theta", "yaw", "orientation", "angle", "direction"), ""),
        ),
        Field(
            "r", _LENGTH, "wheel radius, not diameter", example="50 mm",
            aliases={
                **dict.fromkeys(("radius", "wheel_radius"), ""),
                **dict.fromkeys(("diameter", "dia"), "Did you mean r? It is the radius: half the diameter."),
            },
            missing=("The radius turns spin [rad/s] into speed [m/s].", "Write r: and the radius, such as r: 50 mm."),
        ),
        Field(
            "gamma", _ANGLE,
            "from the wheel plane to the roller axis at the ground: 0 omni, 45 or -45 deg mecanum",
            greek="γ", default="0",
            aliases={"roller_angle": "", "rollers": "Did you mean gamma? It is an angle: 45 deg."},
            misfit=(
                "gamma is the roller axis at the ground against the wheel plane; only swedish wheels have rollers.",
                f"{_NO_ROLLERS} gamma.",
            ),
        ),
        Field(
            "d", _LENGTH, "castor offset: steering axis to contact point, along the rolling direction",
            aliases=dict.fromkeys(("trail", "offset", "offset_x", "castor_offset"), ""),
            missing=(
                "d runs from the steering axis to the contact point, along the rolling direction; with d = 0 the wheel "
                "is a steered one.",
                "Write d: -40 mm for a wheel that trails by 40 mm where it rolls along its heading, or type: steered.",
            ),
            misfit=("d is the castor offset from the steering axis, and this wheel has none.", _NO_STEERING_AXIS),
        ),
        Field(
            "offset_y", _LENGTH, "contact point left of the steering axis, along the axle", default="0",
            aliases=dict.fromkeys(("lateral_offset", "scrub", "axle_offset"), ""),
            misfit=(
                "offset_y is the lateral offset from the steering axis, and this wheel has none.",
                _NO_STEERING_AXIS,
            ),
        ),
        Field(
            "per_steer", Amount(Kind.ANY, "1"),
            "coupling of a swerve module: turn of the drive joint, seen at the wheel, for 1 rad of steering while the "
            "wheel does not roll",
            default="0", aliases=dict.fromkeys(("coupling_ratio", "azimuth_coupling", "couple_ratio"), ""),
            misfit=(
                "per_steer couples a drive to the steering of its wheel, and this wheel has none.",
                _NO_STEERING_AXIS,
            ),
        ),
        Field(
            "r_sw", _LENGTH, "roller radius, for the function contacts",
            aliases=dict.fromkeys(("roller_radius", "r_roller"), ""),
            misfit=("r_sw is the roller radius; only swedish wheels have rollers.", f"{_NO_ROLLERS} r_sw."),
        ),
        Field(
            "driven",
            ListOf(
                Amount(Kind.ANGLE), "[0, 90 deg]", most=2,
                many=(
                    "{n} driven directions", "A ball on the ground rolls in two independent directions.",
                    "Write the directions of two drive rollers.",
                ),
            ),
            "directions in the robot frame in which a ball is driven: it rolls along each and slides along none. One "
            "direction is the joint `<name>.spin`; of two, the joints are `<name>_1.spin` and `<name>_2.spin`",
            default="none",
            misfit=(
                "driven lists the directions in which a ball is driven.",
                "Write actuated: [spin], or actuated: [].",
            ),
        ),
        Field(
            "actuated", _JOINTS, "joints that are driven", default="those of the wheel type",
            aliases=dict.fromkeys(
                ("powered", "drive", "motor", "passive"), "Write actuated: [spin], or actuated: []."
            ),
        ),
        Field("sensed", _JOINTS, "joints that are measured", default="those that are driven"),
        Field(
            "weight", Amount(Kind.ANY, "1"),
            "how much the wheel counts in forward beside other wheels: one of weight 1/4 is taken for twice as noisy",
            default="1",
        ),
        Field("limits", LIMITS, "limits of this wheel's joints, before those of the robot", example="{spin: 20}"),
        Field("noise", NOISE, "noise of this wheel's joints, before that of the robot"),
        Field("encoder", ENCODER, "encoders of this wheel's joints, before those of the robot"),
        Field("lag", LAG, "lag of this wheel's joints, before that of the robot"),
    ),
    (
        Choice(
            (("l", "alpha"), ("x", "y")),
            ("is placed twice: by {keys}", "They say the same thing and could disagree.",
             "Keep l and alpha, or x and y."),
            ("has no place", "Kinematics needs the pivot of every wheel in the robot frame, x forward and y left.",
             "Write x: and y:, or l: and alpha: (distance and direction from the origin)."),
        ),
        Choice(
            (("beta",), ("heading",)),
            ("has {keys}", "Both give the orientation: heading = alpha + beta - pi/2.", "Keep one of them."),
            ("has no beta or heading",
             "The rolling direction decides what the wheel allows; where it steers it is the zero of steer.",
             "Write heading: 0 for a wheel that rolls forward, beta: 0 for one whose axle points to the origin."),
            optional=True,  # but for the wheel types that say otherwise
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
            missing=("It tells the format version.", "Begin the file with wmrgen: 1."),
        ),
        Field(
            "name", Name(), "name of the robot and of its files", required=True, missing=A_NAME,
            aliases=dict.fromkeys(("robot", "title", "model"), ""),
        ),
        Field("description", Text(2_000), "what robot it is, for the banner and the report"),
        Field("source", Text(2_000), "where the dimensions come from"),
        Field(
            "angles",
            Word(
                {"rad": False, "deg": True}, "rad",
                {"degrees": "Did you mean deg?", "radians": "Did you mean rad?"},
            ),
            "unit of angles that are written without one",
        ),
        Field(
            "snap", Word(YES, "true"),
            "angles within 2e-3 rad of a multiple of pi/12 are taken for that multiple",
        ),
        Field(
            "tolerance", _LENGTH, "fixed axles that miss one another by this or less are taken for one; 0 for none",
            default="1 mm per metre of the robot's size",
        ),
        Field("parameters", Mapped(PARAMETER, 256), "named lengths, angles and numbers"),
        Field(
            "wheels", ListOf(
                WHEEL, least=1, most=64,
                few=("the list of wheels is empty", "A robot without wheels has no kinematics.", "Add a wheel."),
                many=(
                    "{n} wheels", "At most {most} are derived.",
                    "Leave out passive castors and balls: they constrain nothing.",
                ),
            ), "the wheels", required=True,
            missing=("A robot without wheels has no kinematics.", "Write wheels: and a list of wheels."),
        ),
        Field("couplings", ListOf(COUPLING), "joints that move alike"),
        Field(
            "limits", LIMITS,
            "limits of the robot and of every joint that is commanded: ranges that checked functions accept, that "
            "prove needs and that desaturate keeps. A passive joint has none but its wheel's own",
        ),
        Field(
            "noise", NOISE,
            "noise of every joint that is measured, independent from joint to joint and from step to step, for "
            "forward_covariance: its variance is (proportional value)**2 + constant**2",
        ),
        Field(
            "deadband", Amount(Kind.ANY, "1"),
            "share of the limits of vx, vy and omega below which limit_twist takes a twist for standstill", default="0",
        ),
        Field(
            "gyro", GYRO, "a yaw-rate sensor, a row of forward, its covariance and odometry_from_angles; its noise",
            aliases=dict.fromkeys(("imu", "yaw_rate_sensor", "gyroscope"), ""),
        ),
        Field("encoder", ENCODER, "encoders of every joint that is sensed, for joints_from_counts"),
        Field("lag", LAG, "lag of every joint that is commanded, which the state space takes in"),
        Field(
            "effective_track", _LENGTH,
            "of fixed wheels on several parallel axles, which skid in curves: the robot turns as if its fixed wheels "
            "were a differential drive with this track, and steered wheels follow; 1.2 to 2 times the track of its "
            "wheels, measured",
            aliases={"skid_track": ""}
            | dict.fromkeys(
                ("track", "track_width", "wheel_separation", "wheelbase", "wheel_base"),
                "Give the places of wheels, x: and y: of each; half the track is y of a left wheel.",
            ),
        ),
        Field("virtual", ListOf(VIRTUAL), "wheels that are not there and stand for real ones"),
        Field("trailers", ListOf(TRAILER, most=16), "trailers, from the robot backwards"),
        Field(
            "slip", Word(YES, "false"),
            "slip of every wheel, along and across: the function slip_inverse, columns of the Pfaffian matrix",
        ),
        Field(
            "precise", Word(YES, "false"),
            "velocities of pivots in more digits than a float has, for headings with the centre of rotation less than "
            "0.1 mm from a steered wheel: coefficients in two floats, more instructions",
        ),
        Field("cg", CG, "centre of gravity, for the function stability"),
        Field("gains", GAINS, "gains of the control laws"),
        Field(
            "functions", ListOf(OneOf("function"), "[dynamics]", once=True),
            "functions to be generated beyond those that every robot has",
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
    "A parameter with more than a value": PARAMETER,
    "Each of `couplings`": COUPLING,
    "Each of `virtual`": VIRTUAL,
    "Each of `trailers`": TRAILER,
    "`cg`": CG,
    "`gains`": GAINS,
}
