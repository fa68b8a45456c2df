"""Forward kinematics: from sensed joint rates to the twist, by least squares over all measured rows.

The rolling and the sliding row of a wheel are a rotation of [1 0 -By; 0 1 Bx], so the normal matrix does not depend on
the heading. It is constant unless contact points move (castors, offset wheels) or a steered wheel measures only one
row. A constant normal matrix is inverted here, and not on the robot.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.closed_form import Solution, solve_symbolic, written_out
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
from wmrgen.analysis.kinematics.sensing import Twist, YawRate, measurements, sensed_ports, solve_general
from wmrgen.analysis.mobility.ranks import decide, unit_of
from wmrgen.geometry.exact.evaluate import fix, parameters_in
from wmrgen.geometry.exact.lowest import Product
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Poly, Row, dot, triple
from wmrgen.geometry.exact.readable import readable
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import TWIST, Port, Role
from wmrgen.geometry.symbolic import Expr, add, expression, number, over, root, subtract, times

FEW_ROWS = (
    16  # rows: with more, residuals are never 0 or one relation in practice, so they are not written out
)
MOST_TERMS = 400  # terms of the twist in tunable parameters: with more, it is computed step by step
# Numerators and denominators above this come from sines of numeric angles (40 digits), not from lengths in a file.
LONG_NUMBER = 10**15


class NominalRank(NamedTuple):
    """The rank of H at nominal parameters."""

    value: int
    normal: list[list[Exact]] | None  # H^T W H with lengths in the robot's unit; None at rank 3


def forward(robot: Robot) -> Formula:
    """Return the function from sensed joint rates to vx, vy, omega and the residual norm ``slip``."""
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
    """Return the twist of `forward` in a form for reports, with components as products in lowest terms.

    Return None if the rows do not determine the twist or depend on joint angles, if all geometry is numbers, or if a
    component is long.
    """
    measured = measurements(robot)
    rows = measured.rows
    entries: list[Poly] = []
    for row, value, _ in rows:
        entries += (*row, value)
    named = any(parameters_in(p) for p in entries)
    if not (named and measured.constant_normal) or any(map(_has_long_numbers, entries)):
        return None
    if nominal_rank(rows, robot).value < 3:
        return None
    products = written_out(rows)
    return None if products is None else [readable(product) for product in products]


def _has_long_numbers(p: Poly) -> bool:
    return any(max(map(abs, (*c.num, c.den))) > LONG_NUMBER for c in p.terms.values())


def disagreement(robot: Robot) -> Formula | None:
    """Return the function from sensed joint rates to the residual of each measured row.

    A residual is z - H xi [m/s] for the twist xi of `forward`, times the root of the weight. Each row is scaled to the
    nominal radius of its wheel, so that a calibration cannot reduce the residuals by smaller radii. Return None if the
    joints measure no more than a twist.
    """
    names, twist = Locals(), forward(robot)
    if {port.name: value for port, value in twist.outputs}["slip"] is sympy.S.Zero:
        return None
    fitted = names.adopt(twist, {})
    outputs: list[tuple[Port, Expr]] = []
    for measured in measurements(robot).all:
        radius = nominal = sympy.S.One
        if not isinstance(measured, YawRate) and "spin" in measured.wheel.sensed:
            radius = expression(measured.wheel.working.rolling_radius)
            nominal = number(measured.wheel.nominal.rolling_radius)
        for row, value, weight in measured.rows:
            explained = add(*(times(expression(p), fitted[v.name]) for p, v in zip(row, TWIST, strict=True)))
            off = over(times(nominal, root(number(weight)), subtract(expression(value), explained)), radius)
            port = Port(f"row_{len(outputs)}", Role.COMMAND, "m/s", "residual of a measured row")
            outputs.append((port, off))
    text = "sensed joint rates to the residual of each measured row"
    return names.formula("disagreement", twist.inputs, outputs, text)


def _constant(rows: list[Measured], robot: Robot, names: Locals) -> Solution:
    """Return xi = (H^T W H)^+ H^T W z, with everything except z computed at derivation time."""
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
    """Return the rank of measured rows at nominal parameters, determined in the robot's own unit."""
    nominal = {p.name: Poly.of(p.nominal) for p in robot.parameters if p.tunable}
    unit, rows = unit_of(robot), [row for row, _, _ in measured]
    rank = decide(_numbers([unit.own_row(r) for r in rows], nominal))
    if rank.value == rank.exact == 3:
        return NominalRank(3, None)
    about_P = unit._replace(centre=(Fraction(0), Fraction(0)))
    numbers = _numbers([about_P.own_row(r) for r in rows], nominal)
    normal = [[ZERO] * 3 for _ in range(3)]
    for r, (_, _, weight) in zip(numbers, measured, strict=True):
        for i in range(3):
            for j in range(3):
                normal[i][j] += r[i] * r[j] * weight
    return NominalRank(rank.value, normal)


def _numbers(rows: list[Row], nominal: Mapping[str, Poly]) -> list[list[Exact]]:
    """Return rows at nominal parameters."""
    numbers = []
    for row in rows:
        constants = [fix(p, nominal).constant for p in row]
        values = [value for value in constants if value is not None]
        assert len(values) == 3
        numbers.append(values)
    return numbers


def _solved(normal: Matrix, moment: list[Poly], rank: NominalRank) -> list[Poly]:
    """Return (H^T W H)^+ H^T W z."""
    return [dot(row, moment) for row in pseudo_inverse(normal, rank.normal)]


def _fitted(rows: list[Measured], twist: list[Poly], names: Locals) -> tuple[Twist, Expr]:
    """Return the twist with names for its components, and the norm of its residuals."""
    fits = [names.poly(n, p) for n, p in zip(("vx_fit", "vy_fit", "omega_fit"), twist, strict=True)]
    errors = [z - dot(r, fits) for r, z, _ in rows]
    return triple(map(expression, fits)), norm(errors, weights=[weight for _, _, weight in rows])


def _short_equations(rows: list[Measured]) -> tuple[Matrix, list[Poly]] | None:
    """Return the normal equations, or None if the twist would have too many terms in tunable parameters.

    With T terms in an entry of H^T H and M in an entry of H^T z, an entry of the twist has about T**2 M terms.
    """
    if sum(_longest(row) ** 2 for row, _, _ in rows) > MOST_TERMS:
        return None
    normal, moment = normal_equations(rows)
    size = max(map(_longest, normal)) ** 2 * _longest(moment)
    return (normal, moment) if size <= MOST_TERMS else None


def _longest(polys: Iterable[Poly]) -> int:
    """Return the largest number of terms that one of the polynomials has."""
    return max(len(p.terms) for p in polys)


def _step_by_step(rows: list[Measured], rank: NominalRank, names: Locals) -> tuple[Twist, Expr]:
    """Return twist and residual norm with names for the entries of H and H^T H, which `prepare` computes in numbers."""
    short = names.short
    named: list[Measured] = []
    for i, (r, z, weight) in enumerate(rows):
        row = short(f"row{i}_x", r[0]), short(f"row{i}_y", r[1]), short(f"row{i}_w", r[2])
        named.append((row, z, weight))
    normal, moment = normal_equations(named)
    entries = named_normal(normal, short)
    twist = _solved(entries, [short(f"b{i}", p, f"Htz[{i}]") for i, p in enumerate(moment)], rank)
    fits, slip = _fitted(named, twist, names)
    return fits, sympy.S.Zero if rank.value == len(rows) else slip


def _negligible(p: Poly) -> bool:
    """Return whether a residual is 0 up to the rounding of numbers."""
    return not p or (not any(_tunable(p)) and max(abs(float(c)) for c in p.terms.values()) < 1e-12)


def _tunable(p: Poly) -> list[str]:
    """Return the tunable parameters in ``p``."""
    return [g.name for g in p.generators if g.kind == "param"]


def _one_relation(residuals: list[Poly]) -> bool:
    """Return whether all residuals are multiples of one form: a single compatibility relation."""
    kept = [r for r in residuals if not _negligible(r)]
    first = kept[0]
    m = next(iter(first.terms))
    return all(m in r.terms and r == first.scale(r.terms[m] / first.terms[m]) for r in kept)
