"""Steering angles whose axles meet in a given centre of rotation (Kelly 4.2.1.2: Jeantaud)."""

from __future__ import annotations

from wmrgen.errors import NotDerivableError
from wmrgen.functions.motion.compose import include
from wmrgen.functions.motion.icr import centre_ports
from wmrgen.functions.registry import function
from wmrgen.kinematics.inverse import inverse
from wmrgen.kinematics.records import Formula, Locals
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Role
from wmrgen.symbolic import signal, times


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
