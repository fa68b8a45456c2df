"""Numbers as robot files write them, exact, with units; and how large an expression of them becomes.

YAML's own reading is not used: to PyYAML ``1e-3`` is a string, ``1:30`` is 90 and ``012`` is 10. Facts about trees
are found by walking them; no value is ever computed here.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from fractions import Fraction
from math import ceil
from typing import NamedTuple

from wmrgen.errors import Code
from wmrgen.robotfile.records import Binary, Call, Expr, Neg, Num, Param, Pi, children, parameters_in
from wmrgen.robotfile.text import Scalar, quoted, suggestion

NUMBER = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
MAX_DIGITS = 40
MAX_EXPONENT = 30

_SIGNED = re.compile(rf"[+-]?{NUMBER}")
_WITH_UNIT = re.compile(rf"([+-]?{NUMBER})[ \t]*([A-Za-zµμ°π_\"][A-Za-z0-9_/µμ°\"]*(?:(?<=/s)(?:\^2|²))?)")
_NOT_FINITE = re.compile(r"[+-]?\.?(?:nan|inf|infinity)", re.IGNORECASE)


class Kind(StrEnum):
    """What a key measures, with its unit inside wmrgen."""

    LENGTH = "length"  # m
    ANGLE = "angle"  # rad
    SPEED = "speed"  # m/s
    RATE = "angular rate"  # rad/s
    ACCELERATION = "acceleration"  # m/s^2
    ANGULAR_ACCELERATION = "angular acceleration"  # rad/s^2
    TIME = "time"  # s
    ANY = "parameter"


class Unit(NamedTuple):
    """One of this unit is ``factor`` SI units, times pi where ``pi``."""

    kind: Kind
    factor: Fraction
    pi: bool = False


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
_SPELLINGS |= {f"{unit}{two}": f"{unit}^2" for unit in ("m/s", "rad/s", "deg/s") for two in ("2", "²")}
_ALIASES = {
    **dict.fromkeys(('"', "inch", "inches"), "Write in for inches."),
    **dict.fromkeys(("degree", "degrees", "degs", "grad"), "Write deg for degrees."),
    **dict.fromkeys(("radian", "radians", "rads"), "Write rad for radians."),
    **dict.fromkeys(("meter", "meters", "metre", "metres"), "Write m for metres."),
    **dict.fromkeys(("foot", "feet"), "Write ft for feet."),
    **dict.fromkeys(("rev/s", "rps", "hz", "turns/s"), "Write rpm: 60 of them are a turn a second."),
    **dict.fromkeys(("rev/min", "r/min"), "Write rpm."),
}


def units_of(kind: Kind) -> list[str]:
    return [name for name, unit in UNITS.items() if kind in (unit.kind, Kind.ANY)]


def spellings_of(kind: Kind) -> list[str]:
    """Its units, in every form that is read."""
    return [*(own := units_of(kind)), *(word for word, unit in _SPELLINGS.items() if unit in own)]


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
        (r"[+-]?\d+(:[\d.]+)+", "is not a number (YAML 1.1 reads it in base 60)", "Write a decimal number."),
        (r"[+-]?[0-9.]+,[0-9]+", "has a decimal comma", "Write a decimal point."),
        (r"[+-]?0[xobXOB][0-9a-fA-F_]+", "is not decimal", "Write a decimal number."),
        (r"[+-]?[0-9][0-9_.]*_[0-9_.eE]*", "has underscores", "Write the digits without them."),
        ("~|(?i:null|none|true|false)", "is no number", "Write the number, or delete the key."),
    ):
        if re.fullmatch(pattern, text):
            raise node.error(f"{quoted(text)} {what}", "", instead)


def plain_number(
    node: Scalar, names: Collection[str] = (), kind: Kind = Kind.ANY
) -> tuple[Fraction, Unit | None] | None:
    """The value and unit of a node that is a number or a number with a unit; None for anything else, such as a number
    before one of the ``names``."""
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
        "After a number stands a unit or an operator.",
        suggestion(name, units_of(kind), _ALIASES),
        node.text.index(name, node.text.index(digits) + len(digits)),
    )


# A power of a power grows as 4^n, and parameters can stack: the size of the exact result is bounded before
# anyone computes it. 4,000 bits are 1,200 digits; a robot needs some twenty.
MAX_BITS = 4_000
MAX_TERMS = 400
MAX_SPREAD = 8  # sin and cos of a sum of n angles have 2^n terms
_ROUNDED_BITS = 280  # a 40-digit point of the unit circle


@dataclass(frozen=True, slots=True)
class Facts:
    """What is known of a tree without computing it.

    ``bits`` bounds the exact result, ``terms`` its expanded sum, ``spread`` the addition theorems that its
    sine takes; ``in_radians``: an angle as it stands. ``kinds``: what it measures by units, and the parameter
    that has the unit.
    """

    bits: int
    terms: int
    spread: int
    in_radians: bool
    kinds: Mapping[Kind, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Scope:
    """Declared parameters with their facts, None where they cannot be read; and whether bare angles are degrees."""

    degrees: bool = False
    facts: Mapping[str, Facts | None] = field(default_factory=dict)


def _facts(expr: Expr, declared: Mapping[str, Facts]) -> Facts:
    """What is known of a tree, from what is known of its parts; ``declared``: of the parameters."""
    match expr:
        case Num(value):
            return Facts(max(1, value.numerator.bit_length(), value.denominator.bit_length()), 1, 0, False)
        case Pi():
            return Facts(_ROUNDED_BITS, 1, 0, True)
        case Param(name):
            return replace(declared[name], spread=max(1, declared[name].spread))
        case Binary("**", left, Num(power)):
            base, times = _facts(left, declared), max(1, abs(int(power)))
            spread = int(bool(parameters_in(left)))
            return Facts(base.bits * times, base.terms**times, spread, base.in_radians)
    parts = [_facts(child, declared) for child in children(expr)]
    bits, terms, spread = (sum(getattr(f, key) for f in parts) for key in ("bits", "terms", "spread"))
    in_radians = any(f.in_radians for f in parts)
    match expr:
        case Call("sin" | "cos" | "tan"):
            return Facts(bits + _ROUNDED_BITS, terms + 2 ** min(spread, 20), 1, in_radians)
        case Call(name):
            return Facts(bits + _ROUNDED_BITS, terms, 1, in_radians or name == "atan2")
        case Binary("*", left, right):
            terms, spread = parts[0].terms * parts[1].terms, _spread_of_product((left, right), parts)
        case Binary("/"):
            spread = max(parts[0].spread, int(bool(parameters_in(expr))))
            terms = parts[0].terms * parts[1].terms
        case _:
            bits += 1
    return Facts(bits, terms, spread, in_radians)


def _spread_of_product(factors: tuple[Expr, Expr], facts: list[Facts]) -> int:
    """A multiple of angles counts them as often as it has them, up to 4 times."""
    a, b = (f.spread for f in facts)
    if a and b:
        return 1
    factor = factors[1] if a else factors[0]
    times = min(4, ceil(abs(factor.value))) if isinstance(factor, Num) else 4
    return (a + b) * max(1, times)


def _kinds(expr: Expr, declared: Mapping[str, Facts]) -> dict[Kind, str]:
    """What parameters with a unit measure that are terms of a sum. Of a product it is not known: its numbers may have
    any unit."""
    match expr:
        case Param(name):
            return dict.fromkeys(declared[name].kinds, name)
        case Neg(arg):
            return _kinds(arg, declared)
        case Binary("+" | "-", left, right):
            return _kinds(left, declared) | _kinds(right, declared)
    return {}


def facts_of(expr: Expr, unit: Kind | None, scope: Scope, node: Scalar, angle: bool = False) -> Facts:
    """The facts of a tree; ``unit``: what that measures which is written behind it.

    RobotFileError when its exact value would be too large to handle, or when it takes the cosine of what may be
    degrees or radians.
    """
    used = parameters_in(expr)
    declared = {name: value for name in used if (value := scope.facts.get(name)) is not None}
    if len(declared) < len(used):
        raise node.error("a parameter that cannot be read is used here", code=Code.CONSEQUENCE)
    facts = _facts(expr, declared)
    if facts.bits > MAX_BITS or facts.terms > MAX_TERMS:
        raise node.error(
            "the expression is too large to be computed exactly",
            "Powers of powers and products of long sums grow without bound.",
            "Write the number, or a simpler expression.",
        )
    if angle and facts.spread > MAX_SPREAD:
        raise node.error(
            f"an angle made of more than {MAX_SPREAD} others",
            "Its exact sine has a term for every subset of them.",
            "Declare the sum as one parameter with its value.",
        )
    if scope.degrees:
        _refuse_bare_trigonometry(expr, declared, node)
    kinds = {unit: ""} if unit else _kinds(expr, declared)
    return replace(facts, in_radians=bool(unit) or facts.in_radians, kinds=kinds)


def _refuse_bare_trigonometry(expr: Expr, declared: Mapping[str, Facts], node: Scalar) -> None:
    """Under ``angles: deg`` refuse cos(30): it cannot be told whether degrees are meant."""
    match expr:
        case Call("sin" | "cos" | "tan" as name, (arg,)):
            if arg != Num(Fraction(0)) and not _facts(arg, declared).in_radians:
                raise node.error(
                    f"with angles: deg the argument of {name}() is ambiguous",
                    "sin, cos and tan take radians, and bare angles are degrees in this file.",
                    f"Write {name}(30*pi/180), or declare a parameter such as a: 30 deg and write {name}(a).",
                )
    for child in children(expr):
        _refuse_bare_trigonometry(child, declared, node)
