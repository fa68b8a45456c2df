"""Least squares whose normal matrix moves with the steering: one division at run time.

Denominators are kept above a floor far below any value a real robot takes, so that no input divides by zero.
"""

from __future__ import annotations

from wmrgen.exact.poly import Poly, Row, dot
from wmrgen.kinematics.records import Locals
from wmrgen.kinematics.sensing import Component, Contact
from wmrgen.kinematics.smallest import System, generic_rank, lower_bound, reach, smallest_twist
from wmrgen.symbolic import Expr, add, expression, root, square

_UPPER = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
Twist = tuple[Expr, Expr, Expr]


def _total(values: list[Poly]) -> Poly:
    return Poly.sum(values)


def named_contacts(contacts: list[Contact], names: Locals) -> list[tuple[Poly, Poly, Poly, Poly]]:
    """Contact points and velocities with names, so that each is computed once."""
    named = []
    for c in contacts:
        n = c.wheel.name
        parts = (("bx", c.bx), ("by", c.by), ("wx", c.wx), ("wy", c.wy))
        bx, by, wx, wy = (names.poly(f"{n}_{k}", p) if p.generators else p for k, p in parts)
        named.append((bx, by, wx, wy))
    return named


def solve_general(contacts: list[Contact], components: list[Component], names: Locals) -> tuple[Twist, Expr]:
    """Any mix of contact velocities and single rows, by cofactors of the 3x3 normal matrix N.

    Where the rows leave a direction unseen (a rear-driven bicycle steered by 90 degrees) the smallest twist
    is taken. The rank that the rows have in general decides at derivation time which formulas are needed.
    """
    rows = _all_rows(contacts, components, names)
    upper = {(i, j): names.poly(f"n{i}{j}", _total([r[i] * r[j] for r, _ in rows])) for i, j in _UPPER}
    n = [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]
    b = [names.poly(f"b{i}", _total([r[i] * z for r, z in rows])) for i in range(3)]
    system = System(n, b, generic_rank(contacts, components), reach(contacts, components))
    twist = smallest_twist(system, lower_bound(contacts, components), names)
    fitted = [names.poly(k, e) for k, e in zip(("vx_fit", "vy_fit", "omega_fit"), twist, strict=True)]
    xi: Row = (fitted[0], fitted[1], fitted[2])
    errors = [names.poly(f"error_{i}", z - dot(r, xi)) for i, (r, z) in enumerate(rows)]
    slip = root(add(*(square(expression(e)) for e in errors)))
    return (expression(xi[0]), expression(xi[1]), expression(xi[2])), slip


def _all_rows(contacts: list[Contact], components: list[Component], names: Locals) -> list[tuple[Row, Poly]]:
    one, zero = Poly.of(1), Poly({})
    rows: list[tuple[Row, Poly]] = []
    for bx, by, wx, wy in named_contacts(contacts, names):
        rows += [((one, zero, -by), wx), ((zero, one, bx), wy)]
    for c in components:
        parts = [
            names.poly(f"{c.wheel.name}_{k}", p) if p.generators else p
            for k, p in zip(("rx", "ry", "rw"), c.row, strict=True)
        ]
        rows.append(((parts[0], parts[1], parts[2]), c.value))
    return rows
