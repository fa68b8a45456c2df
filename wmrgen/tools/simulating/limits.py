"""Limit the twists of a control law, as firmware does between the law and the motors.

`limit_twist` slows a twist down to the limits of vx, vy and omega. For a car it also reduces the yaw rate to what the
steering stops allow. `desaturate` slows all wheels down to their limits of ``spin``. The path does not change, except
at steering stops. Limits of acceleration and of ``steer_rate`` do not apply, because simulated robots have the
commanded velocity and steering angles at once. The ``deadband`` does not apply either: it removes noise of joysticks,
and a law commands small twists close to its goal.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wmrgen.analysis.mobility.basis import NEGLIGIBLE
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError
from wmrgen.geometry.exact.number import ZERO
from wmrgen.geometry.ports import TWIST_NAMES
from wmrgen.tools.simulating.model import Model, Twist, Values

FUNCTIONS = ("limit_twist", "desaturate")


class Limiter:
    """The functions of `FUNCTIONS` that a robot can have."""

    def __init__(self, model: Model) -> None:
        """Take the robot."""
        robot = replace(model.robot, deadband=ZERO)
        possible = Derivation(robot, FUNCTIONS)
        self.functions = tuple(name for name in FUNCTIONS if _has(possible, name))
        self.acted = False  # whether a command was changed
        self._model = model
        self._limits = Model(Derivation(robot, ("inverse", *self.functions))) if self.functions else None

    def limited(self, state: Values, twist: Twist) -> Twist:
        """Return the twist inside the limits.

        Args:
            state: the state of the robot, for N starts.
            twist: vx, vy [m/s] and omega [rad/s] of the law, (N,) each.

        Returns:
            The twist that the robot is commanded, (N,) each.
        """
        if self._limits is None:
            return twist
        values = dict(zip(TWIST_NAMES, twist, strict=True))
        if "limit_twist" in self.functions:
            values = self._limits.call("limit_twist", {**state, **values})
        if "desaturate" in self.functions:
            joints = self._limits.call("inverse", {**state, **values})
            scale = self._limits.call("desaturate", joints)["scale"]
            values = {name: scale * values[name] for name in TWIST_NAMES}
        after = tuple(values[name] for name in TWIST_NAMES)
        for new, old in zip(after, twist, strict=True):
            self.acted |= bool((np.abs(new - old) > NEGLIGIBLE * np.maximum(1.0, np.abs(old))).any())
        return after[0], after[1], after[2]


def _has(derivation: Derivation, name: str) -> bool:
    """Return whether a robot can have a function."""
    try:
        derivation.formula(name)
    except NotDerivableError:
        return False
    return True
