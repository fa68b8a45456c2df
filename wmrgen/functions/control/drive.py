"""Driving a robot like a unicycle: which point and direction take (v, 0, omega), and the wheel commands of that."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from wmrgen.constraints import nominal_view, rolling_row, working_view
from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly
from wmrgen.kinematics.inverse import inverse
from wmrgen.kinematics.records import Locals
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.records import Array, Mobility
from wmrgen.ports import Port
from wmrgen.symbolic import Expr, add, expression, signal, subtract, times

_SMALL = 1e-9


@dataclass(frozen=True, slots=True)
class Reference:
    """The point Q = (x, y) that drives (v, 0, omega) along the unit vector (c, s), robot frame."""

    x: Poly
    y: Poly
    c: Poly
    s: Poly

    def seen(self, x: Expr, y: Expr, names: Locals, prefix: str) -> tuple[Expr, Expr]:
        """A point of the robot frame seen from Q along its direction."""
        dx, dy = subtract(x, expression(self.x)), subtract(y, expression(self.y))
        return self.turned(dx, dy, names, prefix)

    def turned(self, dx: Expr, dy: Expr, names: Locals, prefix: str) -> tuple[Expr, Expr]:
        """A vector of the robot frame in components along and across the direction of Q."""
        c, s = expression(self.c), expression(self.s)
        along = names.define(f"{prefix}_ahead", add(times(c, dx), times(s, dy)))
        aside = names.define(f"{prefix}_left", subtract(times(c, dy), times(s, dx)))
        return along, aside


def reference(robot: Robot, mobility: Mobility, function: str) -> Reference:
    """The centre of the fixed axle and its rolling direction, P and x where no wheel is fixed.

    A skid-steer robot slides as it turns; its reference is the centre of its fixed wheels. NotDerivableError
    where the robot cannot drive (v, 0, omega).
    """
    fixed = [w for w in robot.wheels if w.kind.fixed_axle]
    found = _centre(fixed) if fixed else Reference(Poly({}), Poly({}), Poly.of(1), Poly({}))
    if _drives(robot, mobility) or _skids(robot, mobility, fixed):
        return found
    why = "the axles of its wheels do not let it turn and drive straight at will"
    if not mobility.degenerate and not fixed:
        why = "its coupled wheels do not let it turn"
    raise NotDerivableError(
        f"{robot.name} has no {function}: it would need to drive (v, 0, omega), but {why}"
    )


def _centre(fixed: list[Wheel]) -> Reference:
    """The mean of the fixed wheels; their direction, taken forward."""
    share = Fraction(1, len(fixed))
    views = [working_view(w) for w in fixed]
    x, y = (Poly.sum(p).scale(share) for p in ([g.x for g in views], [g.y for g in views]))
    backwards = _backwards(fixed[0].nominal.ch, fixed[0].nominal.sh)
    c, s = (-p if backwards else p for p in (views[0].ch, views[0].sh))
    return Reference(x, y, c, s)


def _backwards(c: Exact, s: Exact) -> bool:
    """True for a direction that points to the rear (exactly sideways: to the right)."""
    return c.sign < 0 or (not c and s.sign < 0)


def _nominal(robot: Robot) -> Array:
    """(x, y, c, s) with the tunable parameters at their nominal values."""
    fixed = [w.nominal for w in robot.wheels if w.kind.fixed_axle]
    if not fixed:
        return np.array([0.0, 0.0, 1.0, 0.0])
    sign = -1.0 if _backwards(fixed[0].ch, fixed[0].sh) else 1.0
    x, y = (sum(float(v) for v in vs) / len(fixed) for vs in ([g.x for g in fixed], [g.y for g in fixed]))
    return np.array([x, y, sign * float(fixed[0].ch), sign * float(fixed[0].sh)])


def _drives(robot: Robot, mobility: Mobility) -> bool:
    """True when both unit motions of Q lie in the (linear) set of admissible twists."""
    picked = mobility.admissible
    if not picked.linear or not len(picked.basis):
        return False
    x, y, c, s = _nominal(robot)
    wanted = np.array([[c, s, 0.0], [y, -x, 1.0]])
    basis = np.linalg.qr(np.asarray(picked.basis, float).T)[0]
    return bool(np.abs(wanted.T - basis @ (basis.T @ wanted.T)).max() < _SMALL * max(1.0, abs(x), abs(y)))


def _skids(robot: Robot, mobility: Mobility, fixed: list[Wheel]) -> bool:
    """True for parallel fixed wheels on several axles whose drives command both speed and turning."""
    if not mobility.degenerate or len(fixed) < 2 or len(fixed) < len(robot.wheels):
        return False
    lead = fixed[0].nominal
    parallel = all(not (lead.ch * w.nominal.sh - lead.sh * w.nominal.ch) for w in fixed)
    rows = [rolling_row(w, nominal_view(w)).row for w in fixed if "spin" in w.actuated]
    values = np.array([[float(v) if (v := p.constant) is not None else 0.0 for p in row] for row in rows])
    return parallel and len(values) > 1 and int(np.linalg.matrix_rank(values, _SMALL)) >= 2


def commands(
    robot: Robot, mobility: Mobility, ref: Reference, v: Expr, omega: Expr, names: Locals
) -> tuple[tuple[Port, ...], list[tuple[Port, Expr]]]:
    """`inverse` of (v, 0, omega) at Q: its inputs beyond the twist, and its outputs.

    The twist of P is v e - omega z x (Q - P).
    """
    f = inverse(robot, mobility)
    twist = {
        "vx": add(times(expression(ref.c), v), times(expression(ref.y), omega)),
        "vy": subtract(times(expression(ref.s), v), times(expression(ref.x), omega)),
        "omega": omega,
    }
    known = {signal(name): names.define(f"{name}_driving", value) for name, value in twist.items()}
    values = names.adopt(f, {**known})
    outputs = [(port, values[port.name]) for port, _ in f.outputs]
    return tuple(p for p in f.inputs if p.name not in twist), outputs
