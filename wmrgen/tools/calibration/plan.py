"""Suggest drives: a few common courses that determine the parameters which are not determined yet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import pi

import numpy as np

from wmrgen.derivation.facade import Derivation
from wmrgen.tools.calibration import estimator, start
from wmrgen.tools.calibration.calibrate import increments_of
from wmrgen.tools.calibration.logs import Log, Poses
from wmrgen.tools.calibration.model import MOUNT, Problem
from wmrgen.tools.calibration.noise import USUAL, Noise, Share, combined, shares
from wmrgen.tools.calibration.observability import groups, split
from wmrgen.tools.calibration.path import Increments, Reals
from wmrgen.tools.calibration.result import Calibration

_RATE = 10.0  # [1/s] of the readings of a planned drive


@dataclass(frozen=True, slots=True)
class Segment:
    """A constant twist."""

    twist: tuple[float, float, float]  # vx, vy [m/s], omega [rad/s]
    seconds: float


@dataclass(frozen=True, slots=True)
class Course:
    """A drive in words and in segments."""

    text: str
    segments: tuple[Segment, ...]

    @property
    def seconds(self) -> float:
        """How long it lasts [s]."""
        return sum(segment.seconds for segment in self.segments)


@dataclass(frozen=True, slots=True)
class Offer:
    """A course, and the contribution of its log to the covariance."""

    course: Course
    share: Share


def courses(derivation: Derivation) -> list[Course]:
    """Return usual courses at half of the robot's limits, at most 0.5 m/s and 1 rad/s, in its size; shortest first."""
    robot = derivation.robot
    size = max([0.1, *(max(abs(float(w.nominal.x)), abs(float(w.nominal.y))) for w in robot.wheels)])
    speed = _half(robot.limits.get("vx"), 0.5)
    spin = min(_half(robot.limits.get("omega"), 1.0), speed / size)
    side, radius = 20 * size, 5 * size
    ahead, turn = Segment((speed, 0, 0), side / speed), Segment((0, 0, spin), pi / 2 / spin)
    back = Segment((0, 0, -spin), pi / 2 / spin)
    left, right = Segment((0, speed, 0), side / speed), Segment((0, -speed, 0), side / speed)
    bend = speed / radius
    circle, other = Segment((speed, 0, bend), 2 * pi / bend), Segment((speed, 0, -bend), 2 * pi / bend)
    reverse = replace(ahead, twist=(-speed, 0, 0))
    every = [
        Course(f"a straight line of {side:.2g} m and back", (ahead, reverse)),
        Course(f"a line of {side:.2g} m to the left and back", (left, right)),
        Course("four turns on the spot, two each way", (turn,) * 8 + (back,) * 8),
        Course(
            f"a square of {side:.2g} m, once in each direction (UMBmark)",
            (ahead, turn) * 4 + (ahead, back) * 4,
        ),
        Course(f"a figure of eight of two circles of {radius:.2g} m radius, twice", (circle, other) * 2),
    ]
    return sorted(every, key=lambda course: course.seconds)


def _half(limit: object, most: float) -> float:
    high = getattr(limit, "high", None)
    return most if high is None else min(most, 0.5 * float(high))


def offers(
    derivation: Derivation, increments: Increments, nominal: Reals, level: Noise = USUAL
) -> list[Offer]:
    """Return the courses that the robot can drive, each with the contribution of its log.

    Args:
        derivation: The robot.
        increments: Its odometry.
        nominal: (P,) parameters.
        level: Noise of the drive.
    """
    result = []
    for course in courses(derivation):
        log = _driven(derivation, increments, nominal, course)
        if log is None:
            continue
        width = len(nominal) + MOUNT
        problem = Problem(
            increments, nominal, (log,), (start.whole(log),), free=np.eye(width), clocks=(True,)
        )
        fit = estimator.evaluated(problem, start.begun(problem, problem.origin, np.zeros(1)))
        result.append(Offer(course, shares(fit, level)[0]))
    return result


def _driven(derivation: Derivation, increments: Increments, nominal: Reals, course: Course) -> Log | None:
    """Return the log that a course would give; None if the wheels do not allow it.

    A point off an axle moves along the axle when the robot turns, so the nearest twist that the wheels allow will do if
    it advances and turns as it should.
    """
    columns: dict[str, list[Reals]] = {joint: [] for joint in increments.joints}
    for segment in course.segments:
        vx, vy, omega = segment.twist
        values = _commanded(derivation, segment.twist)
        one = {joint: np.array([values.get(joint, 0.0)]) for joint in increments.joints}
        step = increments.alone.steps(one, nominal)
        off = abs(step.position.real[0] - vx) + abs(step.heading[0] - omega)
        off += abs(step.position.imag[0] - vy) * (vy != 0)
        if off > 0.1 * (abs(vx) + abs(vy) + abs(omega)):
            return None
        steps = max(2, round(segment.seconds * _RATE))
        for joint, parts in columns.items():
            share = 1.0 if joint.endswith(".steer") else segment.seconds / steps
            parts.append(np.full(steps, one[joint][0] * share))
    joined = {joint: np.concatenate(parts) for joint, parts in columns.items()}
    path = increments.alone.path(joined, nominal)
    t = np.arange(len(path.heading)) / _RATE
    poses = Poses(t, path.position.real.copy(), path.position.imag.copy(), path.heading)
    return Log(course.text, t, joined, poses)


def _commanded(derivation: Derivation, twist: tuple[float, float, float]) -> dict[str, float]:
    """Return what `inverse` gives for a twist, with steering angles of 0 before it."""
    inverse = derivation.numpy().inverse
    present = {p.name: 0.0 for p in derivation.program.formula("inverse").inputs if p.name.endswith(".steer")}
    vx, vy, omega = twist
    return {name: float(v) for name, v in inverse(vx=vx, vy=vy, omega=omega, **present).items()}


def _worst(every: list[Share], count: int) -> Reals:
    """Return standard deviations of directions of the parameters, relative to nominal, worst first."""
    width = count + MOUNT
    shared = combined(every, np.eye(width)).shared[:count, :count]
    return np.asarray(0.1 * np.sqrt(np.maximum(np.linalg.eigvalsh(shared)[::-1], 0.0)))


def blind(
    choices: Sequence[Offer], problem: Problem, before: Sequence[Share] = ()
) -> tuple[tuple[str, ...], ...]:
    """Return the groups of parameters that no drive determines separately: those that all courses leave open.

    Args:
        choices: What can be driven.
        problem: Robot and parameters.
        before: Logs that there are already.
    """
    count = len(problem.nominal)
    shared = combined([*before, *(offer.share for offer in choices)], np.eye(count + MOUNT)).shared
    only = np.eye(count + MOUNT)[:, :count]  # the mount is no parameter
    _, weak = split(shared, only)
    return groups(problem, problem.increments.parameters, weak)


def plan(
    choices: Sequence[Offer], problem: Problem, precision: float, before: Sequence[Share] = ()
) -> tuple[Course, ...] | None:
    """Return the shortest courses that determine every parameter that any course determines; None if no set does.

    Args:
        choices: What can be driven.
        problem: Robot and parameters.
        precision: Standard deviation of every direction of the parameters, relative to nominal.
        before: Logs that there are already.
    """
    count, never = len(problem.nominal), len(blind(choices, problem, before))
    sets = [chosen for size in range(len(choices) + 1) for chosen in combinations(choices, size)]
    for chosen in sorted(sets, key=lambda some: sum(offer.course.seconds for offer in some)):
        uncertain = _worst([*before, *(offer.share for offer in chosen)], count)
        if len(uncertain) == never or uncertain[never] <= precision:
            return tuple(offer.course for offer in chosen)
    return None


def problem_of_plan(
    derivation: Derivation, gains: Sequence[str] = ()
) -> tuple[Problem, list[Offer], tuple[tuple[str, ...], ...]]:
    """Return a robot's problem without logs, its offers, and the groups that no drive determines separately.

    Args:
        derivation: The robot's.
        gains: Joints whose readings have an unknown scale.
    """
    increments, nominal = increments_of(derivation, gains)
    problem = Problem(increments, nominal, (), (), free=np.eye(len(nominal) + MOUNT))
    choices = offers(derivation, increments, nominal)
    return problem, choices, blind(choices, problem)


def existing(result: Calibration | None) -> list[Share]:
    """Return what the logs of a calibration add."""
    return [] if result is None else shares(result.fit, result.noise)
