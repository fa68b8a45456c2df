"""Dimensions that Lie brackets of a model's vector fields span: its growth vector (Siegwart 3.4.1; Tzafestas 2.2.3).

Which brackets are independent is decided at a rational point of the state space, see `vector_fields`. The growth
vector lists the dimensions that brackets of up to k fields span there. Its length is the degree of nonholonomy.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.sheet import tidy
from wmrgen.functions.models.vector_fields import Field, Slopes, bracket_by, generic_point, to_poly, value_at
from wmrgen.functions.registry import Reason, UnderivableError, system_builder
from wmrgen.functions.system import System
from wmrgen.geometry.exact.linalg import rank
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.printing import exact
from wmrgen.geometry.symbolic import Expr, expression

MOST_STATES = 10  # 10 states take a second; each further state triples the time
MOST_PRODUCTS = 80_000  # products of terms in all derivatives and brackets: 7,000 to 18,000 take a second


class Bracket(NamedTuple):
    """A Lie bracket of input fields, or an input field itself."""

    name: str  # g1, [g1, g2], [g1, [g1, g2]]
    order: int  # number of input fields in it
    polys: Field  # components in the order of the state

    @property
    def field(self) -> tuple[Expr, ...]:
        """Return the components as expressions, in the order of the state."""
        return tuple(expression(p) for p in self.polys)

    def written(self, shown: Callable[[Expr], str] = exact) -> tuple[str, ...]:
        """Return the components as text: in Python syntax, or as ``shown`` writes them."""
        return tuple(shown(tidy(e)) for e in self.field)


class Growth(NamedTuple):
    """The growth vector of a system and the brackets that make it."""

    state: tuple[str, ...]
    vector: tuple[int, ...]  # dimensions spanned by brackets of up to 1, 2, ... fields
    brackets: tuple[Bracket, ...]  # those that add a dimension, the input fields first

    @property
    def degree(self) -> int:
        """Return the degree of nonholonomy: the order after which no dimension is added."""
        return len(self.vector)

    @property
    def controllable(self) -> bool:
        """Return whether the brackets span every direction of the state space."""
        return self.vector[-1] == len(self.state)

    @property
    def text(self) -> str:
        """Return the sentence on the growth vector for generic configurations."""
        return self.describe(everywhere=False)

    def describe(self, everywhere: bool) -> str:
        """Return a sentence: the growth vector, where it is valid, and which bracket adds each dimension."""
        vector = ", ".join(map(str, self.vector))
        added = [b.name for b in self.brackets if b.order > 1]
        where = "wherever the model holds" if everywhere else "at generic configurations"
        text = f"growth vector ({vector}) {where}, degree of nonholonomy {self.degree}"
        if added:
            text += f"; {', '.join(added)} add{'s' if len(added) == 1 else ''} one dimension each"
        reach = (
            "every direction" if self.controllable else f"{self.vector[-1]} of {len(self.state)} directions"
        )
        return f"{text}; the brackets reach {reach}"


def growth(system: System, seed: int = 0, most: int = MOST_PRODUCTS) -> Growth:
    """Return the growth vector of a system.

    Args:
        system: A model with few enough states.
        seed: Chooses the rational point at which ranks are taken.
        most: How many products of terms may be formed.

    Raises:
        NotDerivableError: If the system has too many states, or if its brackets take more than ``most`` products.
    """
    if len(system.state) > MOST_STATES:
        raise UnderivableError(
            f"{system.name} has {len(system.state)} states, and Lie brackets are formed for up to {MOST_STATES}. "
            "If the robot has a chained form of n states (`chained`), the growth vector is (2, 3, ..., n)",
            Reason.TOO_LONG,
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

    try:
        fields = [tuple(map(to_poly, field)) for field in system.fields]
    except ValueError as error:  # such as |b|, or a fourth root
        raise UnderivableError(
            f"{system.name} has formulas that are no polynomials in cosines and sines: {error}", Reason.OTHER
        ) from None
    inputs = [Bracket(f"g{k + 1}", 1, field) for k, field in enumerate(fields)]
    newest = [b for b in inputs if adds_a_dimension(b)]
    vector, work, slopes = [len(reached)], 0, Slopes(state)
    rates: dict[str, tuple[Field, ...]] = {}
    if any(g.kind in ("inv", "sqrt") for b in inputs for p in b.polys for g in p.generators):
        most //= 3  # a term with a root or an inverse takes longer
    while newest and len(reached) < len(state):
        pairs, formed = _pairs(inputs, newest), [b for b in newest if b.name not in rates]
        work += sum(slopes.products(b.polys) for b in formed)
        if work <= most:
            rates |= {b.name: slopes.jacobian(b.polys) for b in formed}
            work += sum(_products(a, rates[a.name], b, rates[b.name]) for a, b in pairs)
        if work > most:
            raise UnderivableError(
                f"the Lie brackets of {system.name} have too many terms to be formed in symbols. "
                "Each trailer that is coupled off the axle (`hitch`) doubles the number of terms",
                Reason.TOO_LONG,
            )
        order = len(vector) + 1
        brackets = (
            Bracket(
                f"[{a.name}, {b.name}]", order, bracket_by(a.polys, rates[a.name], b.polys, rates[b.name])
            )
            for a, b in pairs
        )
        newest = [b for b in brackets if len(reached) < len(state) and any(b.polys) and adds_a_dimension(b)]
        if newest:
            vector.append(len(reached))
    return Growth(state, tuple(vector), tuple(reached))


def _pairs(inputs: list[Bracket], newest: list[Bracket]) -> list[tuple[Bracket, Bracket]]:
    """Return the pairs whose bracket may add a dimension: each input with each field that added one last."""
    if newest[0].order == 1:
        return [(a, b) for i, a in enumerate(inputs) for b in inputs[i + 1 :]]
    return [(g, b) for b in newest for g in inputs]


def _products(f: Bracket, df: tuple[Field, ...], g: Bracket, dg: tuple[Field, ...]) -> int:
    """Return how many products of terms the bracket of two fields takes."""
    count = 0
    for jacobian, field in ((dg, f), (df, g)):
        for row in jacobian:
            count += sum(len(p.terms) * len(q.terms) for p, q in zip(row, field.polys, strict=True))
    return count


def robot_growth(robot: Robot, mobility: Mobility, most: int = MOST_PRODUCTS) -> Growth:
    """Return the growth vector of a robot's model, see `growing`.

    Args:
        robot: The robot.
        mobility: Its mobility.
        most: How many products of terms may be formed.
    """
    return growth(growing(robot, mobility), most=most)


def growing(robot: Robot, mobility: Mobility) -> System:
    """Return the model whose brackets are formed: posture in null-space coordinates, with trailers if there are any."""
    if not mobility.degree_of_mobility:
        raise UnderivableError(f"{robot.name} cannot move: it has no vector fields", Reason.MOBILITY)
    return system_builder("trailer" if robot.trailers else "eta")(robot, mobility, True)
