"""A rule, what it looks at, and what it finds."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from itertools import combinations
from operator import itemgetter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from wmrgen.analysis.mobility import Mobility
from wmrgen.errors import Mark, UsageError, message
from wmrgen.geometry.layout.expressions import Scope
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.robotfile.records import Quantity, RobotSpec, WheelSpec
from wmrgen.robotfile.text import quoted

if TYPE_CHECKING:
    from wmrgen.robotfile.mistakes import Mistake

_IGNORED = re.compile(r"#\s*wmrgen:\s*ignore\s+(WMR\d+(?:[,\s]+WMR\d+)*)")


# A robot with which nothing is wrong.
PAIR = """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
"""


class Subject(NamedTuple):
    """A robot: what its file says, its layout, and what that can do."""

    spec: RobotSpec
    robot: Robot
    mobility: Mobility

    @property
    def wheels(self) -> tuple[tuple[WheelSpec, Wheel], ...]:
        """Each wheel as written and as laid out."""
        return tuple(zip(self.spec.wheels, self.robot.wheels, strict=True))

    @property
    def extent(self) -> tuple[float, Wheel]:
        """The largest distance of two pivots [m], and the second wheel of them; 0 for a single wheel."""
        places = [(w.pivot, w) for w in self.robot.wheels]
        distances = ((abs(q - p), w) for (p, _), (q, w) in combinations(places, 2))
        return max(distances, key=itemgetter(0), default=(0.0, self.robot.wheels[0]))

    def mark(self, wheel: Wheel) -> Mark:
        """The place of a wheel."""
        return self.spec.wheels[wheel.index].mark

    def value(self, quantity: Quantity) -> float:
        """What a quantity is worth at the nominal parameters, SI units."""
        scope = Scope({p.name: p.value for p in self.robot.parameters}, {})
        return float(scope.number(scope.poly(quantity)))


@dataclass(frozen=True, slots=True)
class Finding:
    """``what`` is likely wrong at ``mark``, and what to write instead. ``code``: of the rule."""

    mark: Mark
    what: str
    instead: str = ""
    code: str = ""

    @property
    def stops(self) -> bool:
        """`derive` goes on only where the file says to ignore it."""
        return RULES[self.code].stops

    def __str__(self) -> str:
        return message("warning", self.code, self.what, self.mark, [self.instead])


Check = Callable[[Subject], Iterator[Finding]]


class Rule(NamedTuple):
    """``title``: the mistake. ``text``: why it is one, and when it is none. ``wrong``, ``right``: robot files without
    their first two lines; the rule finds something in the first, and no rule anything in the second.
    ``stops``: `derive` goes on only where the file says to ignore it."""

    code: str
    title: str
    text: str
    wrong: str
    right: str
    check: Check
    stops: bool = False


RULES: dict[str, Rule] = {}
DEGREES = "WMR001"
LAYOUT = "WMR010"  # the first rule that is not about numbers


def rule(
    code: str, title: str, text: str, wrong: str, right: str, stops: bool = False
) -> Callable[[Check], Check]:
    """Enter a check into `RULES`."""

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
    """What all rules find, in order of place; without what the file says is to be ignored on its line. Where degrees
    were taken for radians the layout is not the one that is meant: of it nothing is told but what stops `derive`."""
    every = [replace(f, code=rule.code) for rule in RULES.values() for f in _checked(rule, subject)]
    told = [f for f in every if f.code not in ignored(f.mark)]
    if any(f.code == DEGREES for f in told):
        told = [f for f in told if f.code < LAYOUT or f.stops]
    return sorted(dict.fromkeys(told), key=lambda f: (f.mark.line, f.mark.column, f.code))


def _checked(rule: Rule, subject: Subject) -> list[Finding]:
    """What a rule finds; nothing where a size is beyond the range of doubles, which must not stop `derive`."""
    try:
        with np.errstate(all="ignore"):
            return list(rule.check(subject))
    except (OverflowError, ValueError):  # of infinities and of NaN, LinAlgError among them
        return []


def ignored(mark: Mark) -> list[str]:
    """The codes of the comment ``# wmrgen: ignore WMR012`` on a line."""
    match = _IGNORED.search(mark.text)
    return re.findall(r"WMR\d+", match[1]) if match else []


def rule_called(code: str, rules: Mapping[str, Rule | Mistake]) -> Rule | Mistake:
    """What of ``rules`` a code stands for, in any case. UsageError where it stands for nothing."""
    if code.upper() not in rules:
        near = "".join(f" Did you mean {c}?" for c in get_close_matches(code.upper()[:20], rules, 1))
        raise UsageError(f"{quoted(code)} is not the code of a rule.{near} `wmrgen explain` lists them.")
    return rules[code.upper()]
