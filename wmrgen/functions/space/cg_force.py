"""`cg_force`: the specific force at the centre of gravity from that at a sensor (Kelly 4.1.3).

t_c = t_s + alpha x r + omega x (omega x r), r from the sensor to the centre of gravity, which is fixed in the body.
"""

from __future__ import annotations

from wmrgen.functions.registry import function
from wmrgen.functions.space.stability import FORCE, centre_of_gravity
from wmrgen.functions.space.vectors import Frame, Point, seen_from_before
from wmrgen.functions.space.wheel_motion import AXES, BODY, NOTHING, given_vector
from wmrgen.kinematics.records import Formula, tunable_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import signal, subtract

SENSOR = tuple(Port(f"sensor.{k}", Role.STATE, "m", "place of the sensor, z above the ground") for k in AXES)
_MEASURED = tuple(
    Port(p.name, p.role, p.unit, "specific force a - g at the sensor, robot frame") for p in FORCE
)


@function("Kelly 4.1.3")
def cg_force(robot: Robot, _: Mobility) -> Formula:
    """What an accelerometer and a gyroscope measure to the specific force at the centre of gravity."""
    c = centre_of_gravity(robot, "cg_force")
    x, y, z = (subtract(c[k], signal(port.name)) for k, port in enumerate(SENSOR))
    body = Frame(NOTHING, given_vector("w"), given_vector("f"), given_vector("w", "_rate"))
    found = seen_from_before(body, NOTHING, Point((x, y, z), NOTHING, NOTHING)).a
    turning = tuple(p for p in BODY if p.name.startswith("w"))
    return Formula(
        "cg_force", (*_MEASURED, *SENSOR, *turning, *tunable_ports(robot)), (),
        tuple(zip(FORCE, found, strict=True)),
        "specific force at a sensor to that at the centre of gravity (Kelly 4.1.3)",
    )  # fmt: skip
