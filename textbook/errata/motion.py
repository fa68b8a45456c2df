"""A frame that turns and moves, by differentiation: the independent truth for relations of moving frames."""

from __future__ import annotations

from collections.abc import Mapping

import sympy

from textbook.errata.forms import symbol
from textbook.transforms import rotation_rows
from wmrgen.geometry.symbolic import Expr


def vector(name: str) -> sympy.Matrix:
    """Three symbols ``name_x``, ``name_y``, ``name_z`` in a column."""
    return sympy.Matrix([symbol(rf"{{{name}}}_{axis}") for axis in "xyz"])


def rate(value: sympy.Matrix, rates: Mapping[Expr, Expr]) -> sympy.Matrix:
    """The time derivative by the chain rule; ``rates``: symbol -> its rate."""
    return value.applyfunc(lambda e: sympy.Add(*(sympy.diff(e, s) * v for s, v in rates.items() if e.has(s))))


class Turning:
    """A point r(t) of a frame that turns as R_z(a) R_y(b) R_x(c) and whose origin is at m(t).

    Everything is given at the moment at which the frames are parallel, a = b = c = 0, after differentiating: the
    angular velocity and acceleration are arbitrary there, and both frames have the same coordinates.
    """

    def __init__(self) -> None:
        angles = [symbol(n) for n in "abc"]
        first = [symbol(rf"\dot{{{n}}}") for n in "abc"]
        second = [symbol(rf"\ddot{{{n}}}") for n in "abc"]
        self.r, self.v, self.acc = vector("r"), vector("v"), vector("a^m")
        self.vm, self.am = vector("v^f"), vector("a^f")
        rates = {
            now: then for a, b in ((angles, first), (first, second)) for now, then in zip(a, b, strict=True)
        }
        turn = sympy.eye(3)
        for axis, angle in zip("zyx", angles, strict=True):
            turn = turn * rotation_rows(axis, angle)
        parallel = dict.fromkeys(angles, sympy.S.Zero)
        turned = rate(turn, rates)
        spin = turned * turn.T  # [omega]x
        omega = sympy.Matrix([spin[2, 1], spin[0, 2], spin[1, 0]])
        self.omega, self.alpha = omega.xreplace(parallel), rate(omega, rates).xreplace(parallel)
        # m + R r by the product rule, R = 1 at this moment
        first_R, second_R = turned.xreplace(parallel), rate(turned, rates).xreplace(parallel)
        self.velocity = self.vm + first_R * self.r + self.v
        self.acceleration = self.am + second_R * self.r + 2 * first_R * self.v + self.acc
