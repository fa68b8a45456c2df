"""One scalar of the file to one quantity: number, number with unit, or expression."""

from __future__ import annotations

from collections.abc import Collection
from fractions import Fraction

from wmrgen.spec.expressions import parse_expression
from wmrgen.spec.nodes import Node, Scalar, kind_of
from wmrgen.spec.numbers import Kind, Unit, plain_number, refuse_lookalikes, units_of
from wmrgen.spec.records import Binary, Expr, Neg, Num, Pi, Quantity
from wmrgen.spec.scope import Scope, facts_of, refuse_bare_trigonometry
from wmrgen.spec.text import quoted


def scalar_of(node: Node, what: str) -> Scalar:
    """The node, when it is a text with something in it."""
    if not isinstance(node, Scalar):
        raise node.error(f"{what} must be one value, not {kind_of(node)}")
    if not node.text.strip():
        raise node.error(f"{what} has no value", "", "Write a value after the colon, or delete the key.")
    return node


def parse_value(node: Scalar, names: Collection[str], kind: Kind, what: str) -> tuple[Expr, bool]:
    """The tree of a value and whether it was written with a unit."""
    refuse_lookalikes(node)
    found = plain_number(node)
    if not found:
        return parse_expression(node, names), False
    value, unit = found
    if unit is None:
        return Num(value), False
    if kind not in (unit.kind, Kind.ANY):
        raise node.error(
            f"{what} is {_article(kind)}, and {quoted(node.text.strip())} is {_article(unit.kind)}",
            "",
            f"Use one of {' '.join(units_of(kind))}.",
        )
    return _with_unit(value, unit), True


def _article(kind: Kind) -> str:
    return f"an {kind}" if kind[0] == "a" else f"a {kind}"


def _with_unit(value: Fraction, unit: Unit) -> Expr:
    scaled = Num(value * unit.factor)
    return Binary("*", scaled, Pi()) if unit.pi else scaled


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
    expr, has_unit = parse_value(scalar, scope.facts, kind, what)
    facts = facts_of(expr, has_unit, scope, scalar, kind is Kind.ANGLE)
    refuse_bare_trigonometry(expr, scope, scalar)
    if kind is Kind.ANGLE and scope.degrees and not facts.in_radians:
        expr = _degrees(expr)
    return Quantity(expr, scalar.text.strip(), scalar.mark)
