"""The rigid motion nearest to measured contact velocities: one division at run time.

omega = sum of (B - mean B) x (w - mean w) over sum of |B - mean B|**2; v follows from the means. A contact B = A + f
stands off its pivot A by f = d e + o n, which turns. With the pivots measured from their own mean, P = A - mean A,
both sums collapse: with F = sum f and W = sum w of n contacts

    moment  = sum of P x w + sum of f x w - F x W / n        f x w = -d**2 steer_rate - o (r spin + o steer_rate)
    inertia = sum of |P|**2 + 2 sum of P . f + sum of |f|**2 - |F|**2 / n

Nothing cancels where the pivots stand well apart. Where they do not, the means are taken away first. Every sum and
mean is weighted, n the sum of the weights.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import sympy

from wmrgen.analysis.kinematics.records import Locals
from wmrgen.analysis.kinematics.sensing import FLOOR, Contact, Twist, named_contacts
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.exact.poly import Poly, has_angles
from wmrgen.geometry.symbolic import Expr, add, expression, maximum, number, root, square, times

_APART = 4  # sum of |P|**2 over sum of |f|**2 from which the collapsed sums are taken


@dataclass(frozen=True, slots=True)
class Spread:
    """Constant pivots, ``away`` [unit] from their mean ``centre`` [unit]; ``unit`` [m]: the offset where all have one.

    ``least``: a bound under sum of |B - mean B|**2 [unit**2]; ``count``: the sum of the weights.
    """

    unit: Exact
    centre: tuple[Exact, Exact]
    away: tuple[tuple[Exact, Exact], ...]
    least: Exact
    count: Exact


def spread(contacts: Sequence[Contact]) -> Spread | None:
    """The pivots of ``contacts``; None where they are tunable or stand too close for their offsets."""
    shapes = [c.wheel.working for c in contacts]
    numbers = [[p.constant for p in (g.x, g.y, g.d, g.o)] for g in shapes]
    constants = [[v for v in row if v is not None] for row in numbers]
    if len(contacts) < 2 or any(len(row) < 4 for row in constants):
        return None
    offsets = {d for _, _, d, _ in constants}
    unit = offsets.pop() if len(offsets) == 1 else ONE
    unit = abs(unit) if unit else ONE
    scaled = [[v / unit for v in row] for row in constants]
    weights = [c.weight for c in contacts]
    count = _total(weights)
    centre = tuple(_total(w * row[k] for w, row in zip(weights, scaled, strict=True)) / count for k in (0, 1))
    away = tuple((x - centre[0], y - centre[1]) for x, y, _, _ in scaled)
    far = _total(w * (x * x + y * y) for w, (x, y) in zip(weights, away, strict=True))
    near = _total(w * (d * d + o * o) for w, (_, _, d, o) in zip(weights, scaled, strict=True))
    if far <= near * _APART:
        return None
    # |B - mean B| >= |P| - |f - mean f| in the norm of all contacts, and sqrt(near) <= sqrt(far) / 2.
    return Spread(unit, (centre[0], centre[1]), away, far / 4, count)


def _total(values: Iterable[Exact]) -> Exact:
    return sum(values, ZERO)


def fit_rigid(contacts: Sequence[Contact], names: Locals) -> tuple[Twist, Expr]:
    """Twist and residual norm of the rigid motion nearest to ``contacts``."""
    if len(contacts) == 1:
        return _single(contacts[0], names)
    pivots = spread(contacts)
    return _centred(contacts, names) if pivots is None else _collapsed(contacts, pivots, names)


def _single(contact: Contact, names: Locals) -> tuple[Twist, Expr]:
    """The smallest twist, omega = B x w / (1 + |B|**2)."""
    ((bx, by, wx, wy),) = named_contacts([contact], names)
    above, below = bx * wy - by * wx, 1 + bx * bx + by * by
    omega = names.poly("omega_fit", expression(above) / expression(below))
    vx, vy = wx + omega * by, wy - omega * bx
    return (expression(vx), expression(vy), expression(omega)), sympy.S.Zero


def _centred(contacts: Sequence[Contact], names: Locals) -> tuple[Twist, Expr]:
    """From contact points as they stand about their mean."""
    points = named_contacts(contacts, names)
    weights = [c.weight for c in contacts]
    share = ONE / _total(weights)
    mean = [
        names.poly(f"mean_{k}", _sum(weights, (p[i] for p in points)).scale(share))
        for i, k in enumerate(("bx", "by", "wx", "wy"))
    ]
    # The shifted points add up to zero, so the mean of w drops out of the moment.
    local = [
        (*(names.poly(f"{c.wheel.name}_{k}0", p[i] - mean[i]) for i, k in enumerate(("bx", "by"))), *p[2:])
        for c, p in zip(contacts, points, strict=True)
    ]
    above = _sum(weights, (q[0] * q[3] - q[1] * q[2] for q in local))
    below = _sum(weights, (q[0] * q[0] + q[1] * q[1] for q in local))
    omega = names.poly("omega_fit", expression(above) / maximum(expression(below), number(FLOOR)))
    errors = [e for q in local for e in (q[2] - mean[2] + omega * q[1], q[3] - mean[3] - omega * q[0])]
    vx, vy = mean[2] + omega * mean[1], mean[3] - omega * mean[0]
    return (expression(vx), expression(vy), expression(omega)), _norm(errors, contacts, names)


def _collapsed(contacts: Sequence[Contact], pivots: Spread, names: Locals) -> tuple[Twist, Expr]:
    """From sums over pivots and offsets; lengths in ``pivots.unit``, both sums n times as large."""
    n, over = pivots.count, pivots.unit.inverse()
    offsets, speeds = [], []
    moment, inertia = Poly({}), Poly({})
    for c, (px, py) in zip(contacts, pivots.away, strict=True):
        g = c.wheel.working
        fx, fy = (c.bx - g.x).scale(over), (c.by - g.y).scale(over)
        wx, wy = c.wx.scale(over), c.wy.scale(over)
        u, v = (_named(names, f"{c.wheel.name}_{k}", p) for k, p in (("wx", wx), ("wy", wy)))
        moment = moment + (v.scale(px) - u.scale(py) + fx * wy - fy * wx).scale(n * c.weight)
        inertia = inertia + ((fx + px) * (fx + px) + (fy + py) * (fy + py)).scale(n * c.weight)
        offsets.append((fx, fy))
        speeds.append((u, v))
    weights = [c.weight for c in contacts]
    sums = [_sum(weights, (f[i] for f in offsets)) for i in (0, 1)]
    fx, fy = (_named(names, f"sum_f{k}", p) for k, p in zip("xy", sums, strict=True))
    wx, wy = (_named(names, f"sum_w{k}", _sum(weights, (w[i] for w in speeds))) for i, k in enumerate("xy"))
    # The linear parts have names of their own: their sums are shared with those of f and w.
    below = expression(names.poly("inertia", inertia) - fx * fx - fy * fy)
    if not _stays_positive(inertia, sums):
        below = maximum(below, number(pivots.least * n / 2))
    omega = names.poly("omega_fit", expression(names.poly("moment", moment) - fx * wy + fy * wx) / below)
    share = pivots.unit / n
    x, y = pivots.centre
    vx = (wx + omega * (fy + y * n)).scale(share)
    vy = (wy - omega * (fx + x * n)).scale(share)
    errors = []
    for (px, py), (gx, gy), (u, v) in zip(pivots.away, offsets, speeds, strict=True):
        bx, by = gx + px - fx.scale(ONE / n), gy + py - fy.scale(ONE / n)
        errors += [u - wx.scale(ONE / n) + omega * by, v - wy.scale(ONE / n) - omega * bx]
    return (expression(vx), expression(vy), expression(omega)), _norm(errors, contacts, names, pivots.unit)


def _stays_positive(inertia: Poly, sums: list[Poly]) -> bool:
    """Whether intervals see that ``inertia`` less the squares of ``sums`` is positive, sums regrouped or not."""
    still = inertia.terms.get((), ZERO)
    moving = _total(abs(c) for m, c in inertia.terms.items() if m)
    squares = _total(reach * reach for reach in (_total(abs(c) for c in p.terms.values()) for p in sums))
    return (still - moving * 2 - squares).sign > 0


def _named(names: Locals, name: str, value: Poly) -> Poly:
    return names.poly(name, value) if has_angles([value]) or len(value.terms) > 1 else value


def _sum(weights: Iterable[Exact], values: Iterable[Poly]) -> Poly:
    return Poly.sum(value.scale(weight) for weight, value in zip(weights, values, strict=True))


def _norm(errors: list[Poly], contacts: Sequence[Contact], names: Locals, unit: Exact = ONE) -> Expr:
    """Of two errors for each of ``contacts``, lengths in ``unit``."""
    squares = (square(names.define(f"error_{i}", e.scale(unit))) for i, e in enumerate(errors))
    weights = (number(c.weight) for c in contacts for _ in (0, 1))
    return root(add(*(times(weight, s) for weight, s in zip(weights, squares, strict=True))))
