"""The keys of a robot file: the one table that reading, messages, JSON Schema and reference documentation go by."""

from __future__ import annotations

from wmrgen.robotfile.fields import (
    YES,
    Amount,
    Choice,
    Field,
    ListOf,
    Mapped,
    Name,
    OneOf,
    Section,
    Text,
    Version,
    Word,
)  # fmt: skip
from wmrgen.robotfile.numbers import Kind
from wmrgen.robotfile.part_keys import (
    A_NAME,
    ANGLE_NOISE,
    CG,
    COUNTER,
    COUPLING,
    ENCODER,
    GAINS,
    GYRO,
    LAG,
    LIMITS,
    NOISE,
    RATE_NOISE,
    STEERING_COUNTER,
    TRAILER,
    VIRTUAL,
)

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
