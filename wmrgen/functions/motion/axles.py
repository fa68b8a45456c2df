"""The ICR that the wheel axles point at, for given steering angles: least squares, with the mismatch.

Among the motions that the fixed wheels allow, the one that slides least for the way it makes: the sum of the
squared lateral velocities of the steered wheels is smallest for a given sum of squared velocities of all wheels
with an axle. It does not depend on the frame or the unit of length, and a centre at infinity (crab steering) is a
motion like any other. With one axle line of fixed wheels it is the smaller principal axis of a 2 x 2 matrix,
without fixed wheels the smallest eigenvector of a 3 x 3 one.
"""

from __future__ import annotations

from fractions import Fraction

import sympy

from wmrgen.constraints import heading, working_view
from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.functions.motion.eigen import smallest_eigenvector
from wmrgen.functions.motion.icr import centre_ports
from wmrgen.functions.motion.paths import path
from wmrgen.functions.registry import function
from wmrgen.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.basis import null_columns
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    expression,
    maximum,
    number,
    over,
    root,
    select,
    square,
    times,
)

FLOOR = Exact(Fraction(1, 10**9))  # [m] wheels this near to each other stand on one point


@function("Kelly 4.2.1.2 (Jeantaud); Siegwart 3.3.1; Tzafestas (2.48)")
def axles(robot: Robot, mobility: Mobility) -> Formula:
    """Steering angles to the ICR of the axles, its curvature, the mismatch and each wheel's error."""
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    steered = [w for w in robot.wheels if w.kind.steers]
    rank = mobility.rank_C1f.value
    _derivable(robot, steered, rank)
    names = Locals()
    with_axle = [*fixed, *steered]
    if rank == 0:
        twist = _three(steered, names)
    elif rank == 1:
        twist = _two(fixed[0], steered, with_axle, names)
    else:
        picked = [mobility.basis_rows[k] for k in range(2)]
        column = null_columns(picked)[0]
        turned = {g.name for p in column for g in p.generators if g.kind in ("cos", "sin")}
        if turned - {w.name for w in steered}:
            raise NotDerivableError(
                f"{robot.name} has no axles function: its coupled castors leave a motion that depends on their angle"
            )
        twist = _one(column, with_axle, names)
    return _formula(robot, twist, steered, len(with_axle), names)


def _derivable(robot: Robot, steered: list[Wheel], rank: int) -> None:
    places = {(float(w.nominal.x), float(w.nominal.y)) for w in steered}
    if rank == 3:
        raise NotDerivableError(
            f"{robot.name} has no axles function: its fixed wheels allow no motion at all"
        )
    if rank < 2 and len(places) + rank < 2:
        raise NotDerivableError(
            f"{robot.name} has no axles function: its axles do not determine an ICR; "
            "two axle lines do, of steered wheels or of a fixed and a steered one"
        )


def _mean(values: list[Poly]) -> Poly:
    return Poly.sum(values).scale(Fraction(1, len(values)))


def _reach(wheels: list[Wheel], x: Poly, y: Poly, names: Locals) -> Expr:
    """RMS distance of the wheels from (x, y) [m], above zero."""
    views = [working_view(w) for w in wheels]
    total = _mean([(g.x - x) ** 2 + (g.y - y) ** 2 for g in views])
    return names.define("spread", maximum(root(expression(total)), number(FLOOR)))


def _lateral(w: Wheel, x: Poly, y: Poly) -> tuple[Poly, Poly, Poly]:
    """(-s, c, k): lateral velocity of the pivot for a motion given at (x, y)."""
    g = working_view(w)
    c, s = heading(w, g)
    return -s, c, (g.x - x) * c + (g.y - y) * s


def _three(steered: list[Wheel], names: Locals) -> tuple[Expr, Expr, Expr]:
    """No fixed wheels: the smallest eigenvector, about the centroid of the steered wheels."""
    x, y = (_mean([getattr(working_view(w), k) for w in steered]) for k in "xy")
    spread = _reach(steered, x, y, names)
    rows = []
    for w in steered:
        a, b, k = (expression(p) for p in _lateral(w, x, y))
        rows.append(tuple(names.define(f"{w.name}_n{i}", v) for i, v in enumerate((a, b, over(k, spread)))))
    first = heading(steered[0], working_view(steered[0]))
    straight = (expression(first[0]), expression(first[1]), sympy.S.Zero)
    a, b, k = smallest_eigenvector(rows, straight, names)
    omega = names.define("omega_fit", over(k, spread))
    return _at_origin(a, b, omega, x, y, names)


def _two(fixed: Wheel, steered: list[Wheel], every: list[Wheel], names: Locals) -> tuple[Expr, Expr, Expr]:
    """One axle line: along the fixed wheels' rolling direction and about a point (x, y) of their axle.

    The point is the foot of the wheels' mean, so that the two motions do not mix.
    """
    g = working_view(fixed)
    ex, ey = g.ch, g.sh
    far = _mean([ex * (working_view(w).y - g.y) - ey * (working_view(w).x - g.x) for w in every])
    x, y = g.x - ey * far, g.y + ex * far
    spread = _reach(every, x, y, names)
    straight, turning = [], []
    for w in steered:
        a, b, k = _lateral(w, x, y)
        straight.append(names.define(f"{w.name}_straight", a * ex + b * ey))
        turning.append(names.define(f"{w.name}_turning", over(expression(k), spread)))
    s11 = names.define("s11", add(*(square(v) for v in straight)))
    s22 = names.define("s22", add(*(square(v) for v in turning)))
    s12 = names.define("s12", add(*(times(a, b) for a, b in zip(straight, turning, strict=True))))
    double = angle_of(times(-2, s12), add(s22, times(-1, s11)))
    half = names.define("share", times(sympy.S.Half, double))
    ahead = names.define("ahead", sympy.cos(half))
    omega = names.define("omega_fit", over(sympy.sin(half), spread))
    return _at_origin(times(expression(ex), ahead), times(expression(ey), ahead), omega, x, y, names)


def _one(column: Row, every: list[Wheel], names: Locals) -> tuple[Expr, Expr, Expr]:
    """Two axle lines of fixed wheels: the motion is known, scaled to unit RMS velocity of the wheels."""
    views = [working_view(w) for w in every]
    a, b, k = column
    size = _mean([(a - k * g.y) ** 2 + (b + k * g.x) ** 2 for g in views])
    scale = names.define("size", maximum(root(expression(size)), number(FLOOR)))
    vx, vy, omega = (
        names.define(f"{n}_axles", over(expression(p), scale))
        for n, p in zip(("vx", "vy", "omega"), column, strict=True)
    )
    return vx, vy, omega


def _at_origin(a: Expr, b: Expr, omega: Expr, x: Poly, y: Poly, names: Locals) -> tuple[Expr, Expr, Expr]:
    """The twist of P from the velocity (a, b) at (x, y), with omega >= 0."""
    sign = names.define("sign", select(omega, sympy.S.Zero, sympy.S.NegativeOne, sympy.S.One))
    vx = names.define("vx_axles", times(sign, add(a, times(omega, expression(y)))))
    vy = names.define("vy_axles", times(sign, add(b, times(-1, omega, expression(x)))))
    return vx, vy, names.define("omega_axles", times(sign, omega))


def _formula(
    robot: Robot, twist: tuple[Expr, Expr, Expr], steered: list[Wheel], count: int, names: Locals
) -> Formula:
    vx, vy, omega = twist
    facts = path(twist, names)
    xi: Row = (Poly.gen("local", "vx_axles"), Poly.gen("local", "vy_axles"), Poly.gen("local", "omega_axles"))
    errors: list[tuple[Port, Expr]] = []
    slides: list[Expr] = []
    text = "turn that the wheel needs so that its axle meets the ICR"
    for w in steered:
        g = working_view(w)
        c, s = heading(w, g)
        along = names.define(f"{w.name}_along", dot((c, s, g.x * s - g.y * c), xi))
        across = names.define(f"{w.name}_across", dot((-s, c, g.x * c + g.y * s), xi))
        slides.append(across)
        swing = angle_of(select(along, sympy.S.Zero, times(-1, across), across), absolute(along))
        errors.append((Port(f"{w.name}.error", Role.COMMAND, "rad", text), swing))
    lateral = (
        root(times(sympy.Rational(1, count), add(*(square(v) for v in slides)))) if slides else sympy.S.Zero
    )
    forward = select(vx, sympy.S.Zero, sympy.S.NegativeOne, sympy.S.One)
    outputs = (
        *zip(centre_ports(unit="", weight="1/m"), (times(-1, vy), vx, omega), strict=True),
        (Port("radius", Role.COMMAND, "m", "distance of P from the ICR, at most 1e9"), facts["radius"]),
        (Port("curvature", Role.COMMAND, "1/m", "of P driving forward, positive to the left, at most 1e9 in size"),
         times(forward, facts["curvature"])),
        (Port("mismatch", Role.COMMAND, "rad", "RMS lateral over RMS velocity of the wheels: 0 where all axles meet"),
         lateral),
        *errors,
    )  # fmt: skip
    inputs = (*(joint_port(w, "steer", Role.STATE) for w in steered), *tunable_ports(robot))
    text = "ICR that the axles point at, least squares; homogeneous, of unit RMS wheel velocity"
    return Formula("axles", inputs, tuple(names.items), outputs, text)
