"""Bounds in words, for the header of the generated C."""

from __future__ import annotations

from wmrgen.bounds.assumptions import Library, Range
from wmrgen.bounds.robot import SINGULAR, Bounds, FunctionBound, OutputBound


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
    if any(o.from_length for f in bounds.functions for o in f.outputs):
        under += " h is the speed [m/s] of the pivot of a steered wheel; where it vanishes, the angle is not defined."
    lines = [under]
    for f in bounds.functions:
        lines += _of_function(f)
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


def _of_function(f: FunctionBound) -> list[str]:
    if f.unknown:
        return [f"  {f.name}: nothing, for no range is known of {', '.join(f.unknown)}"]
    if f.alarms:
        return [f"  {f.name}: not proved ({'; '.join(f.alarms)})"]
    groups: dict[tuple[str, str], list[OutputBound]] = {}
    for o in f.outputs:
        key = "" if o.singular else o.name.rpartition(".")[2], bound(o)
        groups.setdefault(key, []).append(o)
    return [f"  {f.name}: {', '.join(o.name for o in group)} {bound(group[0])}" for group in groups.values()]


def bound(o: OutputBound) -> str:
    """``in [-2, 2] m/s, off by 1.2e-07``."""
    if o.singular:
        return f"has no bound: {SINGULAR}"
    return f"in [{o.low:.6g}, {o.high:.6g}] {o.unit or '1'}, off by {error(o)}"


def error(o: OutputBound) -> str:
    """The bound of the error, rounded up to two digits."""
    if not o.from_length:
        return rounded_up(o.error)
    where = f"h >= {rounded_up(o.from_length)}"
    if not o.per_length:
        return f"{rounded_up(o.error)} where {where}"
    return f"{rounded_up(o.error)} + {rounded_up(o.per_length)}/h where {where}"


def rounded_up(value: float) -> str:
    """Two digits, not below ``value``."""
    if not value:
        return "0"
    text = f"{value:.1e}"
    if float(text) < value:
        mantissa, exponent = text.split("e")
        text = f"{float(mantissa) + 0.1:.1f}e{exponent}"
    return text
