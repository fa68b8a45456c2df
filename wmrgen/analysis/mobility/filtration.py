"""Which directions Lie brackets of the admissible motions reach (Siegwart 3.4.1): growth vector and DOF.

The posture model is left invariant on SE(2). A vector field is a twist (vx, vy, omega) of P in the robot frame that
depends on angles, and the rates of these angles. With the bracket of se(2) and D f . g the derivative of f along g,

    [f, g] = ([twist f, twist g] + D twist g . f - D twist f . g,   D rates g . f - D rates f . g)

Two kinds of angles occur. Steering is free: its rates are inputs. Castors whose joints are coupled turn as the motion
turns them, and what the robot can do depends on where they stand (a fixed wheel and a castor with coupled spins).

The growth vector counts dimensions of the pose and of steering, castor angles left out. Its last entry less the degree
of steerability is DOF, its first less the same is DDOF.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import partial
from itertools import combinations, product
from typing import NamedTuple

import numpy as np

from wmrgen.analysis.mobility.basis import led, null_columns
from wmrgen.analysis.mobility.configure import Configuration
from wmrgen.analysis.mobility.ranks import grown, null_basis, span, unit_rows
from wmrgen.analysis.mobility.records import Array
from wmrgen.geometry.constraints import castor_rate, nominal_view
from wmrgen.geometry.exact.evaluate import circle
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Gen, Poly, Row, derivative, each, has_angles, triple
from wmrgen.geometry.layout.records import Robot

_VANISHED = 1e-9  # of the sum of its terms' magnitudes: a value that only rounded coefficients leave
_SHARE = Gen("input", "share", ())  # of the second admissible column in the twist, where steering chooses it
_ZERO, _ONE = Poly({}), Poly.of(1)


def growth_vector(at: Configuration) -> tuple[int, ...]:
    """Dimensions of pose and steering that the inputs span, then those with their brackets, order by order.

    They are counted at a generic admissible configuration; the last entry is reached by all brackets together.
    """
    if not at.mobility:
        return (0,)
    columns = _turning_with_castors(at)
    if columns is None or at.mobility + at.steerability == 1:  # the brackets of one field are zero
        now = null_basis(unit_rows(at.C1))
        return _of_twists(now, at.admissible.tangent, at.steerability)
    return _of_fields(at.robot, columns, at.steerability)


def _of_twists(now: Array, tangent: Array, steering: int) -> tuple[int, ...]:
    """The growth vector where twists depend on steering alone.

    ``now``: basis of the null space; ``tangent``: twists that are reachable with one steering rate added;
    ``steering``: independent steering rates, each a state of its own.
    """
    dims = [steering + len(span(now))]
    reached = span(np.vstack([tangent, grown(now, now)]))
    while steering + len(reached) != dims[-1]:
        dims.append(steering + len(reached))
        reached = grown(now, reached)
    return tuple(dims)


def _turning_with_castors(at: Configuration) -> tuple[Row, ...] | None:
    """The columns of the admissible twists, where these depend on the angles of coupled castors; else None."""
    rows = [each(row, partial(led, at.robot)) for row, _ in at.constant]
    return null_columns(rows) if any(map(has_angles, rows)) else None


class _Field(NamedTuple):
    """A twist and the rates of the coordinates, all of them polynomials in the coordinates."""

    twist: Row
    rates: tuple[Poly, ...]

    @property
    def components(self) -> tuple[Poly, ...]:
        """Twist and rates in one."""
        return (*self.twist, *self.rates)


def _of_fields(robot: Robot, columns: tuple[Row, ...], steering: int) -> tuple[int, ...]:
    """The growth vector where twists turn with castors.

    ``columns`` are two, functions of the castors' angles: both are inputs, or steering chooses their ratio.
    """
    castors = sorted({g.name for column in columns for p in column for g in p.generators})
    state, turn = (*castors, *(_SHARE.name,) * steering), (_ZERO,) * len(castors)
    if steering:
        first, second = columns
        columns = (triple(a + _SHARE.alone * b for a, b in zip(first, second, strict=True)),)
    columns = tuple(each(column, _rounded) for column in columns)
    inputs = [
        _Field(column, (*(_castor_rate(robot, name, column) for name in castors), *(_ZERO,) * steering))
        for column in columns
    ]
    inputs += [_Field((_ZERO, _ZERO, _ZERO), (*turn, _ONE))] * steering
    counted = [0, 1, 2, *range(3 + len(castors), 3 + len(state))]
    point = _generic_point(robot, castors)
    reached, dims, newest = np.zeros((0, 3 + len(state))), list[int](), inputs
    while newest:
        added = []
        for field in newest:
            grown = span(np.vstack([reached, _value(field, point)]))
            if len(grown) > len(reached):
                reached = grown
                added.append(field)
        dims.append(len(span(reached[:, counted])))
        newest = (
            [_bracket(f, g, state) for f, g in _pairs(inputs, added)]
            if added and dims[-1] < len(counted)
            else []
        )
    return tuple(dims[: dims.index(dims[-1]) + 1])


def _pairs(inputs: list[_Field], newest: list[_Field]) -> list[tuple[_Field, _Field]]:
    """Which brackets may add a dimension: those of inputs with inputs or with fields that added one last."""
    first = newest[0] is inputs[0]
    return list(combinations(inputs, 2)) if first else list(product(inputs, newest))


def _castor_rate(robot: Robot, name: str, twist: Row) -> Poly:
    """Steering rate of a castor, in the angles of the castors that turn it."""
    castor = robot.wheel(name)
    return _rounded(led(robot, castor_rate(castor, nominal_view(castor), twist)))


def _rounded(p: Poly) -> Poly:
    """The polynomial with coefficients of 53 bits: products of longer ones take a hundred times as long."""
    return Poly({m: Exact(Fraction(float(c))) for m, c in p.terms.items()})


def _generic_point(robot: Robot, castors: Sequence[str]) -> dict[Gen, Poly]:
    """A different angle for each castor."""
    point = {_SHARE: Poly.of(Fraction(3, 7))}
    for name in castors:
        cosine, sine = circle(Fraction(2 + 3 * robot.wheel(name).index, 7))
        point |= {Gen("cos", name, ()): Poly.of(cosine), Gen("sin", name, ()): Poly.of(sine)}
    return point


def _value(field: _Field, point: Mapping[Gen, Poly]) -> Array:
    """The field at a point, its largest possible component 1; 0 where only rounding of coefficients is left."""
    values = [float(p.substitute(point.get).constant or 0) for p in field.components]
    size = max(sum(abs(float(c)) for c in p.terms.values()) for p in field.components)
    unit = np.array([values]) / (size or 1.0)
    return np.where(np.abs(unit) < _VANISHED, 0.0, unit)


def _bracket(f: _Field, g: _Field, state: Sequence[str]) -> _Field:
    """[f, g], see above."""
    (fx, fy, fw), (gx, gy, gw) = f.twist, g.twist
    still = (_ZERO,) * len(state)
    algebra = (gw * fy - fw * gy, fw * gx - gw * fx, _ZERO, *still)
    along = (
        _along(p, f, state) - _along(q, g, state) for p, q in zip(g.components, f.components, strict=True)
    )
    x, y, turn, *rates = (a + b for a, b in zip(algebra, along, strict=True))
    return _Field((x, y, turn), tuple(rates))


def _along(p: Poly, field: _Field, state: Sequence[str]) -> Poly:
    """The derivative of ``p`` along a field."""
    rates = dict(zip(state, field.rates, strict=True))

    def of_generator(g: Gen) -> Poly:
        slope = {"cos": -Gen("sin", g.name, ()).alone, "sin": Gen("cos", g.name, ()).alone}.get(g.kind, _ONE)
        return slope * rates[g.name]

    return derivative(p, of_generator)
