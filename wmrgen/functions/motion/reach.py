"""The constant twist that displaces the robot: the inverse of `wmrgen.kinematics.odometry` (SE(2) logarithm).

The chord of the arc points along theta / 2 and is dt sinc(theta / 2) times the velocity, so

    v = R(-theta / 2) (x, y) / (dt sinc(theta / 2)),   omega = theta / dt
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import sympy

from wmrgen.exact.number import Exact
from wmrgen.functions.motion.compose import include, over
from wmrgen.functions.registry import function
from wmrgen.kinematics.odometry import POSE, odometry
from wmrgen.kinematics.records import Formula, Locals, twist_ports
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import add, local, maximum, number, signal, subtract, times

SHORTEST = Exact(Fraction(1, 10**9))  # [s] a duration below counts as this, a chord this short as none
_TEXTS = (
    "forward, robot frame at the start",
    "to the left, robot frame at the start",
    "turn, at most pi in size",
)


@function("Siegwart figures 3.15 and 3.16, the twist of a segment")
def reach(robot: Robot, _: Mobility) -> Formula:
    """Displacement x y theta in the robot frame and dt to the constant twist that makes it."""
    del robot
    names = Locals()
    x, y, theta, dt = (signal(n) for n in ("x", "y", "theta", "dt"))
    # Unit speed for unit time along the same arc: its chord is sinc(theta / 2), series and switch point included.
    unit = {n: sympy.Integer(n in ("vx", "dt")) for n in ("x", "y", "theta", "vx", "vy", "dt")}
    include(odometry(), unit | {"omega": theta}, names)
    sinc, h = local("chord"), local("half_turn")
    c, s = names.define("cos_half", sympy.cos(h)), names.define("sin_half", sympy.sin(h))
    time = names.define("time_kept", maximum(dt, number(SHORTEST)))
    scale = names.define("scale", over(sympy.S.One, times(time, maximum(sinc, number(SHORTEST)))))
    values = (
        times(scale, add(times(c, x), times(s, y))),
        times(scale, subtract(times(c, y), times(s, x))),
        over(theta, time),
    )
    inputs = (
        *(replace(p, role=Role.COMMAND, text=t) for p, t in zip(POSE, _TEXTS, strict=True)),
        Port("dt", Role.COMMAND, "s", "duration of the motion, above 0"),
    )
    outputs = tuple(zip(twist_ports(), values, strict=True))
    text = "constant twist that displaces the robot by x y theta in dt"
    return Formula("reach", inputs, tuple(names.items), outputs, text)
