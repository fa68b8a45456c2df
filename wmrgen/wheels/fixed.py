"""The fixed standard wheel: it rolls in its plane and does not slide across it (Siegwart (3.12), (3.13))."""

from __future__ import annotations

from wmrgen.wheels.record import Glyph, WheelType, Words

FIXED = WheelType(
    name="fixed",
    meaning="a standard wheel that does not steer",
    noun="fixed wheel",
    joints=("spin",),
    actuated=("spin",),
    required=("r",),
    aliases=dict.fromkeys(("standard", "drive", "driven", "wheel", "conventional"), ""),
    words=Words(
        "A fixed wheel rolls without slip in its plane (3.12) and does not slide across it (3.13):",
        equations=(12, 13),
    ),
    glyph=Glyph("#4a5763"),
)
