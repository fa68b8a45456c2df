"""The steering coordinates of a robot and the twists that its wheels admit at them.

xi = N(beta) eta: N spans the null space of C1 (Siegwart (3.36); Campion (1996)), beta are the angles of as many
steered wheels, real or virtual, as decide where the ICR lies. All other wheels follow.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from wmrgen.constraints import View, sliding_row, symbolic_view, working_view
from wmrgen.errors import NotDerivableError
from wmrgen.exact.evaluate import fix, number
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Gen, Poly, Row, by_angle
from wmrgen.layout.records import Robot, Wheel
from wmrgen.mobility.basis import null_columns
from wmrgen.mobility.records import Mobility

# Points of the unit circle at which generic ranks are decided.
_POINTS = ((4, 3, 5), (12, -5, 13), (15, 8, 17), (24, 7, 25), (35, -12, 37), (40, 9, 41))
NEGLIGIBLE = 1e-12


@dataclass(frozen=True, slots=True)
class Frame:
    """``columns``: those of N. ``wheels``: their angles are the steering coordinates; a virtual one has index -1."""

    robot: Robot
    symbolic: bool
    columns: tuple[Row, ...]
    wheels: tuple[Wheel, ...]

    @property
    def view(self) -> View:
        """The geometry that all expressions are written in."""
        return symbolic_view if self.symbolic else working_view

    def leader(self, wheel: Wheel) -> Wheel | None:
        """The coordinate that turns ``wheel`` directly: the wheel itself or the one it is coupled to."""
        names = {w.name: w for w in self.wheels}
        if wheel.name in names or wheel.index < 0:
            return names.get(wheel.name)
        return names.get(self.robot.wheels[self.robot.steer_group[wheel.index]].name)


def frame(robot: Robot, mobility: Mobility, symbolic: bool, virtual: tuple[Wheel, ...] = ()) -> Frame:
    """Coordinates and null space; ``virtual`` wheels, as many as the degree of steerability, replace the real ones."""
    if not mobility.degree_of_mobility:
        raise NotDerivableError(f"{robot.name} cannot move (degree of mobility 0): it has no model of motion")
    if len(mobility.basis_wheels) > mobility.degree_of_steerability:
        raise NotDerivableError(
            f"{robot.name} has no model of motion with free steering rates: its couplings tie the angles of "
            f"{', '.join(mobility.basis_wheels)} together, and the degree of steerability is "
            f"{mobility.degree_of_steerability}"
        )
    if virtual:
        rows = list(constant_rows(robot, mobility))
        rows += [sliding_row(w, symbolic_view(w)).row for w in virtual]
        columns, wheels = null_columns(rows), virtual
    else:
        columns = mobility.null_space_symbolic
        wheels = tuple(robot.wheel(name) for name in mobility.basis_wheels)
    if not symbolic:
        columns = tuple(fixed(column, robot) for column in columns)
    return Frame(robot, symbolic, tuple(cleaned(column) for column in columns), wheels)


def fixed(row: Row, robot: Robot) -> Row:
    """A row with the parameters that are not tunable at their values."""
    return fix(row[0], robot.constants), fix(row[1], robot.constants), fix(row[2], robot.constants)


def constant_rows(robot: Robot, mobility: Mobility) -> list[Row]:
    """The independent rows of C1 that no steered wheel gives, parameters as symbols where a wheel gives them."""
    steered = set(mobility.basis_wheels)
    found = []
    for row in mobility.basis_rows:
        if steered & angles_in(row):
            continue
        fixed_wheels = (w for w in robot.wheels if w.kind.fixed_axle)
        source = next((w for w in fixed_wheels if sliding_row(w, working_view(w)).row == row), None)
        found.append(row if source is None else sliding_row(source, symbolic_view(source)).row)
    return found


def angles_in(polys: tuple[Poly, ...] | Row) -> set[str]:
    """Names of the wheels whose steering angle occurs."""
    found: set[str] = set()
    for p in polys:
        for g in p.generators:
            found |= {g.name} if g.kind in ("cos", "sin") else angles_in(g.args)
    return found


def cleaned(row: Row) -> Row:
    """The row without terms that only rounding of its coefficients has left over."""
    largest = max((abs(float(c)) for p in row for c in p.terms.values()), default=0.0)

    def kept(p: Poly) -> Poly:
        return Poly({m: c for m, c in p.terms.items() if abs(float(c)) > NEGLIGIBLE * largest})

    return kept(row[0]), kept(row[1]), kept(row[2])


def clean(poly: Poly) -> Poly:
    """The same for one polynomial."""
    return cleaned((poly, Poly({}), Poly({})))[0]


def nominal_at(poly: Poly, robot: Robot, angles: Callable[[str], tuple[Exact, Exact]]) -> float:
    """The value at nominal parameters; ``angles`` gives (cos, sin) of a wheel's steering angle."""

    def value(gen: Gen) -> Poly | None:
        if gen.kind in ("cos", "sin"):
            return Poly.of(angles(gen.name)[gen.kind == "sin"])
        if gen.args:
            return Poly.gen(gen.kind, gen.name, *(a.substitute(value) for a in gen.args))
        return None

    return float(number(poly.substitute(value), {p.name: p.value for p in robot.parameters}))


def straight(_: str) -> tuple[Exact, Exact]:
    """Every steering angle zero."""
    return Exact(1), Exact(0)


def generic(robot: Robot, seed: int = 0) -> Callable[[str], tuple[Exact, Exact]]:
    """Different angles for different wheels."""
    names = [w.name for w in robot.wheels] + [v.name for v in robot.virtual]

    def angle(name: str) -> tuple[Exact, Exact]:
        c, s, h = _POINTS[(names.index(name) + seed) % len(_POINTS)]
        return Exact(Fraction(c, h)), Exact(Fraction(s, h))

    return angle


def derivative(poly: Poly, name: str) -> Poly:
    """d/d(steering angle of ``name``) of a polynomial in its cosine and sine."""
    return by_angle(poly, Gen("cos", name), Gen("sin", name))
