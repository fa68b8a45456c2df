"""Proved ranges and rounding errors of a robot's functions, and the assumptions of the proof."""

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
from wmrgen.ir.calls import inline_prepare, inlined_calls, pass_geometry_through_prepare
from wmrgen.ir.nodes import Function, Module

SINGULAR = "its formula is singular within the limits: a divisor comes close to zero"
TIES = (
    "If two headings are equally near, or a wheel at its stop is about to turn back, rounding decides which one is "
    "taken. Either is correct, and the error is that of the one taken."
)
_NOTHING = 1e-100  # smaller numbers are printed as 0: the outward rounding of a bound that is exactly 0


class OutputBound(NamedTuple):
    """The bounds of one output: its float result is in [low, high], and near the result of the exact formula.

    At a tie the exact formula takes the same branch as the float code.
    """

    name: str
    unit: str
    low: float  # [unit]
    high: float  # [unit]
    # The error is at most error + per_length / h where h >= from_length. h is the length of the shortest vector whose
    # direction the output depends on, such as the speed [m/s] of the pivot of a steered wheel. per_length and
    # from_length are 0 if there is no such vector.
    error: float  # [unit]
    per_length: float  # [unit of the vector times unit]
    from_length: float  # [unit of the vector]
    singular: bool = False  # a divisor comes close to zero within the limits, so that no error is claimed


class FunctionBound(NamedTuple):
    """The bounds of one function."""

    name: str
    inputs: dict[str, Range]  # by name, in the input's unit
    outputs: tuple[OutputBound, ...]
    # "operation: what may happen", for each operation that was not shown to be defined.
    alarms: tuple[str, ...]
    unknown: tuple[str, ...] = ()  # inputs without a range

    @property
    def proved(self) -> bool:
        """Return whether every operation is defined within the ranges of the inputs."""
        return not self.alarms and not self.unknown


class Bounds(NamedTuple):
    """The bounds of all functions of a robot in float32."""

    library: Library  # errors of sines and arctangents
    missing: tuple[str, ...]  # limits that the robot file needs; without them ``functions`` is empty
    declared: dict[str, Range]  # limits of the robot file, by input name
    assumed: dict[str, Range]  # ranges of inputs without limits, by input name
    functions: tuple[FunctionBound, ...]

    @property
    def steers(self) -> bool:
        """Return whether an output depends on the direction of a vector that may vanish."""
        return any(o.from_length for f in self.functions for o in f.outputs)


def bounds(robot: Robot, module: Module, library: Library) -> Bounds:
    """Bound every C function of a robot in float32.

    Args:
        robot: the robot, whose limits bound the inputs.
        module: its functions.
        library: the errors of sines and arctangents.

    Returns:
        The bounds; without functions if limits are missing.
    """
    where = domain(robot)
    missing = where.missing()
    if missing:
        return Bounds(library, missing, where.declared, {}, ())
    proved: list[FunctionBound] = []
    assumed: dict[str, Range] = {}
    printed = functions(module)
    outcomes = Outcomes(printed, library)
    for function in printed:
        bound = _function_bound(function, where, outcomes)
        proved.append(bound)
        assumed |= {name: r for name, r in bound.inputs.items() if name not in where.declared}
    return Bounds(library, (), where.declared, assumed, tuple(proved))


def functions(module: Module) -> list[Function]:
    """Return the functions as they are printed, each with its part of prepare() and without calls."""
    printed = pass_geometry_through_prepare(inlined_calls(module))
    return [inline_prepare(f, printed.prepare) for f in printed.functions if f.outputs]


def reach(robot: Robot, module: Module, limits: Mapping[str, Range]) -> dict[str, Range]:
    """Bound the twist that `forward` computes while every joint is within its limits.

    Args:
        robot: the robot.
        module: its functions.
        limits: (low, high) by joint; joints may overshoot them (`wmrgen.geometry.ports.overshot`).

    Returns:
        (low, high) by component of the twist [m/s, rad/s]. Components that are always 0 are left out, and those without
        a bound, because a joint has no limits or the formula is singular within them.
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
            return {
                name: (rounded_outward(c.low, -1), rounded_outward(c.high))
                for name, c in bounded
                if c.low < c.high
            }
    return {}


def _function_bound(function: Function, where: Domain, outcomes: Outcomes) -> FunctionBound:
    """Bound one function; the results of `inverse` become ranges of later functions in ``where``."""
    ranges, unknown = where.of(function)
    if unknown:
        return FunctionBound(function.name, ranges, (), (), tuple(unknown))
    outcome = outcomes.of(function, ranges)
    outputs = tuple(
        output_bound(claim, port.name, port.unit)
        for port, claim in zip(function.outputs, outcome.claims, strict=True)
    )
    if function.name == "inverse":
        where.commanded.update({o.name: (o.low, o.high) for o in outputs})
        _add_steering(where)
    alarms = tuple(dict.fromkeys(f"{function.nodes[i].op}: {what}" for i, what in outcome.alarms))
    return FunctionBound(function.name, ranges, outputs, alarms)


def _add_steering(where: Domain) -> None:
    """Widen commanded spins by the spin that steering takes, for wheels that roll when they are steered.

    `inverse` commands no steering rate for these wheels, but `steer_toward` does.
    """
    for w in where.robot.wheels:
        spin, rate = f"{w.name}.spin", f"{w.name}.steer_rate"
        if w.rolls_when_steered and rate in where.commanded:
            del where.commanded[rate]
            low, high = where.commanded[spin]
            share = rounded_outward(float(steering_spin(where.robot, w) or 0))
            where.commanded[spin] = low - share, high + share


def output_bound(claim: Claim, name: str, unit: str) -> OutputBound:
    """Return a claim as the bounds of an output, rounded outward to six digits.

    Args:
        claim: the claim.
        name: the output's name.
        unit: the output's unit.

    Returns:
        The bounds that are printed.
    """
    return OutputBound(
        name,
        unit,
        low=rounded_outward(claim.low, -1),
        high=rounded_outward(claim.high),
        error=rounded_outward(claim.error),
        per_length=rounded_outward(claim.per_length),
        from_length=rounded_outward(SMALL_ANGLE * claim.length_error),
        singular=claim.singular,
    )


def rounded_outward(value: float, sign: int = 1) -> float:
    """Return ``value`` to six digits, rounded up (``sign`` 1) or down (-1); values below 1e-100 become zero."""
    value = float(value)
    if not np.isfinite(value):
        return value
    if abs(value) < _NOTHING:
        return 0.0
    # The digits must not depend on the last bit, which depends on the processor.
    value += sign * abs(value) * 1e-9
    return float(Context(6, ROUND_CEILING if sign > 0 else ROUND_FLOOR).create_decimal_from_float(value))


def data(result: Bounds) -> dict[str, Any]:
    """Return the bounds as plain data, for model.json and `wmrgen prove --json`."""
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
    """Return what is proved, under which limits, and a line for each kind of output; nothing without limits."""
    if bounds.missing:
        return ()
    library = bounds.library
    under = f"Proved for {listed(bounds.declared)}"
    if bounds.assumed:
        under += f", and with these ranges of inputs that have no limits: {listed(bounds.assumed)}"
    under += (
        ": no division by zero, no NaN, no infinity. Results are in the ranges below, and off the exact formula, by "
        f"rounding, at most as stated ({described(library)})."
    )
    if bounds.steers:
        under += " In errors, speed is that of the pivot of a steered wheel [m/s]. At speed 0 the angle is not defined."
        under += f" {TIES}"
    lines = [under]
    for f in bounds.functions:
        lines += _of_function(f, bounds)
    return tuple(lines)


def described(library: Library) -> str:
    """Return the assumed errors of sines and arctangents in words."""
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
    """Return ranges as text, joints of the same kind and range together: ``|left.spin, right.spin| <= 40``."""
    groups: dict[tuple[str, Range], list[str]] = {}
    for name, r in ranges.items():
        groups.setdefault((name.rpartition(".")[2] if "." in name else name, r), []).append(name)
    return ", ".join(limit(", ".join(names), r) for (_, r), names in groups.items())


def limit(names: str, r: Range) -> str:
    """Return one range as text: ``|vx| <= 2`` or ``-2 <= vx <= 1.5``."""
    low, high = r
    return f"|{names}| <= {high:.6g}" if low == -high else f"{low:.6g} <= {names} <= {high:.6g}"


def beyond(f: FunctionBound, bounds: Bounds) -> dict[str, Range]:
    """Return the ranges of inputs that are larger than the declared limits."""
    return {name: r for name, r in f.inputs.items() if bounds.declared.get(name, r) != r}


def _of_function(f: FunctionBound, bounds: Bounds) -> list[str]:
    if f.unknown:
        return [f"  {f.name}: not bounded, because {', '.join(f.unknown)} has no range"]
    if f.alarms:
        return [f"  {f.name}: not proved ({'; '.join(f.alarms)})"]
    groups: dict[tuple[str, str], list[OutputBound]] = {}
    for o in f.outputs:
        key = "" if o.singular else o.name.rpartition(".")[2], bound(o)
        groups.setdefault(key, []).append(o)
    wider = beyond(f, bounds)
    head = [f"  {f.name} is looked at for {listed(wider)}"] if wider else []
    lines = []
    for group in groups.values():
        names = ", ".join(o.name for o in group)
        lines.append(f"  {f.name}: {names} {bound(group[0])}")
    return head + lines


def bound(o: OutputBound) -> str:
    """Return the bounds of an output as text: ``in [-2, 2] m/s, off by 1.2e-07``."""
    if o.singular:
        return f"has no bound: {SINGULAR}"
    return f"in [{o.low:.6g}, {o.high:.6g}] {o.unit or '1'}, off by {error(o)}"


def error(o: OutputBound) -> str:
    """Return the bound of the error as text, rounded up to two digits, in terms of the speed if it depends on one."""
    if not o.from_length:
        return rounded_up(o.error)
    where = f"speed >= {rounded_up(o.from_length)}"
    if not o.per_length:
        return f"{rounded_up(o.error)} where {where}"
    return f"{rounded_up(o.error)} + {rounded_up(o.per_length)}/speed where {where}"


def rounded_up(value: float) -> str:
    """Return ``value`` as text, rounded up to two digits."""
    if not value:
        return "0"
    text = f"{value:.1e}"
    if float(text) < value:
        mantissa, exponent = text.split("e")
        text = f"{float(f'{float(mantissa) + 0.1:.1f}e{exponent}'):.1e}"
    return text
