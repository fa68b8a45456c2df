"""The record of a controller: which parameter is which term of its formula, and the formula."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

Distro = Literal["humble", "jazzy", "kilted", "rolling"]
Numbers = Mapping[str, float]  # terms that are numbers: metres, radians, factors
# Term of joints -> a command for each joint, or one for all of them.
Commands = Mapping[str, tuple[float, ...]]
Lengths = Mapping[str, float]  # lengths of a robot [m], by the keys of comparing.quantities.lengths
Names = Mapping[str, str]  # parameter -> term


class Twist(NamedTuple):
    """A commanded twist of the controller's base frame."""

    vx: float  # [m/s]
    vy: float  # [m/s]
    omega: float  # [rad/s]


def with_own_lengths(numbers: Numbers, keys: Mapping[str, str], own: Lengths) -> dict[str, float]:
    """Replace the lengths of a controller by those of a robot.

    Args:
        numbers: The terms of the controller.
        keys: Term -> key of ``own``.
        own: The lengths of the robot [m].

    Returns:
        The terms with every length that the robot has.
    """
    result = dict(numbers)
    for term, key in keys.items():
        if key in own:
            result[term] = own[key]
    return result


@dataclass(frozen=True, slots=True)
class ControllerType:
    """A controller: the names of its parameters, the terms of its formula, and the formula."""

    name: str  # the type that `export` writes, or the class of a Gazebo system
    kind: str  # of drive, as exporting.drives names it
    pattern: re.Pattern[str]  # of types in files
    names: Names  # the parameters of the newest release
    commands: Callable[[Numbers, Twist], Commands]
    # Term of joints -> words for each joint's wheel, such as "rigid right".
    places: Mapping[str, tuple[str, ...]]
    lengths: Mapping[str, str] = field(default_factory=dict)  # term -> key of the robot's lengths
    # Term of a length -> its multipliers.
    factors: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    defaults: Numbers = field(default_factory=dict)  # of terms that a file may leave out
    own_lengths: Callable[[Numbers, Mapping[str, str], Lengths], dict[str, float]] = with_own_lengths
    older: Callable[[Mapping[str, str]], Names] = lambda texts: {}  # older names, by the file's parameters
    reads_older: frozenset[Distro] = frozenset()  # releases that read older names
    reads_only_older: frozenset[Distro] = frozenset()  # releases that read no other names
    older_commands: Mapping[Distro, Callable[[Numbers, Twist], Commands]] = field(default_factory=dict)
    steering: frozenset[str] = frozenset()  # terms whose joints take angles
    strafes: bool = False  # vy is used
    turns_on_spot: bool = True  # omega without vx is used
    tag: str = ""  # a Gazebo system's file

    def formula(self, distro: Distro | None) -> Callable[[Numbers, Twist], Commands]:
        """Return the formula of a release; without a release, the newest one."""
        return self.older_commands.get(distro, self.commands) if distro else self.commands

    def completed(self, numbers: Numbers, own: Lengths) -> dict[str, float]:
        """Return the terms of a controller, with the robot's lengths in place of those that the file leaves out."""
        result, known = dict(numbers), self.own_lengths(numbers, self.lengths, own)
        for term in self.lengths:
            if term not in numbers:
                for key in (term, *self.factors.get(term, ())):
                    if key in known:
                        result[key] = known[key]
        return result

    def known_names(self, distro: Distro | None = None) -> frozenset[str]:
        """Return the parameters that a release knows, including those that it does not need; None: all releases."""
        result: set[str] = set()
        for word in ("true", "false"):
            result |= self.names_of({"front_steering": word}, distro).keys()
        return frozenset(result)

    def names_of(self, texts: Mapping[str, str], distro: Distro | None) -> dict[str, str]:
        """Return parameter -> terms, with spaces between them.

        If a release reads both names of a term, the older one counts, as in the controllers of Jazzy.

        Args:
            texts: Parameters of a file with their texts.
            distro: The release; None: names of every release are read, those of ROS 1 included.

        Returns:
            The older names first.
        """
        reads_older = distro is None or distro in self.reads_older | self.reads_only_older
        older = dict(self.older(texts)) if reads_older else {}
        newer = {} if distro in self.reads_only_older else dict(self.names)
        return {**older, **{name: term for name, term in newer.items() if name not in older}}


def limits(**axes: str) -> dict[str, str]:
    """Return the parameters of the limits of a twist, such as ``linear_x="vx"``, by the terms of drives.limits_of."""
    result = {}
    for axis, name in axes.items():
        group = axis.replace("_", ".")
        for rate, ends in (("", _SPEEDS), ("_rate", _RATES)):
            for key, end in ends.items():
                result[f"{group}.{key}"] = f"{name}{rate}.{end}"
    return result


_SPEEDS = {"max_velocity": "high", "min_velocity": "low"}
_RATES = {
    "max_acceleration": "high",
    "max_deceleration": "low",
    "max_acceleration_reverse": "-high",
    "max_deceleration_reverse": "-low",
}
