"""The rigid motion that best fits measured contact velocities, with one division at run time.

With contacts B and their velocities w, omega is the sum of (B - mean B) x (w - mean w) divided by the sum of
|B - mean B|**2, and v follows from the means. A contact is B = A + f, where the offset f = d e + o n from its pivot A
rotates with the wheel. With the pivots relative to their mean, P = A - mean A, and with F = sum f and W = sum w over n
contacts, both sums become

    moment  = sum of P x w + sum of f x w - F x W / n        f x w = -d**2 steer_rate - o (r spin + o steer_rate)
    inertia = sum of |P|**2 + 2 sum of P . f + sum of |f|**2 - |F|**2 / n

These sums do not cancel if the pivots are far apart compared to the offsets. Otherwise the means are subtracted first.
Every sum and mean is weighted, and n is the sum of the weights.
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

_APART = (
    4  # ratio of sum |P|**2 to sum |f|**2 above which the inertia has a positive bound, see `Spread.least`
)


@dataclass(frozen=True, slots=True)
class Spread:
    """Constant pivots relative to their mean."""

    unit: Exact  # unit of length [m]: the castor offset if all wheels have the same one, else 1 m
    centre: tuple[Exact, Exact]  # mean of the pivots [unit]
    away: tuple[tuple[Exact, Exact], ...]  # pivots relative to the mean [unit]
    least: Exact  # a lower bound of the sum of |B - mean B|**2 [unit**2]
    count: Exact  # sum of the weights


def spread(contacts: Sequence[Contact]) -> Spread | None:
    """Return the pivots of ``contacts``, or None if they are tunable or too close together for their offsets."""
    shapes = [c.wheel.working for c in contacts]
    constants = []
    for g in shapes:
        numbers = [p.constant for p in (g.x, g.y, g.d, g.o)]
        constants.append([v for v in numbers if v is not None])
    if len(contacts) < 2 or any(len(row) < 4 for row in constants):
        return None
    offsets = {d for _, _, d, _ in constants}
    unit = offsets.pop() if len(offsets) == 1 else ONE
    unit = abs(unit) if unit else ONE
    scaled = [[v / unit for v in row] for row in constants]
    weights = [c.weight for c in contacts]
    count = _total(weights)
    centre_x = _total(w * row[0] for w, row in zip(weights, scaled, strict=True)) / count
    centre_y = _total(w * row[1] for w, row in zip(weights, scaled, strict=True)) / count
    away = tuple((x - centre_x, y - centre_y) for x, y, _, _ in scaled)
    far = _total(w * (x * x + y * y) for w, (x, y) in zip(weights, away, strict=True))
    near = _total(w * (d * d + o * o) for w, (_, _, d, o) in zip(weights, scaled, strict=True))
    if far <= near * _APART:
        return None
    # |B - mean B| >= |P| - |f - mean f| in the norm of all contacts, and sqrt(near) <= sqrt(far) / 2.
    return Spread(unit, (centre_x, centre_y), away, far / 4, count)


def _total(values: Iterable[Exact]) -> Exact:
    return sum(values, ZERO)


def fit_rigid(contacts: Sequence[Contact], names: Locals) -> tuple[Twist, Expr]:
    """Return twist and residual norm of the rigid motion that best fits ``contacts``."""
    if len(contacts) == 1:
        return _single(contacts[0], names)
    pivots = spread(contacts)
    return fit_centred(contacts, names) if pivots is None else _collapsed(contacts, pivots, names)


def _single(contact: Contact, names: Locals) -> tuple[Twist, Expr]:
    """Return the smallest twist that explains one contact velocity: omega = B x w / (1 + |B|**2)."""
    ((bx, by, wx, wy),) = named_contacts([contact], names)
    above, below = bx * wy - by * wx, 1 + bx * bx + by * by
    omega = names.poly("omega_fit", expression(above) / expression(below))
    vx, vy = wx + omega * by, wy - omega * bx
    return (expression(vx), expression(vy), expression(omega)), sympy.S.Zero


def fit_centred(contacts: Sequence[Contact], names: Locals) -> tuple[Twist, Expr]:
    """Return twist and residual norm from contact points relative to their mean, for two contacts or more."""
    points = named_contacts(contacts, names)
    weights = [c.weight for c in contacts]
    share = ONE / _total(weights)
    mean = []
    for i, k in enumerate(("bx", "by", "wx", "wy")):
        mean.append(names.poly(f"mean_{k}", _sum(weights, (p[i] for p in points)).scale(share)))
    # The shifted points have a sum of 0, so that the mean of w has no part in the moment.
    local = []
    for c, (bx, by, wx, wy) in zip(contacts, points, strict=True):
        x = names.poly(f"{c.wheel.name}_bx0", bx - mean[0])
        y = names.poly(f"{c.wheel.name}_by0", by - mean[1])
        local.append((x, y, wx, wy))
    above = _sum(weights, (x * wy - y * wx for x, y, wx, wy in local))
    below = _sum(weights, (x * x + y * y for x, y, _, _ in local))
    omega = names.poly("omega_fit", expression(above) / maximum(expression(below), number(FLOOR)))
    errors = []
    for x, y, wx, wy in local:
        errors += [wx - mean[2] + omega * y, wy - mean[3] - omega * x]
    vx, vy = mean[2] + omega * mean[1], mean[3] - omega * mean[0]
    return (expression(vx), expression(vy), expression(omega)), _norm(errors, contacts, names)


def _collapsed(contacts: Sequence[Contact], pivots: Spread, names: Locals) -> tuple[Twist, Expr]:
    """Return twist and residual norm from sums over pivots and offsets.

    Lengths are in ``pivots.unit``, and moment and inertia are multiplied by n.
    """
    n, over = pivots.count, pivots.unit.inverse()
    offsets, speeds = [], []
    moment, inertia = Poly({}), Poly({})
    for c, (px, py) in zip(contacts, pivots.away, strict=True):
        g = c.wheel.working
        fx, fy = (c.bx - g.x).scale(over), (c.by - g.y).scale(over)
        wx, wy = c.wx.scale(over), c.wy.scale(over)
        u, v = _named(names, f"{c.wheel.name}_wx", wx), _named(names, f"{c.wheel.name}_wy", wy)
        moment = moment + (v.scale(px) - u.scale(py) + fx * wy - fy * wx).scale(n * c.weight)
        inertia = inertia + ((fx + px) * (fx + px) + (fy + py) * (fy + py)).scale(n * c.weight)
        offsets.append((fx, fy))
        speeds.append((u, v))
    weights = [c.weight for c in contacts]
    sums = [_sum(weights, (x for x, _ in offsets)), _sum(weights, (y for _, y in offsets))]
    fx, fy = _named(names, "sum_fx", sums[0]), _named(names, "sum_fy", sums[1])
    wx = _named(names, "sum_wx", _sum(weights, (u for u, _ in speeds)))
    wy = _named(names, "sum_wy", _sum(weights, (v for _, v in speeds)))
    # The linear parts of inertia and moment get names, because they share sums with those of f and w.
    below = expression(names.poly("inertia", inertia) - fx * fx - fy * fy)
    if not surely_positive(inertia, sums):
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


def surely_positive(inertia: Poly, sums: list[Poly]) -> bool:
    """Return whether interval arithmetic proves that ``inertia`` minus the squares of ``sums`` is positive.

    The factor 2 leaves room for any grouping of the terms.
    """
    constant = inertia.terms.get((), ZERO)
    variable = _total(abs(c) for m, c in inertia.terms.items() if m)
    squares = ZERO
    for p in sums:
        most = _total(abs(c) for c in p.terms.values())
        squares += most * most
    return (constant - variable * 2 - squares).sign > 0


def _named(names: Locals, name: str, value: Poly) -> Poly:
    return names.poly(name, value) if has_angles([value]) or len(value.terms) > 1 else value


def _sum(weights: Iterable[Exact], values: Iterable[Poly]) -> Poly:
    return Poly.sum(value.scale(weight) for weight, value in zip(weights, values, strict=True))


def _norm(errors: list[Poly], contacts: Sequence[Contact], names: Locals, unit: Exact = ONE) -> Expr:
    """Return the norm of errors [m/s], of which each contact has two, in ``unit`` per second."""
    terms = []
    for i, error in enumerate(errors):
        weight = number(contacts[i // 2].weight)
        terms.append(times(weight, square(names.define(f"error_{i}", error.scale(unit)))))
    return root(add(*terms))
