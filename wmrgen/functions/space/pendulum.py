"""`stability` of a robot on two wheels whose centre of gravity is below their axle (Siegwart 3.1.1; formulas ours).

Two contacts span no polygon. Sideways the robot tips over either wheel, about the line through the contact along which
the wheel rolls. Lengthwise the body is a pendulum about the axle. The distance from the axle to the centre of gravity
c is d; the wheels have radius r and no mass. The ground pushes only at the contacts, and the body has no angular
acceleration while the line of that force passes through c. Seen from the side, a line from the contacts at the angle
phi from the vertical meets the circle on which c swings if

    |phi| <= asin(d/r),    and the lower of the two points,   s = r cos(phi) - sqrt(d**2 - r**2 sin(phi)**2)

from the contacts, is the stable posture. At a larger angle the body rotates about the axle: the wheels push harder
than its weight can balance. The lengthwise margin is asin(d/r) - |phi|. The margin of a wheel is the angle of
`stability` at this posture, where c is at the height z = s cos(phi). The components of the force are in the frame of
the ground, not of the body.
"""

from __future__ import annotations

from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, tunable_ports
from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.functions.registry import Reason, underivable
from wmrgen.functions.space.wheel_motion import AXES, FORCE, Vector, cross, dot, input_vector
from wmrgen.geometry.layout.records import Point, Robot, Wheel
from wmrgen.geometry.layout.skid import parallel
from wmrgen.geometry.ports import Port, output
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    at_least,
    clamp_between,
    expression,
    maximum,
    minimum,
    norm,
    over,
    root,
    select,
    square,
    subtract,
    times,
)

SWING = "swing.margin"
_SMALLEST = sympy.Rational(1, 10**12)  # the least size of a divisor


class Axle(NamedTuple):
    """Two wheels on one axle line, seen along the direction in which they roll."""

    right: Wheel
    left: Wheel


def axle(robot: Robot) -> Axle | None:
    """Return the outer wheels of a robot on fixed wheels of one axle line alone, at two places or more; else None."""
    wheels = robot.wheels
    if (
        len(wheels) < 2
        or not all(w.kind.fixed_axle for w in wheels)
        or not parallel([w.zero_heading for w in wheels])
    ):
        return None
    ahead = wheels[0].zero_heading
    places = [w.contact(w.zero_heading) / ahead for w in wheels]  # real part along the rolling direction
    first, last = (choose(range(len(wheels)), key=lambda k: places[k].imag) for choose in (min, max))
    width = places[last].imag - places[first].imag
    if width <= NEGLIGIBLE or any(abs(p.real - places[0].real) > NEGLIGIBLE * width for p in places):
        return None
    return Axle(wheels[first], wheels[last])


class _HangingBody(NamedTuple):
    """The geometry of a body that hangs from its axle."""

    right: Expr  # how far the centre of gravity is to the left of the right contact [m]
    left: Expr  # how far the centre of gravity is to the left of the left contact [m]
    radius: Expr  # of the wheels [m]
    arm: Expr  # from the axle to the centre of gravity [m]


def _hanging_body(robot: Robot, cg: Point, two: Axle) -> _HangingBody:
    """Return the geometry. Raise NotDerivableError if the body cannot hang."""
    lowest = two.right.nominal.r - cg.z.nominal
    if len({w.working.r.key for w in robot.wheels}) > 1:
        why = "it stands on one axle, and its wheels have different radii, so the axle may be inclined"
        raise underivable(robot, "stability", why, Reason.AXLES)
    if lowest.sign <= 0:
        why = (
            f"its {len(robot.wheels)} contacts do not span a support polygon, and its centre of gravity is not below "
            "the axle: it stands only while a controller balances it.\n"
            "  A robot on one axle stands by itself if z of cg is less than the radius of its wheels."
        )
        raise underivable(robot, "stability", why, Reason.CENTRE_OF_GRAVITY)
    g, n = two.right.working, two.right.nominal
    x, y, z = (length.working for length in cg)
    offset = (cg.x.nominal - n.x) * n.ch + (cg.y.nominal - n.y) * n.sh
    if (offset * offset + lowest * lowest - n.r * n.r).sign >= 0:
        why = (
            "its centre of gravity is as far from the axle as the ground: the body cannot hang from the axle"
        )
        raise underivable(robot, "stability", why, Reason.CENTRE_OF_GRAVITY)
    ahead = (x - g.x) * g.ch + (y - g.y) * g.sh
    right, left = ((y - w.working.y) * g.ch - (x - w.working.x) * g.sh for w in two)
    arm = root(expression(ahead * ahead + (g.r - z) * (g.r - z)))
    return _HangingBody(expression(right), expression(left), expression(g.r), arm)


def hanging_stability(robot: Robot, cg: Point, two: Axle) -> Formula:
    """Return the margins of a robot that hangs from its axle for a specific force: see above.

    Args:
        robot: A robot on fixed wheels of one axle.
        cg: Its centre of gravity in the posture of the robot file [m].
        two: Its outer wheels.

    Returns:
        A function with ``<wheel>.margin``, ``swing.margin`` and ``margin`` [rad], and ranges of fx and fy [m/s^2] if
        the wheels roll along x or y.
    """
    body, names = _hanging_body(robot, cg, two), Locals()
    g = two.right.working
    c, s = expression(g.ch), expression(g.sh)
    fx, fy, fz = input_vector("f")
    force: Vector = (
        names.define("f_ahead", add(times(c, fx), times(s, fy))),
        names.define("f_left", subtract(times(c, fy), times(s, fx))),
        fz,
    )
    arm = names.define("arm", body.arm)
    height = names.define("height", _height(force, body.radius, arm, names))
    margins = [
        names.define(f"{w.name}_tilt", _margin(force, (sympy.S.Zero, times(k, height), times(-k, side))))
        for w, k, side in ((two.right, 1, body.right), (two.left, -1, body.left))
    ]
    steepest = angle_of(arm, root(maximum(sympy.S.Zero, subtract(square(body.radius), square(arm)))))
    leaning = absolute(angle_of(force[0], fz))
    margins.append(names.define("swing", subtract(steepest, leaning)))
    texts = [f"{w.name}.margin" for w in two]
    ports = [output(name, "rad", "remaining tilt about the contact of this wheel") for name in texts]
    ports.append(output(SWING, "rad", "remaining lean of the force before the body rotates about its axle"))
    outputs = list(zip(ports, margins, strict=True))
    least = minimum(margins[2], minimum(margins[0], margins[1]))
    outputs.append((output("margin", "rad", "smallest margin; negative: tips over"), least))
    outputs += _ranges(two, body, force, height, arm, names)
    return names.formula(
        "stability", (*FORCE, *tunable_ports(robot)), outputs,
        "specific force to the remaining angle before the robot tips over a wheel or its body rotates",
    )  # fmt: skip


def _height(force: Vector, radius: Expr, arm: Expr, names: Locals) -> Expr:
    """Return z = cos(phi) (r cos(phi) - sqrt(d**2 - r**2 sin(phi)**2)) for the direction of the force."""
    size = names.define("f_size", at_least(add(square(force[0]), square(force[2])), _SMALLEST))
    below = subtract(times(square(arm), size), square(times(radius, force[0])))
    hanging = subtract(times(radius, force[2]), root(maximum(sympy.S.Zero, below)))
    return over(times(force[2], hanging), size)


def _margin(f: Vector, m: Vector) -> Expr:
    """Return the margin of a plane, as in `stability`."""
    return angle_of(times(-1, dot(f, m)), norm(*cross(f, m)))


def _ranges(
    two: Axle, body: _HangingBody, force: Vector, height: Expr, arm: Expr, names: Locals
) -> list[tuple[Port, Expr]]:
    """Return the ranges of fx and fy in which the robot stands; none if the wheels roll neither along x nor y.

    The other components are as given. Across, the line of the force must meet the ground between the wheels: right >=
    z f_left/fz >= left. Along, the same condition bounds z from above, and on the lower arc of the circle z grows with
    the lean of the force.
    """
    n = two.right.nominal
    if n.ch and n.sh:
        return []
    along, across = (0, 1) if n.ch else (1, 0)
    tall = names.define("tall", at_least(height, _SMALLEST))
    ends = [over(times(force[2], side), tall) for side in (body.left, body.right)]
    turned = (n.ch if n.ch else -n.sh).sign < 0  # the left of the wheels is to the right of the axis
    low, high = (times(-1, e) for e in reversed(ends)) if turned else ends
    radius = body.radius
    wide = select(force[1], sympy.S.Zero, times(-1, body.left), body.right)
    push = names.define("push", at_least(absolute(force[1]), _SMALLEST))
    top = subtract(radius, over(square(arm), radius))
    ceiling = names.define(
        "ceiling", clamp_between(subtract(radius, arm), over(times(force[2], wide), push), top)
    )
    swing = root(maximum(sympy.S.Zero, subtract(square(arm), square(subtract(radius, ceiling)))))
    most = names.define("most", over(times(force[2], swing), at_least(ceiling, _SMALLEST)))
    bounds = {along: (times(-1, most), most), across: (low, high)}
    text = "f{0} at which the robot tips over, other components as given"
    ranges = []
    for k in (0, 1):
        for end, value in zip(("min", "max"), bounds[k], strict=True):
            ranges.append((output(f"f{AXES[k]}_{end}", "m/s^2", text.format(AXES[k])), value))
    return ranges
