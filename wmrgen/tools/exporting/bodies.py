"""The links of a robot, ready to print: one for each joint, the axle of a steered wheel below its steering joint.

The frame of the robot is P, on the ground, x forward. The origin of a wheel's link is its centre; the wheel rolls
along x and turns about y. The origin of a steering link is the pivot at the height of the axle; the joint turns about
z.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import degrees, pi
from typing import Any

from wmrgen.errors import NotDerivableError
from wmrgen.geometry.layout.records import Interval, Robot, Wheel
from wmrgen.robotfile.text import quoted
from wmrgen.tools.exporting.text import banner, decimal, decimals
from wmrgen.tools.importing.records import RIGID

WIDTH = 0.4  # of a wheel, in radii
CHASSIS, FORK, WHEEL, BALL = 10.0, 0.5, 1.0, 0.2  # masses [kg]
EFFORT, SPEED = "100", 10.0  # [Nm], [rad/s] of joints without limits in the robot file
_NOTES = (
    "PLACEHOLDERS, because the robot file has none: masses, inertias, the chassis, widths of wheels, efforts; "
    "velocities of joints and radii of balls, if it has none.",
)
Moments = tuple[str, str, str]
Pairs = tuple[tuple[str, str], ...]
Frictions = tuple[tuple[str, tuple[str, ...]], ...]


@dataclass(frozen=True, slots=True)
class Body:
    """A link of a wheel and the joint that carries it. Values that it does not have are empty."""

    wheel: Wheel
    part: str  # spin, steer or ball
    parent: str  # the link above
    xyz: str  # [m] in the parent
    yaw: str  # [rad] in the parent
    mass: str  # [kg]
    moments: Moments  # about x, y, z [kg m2]
    kind: str = RIGID  # of the joint
    solid: str = ""  # the shape
    sizes: Pairs = ()
    # Visual and collision: mu, and its directions in the frame of the robot.
    roles: Mapping[str, Frictions] = field(default_factory=dict)
    axes: tuple[str, ...] = ()
    limits: tuple[Pairs, ...] = ()
    leaders: Pairs = ()  # the joint that it follows by a coupling, and the ratio
    remarks: tuple[str, ...] = ()
    driven: bool = False  # it has a motor of its own

    @property
    def joint(self) -> str:
        """Return the name of the joint."""
        return joint_of(self.wheel, self.part)

    @property
    def link(self) -> str:
        """Return the name of the link."""
        return f"{self.joint}_link"


def joint_of(wheel: Wheel, part: str) -> str:
    """Return the name of a wheel's joint in other tools: the robot file's, else left_spin."""
    return wheel.joint_name(part).name


def bodies(robot: Robot) -> list[Body]:
    """Return the links of all wheels in the order of the file, each after its parent."""
    return [body for wheel in robot.wheels for body in _bodies(robot, wheel)]


def context(robot: Robot) -> dict[str, Any]:
    """Return the values of a robot that the templates of URDF and SDFormat print."""
    height = max((float(w.nominal.r) for w in robot.wheels), default=0.0) or 0.1
    spans = [[float(getattr(w.nominal, axis)) for w in robot.wheels] for axis in "xy"]
    (x, length), (y, width) = (((max(s) + min(s)) / 2, max(s) - min(s) + height) for s in spans)
    chassis = {
        "mass": decimal(CHASSIS), "size": decimals(length, width, height), "xyz": decimals(x, y, 2 * height),
        "moments": _moments(CHASSIS, *(a**2 / 12 for a in (length, width, height))),
    }  # fmt: skip
    frame = f"{robot.frame} is the frame of the robot file: P, on the ground, x forward."
    about = [*banner(robot), frame, *_NOTES]
    return {
        "robot": robot.name,
        "about": about,
        "base": robot.frame,
        "chassis": chassis,
        "quarter": decimal(pi / 2),
    }


def _moments(mass: float, x: float, y: float, z: float) -> Moments:
    """Return the moments of inertia of a mass with these mean square extents along x, y and z [m2]."""
    return decimal(mass * (y + z)), decimal(mass * (x + z)), decimal(mass * (x + y))


def _bodies(robot: Robot, wheel: Wheel) -> Iterator[Body]:
    g, yaw = wheel.nominal, decimal(wheel.heading)
    r = float(g.r) or min((float(w.nominal.r) for w in robot.wheels if w.nominal.r), default=0.1) / 2
    at, ball, radius = decimals(g.x, g.y, r), (r**2 / 5,) * 3, (("radius", decimal(r)),)
    if wheel.ball:
        raise NotDerivableError(
            f"{quoted(wheel.ball)} is a driven ball; URDF and SDF have no joint that rolls a ball along one direction "
            "only\n"
            "For this export, write each driven direction as an omni wheel (type: swedish, gamma: 0, heading: the "
            "direction), or delete driven: the ball is then passive."
        )
    if not wheel.has_spin:
        yield Body(
            wheel, "ball", robot.frame, at, "0", decimal(BALL), _moments(BALL, *ball),
            solid="sphere", sizes=radius, roles=_roles((("0", ()),)),
        )  # fmt: skip
        return
    below = robot.frame
    if wheel.turns:
        angles = robot.limit(wheel, "steer")
        ends = _ends(wheel, angles)
        steering = Body(
            wheel, "steer", robot.frame, at, yaw, decimal(FORK), _moments(FORK, *ball),
            "revolute" if ends else "continuous", axes=(_axis(wheel, "steer"),),
            **_jointed(robot, wheel, "steer", "steer_rate", ends),
        )  # fmt: skip
        yield steering
        below, at, yaw = steering.link, decimals(g.d, g.o, 0), "0"
    width = WIDTH * r
    grips, remarks = _rollers(wheel) if wheel.kind.rollers else ((), ())
    yield Body(
        wheel, "spin", below, at, yaw, decimal(WHEEL), _moments(WHEEL, r**2 / 4, width**2 / 12, r**2 / 4),
        "continuous", "cylinder", (*radius, ("length", decimal(width))), _roles(grips), (_axis(wheel, "spin"),),
        remarks=remarks, **_jointed(robot, wheel, "spin", "spin", ()),
    )  # fmt: skip


def _axis(wheel: Wheel, part: str) -> str:
    """Return the axis of a joint in its link: upright for steering, to the left for spin, or opposite."""
    sign = wheel.joint_name(part).sign
    return decimals(0, 0, sign) if part == "steer" else decimals(0, sign, 0)


def _ends(wheel: Wheel, angles: Interval | None) -> Pairs:
    """Return the limits of a steering joint [rad], as its own axis counts them."""
    if angles is None:
        return ()
    ends = [wheel.joint_name("steer").sign * float(end) for end in (angles.low, angles.high)]
    return ("lower", decimal(min(ends))), ("upper", decimal(max(ends)))


def _roles(frictions: Frictions) -> dict[str, Frictions]:
    return {"visual": (), "collision": frictions}


def _jointed(robot: Robot, wheel: Wheel, part: str, rate: str, ends: Pairs) -> dict[str, Any]:
    """Return limits and motor of a joint. The first of coupled joints leads and has their motor."""
    together = next(group for group in robot.together(part, robot.wheels) if wheel in group)
    leads, speed = together[0] is wheel, robot.limit(wheel, rate)
    most = SPEED if speed is None else max(abs(float(speed.low)), abs(float(speed.high)))
    limit = (*ends, ("effort", EFFORT), ("velocity", decimal(most)))
    sign = wheel.joint_name(part).sign * together[0].joint_name(part).sign
    ratio = decimal(sign * float(robot.turn_ratio(part, wheel)))
    return {
        "limits": (limit,) if ends or speed is not None else (),
        "leaders": () if leads else ((joint_of(together[0], part), ratio),),
        "driven": leads and any(part in w.actuated for w in together),
    }


def _rollers(wheel: Wheel) -> tuple[Frictions, tuple[str]]:
    """Return the friction along the axis of the roller at the ground, in the frame of the robot."""
    ch, sh, cg, sg = (float(getattr(wheel.nominal, name)) for name in ("ch", "sh", "cg", "sg"))
    axis = decimals(ch * cg - sh * sg, sh * cg + ch * sg, 0)
    text = "from the rolling direction to the axis of the roller at the ground"
    return (("1", (axis,)),), (f"{wheel.name}: gamma = {decimal(degrees(wheel.gamma))} deg, {text}.",)
