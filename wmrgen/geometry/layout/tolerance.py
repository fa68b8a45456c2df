"""How far axles may miss one another and count as one, and what is told of those that nearly do."""

from __future__ import annotations

from math import ceil
from typing import NamedTuple


class Tolerance(NamedTuple):
    """Axles that miss one another by ``length`` [m] or less are taken for one. ``size`` [m]: from the rim of one wheel
    to that of another, the largest there is. ``written``: the robot file says it."""

    length: float
    size: float
    written: bool

    @property
    def angle(self) -> float:
        """The angle [rad] by which an axle as long as the robot misses by ``length``."""
        return self.length / self.size if self.size else 0.0

    def __str__(self) -> str:
        default = "" if self.written else " (1 mm per metre of the robot's size)"
        return f"the tolerance of {1000 * self.length:.3g} mm{default}"


EXACT = Tolerance(0.0, 0.0, True)


class Near(NamedTuple):
    """Axles that are nearly one: ``text`` says which, in backticks, and how near, ``instead`` what to write for one.

    ``tolerance`` [m] takes them for one: the distance of the two that are farthest apart. ``apart`` [m]: what is
    between the sets of them that are one already. ``moves`` says how wheels were moved, and is empty where the robot's
    own tolerance is smaller. ``wheel``: the last of them.
    """

    text: str
    wheel: str
    tolerance: float
    apart: float
    instead: str
    moves: str = ""

    def sentence(self, tolerance: Tolerance) -> str:
        """The text, with the robot's tolerance and what follows; no full stop."""
        if self.moves:
            return f"{self.text}, within {tolerance}, and are taken for one: {self.moves}"
        little = "a little " * (self.tolerance < 1.005 * tolerance.length)  # which reads the same
        return f"{self.text}, {little}more than {tolerance}"

    @property
    def remedies(self) -> str:
        """What to write in the robot file."""
        if self.moves:
            return f"Write {self.instead}; or tolerance: 0, which keeps them apart."
        enough = f"{1000 * rounded_up(self.tolerance):.6g} mm"
        return (
            f"If one axle bears them, write {self.instead}, or tolerance: {enough}, which takes them for one."
        )


def rounded_up(length: float) -> float:
    """A length [m] in whole hundredths of a millimetre, as a tolerance is proposed."""
    return max(1, ceil(round(length * 1e5, 6))) / 1e5
