"""The steered standard wheel: a fixed wheel whose heading is a joint (Siegwart (3.15), (3.16))."""

from __future__ import annotations

from wmrgen.wheels.record import Glyph, WheelType, Words

_OBEYS = "A steered wheel obeys the same two equations with a moving β(t) = β + ψ, (3.15) and (3.16). "

STEERED = WheelType(
    name="steered",
    meaning="a standard wheel that steers about its own contact point",
    noun="steered wheel",
    joints=("spin", "steer"),
    actuated=("spin", "steer"),
    keys=("offset_y",),
    required=("r",),
    aliases=dict.fromkeys(("steerable", "swerve", "orientable", "centered"), ""),
    misfits={
        "d": (
            "d moves the contact point behind the steering axis, which makes the wheel a castor.",
            "Write type: castor, or delete d (a lateral axle offset is offset_y).",
        )
    },
    words=Words(
        f"{_OBEYS}Its contact point lies under the pivot, so ψ̇ does not occur:",
        offset_intro=f"{_OBEYS}Here the contact point stands off the pivot by o along the axle, so steering rolls "
        "the wheel; the book has no such term:",
        equations=(15, 16),
    ),
    glyph=Glyph("#5b8def"),
)
