"""Forward kinematics: sensed joint rates to the twist, least squares over every known row.

Rolling and sliding rows of a wheel are a rotation of [1 0 -By; 0 1 Bx], so the normal matrix does not see
the heading. It is constant unless contact points move (castors, offset wheels) or a steered wheel gives one
row only: what can be inverted now is not inverted on the robot.
"""

from __future__ import annotations

from collections.abc import Mapping

import sympy

from wmrgen.exact.evaluate import fix
from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.kinematics.normal import pseudo_inverse
from wmrgen.kinematics.records import (
    Formula,
    Locals,
    joint_port,
    slip_port,
    tunable_ports,
    twist_ports,
)
from wmrgen.kinematics.rigid import fit_rigid
from wmrgen.kinematics.rootsum import norm
from wmrgen.kinematics.sensing import Component, Contact, measurements, sensed_joints
from wmrgen.kinematics.solve import solve_general
from wmrgen.layout.records import Robot
from wmrgen.mobility.ranks import decide
from wmrgen.ports import Role
from wmrgen.symbolic import Expr, expression

FEW_ROWS = 16  # beyond, residuals are never zero or one relation in practice: not worth expanding
_JOINT_ROLE = {"spin": Role.COMMAND, "steer": Role.STATE, "steer_rate": Role.COMMAND}


def forward(robot: Robot) -> Formula:
    """Sensed joint rates to vx vy omega and the residual norm ``slip``."""
    names = Locals()
    contacts, components = measurements(robot)
    if constant_normal(contacts, components):
        nominal = {p.name: Poly.of(p.nominal) for p in robot.parameters if p.tunable}
        twist, slip = _constant(contacts, components, names, nominal)
    elif not components:
        twist, slip = fit_rigid(contacts, names)
    else:
        twist, slip = solve_general(contacts, components, names)
    inputs = tuple(joint_port(w, j, _JOINT_ROLE[j]) for w in robot.wheels for j in sensed_joints(w))
    outputs = (
        *zip(twist_ports(), twist, strict=True),
        (slip_port("norm of the least-squares residual over all known rows"), slip),
    )
    text = "sensed joint rates to the twist of P in the robot frame, least squares"
    return Formula("forward", (*inputs, *tunable_ports(robot)), tuple(names.items), outputs, text)


def _moves(poly: Poly) -> bool:
    return any(g.kind in ("cos", "sin") for g in poly.generators)


def constant_normal(contacts: list[Contact], components: list[Component]) -> bool:
    """True when the normal matrix depends on no joint angle."""
    return not any(_moves(c.bx) or _moves(c.by) for c in contacts) and not any(
        _moves(p) for c in components for p in c.row
    )


def _rows(contacts: list[Contact], components: list[Component]) -> list[tuple[Row, Poly]]:
    one, zero = Poly.of(1), Poly({})
    rows: list[tuple[Row, Poly]] = []
    for c in contacts:
        rows += [((one, zero, -c.by), c.wx), ((zero, one, c.bx), c.wy)]
    return rows + [(c.row, c.value) for c in components]


def _constant(
    contacts: list[Contact], components: list[Component], names: Locals, nominal: Mapping[str, Poly]
) -> tuple[tuple[Expr, Expr, Expr], Expr]:
    """xi = (H^T H)^+ H^T z with everything but z known now."""
    rows = _rows(contacts, components)
    if not rows:
        return (sympy.S.Zero,) * 3, sympy.S.Zero
    normal = [[Poly.sum(r[i] * r[j] for r, _ in rows) for j in range(3)] for i in range(3)]
    moment = [Poly.sum(r[i] * z for r, z in rows) for i in range(3)]
    inverse = pseudo_inverse(normal, _regular([r for r, _ in rows], nominal), nominal)
    twist = [dot((row[0], row[1], row[2]), (moment[0], moment[1], moment[2])) for row in inverse]
    if len(rows) <= FEW_ROWS:
        direct = [z - dot(r, (twist[0], twist[1], twist[2])) for r, z in rows]
        if all(_negligible(p) for p in direct):
            return _three(twist), sympy.S.Zero
        if _one_relation(direct):
            return _three(twist), norm(direct)
    named = [names.poly(n, p) for n, p in zip(("vx_fit", "vy_fit", "omega_fit"), twist, strict=True)]
    fitted: Row = (named[0], named[1], named[2])
    return _three(named), norm([z - dot(r, fitted) for r, z in rows])


def _regular(rows: list[Row], nominal: Mapping[str, Poly]) -> bool:
    """True when the rows have rank 3, exactly and at the tolerance; tunable parameters count as they stand."""
    numbers = [[v for p in row if (v := fix(p, nominal).constant) is not None] for row in rows]
    assert all(len(row) == 3 for row in numbers)
    rank = decide(numbers)
    return rank.value == rank.exact == 3


def _negligible(p: Poly) -> bool:
    return not p or (not any(_tunable(p)) and max(abs(float(c)) for c in p.terms.values()) < 1e-12)


def _tunable(p: Poly) -> list[str]:
    return [g.name for g in p.generators if g.kind == "param"]


def _one_relation(residuals: list[Poly]) -> bool:
    """True when all residuals are multiples of one form: a single compatibility relation."""
    kept = [r for r in residuals if not _negligible(r)]
    first = kept[0]
    m = next(iter(first.terms))
    return all(m in r.terms and r == first.scale(r.terms[m] / first.terms[m]) for r in kept)


def _three(values: list[Poly]) -> tuple[Expr, Expr, Expr]:
    return expression(values[0]), expression(values[1]), expression(values[2])
