"""Forward kinematics: sensed joint rates to the twist, least squares over every measured row.

Rolling and sliding rows of a wheel are a rotation of [1 0 -By; 0 1 Bx], so the normal matrix does not see
the heading. It is constant unless contact points move (castors, offset wheels) or a steered wheel gives one
row only: what can be inverted now is not inverted on the robot.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.closed_form import Solution, solve_symbolic, written_out
from wmrgen.analysis.kinematics.gyro import YawRate
from wmrgen.analysis.kinematics.least_squares import (
    Matrix,
    Measured,
    named_normal,
    norm,
    normal_equations,
    pseudo_inverse,
)
from wmrgen.analysis.kinematics.records import Formula, Locals, slip_port, tunable_ports
from wmrgen.analysis.kinematics.rigid import fit_rigid
from wmrgen.analysis.kinematics.sensing import Twist, measurements, sensed_ports, solve_general
from wmrgen.analysis.mobility.ranks import decide, unit_of
from wmrgen.geometry.exact.evaluate import fix, parameters_in
from wmrgen.geometry.exact.lowest import Product
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Poly, Row, dot, triple
from wmrgen.geometry.exact.readable import readable
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import TWIST, Port, Role
from wmrgen.geometry.symbolic import Expr, add, expression, number, over, root, subtract, times

FEW_ROWS = 16  # beyond, residuals are never zero or one relation in practice: not worth expanding
MOST_TERMS = 400  # of the twist in tunable parameters: beyond, it is computed step by step
LONG_NUMBER = (
    10**15
)  # no length is written so; the sine of an angle that has no name is a fraction of 40 digits


class NominalRank(NamedTuple):
    """The rank of H at nominal parameters; ``normal``: H^T W H there, lengths in the robot's unit, None at rank 3."""

    value: int
    normal: list[list[Exact]] | None


def forward(robot: Robot) -> Formula:
    """Sensed joint rates to vx vy omega and the residual norm ``slip``."""
    names = Locals()
    measured = measurements(robot, names)
    if measured.constant_normal:
        twist, slip, names = _constant(measured.rows, robot, names)
    elif measured.rigid:
        twist, slip = fit_rigid(measured.contacts, names)
    else:
        twist, slip = solve_general(measured, names)
    kind = "weighted least-squares" if measured.weighted else "least-squares"
    outputs = (
        *zip(TWIST, twist, strict=True),
        (slip_port(f"norm of the {kind} residual over all known rows"), slip),
    )
    text = f"sensed joint rates to the twist of P in the robot frame, {kind.replace('-', ' ')}"
    return names.formula("forward", (*sensed_ports(robot), *tunable_ports(robot)), outputs, text)


def readable_twist(robot: Robot) -> list[Product] | None:
    """Return the twist that `forward` gives as a reader writes it: components as products in lowest terms.

    None where there is no such form: the rows do not determine the twist, they move with joint angles, all geometry is
    numbers, or a component is long.
    """
    measured = measurements(robot)
    rows = measured.rows
    entries = [p for row, value, _ in rows for p in (*row, value)]
    named = any(parameters_in(p) for p in entries)
    if not (named and measured.constant_normal) or any(map(_has_long_numbers, entries)):
        return None
    if nominal_rank(rows, robot).value < 3:
        return None
    products = written_out(rows)
    return products and [readable(product) for product in products]


def _has_long_numbers(p: Poly) -> bool:
    return any(max(map(abs, (*c.num, c.den))) > LONG_NUMBER for c in p.terms.values())


def disagreement(robot: Robot) -> Formula | None:
    """Sensed joint rates to what each measured row z - H xi [m/s] is of the twist that `forward` makes of them, times
    the root of its weight; None where joints tell no more than a twist. Errors of joints are angles: so that parameters
    do not make them smaller, a row counts by the nominal radius of its wheel, whatever the tunable one is."""
    names, twist = Locals(), forward(robot)
    if {port.name: value for port, value in twist.outputs}["slip"] is sympy.S.Zero:
        return None
    fitted = names.adopt(twist, {})
    outputs: list[tuple[Port, Expr]] = []
    for measured in measurements(robot).all:
        wheel = None if isinstance(measured, YawRate) else measured.wheel
        rolls = wheel is not None and "spin" in wheel.sensed
        radius = expression(wheel.working.rolling_radius) if wheel and rolls else sympy.S.One
        nominal = number(wheel.nominal.rolling_radius) if wheel and rolls else sympy.S.One
        for row, value, weight in measured.rows:
            explained = add(*(times(expression(p), fitted[v.name]) for p, v in zip(row, TWIST, strict=True)))
            off = over(times(nominal, root(number(weight)), subtract(expression(value), explained)), radius)
            port = Port(f"row_{len(outputs)}", Role.COMMAND, "m/s", "what a measured row is off by")
            outputs.append((port, off))
    text = "sensed joint rates to what each measured row is off by"
    return names.formula("disagreement", twist.inputs, outputs, text)


def _constant(rows: list[Measured], robot: Robot, names: Locals) -> Solution:
    """xi = (H^T W H)^+ H^T W z with everything but z computed at derivation time."""
    if not rows:
        return Solution((sympy.S.Zero,) * 3, sympy.S.Zero, names)
    rank = nominal_rank(rows, robot)
    if rank.value == 3 and any(_tunable(p) for row, _, _ in rows for p in row):
        return solve_symbolic(rows, names)
    equations = _short_equations(rows)
    if equations is None:
        return Solution(*_step_by_step(rows, rank, names), names)
    twist = _solved(*equations, rank)
    if len(rows) <= FEW_ROWS:
        direct = [z - dot(r, twist) for r, z, _ in rows]
        if all(_negligible(p) for p in direct):
            return Solution(triple(map(expression, twist)), sympy.S.Zero, names)
        if _one_relation(direct):
            slip = norm(direct, weights=[weight for _, _, weight in rows])
            return Solution(triple(map(expression, twist)), slip, names)
    return Solution(*_fitted(rows, twist, names), names)


def nominal_rank(measured: list[Measured], robot: Robot) -> NominalRank:
    """The rank at nominal parameters, decided in the robot's own unit."""
    nominal = {p.name: Poly.of(p.nominal) for p in robot.parameters if p.tunable}
    unit, rows = unit_of(robot), [row for row, _, _ in measured]
    rank = decide(_numbers([unit.own_row(r) for r in rows], nominal))
    if rank.value == rank.exact == 3:
        return NominalRank(3, None)
    about_P = unit._replace(centre=(Fraction(0), Fraction(0)))
    numbers = zip(
        _numbers([about_P.own_row(r) for r in rows], nominal), (m[2] for m in measured), strict=True
    )
    weighed = [(r, weight) for r, weight in numbers]
    normal = [[sum((r[i] * r[j] * w for r, w in weighed), ZERO) for j in range(3)] for i in range(3)]
    return NominalRank(rank.value, normal)


def _numbers(rows: list[Row], nominal: Mapping[str, Poly]) -> list[list[Exact]]:
    numbers = [[v for p in row if (v := fix(p, nominal).constant) is not None] for row in rows]
    assert all(len(row) == 3 for row in numbers)
    return numbers


def _solved(normal: Matrix, moment: list[Poly], rank: NominalRank) -> list[Poly]:
    """(H^T W H)^+ H^T W z."""
    return [dot(row, moment) for row in pseudo_inverse(normal, rank.normal)]


def _fitted(rows: list[Measured], twist: list[Poly], names: Locals) -> tuple[Twist, Expr]:
    """The twist, named, and the norm of what it leaves of the rows."""
    fits = [names.poly(n, p) for n, p in zip(("vx_fit", "vy_fit", "omega_fit"), twist, strict=True)]
    errors = [z - dot(r, fits) for r, z, _ in rows]
    return triple(map(expression, fits)), norm(errors, weights=[weight for _, _, weight in rows])


def _short_equations(rows: list[Measured]) -> tuple[Matrix, list[Poly]] | None:
    """The normal equations; None where cofactors of H^T H, written out in tunable parameters, have too many terms.

    With T terms in an entry of H^T H and M in one of H^T z, an entry of the twist has some T**2 M of them.
    """
    if sum(max(len(p.terms) for p in r) ** 2 for r, _, _ in rows) > MOST_TERMS:
        return None
    normal, moment = normal_equations(rows)
    size = max(len(p.terms) for row in normal for p in row) ** 2 * max(len(p.terms) for p in moment)
    return (normal, moment) if size <= MOST_TERMS else None


def _step_by_step(rows: list[Measured], rank: NominalRank, names: Locals) -> tuple[Twist, Expr]:
    """The same with names for the entries of H and H^T H: `prepare` has their numbers when it inverts."""

    short = names.short
    named: list[Measured] = [
        ((short(f"row{i}_x", r[0]), short(f"row{i}_y", r[1]), short(f"row{i}_w", r[2])), z, weight)
        for i, (r, z, weight) in enumerate(rows)
    ]
    normal, moment = normal_equations(named)
    entries = named_normal(normal, short)
    twist = _solved(entries, [short(f"b{i}", p, f"Htz[{i}]") for i, p in enumerate(moment)], rank)
    fits, slip = _fitted(named, twist, names)
    return fits, sympy.S.Zero if rank.value == len(rows) else slip


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
