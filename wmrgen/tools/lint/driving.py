"""Rules about joints that drive, steer or measure: too few, too many, or joints that contradict each other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import degrees, pi

import numpy as np

from wmrgen.analysis.kinematics.sensing import generic_rank, measurements
from wmrgen.analysis.mobility import analyse
from wmrgen.analysis.mobility.configure import pivot_velocity
from wmrgen.analysis.mobility.records import Array, Balance
from wmrgen.geometry.exact.number import ONE, ZERO
from wmrgen.geometry.layout.records import Gyro, Noise, Robot, Wheel
from wmrgen.geometry.layout.skid import driven
from wmrgen.geometry.notation import listed
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.tools.lint.record import PAIR, Finding, Subject, rule

NEAR = 2e-3  # [rad]; a limit written as 1.57 allows pi/2


@rule(
    "WMR020",
    "too few actuated joints",
    """Each degree of freedom of the robot needs a joint that drives it, and each degree of steerability a joint that
    is steered. With fewer, some motions are left to chance. Fixed, steered and Swedish wheels are actuated
    unless the file says otherwise; castors are not.""",
    PAIR.removesuffix("}\n") + ", actuated: [], sensed: [spin]}\n",
    PAIR,
)
def short(subject: Subject) -> Iterator[Finding]:
    lost = any(s.everywhere for s in subject.mobility.singularities)  # WMR033 reports it
    if subject.mobility.degree_of_mobility and not lost:
        for balance in subject.mobility.actuation:
            if balance.lacking:
                yield Finding(subject.mark(subject.robot.wheels[0]), str(balance), _more(subject, balance))


def _more(subject: Subject, balance: Balance) -> str:
    """Advise which idle joint could be actuated to supply the lacking motor."""
    steering = balance.joint == "steer"
    idle = [
        f"{joint} to actuated of {w.name}"
        for w in subject.robot.wheels
        for joint in w.kind.joints
        if joint not in w.actuated and steering == (joint == "steer" and w.kind.steers)
    ]
    if idle:
        return f"Add {idle[0]}, or to another wheel."
    if balance.motors < balance.need:
        return "Every joint is driven already: add a driven wheel."
    return "Every joint is driven already, and some drive the same motion: check the places and headings."


@rule(
    "WMR021",
    "unequally actuated wheels",
    """If more joints are driven than the robot has degrees of freedom, their rates must agree, or wheels slide. If
    all wheels of one type are driven, as on mecanum bases and skid-steer robots, this is usual and not reported.
    The report and `actuation` of model.json give the number of surplus motors. If some wheels of a type are
    driven and others are not, or if castors are driven that need no motor, an entry of actuated is likely
    missing or superfluous.""",
    """
wheels:
  - {name: front_left,  type: steered, x: 0.3,  y: 0.2,  heading: 0, r: 0.1}
  - {name: front_right, type: steered, x: 0.3,  y: -0.2, heading: 0, r: 0.1}
  - {name: back_left,   type: steered, x: -0.3, y: 0.2,  heading: 0, r: 0.1}
  - {name: back_right,  type: steered, x: -0.3, y: -0.2, heading: 0, r: 0.1, actuated: [steer]}
""",
    """
wheels:
  - {name: front_left,  type: steered, x: 0.3,  y: 0.2,  heading: 0, r: 0.1}
  - {name: front_right, type: steered, x: 0.3,  y: -0.2, heading: 0, r: 0.1}
  - {name: back_left,   type: steered, x: -0.3, y: 0.2,  heading: 0, r: 0.1}
  - {name: back_right,  type: steered, x: -0.3, y: -0.2, heading: 0, r: 0.1}
""",
)
def uneven(subject: Subject) -> Iterator[Finding]:
    for balance in subject.mobility.actuation:
        for alike in _alike(subject.robot, balance.joint) if balance.surplus else ():
            idle = [w for w in alike if balance.joint not in w.actuated]
            if 0 < len(idle) < len(alike) - len(idle):
                yield Finding(
                    subject.mark(idle[0]),
                    f"{balance}; of the {idle[0].kind.noun}s only {listed([w.name for w in idle])} "
                    f"{'is' if len(idle) == 1 else 'are'} not actuated",
                    f"Write {balance.joint} in actuated of all of them, or of as many as are needed.",
                )
    castors = [w for w in subject.robot.wheels if w.kind.swivels and w.actuated]
    if castors and any(balance.surplus for balance in subject.mobility.actuation):
        passive = (replace(w, actuated=() if w in castors else w.actuated) for w in subject.robot.wheels)
        if not any(b.lacking for b in analyse(replace(subject.robot, wheels=tuple(passive))).actuation):
            what = f"{listed([w.name for w in castors])}: driven, although other wheels drive every motion already"
            yield Finding(
                subject.mark(castors[0]), what, "Write actuated: [], or delete the key: castors follow."
            )


def _alike(robot: Robot, joint: str) -> list[list[Wheel]]:
    """Return the wheels that have the joint, one list for each wheel type."""
    types: dict[str, list[Wheel]] = {}
    for w in robot.wheels:
        if joint in w.kind.joints:
            types.setdefault(w.type, []).append(w)
    return list(types.values())


@rule(
    "WMR022",
    "odometry lacks a sensor",
    """The sensed joints do not determine the whole twist, although they would if every joint of the wheels were
    sensed. `forward` and `odometry` then return the smallest twist that fits. Actuated joints are sensed unless
    the file says otherwise. Two tracking wheels determine the velocity of one point of the robot; with a yaw-
    rate sensor (`gyro:`) they determine the twist.""",
    PAIR.removesuffix("}\n") + ", sensed: []}\n",
    PAIR,
)
def unsensed(subject: Subject) -> Iterator[Finding]:
    robot = subject.robot
    blind = [w for w in robot.wheels if set(w.kind.joints) - set(w.sensed)]
    if not blind or (seen := _seen(driven(robot))) == 3:
        return
    every = replace(robot, wheels=tuple(replace(w, sensed=w.kind.joints) for w in robot.wheels))
    if seen < (possible := _seen(driven(every))):
        yield Finding(
            subject.mark(blind[0]),
            f"the sensed joints determine {seen} of the 3 components of the twist, all joints {possible}",
            f"Write sensed: [{', '.join(blind[0].kind.joints)}] for a wheel with a sensor: "
            f"{listed([w.name for w in blind])} {'lacks' if len(blind) == 1 else 'lack'} one.{_with_a_gyro(robot)}",
        )


def _with_a_gyro(robot: Robot) -> str:
    """Advise to add a yaw-rate sensor if nothing else is lacking."""
    noiseless = Gyro(ONE, Noise(ZERO, ZERO))
    if robot.gyro is not None or _seen(driven(replace(robot, gyro=noiseless))) < 3:
        return ""
    return (
        " Or write gyro: {constant: 0.005 rad/s} at the top of the file if the robot has a yaw-rate sensor."
    )


def _seen(robot: Robot) -> int:
    """Return how many components of the twist the sensed joints and the gyro determine."""
    measured = measurements(robot)
    return generic_rank(measured) if measured.all else 0


@rule(
    "WMR023",
    "motion beyond the steering limits",
    """The limits of steering exclude a motion that the limits of vx, vy and omega allow. For example, omega is too
    large for a car even at its highest speed, or the wheels of a base do not steer far enough for vy. The
    rule also checks that the robot can drive straight on; it cannot if a heading is a quarter turn off.
    Headings half a turn apart are treated as one, because the wheel may roll backwards.""",
    """
wheels:
  - {name: rear,  type: fixed,   x: 0, y: 0, heading: 0, r: 0.3}
  - {name: front, type: steered, x: 1, y: 0, heading: 0, r: 0.3, actuated: [steer], limits: {steer: 30 deg}}
limits: {vx: 1, omega: 1}
""",
    """
wheels:
  - {name: rear,  type: fixed,   x: 0, y: 0, heading: 0, r: 0.3}
  - {name: front, type: steered, x: 1, y: 0, heading: 0, r: 0.3, actuated: [steer], limits: {steer: 30 deg}}
limits: {vx: 1, omega: 0.5}
""",
)
def beyond(subject: Subject) -> Iterator[Finding]:
    for motion, twist in _promised(subject):
        for spec, w in subject.wheels:
            limit, speed = subject.robot.limit(w, "steer"), pivot_velocity(w, twist)
            if not (limit and w.kind.steers) or abs(speed) < 1e-9 * float(np.abs(twist).max()):
                continue
            angle = float(np.angle(speed / w.zero_heading))
            turned = [angle + k * pi for k in range(-4, 5)]
            if not any(float(limit.low) - NEAR <= a <= float(limit.high) + NEAR for a in turned):
                own = (v for v in (*spec.limits, *subject.spec.limits) if v.name == "steer")
                least = degrees(min(turned, key=abs))
                what = f"{motion} is not possible: {w.name} would have to steer {least:.4g} deg"
                yield Finding(
                    next(own).mark, what, "Reduce the limit of the motion, or increase the limit of steering."
                )
                return


def _promised(subject: Subject) -> Iterator[tuple[str, Array]]:
    """Yield straight driving and the motions that the limits of the twist allow, each with its twist in SI units."""
    limits, free = subject.robot.limits, subject.mobility.admissible
    most = {name: max(abs(float(limits[name].low)), abs(float(limits[name].high))) for name in limits}
    vx, vy, omega = (most.get(name, 0.0) for name in TWIST_NAMES)
    if not free.linear or any(joint == "steer" for joint, _ in subject.robot.couplings):
        return
    ahead = np.array([1.0, 0.0, 0.0])
    if np.abs(ahead @ free.basis.T @ free.basis - ahead).max() < 1e-9:
        yield "driving straight on", ahead
    if free.dimension == 3 and vy:
        yield "driving sideways", np.array([0.0, vy, 0.0])
    if free.dimension == 3 and omega:
        yield "turning on the spot", np.array([0.0, 0.0, omega])
    if free.dimension == 2 and vx and omega:
        columns = free.basis[:, [0, 2]]
        if abs(float(np.linalg.det(columns))) > 1e-9:
            for rate in (omega, -omega):
                twist = np.linalg.solve(columns.T, np.array([vx, rate])) @ free.basis
                yield f"omega = {rate:.4g} rad/s at vx = {vx:.4g} m/s or less", twist
