"""Describe the robot that a page drives: its shape, and its functions in JavaScript."""

from __future__ import annotations

from dataclasses import replace
from math import atan2
from typing import Any

from wmrgen.analysis.kinematics.records import Locals, tunable_ports
from wmrgen.codegen.registry import BACKENDS
from wmrgen.derivation.emit import site
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError
from wmrgen.functions.models.axle import leading_axle
from wmrgen.functions.models.inputs import Motion, best_motion
from wmrgen.functions.system import rate_port
from wmrgen.functions.trailers.trailer import state_ports, turns
from wmrgen.geometry.constraints import nominal_view
from wmrgen.geometry.layout.records import Wheel
from wmrgen.geometry.ports import POSE, TWIST
from wmrgen.ir.calls import select, self_contained
from wmrgen.ir.lower import lower
from wmrgen.ir.nodes import Function
from wmrgen.ir.pipeline import optimise

FUNCTIONS = ("inverse", "forward", "odometry")
_JOINTS = ("spin", "steer", "steer_rate")


def robot(derivation: Derivation) -> dict[str, Any]:
    """Return wheels, limits and sensed joints for `templates/html/live.js`, in metres and radians."""
    sensed = derivation.module.function("forward").inputs
    return {
        "name": derivation.robot.name,
        "wheels": [_wheel(wheel) for wheel in derivation.robot.wheels],
        "joints": [port.name for port in sensed if port.name.rpartition(".")[2] in _JOINTS],
        "limits": dict(site(derivation).limits),
        "omnidirectional": derivation.mobility.degree_of_mobility == 3,
        "trailers": [
            {"name": t.name, "hitch": float(t.hitch.nominal), "length": float(t.length.nominal)}
            for t in (derivation.robot.trailers if _towing(derivation) else ())
        ],
        "axle": _axle(derivation),
    }


def _axle(derivation: Derivation) -> dict[str, float]:
    """Return the centre and the heading of the fixed axle, which trailers follow."""
    driven = derivation.driven
    ex, ey, x, y = leading_axle(driven.robot, driven.mobility, nominal_view).nominal
    return {"x": x, "y": y, "heading": atan2(ey, ex)}


def _wheel(wheel: Wheel) -> dict[str, Any]:
    """Return a wheel as `templates/html/live.js` draws it."""
    g, kind = wheel.nominal, wheel.kind
    lengths = {name: float(getattr(g, name)) for name in ("x", "y", "r", "d", "o")}
    return {
        "name": wheel.name,
        **lengths,
        "heading": wheel.heading,
        "gamma": wheel.gamma if kind.rollers else None,
        "turns": kind.turns,  # whether its heading is a joint; `heading` is that at angle 0
        "zero": kind.sliding_row,  # whether it cannot slide sideways
        "swivels": kind.swivels,
        "rolls": kind.has_spin,
        "ball": kind.glyph.ball,  # whether it is a ball, or one driven direction of a ball
    }


def _towing(derivation: Derivation) -> Motion | None:
    """Return the motion that tows the trailers; None without trailers, or if the robot has no model of motion."""
    if not derivation.robot.trailers:
        return None
    try:
        return best_motion(derivation.driven.robot, derivation.driven.mobility)
    except NotDerivableError:
        return None


def towed(derivation: Derivation) -> Function | None:
    """Return ``towed``, the yaw rates of trailers from the twist of P and all headings (Tzafestas (2.70)).

    It is None if no trailer follows: see `_towing`.
    """
    motion = _towing(derivation)
    if motion is None:
        return None
    robot, headings = motion.robot, state_ports(motion.robot.trailers)
    rates = turns(motion, derivation.driven.mobility)
    formula = Locals().formula(
        "towed", (*TWIST, POSE[2], *headings, *tunable_ports(robot)),
        zip(map(rate_port, headings), rates, strict=True), "yaw rates of the trailers",
    )  # fmt: skip
    (function,) = self_contained(optimise((lower(formula),), robot.name))
    return function


def code(derivation: Derivation) -> str:
    """Return the functions that drive the robot, as a JavaScript expression."""
    module = select(derivation.without_gyro.module, {name: name for name in FUNCTIONS})
    if trailers := towed(derivation):
        module = replace(module, functions=(*module.functions, trailers))
    return str(BACKENDS["javascript"].offers("expression")(module))
