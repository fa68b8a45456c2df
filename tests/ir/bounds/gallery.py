"""The robots of the gallery with their bounds; robots without limits get some here."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from pathlib import Path

import wmrgen
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.records import Interval
from wmrgen.ir.bounds.robot import Bounds, FunctionBound, functions
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Function

ROBOTS = sorted((Path(__file__).parents[3] / "robots").glob("*.yaml"))
NAMES = [p.stem for p in ROBOTS]
# The sines of a C library, because the tests compare with correctly rounded ones.
LIBM_C = Choice("float", "libm")
_OTHERWISE = {"vx": Fraction(2), "omega": Fraction(3), "steer_rate": Fraction(5)}
# The limit of the virtual front wheel, whose models are singular at 90 degrees.
_OF_ROBOTS = {"car_with_trailers": {"steer": Fraction(1)}}


@dataclass(frozen=True)
class Proved:
    """A robot, its functions as printed, and their bounds."""

    derivation: Derivation
    functions: dict[str, Function]
    bounds: Bounds

    @property
    def pairs(self) -> list[tuple[Function, FunctionBound]]:
        return [(self.functions[b.name], b) for b in self.bounds.functions if not b.unknown]


@lru_cache(maxsize=4)
def proved(name: str) -> Proved:
    robot = wmrgen.load(ROBOTS[NAMES.index(name)])
    chosen = _OTHERWISE | _OF_ROBOTS.get(name, {})
    limits = {n: Interval(Exact(-v), Exact(v)) for n, v in chosen.items()} | robot.limits
    derivation = wmrgen.derive(replace(robot, limits=limits))
    return Proved(
        derivation, {f.name: f for f in functions(derivation.c_module)}, derivation.bounds_of(LIBM_C)
    )
