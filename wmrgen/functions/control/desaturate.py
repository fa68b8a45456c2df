"""`desaturate`: one factor for all joint rates, so that every wheel keeps its speed limit and the path stays.

Steering angles depend on the direction of the twist alone, joint rates are proportional to its size: rates times k
drive the twist times k, along the same path, 1/k times as long.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import ONE
from wmrgen.functions.registry import function
from wmrgen.kinematics.records import Formula, Locals, joint_port
from wmrgen.layout.records import Interval, Robot, Wheel
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port, Role
from wmrgen.symbolic import Expr, maximum, minimum, number, signal, times


@dataclass(frozen=True, slots=True)
class _Rate:
    """A joint rate: what is asked of it, and what it may do (None: anything)."""

    wheel: Wheel
    joint: str
    limit: Interval | None

    @property
    def name(self) -> str:
        return f"{self.wheel.name}.{self.joint}"


@function("ours; the texts have none")
def desaturate(robot: Robot, _: Mobility) -> Formula:
    """Every ``<wheel>.spin`` (and ``<castor>.steer_rate``) that `inverse` commands, times one ``scale`` <= 1.

    scale = 1 / max(1, rate / limit over all limited joints). Castors that nothing drives turn along.
    """
    rates = _rates(robot)
    names = Locals()
    load: Expr = sympy.S.One
    for rate in rates:
        if rate.limit is not None:
            asked = signal(rate.name)
            for bound in (rate.limit.high, rate.limit.low):
                load = maximum(load, times(number(ONE / bound), asked))
    scale = names.define("scale", 1 / names.define("load", load))
    outputs = [(joint_port(r.wheel, r.joint, Role.COMMAND), _kept(r, scale)) for r in rates]
    outputs.append(
        (Port("scale", Role.COMMAND, "", "factor of all rates: 1 where every limit is kept"), scale)
    )
    inputs = tuple(joint_port(r.wheel, r.joint, Role.COMMAND) for r in rates)
    text = "joint rates to joint rates inside the speed limits, all times one factor"
    return Formula("desaturate", inputs, tuple(names.items), tuple(outputs), text)


def _kept(rate: _Rate, scale: Expr) -> Expr:
    """The scaled rate; cut at the limit, which rounding may pass by one unit in the last place."""
    scaled = times(scale, signal(rate.name))
    if rate.limit is None:
        return scaled
    below = minimum(number(rate.limit.high), scaled)
    return maximum(number(rate.limit.low), below)


def _rates(robot: Robot) -> list[_Rate]:
    rates = [_Rate(w, "spin", robot.limit(w, "spin")) for w in robot.wheels if w.has_spin]
    rates += [_Rate(w, "steer_rate", robot.limit(w, "steer_rate")) for w in robot.wheels if w.kind.swivels]
    missing = [
        r.wheel.name for r in rates if r.joint == "spin" and "spin" in r.wheel.actuated and not r.limit
    ]
    driven = [r for r in rates if r.joint == "spin" and "spin" in r.wheel.actuated]
    if not driven:
        raise NotDerivableError(f"{robot.name} has no desaturate: no wheel is driven")
    if missing:
        raise NotDerivableError(
            f"{robot.name} has no desaturate: {', '.join(missing)} {'has' if len(missing) == 1 else 'have'} no "
            "limit of spin; write limits: {spin: 40} [rad/s] for the robot or for each wheel"
        )
    for rate in rates:
        if rate.limit is not None and not (rate.limit.low.sign < 0 < rate.limit.high.sign):
            raise NotDerivableError(
                f"{robot.name} has no desaturate: the limits of {rate.name} leave no speed in one direction, "
                "and no factor brings a rate of the other sign inside"
            )
    return rates
