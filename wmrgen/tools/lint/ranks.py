"""Layouts that cannot move, move by sliding, or do so only because of how their numbers are rounded."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from wmrgen.analysis.mobility.ranks import to_array
from wmrgen.analysis.mobility.records import Singularity
from wmrgen.geometry.constraints import nominal_view, rolling_row
from wmrgen.geometry.exact.number import ZERO
from wmrgen.geometry.layout.measured import SLIP
from wmrgen.geometry.layout.records import Near, Robot
from wmrgen.geometry.layout.skid import no_track, parallel
from wmrgen.geometry.notation import listed, plain
from wmrgen.tools.lint.record import PAIR, Finding, Subject, rule

NARROW = 1e-2  # the smallest relative singular value that is no accident
NOISE = 1e-9  # of the robot's size
FLAT = 10.0  # the ratio of good ones
_MECANUM = (
    "Rollers at the ground must form an O: gamma -45 deg at the front left and rear right, 45 deg at the others. "
    "The rollers on top, which one sees, then form an X."
)
_LOOK = "Look at headings, gamma and places of the wheels."
_FOUR = """\
wheels:
  - {name: front_left,  type: fixed, x: 0.3,  y: 0.2,  heading: 0, r: 0.1}
  - {name: front_right, type: fixed, x: 0.3,  y: -0.2, heading: 0, r: 0.1}
  - {name: back_left,   type: fixed, x: -0.3, y: 0.2,  heading: 0, r: 0.1}
  - {name: back_right,  type: fixed, x: -0.3, y: -0.2, heading: 0, r: 0.1}
"""


@rule(
    "WMR030",
    "nothing can move",
    """The axles meet in no common point, whatever the steering: every motion slides a wheel, and kinematics by rolling
    do not exist. `derive` refuses such a robot with exit code 3 unless the finding is ignored.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0,   y: 0.2,  heading: 0,      r: 0.1}
  - {name: right, type: fixed, x: 0,   y: -0.2, heading: 10 deg, r: 0.1}
  - {name: front, type: fixed, x: 0.3, y: 0,    heading: 0,      r: 0.1}
""",
    """
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
  - {name: front, type: castor, x: 0.3, y: 0, d: -0.04, r: 0.1}
""",
    stops=True,
)
def stuck(subject: Subject) -> Iterator[Finding]:
    if not subject.mobility.degree_of_mobility:
        apart = subject.mobility.apart
        yield Finding(
            subject.mark(subject.robot.wheels[0]),
            f"the axles of {listed(apart)} meet in no common point: nothing can move"
            if apart
            else "no motion is free of sliding",
            "Look at headings and places of the fixed wheels.",
        )


@rule(
    "WMR031",
    "skid-steer",
    """Fixed wheels on several parallel axles roll straight ahead only; the robot turns by skidding. Its kinematics are
    least squares and `slip` says what is left; how far it turns, they do not know. Where that is the robot, as a Husky
    is, `effective_track` says so, a length to be measured; else a wheel is a castor or steers.""",
    _FOUR,
    f"effective_track: 0.7\n{_FOUR}",
)
def skids(subject: Subject) -> Iterator[Finding]:
    if subject.robot.effective_track is not None:
        return
    apart = any(not near.moves for near in _near(subject.robot))
    if subject.mobility.skids and not apart and not list(_doubtful_rank(subject)):
        fixed = [w for w in subject.robot.wheels if w.kind.fixed_axle]
        names = listed([w.name for w in fixed])
        what = f"{names} stand on parallel axles: the robot turns only by skidding (skid-steer)"
        about = (
            "Some of its wheels move across their rolling direction, so it has no effective_track: kinematics are "
            "least squares, which do not know how far it turns."
            if any(no_track(subject.robot.wheels))
            else "Write effective_track: and the track of a differential drive that turns as it does (measured, some "
            "1.5 times its own). Without it kinematics are least squares, which do not know how far it turns."
        )
        remedies = [near.remedies for near in subject.robot.near if not near.moves]
        yield Finding(subject.mark(fixed[0]), what, " ".join((about, *remedies)))


@rule(
    "WMR032",
    "mecanum rollers that form no O",
    """Seen at the ground, the rollers of four mecanum wheels form an O: their lines run around the middle. Those of an
    X pass near it, so that the wheels hardly turn the robot, and not at all where wheelbase and track are equal. gamma
    is the angle at the ground; the rollers on top, which one sees, lie the other way. Of four wheels none, or all, are
    turned so, and none has a gamma of 0 where the others stand aslant.""",
    """
wheels:
  - {name: fl, type: swedish, x: 0.2,  y: 0.25,  heading: 0, gamma: 45 deg,  r: 0.1}
  - {name: fr, type: swedish, x: 0.2,  y: -0.25, heading: 0, gamma: -45 deg, r: 0.1}
  - {name: bl, type: swedish, x: -0.2, y: 0.25,  heading: 0, gamma: -45 deg, r: 0.1}
  - {name: br, type: swedish, x: -0.2, y: -0.25, heading: 0, gamma: 45 deg,  r: 0.1}
""",
    """
wheels:
  - {name: fl, type: swedish, x: 0.2,  y: 0.25,  heading: 0, gamma: -45 deg, r: 0.1}
  - {name: fr, type: swedish, x: 0.2,  y: -0.25, heading: 0, gamma: 45 deg,  r: 0.1}
  - {name: bl, type: swedish, x: -0.2, y: 0.25,  heading: 0, gamma: 45 deg,  r: 0.1}
  - {name: br, type: swedish, x: -0.2, y: -0.25, heading: 0, gamma: -45 deg, r: 0.1}
""",
)
def crossed(subject: Subject) -> Iterator[Finding]:
    rollers = [w for w in subject.robot.wheels if w.kind.rollers and float(w.nominal.sg)]
    if len(rollers) < 3 or _lost(subject):
        return
    middle = sum(w.pivot for w in rollers) / len(rollers)
    straight = parallel([w.zero_heading for w in rollers])
    rest = [w for w in subject.robot.wheels if w not in rollers]
    if straight and len(rest) == 1 and rest[0].kind.rollers and len(rollers) == 3:
        what = f"{rest[0].name} has gamma 0, as an omni wheel, and the rollers of the others stand aslant"
        yield Finding(subject.mark(rest[0]), what, _MECANUM)
        return
    ways = []
    for w in rollers:
        arm = w.pivot - middle
        gamma = complex(float(w.nominal.cg), float(w.nominal.sg))
        lever, other = (abs((arm.conjugate() * w.zero_heading * g).imag) for g in (gamma, gamma.conjugate()))
        ways.append(lever < other - 1e-9)
    if all(ways):
        what = f"the rollers of {listed([w.name for w in rollers])} form an X at the ground"
        yield Finding(subject.mark(rollers[0]), what, _MECANUM)
    elif any(ways) and len(rollers) == len(subject.robot.wheels) == 4 and straight:
        odd = [w.name for w, crossing in zip(rollers, ways, strict=True) if crossing]
        what = f"the rollers of {listed(odd)} point past the middle, as of an X, those of the others run around it"
        yield Finding(subject.mark(rollers[ways.index(True)]), what, _MECANUM)


def _lost(subject: Subject) -> Singularity | None:
    return next((s for s in subject.mobility.singularities if s.everywhere), None)


@rule(
    "WMR033",
    "wheels that cannot drive every motion",
    """The robot could move every way, and its wheels cannot drive it so: one motion turns no wheel, or hardly turns
    one. `forward` then tells that motion badly: small errors of the wheels become large ones.""",
    """
wheels:
  - {name: w1, type: swedish, x: 0.2,  y: 0.003,  heading: 0,    gamma: 0, r: 0.05}
  - {name: w2, type: swedish, x: -0.2, y: -0.003, heading: 0,    gamma: 0, r: 0.05}
  - {name: w3, type: swedish, x: 0,    y: 0.2,    heading: pi/2, gamma: 0, r: 0.05}
""",
    """
wheels:
  - {name: w1, type: swedish, x: 0.2,  y: 0.2,  heading: 0,    gamma: 0, r: 0.05}
  - {name: w2, type: swedish, x: -0.2, y: -0.2, heading: 0,    gamma: 0, r: 0.05}
  - {name: w3, type: swedish, x: 0,    y: 0.2,  heading: pi/2, gamma: 0, r: 0.05}
""",
)
def conditioned(subject: Subject) -> Iterator[Finding]:
    wheels = [w for w in subject.robot.wheels if w.kind.rolls_across]
    lost = _lost(subject)
    if lost:
        yield Finding(subject.mark(wheels[0]), plain(lost.meaning), _LOOK)
    elif len(wheels) > 2 and subject.mobility.degree_of_mobility == 3:
        rows = to_array([[p.constant or ZERO for p in rolling_row(w, nominal_view(w)).row] for w in wheels])
        places = np.array([*(w.pivot for w in wheels)])
        middle = places.mean()
        reach = float(np.abs(places - middle).max()) or 1.0
        turning = rows[:, 2] + middle.imag * rows[:, 0] - middle.real * rows[:, 1]
        about = np.column_stack([rows[:, :2], turning / reach])
        values = np.linalg.svd(about, compute_uv=False)
        if values[2] * FLAT < values[0]:
            worse = values[0] / values[2]
            what = f"one motion hardly turns the wheels: forward multiplies errors of theirs by {worse:.3g}"
            yield Finding(subject.mark(wheels[0]), what, _LOOK)


@rule(
    "WMR034",
    "two axles that nearly are one, or a rank that nearly is another",
    """Two axles that nearly are one. Above the `tolerance` the robot is taken for one with two axles, which hardly
    turns; below, for one with one axle, and its wheels are moved a little. Write numbers alike, or with all their
    digits; a robot file that names its `tolerance` is told nothing of what lies within it.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0.005, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0,     y: -0.2, heading: 0, r: 0.1}
""",
    PAIR,
)
def narrow(subject: Subject) -> Iterator[Finding]:
    robot, near = subject.robot, _near(subject.robot)
    for one in near:
        if not (one.moves and robot.tolerance.written):
            mark = subject.mark(robot.wheel(one.wheel))
            yield Finding(mark, plain(one.sentence(robot.tolerance)), one.remedies)
    if all(one.moves for one in near):
        yield from _doubtful_rank(subject)


def _near(robot: Robot) -> list[Near]:
    """What nearly is on one line or at one heading, by more than the noise of floats."""
    size = robot.tolerance.size
    return [near for near in robot.near if NOISE * size < near.apart < SLIP * size]


def _doubtful_rank(subject: Subject) -> Iterator[Finding]:
    robot = subject.robot
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    for name, rank in (("C1f", subject.mobility.rank_C1f), ("C1", subject.mobility.rank_C1)):
        if not rank.value:
            continue
        least, most = rank.singular_values[rank.value - 1], rank.singular_values[0]
        if rank.disagrees or least < NARROW * most:
            values = ", ".join(f"{v:.3g}" for v in rank.singular_values)
            what = f"rank {name} is {rank.value} by a hair's breadth: singular values {values}"
            place = (fixed or list(robot.wheels))[-1 if fixed else 0]
            yield Finding(subject.mark(place), what, "Look for decimals that were rounded.")
            return
