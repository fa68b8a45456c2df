"""Quantities of robot files: numbers, numbers with a unit and expressions, each of what its key measures."""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction

from wmrgen.errors import RobotFileError
from wmrgen.robotfile.expressions import parse_expression
from wmrgen.robotfile.numbers import Facts, Kind, Scope, facts_of, plain_number, refuse_lookalikes, units_of
from wmrgen.robotfile.records import Binary, Expr, Neg, Num, Pi, Quantity
from wmrgen.robotfile.text import Node, Scalar, quoted, scalar_of


def parse_value(node: Scalar, names: Collection[str], kind: Kind, what: str) -> tuple[Expr, Kind | None]:
    """The tree of a value and what its unit measures, where it has one."""
    refuse_lookalikes(node)
    plain = plain_number(node, names, kind)
    if plain is None:
        return parse_expression(node, names), None
    value, unit = plain
    if unit is None:
        return Num(value), None
    if kind not in (unit.kind, Kind.ANY):
        raise _of_another_kind(node, what, kind, quoted(node.text.strip()), unit.kind)
    scaled = Num(value * unit.factor)
    return Binary("*", scaled, Pi()) if unit.pi else scaled, unit.kind


def _of_another_kind(node: Scalar, what: str, kind: Kind, given: str, is_a: Kind) -> RobotFileError:
    wrong = f"{what} is {_article(kind)}, and {given} is {_article(is_a)}"
    return node.error(wrong, "", f"Use one of {' '.join(units_of(kind))}.")


def of_one_kind(node: Scalar, what: str, own: Facts, scope: Scope) -> None:
    """RobotFileError where a value measures something else than what has the facts ``own``, as far as units say."""
    expr, unit = parse_value(node, scope.facts, Kind.ANY, what)
    kinds = facts_of(expr, unit, scope, node).kinds
    if own.kinds and (other := next((k for k in kinds if k not in own.kinds), None)):
        raise _of_another_kind(
            node, what, next(iter(own.kinds)), kinds[other] or quoted(node.text.strip()), other
        )


def _article(kind: Kind) -> str:
    return f"an {kind}" if kind[0] == "a" else f"a {kind}"


def _degrees(expr: Expr) -> Expr:
    """A tree that is degrees as a tree that is radians."""
    match expr:
        case Num(value):
            return Binary("*", Num(value / 180), Pi())
        case Neg(Num(value)):
            return Binary("*", Num(-value / 180), Pi())
    return Binary("*", Binary("*", expr, Num(Fraction(1, 180))), Pi())


def read_quantity(node: Node, kind: Kind, what: str, scope: Scope) -> Quantity:
    """A quantity in SI units and radians; ``what`` names it in messages."""
    scalar = scalar_of(node, what)
    expr, unit = parse_value(scalar, scope.facts, kind, what)
    facts = facts_of(expr, unit, scope, scalar, kind is Kind.ANGLE)
    other = next((k for k in facts.kinds if k is not kind), None)
    if other and kind is not Kind.ANY:
        raise _of_another_kind(scalar, what, kind, facts.kinds[other], other)
    if kind is Kind.ANGLE and scope.degrees and not facts.in_radians:
        expr = _degrees(expr)
    return Quantity(expr, scalar.text.strip(), scalar.mark)
