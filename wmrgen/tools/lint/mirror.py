"""Left and right partners: wheels that should be mirror images of each other and are not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import combinations
from math import isclose
from typing import NamedTuple

from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.robotfile.names import role
from wmrgen.robotfile.records import Quantity, WheelSpec
from wmrgen.tools.lint.halves import faced, facing
from wmrgen.tools.lint.numbers import APART
from wmrgen.tools.lint.places import labels
from wmrgen.tools.lint.record import PAIR, Finding, Subject, rule

# Calibration changes a parameter by 10 % of its nominal value at most unless the file says otherwise. Partners that
# differ by less may be measured values; UMBmark, for example, gives the two wheels of one robot unequal radii.
_MEASURED = 0.1


class Partners(NamedTuple):
    """A wheel on the left and the wheel on the right that should be its mirror image."""

    left: Wheel
    right: Wheel

    @property
    def midline(self) -> float:
        """Return y of the line halfway between the two pivots [m]."""
        return (self.left.pivot.imag + self.right.pivot.imag) / 2


@rule(
    "WMR015",
    "unequal left and right wheels",
    """A left wheel and its partner on the right have the same radius, the same x and the same limits, and they are
    equally far from the middle of the robot. If one value differs by more than calibration explains, a digit or a unit
    is likely wrong. Partners are wheels of one type whose names differ in left and right only, or the only two of a
    type at one x. On a robot that is really built like this, ignore the finding.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
""",
    PAIR,
)
def unequal(subject: Subject) -> Iterator[Finding]:
    # WMR005 reports a value that is exactly twice its partner's, WMR011 names that contradict the places.
    if any(faced(subject)) or any(labels(subject)):
        return
    pairs = list(_partners(subject.robot))
    if not pairs:
        return
    size = subject.extent[0]
    midline = min((pair.midline for pair in pairs), key=abs)
    for pair in pairs:
        for difference in _differences(subject, pair, midline, size):
            yield Finding(
                subject.mark(pair.right),
                f"{pair.left.name} and {pair.right.name} are no mirror images: {difference}",
                "Look for a wrong digit, unit or sign.",
            )


def _partners(robot: Robot) -> Iterator[Partners]:
    """Yield pairs of one type on two sides: partners by their names, or the only two of the type at one x."""
    face_each_other = list(facing(robot))
    for a, b in combinations(robot.wheels, 2):
        if (a, b) in face_each_other or (a.type == b.type and _names_are_partners(robot, a, b)):
            left, right = (a, b) if a.pivot.imag >= b.pivot.imag else (b, a)
            yield Partners(left, right)


def _names_are_partners(robot: Robot, a: Wheel, b: Wheel) -> bool:
    """Return whether two names differ in left and right only, and no other wheel has one of these roles."""
    roles = Counter(role(w.name) for w in robot.wheels)
    sides_of_a, sides_of_b = role(a.name).split(), role(b.name).split()
    exchanged = [{"left": "right", "right": "left"}.get(side, side) for side in sides_of_a]
    alone = roles[role(a.name)] == roles[role(b.name)] == 1
    return alone and exchanged == sides_of_b != sides_of_a


def _differences(subject: Subject, pair: Partners, midline: float, size: float) -> Iterator[str]:
    """Describe each value in which two partners differ by more than calibration explains."""
    left, right = pair
    r_left, r_right = float(left.nominal.r), float(right.nominal.r)
    differ = not isclose(r_left, r_right, rel_tol=_MEASURED)
    if differ and isclose(r_left, r_right, rel_tol=1 - 1 / APART):  # WMR004 reports radii further apart
        yield f"r is {r_left:.4g} m and {r_right:.4g} m"
    # WMR031, WMR034 and WMR035 report a robot that is degenerate because its wheels are on two axles.
    on_two_axles = subject.mobility.degenerate and subject.robot.effective_track is None
    if abs(left.pivot.real - right.pivot.real) > _MEASURED * size and not on_two_axles:
        yield f"x is {left.pivot.real:.4g} m and {right.pivot.real:.4g} m"
    track = left.pivot.imag - right.pivot.imag
    if abs(pair.midline - midline) > _MEASURED * track:
        yield f"y is {left.pivot.imag:.4g} m and {right.pivot.imag:.4g} m, and the middle is {midline:.4g} m"
    spec_left, spec_right = subject.spec.wheels[left.index], subject.spec.wheels[right.index]
    limits_left, limits_right = _limits(subject, spec_left), _limits(subject, spec_right)
    for name in sorted(set(limits_left) & set(limits_right)):
        low, high = limits_left[name]
        written = limits_right[name]
        if written not in ((low, high), (-high, -low)):  # the same, or mirrored as steering angles are
            yield f"the limits of {name} are [{low:.4g}, {high:.4g}] and [{written[0]:.4g}, {written[1]:.4g}]"


def _limits(subject: Subject, spec: WheelSpec) -> dict[str, tuple[float, float]]:
    """The limits that the file gives a wheel itself, low and high in SI units, rounded to nine digits."""

    def value(quantity: Quantity) -> float:
        return float(f"{subject.value(quantity):.9g}")

    return {limit.name: (value(limit.low), value(limit.high)) for limit in spec.limits}
