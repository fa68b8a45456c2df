"""What castors see of a twist: the velocity of the pivot, once in the frame of the wheel's zero, then turned.

The pivot's velocity (a, b) is linear in the twist and castors that stand in a row share its parts; turned by the
joint angle it is (u, w) = (a c + b s, b c - a s), and with the offset d and the lateral offset o

    rolling row . xi = u - o omega        sliding row . xi = w + d omega        (Siegwart (3.17), (3.18))
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from wmrgen.constraints import steer_gens, working_view
from wmrgen.exact.poly import Poly, Row
from wmrgen.kinematics.line import pivot, turned_by
from wmrgen.kinematics.records import Locals
from wmrgen.layout.records import Robot, Wheel

_MANY = 3  # castors of one offset from which dividing all velocities by it takes fewer operations


@dataclass(frozen=True, slots=True)
class CastorMotion:
    """``rolling`` and ``sliding``: rows times the twist [m/s]. ``free_rate``: steering rate [rad/s] without sliding."""

    rolling: Poly
    sliding: Poly
    free_rate: Poly


def castor_motion(robot: Robot, twist: Row, names: Locals) -> dict[int, CastorMotion]:
    """The motion of every castor, by wheel index."""
    castors = [w for w in robot.wheels if w.kind.swivels]
    alike = Counter(working_view(w).d.key for w in castors)
    return {w.index: _motion(w, twist, names, alike[working_view(w).d.key] >= _MANY) for w in castors}


def _motion(w: Wheel, twist: Row, names: Locals, divided: bool) -> CastorMotion:
    """``divided``: the pivot's velocity is written in offsets per second."""
    g, (c, s) = working_view(w), steer_gens(w)
    over = g.d.inverse()
    before, after = (over, Poly.of(1)) if divided else (Poly.of(1), over)
    a, b = (
        names.poly(f"{w.name}_{k}", p * before) if len(p.terms) > 1 else p * before
        for k, p in zip("ab", turned_by(w, pivot(w, twist)), strict=True)
    )
    along, across = a * c + b * s, b * c - a * s
    unit = g.d if divided else Poly.of(1)
    return CastorMotion(
        unit * along - g.o * twist[2], unit * across + g.d * twist[2], -(across * after) - twist[2]
    )
