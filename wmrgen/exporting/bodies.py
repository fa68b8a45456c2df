"""The links of a robot: one for each joint, in the order of the file, the axle of a steered wheel below its steering.

base_link is P, on the ground, x forward. A wheel's link lies in its centre, turned so that it rolls along its x and
turns about its y; a steering link lies in the pivot at the height of the axle and turns about z.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from wmrgen.layout.records import Interval, Robot, Wheel

BASE = "base_link"
WIDTH = 0.4  # of a wheel, in radii
MASSES = {"chassis": 10.0, "steer": 0.5, "spin": 1.0, "ball": 0.2}  # [kg]
EFFORT, SPEED = 100.0, 10.0  # [Nm], [rad/s] of joints of which the robot file says nothing
PLACEHOLDERS = (
    "PLACEHOLDERS, of which the robot file says nothing: masses, inertias, the chassis, widths of wheels, efforts; "
    "velocities of joints, radii of balls, where it gives none."
)
Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Body:
    """A link of ``wheel`` and the joint of that ``part`` (spin, steer, ball) that carries it, at ``place`` [m] and
    ``yaw`` [rad] in the link ``parent``. ``driven``: it has a motor of its own. ``leader``: the joint that a coupling
    makes it equal to. ``limits`` of its angle [rad], ``speed`` [rad/s]: None where the file has none."""

    wheel: Wheel
    part: str
    parent: str
    place: Vector
    yaw: float
    radius: float
    driven: bool = False
    leader: str = ""
    limits: Interval | None = None
    speed: float | None = None

    @property
    def joint(self) -> str:
        return joint_of(self.wheel, self.part)

    @property
    def link(self) -> str:
        return f"{self.joint}_link"

    @property
    def inertia(self) -> Vector:
        """Moments about x, y, z [kg m2]: a solid cylinder about y, else a ball."""
        mass, r = MASSES[self.part], self.radius
        if self.part != "spin":
            return (0.4 * mass * r**2,) * 3
        across = mass * (3 * r**2 + (WIDTH * r) ** 2) / 12
        return across, mass * r**2 / 2, across


def joint_of(wheel: Wheel, part: str) -> str:
    """What ROS calls a joint of a wheel, as in packages of `wmrgen derive`: left_spin."""
    return f"{wheel.name}_{part}"


def bodies(robot: Robot) -> list[Body]:
    """The links of all wheels, each after its parent."""
    return [body for wheel in robot.wheels for body in _bodies(robot, wheel)]


def _bodies(robot: Robot, wheel: Wheel) -> Iterator[Body]:
    g = wheel.nominal
    x, y, r = float(g.x), float(g.y), float(g.r)
    if not wheel.has_spin:
        r = r or min((float(w.nominal.r) for w in robot.wheels if w.nominal.r), default=0.1) / 2
        yield Body(wheel, "ball", BASE, (x, y, r), 0.0, r)
    elif wheel.turns:
        steering = _jointed(robot, wheel, "steer", BASE, (x, y, r), wheel.heading)
        yield steering
        yield _jointed(robot, wheel, "spin", steering.link, (float(g.d), float(g.o), 0.0), 0.0)
    else:
        yield _jointed(robot, wheel, "spin", BASE, (x, y, r), wheel.heading)


def _jointed(robot: Robot, wheel: Wheel, part: str, parent: str, place: Vector, yaw: float) -> Body:
    """A link whose joint turns. Of coupled joints the first leads, and has their motor."""
    together = next(group for group in robot.together(part, robot.wheels) if wheel in group)
    leads = together[0] is wheel
    rate = robot.limit(wheel, "spin" if part == "spin" else "steer_rate")
    return Body(
        wheel, part, parent, place, yaw, float(wheel.nominal.r),
        driven=leads and any(part in w.actuated for w in together),
        leader="" if leads else joint_of(together[0], part),
        limits=robot.limit(wheel, "steer") if part == "steer" else None,
        speed=None if rate is None else max(abs(float(rate.low)), abs(float(rate.high))),
    )  # fmt: skip


def chassis(robot: Robot) -> tuple[Vector, Vector, Vector]:
    """Size and centre of a box over the wheels [m], and its moments of inertia."""
    height = max((float(w.nominal.r) for w in robot.wheels), default=0.0) or 0.1
    spans = [[float(getattr(w.nominal, axis)) for w in robot.wheels] for axis in "xy"]
    (x, length), (y, width) = (((max(s) + min(s)) / 2, max(s) - min(s) + height) for s in spans)
    i, j, k = (MASSES["chassis"] * a**2 / 12 for a in (length, width, height))
    return (length, width, height), (x, y, 2 * height), (j + k, i + k, i + j)
