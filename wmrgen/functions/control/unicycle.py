"""Robots that drive like a unicycle, and two control laws for them: `goto_pose` and `pursuit`.

The reference point takes (v, 0, omega). It is the centre of the fixed axle. `goto_pose` is the polar feedback law
(Siegwart 3.6.2): v = k_rho rho, omega = k_alpha alpha + k_beta beta (Siegwart (3.56), (3.57)). Driving backwards is
the same law for a robot that faces the opposite direction, v -> -v, which is (3.55) as corrected. When P is at the
goal with heading 0, the reference point is at its own place in the robot frame.

`pursuit` steers onto the circle that is tangent to the heading and meets a point ahead (Tzafestas (2.57)). With the
goal at distance L in direction epsilon and its lateral offset d = L sin epsilon, the curvature is 2 sin epsilon / L =
2 d / L^2. A wheel at distance D before the fixed axle steers by atan(2 D sin epsilon / L).
"""

from __future__ import annotations

import numpy as np
import sympy

from wmrgen.analysis.kinematics.inverse import inverse
from wmrgen.analysis.kinematics.records import Formula, Locals
from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.control.gains import TEXTBOOK, judge, nominal_gains, shown
from wmrgen.functions.models.axle import THROUGH_P, Axle, Vector, axle_of
from wmrgen.functions.registry import Reason, function, underivable
from wmrgen.geometry.constraints import nominal_view, rolling_row, working_view
from wmrgen.geometry.exact.evaluate import number as nominal_number
from wmrgen.geometry.exact.number import ZERO
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import POSE, TWIST_NAMES, Port, Role, output
from wmrgen.geometry.symbolic import (
    Expr,
    add,
    angle_of,
    expression,
    norm,
    number,
    rotated,
    rotated_back,
    select,
    signal,
    square,
    subtract,
    times,
)

_SMALL = 1e-9  # relative: rounding of a rank and of the distance to the set of admissible twists
AT_GOAL = sympy.Rational(1, 10**9)  # [m]: a nearer robot has arrived: at the goal bearings are undefined
BORDER = sympy.Rational(1, 10**6)  # [rad]: an angle nearer to the end of its range is treated as the end


def reference(robot: Robot, mobility: Mobility, name: str) -> Axle:
    """Return the centre of the fixed axle and its rolling direction; P and x if no wheel is fixed.

    A skid-steer robot slides as it turns; its reference is the centre of its fixed wheels.

    Args:
        robot: The robot.
        mobility: Its mobility.
        name: The function that needs to drive (v, 0, omega).

    Raises:
        NotDerivableError: If the robot cannot drive (v, 0, omega).
    """
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    ref = axle_of(fixed, working_view) if fixed else THROUGH_P
    if drives(robot, mobility, ref) or _skids(robot, mobility, fixed):
        return ref
    why, reason = "the axles of its wheels do not allow both driving straight and turning", Reason.AXLES
    if not mobility.degenerate and not fixed:
        why, reason = "its coupled wheels prevent it from turning", Reason.COUPLINGS
    raise underivable(robot, name, f"it needs a robot that can drive (v, 0, omega), but {why}", reason)


def drives(robot: Robot, mobility: Mobility, ref: Axle) -> bool:
    """Return whether both unit motions of Q are in the (linear) set of admissible twists.

    Args:
        robot: The robot.
        mobility: Its mobility.
        ref: The axle with its centre Q.
    """
    admissible = mobility.admissible
    if not admissible.linear or not len(admissible.basis):
        return False
    nominal = {p.name: Poly.of(p.nominal) for p in robot.parameters}
    x, y, c, s = (float(nominal_number(p, nominal)) for p in (ref.x, ref.y, ref.ex, ref.ey))
    wanted = np.array([[c, s, 0.0], [y, -x, 1.0]])
    basis = np.linalg.qr(np.asarray(admissible.basis, float).T)[0]
    return bool(np.abs(wanted.T - basis @ (basis.T @ wanted.T)).max() < _SMALL * max(1.0, abs(x), abs(y)))


def _skids(robot: Robot, mobility: Mobility, fixed: list[Wheel]) -> bool:
    """Return whether the robot has parallel fixed wheels on several axles whose drives set speed and yaw rate."""
    if not mobility.degenerate or len(fixed) < len(robot.wheels):
        return False
    lead = fixed[0].nominal
    parallel = all(not (lead.ch * w.nominal.sh - lead.sh * w.nominal.ch) for w in fixed)
    rows = [rolling_row(w, nominal_view(w)).row for w in fixed if "spin" in w.actuated]
    values = np.array([[float(p.constant or ZERO) for p in row] for row in rows])
    return parallel and int(np.linalg.matrix_rank(values, _SMALL)) >= 2


def commands(
    robot: Robot, mobility: Mobility, ref: Axle, v: Expr, omega: Expr, names: Locals
) -> tuple[tuple[Port, ...], list[tuple[Port, Expr]]]:
    """Return the commands of `inverse` for (v, 0, omega) at Q.

    Args:
        robot: The robot.
        mobility: Its mobility.
        ref: The axle with its centre Q.
        v: The speed of Q along the axle's direction of travel [m/s].
        omega: The yaw rate [rad/s].
        names: Takes the intermediate results.

    Returns:
        The inputs of `inverse` other than the twist, and its outputs with their values.
    """
    f = inverse(robot, mobility)
    twist = dict(zip(TWIST_NAMES, (*ref.velocity_of_p(v, omega), omega), strict=True))
    values = names.adopt(f, {name: names.define(f"{name}_driving", value) for name, value in twist.items()})
    outputs = [(port, values[port.name]) for port, _ in f.outputs]
    return tuple(p for p in f.inputs if p.name not in twist), outputs


_GOTO_OUTPUTS = (
    output("v", "m/s", "speed forward of the axle centre"),
    output("omega", "rad/s", "yaw rate, counter-clockwise"),
    output("rho", "m", "distance to the goal"),
    output("alpha", "rad", "direction of the goal from the direction of driving"),
    output("beta", "rad", "-theta - alpha"),
    output("direction", "", "+1 forward, -1 backwards: use it as the next input"),
)
_GOTO_INPUTS = (
    Port("x", Role.STATE, "m", "position of P, goal frame"),
    Port("y", Role.STATE, "m", "position of P, goal frame"),
    Port("theta", Role.STATE, "rad", "heading, goal frame"),
    Port(
        "direction",
        Role.STATE,
        "",
        "+1 forward, -1 backwards, 0: forward if the goal is ahead, else backwards",
    ),
)


@function("Siegwart (3.50)-(3.58), (3.55) corrected")
def goto_pose(robot: Robot, mobility: Mobility) -> Formula:
    """Return joint commands from the pose relative to the goal, the direction of driving and the present steering."""
    _require_stable(robot)
    ref = reference(robot, mobility, "goto_pose")
    names = Locals()
    rho, alpha, beta, way = _polar(ref, names)
    k_rho, k_alpha, k_beta = (_gain(robot, name) for name in TEXTBOOK)
    v = names.define("v_value", select(AT_GOAL, rho, times(way, k_rho, rho), sympy.S.Zero))
    omega = names.define("omega_value", add(times(k_alpha, alpha), times(k_beta, beta)))
    more, outputs = commands(robot, mobility, ref, v, omega, names)
    results = zip(_GOTO_OUTPUTS, (v, omega, rho, alpha, beta, way), strict=True)
    return names.formula(
        "goto_pose",
        (*_GOTO_INPUTS, *more),
        (*outputs, *results),
        "pose relative to the goal to joint commands, polar feedback law (Siegwart (3.56)-(3.58))",
    )


def _require_stable(robot: Robot) -> None:
    """Raise NotDerivableError if the gains of the robot file do not stabilise the law."""
    gains = nominal_gains(robot)
    verdict = judge(**gains)
    if not verdict.stable:
        raise underivable(
            robot,
            "goto_pose",
            f"gains {shown(gains)} do not stabilise it. Violated: "
            f"{', '.join(verdict.violated)} (Siegwart (3.61)-(3.64)). Change `gains`, or delete it to use "
            f"{shown(TEXTBOOK)}.",
            Reason.UNSTABLE_GAINS,
        )


def _gain(robot: Robot, name: str) -> Expr:
    """Return a gain of the robot file, or of the textbook if the file has none."""
    return expression(robot.gains[name].working) if name in robot.gains else number(TEXTBOOK[name])


def _polar(ref: Axle, names: Locals) -> tuple[Expr, Expr, Expr, Expr]:
    """Return rho, alpha, beta (Siegwart (3.50)-(3.52)) and the direction of driving.

    Bearings are computed from the goal in the robot frame, so no angle needs wrapping. A bearing of -pi becomes pi.
    """
    x, y, theta = (signal(p.name) for p in POSE)
    c, s = names.define("theta_cos", sympy.cos(theta)), names.define("theta_sin", sympy.sin(theta))
    if ref.x or ref.y:
        qx, qy = ref.centre
        dx, dy = rotated(c, s, qx, qy)
        x, y = add(x, dx, times(-1, qx)), add(y, dy, times(-1, qy))
    px, py = _along_axle(ref, (x, y), names, "axle")
    ahead = names.define("goal_ahead", times(-1, add(times(c, px), times(s, py))))
    left = names.define("goal_left", subtract(times(s, px), times(c, py)))
    rho = names.define("rho_value", norm(px, py))
    way = names.define("direction_value", _direction(ahead, rho))
    raw = (names.define("alpha_raw", angle_of(times(way, left), times(way, ahead))),
           names.define("beta_raw", angle_of(times(way, py), times(-1, way, px))))  # fmt: skip
    alpha, beta = (
        names.define(name, select(AT_GOAL, rho, _half_open(angle), sympy.S.Zero))
        for name, angle in zip(("alpha_value", "beta_value"), raw, strict=True)
    )
    return rho, alpha, beta, way


def _along_axle(ref: Axle, vector: Vector, names: Locals, prefix: str) -> Vector:
    """Return the components of a vector of the robot frame along and across the direction of Q."""
    along, across = rotated_back(*ref.direction, *vector)
    return names.define(f"{prefix}_ahead", along), names.define(f"{prefix}_left", across)


def _half_open(angle: Expr) -> Expr:
    """Return pi for -pi: rounding and the sign of zero must not choose the side."""
    return select(angle, add(times(-1, sympy.pi), BORDER), sympy.pi, angle)


def _direction(ahead: Expr, rho: Expr) -> Expr:
    """Return the commanded direction; for 0 forward if |alpha| <= pi/2, the set I1 (Siegwart (3.54))."""
    wanted, zero, one = signal("direction"), sympy.S.Zero, sympy.S.One
    bearing = select(ahead, times(-1, BORDER, rho), sympy.S.NegativeOne, one)
    return select(zero, wanted, one, select(wanted, zero, sympy.S.NegativeOne, bearing))


_PURSUIT_INPUTS = (
    Port("goal_x", Role.COMMAND, "m", "point to meet, robot frame"),
    Port("goal_y", Role.COMMAND, "m", "point to meet, robot frame"),
    Port("v", Role.COMMAND, "m/s", "speed forward of the axle centre; negative drives the same circle backwards"),
)  # fmt: skip


@function("Tzafestas (2.57)")
def pursuit(robot: Robot, mobility: Mobility) -> Formula:
    """Return joint commands for a look-ahead point and a speed; straight on if the point is reached."""
    ref = reference(robot, mobility, "pursuit")
    names = Locals()
    dx, dy = (subtract(signal(n), expression(p)) for n, p in (("goal_x", ref.x), ("goal_y", ref.y)))
    gx, gy = _along_axle(ref, (dx, dy), names, "goal")
    square_l = names.define("distance_squared", add(square(gx), square(gy)))
    far = times(AT_GOAL, AT_GOAL)
    divisor = names.define("divisor", select(far, square_l, square_l, sympy.S.One))
    bend = names.define("curvature_value", select(far, square_l, times(2, gy, 1 / divisor), sympy.S.Zero))
    omega = names.define("omega_value", times(signal("v"), bend))
    more, outputs = commands(robot, mobility, ref, signal("v"), omega, names)
    outputs += [
        (output("omega", "rad/s", "yaw rate, counter-clockwise"), omega),
        (
            output("curvature", "1/m", "curvature of the circle of the axle centre, positive to the left"),
            bend,
        ),
    ]
    base = wheelbase(robot, ref)
    if base is not None:
        port = output("psi", "rad", "steering angle of a wheel on the centre line, from straight ahead")
        outputs.append((port, angle_of(times(2, expression(base), gy), square_l)))
    return names.formula(
        "pursuit",
        (*_PURSUIT_INPUTS, *more),
        outputs,
        "look-ahead point and speed to joint commands, pursuit (Tzafestas (2.57))",
    )


def wheelbase(robot: Robot, ref: Axle) -> Poly | None:
    """Return D [m], from the fixed axle to the steered wheels along the heading; None unless all wheels share it."""
    if not any(w.kind.fixed_axle for w in robot.wheels):
        return None
    bases = {ref.seen(working_view(w))[0] for w in robot.wheels if w.kind.steers}
    return bases.pop() if len(bases) == 1 else None
