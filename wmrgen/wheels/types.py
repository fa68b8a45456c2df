"""The five wheel types of Siegwart's table: what each is, has and needs, and how readers are told of it."""

from __future__ import annotations

from wmrgen.wheels.record import Check, Glyph, WheelType, Words

# The fixed standard wheel: it rolls in its plane and does not slide across it (Siegwart (3.12), (3.13)).
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
    glyph=Glyph("#4d4d4d"),
)


# The steered standard wheel: a fixed wheel whose heading is a joint (Siegwart (3.15), (3.16)).
_OBEYS = (
    "A steered wheel obeys the two equations of a fixed wheel with a moving β(t) = β + ψ, (3.15) and (3.16). "
)

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
    glyph=Glyph("#56b4e9"),
)


# The castor: its contact point trails its steering axis, so it follows any motion (Siegwart (3.17), (3.18)).
CASTOR = WheelType(
    name="castor",
    meaning="a wheel whose contact point stands off its steering axis by d, along the rolling direction",
    noun="castor",
    joints=("spin", "steer"),
    keys=("offset_y",),
    required=("r", "d"),
    oriented=False,
    aliases=dict.fromkeys(("caster", "trailing"), ""),
    words=Words(
        "A castor's contact point lies off its pivot. Its rolling equation is that of a steered wheel (3.17); "
        "in the sliding equation (3.18) the swivel rate takes up whatever sideways motion the chassis has, so that "
        "it does not constrain the robot:",
        free="a castor swivels into any motion",
        equations=(17, 18),
    ),
    glyph=Glyph("#e69f00"),
)


# The Swedish wheel (omni, mecanum): rollers on its rim let it slide across them (Siegwart (3.19), (3.20)).
SWEDISH = WheelType(
    name="swedish",
    meaning="an omni or mecanum wheel: rollers on its rim",
    noun="Swedish wheel",
    joints=("spin",),
    actuated=("spin",),
    keys=("gamma", "r_sw"),
    required=("r",),
    sliding_row=False,
    aliases={
        **dict.fromkeys(
            ("omni", "omniwheel", "swedish90", "swedish-90"), "An omni wheel is swedish with gamma: 0."
        ),
        **dict.fromkeys(
            ("mecanum", "swedish45", "swedish-45"),
            "A mecanum wheel is swedish with gamma: 45 deg or -45 deg at the ground.",
        ),
    },
    checks=(
        Check("r_sw", lambda g: g.r_sw.sign <= 0, "{what} has r_sw = {text}, which is not positive"),
        Check(
            "gamma",
            lambda g: abs(float(g.cg)) < 1e-9,
            "{what} has gamma = {text}: the roller axis stands across the wheel plane",
            "The wheel could not drive: its rim speed would turn the rollers only.",
            "gamma is the angle from the wheel plane to the roller axis at the ground: "
            "0 for an omni wheel, 45 deg or -45 deg for a mecanum wheel.",
        ),
    ),
    words=Words(
        "A Swedish wheel is driven along its wheel plane and moves freely across the axes of its rollers. Only the "
        "component along the roller axis is enforced (3.19); the second line, (3.20), gives the rollers' own speed:",
        free="a Swedish wheel moves freely across the axes of its rollers",
        equations=(19, 20),
        note="(The book prints (3.20) with −r φ̇ sin γ. With the rollers locked, (3.19) and (3.20) must together "
        "give the velocity r φ̇ along the wheel, and only the plus sign does.)",
    ),
    glyph=Glyph("#009e73", width=0.72, sign=4),
)


# The spherical wheel: a ball that follows every motion and constrains none (Siegwart (3.21), (3.22)).
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
    glyph=Glyph("#cc79a7", width=2.0, ball=True),
)
