"""Lie brackets of a system's vector fields, and how far they reach (Siegwart 3.4.1; Tzafestas 2.2.3).

[f, g] = (dg/dq) f - (df/dq) g is formed in symbols, by exact polynomial algebra. Which brackets are independent is
decided at a rational point of the state space, without rounding. The growth vector counts the dimensions that
brackets of up to k fields span there; its length is the degree of nonholonomy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from wmrgen.errors import NotDerivableError
from wmrgen.exact.linalg import rank
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly
from wmrgen.functions.models.eta import eta_system
from wmrgen.functions.models.sheet import tidy
from wmrgen.functions.models.vector_fields import Field, by_state, to_poly, value_at
from wmrgen.functions.system import System
from wmrgen.functions.trailers.trailer import trailer_system
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.printing import exact
from wmrgen.symbolic import Expr, expression

MOST_STATES = 10  # each further state triples the time; 10 take a second
MOST_PRODUCTS = 130_000  # of terms, in all brackets together: 20,000 take a second


@dataclass(frozen=True, slots=True)
class Bracket:
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


@dataclass(frozen=True, slots=True)
class Growth:
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
        said = f"growth vector ({vector}), degree of nonholonomy {self.degree}"
        if added:
            said += f"; {', '.join(added)} add{'s' if len(added) == 1 else ''} one dimension each"
        reach = (
            "every direction" if self.controllable else f"{self.vector[-1]} of {len(self.state)} directions"
        )
        return f"{said}; the brackets reach {reach}"


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


def _products(f: Field, g: Field) -> int:
    """About how many products of terms the bracket of two fields takes."""
    return 2 * sum(len(p.terms) for p in f) * sum(len(p.terms) for p in g)


def _refuse_long(system: System, products: int) -> None:
    if products > MOST_PRODUCTS:
        raise NotDerivableError(
            f"{system.name} has Lie brackets of too many terms to be formed in symbols. "
            "Trailers that are coupled off the axle (`hitch`) double them one by one"
        )


def growth(system: System, seed: int = 0) -> Growth:
    """The growth vector of a system. NotDerivableError where it is too large for brackets in symbols."""
    if len(system.state) > MOST_STATES:
        raise NotDerivableError(
            f"{system.name} has {len(system.state)} states: Lie brackets are formed for up to {MOST_STATES}. "
            "Where a chained form of n states exists (`chained`), the growth vector is (2, 3, ..., n)"
        )
    state = tuple(p.name for p in system.state)
    numbers = {p.name: p.default for p in system.geometry if p.default is not None}
    point = _point(system, seed)
    found: list[Bracket] = []
    rows: list[list[Exact]] = []

    def add(candidate: Bracket) -> bool:
        row = [value_at(p, point, numbers) for p in candidate.polys]
        if rank([*rows, row]) == len(rows):
            return False
        found.append(candidate)
        rows.append(row)
        return True

    inputs = [
        Bracket(f"g{k + 1}", 1, tuple(to_poly(e) for e in field)) for k, field in enumerate(system.fields)
    ]
    last = [b for b in inputs if add(b)]
    vector, products = [len(rows)], 0
    while last and len(rows) < len(state):
        order = last[0].order + 1
        pairs = [(g, b) for b in last for g in inputs if g.name != b.name]
        if order == 2:
            pairs = [(a, b) for i, a in enumerate(inputs) for b in inputs[i + 1 :]]
        products += sum(_products(a.polys, b.polys) for a, b in pairs)
        _refuse_long(system, products)
        candidates = (
            Bracket(f"[{a.name}, {b.name}]", order, bracket(a.polys, b.polys, state)) for a, b in pairs
        )
        last = [c for c in candidates if len(rows) < len(state) and any(c.polys) and add(c)]
        if last:
            vector.append(len(rows))
    return Growth(state, tuple(p.name for p in system.inputs), tuple(vector), tuple(found))


def _point(system: System, seed: int) -> dict[str, Fraction]:
    """State -> a number, and for an angle the tangent of its half."""
    return {
        p.name: Fraction((-1) ** k * (2 * k + 1 + seed), 7 + 3 * k + 2 * seed)
        for k, p in enumerate(system.state)
    }


def robot_growth(robot: Robot, mobility: Mobility) -> Growth:
    """The growth of the posture model in null-space coordinates, of body and trailers where there are some."""
    if not mobility.degree_of_mobility:
        raise NotDerivableError(f"{robot.name} cannot move: it has no vector fields")
    return growth(
        trailer_system(robot, mobility, True) if robot.trailers else eta_system(robot, mobility, True)
    )
