"""How fast the wheels of a car roll at the present steering angles: what `compensate_steering` commands of them.

The pivot of a steered wheel stands at (a, b) from the centre Q of the fixed axle, ahead and to the left. While it moves
at q along the wheel's direction (c, s), seen from the axle, Q moves at v and the body turns at omega,

    v = q (c + s b / a)    omega = q s / a

and every driven wheel rolls at row . xi = q g, with g of the steering angles alone. Commanded spins and angles have the
q of least squares; along the present direction the pivot moves at q cos(steer - steer_now), as `compensate_steering`
has it of a wheel that is steered and driven:

    q = sum of g r spin / sum of g**2    r spin' = q cos(steer - steer_now) g_now

Of several steered wheels the mean is taken, which is exact where all present angles are about one centre.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy

from wmrgen.analysis.kinematics.records import Locals
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.control.unicycle import drives
from wmrgen.functions.models.axle import Axle, fixed_axle
from wmrgen.geometry.constraints import along, rolling_row, working_view
from wmrgen.geometry.exact.evaluate import add_angles
from wmrgen.geometry.exact.poly import Poly, dot
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.symbolic import Expr, add, expression, maximum, over, signal, subtract, times

_LEAST = sympy.Rational(
    1, 10**6
)  # of the sum of g**2: the centre of rotation stands under the only driven wheel


def car_axle(robot: Robot, mobility: Mobility) -> Axle | None:
    """The fixed axle of a robot that one freedom of steering turns about a point of it."""
    axle = fixed_axle(robot, mobility, working_view)
    return axle if axle is not None and drives(robot, mobility, axle) and _leads(robot, axle) else None


def _leads(robot: Robot, axle: Axle) -> list[Wheel]:
    """The steered wheels off the axle line, whose angles say where the robot turns."""
    return [w for w in robot.wheels if w.kind.steers and axle.seen(working_view(w))[0]]


def axle_speeds(robot: Robot, axle: Axle, driven: Sequence[Wheel], names: Locals) -> list[Expr]:
    """Return the spins [rad/s] of ``driven`` wheels at the present angles ``<wheel>.steer_now``.

    Args:
        robot: a car; its inputs are commanded spins and angles, and the present angles.
        axle: see `car_axle`.
        driven: fixed and steered wheels.
        names: takes the intermediate results.
    """
    leads = _leads(robot, axle)
    turning = [w for w in robot.wheels if w.kind.steers and (w in leads or w in driven)]
    wanted, present = (
        {w.index: _direction(w, joint, names) for w in turning} for joint in ("steer", "steer_now")
    )
    parts: list[list[Expr]] = [[] for _ in driven]
    for lead in leads:
        g, now = (
            [names.short(f"{lead.name}_{when}_{w.name}", _per_speed(w, lead, axle, angles)) for w in driven]
            for when, angles in (("wanted", wanted), ("present", present))
        )
        radii = [working_view(w).rolling_radius for w in driven]
        rims = add(
            *(
                times(expression(k * r), signal(f"{w.name}.spin"))
                for w, k, r in zip(driven, g, radii, strict=True)
            )
        )
        speed = over(rims, maximum(expression(Poly.sum(k * k for k in g)), _LEAST))
        swing = subtract(signal(f"{lead.name}.steer"), signal(f"{lead.name}.steer_now"))
        moved = names.define(f"{lead.name}_speed", times(speed, sympy.cos(swing, evaluate=False)))
        for part, k, r in zip(parts, now, radii, strict=True):
            part.append(times(expression(k * r.inverse()), moved))
    return [times(sympy.Rational(1, len(leads)), add(*part)) for part in parts]


def _direction(w: Wheel, joint: str, names: Locals) -> tuple[Poly, Poly]:
    """(cos, sin) of the rolling direction at the angle ``joint``, robot frame."""
    g, angle = working_view(w), signal(f"{w.name}.{joint}")
    c = names.poly(f"{w.name}_{joint}_cos", sympy.cos(angle))
    return add_angles((g.ch, g.sh), (c, names.poly(f"{w.name}_{joint}_sin", sympy.sin(angle))))


def _per_speed(w: Wheel, lead: Wheel, axle: Axle, angles: dict[int, tuple[Poly, Poly]]) -> Poly:
    """g of a wheel: its rim speed per speed of the pivot of ``lead`` along its direction."""
    dx, dy = angles[lead.index]
    c, s = axle.ex * dx + axle.ey * dy, axle.ex * dy - axle.ey * dx
    a, b = axle.seen(working_view(lead))
    turn = s * a.inverse()
    v = c + b * turn
    g = working_view(w)
    if w.kind.steers:
        x, y, third = along(angles[w.index], g)
        row = x, y, third - g.o
    else:
        row = rolling_row(w, g).row
    return dot(row, (axle.ex * v + axle.y * turn, axle.ey * v - axle.x * turn, turn))
