"""What a robot file says of joints and of other parts, which `wmrgen.robotfile.keys` has among the keys of robot and
wheel: limits, noise, encoders, lag; couplings, virtual wheels, trailers, centre of gravity, gains."""

from __future__ import annotations

from wmrgen.robotfile.fields import YES, Amount, Choice, Field, Interval, ListOf, Name, OneOf, Section, Word
from wmrgen.robotfile.numbers import Kind

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
