"""The records of lint: a rule, the robot that it checks, and a finding; and the function that runs all rules."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from operator import itemgetter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wmrgen.analysis.mobility import Mobility
from wmrgen.errors import Mark, message
from wmrgen.geometry.layout.expressions import Scope
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.robotfile.records import Quantity, RobotSpec, WheelSpec

if TYPE_CHECKING:
    pass

_IGNORED = re.compile(r"#\s*wmrgen:\s*ignore\s+(WMR\d+(?:[,\s]+WMR\d+)*)")


# A robot without findings.
PAIR = """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
"""


class Subject(NamedTuple):
    """A robot in three forms: its file, its layout and its mobility."""

    spec: RobotSpec
    robot: Robot
    mobility: Mobility

    @property
    def wheels(self) -> tuple[tuple[WheelSpec, Wheel], ...]:
        """Return each wheel as written in the file, with its record in the layout."""
        return tuple(zip(self.spec.wheels, self.robot.wheels, strict=True))

    @property
    def extent(self) -> tuple[float, Wheel]:
        """Return the largest distance of two pivots [m] and the second of the two wheels; 0 for a single wheel."""
        places = [(w.pivot, w) for w in self.robot.wheels]
        distances = ((abs(q - p), w) for (p, _), (q, w) in combinations(places, 2))
        return max(distances, key=itemgetter(0), default=(0.0, self.robot.wheels[0]))

    def mark(self, wheel: Wheel) -> Mark:
        """Return the place of a wheel in the file."""
        return self.spec.wheels[wheel.index].mark

    def value(self, quantity: Quantity) -> float:
        """Return the value of a quantity at the nominal parameters, in SI units."""
        scope = Scope({p.name: p.value for p in self.robot.parameters}, {})
        return float(scope.number(scope.poly(quantity)))


@dataclass(frozen=True, slots=True)
class Finding:
    """A likely mistake in a robot file."""

    mark: Mark  # where it is
    what: str  # what is likely wrong
    instead: str = ""  # what to write
    code: str = ""  # of the rule

    @property
    def stops(self) -> bool:
        """Whether `derive` refuses the robot unless the file ignores the finding."""
        return RULES[self.code].stops

    def __str__(self) -> str:
        return message("warning", self.code, self.what, self.mark, [self.instead])


Check = Callable[[Subject], Iterator[Finding]]


class Rule(NamedTuple):
    """A rule of lint. The tests run its examples: ``wrong`` has this finding alone, ``right`` has none."""

    code: str
    title: str  # the name of the mistake
    text: str  # why it is a mistake, and when it is none
    wrong: str  # a robot file without its first two lines
    right: str
    check: Check
    stops: bool = False  # `derive` refuses the robot unless the file ignores the finding


RULES: dict[str, Rule] = {}
DEGREES = "WMR001"
LAYOUT = "WMR010"  # the first rule that is not about numbers


def rule(
    code: str, title: str, text: str, wrong: str, right: str, stops: bool = False
) -> Callable[[Check], Check]:
    """Return a decorator that registers a check in `RULES`.

    Args:
        code: WMR and three digits.
        title: The name of the mistake.
        text: Why it is a mistake, and when it is none.
        wrong: A robot file with the mistake, without its first two lines.
        right: The same robot without the mistake.
        stops: Whether `derive` refuses a robot with the finding.

    Returns:
        The decorator, which returns the check unchanged.
    """

    def register(check: Check) -> Check:
        if code in RULES:
            raise ValueError(f"there are two rules {code}")
        RULES[code] = Rule(
            code, title, " ".join(text.split()), wrong.lstrip("\n"), right.lstrip("\n"), check, stops
        )
        for other in sorted(RULES):  # the order in which they are listed
            RULES[other] = RULES.pop(other)
        return check

    return register


def findings(subject: Subject) -> list[Finding]:
    """Return the findings of all rules in order of place, without those that a comment on the line ignores.

    If an angle in degrees was read as radians, the layout is not the one that was meant. Findings about the layout are
    then left out, except those that stop `derive`.
    """
    reported = list[Finding]()
    for rule in RULES.values():
        for finding in _checked(rule, subject):
            if rule.code not in ignored(finding.mark):
                reported.append(replace(finding, code=rule.code))
    if any(f.code == DEGREES for f in reported):
        reported = [f for f in reported if f.code < LAYOUT or f.stops]
    return sorted(dict.fromkeys(reported), key=lambda f: (f.mark.line, f.mark.column, f.code))


def _checked(rule: Rule, subject: Subject) -> list[Finding]:
    """Return the findings of one rule; none if a size is beyond the range of doubles, which must not stop `derive`."""
    try:
        with np.errstate(all="ignore"):
            return list(rule.check(subject))
    except (OverflowError, ValueError):  # from infinities and NaN; LinAlgError is a ValueError
        return []


def ignored(mark: Mark) -> list[str]:
    """Return the codes in the comment ``# wmrgen: ignore WMR012`` of a line."""
    match = _IGNORED.search(mark.text)
    return re.findall(r"WMR\d+", match[1]) if match else []
