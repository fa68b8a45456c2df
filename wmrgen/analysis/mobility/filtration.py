"""Growth vector and DOF: the directions that Lie brackets of the admissible motions reach (Siegwart 3.4.1).

The posture model is left invariant on SE(2). A vector field consists of a twist (vx, vy, omega) of P in the robot
frame, which depends on joint angles, and of the rates of these angles. With the bracket of se(2), and with D f . g as
the derivative of f along g,

    [f, g] = ([twist f, twist g] + D twist g . f - D twist f . g,   D rates g . f - D rates f . g)

There are two kinds of angles. Steering angles are free: their rates are inputs. The angles of castors follow from the
motion. If joints of castors are coupled, the admissible twists depend on these angles, for example for a fixed wheel
and a castor with coupled spins.

The growth vector counts dimensions of the pose and of steering, without castor angles. DOF is its last entry minus the
degree of steerability, and DDOF is its first entry minus the degree of steerability.
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

_VANISHED = (
    1e-9  # relative to the sum of the terms' magnitudes: smaller values come from rounded coefficients
)
_SHARE = Gen("input", "share", ())  # weight of the second admissible column, if steering determines it
_ZERO, _ONE = Poly({}), Poly.of(1)


def growth_vector(at: Configuration) -> tuple[int, ...]:
    """Return the dimensions of pose and steering that inputs and their brackets span, by order of the brackets.

    They are counted at a generic admissible configuration. The last entry is the dimension that all brackets span.
    """
    if not at.mobility:
        return (0,)
    columns = _castor_dependent_columns(at)
    if columns is None or at.mobility + at.steerability == 1:  # the brackets of one field are zero
        now = null_basis(unit_rows(at.C1))
        return _growth_of_twists(now, at.admissible.tangent, at.steerability)
    return _growth_of_fields(at.robot, columns, at.steerability)


def _growth_of_twists(now: Array, tangent: Array, steering: int) -> tuple[int, ...]:
    """Return the growth vector for twists that depend on steering alone.

    ``now`` is a basis of the null space. ``tangent`` spans the twists that are reachable with one steering rate.
    ``steering`` is the number of independent steering rates; each steering angle is a state.
    """
    dims = [steering + len(span(now))]
    reached = span(np.vstack([tangent, grown(now, now)]))
    while steering + len(reached) != dims[-1]:
        dims.append(steering + len(reached))
        reached = grown(now, reached)
    return tuple(dims)


def _castor_dependent_columns(at: Configuration) -> tuple[Row, ...] | None:
    """Return the columns of the admissible twists if they depend on angles of coupled castors, else None."""
    rows = [each(row, partial(led, at.robot)) for row, _ in at.constant]
    return null_columns(rows) if any(map(has_angles, rows)) else None


class _Field(NamedTuple):
    """A vector field. Its components are polynomials in the coordinates, which are angles."""

    twist: Row
    rates: tuple[Poly, ...]  # rates of the coordinates

    @property
    def components(self) -> tuple[Poly, ...]:
        """Twist and rates."""
        return (*self.twist, *self.rates)


def _growth_of_fields(robot: Robot, columns: tuple[Row, ...], steering: int) -> tuple[int, ...]:
    """Return the growth vector for twists that depend on castor angles.

    There are two columns, functions of the castor angles. Either both are inputs, or steering determines their ratio.
    """
    names: set[str] = set()
    for column in columns:
        for p in column:
            names |= {g.name for g in p.generators}
    castors = sorted(names)
    state, turn = (*castors, *(_SHARE.name,) * steering), (_ZERO,) * len(castors)
    if steering:
        first, second = columns
        columns = (triple(a + _SHARE.alone * b for a, b in zip(first, second, strict=True)),)
    columns = tuple(each(column, _rounded) for column in columns)
    inputs = []
    for column in columns:
        castor_rates = [_castor_rate(robot, name, column) for name in castors]
        inputs.append(_Field(column, (*castor_rates, *(_ZERO,) * steering)))
    inputs += [_Field((_ZERO, _ZERO, _ZERO), (*turn, _ONE))] * steering
    counted = [0, 1, 2, *range(3 + len(castors), 3 + len(state))]  # without castor angles
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
        newest = []
        if added and dims[-1] < len(counted):
            newest = [_bracket(f, g, state) for f, g in _pairs(inputs, added)]
    return tuple(dims[: dims.index(dims[-1]) + 1])


def _pairs(inputs: list[_Field], newest: list[_Field]) -> list[tuple[_Field, _Field]]:
    """Return pairs whose brackets may add a dimension: inputs with inputs, or with the newest fields."""
    first = newest[0] is inputs[0]
    return list(combinations(inputs, 2)) if first else list(product(inputs, newest))


def _castor_rate(robot: Robot, name: str, twist: Row) -> Poly:
    """Return the steering rate of a castor, with coupled angles replaced by those of the leading castors."""
    castor = robot.wheel(name)
    return _rounded(led(robot, castor_rate(castor, nominal_view(castor), twist)))


def _rounded(p: Poly) -> Poly:
    """Return the polynomial with coefficients rounded to 53 bits, because products of longer ones are very slow."""
    return Poly({m: Exact(Fraction(float(c))) for m, c in p.terms.items()})


def _generic_point(robot: Robot, castors: Sequence[str]) -> dict[Gen, Poly]:
    """Return a point with a different angle for each castor."""
    point = {_SHARE: Poly.of(Fraction(3, 7))}
    for name in castors:
        cosine, sine = circle(Fraction(2 + 3 * robot.wheel(name).index, 7))
        point |= {Gen("cos", name, ()): Poly.of(cosine), Gen("sin", name, ()): Poly.of(sine)}
    return point


def _value(field: _Field, point: Mapping[Gen, Poly]) -> Array:
    """Return the field at a point, scaled to components of at most 1, with rounding errors replaced by 0."""
    values = [float(p.substitute(point.get).constant or 0) for p in field.components]
    size = max(map(_bound, field.components))
    unit = np.array([values]) / (size or 1.0)
    return np.where(np.abs(unit) < _VANISHED, 0.0, unit)


def _bound(p: Poly) -> float:
    """Return the sum of the absolute coefficients: the largest value of ``p`` if no generator exceeds 1."""
    return sum(abs(float(c)) for c in p.terms.values())


def _bracket(f: _Field, g: _Field, state: Sequence[str]) -> _Field:
    """Return the Lie bracket [f, g], see the module docstring."""
    (fx, fy, fw), (gx, gy, gw) = f.twist, g.twist
    still = (_ZERO,) * len(state)
    algebra = (gw * fy - fw * gy, fw * gx - gw * fx, _ZERO, *still)
    total = []
    for a, p, q in zip(algebra, g.components, f.components, strict=True):
        total.append(a + (_along(p, f, state) - _along(q, g, state)))
    x, y, turn, *rates = total
    return _Field((x, y, turn), tuple(rates))


def _along(p: Poly, field: _Field, state: Sequence[str]) -> Poly:
    """Return the derivative of ``p`` along a field."""
    rates = dict(zip(state, field.rates, strict=True))

    def of_generator(g: Gen) -> Poly:
        slope = {"cos": -Gen("sin", g.name, ()).alone, "sin": Gen("cos", g.name, ()).alone}.get(g.kind, _ONE)
        return slope * rates[g.name]

    return derivative(p, of_generator)
