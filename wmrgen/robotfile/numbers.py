"""Read the numbers of robot files exactly, and their units.

The numbers of YAML are not used: to PyYAML ``1e-3`` is a string, ``1:30`` is 90 and ``012`` is 10.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from enum import StrEnum
from fractions import Fraction
from typing import NamedTuple

from wmrgen.robotfile.text import Scalar, quoted, suggestion

NUMBER = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
MAX_DIGITS = 40  # of a number; twice those of a float64, so that no measured value is refused
MAX_EXPONENT = 30  # of ten; 1e-30 to 1e30 m is beyond every robot, and stays within a float32

_SIGNED = re.compile(rf"[+-]?{NUMBER}")
_WITH_UNIT = re.compile(rf"([+-]?{NUMBER})[ \t]*([A-Za-zµμ°π_\"][A-Za-z0-9_/µμ°\"]*(?:(?<=/s)(?:\^2|²))?)")
_NOT_FINITE = re.compile(r"[+-]?\.?(?:nan|inf|infinity)", re.IGNORECASE)


class Kind(StrEnum):
    """The kind of quantity that a key measures. Comments give the SI unit that wmrgen computes in."""

    LENGTH = "length"  # m
    ANGLE = "angle"  # rad
    SPEED = "speed"  # m/s
    RATE = "angular rate"  # rad/s
    ACCELERATION = "acceleration"  # m/s^2
    ANGULAR_ACCELERATION = "angular acceleration"  # rad/s^2
    TIME = "time"  # s
    ANY = "parameter"


class Unit(NamedTuple):
    """A unit of measurement."""

    kind: Kind
    factor: Fraction  # SI units in one of this unit
    pi: bool = False  # whether the factor is multiplied by pi


def _unit(kind: Kind, factor: str, pi: bool = False) -> Unit:
    return Unit(kind, Fraction(factor), pi)


UNITS: dict[str, Unit] = {
    "m": _unit(Kind.LENGTH, "1"),
    "mm": _unit(Kind.LENGTH, "1/1000"),
    "cm": _unit(Kind.LENGTH, "1/100"),
    "um": _unit(Kind.LENGTH, "1/1000000"),
    "km": _unit(Kind.LENGTH, "1000"),
    "in": _unit(Kind.LENGTH, "0.0254"),
    "ft": _unit(Kind.LENGTH, "0.3048"),
    "rad": _unit(Kind.ANGLE, "1"),
    "deg": _unit(Kind.ANGLE, "1/180", True),
    "m/s": _unit(Kind.SPEED, "1"),
    "cm/s": _unit(Kind.SPEED, "1/100"),
    "mm/s": _unit(Kind.SPEED, "1/1000"),
    "km/h": _unit(Kind.SPEED, "5/18"),
    "rad/s": _unit(Kind.RATE, "1"),
    "deg/s": _unit(Kind.RATE, "1/180", True),
    "rpm": _unit(Kind.RATE, "1/30", True),
    "m/s^2": _unit(Kind.ACCELERATION, "1"),
    "rad/s^2": _unit(Kind.ANGULAR_ACCELERATION, "1"),
    "deg/s^2": _unit(Kind.ANGULAR_ACCELERATION, "1/180", True),
    "s": _unit(Kind.TIME, "1"),
    "ms": _unit(Kind.TIME, "1/1000"),
}
_SPELLINGS = {"µm": "um", "μm": "um", "°": "deg", "°/s": "deg/s"}
for _unit_per_second in ("m/s", "rad/s", "deg/s"):
    _SPELLINGS |= dict.fromkeys((f"{_unit_per_second}2", f"{_unit_per_second}²"), f"{_unit_per_second}^2")
_ALIASES = {
    **dict.fromkeys(('"', "inch", "inches"), "Write in for inches."),
    **dict.fromkeys(("degree", "degrees", "degs", "grad"), "Write deg for degrees."),
    **dict.fromkeys(("radian", "radians", "rads"), "Write rad for radians."),
    **dict.fromkeys(("meter", "meters", "metre", "metres"), "Write m for metres."),
    **dict.fromkeys(("foot", "feet"), "Write ft for feet."),
    **dict.fromkeys(("rev/s", "rps", "hz", "turns/s"), "Write rpm: 60 rpm are one turn per second."),
    **dict.fromkeys(("rev/min", "r/min"), "Write rpm."),
}


def units_of(kind: Kind) -> list[str]:
    """Return the names of the units of a kind; for ANY, of all units."""
    return [name for name, unit in UNITS.items() if kind in (unit.kind, Kind.ANY)]


def spellings_of(kind: Kind) -> list[str]:
    """Return the units of a kind in all spellings that robot files may have."""
    own = units_of(kind)
    return own + [word for word, unit in _SPELLINGS.items() if unit in own]


def number(text: str, node: Scalar, offset: int = 0) -> Fraction:
    """Return the exact value of a number.

    Args:
        text: A NUMBER with an optional sign.
        node: The node that has the number, for the place of errors.
        offset: The character of the node where the number begins.

    Raises:
        RobotFileError: The number begins with 0 as an octal number, has too many digits, or has too large an exponent.
    """
    mantissa, _, exponent = text.lower().partition("e")
    digits = mantissa.lstrip("+-")
    if len(digits) > 1 and digits[0] == "0" and digits[1].isdigit():
        raise node.error(
            f"the number {quoted(text)} begins with 0",
            "YAML 1.1 reads such a number as octal.",
            f"Write {mantissa[: len(mantissa) - len(digits)]}{digits.lstrip('0') or '0'}.",
            offset,
        )
    if len(digits) > MAX_DIGITS:
        raise node.error(
            f"a number with more than {MAX_DIGITS} digits", "Numbers are read exactly.", "Round it.", offset
        )
    power = exponent.lstrip("+-").lstrip("0") or "0"
    if len(power) > 3 or int(power) > MAX_EXPONENT:
        raise node.error(
            f"the exponent of {quoted(text)} is out of range",
            f"Exponents are from -{MAX_EXPONENT} to {MAX_EXPONENT}.",
            "Write a number of a usual size.",
            offset,
        )
    return Fraction(mantissa) * Fraction(10) ** (-int(power) if exponent.startswith("-") else int(power))


def refuse_lookalikes(node: Scalar) -> None:
    """Raise RobotFileError for a text that YAML or people read as a number, and robot files do not."""
    text = node.text.strip()
    if _NOT_FINITE.fullmatch(text):
        raise node.error(
            f"{quoted(text)} is not a finite number", "Quantities are finite.", "Write the value."
        )
    for pattern, what, instead in (
        (r"[+-]?\d+(:[\d.]+)+", "is not a number (YAML 1.1 reads it in base 60)", "Write a decimal number."),
        (r"[+-]?[0-9.]+,[0-9]+", "has a decimal comma", "Write a decimal point."),
        (r"[+-]?0[xobXOB][0-9a-fA-F_]+", "is not decimal", "Write a decimal number."),
        (r"[+-]?[0-9][0-9_.]*_[0-9_.eE]*", "has underscores", "Write the digits without them."),
        ("~|(?i:null|none|true|false)", "is not a number", "Write the number, or delete the key."),
    ):
        if re.fullmatch(pattern, text):
            raise node.error(f"{quoted(text)} {what}", "", instead)


def plain_number(
    node: Scalar, names: Collection[str] = (), kind: Kind = Kind.ANY
) -> tuple[Fraction, Unit | None] | None:
    """Return the value and the unit of a node that is a number, or a number with a unit.

    Args:
        node: The node to read.
        names: Names of parameters. A number before one of them is an expression, not a number with a unit.
        kind: The kind of quantity whose units are suggested if the unit is unknown.

    Returns:
        Value and unit (None if there is no unit), or None if the node is something else.

    Raises:
        RobotFileError: The word after the number is not a unit.
    """
    text = node.text.strip()
    if _SIGNED.fullmatch(text):
        return number(text, node), None
    match = _WITH_UNIT.fullmatch(text)
    if not match:
        return None
    digits, name = match.groups()
    unit = UNITS.get(_SPELLINGS.get(name, name))
    if unit:
        return number(digits, node), unit
    if name.partition("/")[0] in ("pi", "π", *names):
        return None
    raise node.error(
        f"{quoted(name)} is not a unit",
        "A number is followed by a unit or an operator.",
        suggestion(name, units_of(kind), _ALIASES),
        node.text.index(name, node.text.index(digits) + len(digits)),
    )
