"""The record of a wheel type, and the five types of Siegwart's table.

A type has the joints of a wheel, its constraint rows, its keys in the robot file, and its words in the report. The rows
themselves are in `wmrgen.geometry.constraints`; they are the same for all types,
because geometry that a type lacks is zero.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple


class Check(NamedTuple):
    """A check of the value of a key."""

    key: str
    bad: Callable[[Any], bool]  # takes the nominal `Geometry` of the wheel
    problem: str  # the message, with {what} for the wheel and {text} for the value as written
    why: str = ""
    instead: str = ""  # what to write
    keeps_sign: str = (
        ""  # must not reach 0 for any tunable parameter: the "value", its "cosine", or "" for neither
    )


class Words(NamedTuple):
    """The sentences of the report about a wheel type."""

    intro: str  # before the equations
    free: str = ""  # why a wheel of this type does not constrain the twist
    offset_intro: str = ""  # in place of `intro` if the contact point is off its pivot along the axle
    # Numbers of the rolling and sliding equations in section 3.2 of Siegwart, Nourbakhsh and Scaramuzza.
    equations: tuple[int, int] | None = None
    note: str = ""  # after the equations


class Glyph(NamedTuple):
    """How the drawing shows a wheel."""

    fill: str  # a colour
    width: float = 0.42  # of the tyre, divided by its radius
    sign: int = 3  # half the width of the tyre in the legend [px]
    ball: bool = False  # a circle in place of a tyre


@dataclass(frozen=True, slots=True)
class WheelType:
    """A wheel type.

    A wheel that steers and requires d is a castor. A wheel with the key gamma has rollers.
    """

    name: str
    meaning: str  # a phrase for the schema
    noun: str  # such as "castor" or "fixed wheel"
    joints: tuple[str, ...]  # of (spin, steer), in this order
    words: Words
    glyph: Glyph
    actuated: tuple[str, ...] = ()  # joints that are driven by default
    keys: tuple[str, ...] = ()  # keys that a robot file may give, in addition to those of all wheels
    required: tuple[str, ...] = ()  # keys that a robot file must give, among them r for a wheel with a spin
    oriented: bool = True  # whether beta or heading is required
    sliding_row: bool = True  # whether the contact point cannot move freely across the wheel
    aliases: Mapping[str, str] = field(default_factory=dict)  # other names for the type, each with a hint
    # Keys of other types that people might write for this one: why not, and what to write.
    misfits: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    checks: tuple[Check, ...] = ()
    powered: WheelType | None = (
        None  # the type along each direction of the key driven; None if it has no such key
    )

    @property
    def label(self) -> str:
        """The noun without "wheel", for a column of types."""
        return self.noun.removesuffix(" wheel")

    @property
    def has_spin(self) -> bool:
        """Whether the wheel rolls about an axle, so that it has a rolling row."""
        return "spin" in self.joints

    @property
    def directed(self) -> bool:
        """Whether the wheel has a constraint row, so that its rolling direction matters."""
        return self.has_spin or self.sliding_row

    @property
    def rolls_across(self) -> bool:
        """Whether the wheel rolls along one direction and moves freely across it, on rollers or as a driven ball."""
        return self.has_spin and not self.sliding_row

    @property
    def turns(self) -> bool:
        """Whether the wheel has a steering joint."""
        return "steer" in self.joints

    def takes(self, key: str) -> bool:
        """Return whether wheels of this type have a key that is not common to all types."""
        return key in self.keys or key in self.required

    @property
    def rollers(self) -> bool:
        """Whether the wheel has rollers on its rim, with axes at the angle gamma from the wheel plane."""
        return self.takes("gamma")

    @property
    def swivels(self) -> bool:
        """Whether the contact point trails the steering axis, so that the wheel follows any motion, like a castor."""
        return self.turns and "d" in self.required

    @property
    def constrains(self) -> bool:
        """Whether the sliding row constrains the twist."""
        return self.sliding_row and not self.swivels

    @property
    def steers(self) -> bool:
        """Whether the wheel constrains the twist in a direction that its steering angle chooses."""
        return self.constrains and self.turns

    @property
    def fixed_axle(self) -> bool:
        """Whether the wheel constrains the twist by an axle that is fixed in the body."""
        return self.constrains and not self.turns


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
    keys=("offset_y", "per_steer"),
    required=("r",),
    aliases=dict.fromkeys(("steerable", "swerve", "orientable", "centered"), ""),
    misfits={
        "d": (
            "A contact point at a distance d from the steering axis makes the wheel a castor.",
            "Write type: castor, or delete d (a lateral axle offset is offset_y).",
        )
    },
    words=Words(
        f"{_OBEYS}Its contact point is below the pivot, so ψ̇ does not occur:",
        offset_intro=f"{_OBEYS}Here the contact point is at a distance o from the pivot along the axle, so steering "
        "rolls the wheel. The book does not have this term:",
        equations=(15, 16),
    ),
    glyph=Glyph("#56b4e9"),
)


# The castor: its contact point trails its steering axis, so that it follows any motion (Siegwart (3.17), (3.18)).
CASTOR = WheelType(
    name="castor",
    meaning="a wheel whose contact point is at a distance d from its steering axis, along the rolling direction",
    noun="castor",
    joints=("spin", "steer"),
    keys=("offset_y", "per_steer"),
    required=("r", "d"),
    oriented=False,
    aliases=dict.fromkeys(("caster", "trailing"), ""),
    words=Words(
        "The contact point of a castor is off its pivot. Its rolling equation is the one of a steered wheel (3.17). "
        "In the sliding equation (3.18) the swivel rate follows any sideways motion of the chassis, so that the castor "
        "does not constrain the robot:",
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
        Check(
            "r_sw",
            lambda g: g.r_sw.sign <= 0,
            "{what} has r_sw = {text}, which is not positive",
            "",
            "Write the radius of a roller, such as r_sw: 15 mm. Only the function contacts needs it.",
            "value",
        ),
        Check(
            "gamma",
            lambda g: abs(float(g.cg)) < 1e-9,
            "{what} has gamma = {text}: the roller axis is perpendicular to the wheel plane",
            "Such a wheel cannot drive, because its rim speed turns only the rollers.",
            "Write the angle from the wheel plane to the roller axis at the ground: "
            "0 for an omni wheel, 45 deg or -45 deg for a mecanum wheel.",
            "cosine",
        ),
    ),
    words=Words(
        "A Swedish wheel is driven along its wheel plane and moves freely across the axes of its rollers. Only the "
        "component along the roller axis is constrained (3.19). The second line, (3.20), gives the speed of the "
        "rollers:",
        free="a Swedish wheel moves freely across the axes of its rollers",
        equations=(19, 20),
        note="(The book prints (3.20) with −r φ̇ sin γ. With locked rollers, (3.19) and (3.20) together must give the "
        "velocity r φ̇ along the wheel, which requires the plus sign.)",
    ),
    glyph=Glyph("#009e73", width=0.72, sign=4),
)


# A direction in which a ball is driven: the ball rolls along it (Siegwart (3.21)) and moves freely across it.
_POWERED = WheelType(
    name="spherical",
    meaning="a direction in which a ball is driven",
    noun="driven ball",
    joints=("spin",),
    actuated=("spin",),
    required=("r",),
    sliding_row=False,
    words=Words(
        "A driven ball rolls without slip along the direction of its drive roller, (3.21) with that direction for β, "
        "and moves freely across it:",
        free="a driven ball moves freely across the direction in which it is driven",
        equations=(21, 22),
    ),
    glyph=Glyph("#cc79a7", width=2.0, ball=True),
)

# The spherical wheel: a ball that follows any motion (Siegwart (3.21), (3.22)).
SPHERICAL = WheelType(
    name="spherical",
    meaning="a ball that rolls in any direction, driven in none, one or two directions",
    noun="spherical wheel",
    joints=(),
    keys=("driven",),
    oriented=False,
    sliding_row=False,
    aliases=dict.fromkeys(("ball", "sphere", "slider"), ""),
    words=Words(
        "A ball rolls in any direction. (3.22) gives the direction β and (3.21) the rate of its rolling; neither "
        "constrains the motion:",
        free="a sphere rolls in any direction",
        equations=(21, 22),
    ),
    glyph=Glyph("#cc79a7", width=2.0, ball=True),
    powered=_POWERED,
)
