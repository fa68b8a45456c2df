"""The instantaneous centre of rotation (ICR): of a twist, `icr`, and the steering angles of a centre, `steer_to`.

Homogeneous coordinates stay finite (Kelly 4.2.1). A twist turns the body about (x, y) / w with (x, y, w) = (-vy, vx,
omega) in the robot frame. w = 0 is a translation: the centre is at infinity in the direction (x, y), at right angles
to the motion.

`check_steering` determines whether the axles meet at given steering angles, by the rank of C1 (Kelly 4.2.1.2):

    rank 1   all axles are on one line: the ICR may be anywhere on it (Siegwart 3.3.1)
    rank 2   all axles meet in the ICR, or all are parallel: crab steering, the ICR at infinity (Jeantaud)
    rank 3   the axles do not meet: mobility 0, driving slides
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from wmrgen.analysis.kinematics.inverse import inverse
from wmrgen.analysis.kinematics.records import Formula, Locals
from wmrgen.analysis.mobility.admissible import along
from wmrgen.analysis.mobility.ranks import numeric_rank, unit_rows
from wmrgen.analysis.mobility.records import Array, Mobility
from wmrgen.functions.motion.paths import FARTHEST, SLOWEST, path
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import TWIST, TWIST_NAMES, Port, Role, output
from wmrgen.geometry.symbolic import absolute, add, maximum, norm, over, signal, subtract, times

POINT = (
    Port("point.x", Role.COMMAND, "m", "a point of the body, robot frame"),
    Port("point.y", Role.COMMAND, "m", "a point of the body, robot frame"),
)


def centre_ports(unit: str = "m/s", weight: str = "rad/s") -> tuple[Port, Port, Port]:
    """Return the ports icr.x, icr.y, icr.w."""
    text = "homogeneous: the centre of rotation is (icr.x, icr.y) / icr.w, robot frame"
    return (
        Port("icr.x", Role.COMMAND, unit, text),
        Port("icr.y", Role.COMMAND, unit, text),
        Port(
            "icr.w", Role.COMMAND, weight, "homogeneous weight of the centre; 0: at infinity, a translation"
        ),
    )


@function("Kelly 4.2.1.1; Tzafestas (2.43)")
def icr(_: Robot, __: Mobility) -> Formula:
    """Return the ICR and the curvature of P for a twist, and the velocity and radius of a point of the body."""
    names = Locals()
    vx, vy, omega = (signal(n) for n in TWIST_NAMES)
    facts = path((vx, vy, omega), names)
    a = names.define("point_x_rate", subtract(vx, omega * signal("point.y")))
    b = names.define("point_y_rate", add(vy, omega * signal("point.x")))
    rate = names.define("rate", maximum(absolute(omega), SLOWEST))
    speed = names.define("point_speed", norm(a, b))
    turning = names.define("point_turning", maximum(rate, over(speed, FARTHEST)))
    outputs = (
        *zip(centre_ports(), (times(-1, vy), vx, omega), strict=True),
        (output("turns", "", "1 counter-clockwise, -1 clockwise, 0 translation"), facts["turns"]),
        (output("radius", "m", "distance of P from the centre, at most 1e9"), facts["radius"]),
        (output("curvature", "1/m", "yaw rate over speed of P, at most 1e9 in size"), facts["curvature"]),
        (output("point.vx", "m/s", "velocity of the point, robot frame"), a),
        (output("point.vy", "m/s", "velocity of the point, robot frame"), b),
        (output("point.radius", "m", "distance of the point from the centre, at most 1e9"), over(speed, turning)),
    )  # fmt: skip
    text = "instantaneous centre of rotation of a twist; radius and velocity of a point of the body"
    return names.formula("icr", (*TWIST, *POINT), outputs, text)


@function("Kelly 4.2.1.2 (Jeantaud), 4.2.2.1.1")
def steer_to(robot: Robot, mobility: Mobility) -> Formula:
    """Return the steering angles whose axles meet at a centre of rotation (Kelly 4.2.1.2: Jeantaud).

    Each wheel takes the nearer of its two directions, as in ``inverse``. If there are fixed wheels, the centre is
    moved to their axle.
    """
    steers = {f"{w.name}.steer" for w in robot.wheels if w.kind.steers}
    if not steers:
        raise underivable(robot, "steer_to", "none of its wheels is steered", Reason.NOT_STEERED)
    names, drive = Locals(), inverse(robot, mobility)
    twist = {"vx": signal("icr.y"), "vy": times(-1, signal("icr.x")), "omega": signal("icr.w")}
    commands = names.adopt(drive, twist)
    formula = names.formula(
        "steer_to",
        (*centre_ports(), *(p for p in drive.inputs if p.name in steers or p.role is Role.GEOMETRY)),
        ((p, commands[p.name]) for p, _ in drive.outputs if p.name in steers),
        "centre of rotation to steering angles; a point has icr.w = 1, a direction of infinity icr.w = 0",
    )
    return replace(formula, calls=())  # kernels would also compute speeds, which are not outputs


class SteeringCheck(NamedTuple):
    """Whether the axles meet at given steering angles."""

    rank: int  # of C1 at the angles, with the project's tolerance
    odd: tuple[str, ...]  # wheels whose axle alone does not meet the others

    @property
    def mobility(self) -> int:
        """Return the freedoms of motion at these angles, 3 - rank (Siegwart (3.40))."""
        return 3 - self.rank


def check_steering(robot: Robot, steer: Mapping[str, float]) -> SteeringCheck:
    """Return whether the axles meet. ``steer`` has joint angles [rad] by wheel name, 0 if not given."""
    wheels = [w for w in robot.wheels if w.kind.constrains]
    rows = np.array([_row(w, steer) for w in wheels]).reshape(-1, 3)
    rank = _rank(rows)
    odd = [
        w.name
        for i, w in enumerate(wheels)
        if rank == 3 and w.kind.steers and _rank(np.delete(rows, i, axis=0)) == 2
    ]
    return SteeringCheck(rank, tuple(odd))


def _rank(rows: Array) -> int:
    """Return the numeric rank of rows."""
    return numeric_rank(unit_rows(rows))[0]


def axle_distances(robot: Robot, steer: Mapping[str, float], point: tuple[float, float]) -> dict[str, float]:
    """Return how far the axle line of each fixed or steered wheel passes from a point [m].

    Args:
        robot: The robot.
        steer: Steering angles [rad] by wheel name, 0 if not given.
        point: A point of the robot frame [m].

    Returns:
        Distances by wheel name.
    """
    distances = {}
    for w in robot.wheels:
        if w.kind.constrains:
            b, a, k = _row(w, steer)  # (-s, c, x c + y s)
            distances[w.name] = abs(float(a * point[0] - b * point[1] - k))
    return distances


def sideways_speeds(robot: Robot, twist: Sequence[float]) -> dict[str, float]:
    """Return how fast a twist (vx, vy, omega) moves each fixed wheel along its axle [m/s], by wheel name."""
    speeds = {}
    for w in robot.wheels:
        if w.kind.constrains and not w.kind.steers:
            speeds[w.name] = float(_row(w, {}) @ np.asarray(twist))
    return speeds


def _row(w: Wheel, steer: Mapping[str, float]) -> Array:
    """Return the sliding row of the pivot: [-s, c, x c + y s]."""
    angle = steer.get(w.name, 0.0) if w.kind.steers else 0.0
    return along(w, 1j * w.zero_heading * cmath.rect(1, angle))
