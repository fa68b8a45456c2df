"""What a wheel type is, everything that the stages ask of it; and the five of Siegwart's table.

The rows themselves are the same for every type and stand in `wmrgen.geometry.constraints`: geometry that a type
lacks is zero there. A type says which joints and which rows a wheel has, what the robot file may give, and its words.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple


class Check(NamedTuple):
    """What the value of ``key`` must not be. ``bad`` sees the wheel's nominal `Geometry`.

    ``problem`` has the placeholders {what} (the wheel) and {text} (the value as written). ``keeps_sign``: what must
    not reach 0 wherever tunable parameters are, the ``value`` or its ``cosine``; empty where neither says it.
    """

    key: str
    bad: Callable[[Any], bool]
    problem: str
    why: str = ""
    instead: str = ""
    keeps_sign: str = ""


class Words(NamedTuple):
    """The report's words.

    ``intro`` comes before the equations of the type; ``offset_intro`` replaces it where a contact point stands off
    its pivot along the axle. ``free``: why a wheel of the type puts no constraint on the twist. ``equations``:
    numbers of the rolling and sliding equation in section 3.2 of Siegwart, Nourbakhsh and Scaramuzza. ``note``
    follows the equations.
    """

    intro: str
    free: str = ""
    offset_intro: str = ""
    equations: tuple[int, int] | None = None
    note: str = ""


class Glyph(NamedTuple):
    """How the drawing shows a wheel: ``fill`` is a colour, ``width`` the tyre's over its radius.

    ``sign``: half the width [px] of the tyre in the legend. ``ball``: a circle instead of a tyre.
    """

    fill: str
    width: float = 0.42
    sign: int = 3
    ball: bool = False


@dataclass(frozen=True, slots=True)
class WheelType:
    """A wheel type.

    ``meaning``: a line for the schema. ``noun``: "castor", "fixed wheel". ``joints``: of (spin, steer), in this
    order; ``actuated``: those that are driven unless the robot file says otherwise. ``keys``: those that the robot
    file may give beyond the common ones; ``required``: those that it must give, r of a wheel with a spin; a wheel that
    turns and requires d is a castor, one with gamma has rollers. ``oriented``: beta or heading must be given.
    ``powered``: what a wheel of this type is along each direction in which it is driven; only a type that has it takes
    the key driven.
    ``sliding_row``: the contact cannot move freely across the wheel. ``aliases``: what people also call it, with a
    hint. ``misfits``: a key that exists but does not fit, with why and what to write instead.
    """

    name: str
    meaning: str
    noun: str
    joints: tuple[str, ...]
    words: Words
    glyph: Glyph
    actuated: tuple[str, ...] = ()
    keys: tuple[str, ...] = ()
    required: tuple[str, ...] = ()
    oriented: bool = True
    sliding_row: bool = True
    aliases: Mapping[str, str] = field(default_factory=dict)
    misfits: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    checks: tuple[Check, ...] = ()
    powered: WheelType | None = None

    @property
    def label(self) -> str:
        """The noun in a column that is called type."""
        return self.noun.removesuffix(" wheel")

    @property
    def has_spin(self) -> bool:
        """It rolls about an axle, so it has a rolling row."""
        return "spin" in self.joints

    @property
    def directed(self) -> bool:
        """It has a row, so its rolling direction counts."""
        return self.has_spin or self.sliding_row

    @property
    def rolls_across(self) -> bool:
        """It rolls along one direction and moves freely across it, on rollers or as a driven ball."""
        return self.has_spin and not self.sliding_row

    @property
    def turns(self) -> bool:
        """Its rolling direction is a joint."""
        return "steer" in self.joints

    def takes(self, key: str) -> bool:
        """A robot file may give the key or must: of those that not every wheel type has."""
        return key in self.keys or key in self.required

    @property
    def rollers(self) -> bool:
        """It has rollers on its rim, with their axes at gamma from the wheel plane."""
        return self.takes("gamma")

    @property
    def swivels(self) -> bool:
        """Its contact point trails its steering axis, so its steering rate takes up what moves across the wheel."""
        return self.turns and "d" in self.required

    @property
    def constrains(self) -> bool:
        """Its sliding row constrains the twist."""
        return self.sliding_row and not self.swivels

    @property
    def steers(self) -> bool:
        """It constrains the twist, and its steering angle chooses how."""
        return self.constrains and self.turns

    @property
    def fixed_axle(self) -> bool:
        """It constrains the twist by an axle that stands fixed in the body."""
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
    keys=("offset_y", "per_steer"),
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
        Check(
            "r_sw",
            lambda g: g.r_sw.sign <= 0,
            "{what} has r_sw = {text}, which is not positive",
            "",
            "r_sw is the radius of a roller: r_sw: 15 mm. Only the function contacts asks for it.",
            "value",
        ),
        Check(
            "gamma",
            lambda g: abs(float(g.cg)) < 1e-9,
            "{what} has gamma = {text}: the roller axis stands across the wheel plane",
            "The wheel could not drive: its rim speed would turn the rollers only.",
            "gamma is the angle from the wheel plane to the roller axis at the ground: "
            "0 for an omni wheel, 45 deg or -45 deg for a mecanum wheel.",
            "cosine",
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


# A direction in which a ball is driven: it rolls along that direction (Siegwart (3.21)) and moves freely across it.
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

# The spherical wheel: a ball that follows every motion and constrains none (Siegwart (3.21), (3.22)).
SPHERICAL = WheelType(
    name="spherical",
    meaning="a ball that rolls every way, driven in none, one or two directions",
    noun="spherical wheel",
    joints=(),
    keys=("driven",),
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
    powered=_POWERED,
)
