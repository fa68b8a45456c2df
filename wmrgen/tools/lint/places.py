"""Rules about places and headings of wheels that contradict their names, each other or the frame of the robot."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import combinations

from wmrgen.geometry.layout.records import Wheel
from wmrgen.geometry.notation import listed
from wmrgen.robotfile.names import role
from wmrgen.tools.lint.halves import faced
from wmrgen.tools.lint.record import PAIR, Finding, Subject, rule

_NOSE = PAIR + "  - {name: nose,  type: castor, x: 0.3, y: 0, d: -0.04, r: 0.05}\n"
_OPPOSITE = {"front": "behind", "rear": "in front of", "left": "right of", "right": "left of"}
_SAME = 1e-6  # [m]; equal but for rounding of decimals
_OUTSIDE = 2.0  # distance of P from the middle of the wheels, over their largest distance from it
_ORIGIN = "Measure places from the middle of the axle, or ignore this finding if another origin is meant."
_NEAR = 0.05  # share of the radii, or of the robot if that is smaller: nearer contacts are one
_OPPOSED = 0.05  # [rad]; headings that differ by less are parallel
_OBLIQUE = 0.7  # sine of twice the angle to the axes; cosine of that between arm and heading


def _middle(wheels: tuple[Wheel, ...]) -> complex:
    """Return the middle of the rectangle around the pivots: x + iy [m]."""
    at = [w.pivot for w in wheels]
    xs, ys = [p.real for p in at], [p.imag for p in at]
    return complex(max(xs) + min(xs), max(ys) + min(ys)) / 2


@rule(
    "WMR010",
    "two wheels at one place",
    """Two wheels touch the ground at one point. Either one wheel is written twice, or a sign is missing.""",
    f"{_NOSE}  - {{name: tail,  type: castor, x: 0.3, y: 0, d: -0.04, r: 0.05}}\n",
    f"{_NOSE}  - {{name: tail,  type: castor, x: -0.3, y: 0, d: -0.04, r: 0.05}}\n",
)
def together(subject: Subject) -> Iterator[Finding]:
    robot = subject.robot
    extent, _ = subject.extent
    places = [(w, w.pivot, w.contact(w.zero_heading), float(w.nominal.r)) for w in robot.wheels]
    for (a, p, p_contact, p_radius), (b, q, q_contact, q_radius) in combinations(places, 2):
        if a.ball and a.ball == b.ball:
            continue
        near = _NEAR * min(p_radius + q_radius, extent)
        apart = robot.steer_group[a.index] != robot.steer_group[b.index]
        one = apart and abs(p - q) <= near and abs(float(a.nominal.o - b.nominal.o)) <= near
        if one or abs(p_contact - q_contact) <= near:
            at = f"({q_contact.real:.4g}, {q_contact.imag:.4g})"
            what = f"{b.name} touches the ground where {a.name} does, at {at}"
            yield Finding(subject.mark(b), what, "Check the signs of x and y.")


def _contradicted(side: str, places: Mapping[str, complex]) -> str:
    """Return from which point the wheel is on the wrong side: the first place that is not 0 along the axis decides."""
    for whence, at in places.items():
        along = {"front": at.real, "rear": -at.real, "left": at.imag, "right": -at.imag}.get(side, 0.0)
        if abs(along) > _SAME:
            return whence if along < 0 else ""
    return ""


@rule(
    "WMR011",
    "name contradicts place",
    """x points forward and y to the left. A wheel called back_left is behind the middle of the wheels and left of it,
    or on the only axle behind the origin. If it is not, names or signs are exchanged, and every command goes to
    the wrong motor.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
""",
    PAIR,
)
def labels(subject: Subject) -> Iterator[Finding]:
    middle, groups = _middle(subject.robot.wheels), subject.robot.steer_group
    steered_at = Counter((w.pivot, groups[w.index]) for w in subject.robot.wheels)
    for w in subject.robot.wheels:
        places = {"the middle of the wheels": w.pivot - middle, "the origin P": w.pivot}
        wrong = [(s, whence) for s in role(w.name).split() if (whence := _contradicted(s, places))]
        if steered_at[w.pivot, groups[w.index]] > 1:  # the left one of a pair that one joint steers
            own = {"its pivot": w.contact(w.zero_heading) - w.pivot}
            wrong = [(s, whence) for s, whence in wrong if _contradicted(s, own)]
        if wrong:
            where = " and ".join(f"{_OPPOSITE[side]} {whence}" for side, whence in wrong)
            sides = f"{'neither' if len(wrong) > 1 else 'not'} {' nor '.join(side for side, _ in wrong)}"
            yield Finding(
                subject.mark(w),
                f"{w.name} is at ({w.pivot.real:.4g}, {w.pivot.imag:.4g}), {where}: {sides}",
                "x points forward, y to the left. Change the sign or the name.",
            )


@rule(
    "WMR012",
    "wheels that roll against each other",
    """Two wheels with one axle direction and opposite headings turn with opposite signs when the robot drives
    straight. On a differential drive with l and alpha this is the right wheel with beta = 0: its beta is pi. If
    the joints of the two sides really count in opposite directions, because the motors are mounted mirrored,
    ignore the finding. For wheels that steer, the heading at angle 0 counts. Omni wheels that are mounted
    tangentially are excluded.""",
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
    middle = _middle(subject.robot.wheels)
    driven = [
        w
        for w in subject.robot.wheels
        if "spin" in w.actuated
        and not w.kind.swivels
        and not (w.kind.steers and abs(w.zero_heading.imag) > _OPPOSED)
    ]
    for b in driven:
        way = b.zero_heading.real if abs(b.zero_heading.real) > _OPPOSED else b.zero_heading.imag
        others = [
            a
            for a in driven
            if way < 0
            and abs(a.zero_heading + b.zero_heading) < _OPPOSED
            and not (_tangential(a, middle) and _tangential(b, middle))
        ]
        if others:
            yield Finding(
                subject.mark(b),
                f"{others[0].name} and {b.name} turn against each other when the robot drives straight",
                f"Turn {b.name} by pi (beta: pi, or heading: 0), or ignore this finding if its joint counts that way.",
            )


def _tangential(w: Wheel, middle: complex) -> bool:
    """Return whether an omni wheel rolls around the middle, at the corners of an oblong base at least roughly."""
    arm, oblique = w.pivot - middle, abs((w.zero_heading**2).imag) > _OBLIQUE
    along = abs((w.zero_heading.conjugate() * arm).real)
    return w.kind.rolls_across and along < _SAME + (_OBLIQUE if oblique else 0.01) * abs(arm)


@rule(
    "WMR013",
    "leading castor",
    """d is the distance from a castor's pivot to its contact along its rolling direction. With heading 0 and d > 0 the
    contact is in front of the pivot at angle 0. No castor stays there when the robot drives forward: it swings
    round to pi. Write d negative, or heading: pi; then angle 0 is the angle at which the castor trails.""",
    PAIR + "  - {name: tail,  type: castor, x: -0.3, y: 0, heading: 0, d: 0.04, r: 0.05}\n",
    PAIR + "  - {name: tail,  type: castor, x: -0.3, y: 0, heading: 0, d: -0.04, r: 0.05}\n",
)
def leading(subject: Subject) -> Iterator[Finding]:
    for spec, w in subject.wheels:
        d = float(w.nominal.d)
        if w.kind.swivels and spec.d and d * w.zero_heading.real > 0.9 * abs(d):
            other, heading = ("negative", "pi") if d > 0 else ("positive", "0")
            yield Finding(
                spec.d.mark,
                f"{w.name}: d = {spec.d.text} puts the contact in front of the pivot",
                f"Write d {other}, or heading: {heading}, so that the castor trails.",
            )


@rule(
    "WMR014",
    "origin off the axle",
    """A robot with one fixed axle turns about points of that axle. vx, vy and omega are the velocities of P, the
    origin. If P is off the axle, a turn moves P sideways and vy is not 0. Most drivers use the middle of the
    axle as P. If another origin is meant, such as the centre of gravity, ignore the finding.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0.1, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0.1, y: -0.2, heading: 0, r: 0.1}
""",
    PAIR,
)
def origin(subject: Subject) -> Iterator[Finding]:
    fixed = [w for w in subject.robot.wheels if w.kind.fixed_axle]
    middle = _middle(subject.robot.wheels)
    reach = max(abs(w.pivot - middle) for w in subject.robot.wheels)
    if abs(middle) > _OUTSIDE * reach > 0:
        what = f"the origin P is {abs(middle):.4g} m from the middle of the wheels, which reach {reach:.4g} m from it"
        yield Finding(subject.mark(subject.robot.wheels[0]), what, _ORIGIN)
    elif subject.mobility.rank_C1f.value == 1:
        w, most = fixed[0], max(abs(v.pivot) for v in fixed)
        ahead = w.zero_heading if w.zero_heading.real >= 0 else -w.zero_heading  # as seen in the robot frame
        seen = [ahead.conjugate() * v.pivot for v in fixed]
        off, aside = seen[0].real, (max(p.imag for p in seen) + min(p.imag for p in seen)) / 2
        if abs(off) > _SAME * most:
            what = f"the axle of {w.name} is {abs(off):.4g} m {'in front of' if off > 0 else 'behind'} the origin P"
            yield Finding(subject.mark(w), what, _ORIGIN)
        elif len(fixed) > 1 and abs(aside) > 1e-3 * most and not any(faced(subject)):
            names, side = listed([v.name for v in fixed]), "left" if aside > 0 else "right"
            what = f"the axle of {names} has its middle {abs(aside):.4g} m {side} of the origin P"
            yield Finding(subject.mark(w), what, _ORIGIN)
