"""A robot measured from near its middle in a length near its own size.

Ranks are decided at a tolerance relative to rows of wheels that stand about one unit from the origin: degrees must
depend neither on the unit of length of the file nor on where P lies. With the centre c and the length L the twist
(v, omega) of P becomes (v + omega z x c, L omega), all of it in m/s.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import hypot, log
from typing import TypeVar

import numpy as np

from wmrgen.constraints import View
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly, Row
from wmrgen.layout.records import Geometry, Robot
from wmrgen.mobility.records import Array

T = TypeVar("T", Poly, Exact)
NEAR = 32  # units: the centre lies on a grid this wide, so that it is P of a robot that stands about P


@dataclass(frozen=True, slots=True)
class Unit:
    """``centre`` [m] and ``length`` [m]."""

    centre: tuple[Fraction, Fraction]
    length: Fraction

    def robot(self, robot: Robot) -> Robot:
        """The robot with its nominal geometry in this unit."""
        return replace(
            robot,
            wheels=tuple(replace(w, nominal=self._geometry(w.nominal)) for w in robot.wheels),
        )

    def view(self, view: View) -> View:
        """A view of a robot in metres, in this unit."""
        return lambda wheel: self._geometry(view(wheel))

    def _geometry(self, g: Geometry[T]) -> Geometry[T]:
        (cx, cy), per = self.centre, 1 / self.length
        return replace(
            g,
            x=(g.x - cx) * per,
            y=(g.y - cy) * per,
            r=g.r * per,
            d=g.d * per,
            o=g.o * per,
            r_sw=g.r_sw * per,
        )

    def twists(self, rows: Array) -> Array:
        """Twists of P in SI units, from rows (or one row) in this unit."""
        omega = rows[..., 2] / float(self.length)
        x, y = (float(v) for v in self.centre)
        return np.stack([rows[..., 0] + y * omega, rows[..., 1] - x * omega, omega], axis=-1)

    def row(self, row: Row) -> Row:
        """A row on twists of P in SI units, from one on twists in this unit."""
        a, b, k = row
        x, y = self.centre
        return a, b, k.scale(self.length) + b.scale(x) - a.scale(y)


def unit_of(robot: Robot) -> Unit:
    """Millimetre, metre or kilometre, whichever is nearest to the reach of the wheels about their middle."""
    places = np.array([(float(w.nominal.x), float(w.nominal.y)) for w in robot.wheels])
    middle = places.mean(axis=0)
    reach = max(hypot(float(x), float(y)) for x, y in places - middle)
    length = Fraction(1000) ** round(log(reach, 1000)) if reach else Fraction(1)
    grid = NEAR * length
    x, y = (grid * round(Fraction(float(v)) / grid) for v in middle)
    return Unit((x, y), length)
