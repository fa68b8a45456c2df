"""Rules about layouts that cannot move, that move by sliding, or whose rank depends on rounded numbers."""

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

NARROW = 1e-2  # relative singular value below which a rank may be due to rounded decimals
NOISE = 1e-9  # share of the robot's size; rounding of doubles
FLAT = 10.0  # largest ratio of singular values of a base that measures every motion well
_MECANUM = (
    "Rollers at the ground must form an O: gamma -45 deg at the front left and rear right, 45 deg at the others. "
    "The rollers on top, which one sees, then form an X."
)
_LOOK = "Check headings, gamma and places of the wheels."
_FOUR = """\
wheels:
  - {name: front_left,  type: fixed, x: 0.3,  y: 0.2,  heading: 0, r: 0.1}
  - {name: front_right, type: fixed, x: 0.3,  y: -0.2, heading: 0, r: 0.1}
  - {name: back_left,   type: fixed, x: -0.3, y: 0.2,  heading: 0, r: 0.1}
  - {name: back_right,  type: fixed, x: -0.3, y: -0.2, heading: 0, r: 0.1}
"""


@rule(
    "WMR030",
    "no motion without sliding",
    """The axles have no common point, whatever the steering angles are: every motion slides a wheel, and kinematics by
    rolling do not exist. `derive` refuses such a robot with exit code 3 unless the finding is ignored.""",
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
            f"the axles of {listed(apart)} have no common point: nothing can move"
            if apart
            else "every motion slides a wheel",
            "Check headings and places of the fixed wheels.",
        )


@rule(
    "WMR031",
    "skid-steer without a track",
    """Fixed wheels on several parallel axles roll straight ahead only; the robot turns by skidding. Its kinematics are
    a least-squares fit with the residual `slip`, which does not predict how far the robot turns. If the robot
    is meant like this, as a Husky is, measure its `effective_track` and write it. Otherwise one of the wheels
    is a castor or steers.""",
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
        what = f"{names} are on parallel axles: the robot turns only by skidding (skid-steer)"
        about = (
            "Some of its wheels also roll sideways, so it has no effective_track: its kinematics are least "
            "squares, which do not predict how far it turns."
            if any(no_track(subject.robot.wheels))
            else "Write effective_track: the track of a differential drive that turns like this robot. Measure it: it "
            "is often 1.5 times the track of the wheels. Without it kinematics are least squares, which do not "
            "predict how far the robot turns."
        )
        remedies = [near.remedies for near in subject.robot.near if not near.moves]
        yield Finding(subject.mark(fixed[0]), what, " ".join((about, *remedies)))


@rule(
    "WMR032",
    "mecanum rollers that form no O",
    """At the ground, the rollers of four mecanum wheels form an O: their axes run around the middle. Rollers that form
    an X point at the middle, so that the wheels hardly turn the robot, and not at all if wheelbase and track
    are equal. gamma is the angle at the ground; the rollers on top, which one sees, point the other way. Either
    all four wheels are wrong or one of them is, for example with gamma 0.""",
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
        what = (
            f"{rest[0].name} has gamma 0, as an omni wheel, but the rollers of the other wheels are oblique"
        )
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
        what = f"the rollers of {listed(odd)} point at the middle, as in an X, but the other rollers run around it"
        yield Finding(subject.mark(rollers[ways.index(True)]), what, _MECANUM)


def _lost(subject: Subject) -> Singularity | None:
    return next((s for s in subject.mobility.singularities if s.everywhere), None)


@rule(
    "WMR033",
    "wheels that cannot drive every motion",
    """The constraints allow every motion, but the wheels cannot drive all of them: one motion turns no wheel, or
    hardly turns any. `forward` then multiplies measurement errors of the wheels in that motion.""",
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
            what = f"one motion hardly turns the wheels: forward multiplies their measurement errors by {worse:.3g}"
            yield Finding(subject.mark(wheels[0]), what, _LOOK)


@rule(
    "WMR034",
    "nearly common axle or nearly lower rank",
    """Two axles are nearly one. If they miss each other by more than the `tolerance`, the robot is treated as one with
    two axles, which hardly turns. If they miss by less, they are treated as one axle, and the wheels are moved
    a little. Write equal numbers, or all their digits. If a robot file gives its `tolerance`, axles within it
    have no finding.""",
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
    """Return the axles that are nearly on one line or at one heading, but differ by more than rounding."""
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
            what = f"rank {name} is {rank.value}, but nearly lower: singular values {values}"
            place = (fixed or list(robot.wheels))[-1 if fixed else 0]
            yield Finding(
                subject.mark(place), what, "Write all decimals, or exact expressions such as 0.4/3."
            )
            return


@rule(
    "WMR035",
    "layout outside Campion's five types",
    """The fixed axles are not on one line, or steering cannot choose between motions: less than two degrees of
    maneuverability are left, and the robot moves along one fixed curve. In most such files x and y are exchanged, a
    heading is a quarter turn off, or a wheel that steers has the type fixed. For a
    robot on rails or an axle on a test bench this is intended: ignore the finding.""",
    """
wheels:
  - {name: left,  type: fixed, x: 0.2,  y: 0, heading: 0, r: 0.1}
  - {name: right, type: fixed, x: -0.2, y: 0, heading: 0, r: 0.1}
""",
    PAIR,
)
def degenerate(subject: Subject) -> Iterator[Finding]:
    mobility = subject.mobility
    other_rule_reports = (
        mobility.degree_of_mobility == 0  # WMR030
        or mobility.skids  # WMR031, unless effective_track says that skidding is meant
        or any(not near.moves for near in _near(subject.robot))  # WMR034
        or any(_doubtful_rank(subject))  # WMR034
    )
    if not mobility.degenerate or other_rule_reports:
        return
    fixed = [w for w in subject.robot.wheels if w.kind.fixed_axle]
    first = (fixed or list(subject.robot.wheels))[0]
    pair = f"({mobility.degree_of_mobility}, {mobility.degree_of_steerability})"
    yield Finding(
        subject.mark(first),
        f"the robot has one motion only: {pair} is none of Campion's five types",
        "x points forward and y to the left: look at the places and headings of the fixed wheels.",
    )
