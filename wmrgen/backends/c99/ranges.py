"""What a checked function accepts, and what its outputs are where it accepts nothing."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from wmrgen.backends.c99.literal import literal
from wmrgen.exact.number import Exact
from wmrgen.ir.nodes import Function, Limits, Port, Role
from wmrgen.ir.site import Site
from wmrgen.selftest.rounding_bounds import LARGEST_ANGLE

OVERSHOOT = 1.25  # of what is measured: a joint that stands at its limit must not stop the robot
LARGEST = {"float": 1e9, "double": 1e100}
# A step of odometry turns by no more than an angle that the kernels take: omega dt <= 2000 rad.
_TURNING = {"float": {"omega": 200.0, "dt": 10.0}, "double": {"omega": 1e6, "dt": 1e2}}
_TWIST = ("vx", "vy", "omega")


@dataclass(frozen=True, slots=True)
class Range:
    """An input: accepted from ``low`` to ``high``, as C writes them."""

    port: Port
    low: str
    high: str


@dataclass(frozen=True, slots=True)
class Safe:
    """An output where nothing was accepted: the input of the same name where ``held``, else 0, inside ``limit``."""

    port: Port
    held: bool
    limit: tuple[str, str] | None


def ranges(function: Function, scalar: str, site: Site) -> tuple[Range, ...]:
    """The accepted range of every contract input of ``function``.

    A commanded twist keeps its declared limits, what is measured may be `OVERSHOOT` as far from their middle;
    everything else, and what has no limits, only has to be of a size that gives finite results.
    """
    ports = (port for port in function.inputs if port.role in (Role.STATE, Role.COMMAND))
    return tuple(_range(port, function.limits, scalar, site) for port in ports)


def _range(port: Port, limits: Limits, scalar: str, site: Site) -> Range:
    size = _TURNING[scalar].get(port.name) or (LARGEST_ANGLE if port.unit == "rad" else LARGEST)[scalar]
    low, high = -size, size
    if port.name in site.limits and limits is not Limits.NONE:
        low, high = site.limits[port.name]
        if port.name not in _TWIST or limits is Limits.MEASURED:
            middle, half = (low + high) / 2, OVERSHOOT * (high - low) / 2
            low, high = middle - half, middle + half
    return Range(port, _number(low, scalar), _number(high, scalar))


def safe(function: Function, scalar: str, site: Site) -> tuple[Safe, ...]:
    """What each output is when an input is refused: positions and angles are held, everything else is 0."""
    given = {port.name for port in function.inputs if port.unit in ("m", "rad")}
    found = []
    for port in function.outputs:
        limit = site.limits.get(port.name) if port.unit == "rad" else None
        text = (_number(limit[0], scalar), _number(limit[1], scalar)) if limit else None
        found.append(Safe(port, port.name in given, text))
    return tuple(found)


def _number(value: float, scalar: str) -> str:
    """``value`` as a C literal, negative ones without parentheses; large sizes as 1e9."""
    power = f"{value:.0e}".replace("e+0", "e").replace("e+", "e")
    end = "f" if scalar == "float" else ""
    if abs(value) >= 1e4 and float(power) == value:
        return power + end
    return literal(Exact(Fraction(value)), scalar).strip("()") if value else "0.0" + end
