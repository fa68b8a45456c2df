"""What a file declares before its values can be read: parameter names, degrees or radians.

Facts about trees are found by walking them; no value is ever computed here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil

from wmrgen.errors import RobotFileError
from wmrgen.spec.nodes import Scalar
from wmrgen.spec.records import Binary, Call, Expr, Neg, Num, Param, Pi

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
    sine takes; ``in_radians``: an angle as it stands.
    """

    bits: int
    terms: int
    spread: int
    in_radians: bool


@dataclass(frozen=True, slots=True)
class Scope:
    """Declared parameters with their facts, and whether bare angles are degrees."""

    degrees: bool = False
    facts: Mapping[str, Facts] = field(default_factory=dict)


def children(expr: Expr) -> tuple[Expr, ...]:
    match expr:
        case Neg(arg):
            return (arg,)
        case Binary(_, left, right):
            return (left, right)
        case Call(_, args):
            return args
    return ()


def parameters_in(expr: Expr) -> set[str]:
    """Names of the parameters that occur in the tree."""
    if isinstance(expr, Param):
        return {expr.name}
    return set().union(*(parameters_in(child) for child in children(expr)))


def _number_bits(value: Fraction) -> int:
    return max(1, value.numerator.bit_length(), value.denominator.bit_length())


def _size(expr: Expr, facts: Mapping[str, Facts]) -> tuple[int, int]:
    """Upper bounds: (bits, terms) of the expanded exact result."""
    match expr:
        case Num(value):
            return _number_bits(value), 1
        case Param(name):
            return facts[name].bits, facts[name].terms
        case Binary("**", left, Num(power)):
            bits, terms = _size(left, facts)
            times = max(1, abs(int(power)))
            return bits * times, int(terms**times)
    sizes = [_size(child, facts) for child in children(expr)]
    bits, terms = sum(b for b, _ in sizes), sum(t for _, t in sizes)
    match expr:
        case Call("sin" | "cos" | "tan", (arg,)):
            return bits + _ROUNDED_BITS, int(terms + 2 ** min(_spread(arg, facts), 20))
        case Pi() | Call():
            return bits + _ROUNDED_BITS, max(1, terms)
        case Binary("*" | "/"):
            return bits, sizes[0][1] * sizes[1][1]
    return bits + 1, terms


def _spread(expr: Expr, facts: Mapping[str, Facts]) -> int:
    """How many angles the tree adds up, multiples up to 4 counted as often; constants count nothing."""
    match expr:
        case Num() | Pi():
            return 0
        case Param(name):
            return max(1, facts[name].spread)
        case Call():
            return 1
        case Binary("*", left, right):
            a, b = _spread(left, facts), _spread(right, facts)
            factor = left if not a else right
            times = min(4, ceil(abs(factor.value))) if isinstance(factor, Num) else 4
            return 1 if a and b else (a + b) * max(1, times)
        case Binary("/", left, _):
            return max(_spread(left, facts), int(bool(parameters_in(expr))))
        case Binary("**"):
            return int(bool(parameters_in(expr)))
    return sum(_spread(child, facts) for child in children(expr))


def _in_radians(expr: Expr, facts: Mapping[str, Facts]) -> bool:
    """Whether pi, atan2 or a value with a unit occurs, here or in a parameter."""
    match expr:
        case Pi() | Call("atan2", _):
            return True
        case Param(name):
            return facts[name].in_radians
    return any(_in_radians(child, facts) for child in children(expr))


def facts_of(expr: Expr, has_unit: bool, scope: Scope, node: Scalar, angle: bool = False) -> Facts:
    """The facts of a tree. RobotFileError when its exact value would be too large to handle."""
    bits, terms = _size(expr, scope.facts)
    if bits > MAX_BITS or terms > MAX_TERMS:
        raise node.error(
            "the expression is too large to be computed exactly",
            "Powers of powers and products of long sums grow without bound.",
            "Write the number, or a simpler expression.",
        )
    spread = _spread(expr, scope.facts)
    if angle and spread > MAX_SPREAD:
        raise node.error(
            f"an angle made of more than {MAX_SPREAD} others",
            "Its exact sine has a term for every subset of them.",
            "Declare the sum as one parameter with its value.",
        )
    return Facts(bits, terms, spread, has_unit or _in_radians(expr, scope.facts))


def refuse_bare_trigonometry(expr: Expr, scope: Scope, node: Scalar) -> None:
    """Under ``angles: deg`` refuse cos(30): it cannot be told whether degrees are meant."""
    if not scope.degrees:
        return
    match expr:
        case Call("sin" | "cos" | "tan" as name, (arg,)) if arg != Num(Fraction(0)) and not _in_radians(
            arg, scope.facts
        ):
            raise node.error(
                f"with angles: deg the argument of {name}() is ambiguous",
                "sin, cos and tan take radians, and bare angles are degrees in this file.",
                f"Write {name}(30*pi/180), or declare a parameter such as a: 30 deg and write {name}(a).",
            )
    for child in children(expr):
        refuse_bare_trigonometry(child, scope, node)


def dependency_order(uses: Mapping[str, set[str]], nodes: Mapping[str, Scalar]) -> list[str]:
    """Names ordered so that each stands after those it uses, in file order otherwise.

    RobotFileError for a circle. Iterative: a chain of parameters may be long.
    """
    order: dict[str, None] = {}
    for root in uses:
        path = [root]
        while path:
            name = path[-1]
            missing = [used for used in sorted(uses[name]) if used not in order]
            if not missing:
                order[name] = None
                path.pop()
            elif missing[0] in path:
                raise _circle(path[path.index(missing[0]) :], nodes[name])
            else:
                path.append(missing[0])
    return list(order)


def _circle(names: list[str], node: Scalar) -> RobotFileError:
    if len(names) == 1:
        return node.error(f"parameter {names[0]} refers to itself", "", "Give it a number.")
    chain = " -> ".join([*names[:6], *(["…"] if len(names) > 6 else []), names[0]])
    return node.error(
        f"parameters refer to each other in a circle: {chain}", "", "Give one of them a number."
    )
