"""Frobenius's test: which rolling constraints can be integrated to relations between positions.

A Pfaffian row a . xi + (joint rates) becomes the one-form c = c_x dx + c_y dy + c_theta dtheta + ... in the world
frame, by xi = R(theta) (x', y', theta'). It is integrable exactly if c ^ dc = 0; with three coordinates, if c . curl c
= 0 (Tzafestas (2.25): -1). A set of rows is integrable exactly if the velocities that they admit are closed under Lie
brackets. The mobility answers this: DDOF = DOF (Siegwart 3.4.2).

Coefficients are polynomials in the cosine and sine of theta and of steering angles. sin**2 is replaced by 1 - cos**2,
so every polynomial has one form, and a zero is recognised.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations
from typing import NamedTuple

import sympy

from wmrgen.analysis.mobility.records import Mobility
from wmrgen.functions.models.integrals import Integral, integrals
from wmrgen.functions.models.polynomials import by_steering
from wmrgen.functions.models.vector_fields import by_state
from wmrgen.geometry.constraints import ConstraintRow, constrain, nominal_view, symbolic_view
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Robot
from wmrgen.geometry.notation import escape
from wmrgen.geometry.printing import Latex, exact
from wmrgen.geometry.symbolic import Expr, expression

SMALL = 1e-12  # far above the rounding error of coefficients with 40 digits
ZERO = Poly({})
THETA = Poly.gen("input", "theta")


class RowTest(NamedTuple):
    """The test of one constraint."""

    wheel: str
    kind: str  # sliding or rolling
    coordinates: tuple[str, ...]  # names of the coordinates of the one-form
    row: tuple[Expr, ...]  # coefficients of the one-form c
    # coefficients of c ^ dc by coordinates; for three coordinates one, c . curl c
    components: tuple[tuple[tuple[str, str, str], Expr], ...]
    integrable: bool
    curl: tuple[Expr, Expr, Expr] | None  # for three coordinates only

    @property
    def value(self) -> Expr:
        """Return c . curl c for three coordinates; else a component of c ^ dc that is not 0, or 0."""
        return next((e for _, e in self.components if e != 0), sympy.S.Zero)

    def proof(self, shown: Callable[[Expr], str] = exact) -> str:
        """Return one line that can be followed by hand. ``shown`` writes the expressions."""
        return _written(self, shown, latex=False)

    @property
    def latex(self) -> str:
        """Return the same line as LaTeX math."""
        return _written(self, Latex().doprint, latex=True)


class Integrability(NamedTuple):
    """Each constraint by itself, all of them together, and the relations that they integrate to."""

    rows: tuple[RowTest, ...]
    ddof: int
    dof: int
    holonomic: bool
    text: str
    integrals: tuple[Integral, ...]

    def row(self, wheel: str, kind: str = "sliding") -> RowTest:
        """Return the test of one wheel's constraint. Raise KeyError if there is none."""
        return {(r.wheel, r.kind): r for r in self.rows}[wheel, kind]


def integrability(robot: Robot, mobility: Mobility) -> Integrability:
    """Return Frobenius's test of every constraint of the layout and of all together."""
    shown, numbers = constrain(robot, symbolic_view), constrain(robot, nominal_view)
    pairs = zip((*shown.sliding, *shown.rolling), (*numbers.sliding, *numbers.rolling), strict=True)
    rows = tuple(_test(r.wheel.name, r.kind, world_form(r), world_form(n)) for r, n in pairs)
    return Integrability(
        rows, mobility.ddof, mobility.dof, mobility.holonomic, _together(mobility), integrals(robot, mobility)
    )


class Form(NamedTuple):
    """A one-form."""

    coordinates: tuple[str, ...]
    coefficients: tuple[Poly, ...]  # ``coefficients[k]`` belongs to d(``coordinates[k]``)


def world_form(row: ConstraintRow) -> Form:
    """Return the form of a constraint row on x, y, theta, the wheel's steering angle and its wheel angle."""
    a, b, k = row.row
    c, s = Poly.gen("cosf", "", THETA), Poly.gen("sinf", "", THETA)
    coordinates = ["x", "y", "theta"]
    coefficients = [a * c - b * s, a * s + b * c, k]
    rates = dict(row.rates)
    if row.wheel.turns:
        coordinates.append(f"{row.wheel.name}.steer")
        coefficients.append(rates.get((row.wheel.index, "steer"), ZERO))
    if (row.wheel.index, "spin") in rates:
        coordinates.append(f"{row.wheel.name}.angle")
        coefficients.append(rates[row.wheel.index, "spin"])
    return Form(tuple(coordinates), tuple(coefficients))


def partial(poly: Poly, coordinate: str) -> Poly:
    """Return d poly / d coordinate for theta and steering angles; no coefficient depends on another coordinate."""
    if coordinate.endswith(".steer"):
        return by_steering(poly, coordinate.removesuffix(".steer"))
    return by_state(poly, coordinate) if coordinate == "theta" else ZERO


def exterior(form: Form) -> dict[tuple[int, int], Poly]:
    """Return dc: the coefficient of dq_i ^ dq_j, i < j, is d_i c_j - d_j c_i."""
    q, c = form.coordinates, form.coefficients
    return {(i, j): partial(c[j], q[i]) - partial(c[i], q[j]) for i, j in combinations(range(len(q)), 2)}


def frobenius_components(form: Form) -> Iterator[tuple[tuple[str, str, str], Poly]]:
    """Yield c ^ dc: the coefficient of dq_i ^ dq_j ^ dq_k is c_i (dc)_jk - c_j (dc)_ik + c_k (dc)_ij."""
    d = exterior(form)
    q, c = form.coordinates, form.coefficients
    for i, j, k in combinations(range(len(q)), 3):
        yield (q[i], q[j], q[k]), c[i] * d[j, k] - c[j] * d[i, k] + c[k] * d[i, j]


def _test(wheel: str, kind: str, shown: Form, numbers: Form) -> RowTest:
    """Return the test of a row, decided on the numbers and written in the named parameters."""
    vanishes = {}
    for names, p in frobenius_components(numbers):
        vanishes[names] = all(abs(float(c)) < SMALL for c in p.terms.values())
    components = tuple(
        (names, sympy.S.Zero if vanishes[names] else expression(p))
        for names, p in frobenius_components(shown)
    )
    row = tuple(expression(p) for p in shown.coefficients)
    curl = _curl(shown) if len(shown.coordinates) == 3 else None
    return RowTest(wheel, kind, shown.coordinates, row, components, all(vanishes.values()), curl)


def _curl(form: Form) -> tuple[Expr, Expr, Expr]:
    """Return curl c of a form of three coordinates."""
    d = exterior(form)
    return expression(d[1, 2]), expression(-d[0, 2]), expression(d[0, 1])


def _together(m: Mobility) -> str:
    """Return a sentence on all constraints of the pose; wheel angles add relations of their own (`integrals`)."""
    reached = f"they leave DDOF = {m.ddof} velocities, whose Lie brackets reach DOF = {m.dof}"
    if m.ddof == 3:
        return "No constraint on the pose is left (DDOF = DOF = 3): the robot is holonomic."
    if not m.ddof:
        return f"The constraints on the pose are integrable: {reached}. The robot cannot move."
    if m.holonomic:
        return f"The constraints on the pose are integrable together (Frobenius): {reached}. The robot is holonomic."
    return (
        f"The constraints on the pose are not integrable (Frobenius): {reached}. The robot is nonholonomic."
    )


def _written(test: RowTest, shown: Callable[[Expr], str], *, latex: bool) -> str:
    """Return c = (...), curl c = (...), c . curl c = ...: verdict."""
    verdict = "integrable" if test.integrable else "not integrable"
    end = rf":\ \text{{{verdict}}}" if latex else f": {verdict}"
    nonzero = "" if test.integrable else r" \neq 0" if latex else " != 0"
    row = f"c = ({', '.join(shown(e) for e in test.row)})"
    if test.curl is not None:
        curl = r"\nabla \times c" if latex else "curl c"
        product = rf"c \cdot ({curl})" if latex else f"c . {curl}"
        components = ", ".join(shown(e) for e in test.curl)
        return f"{row}, {curl} = ({components}), {product} = {shown(test.value)}{nonzero}{end}"
    wedge = r" \wedge " if latex else " ^ "
    if test.integrable:
        return f"{row}, c{wedge}dc = 0{end}"
    names, value = next((n, e) for n, e in test.components if e != 0)
    basis = wedge.join(rf"d\mathit{{{escape(n)}}}" if latex else f"d{n}" for n in names)
    more = r"\dots" if latex else "..."
    return f"{row}, c{wedge}dc = ({shown(value)}) {basis} + {more}{nonzero}{end}"
