"""Proved ranges and rounding errors of a robot's functions, and what they were proved under."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from typing import Any, NamedTuple

import numpy as np

from wmrgen.analysis.kinematics.ranges import steering_spin
from wmrgen.geometry.exact.interval import outside
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.ports import overshot
from wmrgen.ir.bounds.analysis import Claim, Outcomes, analysed
from wmrgen.ir.bounds.assumptions import LIBM, Domain, Library, Range, domain
from wmrgen.ir.bounds.patterns import SMALL_ANGLE
from wmrgen.ir.calls import hand_through, inline_prepare, inlined_calls
from wmrgen.ir.nodes import Function, Module

SINGULAR = "its formula is singular within the limits: a divisor comes close to zero"
TIES = (
    "Where two headings are equally near, or a wheel at its stop is about to turn back, rounding decides which is "
    "taken: either is right, and the error is that of the one taken."
)
_NOTHING = 1e-100  # below every float: what the arithmetic of bounds leaves of zero


class OutputBound(NamedTuple):
    """The float result lies in [low, high] and within ``error`` + ``per_length`` / h of the exact formula.

    The formula is decided as the float code decides it: at a tie either branch is right, the error that of the taken.
    h is the length of the shortest vector whose direction the output depends on, as the speed [m/s] of the pivot of
    a steered wheel; the error is claimed where h >= ``from_length``. Both are 0 where there is no such vector.
    ``singular``: nothing of this is claimed, for a divisor in the formula comes close to zero within the limits.
    """

    name: str
    unit: str
    low: float
    high: float
    error: float
    per_length: float
    from_length: float
    singular: bool = False


class FunctionBound(NamedTuple):
    """One function: ``inputs`` by name, ``outputs``, what could not be shown (``alarms``), inputs without range."""

    name: str
    inputs: dict[str, Range]
    outputs: tuple[OutputBound, ...]
    alarms: tuple[str, ...]
    unknown: tuple[str, ...] = ()

    @property
    def proved(self) -> bool:
        return not self.alarms and not self.unknown


class Bounds(NamedTuple):
    """All functions of a robot in one floating-point type, with ``library`` for sines and arctangents.

    ``missing``: limits that the robot file must have; ``assumed``: ranges of inputs that it does not limit.
    """

    library: Library
    missing: tuple[str, ...]
    declared: dict[str, Range]
    assumed: dict[str, Range]
    functions: tuple[FunctionBound, ...]

    @property
    def steers(self) -> bool:
        """Whether an output depends on the direction of a vector that may vanish."""
        return any(o.from_length for f in self.functions for o in f.outputs)


def bounds(robot: Robot, module: Module, library: Library) -> Bounds:
    """The bounds of every C function of ``module`` in float; no function where needed limits are missing."""
    where = domain(robot)
    missing = where.missing()
    if missing:
        return Bounds(library, missing, where.declared, {}, ())
    proved: list[FunctionBound] = []
    assumed: dict[str, Range] = {}
    printed = functions(module)
    outcomes = Outcomes(printed, library)
    for function in printed:
        bound = _function(function, where, outcomes)
        proved.append(bound)
        assumed |= {name: r for name, r in bound.inputs.items() if name not in where.declared}
    return Bounds(library, (), where.declared, assumed, tuple(proved))


def functions(module: Module) -> list[Function]:
    """The functions as they are printed, each with its part of prepare()."""
    printed = hand_through(inlined_calls(module))
    return [inline_prepare(f, printed.prepare) for f in printed.functions if f.outputs]


def reach(robot: Robot, module: Module, limits: Mapping[str, Range]) -> dict[str, Range]:
    """Component of the twist -> what `forward` of ``module`` gives while every joint keeps its overshot ``limits``.

    What it gives as 0 whatever the joints do is left out, and what is not bounded: a joint has no limits, or the
    formula is singular within them.
    """
    measured = Domain(robot, {name: outside(*overshot(*limit)) for name, limit in limits.items()})
    for function in functions(
        replace(module, functions=tuple(f for f in module.functions if f.name == "forward"))
    ):
        ranges, unknown = measured.of(function)
        outcome = None if unknown else analysed(function, ranges, LIBM)
        if outcome is not None and not outcome.alarms:
            claims = zip(function.outputs, outcome.claims, strict=True)
            bounded = ((p.name, c) for p, c in claims if not c.singular)
            return {name: (_up(c.low, -1), _up(c.high)) for name, c in bounded if c.low < c.high}
    return {}


def _function(function: Function, where: Domain, outcomes: Outcomes) -> FunctionBound:
    ranges, unknown = where.of(function)
    if unknown:
        return FunctionBound(function.name, ranges, (), (), tuple(unknown))
    outcome = outcomes.of(function, ranges)
    outputs = tuple(
        _output(claim, port.name, port.unit)
        for port, claim in zip(function.outputs, outcome.claims, strict=True)
    )
    if function.name == "inverse":
        where.commanded.update({o.name: (o.low, o.high) for o in outputs})
        _add_steering(where)
    alarms = tuple(dict.fromkeys(f"{function.nodes[i].op}: {what}" for i, what in outcome.alarms))
    return FunctionBound(function.name, ranges, outputs, alarms)


def _add_steering(where: Domain) -> None:
    """`steer_toward` commands steering rates that `inverse` leaves at 0, and adds to spins what they take."""
    for w in where.robot.wheels:
        spin, rate = f"{w.name}.spin", f"{w.name}.steer_rate"
        if w.rolls_when_steered and rate in where.commanded:
            del where.commanded[rate]
            low, high = where.commanded[spin]
            share = _up(float(steering_spin(where.robot, w) or 0))
            where.commanded[spin] = low - share, high + share


def _output(claim: Claim, name: str, unit: str) -> OutputBound:
    return OutputBound(
        name, unit, _up(claim.low, -1), _up(claim.high), _up(claim.error), _up(claim.per_length),
        _up(SMALL_ANGLE * claim.length_error), claim.singular,
    )  # fmt: skip


def _up(value: float, sign: int = 1) -> float:
    """``value`` away from minus infinity (``sign`` 1) or plus infinity, to six digits; what rounds to zero is zero."""
    value = float(value)
    if not np.isfinite(value):
        return value
    if abs(value) < _NOTHING:
        return 0.0
    value += sign * abs(value) * 1e-9  # whatever the last place on a processor, the digits are the same
    return float(Context(6, ROUND_CEILING if sign > 0 else ROUND_FLOOR).create_decimal_from_float(value))


def data(result: Bounds) -> dict[str, Any]:
    """The bounds as plain data: what model.json and `wmrgen prove --json` hold."""
    return {
        "scalar": "float",
        "library": {"name": result.library.name, **result.library.table()},
        "limits": {name: list(r) for name, r in result.declared.items()},
        "assumed": {name: list(r) for name, r in result.assumed.items()},
        "functions": {f.name: _data(f, result) for f in result.functions},
    }


def _data(f: FunctionBound, result: Bounds) -> dict[str, Any]:
    if f.unknown:
        return {"proved": False, "no_range": list(f.unknown)}
    return {
        "proved": f.proved,
        **({"inputs": {n: list(r) for n, r in wider.items()}} if (wider := beyond(f, result)) else {}),
        **({"not_shown": list(f.alarms)} if f.alarms else {}),
        "outputs": {o.name: _output_data(o) for o in f.outputs},
    }


def _output_data(o: OutputBound) -> dict[str, Any]:
    if o.singular:
        return {"no_bound": SINGULAR}
    return {
        "range": [o.low, o.high],
        "error": o.error,
        **({"error_per_speed": o.per_length} if o.per_length else {}),
        **({"from_speed": o.from_length} if o.from_length else {}),
    }


# ---- in words, for the header of generated C


def header_lines(bounds: Bounds) -> tuple[str, ...]:
    """What is proved, under which limits, and a line per kind of output; nothing without limits."""
    if bounds.missing:
        return ()
    library = bounds.library
    under = f"Proved for {listed(bounds.declared)}"
    if bounds.assumed:
        under += f", and with these ranges of inputs that have no limits: {listed(bounds.assumed)}"
    under += (
        ": no division by zero, no NaN, no infinity; results in the ranges below; and off the exact formula, by "
        f"rounding, at most as stated ({described(library)})."
    )
    if bounds.steers:
        under += (
            " speed is that of the pivot of a steered wheel [m/s]; where it is 0, the angle is not defined."
        )
        under += f" {TIES}"
    lines = [under]
    for f in bounds.functions:
        lines += _of_function(f, bounds)
    return tuple(lines)


def described(library: Library) -> str:
    """What the bounds rest on."""
    if library.circle:
        return (
            f"its own sines within {library.sin:g} * 2**-24 up to {library.reach:g} rad, arctangents within "
            f"{library.atan:g} units in the last place"
        )
    return (
        f"sin, cos and atan2 of the C library within {library.sin:g}, {library.cos:g} and "
        f"{library.atan2:g} units in the last place"
    )


def listed(ranges: dict[str, Range]) -> str:
    """Ranges by name, equal ones of one joint together: ``|left.spin, right.spin| <= 40``."""
    groups: dict[tuple[str, Range], list[str]] = {}
    for name, r in ranges.items():
        groups.setdefault((name.rpartition(".")[2] if "." in name else name, r), []).append(name)
    return ", ".join(limit(", ".join(names), r) for (_, r), names in groups.items())


def limit(names: str, r: Range) -> str:
    low, high = r
    return f"|{names}| <= {high:.6g}" if low == -high else f"{low:.6g} <= {names} <= {high:.6g}"


def beyond(f: FunctionBound, bounds: Bounds) -> dict[str, Range]:
    """The ranges of inputs that a function takes beyond their limits."""
    return {name: r for name, r in f.inputs.items() if bounds.declared.get(name, r) != r}


def _of_function(f: FunctionBound, bounds: Bounds) -> list[str]:
    if f.unknown:
        return [f"  {f.name}: nothing, for no range is known of {', '.join(f.unknown)}"]
    if f.alarms:
        return [f"  {f.name}: not proved ({'; '.join(f.alarms)})"]
    groups: dict[tuple[str, str], list[OutputBound]] = {}
    for o in f.outputs:
        key = "" if o.singular else o.name.rpartition(".")[2], bound(o)
        groups.setdefault(key, []).append(o)
    wider = beyond(f, bounds)
    head = [f"  {f.name} is looked at for {listed(wider)}"] if wider else []
    return head + [
        f"  {f.name}: {', '.join(o.name for o in group)} {bound(group[0])}" for group in groups.values()
    ]


def bound(o: OutputBound) -> str:
    """``in [-2, 2] m/s, off by 1.2e-07``."""
    if o.singular:
        return f"has no bound: {SINGULAR}"
    return f"in [{o.low:.6g}, {o.high:.6g}] {o.unit or '1'}, off by {error(o)}"


def error(o: OutputBound) -> str:
    """The bound of the error, rounded up to two digits; speed is what it depends on."""
    if not o.from_length:
        return rounded_up(o.error)
    where = f"speed >= {rounded_up(o.from_length)}"
    if not o.per_length:
        return f"{rounded_up(o.error)} where {where}"
    return f"{rounded_up(o.error)} + {rounded_up(o.per_length)}/speed where {where}"


def rounded_up(value: float) -> str:
    """Two digits, not below ``value``."""
    if not value:
        return "0"
    text = f"{value:.1e}"
    if float(text) < value:
        mantissa, exponent = text.split("e")
        text = f"{float(f'{float(mantissa) + 0.1:.1f}e{exponent}'):.1e}"
    return text
