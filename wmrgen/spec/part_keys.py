"""What a robot file says beside its wheels: couplings, virtual wheels, trailers, centre of gravity, gains.
`wmrgen.spec.keys` has the other keys."""

from __future__ import annotations

from wmrgen.spec.fields import Amount, Choice, Field, ListOf, Name, OneOf, Section
from wmrgen.spec.numbers import Kind

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
        ),
        Field(
            "ratios", ListOf(Amount(Kind.ANY, "1"), "[1, -17/42]"),
            "of spins that gears keep in proportion: turns of each per turn of a common shaft, negative against it",
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
        Field("length", _LENGTH, "from its coupling to its axle", required=True),
        Field("hitch", _LENGTH, "from the axle in front back to the coupling", default="0"),
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
