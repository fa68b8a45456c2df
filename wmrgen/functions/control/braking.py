"""How fast a quantity may change that has one limit for speeding up and another one for braking.

A limit [low, high] of a rate lets the size of the quantity grow by ``high`` and shrink by -``low`` per second,
whichever way it goes. A step of dt that passes through zero brakes first and speeds up after it: with x the size now
if the step goes towards zero, else 0, it may go as far as

    D = -low dt                       while that does not reach zero
    D = x + high (dt - x / -low)      beyond

so that D / dt = max(-low, high + (1 + high / low) x / dt), or min where braking is the faster of both.
"""

from __future__ import annotations

import sympy

from wmrgen.analysis.kinematics.records import Locals
from wmrgen.geometry.exact.number import ONE
from wmrgen.geometry.layout.records import Interval
from wmrgen.geometry.symbolic import Expr, absolute, add, maximum, minimum, number, select, times


def rate_limit(
    limit: Interval, now: Expr, change: Expr, per_step: Expr | None, names: Locals, name: str
) -> Expr:
    """Return how fast a quantity may change in this step, in either direction, per second.

    Args:
        limit: of the rate; -``low`` holds for braking, ``high`` for speeding up, both above 0 in size.
        now: the quantity.
        change: where it shall go, of the same sign as the step.
        per_step: 1 / dt [1/s]; may be None where the limit is symmetric.
        names: takes the intermediate results.
        name: what they are called after.
    """
    faster, slower = limit.high, -limit.low
    if faster == slower:
        return number(faster)
    assert per_step is not None
    ahead = names.define(
        f"{name}_ahead", select(times(now, change), sympy.S.Zero, absolute(now), sympy.S.Zero)
    )
    mixed = add(number(faster), times(number(ONE - faster / slower), per_step, ahead))
    better = minimum if slower > faster else maximum
    return names.define(f"{name}_limit", better(number(slower), mixed))
