"""The smallest twist that solves N xi = b, N = H^T H symmetric and perhaps singular.

With c1, c2, det the invariants of N and adj its adjugate, the Moore-Penrose inverse is

    rank 3   adj / det
    rank 2   (c1 (I - adj / c2) - N) / c2
    rank 1   I / c1                          (b lies in the range of N)

A rank is lost at run time where an invariant falls under EDGE of what the ones before it allow: a singular value
under a thousandth of the largest, far above the rounding of a float. Lengths are measured in the reach of the
contacts for that decision, so that it does not depend on the unit.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from wmrgen.exact.evaluate import circle, fix
from wmrgen.exact.linalg import cofactor
from wmrgen.exact.number import ONE, Exact
from wmrgen.exact.poly import Gen, Poly
from wmrgen.kinematics.records import Locals
from wmrgen.kinematics.sensing import Component, Contact
from wmrgen.mobility.ranks import numeric_rank
from wmrgen.mobility.records import Array
from wmrgen.symbolic import Expr, expression, maximum, number, select, subtract, times

FLOOR = Exact(Fraction(1, 10**12))
EDGE = Exact(Fraction(1, 10**6))
_POINTS = ((3, 5), (-7, 4), (2, -9))  # half-angle tangents p/q of generic joint angles


@dataclass(frozen=True, slots=True)
class System:
    """N and b with names for their entries; ``rank``: of N in general; ``reach``: a length [m**2] of the contacts."""

    n: list[list[Poly]]
    b: list[Poly]
    rank: int
    reach: Exact


def reach(contacts: list[Contact], components: list[Component]) -> Exact:
    """The mean square distance of the measured wheels from P, offsets included; 1 when all stand at P."""
    wheels = [c.wheel.nominal for c in contacts] + [c.wheel.nominal for c in components]
    total = sum((g.x * g.x + g.y * g.y + g.d * g.d + g.o * g.o for g in wheels), Exact(0))
    return total / len(wheels) if total else ONE


def generic_rank(contacts: list[Contact], components: list[Component]) -> int:
    """The rank of the known rows at general joint angles."""
    return max(_rank_at(contacts, components, k) for k in range(len(_POINTS)))


def _rank_at(contacts: list[Contact], components: list[Component], seed: int) -> int:
    def value(gen: Gen) -> Poly | None:
        if gen.kind not in ("cos", "sin"):
            return None
        index = sum(ord(c) * (k + 1) for k, c in enumerate(gen.name)) + 1
        p, q = _POINTS[seed]
        return Poly.of(circle(Fraction(p * index, q + index))[gen.kind == "sin"])

    rows = []
    for c in contacts:
        bx, by = (_float(p.substitute(value)) for p in (c.bx, c.by))
        rows += [[1.0, 0.0, -by], [0.0, 1.0, bx]]
    rows += [[_float(p.substitute(value)) for p in c.row] for c in components]
    return numeric_rank(_over_reach(rows, contacts, components))[0]


def _over_reach(rows: list[list[float]], contacts: list[Contact], components: list[Component]) -> Array:
    """The rows with lengths in the reach of the contacts, so that their rank does not depend on the unit."""
    return np.asarray(np.array(rows).reshape(-1, 3) / [1.0, 1.0, float(reach(contacts, components)) ** 0.5])


def _float(poly: Poly) -> float:
    """A polynomial whose remaining generators are tunable parameters, at 1 m."""
    known = fix(poly, {g.name: Poly.of(1) for g in poly.generators if g.kind == "param"}).constant
    return float(known) if known is not None else 0.0


def lower_bound(contacts: list[Contact], components: list[Component]) -> float:
    """A bound under det N from the rows that do not move; 0 when they alone do not have rank 3."""
    rows = []
    for c in contacts:
        if c.bx.constant is not None and c.by.constant is not None:
            rows += [[1.0, 0.0, -float(c.by.constant)], [0.0, 1.0, float(c.bx.constant)]]
    for m in components:
        numbers = [p.constant for p in m.row]
        if all(v is not None for v in numbers):
            rows.append([float(v) for v in numbers if v is not None])
    if numeric_rank(_over_reach(rows, contacts, components))[0] < 3:
        return 0.0
    normal = [[sum(r[i] * r[j] for r in rows) for j in range(3)] for i in range(3)]
    a, b, c3 = normal
    return (
        a[0] * (b[1] * c3[2] - b[2] * c3[1])
        - a[1] * (b[0] * c3[2] - b[2] * c3[0])
        + a[2] * (b[0] * c3[1] - b[1] * c3[0])
    )


def smallest_twist(system: System, bound: float, names: Locals) -> list[Expr]:
    """N^+ b. ``bound``: a lower bound of det N when positive; then nothing can be lost."""
    n, b = system.n, system.b
    c1 = names.define("c1", n[0][0] + n[1][1] + n[2][2])
    low = [times(expression(v), _over(c1, names, "c1")) for v in b]
    if system.rank == 1:
        return low
    adj = _adjugate(n, names)
    projected = [names.define(f"p{i}", Poly.sum(adj[i][j] * b[j] for j in range(3))) for i in range(3)]
    det = names.define("det", n[0][0] * adj[0][0] + n[0][1] * adj[0][1] + n[0][2] * adj[0][2])
    if bound > 0:
        below = maximum(det, number(Exact(Fraction(bound / 2).limit_denominator(10**9)) or FLOOR))
        return [times(p, 1 / below) for p in projected]
    c2 = names.define("c2", adj[0][0] + adj[1][1] + adj[2][2])
    over_c2 = _over(c2, names, "c2")
    middle = []
    for i in range(3):
        seen = expression(Poly.sum(n[i][j] * b[j] for j in range(3)))
        rest = subtract(expression(b[i]), times(projected[i], over_c2))
        middle.append(times(subtract(times(c1, rest), seen), over_c2))
    s = system.reach
    size1 = names.define("size1", n[0][0] + n[1][1] + n[2][2].scale(s.inverse()))
    size2 = names.define("size2", (adj[0][0] + adj[1][1]).scale(s.inverse()) + adj[2][2])
    edge2 = names.define("edge2", times(number(EDGE), size1, size1))
    found = middle
    if system.rank == 3:
        over_det = _over(det, names, "det")
        edge3 = names.define("edge3", times(number(EDGE * s), size1, size2))
        found = [select(edge3, det, times(p, over_det), m) for p, m in zip(projected, middle, strict=True)]
    return [select(edge2, size2, f, v) for f, v in zip(found, low, strict=True)]


def _over(value: Expr, names: Locals, name: str) -> Expr:
    return names.define(f"over_{name}", 1 / maximum(value, number(FLOOR)))


def _adjugate(n: list[list[Poly]], names: Locals) -> list[list[Poly]]:
    """The adjugate of a symmetric matrix, entries named."""

    def minor(i: int, j: int) -> Poly:
        return names.poly(f"adj{i}{j}", cofactor(n, i, j))

    upper = {(i, j): minor(i, j) for i in range(3) for j in range(i, 3)}
    return [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]
