"""Read quantities: numbers, numbers with a unit, and expressions, each of the kind that its key measures.

No value is computed here. What is known of an expression (its size, its kind) is found by walking its tree.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import ceil

from wmrgen.errors import Code, RobotFileError
from wmrgen.robotfile.expressions import parse_expression
from wmrgen.robotfile.numbers import Kind, plain_number, refuse_lookalikes, units_of
from wmrgen.robotfile.records import (
    Binary,
    Call,
    Expr,
    Neg,
    Num,
    Param,
    Pi,
    Quantity,
    children,
    parameters_in,
)
from wmrgen.robotfile.text import Node, Scalar, quoted, scalar_of

# ---- the size and the kind of an expression

# A power of a power grows as 4^n, and parameters can use parameters: the size of the exact result is bounded before it
# is computed.
MAX_BITS = 4_000  # of a numerator or denominator; 1,200 digits, and a robot needs about twenty
MAX_TERMS = 400  # of the expanded sum; longer ones take long to simplify
MAX_SPREAD = 8  # angles in a sum; its sine and cosine have 2^n terms
_ROUNDED_BITS = 280  # of pi, a sine or a root: rational approximations with 40 digits


@dataclass(frozen=True, slots=True)
class Facts:
    """What is known of an expression without computing it."""

    bits: int  # upper bound for the exact result
    terms: int  # upper bound for the expanded sum
    spread: int  # number of angles in the sum, for the addition theorems of its sine
    in_radians: bool  # whether an angle is in radians even where bare numbers are degrees
    # What units say that it measures, each with the name of the parameter that has the unit.
    kinds: Mapping[Kind, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Scope:
    """What an expression may use."""

    degrees: bool = False  # whether angles without a unit are degrees
    facts: Mapping[str, Facts | None] = field(default_factory=dict)  # by parameter; None if unreadable


# What to write in place of a word that is no angle.
_ANGLES = (
    "Write the angle. A direction counts from x: forward is 0, left 90 deg, backward 180 deg, right -90 deg."
)


def _facts(expr: Expr, declared: Mapping[str, Facts]) -> Facts:
    """Return the facts of a tree from those of its parts; ``declared`` has those of the parameters."""
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
    bits = sum(f.bits for f in parts)
    terms = sum(f.terms for f in parts)
    spread = sum(f.spread for f in parts)
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
    """Return the spread of a product: n times an angle counts as n angles, at most 4."""
    a, b = (f.spread for f in facts)
    if a and b:
        return 1
    factor = factors[1] if a else factors[0]
    times = min(4, ceil(abs(factor.value))) if isinstance(factor, Num) else 4
    return (a + b) * max(1, times)


def _kinds(expr: Expr, declared: Mapping[str, Facts]) -> dict[Kind, str]:
    """Return what the terms of a sum measure, if they are parameters with a unit. The kind of a product is unknown,
    because its numbers may have any unit."""
    match expr:
        case Param(name):
            return dict.fromkeys(declared[name].kinds, name)
        case Neg(arg):
            return _kinds(arg, declared)
        case Binary("+" | "-", left, right):
            return _kinds(left, declared) | _kinds(right, declared)
    return {}


def facts_of(expr: Expr, unit: Kind | None, scope: Scope, node: Scalar, angle: bool = False) -> Facts:
    """Return the facts of an expression.

    Args:
        expr: The tree of the expression.
        unit: The kind of the unit that is written after it, or None.
        scope: The parameters that it may use.
        node: The node of the expression, for the place of errors.
        angle: Whether the expression is an angle, whose sine will be computed.

    Raises:
        RobotFileError: The exact value would be too large, or under ``angles: deg`` the argument of a sine may be
            degrees or radians.
    """
    used = parameters_in(expr)
    declared = {name: value for name, value in scope.facts.items() if name in used and value is not None}
    if len(declared) < len(used):
        raise node.error(
            "a parameter used here cannot be read", "", "Correct the parameter.", code=Code.CONSEQUENCE
        )
    facts = _facts(expr, declared)
    if facts.bits > MAX_BITS or facts.terms > MAX_TERMS:
        raise node.error(
            "the expression is too large to compute exactly",
            "Powers of powers and products of long sums grow without bound.",
            "Write the number, or a simpler expression.",
        )
    if angle and facts.spread > MAX_SPREAD:
        raise node.error(
            f"an angle that is the sum of more than {MAX_SPREAD} angles",
            "Its exact sine has a term for each subset of them.",
            "Declare the sum as one parameter with its value.",
        )
    if scope.degrees:
        _refuse_bare_trigonometry(expr, declared, node)
    kinds = {unit: ""} if unit else _kinds(expr, declared)
    return replace(facts, in_radians=bool(unit) or facts.in_radians, kinds=kinds)


def _refuse_bare_trigonometry(expr: Expr, declared: Mapping[str, Facts], node: Scalar) -> None:
    """Under ``angles: deg``, refuse cos(30), which may mean degrees or radians."""
    match expr:
        case Call("sin" | "cos" | "tan" as name, (arg,)):
            if arg != Num(Fraction(0)) and not _facts(arg, declared).in_radians:
                raise node.error(
                    f"with angles: deg the argument of {name}() is ambiguous",
                    "sin, cos and tan take radians, but angles without a unit are degrees in this file.",
                    f"Write {name}(30*pi/180), or declare a parameter such as a: 30 deg and write {name}(a).",
                )
    for child in children(expr):
        _refuse_bare_trigonometry(child, declared, node)


# ---- reading a quantity


def parse_value(node: Scalar, names: Collection[str], kind: Kind, what: str) -> tuple[Expr, Kind | None]:
    """Parse the text of a value.

    Args:
        node: The text.
        names: The parameters that it may use.
        kind: What the key measures.
        what: Names the value in messages.

    Returns:
        The tree in SI units and radians, and the kind of the unit that is written after it, or None.

    Raises:
        RobotFileError: The text is not a value, or its unit is of another kind.
    """
    refuse_lookalikes(node)
    plain = plain_number(node, names, kind)
    if plain is None:
        return parse_expression(node, names, _ANGLES if kind is Kind.ANGLE else ""), None
    value, unit = plain
    if unit is None:
        return Num(value), None
    if kind not in (unit.kind, Kind.ANY):
        raise _of_another_kind(node, what, kind, quoted(node.text.strip()), unit.kind)
    scaled = Num(value * unit.factor)
    return Binary("*", scaled, Pi()) if unit.pi else scaled, unit.kind


def _of_another_kind(node: Scalar, what: str, kind: Kind, given: str, is_a: Kind) -> RobotFileError:
    """Return the error for a key of one kind and a value, shown as ``given``, of another."""
    wrong = f"{what} is {_article(kind)}, and {given} is {_article(is_a)}"
    return node.error(wrong, "", f"Use one of {' '.join(units_of(kind))}.")


def check_same_kind(node: Scalar, what: str, own: Facts, scope: Scope) -> None:
    """Raise RobotFileError if units show that a value is of another kind than the one with the facts ``own``.

    Args:
        node: The value.
        what: Names the value in messages.
        own: The facts of the value that it must agree with.
        scope: The parameters that it may use.
    """
    expr, unit = parse_value(node, scope.facts, Kind.ANY, what)
    kinds = facts_of(expr, unit, scope, node).kinds
    others = [kind for kind in kinds if kind not in own.kinds]
    if own.kinds and others:
        given = kinds[others[0]] or quoted(node.text.strip())
        raise _of_another_kind(node, what, next(iter(own.kinds)), given, others[0])


def _article(kind: Kind) -> str:
    """Return the name of a kind with its article."""
    return f"an {kind}" if kind[0] == "a" else f"a {kind}"


def _degrees(expr: Expr) -> Expr:
    """Return the tree in radians of a tree in degrees."""
    match expr:
        case Num(value):
            return Binary("*", Num(value / 180), Pi())
        case Neg(Num(value)):
            return Binary("*", Num(-value / 180), Pi())
    return Binary("*", Binary("*", expr, Num(Fraction(1, 180))), Pi())


def read_quantity(node: Node, kind: Kind, what: str, scope: Scope) -> Quantity:
    """Read a quantity.

    Args:
        node: The value.
        kind: What the key measures.
        what: Names the value in messages.
        scope: The parameters that it may use, and the unit of angles without a unit.

    Returns:
        The quantity in SI units and radians.

    Raises:
        RobotFileError: The value is not a quantity of this kind.
    """
    scalar = scalar_of(node, what)
    expr, unit = parse_value(scalar, scope.facts, kind, what)
    facts = facts_of(expr, unit, scope, scalar, kind is Kind.ANGLE)
    other = next((k for k in facts.kinds if k is not kind), None)
    if other and kind is not Kind.ANY:
        raise _of_another_kind(scalar, what, kind, facts.kinds[other], other)
    if kind is Kind.ANGLE and scope.degrees and not facts.in_radians:
        expr = _degrees(expr)
    return Quantity(expr, scalar.text.strip(), scalar.mark)
