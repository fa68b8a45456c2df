"""What drives tell of the parameters, what they cannot, and which further drive would."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import pi

import numpy as np
from scipy.linalg import qr

from wmrgen.derivation.facade import Derivation
from wmrgen.tools.calibrating.certainty import Fit
from wmrgen.tools.calibrating.fit import (
    Problem,
    Untold,
    information,
    prior_of_shared,
    serial,
    start_of,
    sums,
)
from wmrgen.tools.calibrating.logs import Drive, Truth
from wmrgen.tools.calibrating.path import Reals, reckoned

WEAK = 0.02  # a direction of the parameters that is less certain than this, relative to nominal, is not observable
_TOGETHER = 0.25  # of a direction's largest part: what is smaller does not belong to it
_RATE = 20.0  # [1/s] of the readings of a planned drive


@dataclass(frozen=True, slots=True)
class Segment:
    """A constant twist (vx [m/s], vy [m/s], omega [rad/s]) for ``seconds``."""

    twist: tuple[float, float, float]
    seconds: float


@dataclass(frozen=True, slots=True)
class Course:
    """A drive to propose: ``text`` says it."""

    text: str
    segments: tuple[Segment, ...]

    @property
    def seconds(self) -> float:
        """How long it lasts."""
        return sum(segment.seconds for segment in self.segments)


@dataclass(frozen=True, slots=True)
class Offer:
    """A course, and the information on the shared unknowns that it would give: ``tells`` (shared, shared)."""

    course: Course
    tells: Reals


def deviations(problem: Problem, told: Reals, noise: float) -> tuple[Reals, Reals]:
    """Standard deviations, relative to nominal, of the directions of the parameters, worst first, and these
    directions as columns. ``told``: the information of drives on the shared unknowns; ``noise``: the mean square of
    residuals in units of the loss's scale, taken to be 1 at least."""
    count = len(problem.nominal)
    covariance = np.linalg.inv(told + prior_of_shared(problem))[:count, :count] * max(noise, 1.0)
    variances, directions = np.linalg.eigh(covariance)
    variances = np.maximum(variances, 0.0)  # rounding takes more from what is told to the last bit
    return 0.1 * np.sqrt(variances[::-1]), directions[:, ::-1]


def unobservable(best: Fit) -> list[tuple[str, ...]]:
    """Each direction that the drives do not tell, as the parameters that scale together in it, largest part first."""
    return _weak(best.problem, best.information, best.noise)


def uncertain_of(problem: Problem, told: Reals, noise: float) -> Reals:
    """The directions (P, k) that are less certain than `WEAK`; arguments as of `deviations`."""
    uncertain, directions = deviations(problem, told, noise)
    return np.asarray(directions[:, uncertain > WEAK])


def _weak(problem: Problem, told: Reals, noise: float) -> list[tuple[str, ...]]:
    """The parameters of `uncertain_of` directions, of which as many as there are directions are in one of them only."""
    directions = uncertain_of(problem, told, noise)
    if not directions.size:
        return []
    alone = qr(directions.T, mode="r", pivoting=True)[1][: directions.shape[1]]
    return [_names(problem, direction) for direction in np.linalg.solve(directions[alone].T, directions.T)]


def _names(problem: Problem, direction: Reals) -> tuple[str, ...]:
    size = np.abs(direction)
    order = [i for i in np.argsort(-size) if size[i] > _TOGETHER * size.max()]
    return tuple(problem.increments.parameters[i] for i in order)


def courses(problem: Problem, derivation: Derivation) -> list[Course]:
    """Straight, turn, square and figure of eight at half of the robot's limits, at most 0.5 m/s and 1 rad/s, for a
    robot of its size: the ones that its wheels allow."""
    robot = derivation.robot
    size = max([0.1, *(max(abs(float(w.nominal.x)), abs(float(w.nominal.y))) for w in robot.wheels)])
    speed = _half(robot.limits.get("vx"), 0.5)
    spin = min(_half(robot.limits.get("omega"), 1.0), speed / size)
    side, radius = 20 * size, 5 * size
    ahead, turn = Segment((speed, 0, 0), side / speed), Segment((0, 0, spin), pi / 2 / spin)
    back = Segment((0, 0, -spin), pi / 2 / spin)
    bend = speed / radius
    circle = 2 * pi / bend
    every = [
        Course(f"a straight line of {side:.2g} m and back", (ahead, replace(ahead, twist=(-speed, 0, 0)))),
        Course(f"a line of {side:.2g} m to the left and back", (
            Segment((0, speed, 0), side / speed), Segment((0, -speed, 0), side / speed))),
        Course("four turns on the spot, two each way", (turn,) * 8 + (back,) * 8),
        Course(f"a square of {side:.2g} m, once in each direction (UMBmark)", (ahead, turn) * 4 + (ahead, back) * 4),
        Course(f"a figure of eight of two circles of {radius:.2g} m radius, twice", (
            Segment((speed, 0, bend), circle), Segment((speed, 0, -bend), circle)) * 2),
    ]  # fmt: skip
    return sorted((c for c in every if _allowed(problem, derivation, c)), key=lambda course: course.seconds)


def _half(limit: object, most: float) -> float:
    high = getattr(limit, "high", None)
    return most if high is None else min(most, 0.5 * float(high))


def _allowed(problem: Problem, derivation: Derivation, course: Course) -> bool:
    """Whether the wheels let the robot move so. A point that is off an axle slides along where the robot turns: the
    nearest twist that the wheels allow will do, as long as it advances and turns as it should."""
    for segment in course.segments:
        joints = _joints(derivation, segment)
        columns = {joint: np.array([joints.get(joint, 0.0)]) for joint in problem.increments.joints}
        step = problem.increments(columns, problem.nominal)
        vx, vy, omega = segment.twist
        off = (
            abs(step.position.real[0] - vx)
            + abs(step.heading[0] - omega)
            + abs(step.position.imag[0] - vy) * (vy != 0)
        )
        if off > 0.1 * (abs(vx) + abs(vy) + abs(omega)):
            return False
    return True


def _joints(derivation: Derivation, segment: Segment) -> dict[str, float]:
    """What `inverse` makes of a segment's twist, with steering angles of 0 before it."""
    inverse = derivation.numpy().inverse
    present = {p.name: 0.0 for p in derivation.program.formula("inverse").inputs if p.name.endswith(".steer")}
    vx, vy, omega = segment.twist
    return {name: float(v) for name, v in inverse(vx=vx, vy=vy, omega=omega, **present).items()}


def planned(problem: Problem, derivation: Derivation, course: Course) -> Drive:
    """The log that a course would give, and its truth: the pose at every reading."""
    parts: dict[str, list[Reals]] = {joint: [] for joint in problem.increments.joints}
    for segment in course.segments:
        steps = max(2, round(segment.seconds * _RATE))
        values = _joints(derivation, segment)
        for joint, arrays in parts.items():
            rate = values.get(joint, 0.0)
            arrays.append(
                np.full(steps, rate if joint.endswith(".steer") else rate * segment.seconds / steps)
            )
    columns = {joint: np.concatenate(arrays) for joint, arrays in parts.items()}
    path = reckoned(problem.increments(columns, problem.nominal))
    t = np.arange(len(path.heading)) / _RATE
    truth = Truth(t, path.position.real.copy(), path.position.imag.copy(), path.heading)
    return Drive(course.text, t, columns, truth)


def offers(problem: Problem, derivation: Derivation) -> list[Offer]:
    """The courses that the robot can drive, the shortest first, each with what it would tell."""
    drives = {course: planned(problem, derivation, course) for course in courses(problem, derivation)}
    problem = replace(problem, untold=None, held=None)
    choices = _offered(problem, drives)
    untold = uncertain_of(problem, _total(problem, choices), 1.0)
    if untold.size and problem.increments.rows is not None:
        choices = _offered(replace(problem, untold=Untold(untold, np.zeros(len(untold)))), drives)
    return choices


def _offered(problem: Problem, drives: Mapping[Course, Drive]) -> list[Offer]:
    result = []
    for course, drive in drives.items():
        one = replace(problem, drives=(drive,))
        result.append(Offer(course, information(one, serial(one, start_of(one), sums))))
    return result


def _total(problem: Problem, choices: Sequence[Offer]) -> Reals:
    """What all courses together tell."""
    return sum((c.tells for c in choices), np.zeros_like(prior_of_shared(problem)))


def plan(
    problem: Problem, choices: Sequence[Offer], precision: float, told: Reals | None = None
) -> tuple[Course, ...] | None:
    """The shortest of ``choices`` after which every direction that is not `blind` is certain to ``precision``, relative
    to nominal; None where they do not do. ``told``: the information of drives that there are already. A pose is taken
    to be off by `Problem.scale`, once a second."""
    before = np.zeros_like(prior_of_shared(problem)) if told is None else told
    never = len(blind(problem, choices))
    for chosen in _by_duration(choices):
        uncertain, _ = deviations(problem, before + sum(offer.tells for offer in chosen), 1.0)
        if len(uncertain) == never or uncertain[never] <= precision:
            return tuple(offer.course for offer in chosen)
    return None


def blind(problem: Problem, choices: Sequence[Offer]) -> list[tuple[str, ...]]:
    """Directions that no drive on the floor tells, whatever it is: those that all courses together leave open."""
    return _weak(problem, _total(problem, choices), 1.0)


def _by_duration(choices: Sequence[Offer]) -> list[tuple[Offer, ...]]:
    """Sets of courses, the shortest in all first."""
    sets = [chosen for size in range(len(choices) + 1) for chosen in combinations(choices, size)]
    return sorted(sets, key=lambda chosen: sum(offer.course.seconds for offer in chosen))
