"""The robot that a page drives: what it looks like, and its functions in JavaScript."""

from __future__ import annotations

from typing import Any

from wmrgen.backends.registry import BACKENDS
from wmrgen.emit import site
from wmrgen.ir.calls import select
from wmrgen.layout.records import Wheel
from wmrgen.robot import Derivation

FUNCTIONS = ("inverse", "forward", "odometry")
_JOINTS = ("spin", "steer", "steer_rate")


def robot(derivation: Derivation) -> dict[str, Any]:
    """Wheels, limits and sensed joints, as `templates/html/live.js` draws and drives them; metres and radians."""
    sensed = derivation.module.function("forward").inputs
    return {
        "name": derivation.robot.name,
        "wheels": [_wheel(wheel) for wheel in derivation.robot.wheels],
        "joints": [port.name for port in sensed if port.name.rpartition(".")[2] in _JOINTS],
        "limits": dict(site(derivation).limits),
        "omnidirectional": derivation.mobility.degree_of_mobility == 3,
    }


def _wheel(wheel: Wheel) -> dict[str, Any]:
    """``turns``: its heading, that of steer 0, is a joint. ``zero``: it cannot move across its rolling direction."""
    g, kind = wheel.nominal, wheel.kind
    lengths = {name: float(getattr(g, name)) for name in ("x", "y", "r", "d", "o")}
    return {
        "name": wheel.name,
        "type": wheel.type,
        **lengths,
        "heading": wheel.heading,
        "gamma": wheel.gamma if kind.rollers else None,
        "turns": kind.turns,
        "zero": kind.sliding_row,
        "swivels": kind.swivels,
        "rolls": kind.has_spin,
    }


def code(derivation: Derivation) -> str:
    """A JavaScript expression of the functions that drive it."""
    module = select(derivation.module, {name: name for name in FUNCTIONS})
    return str(BACKENDS["javascript"].offers("expression")(module))
