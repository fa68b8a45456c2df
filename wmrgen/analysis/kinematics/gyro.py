"""What a gyro says about the twist: the row [0 0 1].

Rows are in m/s. The residual of the yaw rate is made a velocity by the mean distance of the sensed wheels from their
middle, so that a gyro of weight 1 counts as a wheel does there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from wmrgen.analysis.kinematics.least_squares import Measured
from wmrgen.analysis.kinematics.records import signal_poly
from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot, Wheel
from wmrgen.geometry.ports import GYRO


class YawRate(NamedTuple):
    """What a gyro measures: omega = value [rad/s]. It counts ``weight`` [m**2]."""

    value: Poly
    weight: Exact

    @property
    def rows(self) -> list[Measured]:
        """The row [0 0 1]."""
        return [((Poly({}), Poly({}), Poly.of(1)), self.value, self.weight)]


def yaw_rate(robot: Robot, wheels: Sequence[Wheel]) -> YawRate | None:
    """What the gyro of ``robot`` measures beside its sensed ``wheels``; None where it has none."""
    if robot.gyro is None:
        return None
    return YawRate(signal_poly(GYRO.name), robot.gyro.weight * _spread(wheels))


def _spread(wheels: Sequence[Wheel]) -> Exact:
    """The mean square distance of the measured wheels from their middle, offsets included; 1 if that is 0.

    It does not depend on where P is, and neither does the twist that a gyro of this weight helps to find.
    """
    shapes = [w.nominal for w in wheels]
    if not shapes:
        return ONE
    x, y = (sum((getattr(g, k) for g in shapes), Exact(0)) / len(shapes) for k in ("x", "y"))
    total = sum(((g.x - x) ** 2 + (g.y - y) ** 2 + g.d * g.d + g.o * g.o for g in shapes), Exact(0))
    return total / len(shapes) if total else ONE
