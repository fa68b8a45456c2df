"""The figure that the example of a robot drives: the first of a list that the robot can drive and measure.

Along the figure one share swings from 0 to 1, to -1 and back to 0, in straight lines over time, and scales what turns
the robot or moves it sideways. A robot can drive a figure if, at every point of it, the twist is inside its limits and
`forward` of what `inverse` commands is that twist. What fails there: curvature beyond a steering stop, wheels that
cannot turn the robot, wheels that skid, and wheels that do not determine the yaw rate.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import degrees, pi
from typing import NamedTuple

from wmrgen.ir.calls import by_name, inline_prepare, inlined
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.nodes import Function, Module
from wmrgen.ports import TWIST_NAMES

DURATION = 60  # s
_SPEEDS = (0.25, 1.0, 0.1, 0.04)  # m/s; a fast robot's `limit_twist` takes 0.25 m/s for standstill
_HEADINGS = (2 * pi, pi, pi / 2, pi / 4, pi / 8, pi / 16)  # rad, the change of heading in half of the figure
_SHARES = (0.0, 0.25, 0.5, 1.0, 0.5, 0.0, -0.5, -1.0, -0.25)
_TOLERANCE = 1e-3  # of the speed, and of the speed per metre: a tenth of what the drive may be off


class Figure(NamedTuple):
    """``ahead`` [m/s] as long as it drives; ``sideways`` [m/s] and ``turning`` [rad/s] at the largest share."""

    ahead: float
    sideways: float
    turning: float
    text: str


def figure(module: Module) -> Figure:
    """The figure for a robot with the C functions of ``module``; standstill if it can drive none."""
    kernels = by_name(module.kernels)
    functions = {f.name: inline_prepare(inlined(f, kernels), module.prepare) for f in module.functions}
    if {"inverse", "forward"} <= functions.keys():
        for candidate in _candidates():
            swaying = _swaying(functions, candidate) if candidate.turning else candidate
            if _drives(functions, swaying):
                return swaying
    return Figure(0.0, 0.0, 0.0, "Standstill: no motion of this robot is both commanded and measured.")


def _candidates() -> Iterator[Figure]:
    for speed in _SPEEDS:
        for heading in _HEADINGS:
            what = "loop" if heading == 2 * pi else f"curve of {degrees(heading):g} degrees"
            text = f"A {what} to the left and one to the right in a minute."
            yield Figure(speed, 0.0, 4 * heading / DURATION, text)
    for speed in _SPEEDS:
        text = (
            "To the left and to the right, while the robot drives ahead and keeps its heading, in a minute."
        )
        yield Figure(speed, speed, 0.0, text)
    for speed in _SPEEDS:
        yield Figure(speed, 0.0, 0.0, "Straight ahead for a minute.")


def _twist(figure: Figure, share: float) -> dict[str, float]:
    parts = (figure.ahead, share * figure.sideways, share * figure.turning)
    return dict(zip(TWIST_NAMES, parts, strict=True))


def _swaying(functions: Mapping[str, Function], figure: Figure) -> Figure:
    """``figure`` with the velocity sideways of P that fixed wheels ahead of P or behind it force on a turn."""
    driven = _step(functions, {}, _twist(figure, 1.0))
    sway = driven["vy"] * figure.turning
    if abs(sway) <= _TOLERANCE * figure.ahead * abs(driven["omega"]):
        return figure
    return figure._replace(sideways=sway / driven["omega"]) if driven["omega"] else figure


def _drives(functions: Mapping[str, Function], figure: Figure) -> bool:
    """Whether the twist of the commands is the wanted one at every share, and never faster sideways than ahead."""
    if abs(figure.sideways) > figure.ahead:
        return False
    joints: dict[str, float] = {}
    for share in _SHARES:
        wanted = _twist(figure, share)
        driven = _step(functions, joints, wanted)
        if any(abs(driven[name] - wanted[name]) > _TOLERANCE * figure.ahead for name in TWIST_NAMES):
            return False
    return True


def _step(
    functions: Mapping[str, Function], joints: dict[str, float], wanted: dict[str, float]
) -> dict[str, float]:
    """The twist that is driven: `forward` of the commands for the ``wanted`` one, which are added to ``joints``."""

    def call(name: str, given: Mapping[str, float]) -> dict[str, float]:
        if name not in functions:
            return {}
        function = functions[name]
        values = {p.name: given.get(p.name, 0.0) for p in function.inputs if p.default is None}
        return evaluate(function, values, FLOAT64)

    joints |= call("inverse", joints | wanted | call("limit_twist", wanted))
    joints |= call("desaturate", joints)
    return call("forward", joints)
