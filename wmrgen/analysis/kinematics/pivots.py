"""The velocity of a pivot, which gives the direction of a steered wheel, as plain or as compensated sums."""

from __future__ import annotations

from wmrgen.analysis.kinematics.records import Locals
from wmrgen.geometry.constraints import along, working_view
from wmrgen.geometry.exact.poly import Poly, Row, dot
from wmrgen.geometry.layout.records import Wheel
from wmrgen.geometry.symbolic import Compensated, Expr, expression, signal, times

Velocity = tuple[Poly, Poly]
_CLOSE = 8  # ratio of two coefficients above which the smaller one is negligible for cancellation
_GEOMETRY = ("param", "pi", "sqrt", "inv", "atan2", "tan", "cosf", "sinf")  # kinds of generators


def pivot(w: Wheel, twist: Row) -> Velocity:
    """Return the velocity of the pivot A in the robot frame [m/s]."""
    g = working_view(w)
    one, zero = Poly.of(1), Poly({})
    return dot(along((one, zero), g), twist), dot(along((zero, one), g), twist)


def components(
    velocity: Velocity, names: Locals, *called: tuple[str, str], precise: bool = False
) -> tuple[Expr, Expr]:
    """Return both components of a pivot's velocity as expressions whose ratio gives its direction.

    If the centre of rotation is 10 nm from a wheel, vx - y omega is 1e-8 of its terms, less than a float resolves.

    Args:
        velocity: The velocity of the pivot [m/s].
        names: Collects a name for each component that is a sum.
        called: The name and the quantity of each component, see `Locals.define`.
        precise: Whether to compensate sums. A sum remains plain if its error is small relative to the other component.

    Returns:
        The components [m/s].
    """
    parts: list[Expr] = []
    for one, other, (name, quantity) in zip(velocity, velocity[::-1], called, strict=True):
        if len(one.terms) < 2:
            parts.append(expression(one))
        else:
            parts.append(names.define(name, _compensated(one, other) if precise else one, quantity))
    return parts[0], parts[1]


def _compensated(total: Poly, other: Poly) -> Expr | Poly:
    """Return ``total`` as a compensated sum if it is x + c y for two inputs and c depends on geometry alone."""
    parts, single = _by_input(total), _by_input(other)
    plain = [name for name, c in parts.items() if c.constant in (1, -1)]
    if len(parts) != 2 or not plain:
        return total
    x = plain[0]
    y = next(name for name in parts if name != x)
    c = parts[y].constant
    k = single[y].constant if list(single) == [y] else None
    if c is not None and k is not None and abs(c) <= abs(k) * _CLOSE:
        return total  # when it cancels, the other component is large
    first, coefficient = parts[x] * Poly.gen("input", x), expression(parts[y])
    return Compensated(expression(first), times(coefficient, signal(y)))


def _by_input(form: Poly) -> dict[str, Poly]:
    """Return the coefficients of a linear form in inputs, which depend on geometry alone; {} if it is no such form."""
    parts: dict[str, Poly] = {}
    for monomial, coefficient in form.terms.items():
        inputs = [(g, e) for g, e in monomial if g.kind not in _GEOMETRY]
        if len(inputs) != 1 or inputs[0][0].kind != "input" or inputs[0][1] != 1:
            return {}
        name = inputs[0][0].name
        rest = Poly({tuple(p for p in monomial if p not in inputs): coefficient})
        parts[name] = parts.get(name, Poly({})) + rest
    return parts
