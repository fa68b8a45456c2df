"""What a robot file says of the sensors of joints: noise and encoders. `wmrgen.spec.keys` has the other keys."""

from __future__ import annotations

from wmrgen.spec.fields import Amount, Field, Section
from wmrgen.spec.numbers import Kind


def _noise_of(kind: Kind, example: str) -> Section:
    return Section(
        "the noise of a joint",
        example,
        (
            Field(
                "proportional", Amount(Kind.ANY, "1"), "standard deviation in proportion to the value",
                default="0", aliases=dict.fromkeys(("relative", "scale", "percent"), ""),
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
