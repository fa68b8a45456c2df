"""The ICR at which the wheel axles point for given steering angles: least squares, with the mismatch.

Among the motions that the fixed wheels allow, this is the motion that slides least for its speed: the sum of the
squared lateral velocities of the steered wheels is smallest for a given sum of squared velocities of all wheels with
an axle. It does not depend on the frame or the unit of length, and a centre at infinity (crab steering) is an ordinary
case. With one axle line of fixed wheels it is the smaller principal axis of a 2 x 2 matrix. Without fixed wheels it is
the smallest eigenvector of a 3 x 3 matrix G, in closed form and defined for every input.

The smallest eigenvalue of G is q + 2 p cos(phi + 2 pi / 3) with q = tr G / 3, p**2 = tr (G - q I)**2 / 6 and cos 3 phi
= det(G - q I) / 2 p**3. The cosine loses half the digits if two eigenvalues are equal; Newton steps on the
characteristic polynomial restore them. The adjugate of G - lambda I is then a multiple of v v^T for the eigenvector v,
so its largest column is the eigenvector.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy

from wmrgen.analysis.kinematics.records import Formula, Locals, joint_port, tunable_ports
from wmrgen.analysis.mobility.basis import null_columns
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.polynomials import angles_in
from wmrgen.functions.motion.icr import centre_ports
from wmrgen.functions.motion.paths import path, sign
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import along, heading, working_view
from wmrgen.geometry.exact.linalg import adjugate, mean, symmetric
from wmrgen.geometry.exact.poly import Poly, Row, dot, triple
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import Port, Role, output
from wmrgen.geometry.symbolic import (
    Expr,
    absolute,
    add,
    angle_of,
    clamp_between,
    expression,
    maximum,
    norm,
    over,
    root,
    select,
    square,
    subtract,
    times,
)

NEAR = sympy.Rational(1, 10**9)  # [m] wheels nearer to each other are treated as at one point
FLOOR = sympy.Rational(1, 10**12)  # a slope or a squared eigenvector below is only rounding error
Twist = tuple[Expr, Expr, Expr]


@function("Kelly 4.2.1.2 (Jeantaud); Siegwart 3.3.1; Tzafestas (2.48)")
def axles(robot: Robot, mobility: Mobility) -> Formula:
    """Return the ICR of the axles, its curvature, the mismatch and each wheel's error for given steering angles."""
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    steered = [w for w in robot.wheels if w.kind.steers]
    rank = mobility.rank_C1f.value
    _require_icr(robot, steered, rank)
    names = Locals()
    with_axle = [*fixed, *steered]
    if rank == 0:
        twist = _without_axle_line(steered, names)
    elif rank == 1:
        twist = _with_one_axle_line(fixed[0], steered, with_axle, names)
    else:
        column = null_columns([mobility.basis_rows[k] for k in range(2)])[0]
        turned = angles_in(column)
        if turned - {w.name for w in steered}:
            raise underivable(
                robot,
                "axles function",
                "its coupled castors allow a motion that depends on their angle",
                Reason.CASTOR,
            )
        twist = _with_two_axle_lines(column, with_axle, names)
    return _formula(robot, twist, steered, len(with_axle), names)


def _require_icr(robot: Robot, steered: list[Wheel], rank: int) -> None:
    """Raise NotDerivableError if the axles do not determine an ICR."""
    places = {w.pivot for w in steered}
    if rank == 3:
        raise underivable(robot, "axles function", "its fixed wheels allow no motion at all", Reason.MOBILITY)
    if rank < 2 and len(places) + rank < 2:
        raise underivable(
            robot,
            "axles function",
            "its axles do not determine an ICR; it needs two axle lines, at least one of them steered",
            Reason.AXLES,
        )


def _reach(wheels: list[Wheel], x: Poly, y: Poly, names: Locals) -> Expr:
    """Return the RMS distance of the wheels from (x, y) [m], above zero."""
    views = [working_view(w) for w in wheels]
    total = mean([(g.x - x) ** 2 + (g.y - y) ** 2 for g in views])
    return names.define("spread", maximum(root(expression(total)), NEAR))


def _lateral(w: Wheel, x: Poly, y: Poly) -> Row:
    """Return (-s, c, k): the lateral velocity of the pivot for a motion given at (x, y)."""
    g = working_view(w)
    c, s = heading(w, g)
    return -s, c, (g.x - x) * c + (g.y - y) * s


def _without_axle_line(steered: list[Wheel], names: Locals) -> Row:
    """Return the twist without fixed wheels: the smallest eigenvector, about the centroid of the steered wheels."""
    x, y = mean([working_view(w).x for w in steered]), mean([working_view(w).y for w in steered])
    spread = _reach(steered, x, y, names)
    rows = []
    for w in steered:
        a, b, k = (expression(p) for p in _lateral(w, x, y))
        rows.append([names.poly(f"{w.name}_n{i}", v) for i, v in enumerate((a, b, over(k, spread)))])
    c, s = heading(steered[0], working_view(steered[0]))
    a, b, k = smallest_eigenvector(rows, (expression(c), expression(s), sympy.S.Zero), names)
    omega = names.define("omega_fit", over(k, spread))
    return _at_origin(a, b, omega, x, y, names)


def _with_one_axle_line(fixed: Wheel, steered: list[Wheel], with_axle: list[Wheel], names: Locals) -> Row:
    """Return the twist for one axle line: a mix of driving along the fixed wheels and turning about a point (x, y).

    The point is on their axle, at the foot of the wheels' mean, so that the two motions are independent.
    """
    g = working_view(fixed)
    ex, ey = g.ch, g.sh
    far = mean([ex * (working_view(w).y - g.y) - ey * (working_view(w).x - g.x) for w in with_axle])
    x, y = g.x - ey * far, g.y + ex * far
    spread = _reach(with_axle, x, y, names)
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


def _with_two_axle_lines(column: Row, with_axle: list[Wheel], names: Locals) -> Row:
    """Return the twist for two axle lines of fixed wheels: the only motion, scaled to unit RMS wheel velocity."""
    views = [working_view(w) for w in with_axle]
    a, b, k = column
    size = mean([(a - k * g.y) ** 2 + (b + k * g.x) ** 2 for g in views])
    scale = names.define("size", maximum(root(expression(size)), NEAR))
    vx, vy, omega = (over(expression(p), scale) for p in column)
    return names.poly("vx_axles", vx), names.poly("vy_axles", vy), names.poly("omega_axles", omega)


def _at_origin(a: Expr, b: Expr, omega: Expr, x: Poly, y: Poly, names: Locals) -> Row:
    """Return the twist of P for the velocity (a, b) at (x, y), with omega >= 0."""
    way = names.define("sign", sign(omega))
    vx = names.poly("vx_axles", times(way, add(a, times(omega, expression(y)))))
    vy = names.poly("vy_axles", times(way, add(b, times(-1, omega, expression(x)))))
    return vx, vy, names.poly("omega_axles", times(way, omega))


def _formula(robot: Robot, twist: Row, steered: list[Wheel], count: int, names: Locals) -> Formula:
    """Return the function for the twist of the axles."""
    vx, vy, omega = (expression(p) for p in twist)
    facts = path((vx, vy, omega), names)
    errors: list[tuple[Port, Expr]] = []
    slides: list[Expr] = []
    text = "rotation of the wheel after which its axle meets the ICR"
    for w in steered:
        g = working_view(w)
        c, s = heading(w, g)
        ahead = names.define(f"{w.name}_along", dot(along((c, s), g), twist))
        across = names.define(f"{w.name}_across", dot(along((-s, c), g), twist))
        slides.append(across)
        swing = angle_of(select(ahead, sympy.S.Zero, times(-1, across), across), absolute(ahead))
        errors.append((output(f"{w.name}.error", "rad", text), swing))
    mismatch = (
        root(times(sympy.Rational(1, count), add(*(square(v) for v in slides)))) if slides else sympy.S.Zero
    )
    outputs = (
        *zip(centre_ports(unit="", weight="1/m"), (times(-1, vy), vx, omega), strict=True),
        (output("radius", "m", "distance of P from the ICR, at most 1e9"), facts["radius"]),
        (output("curvature", "1/m", "of P driving forward, positive to the left, at most 1e9 in size"),
         times(sign(vx), facts["curvature"])),
        (output("mismatch", "rad", "RMS lateral over RMS velocity of the wheels: 0 if all axles meet"), mismatch),
        *errors,
    )  # fmt: skip
    inputs = (*(joint_port(w, "steer", Role.STATE) for w in steered), *tunable_ports(robot))
    text = "ICR at which the axles point, least squares; homogeneous, for unit RMS wheel velocity"
    return names.formula("axles", inputs, outputs, text)


def smallest_eigenvector(rows: Sequence[Sequence[Poly]], fallback: Twist, names: Locals) -> Twist:
    """Return the unit vector v with the smallest sum of (row . v)**2.

    Args:
        rows: Three components each.
        fallback: The result if all rows are parallel.
        names: Takes the intermediate results.
    """
    share = sympy.Rational(1, len(rows))

    def mean_product(i: int, j: int) -> Poly:
        total = expression(Poly.sum(r[i] * r[j] for r in rows))
        return names.poly(f"g{i}{j}", times(share, total))

    gram = symmetric(mean_product)
    eigenvalue = _smallest_eigenvalue(gram, names)
    for i in range(3):
        gram[i][i] = names.poly(f"m{i}{i}", subtract(expression(gram[i][i]), eigenvalue))
    square_of = adjugate(gram)
    column = _largest_column(symmetric(lambda i, j: names.poly(f"k{i}{j}", square_of[i][j])), names)
    size = names.define("vector_size", norm(*column))
    kept = names.define("vector_kept", maximum(size, FLOOR))
    return triple(
        names.define(f"vector{i}", select(FLOOR, size, over(v, kept), f))
        for i, (v, f) in enumerate(zip(column, fallback, strict=True))
    )


def _smallest_eigenvalue(gram: list[list[Poly]], names: Locals) -> Expr:
    """Return the smallest eigenvalue, between 0 and a third of the trace."""
    minors = adjugate(gram)
    adj = symmetric(lambda i, j: names.poly(f"adj{i}{j}", minors[i][j]))
    trace = names.define("trace", gram[0][0] + gram[1][1] + gram[2][2])
    second = names.define("second", adj[0][0] + adj[1][1] + adj[2][2])
    third = names.define("third", dot(gram[0], adj[0]))
    mean = names.define("mean", times(sympy.Rational(1, 3), trace))
    value = clamp_between(sympy.S.Zero, _cosine_root(trace, second, third, mean, names), mean)
    value = names.define("eigenvalue0", value)
    for k in range(2):  # Newton steps: each doubles the number of correct digits
        rest = add(third, times(value, subtract(times(value, subtract(trace, value)), second)))
        slope = add(second, times(value, subtract(times(3, value), times(2, trace))))
        step = over(rest, maximum(slope, FLOOR))
        value = names.define(f"eigenvalue{k + 1}", clamp_between(sympy.S.Zero, add(value, step), mean))
    return value


def _cosine_root(trace: Expr, second: Expr, third: Expr, mean: Expr, names: Locals) -> Expr:
    """Return q + 2 p cos(phi + 2 pi / 3) from the invariants.

    With x = lambda - q: p**2 = (tr**2 - 3 second) / 9 and det(G - q I) = third - q second + 2 q**3.
    """
    zero, one = sympy.S.Zero, sympy.S.One
    spread = times(sympy.Rational(1, 9), subtract(square(trace), times(3, second)))
    p = names.define("half_range", root(maximum(spread, zero)))
    cube = maximum(times(2, p, p, p), FLOOR)
    shifted = add(third, times(mean, subtract(times(2, mean, mean), second)))
    ratio = names.define("ratio", clamp_between(sympy.S.NegativeOne, over(shifted, cube), one))
    height = root(maximum(subtract(one, square(ratio)), zero))
    angle = add(times(sympy.Rational(1, 3), angle_of(height, ratio)), times(sympy.Rational(2, 3), sympy.pi))
    return add(mean, times(2, p, sympy.cos(names.define("angle", angle))))


def _largest_column(k: list[list[Poly]], names: Locals) -> list[Expr]:
    """Return the column of a positive semidefinite matrix with the largest diagonal entry."""
    one, two, three = (expression(k[i][i]) for i in range(3))
    best = names.define("k_best", maximum(one, two))
    column = []
    for i, row in enumerate(k):
        a, b, c = (expression(p) for p in row)
        value = select(best, three, c, select(one, two, b, a))
        column.append(names.define(f"column{i}", value))
    return column
