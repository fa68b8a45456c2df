"""What a wheel type is: everything that the stages ask of it.

The rows themselves are the same for every type and stand in `wmrgen.constraints`: geometry that a type lacks is
zero there. A type says which joints and which rows a wheel has, what the robot file may give, and its words.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple


class Check(NamedTuple):
    """What the value of ``key`` must not be. ``bad`` sees the wheel's nominal `Geometry`.

    ``problem`` has the placeholders {what} (the wheel) and {text} (the value as written).
    """

    key: str
    bad: Callable[[Any], bool]
    problem: str
    why: str = ""
    instead: str = ""


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
