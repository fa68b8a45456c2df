"""The velocity of a pivot, whose components give the direction of a wheel: plain sums or, on request, precise ones."""

from __future__ import annotations

from wmrgen.analysis.kinematics.records import Locals
from wmrgen.geometry.constraints import along, working_view
from wmrgen.geometry.exact.poly import Poly, Row, dot
from wmrgen.geometry.layout.records import Wheel
from wmrgen.geometry.symbolic import Compensated, Expr, expression, signal, times

Velocity = tuple[Poly, Poly]
_CLOSE = 8  # a coefficient so many times another one counts as much smaller
_GEOMETRY = ("param", "pi", "sqrt", "inv", "atan2", "tan", "cosf", "sinf")  # kinds of generators


def pivot(w: Wheel, twist: Row) -> Velocity:
    """Velocity of the pivot A in the robot frame [m/s]."""
    g = working_view(w)
    one, zero = Poly.of(1), Poly({})
    return dot(along((one, zero), g), twist), dot(along((zero, one), g), twist)


def components(
    velocity: Velocity, names: Locals, *called: tuple[str, str], precise: bool = False
) -> tuple[Expr, Expr]:
    """Both components of the velocity of a pivot, from whose ratio its direction is taken; a sum gets a name.

    With the centre of rotation 10 nm from a wheel, vx - y omega is 1e-8 of its terms, less than a float resolves.

    Args:
        velocity: of the pivot [m/s].
        names: where sums get their names.
        called: name and quantity of each component, see `Locals.define`.
        precise: whether such a sum is compensated, unless the other component keeps it from mattering.
    """

    def summed(one: Poly, other: Poly) -> Expr | Poly:
        return _compensated(one, other) if precise else one

    a, b = (
        expression(one) if len(one.terms) < 2 else names.define(name, summed(one, other), quantity)
        for one, other, (name, quantity) in zip(velocity, velocity[::-1], called, strict=True)
    )
    return a, b


def _compensated(total: Poly, other: Poly) -> Expr | Poly:
    """``total``, compensated where it is x + c y for two inputs and c of geometry alone."""
    parts, single = _by_input(total), _by_input(other)
    plain = [name for name, c in parts.items() if c.constant in (1, -1)]
    if len(parts) != 2 or not plain:
        return total
    x, y = (plain[0], next(name for name in parts if name != plain[0]))
    c, k = parts[y].constant, single[y].constant if list(single) == [y] else None
    if c is not None and k is not None and abs(c) <= abs(k) * _CLOSE:
        return total  # both cannot vanish together
    first, coefficient = parts[x] * Poly.gen("input", x), expression(parts[y])
    return Compensated(expression(first), times(coefficient, signal(y)))


def _by_input(form: Poly) -> dict[str, Poly]:
    """Coefficients, of geometry alone, of a linear form of inputs; nothing where it is none."""
    parts: dict[str, Poly] = {}
    for monomial, coefficient in form.terms.items():
        inputs = [(g, e) for g, e in monomial if g.kind not in _GEOMETRY]
        if len(inputs) != 1 or inputs[0][0].kind != "input" or inputs[0][1] != 1:
            return {}
        name = inputs[0][0].name
        rest = Poly({tuple(p for p in monomial if p not in inputs): coefficient})
        parts[name] = parts.get(name, Poly({})) + rest
    return parts
