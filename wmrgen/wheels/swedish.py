"""The Swedish wheel (omni, mecanum): rollers on its rim let it slide across them (Siegwart (3.19), (3.20))."""

from __future__ import annotations

from wmrgen.wheels.record import Check, Glyph, WheelType, Words

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
        Check("r_sw", lambda g: g.r_sw.sign <= 0, "{name}: roller radius r_sw = {text} is not positive"),
        Check(
            "gamma",
            lambda g: abs(float(g.cg)) < 1e-9,
            "{name}: gamma = {text} puts the roller axis across the wheel plane",
            "The wheel could not drive: its rim speed would turn the rollers only.",
            "gamma is the angle from the wheel plane to the roller axis at the ground: "
            "0 for an omni wheel, 45 deg or -45 deg for a mecanum wheel.",
        ),
    ),
    words=Words(
        "A Swedish wheel is driven along its wheel plane and slides freely across its rollers. Only the component "
        "along the roller axis is enforced (3.19); the second line, (3.20), gives the rollers' own speed:",
        free="the rollers of a Swedish wheel give way across the wheel",
        equations=(19, 20),
        note="(The book prints (3.20) with −r φ̇ sin γ. With the rollers locked, (3.19) and (3.20) must together "
        "give the velocity r φ̇ along the wheel, and only the plus sign does.)",
    ),
    glyph=Glyph("#bfe3d6", width=0.72, sign=4),
)
