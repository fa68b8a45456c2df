"""Vector fields as exact polynomials, their Lie brackets, and how far these reach (Siegwart 3.4.1; Tzafestas 2.2.3).

Generators are states, parameters, and sines and cosines of sums of states; tan is sin/cos. [f, g] = (dg/dq) f -
(df/dq) g is formed in symbols. Which brackets are independent is decided at a rational point of the state space, where
every angle is a rational point of the unit circle: without rounding. The growth vector counts the dimensions that
brackets of up to k fields span there; its length is the degree of nonholonomy.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import NamedTuple

import sympy

from wmrgen.errors import NotDerivableError
from wmrgen.exact.evaluate import CosSin, add_angles, circle, function, multiple, number, sqrt_poly
from wmrgen.exact.linalg import rank
from wmrgen.exact.number import ONE, Exact
from wmrgen.exact.poly import Gen, Poly, derivative
from wmrgen.functions.models.sheet import tidy
from wmrgen.functions.registry import system_builder
from wmrgen.functions.system import System
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.ports import Port
from wmrgen.printing import exact
from wmrgen.symbolic import Expr, Parameter, Quantity, expression

MOST_STATES = 10  # each further state triples the time; 10 take a second
MOST_PRODUCTS = 130_000  # of terms, in all brackets together: 20,000 take a second

Field = tuple[Poly, ...]


def to_poly(expr: Expr) -> Poly:
    """A field component as a polynomial. Inputs and locals keep their printed name (`front_steer`)."""
    match expr:
        case sympy.Rational():
            return Poly.of(Fraction(int(expr.p), int(expr.q)))
        case sympy.core.numbers.Pi():
            return Poly.gen("pi")
        case Parameter():
            return Poly.gen("param", expr.name)
        case Quantity():
            return Poly.gen("input", expr.name)
        case sympy.Add():
            return Poly.sum(to_poly(a) for a in expr.args)
        case sympy.Mul():
            result = Poly.of(1)
            for a in expr.args:
                result = result * to_poly(a)
            return result
        case sympy.Pow():
            return _power(expr)
        case sympy.cos():
            return _circle(expr.args[0])[0]
        case sympy.sin():
            return _circle(expr.args[0])[1]
        case sympy.tan():
            c, s = _circle(expr.args[0])
            return s * c.inverse()
        case sympy.atan2():
            return function("atan2", "", tuple(to_poly(a) for a in expr.args))
    raise ValueError(f"no polynomial: {expr}")


def _power(expr: Expr) -> Poly:
    base, exponent = to_poly(expr.base), expr.exp
    if exponent.is_Integer:
        return base ** int(exponent)
    if exponent.is_Rational and exponent.q == 2:
        return sqrt_poly(base) ** int(exponent.p)
    raise ValueError(f"no polynomial: {expr}")


def _circle(angle: Expr) -> tuple[Poly, Poly]:
    """Cosine and sine of a sum of states, its first coefficient positive."""
    poly = to_poly(angle)
    if poly and poly.ordered[0][1].sign < 0:
        return Poly.gen("cosf", "", -poly), -Poly.gen("sinf", "", -poly)
    return Poly.gen("cosf", "", poly), Poly.gen("sinf", "", poly)


def by_state(poly: Poly, state: str) -> Poly:
    """d poly / d state."""
    name = state.replace(".", "_")
    return derivative(poly, lambda g: _of_generator(g, name))


def _of_generator(g: Gen, name: str) -> Poly:
    if g.kind == "input":
        return Poly.of(int(g.name == name))
    if not g.args:
        return Poly({})
    inner = by_state(g.args[0], name)
    if not inner:
        return inner
    match g.kind:
        case "cosf":
            return -(Poly.gen("sinf", "", *g.args) * inner)
        case "sinf":
            return Poly.gen("cosf", "", *g.args) * inner
        case "inv":
            return -(Poly({((g, 2),): ONE}) * inner)
        case "sqrt":
            return (Poly({((g, -1),): ONE}) * inner).scale(Fraction(1, 2))
    raise ValueError(f"no derivative of {g.kind}")


def generic_point(state: tuple[Port, ...], seed: int = 0) -> dict[str, Exact]:
    """State -> a number, and for an angle the tangent of its half. Printed names, see `to_poly`."""
    return {
        p.name.replace(".", "_"): Exact(Fraction((-1) ** k * (2 * k + 1 + seed), 7 + 3 * k + 2 * seed))
        for k, p in enumerate(state)
    }


def at_point(poly: Poly, point: Mapping[str, Exact], numbers: Mapping[str, Exact]) -> Poly:
    """``poly`` with states at ``point`` and parameters at ``numbers`` put in: a number wherever the field has it."""

    def value(g: Gen) -> Poly | None:
        match g.kind:
            case "input":
                return Poly.of(point[g.name])
            case "param":
                return Poly.of(numbers[g.name]) if g.name in numbers else None
            case "cosf" | "sinf":
                cos_sin = _on_circle(g.args[0], point)
                return None if cos_sin is None else cos_sin[g.kind == "sinf"]
            case "inv":
                return g.args[0].substitute(value).inverse()
            case "sqrt":
                return sqrt_poly(g.args[0].substitute(value))
        return None

    return poly.substitute(value)


def value_at(poly: Poly, point: Mapping[str, Exact], numbers: Mapping[str, Exact]) -> Exact:
    """The value there. What the field does not hold is rounded, see `exact.evaluate`."""
    return number(at_point(poly, point, numbers), {name: Poly.of(n) for name, n in numbers.items()})


def _on_circle(angle: Poly, point: Mapping[str, Exact]) -> CosSin | None:
    """(cos, sin) of a whole-numbered sum of states; None for an angle of parameters."""
    total: CosSin = Poly.of(1), Poly({})
    for monomial, count in angle.terms.items():
        ((g, e),) = monomial
        if g.kind != "input" or e != 1 or count.den != 1 or not count.is_rational:
            return None
        c, s = circle(point[g.name].rational())
        total = add_angles(total, multiple((Poly.of(c), Poly.of(s)), count.num[0]))
    return total


class Bracket(NamedTuple):
    """A vector field reached by the inputs. ``name``: g1, [g1, g2], [g1, [g1, g2]]; ``order``: fields in it."""

    name: str
    order: int
    polys: Field

    @property
    def field(self) -> tuple[Expr, ...]:
        """Components in the order of the state."""
        return tuple(expression(p) for p in self.polys)

    def written(self, shown: Callable[[Expr], str] = exact) -> tuple[str, ...]:
        """Components in Python syntax, or as ``shown`` writes them."""
        return tuple(shown(tidy(e)) for e in self.field)


class Growth(NamedTuple):
    """``brackets``: those that add a dimension, the input fields first. ``vector``: dimensions by order."""

    state: tuple[str, ...]
    inputs: tuple[str, ...]
    vector: tuple[int, ...]
    brackets: tuple[Bracket, ...]

    @property
    def degree(self) -> int:
        """Degree of nonholonomy: the order after which nothing is added."""
        return len(self.vector)

    @property
    def controllable(self) -> bool:
        """True where the brackets span every direction of the state space."""
        return self.vector[-1] == len(self.state)

    @property
    def text(self) -> str:
        """The growth vector, and which bracket adds each dimension."""
        vector = ", ".join(map(str, self.vector))
        added = [b.name for b in self.brackets if b.order > 1]
        text = f"growth vector ({vector}), degree of nonholonomy {self.degree}"
        if added:
            text += f"; {', '.join(added)} add{'s' if len(added) == 1 else ''} one dimension each"
        reach = (
            "every direction" if self.controllable else f"{self.vector[-1]} of {len(self.state)} directions"
        )
        return f"{text}; the brackets reach {reach}"


def bracket(f: Field, g: Field, state: tuple[str, ...]) -> Field:
    """[f, g] = (dg/dq) f - (df/dq) g."""
    return tuple(
        Poly.sum(
            part
            for k, q in enumerate(state)
            for part in (by_state(g[i], q) * f[k], -(by_state(f[i], q) * g[k]))
            if part
        )
        for i in range(len(state))
    )


def growth(system: System, seed: int = 0, most: int = MOST_PRODUCTS) -> Growth:
    """The growth vector of a system. NotDerivableError where its brackets in symbols take more than ``most`` products
    of terms, or it has too many states."""
    if len(system.state) > MOST_STATES:
        raise NotDerivableError(
            f"{system.name} has {len(system.state)} states: Lie brackets are formed for up to {MOST_STATES}. "
            "Where a chained form of n states exists (`chained`), the growth vector is (2, 3, ..., n)"
        )
    state = tuple(p.name for p in system.state)
    values = {p.name: p.default for p in system.geometry if p.default is not None}
    point = generic_point(system.state, seed)
    reached: list[Bracket] = []
    rows: list[list[Exact]] = []

    def adds_a_dimension(candidate: Bracket) -> bool:
        row = [value_at(p, point, values) for p in candidate.polys]
        if rank([*rows, row]) == len(rows):
            return False
        reached.append(candidate)
        rows.append(row)
        return True

    inputs = [
        Bracket(f"g{k + 1}", 1, tuple(to_poly(e) for e in field)) for k, field in enumerate(system.fields)
    ]
    newest = [b for b in inputs if adds_a_dimension(b)]
    vector, products = [len(reached)], 0
    while newest and len(reached) < len(state):
        pairs = _pairs(inputs, newest)
        products += sum(_products(a.polys, b.polys) for a, b in pairs)
        if products > most:
            raise NotDerivableError(
                f"{system.name} has Lie brackets of too many terms to be formed in symbols. "
                "Trailers that are coupled off the axle (`hitch`) double them one by one"
            )
        order = len(vector) + 1
        brackets = (
            Bracket(f"[{a.name}, {b.name}]", order, bracket(a.polys, b.polys, state)) for a, b in pairs
        )
        newest = [b for b in brackets if len(reached) < len(state) and any(b.polys) and adds_a_dimension(b)]
        if newest:
            vector.append(len(reached))
    return Growth(state, tuple(p.name for p in system.inputs), tuple(vector), tuple(reached))


def _pairs(inputs: list[Bracket], newest: list[Bracket]) -> list[tuple[Bracket, Bracket]]:
    """What may add a dimension: the bracket of each input with each field that added one last."""
    if newest[0].order == 1:
        return [(a, b) for i, a in enumerate(inputs) for b in inputs[i + 1 :]]
    return [(g, b) for b in newest for g in inputs]


def _products(f: Field, g: Field) -> int:
    """About how many products of terms the bracket of two fields takes."""
    return 2 * sum(len(p.terms) for p in f) * sum(len(p.terms) for p in g)


def robot_growth(robot: Robot, mobility: Mobility, most: int = MOST_PRODUCTS) -> Growth:
    """The growth of the posture model in null-space coordinates, of body and trailers where there are some."""
    if not mobility.degree_of_mobility:
        raise NotDerivableError(f"{robot.name} cannot move: it has no vector fields")
    return growth(system_builder("trailer" if robot.trailers else "eta")(robot, mobility, True), most=most)
