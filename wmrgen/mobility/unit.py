"""A robot measured from its middle in a length of its own: degrees must not depend on where P lies nor on the unit.

Tolerances are relative to the rows of wheels that stand about one unit from the origin. With the centre c of the
pivots and a unit length L the twist becomes (v + omega z x c, L omega), all of it in m/s.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import frexp, hypot

import numpy as np

from wmrgen.exact.number import ONE, ZERO, Exact
from wmrgen.layout.records import Geometry, Robot, Wheel
from wmrgen.mobility.records import Array


@dataclass(frozen=True, slots=True)
class Unit:
    """``centre`` [m] and ``length`` [m], a power of two."""

    centre: tuple[Exact, Exact]
    length: Exact

    def robot(self, robot: Robot) -> Robot:
        """The robot with its nominal geometry in this unit."""
        return replace(robot, wheels=tuple(self._wheel(w) for w in robot.wheels))

    def _wheel(self, w: Wheel) -> Wheel:
        g, over = w.nominal, self.length.inverse()
        return replace(
            w,
            nominal=Geometry(
                x=(g.x - self.centre[0]) * over, y=(g.y - self.centre[1]) * over,
                ch=g.ch, sh=g.sh, cg=g.cg, sg=g.sg,
                r=g.r * over, d=g.d * over, o=g.o * over, r_sw=g.r_sw * over,
            ),
        )  # fmt: skip

    def twists(self, rows: Array) -> Array:
        """Twists of P in SI units, from rows (or one row) in this unit."""
        omega = rows[..., 2] / float(self.length)
        x, y = (float(v) for v in self.centre)
        return np.stack([rows[..., 0] + y * omega, rows[..., 1] - x * omega, omega], axis=-1)

    def row(self, row: Array) -> Array:
        """A row on twists of P in SI units, from one on twists in this unit."""
        x, y = (float(v) for v in self.centre)
        return np.array([row[0], row[1], x * row[1] - y * row[0] + row[2] * float(self.length)])


PLAIN = Unit((ZERO, ZERO), ONE)
ORDINARY = (
    20  # [m], and one over it: of a pivot's distance from P, where a metre is as good as a unit of one's own
)


def unit_of(robot: Robot) -> Unit:
    """The unit in which a robot is analysed: metres about P for a robot of some `ORDINARY` size that stands there."""
    places = [(float(w.nominal.x), float(w.nominal.y)) for w in robot.wheels]
    if 1 / ORDINARY <= max(hypot(x, y) for x, y in places) <= ORDINARY:
        return PLAIN
    share = Fraction(1, len(places))
    cx = sum((w.nominal.x for w in robot.wheels), ZERO) * share
    cy = sum((w.nominal.y for w in robot.wheels), ZERO) * share
    reach = max(hypot(x - float(cx), y - float(cy)) for x, y in places)
    return Unit((cx, cy), Exact(Fraction(2) ** frexp(reach)[1]) if reach else ONE)


def twist_scale(robot: Robot) -> Array:
    """What takes a twist of P to one in the robot's own unit of length: (1, 1, length)."""
    return np.array([1.0, 1.0, float(unit_of(robot).length)])
