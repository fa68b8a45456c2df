"""The spherical wheel: a ball that follows every motion and constrains none (Siegwart (3.21), (3.22))."""

from __future__ import annotations

from wmrgen.wheels.record import Glyph, WheelType, Words

SPHERICAL = WheelType(
    name="spherical",
    meaning="a ball that rolls every way",
    noun="spherical wheel",
    joints=(),
    oriented=False,
    sliding_row=False,
    aliases=dict.fromkeys(("ball", "sphere", "slider"), ""),
    words=Words(
        "A ball rolls any way. (3.21) gives its rate for the direction β that (3.22) picks; both follow the "
        "motion, neither constrains it:",
        free="a sphere rolls any way",
        equations=(21, 22),
    ),
    glyph=Glyph("#e3cbe9", width=2.0, ball=True),
)
