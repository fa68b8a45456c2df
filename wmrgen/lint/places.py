"""Wheels in places or headings that contradict their names, one another or the frame of the robot."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import combinations
from math import hypot

from wmrgen.layout.records import Wheel
from wmrgen.lint.record import PAIR, Finding, Subject, rule

_WORDS = {
    "front": ("x", 1), "fore": ("x", 1), "rear": ("x", -1), "back": ("x", -1), "hind": ("x", -1),
    "left": ("y", 1), "right": ("y", -1),
}  # fmt: skip
_LETTERS = {"f": ("x", 1), "r": ("x", -1), "b": ("x", -1)}  # the first of two: fl, rr, bl
_SIDES = {"l": ("y", 1), "r": ("y", -1)}
_SAME = 1e-6
_NEAR = 0.05  # of the radii


def _contact(w: Wheel) -> complex:
    """The contact at zero steering."""
    arm = complex(float(w.nominal.d), float(w.nominal.o))
    return w.pivot + w.zero_heading * arm


def _middle(wheels: tuple[Wheel, ...]) -> complex:
    """The middle of the rectangle that the pivots fill."""
    at = [w.pivot for w in wheels]
    xs, ys = [p.real for p in at], [p.imag for p in at]
    return complex(max(xs) + min(xs), max(ys) + min(ys)) / 2


@rule(
    "WMR010",
    "two wheels at one place",
    """Two wheels that touch the ground at one point are one wheel written twice, or a sign is missing.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
  - {name: nose,  type: castor, x: 0.3, y: 0, d: -0.04, r: 0.05}
  - {name: tail,  type: castor, x: 0.3, y: 0, d: -0.04, r: 0.05}
""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
  - {name: nose,  type: castor, x: 0.3, y: 0, d: -0.04, r: 0.05}
  - {name: tail,  type: castor, x: -0.3, y: 0, d: -0.04, r: 0.05}
""",
)
def together(subject: Subject) -> Iterator[Finding]:
    for a, b in combinations(subject.robot.wheels, 2):
        if abs(_contact(a) - _contact(b)) <= _NEAR * float(a.nominal.r + b.nominal.r):
            p = _contact(b)
            what = f"{b.name} touches the ground where {a.name} does, at ({p.real:.4g}, {p.imag:.4g})"
            yield Finding(subject.mark(b), what, "Look for a sign that is missing.")


def _claims(name: str) -> Iterator[tuple[str, int, str]]:
    """What a wheel's name says of its place: axis, sign, and the word that says it."""
    for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name):
        low = word.lower()
        if low in _WORDS:
            yield *_WORDS[low], word
        elif len(low) == 2 and low[0] in _LETTERS and low[1] in _SIDES:
            yield *_LETTERS[low[0]], word
            yield *_SIDES[low[1]], word
        elif len(low) == 2 and low[0] in _SIDES and low[1] in _LETTERS:
            yield *_SIDES[low[0]], word
            yield *_LETTERS[low[1]], word


@rule(
    "WMR011",
    "a name that contradicts its place",
    """x points forward and y to the left. A wheel called back_left stands behind the middle of the wheels and left of
    it; where it does not, names or signs are swapped, and every command goes to the wrong motor.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
""",
    PAIR,
)
def labels(subject: Subject) -> Iterator[Finding]:
    middle = _middle(subject.robot.wheels)
    words = {"x": ("behind", "in front of"), "y": ("right of", "left of")}
    for w in subject.robot.wheels:
        off = w.pivot - middle
        for axis, sign, word in _claims(w.name):
            side = off.real if axis == "x" else off.imag
            if side * sign < -_SAME:
                at = w.pivot
                where = f"({at.real:.4g}, {at.imag:.4g}), {words[axis][side > 0]} the middle of the wheels"
                yield Finding(
                    subject.mark(w),
                    f"{w.name} stands at {where}: not {word}",
                    "x points forward, y to the left. Change the sign or the name.",
                )
                break


@rule(
    "WMR012",
    "wheels that roll against each other",
    """Two wheels with one axle direction whose headings point opposite ways turn with opposite signs when the robot
    drives straight. On a differential drive with l and alpha that is the right wheel with beta = 0: its beta is pi.
    Where the joints of the two sides really count opposite ways, as on robots whose motors are mounted mirrored, the
    finding is to be ignored. Omni wheels that stand tangentially are none of these.""",
    """
wheels:
  - {name: left,  type: fixed, l: 0.2, alpha: pi/2,  beta: 0, r: 0.1}
  - {name: right, type: fixed, l: 0.2, alpha: -pi/2, beta: 0, r: 0.1}
""",
    """
wheels:
  - {name: left,  type: fixed, l: 0.2, alpha: pi/2,  beta: 0,  r: 0.1}
  - {name: right, type: fixed, l: 0.2, alpha: -pi/2, beta: pi, r: 0.1}
""",
)
def against(subject: Subject) -> Iterator[Finding]:
    driven = [w for w in subject.robot.wheels if "spin" in w.actuated and not w.turns]
    middle = _middle(subject.robot.wheels)
    for b in driven:
        for a in driven[: driven.index(b)]:
            if abs(a.zero_heading + b.zero_heading) < _SAME and not (
                _tangential(a, middle) and _tangential(b, middle)
            ):
                yield Finding(
                    subject.mark(b),
                    f"{a.name} and {b.name} turn against each other when the robot drives straight",
                    f"Turn {b.name} by pi (beta: pi, or heading: 0), or ignore this where its joint counts that way.",
                )
                break


def _tangential(w: Wheel, middle: complex) -> bool:
    """A wheel with rollers that rolls around the middle."""
    arm = w.pivot - middle
    return w.kind.rollers and abs((w.zero_heading.conjugate() * arm).real) < _SAME + 0.01 * abs(arm)


@rule(
    "WMR013",
    "a castor that leads",
    """d is the distance from a castor's pivot to its contact along its rolling direction: with heading 0 and d > 0 the
    contact lies in front of the pivot at angle 0, where no castor stays when the robot drives forward: it swings round
    to pi. Write d negative, or heading: pi, and angle 0 is the one at which it trails.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
  - {name: tail,  type: castor, x: -0.3, y: 0, heading: 0, d: 0.04, r: 0.05}
""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
  - {name: tail,  type: castor, x: -0.3, y: 0, heading: 0, d: -0.04, r: 0.05}
""",
)
def leading(subject: Subject) -> Iterator[Finding]:
    for spec, w in subject.wheels:
        if w.kind.swivels and spec.d and float(w.nominal.d) > 0 and w.zero_heading.real > 0.5:
            yield Finding(
                spec.d.mark,
                f"{w.name}: d = {spec.d.text} puts the contact in front of the pivot",
                "Write d negative, or heading: pi, for a castor that trails.",
            )


@rule(
    "WMR014",
    "the origin is off the axle",
    """A robot with one fixed axle turns about points of that axle. vx, vy and omega are those of P, the origin: with P
    off the axle a turn moves P sideways, and vy is not 0. Most drivers take P in the middle of the axle. Where another
    origin is meant, such as the centre of gravity, the finding is to be ignored.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0.1, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0.1, y: -0.2, heading: 0, r: 0.1}
""",
    PAIR,
)
def origin(subject: Subject) -> Iterator[Finding]:
    fixed = [w for w in subject.robot.wheels if w.kind.fixed_axle]
    if subject.mobility.rank_C1f.value != 1:
        return
    w = fixed[0]
    off = (w.zero_heading.conjugate() * w.pivot).real
    if abs(off) > _SAME * hypot(*(abs(v.pivot) for v in fixed)):
        yield Finding(
            subject.mark(w),
            f"the axle of {w.name} is {abs(off):.4g} m {'in front of' if off > 0 else 'behind'} the origin P",
            "Give places from the middle of the axle, or ignore this where another origin is meant.",
        )
