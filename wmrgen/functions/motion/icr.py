"""The instantaneous centre of rotation (ICR): of a twist, `icr`, and the steering angles of a centre, `steer_to`.

Homogeneous coordinates stay finite (Kelly 4.2.1): a twist turns the body about (x, y) / w with
(x, y, w) = (-vy, vx, omega) in the robot frame; w = 0 is a translation: the centre lies at infinity in the direction
(x, y), at right angles to the motion.

`check_steering` says whether the axles agree at given steering angles, by the rank of C1 there (Kelly 4.2.1.2):

    rank 1   all axles lie on one line: the ICR may be anywhere on it (Siegwart 3.3.1)
    rank 2   all axles meet in the ICR, or all are parallel: crab steering, the ICR at infinity (Jeantaud)
    rank 3   the axles do not meet: mobility 0, driving slides
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, sin

import numpy as np
import sympy

from wmrgen.errors import NotDerivableError
from wmrgen.functions.motion.paths import FARTHEST, SLOWEST, include, over, path
from wmrgen.functions.registry import function
from wmrgen.kinematics.inverse import inverse
from wmrgen.kinematics.records import Formula, Locals, twist_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.ranks import numeric_rank, unit_rows
from wmrgen.mobility.records import Array, Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import add, maximum, number, root, signal, square, subtract, times

POINT = (
    Port("point.x", Role.COMMAND, "m", "a point of the body, robot frame"),
    Port("point.y", Role.COMMAND, "m", "a point of the body, robot frame"),
)


def centre_ports(
    role: Role = Role.COMMAND, unit: str = "m/s", weight: str = "rad/s"
) -> tuple[Port, Port, Port]:
    """icr.x, icr.y, icr.w."""
    return (
        Port(
            "icr.x", role, unit, "homogeneous: the centre of rotation is (icr.x, icr.y) / icr.w, robot frame"
        ),
        Port(
            "icr.y", role, unit, "homogeneous: the centre of rotation is (icr.x, icr.y) / icr.w, robot frame"
        ),
        Port("icr.w", role, weight, "homogeneous weight of the centre; 0: at infinity, a translation"),
    )


@function("Kelly 4.2.1.1; Tzafestas (2.43)")
def icr(robot: Robot, _: Mobility) -> Formula:
    """Twist and a point of the body to the ICR, the curvature of P and the velocity and radius of the point."""
    del robot
    names = Locals()
    vx, vy, omega = (signal(n) for n in ("vx", "vy", "omega"))
    facts = path((vx, vy, omega), names)
    a = names.define("point_x_rate", subtract(vx, omega * signal("point.y")))
    b = names.define("point_y_rate", add(vy, omega * signal("point.x")))
    rate = names.define("rate", maximum(sympy.Abs(omega, evaluate=False), number(SLOWEST)))
    speed = names.define("point_speed", root(add(square(a), square(b))))
    turning = names.define("point_turning", maximum(rate, over(speed, number(FARTHEST))))
    centre = zip(centre_ports(), (times(-1, vy), vx, omega), strict=True)
    outputs = (
        *centre,
        (Port("turns", Role.COMMAND, "", "1 counter-clockwise, -1 clockwise, 0 translation"), facts["turns"]),
        (Port("radius", Role.COMMAND, "m", "distance of P from the centre, at most 1e9"), facts["radius"]),
        (Port("curvature", Role.COMMAND, "1/m", "yaw rate over speed of P, at most 1e9 in size"), facts["curvature"]),
        (Port("point.vx", Role.COMMAND, "m/s", "velocity of the point, robot frame"), a),
        (Port("point.vy", Role.COMMAND, "m/s", "velocity of the point, robot frame"), b),
        (Port("point.radius", Role.COMMAND, "m", "distance of the point from the centre, at most 1e9"),
         over(speed, turning)),
    )  # fmt: skip
    text = "instantaneous centre of rotation of a twist; radius and velocity of a point of the body"
    return Formula("icr", (*twist_ports(), *POINT), tuple(names.items), tuple(outputs), text)


@function("Kelly 4.2.1.2 (Jeantaud), 4.2.2.1.1")
def steer_to(robot: Robot, mobility: Mobility) -> Formula:
    """A centre of rotation to the steering angles whose axles meet there (Kelly 4.2.1.2: Jeantaud).

    Each wheel takes the nearer of its two branches, as in ``inverse``; fixed wheels pull the centre to their axle.
    """
    if not any(w.kind.steers for w in robot.wheels):
        raise NotDerivableError(f"{robot.name} has no steer_to: none of its wheels is steered")
    names = Locals()
    x, y, w = centre_ports()
    formula = inverse(robot, mobility)
    turned = {"vx": signal("icr.y"), "vy": times(-1, signal("icr.x")), "omega": signal("icr.w")}
    found = include(formula, turned, names)
    steers = {f"{w.name}.steer" for w in robot.wheels if w.kind.steers}
    outputs = tuple((p, found[p.name]) for p, _ in formula.outputs if p.name in steers)
    inputs = (x, y, w, *(p for p in formula.inputs if p.name in steers or p.role is Role.GEOMETRY))
    text = "centre of rotation to steering angles; a point has icr.w = 1, a direction of infinity icr.w = 0"
    return Formula("steer_to", inputs, tuple(names.items), outputs, text)


@dataclass(frozen=True, slots=True)
class SteeringCheck:
    """``rank``: of C1 at the angles, at the project's tolerance. ``odd``: wheels each of which alone spoils it.

    ``mobility`` = 3 - rank: what the robot can still do at these angles.
    """

    rank: int
    singular_values: tuple[float, ...]
    odd: tuple[str, ...]

    @property
    def mobility(self) -> int:
        """Freedoms of motion at these angles (Siegwart (3.40))."""
        return 3 - self.rank


def check_steering(robot: Robot, steer: Mapping[str, float]) -> SteeringCheck:
    """``steer``: joint angle [rad] by wheel name, 0 where not given."""
    wheels = [w for w in robot.wheels if w.kind.constrains]
    rows = np.array([_row(w, steer) for w in wheels]).reshape(-1, 3)
    rank, singular = _rank(rows)
    odd = [
        w.name
        for i, w in enumerate(wheels)
        if rank == 3 and w.kind.steers and _rank(np.delete(rows, i, axis=0))[0] == 2
    ]
    return SteeringCheck(rank, singular, tuple(odd))


def _rank(rows: Array) -> tuple[int, tuple[float, ...]]:
    return numeric_rank(unit_rows(rows)) if len(rows) else (0, ())


def axle_distances(robot: Robot, steer: Mapping[str, float], point: tuple[float, float]) -> dict[str, float]:
    """How far the axle line of each fixed or steered wheel passes from a point of the robot frame [m]."""
    found = {}
    for w in robot.wheels:
        if w.kind.constrains:
            b, a, k = _row(w, steer)  # (-s, c, x c + y s)
            found[w.name] = abs(a * point[0] - b * point[1] - k)
    return found


def _row(w: Wheel, steer: Mapping[str, float]) -> list[float]:
    """Sliding row of the pivot: [-s, c, x c + y s]."""
    ch, sh, x, y = (float(v) for v in (w.nominal.ch, w.nominal.sh, w.nominal.x, w.nominal.y))
    angle = steer.get(w.name, 0.0) if w.kind.steers else 0.0
    c, s = ch * cos(angle) - sh * sin(angle), sh * cos(angle) + ch * sin(angle)
    return [-s, c, x * c + y * s]
