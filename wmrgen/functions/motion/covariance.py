"""Covariance of the twist and of the pose, to first order: `forward_covariance` and `odometry_covariance`.

`forward` minimises weighted residuals e = H xi - z, with N = H^T W H. An error dq of a measured joint changes a row by
a dq, a = d(H xi - z)/dq, and so the twist by N^-1 H^T W a dq. The noise of joints is independent, with the variance
(proportional q)**2 + constant**2 of the robot file. Let C be the covariance of the rows, block by block of the two
rows of a wheel. Then

    cov xi = N^-1 M N^-1 + excess N^-1        M = H^T W C W H
    excess = max(0, slip**2 - expected) / (rows - 3)        expected = tr(W C) - tr(N^-1 M)

``slip`` is the residual of `forward`, and ``expected`` is the mean of its square if there is only noise. A larger
residual comes from slipping wheels or a broken encoder. It is attributed to all rows alike, according to their weights
(method of moments; DerSimonian, Laird 1986). A residual within the noise adds nothing, and without redundant rows no
slip can be observed. The covariance is positive semidefinite: it is a sum of squares with positive weights.

Over a step the errors of the pose are propagated by the derivatives of the SE(2) exponential. With d the step's
displacement, R the rotation by theta + h, h = omega dt / 2, and z x the quarter turn counter-clockwise,

    position' = position + (z x d) (heading + dt/2 yaw rate) + dt sinc(h) R velocity
    heading'  = heading + dt yaw rate

The effect of the yaw rate omits the term -dt/2 (1/h - 1/tan h) d, about h/3 of it. Errors of different steps are
independent.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.forward import forward, nominal_rank
from wmrgen.analysis.kinematics.least_squares import Matrix, named_normal, normal_equations, pseudo_inverse
from wmrgen.analysis.kinematics.pose import increments, wrapped
from wmrgen.analysis.kinematics.records import Formula, Locals, signal_poly, slip_port, tunable_ports
from wmrgen.analysis.kinematics.sensing import (
    EDGE,
    FLOOR,
    Component,
    Contact,
    Measurements,
    YawRate,
    adjugate,
    generic_rank,
    measurements,
    reach_of,
    sensed_joints,
    sensed_ports,
)
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.polynomials import by_angle
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import XI
from wmrgen.geometry.exact.linalg import symmetric
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Gen, Poly, Row, derivative, dot
from wmrgen.geometry.layout.records import Noise, Robot, Wheel
from wmrgen.geometry.ports import DT, GYRO, POSE, POSE_COVARIANCE, TWIST, TWIST_COVARIANCE, Limits, Port
from wmrgen.geometry.symbolic import (
    Expr,
    add,
    expression,
    local,
    maximum,
    number,
    rotated,
    signal,
    square,
    subtract,
    times,
)

_PAIRS = tuple((i, j) for i in range(3) for j in range(i, 3))


class _Block(NamedTuple):
    """The rows of a wheel, one or two."""

    rows: list[Row]
    weight: Exact  # of both rows in the least squares
    noise: Matrix  # covariance of the rows' errors [(m/s)**2]


@function(
    "ours, after Tzafestas (2.8a): propagation of first order; DerSimonian, Laird",
    limits=Limits.MEASURED,
    reads=("noise",),
)
def forward_covariance(robot: Robot, _: Mobility) -> Formula:
    """Return the covariance of the twist of `forward` for sensed joints, the twist and its slip."""
    joints = (robot.noise_of(w, j) for w in robot.wheels for j in sensed_joints(w))
    if not any(joints) and (robot.gyro is None or not any(robot.gyro.noise)):
        raise underivable(
            robot,
            "forward_covariance",
            "no sensed joint has noise; write noise: {spin: {proportional: 0.02, constant: 0.01 rad/s}}",
            Reason.NO_NOISE,
        )
    names, measured = Locals(), measurements(robot)
    constant = measured.constant_normal
    rank = nominal_rank(measured.rows, robot).value if constant else generic_rank(measured)
    if rank < 3:
        raise underivable(
            robot,
            "forward_covariance",
            "its sensed joints do not determine every component of the twist",
            Reason.UNOBSERVABLE,
        )
    blocks = [_block(m, robot, names) for m in measured.all]
    inverse = (_constant_inverse if constant else _moving_inverse)(measured, names)
    matrix = _propagated(blocks, inverse, names)
    residual = {port.name: value for port, value in forward(robot).outputs}["slip"]
    slips = len(measured.rows) > 3 and residual is not sympy.S.Zero
    outputs = [expression(matrix[i][j]) for i, j in _PAIRS]
    if slips:
        excess = _excess(blocks, inverse, len(measured.rows), names)
        outputs = [
            add(value, times(excess, expression(inverse[i][j])))
            for value, (i, j) in zip(outputs, _PAIRS, strict=True)
        ]
    inputs = _inputs(robot, names, slips)
    text = "sensed joints and the slip of forward to the covariance of the twist"
    return names.formula("forward_covariance", inputs, zip(TWIST_COVARIANCE, outputs, strict=True), text)


def _inputs(robot: Robot, names: Locals, slips: bool) -> list[Port]:
    """Return sensed joints, the components of the twist that errors depend on, slip, and tunable parameters."""
    used = {symbol for _, value in names.items for symbol in value.free_symbols}
    twist = [port for port in TWIST if signal(port.name) in used]
    slip = [slip_port("residual of forward")] if slips else []
    return [*sensed_ports(robot), *twist, *slip, *tunable_ports(robot)]


def _block(measured: Contact | Component | YawRate, robot: Robot, names: Locals) -> _Block:
    """Return the rows of a wheel or of the gyro with the covariance of their errors."""
    rows = measured.rows
    if isinstance(measured, YawRate):
        assert robot.gyro is not None
        variance = _variance(GYRO.name, robot.gyro.noise, names)
        return _Block([row for row, _, _ in rows], measured.weight, [[names.short("gyro_c00", variance)]])
    w = measured.wheel
    errors = [dot(row, XI) - value for row, value, _ in rows]
    size = range(len(rows))
    noise = [[Poly({}) for _ in size] for _ in size]
    for joint in sensed_joints(w):
        deviation = robot.noise_of(w, joint)
        moved = [_by_joint(e, w, joint) for e in errors]
        if deviation is None or not any(moved):
            continue
        variance = _variance(f"{w.name}.{joint}", deviation, names)
        for i in size:
            for j in size:
                noise[i][j] = noise[i][j] + moved[i] * moved[j] * variance
    named = symmetric(lambda i, j: names.short(f"{w.name}_c{i}{j}", noise[i][j]), len(rows))
    return _Block([row for row, _, _ in rows], measured.weight, named)


def _by_joint(value: Poly, w: Wheel, joint: str) -> Poly:
    """Return the derivative by a measured joint."""
    if joint == "steer":
        return by_angle(value, Gen("cos", w.name), Gen("sin", w.name))
    port = Gen("input", f"{w.name}.{joint}")
    return derivative(value, lambda g: Poly.of(1) if g == port else Poly({}))


def _variance(port: str, noise: Noise, names: Locals) -> Poly:
    """Return (proportional q)**2 + constant**2."""
    value = signal_poly(port)
    share, least = noise.proportional * noise.proportional, noise.constant * noise.constant
    return names.short(f"{port}_variance", (value * value).scale(share) + least)


def _constant_inverse(measured: Measurements, names: Locals) -> Matrix:
    """Return N^-1 if no joint changes it; entries that depend on tunable parameters get names."""
    normal, _ = normal_equations(measured.rows)
    inverse = pseudo_inverse(named_normal(normal, names.short), None)
    return symmetric(lambda i, j: names.short(f"inverse{i}{j}", inverse[i][j]))


def _moving_inverse(measured: Measurements, names: Locals) -> Matrix:
    """Return N^-1 by cofactors, with the determinant bounded where `forward` uses a smaller rank."""
    normal, _ = normal_equations(measured.rows)
    n = named_normal(normal, names.poly)
    adj, det = adjugate(n, names)
    s = reach_of(measured.wheels)
    size1 = names.define("size1", n[0][0] + n[1][1] + n[2][2].scale(s.inverse()))
    size2 = names.define("size2", (adj[0][0] + adj[1][1]).scale(s.inverse()) + adj[2][2])
    edge = maximum(times(number(EDGE * s), size1, size2), number(FLOOR))
    over = names.poly("over_det", 1 / maximum(det, edge))
    return symmetric(lambda i, j: names.poly(f"inverse{i}{j}", adj[i][j] * over))


def _propagated(blocks: Sequence[_Block], inverse: Matrix, names: Locals) -> Matrix:
    """Return N^-1 H^T W C W H N^-1: a sum over blocks of gains times their noise."""
    total = {pair: Poly({}) for pair in _PAIRS}
    for k, block in enumerate(blocks):
        gains: list[list[Poly]] = [[], [], []]
        for i in range(3):
            for a, row in enumerate(block.rows):
                gain = dot(inverse[i], row).scale(block.weight)
                gains[i].append(names.short(f"gain{k}{i}{a}", gain))
        size = range(len(block.rows))
        for i, j in _PAIRS:
            terms = [gains[i][a] * gains[j][b] * block.noise[a][b] for a in size for b in size]
            total[i, j] = total[i, j] + Poly.sum(terms)
    return symmetric(lambda i, j: total[i, j])


def _excess(blocks: Sequence[_Block], inverse: Matrix, rows: int, names: Locals) -> Expr:
    """Return by how much slip**2 exceeds its mean under noise, per redundant row."""
    expected = Poly({})
    for block in blocks:
        for a, row in enumerate(block.rows):
            expected = expected + block.noise[a][a].scale(block.weight)
            for b, other in enumerate(block.rows):
                lever = Poly.sum(row[i] * inverse[i][j] * other[j] for i in range(3) for j in range(3))
                expected = expected - (lever * block.noise[a][b]).scale(block.weight * block.weight)
    beyond = subtract(square(signal("slip")), names.define("expected", expected))
    share = sympy.Rational(1, rows - 3)
    return names.define("excess", times(share, maximum(beyond, sympy.S.Zero)))


@function("Konstantinov, case of constant speeds; propagation of first order is ours", limits=Limits.MEASURED)
def odometry_covariance(_: Robot, __: Mobility) -> Formula:
    """Return the pose and its covariance after a step at a twist with the given covariance."""
    names = Locals()
    steps = increments(names)
    x, y, theta = (add(signal(p.name), e) for p, e in zip(POSE, steps, strict=True))
    pose = zip(POSE, (x, y, wrapped(names.define("theta_whole", theta))), strict=True)
    dx, dy = names.define("x_step", steps[0]), names.define("y_step", steps[1])
    before = {p.name: signal(p.name) for p in (*POSE_COVARIANCE, *TWIST_COVARIANCE)}
    (xx, xy, yy), by_rate = _of_velocity(before, names)
    half = names.define("half_dt", signal("dt") / 2)
    # Covariance of half the heading change and the yaw rate.
    swing = names.define("swing", times(half, before["omegaomega"]))
    heading = names.define("heading_variance", add(before["thetatheta"], times(half, swing)))
    lever = (times(-1, dy), dx)
    with_heading, turned, rates = [], [], []
    for axis, arm, rate in zip("xy", lever, by_rate, strict=True):
        with_heading.append(names.define(f"{axis}_heading", add(before[f"{axis}theta"], times(half, rate))))
        turned.append(names.define(f"{axis}_turned", add(with_heading[-1], times(arm, heading))))
        rates.append(add(turned[-1], times(half, add(rate, times(arm, swing)))))
    after = (
        add(before["xx"], times(lever[0], add(with_heading[0], turned[0])), xx),
        add(before["xy"], times(lever[0], with_heading[1]), times(lever[1], turned[0]), xy),
        rates[0],
        add(before["yy"], times(lever[1], add(with_heading[1], turned[1])), yy),
        rates[1],
        add(before["thetatheta"], times(4, half, swing)),
    )
    inputs = (*POSE, *POSE_COVARIANCE, *TWIST, *TWIST_COVARIANCE, DT)
    outputs = (*pose, *zip(POSE_COVARIANCE, after, strict=True))
    text = "pose and its covariance after driving a constant twist, known with a covariance, for dt"
    return names.formula("odometry_covariance", inputs, outputs, text)


def _of_velocity(
    covariances: Mapping[str, Expr], names: Locals
) -> tuple[tuple[Expr, Expr, Expr], tuple[Expr, Expr]]:
    """Return what errors of the velocity add to xx, xy and yy, and their covariances with the yaw rate."""
    chord, middle = local("chord"), local("middle")
    c = names.define("chord_x", chord * sympy.cos(middle))
    s = names.define("chord_y", chord * sympy.sin(middle))

    def driven(name: str, a: Expr, b: Expr) -> tuple[Expr, Expr]:
        x, y = (names.define(f"{name}_{k}", e) for k, e in zip("xy", rotated(c, s, a, b), strict=True))
        return x, y

    by_rate = driven("by_omega", covariances["vxomega"], covariances["vyomega"])
    px, py = driven("by_vx", covariances["vxvx"], covariances["vxvy"])
    qx, qy = driven("by_vy", covariances["vxvy"], covariances["vyvy"])
    xx = subtract(times(c, px), times(s, qx))
    xy = add(times(s, px), times(c, qx))
    yy = add(times(s, py), times(c, qy))
    return (xx, xy, yy), by_rate
