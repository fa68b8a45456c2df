"""Frobenius's test: which rolling constraints can be integrated to relations between positions.

One Pfaffian row c(q) . q' = 0 is integrable exactly where c ^ dc = 0, with three coordinates where c . curl c = 0
(Tzafestas (2.25): -1). A set of them is integrable exactly where the velocities that they leave are closed under Lie
brackets, which mobility answers: DDOF = DOF (Siegwart 3.4.2).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import sympy

from wmrgen.constraints import constrain, nominal_view, symbolic_view
from wmrgen.exact.poly import Poly
from wmrgen.functions.structure.forms import Form, exterior, frobenius_components, world_form
from wmrgen.functions.structure.integrals import Integral, integrals
from wmrgen.layout.records import Robot
from wmrgen.mobility.records import Mobility
from wmrgen.notation import escape
from wmrgen.printing import Latex, exact
from wmrgen.symbolic import Expr, expression

SMALL = 1e-12  # what rounding to 40 digits leaves of a zero


@dataclass(frozen=True, slots=True)
class RowTest:
    """One constraint. ``components``: coefficients of c ^ dc by coordinates; one, c . curl c, of three."""

    wheel: str
    kind: str  # sliding rolling
    coordinates: tuple[str, ...]
    row: tuple[Expr, ...]
    components: tuple[tuple[tuple[str, str, str], Expr], ...]
    integrable: bool
    curl: tuple[Expr, Expr, Expr] | None

    @property
    def value(self) -> Expr:
        """c . curl c where there are three coordinates; else a component of c ^ dc that is not 0, or 0."""
        return next((e for _, e in self.components if e != 0), sympy.S.Zero)

    @property
    def proof(self) -> str:
        """One line that can be followed by hand."""
        return self.proof_in(exact)

    def proof_in(self, shown: Callable[[Expr], str]) -> str:
        """The same line with expressions as ``shown`` writes them."""
        return _written(self, shown, _PLAIN)

    @property
    def latex(self) -> str:
        """The same line for LaTeX math."""
        return _written(self, Latex().doprint, _LATEX)

    @property
    def text(self) -> str:
        """The verdict in words."""
        verdict = "integrable" if self.integrable else "not integrable"
        return f"{self.wheel}, {self.kind} constraint: {verdict}"


@dataclass(frozen=True, slots=True)
class Integrability:
    """Each constraint by itself, all of them together, and the relations that they integrate to."""

    rows: tuple[RowTest, ...]
    ddof: int
    dof: int
    holonomic: bool
    text: str
    integrals: tuple[Integral, ...]

    def row(self, wheel: str, kind: str = "sliding") -> RowTest:
        """The test of one wheel's constraint. KeyError when there is none."""
        return {(r.wheel, r.kind): r for r in self.rows}[wheel, kind]


def integrability(robot: Robot, mobility: Mobility) -> Integrability:
    """Frobenius's test of every constraint of the layout and of all together."""
    shown, numbers = constrain(robot, symbolic_view), constrain(robot, nominal_view)
    pairs = zip((*shown.sliding, *shown.rolling), (*numbers.sliding, *numbers.rolling), strict=True)
    rows = tuple(_test(r.wheel.name, r.kind, world_form(r), world_form(n)) for r, n in pairs)
    return Integrability(
        rows, mobility.ddof, mobility.dof, mobility.holonomic, _together(mobility), integrals(robot, mobility)
    )


def _test(wheel: str, kind: str, shown: Form, numbers: Form) -> RowTest:
    """Decided on the numbers, written in the named parameters."""
    exact = dict(frobenius_components(numbers))
    integrable = all(_vanishes(p) for p in exact.values())
    found = tuple(
        (names, sympy.S.Zero if _vanishes(exact[names]) else expression(p))
        for names, p in frobenius_components(shown)
    )
    return RowTest(
        wheel, kind, shown.coordinates, tuple(expression(p) for p in shown.coefficients), found, integrable,
        _curl(shown) if len(shown.coordinates) == 3 else None,
    )  # fmt: skip


def _vanishes(poly: Poly) -> bool:
    return all(abs(float(c)) < SMALL for c in poly.terms.values())


def _curl(form: Form) -> tuple[Expr, Expr, Expr]:
    d = exterior(form)
    return expression(d[1, 2]), expression(-d[0, 2]), expression(d[0, 1])


def _together(m: Mobility) -> str:
    """The constraints on the pose; wheel angles add relations of their own (`integrals`)."""
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


@dataclass(frozen=True, slots=True)
class _Signs:
    curl: str
    curl_product: str
    wedge: str
    differential: str
    nonzero: str
    said: str
    more: str


_PLAIN = _Signs("curl c", "c . curl c", " ^ ", "d%s", " != 0", ": %s", "...")
_LATEX = _Signs(
    r"\nabla \times c",
    r"c \cdot (\nabla \times c)",
    r" \wedge ",
    r"d\mathit{%s}",
    r" \neq 0",
    r":\ \text{%s}",
    r"\dots",
)


def _written(test: RowTest, shown: Callable[[Expr], str], sign: _Signs) -> str:
    """c = (...), curl c = (...), c . curl c = ...: verdict."""
    row = ", ".join(shown(e) for e in test.row)
    verdict = sign.said % ("integrable" if test.integrable else "not integrable")
    if test.curl is not None:
        curl = ", ".join(shown(e) for e in test.curl)
        nonzero = "" if test.integrable else sign.nonzero
        return f"c = ({row}), {sign.curl} = ({curl}), {sign.curl_product} = {shown(test.value)}{nonzero}{verdict}"
    product = f"c{sign.wedge}dc"
    if test.integrable:
        return f"c = ({row}), {product} = 0{verdict}"
    names, value = next((n, e) for n, e in test.components if e != 0)
    plain = sign is _PLAIN
    basis = sign.wedge.join(sign.differential % (n if plain else escape(n)) for n in names)
    return f"c = ({row}), {product} = ({shown(value)}) {basis} + {sign.more}{sign.nonzero}{verdict}"
