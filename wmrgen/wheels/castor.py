"""The castor: its contact point trails its steering axis, so it follows any motion (Siegwart (3.17), (3.18))."""

from __future__ import annotations

from wmrgen.wheels.record import Check, Glyph, WheelType, Words

CASTOR = WheelType(
    name="castor",
    meaning="a wheel whose contact point trails its steering axis by d",
    noun="castor",
    joints=("spin", "steer"),
    keys=("d", "offset_y"),
    required=("r", "d"),
    oriented=False,
    aliases=dict.fromkeys(("caster", "trailing"), ""),
    checks=(
        Check(
            "d",
            lambda g: not g.d,
            "{name}: a castor with d = 0 is a steered wheel",
            "With the contact point under the pivot the wheel cannot follow: it constrains the robot.",
            "Write type: steered, or give d, the distance from the pivot to the contact along the rolling direction.",
        ),
    ),
    words=Words(
        "A castor's contact point lies off its pivot. Its rolling equation is that of a steered wheel (3.17); "
        "in the sliding equation (3.18) the swivel rate takes up whatever sideways motion the chassis has, so that "
        "it does not constrain the robot:",
        free="a castor swivels into any motion",
        equations=(17, 18),
    ),
    glyph=Glyph("#c9a26b"),
)
