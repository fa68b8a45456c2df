"""Numbers as robot files write them, exact, and units.

YAML's own reading is not used: to PyYAML ``1e-3`` is a string, ``1:30`` is 90 and ``012`` is 10.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction

from wmrgen.errors import RobotFileError
from wmrgen.spec.nodes import Scalar
from wmrgen.spec.text import quoted, suggestion

NUMBER = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
MAX_DIGITS = 40
MAX_EXPONENT = 30

_SIGNED = re.compile(rf"[+-]?{NUMBER}")
_WITH_UNIT = re.compile(rf"([+-]?{NUMBER})[ \t]*([A-Za-zµμ°π_\"][A-Za-z0-9_/µμ°\"]*)")
_NOT_FINITE = re.compile(r"[+-]?\.?(?:nan|inf|infinity)", re.IGNORECASE)


class Kind(StrEnum):
    """What a key measures, with its unit inside wmrgen."""

    LENGTH = "length"  # m
    ANGLE = "angle"  # rad
    SPEED = "speed"  # m/s
    RATE = "angular rate"  # rad/s
    ANY = "parameter"


@dataclass(frozen=True, slots=True)
class Unit:
    """One of this unit is ``factor`` SI units, times pi where ``pi``."""

    kind: Kind
    factor: Fraction
    pi: bool = False


def _unit(kind: Kind, factor: str, pi: bool = False) -> Unit:
    return Unit(kind, Fraction(factor), pi)


_DEGREE = _unit(Kind.ANGLE, "1/180", True)
UNITS: dict[str, Unit] = {
    "m": _unit(Kind.LENGTH, "1"),
    "mm": _unit(Kind.LENGTH, "1/1000"),
    "cm": _unit(Kind.LENGTH, "1/100"),
    "um": _unit(Kind.LENGTH, "1/1000000"),
    "km": _unit(Kind.LENGTH, "1000"),
    "in": _unit(Kind.LENGTH, "0.0254"),
    "ft": _unit(Kind.LENGTH, "0.3048"),
    "rad": _unit(Kind.ANGLE, "1"),
    "deg": _DEGREE,
    "m/s": _unit(Kind.SPEED, "1"),
    "cm/s": _unit(Kind.SPEED, "1/100"),
    "mm/s": _unit(Kind.SPEED, "1/1000"),
    "km/h": _unit(Kind.SPEED, "5/18"),
    "rad/s": _unit(Kind.RATE, "1"),
    "deg/s": _unit(Kind.RATE, "1/180", True),
    "rpm": _unit(Kind.RATE, "1/30", True),
}
_SPELLINGS = {"µm": "um", "μm": "um", "°": "deg", "°/s": "deg/s"}
_ALIASES = {
    **dict.fromkeys(('"', "inch", "inches"), "Write in for inches."),
    **dict.fromkeys(("degree", "degrees", "grad"), "Write deg for degrees."),
    **dict.fromkeys(("radian", "radians"), "Write rad for radians."),
    **dict.fromkeys(("meter", "meters", "metre", "metres"), "Write m for metres."),
    **dict.fromkeys(("foot", "feet"), "Write ft for feet."),
}


def units_of(kind: Kind) -> list[str]:
    return [name for name, unit in UNITS.items() if kind in (unit.kind, Kind.ANY)]


def number(text: str, node: Scalar, offset: int = 0) -> Fraction:
    """The exact value of a NUMBER with an optional sign, which stands at ``offset`` of the node."""
    mantissa, _, exponent = text.lower().partition("e")
    digits = mantissa.lstrip("+-")
    if len(digits) > 1 and digits[0] == "0" and digits[1].isdigit():
        raise node.error(
            f"the number {quoted(text)} begins with 0",
            "YAML 1.1 reads such a number as octal, people read it as decimal.",
            f"Write {mantissa[: len(mantissa) - len(digits)]}{digits.lstrip('0') or '0'}.",
            offset,
        )
    if len(digits) > MAX_DIGITS:
        raise node.error(
            f"a number of more than {MAX_DIGITS} digits", "", "Round it: exact means as written.", offset
        )
    power = exponent.lstrip("+-").lstrip("0") or "0"
    if len(power) > 3 or int(power) > MAX_EXPONENT:
        raise node.error(
            f"the exponent of {quoted(text)} is out of range",
            f"Lengths and angles of robots need no exponent beyond ±{MAX_EXPONENT}.",
            "",
            offset,
        )
    return Fraction(mantissa) * Fraction(10) ** (-int(power) if exponent.startswith("-") else int(power))


def refuse_lookalikes(node: Scalar) -> None:
    """Refuse what YAML or people would take for a number and this grammar does not."""
    text = node.text.strip()
    if _NOT_FINITE.fullmatch(text):
        raise node.error(
            f"{quoted(text)} is not a finite number", "Every quantity is finite.", "Write the value."
        )
    for pattern, what, instead in (
        (
            r"[+-]?[0-9]+(:[0-9.]+)+",
            "is not a number (YAML 1.1 reads it in base 60)",
            "Write a decimal number.",
        ),
        (r"[+-]?[0-9.]+,[0-9]+", "has a decimal comma", "Write a decimal point."),
        (r"[+-]?0[xobXOB][0-9a-fA-F_]+", "is not decimal", "Write a decimal number."),
        (r"[+-]?[0-9][0-9_.]*_[0-9_.eE]*", "has underscores", "Write the digits without them."),
    ):
        if re.fullmatch(pattern, text):
            raise node.error(f"{quoted(text)} {what}", "", instead)


def plain_number(node: Scalar) -> tuple[Fraction, Unit | None] | None:
    """The value and unit of a node that is a number or a number with a unit; None for anything else."""
    text = node.text.strip()
    if _SIGNED.fullmatch(text):
        return number(text, node), None
    found = _WITH_UNIT.fullmatch(text)
    if not found or found[2] in ("pi", "π"):
        return None
    digits, name = found.groups()
    unit = UNITS.get(_SPELLINGS.get(name, name))
    if not unit:
        raise _unknown_unit(node, digits, name)
    return number(digits, node), unit


def _unknown_unit(node: Scalar, digits: str, name: str) -> RobotFileError:
    return node.error(
        f"{quoted(name)} is not a unit",
        "After a number stands a unit or an operator.",
        f"{suggestion(name, UNITS, _ALIASES)} For a product write {digits}*{name}."
        if name.isidentifier()
        else suggestion(name, UNITS, _ALIASES),
        node.text.index(name, node.text.index(digits) + len(digits)),
    )
