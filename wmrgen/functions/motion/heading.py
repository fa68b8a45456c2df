"""The heading from wheel angles, where the yaw rate is a constant combination of wheel speeds.

It then integrates: a holonomic relation, as phi = phi0 - (r/3a)(psi1 + psi2 + psi3) (Konstantinov (6)) and
phi = phi0 + r (theta_r - theta_l) / 2a of the differential drive (Tzafestas (2.36c)).
"""

from __future__ import annotations

import numpy as np

from wmrgen.errors import NotDerivableError
from wmrgen.exact.evaluate import fix
from wmrgen.exact.poly import Poly
from wmrgen.functions.motion.compose import include
from wmrgen.functions.registry import function
from wmrgen.kinematics.forward import constant_normal, forward
from wmrgen.kinematics.odometry import POSE
from wmrgen.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.kinematics.sensing import Component, Contact, measurements
from wmrgen.layout.records import Robot
from wmrgen.mobility.ranks import numeric_rank
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import add, signal


@function("Konstantinov (6); Tzafestas (2.36)")
def heading(robot: Robot, _: Mobility) -> Formula:
    """Wheel angles turned since the heading was theta, to the heading now."""
    contacts, components = measurements(robot)
    if not constant_normal(contacts, components):
        raise NotDerivableError(_why(robot, "its yaw rate depends on joint angles that change on the way"))
    if not _sees_yaw(robot, contacts, components):
        raise NotDerivableError(_why(robot, "the sensed wheel speeds do not determine its yaw rate"))
    formula, names = forward(robot), Locals()
    spins = [p for p in formula.inputs if p.name.endswith(".spin")]
    joints = {signal(p.name) for p in formula.inputs if p.name.endswith((".steer", ".steer_rate"))}
    if joints & formula.closed()["omega"].free_symbols:
        raise NotDerivableError(_why(robot, "its yaw rate depends on steering angles that change on the way"))
    angles = {p.name: signal(p.name.replace(".spin", ".angle")) for p in spins}
    omega = include(formula, angles, names)["omega"]
    text = "angle of the wheel about its axle since the heading was theta"
    inputs = (
        *(Port(p.name.replace(".spin", ".angle"), Role.STATE, "rad", text) for p in spins),
        POSE[2],
        *tunable_ports(robot),
    )
    outputs = ((POSE[2], add(signal("theta"), omega)),)
    return Formula(
        "heading", inputs, tuple(names.items), outputs, "heading from wheel angles, a holonomic relation"
    )


def _why(robot: Robot, reason: str) -> str:
    return f"{robot.name} has no heading function: {reason}"


def _sees_yaw(robot: Robot, contacts: list[Contact], components: list[Component]) -> bool:
    """True when the known rows contain the yaw rate, at nominal parameters."""
    nominal = {p.name: Poly.of(p.nominal) for p in robot.parameters}

    def value(p: Poly) -> float:
        found = fix(p, nominal).constant
        return float(found) if found is not None else 0.0

    rows = [r for c in contacts for r in ([1.0, 0.0, -value(c.by)], [0.0, 1.0, value(c.bx)])]
    rows += [[value(p) for p in c.row] for c in components]
    known = np.array(rows).reshape(-1, 3)
    return numeric_rank(known)[0] == numeric_rank(np.vstack([known, [0.0, 0.0, 1.0]]))[0]
