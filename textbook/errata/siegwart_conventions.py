"""What Siegwart, Nourbakhsh and Scaramuzza print and what holds only under a condition."""

from __future__ import annotations

import sympy

from textbook.errata import engine
from textbook.errata.checks import each, identity, number, rights, vanishes
from textbook.errata.engine import ALPHA, BETA, D, L, R
from textbook.errata.forms import EQ, Form, form, forms, symbol
from textbook.errata.records import Check, Finding, Record
from textbook.errata.siegwart import TEXT, omega, thd, theta, vx, vy, xd, yd
from textbook.inverses import generic_rank
from textbook.transforms import world_to_robot_rows
from wmrgen.robot import Derivation
from wmrgen.symbolic import number as number_of
from wmrgen.symbolic import signal

# Pages of formulas, laid out by hand.
# fmt: off

M = sympy.Matrix
cos, sin, pi = sympy.cos, sympy.sin, sympy.pi
SIGMA, BETAD = symbol(r"\sigma"), symbol(r"\dot{\beta}")

XI_R = symbol(r"\dot{\xi}_R")

def _turned(angle: sympy.Expr) -> sympy.Matrix:
    return world_to_robot_rows(angle) * M([xd, yd, thd])

def _frames(right: sympy.Matrix) -> sympy.Matrix:
    return right - _turned(theta)

FRAME = Record(TEXT, "(3.3)", rights(_frames, "rotation into the robot frame at heading θ"),
    form(XI_R, EQ, _turned(pi / 2)), form(XI_R, EQ, _turned(theta)),
    part=rights(_frames, "the same at θ = π/2", {theta: pi / 2}), condition="θ = π/2",
    remark="R(π/2) ξ_I and R(θ) ξ_I, multiplied out.")

_N = M([[cos(ALPHA + BETA), sin(ALPHA + BETA)]])
_E = M([[sin(ALPHA + BETA), -cos(ALPHA + BETA)]])

def _contact(left: sympy.Expr, _: sympy.Expr) -> sympy.Expr:
    """n . velocity of B = A + sigma d e, A = l (cos alpha, sin alpha), the wheel turning at omega + beta'."""
    a = M([L * cos(ALPHA), L * sin(ALPHA)])
    pivot = M([vx - omega * a[1], vy + omega * a[0]])
    arm = SIGMA * D * _E
    swing = (omega + BETAD) * M([-arm[1], arm[0]])
    return left - (_N * (pivot + swing))[0]

def _castor(side: sympy.Expr) -> Form:
    row = engine.sliding("fixed")
    lead = row[0] * vx + row[1] * vy + (side * D + row[2]) * omega
    return form(lead + side * D * BETAD, EQ, sympy.S.Zero)

CASTOR = Record(TEXT, "(3.17), (3.18)", identity(_contact, "sideways velocity of the contact B = A + σ d e"),
    _castor(sympy.S.One), _castor(SIGMA),
    part=identity(_contact, "the same with B = A + d e", {SIGMA: sympy.S.One}), condition="σ = 1: B = A + d e",
    remark="A castor that trails then has φ̇ < 0; for d > 0 with φ̇ > 0 read −d for d.")

SPEED = sympy.Symbol("V", positive=True)
ALONG = symbol(r"e\cdot V/|V|")

def _alignment(signs: tuple[int, ...]) -> Check:
    """e at the stable equilibrium of (3.18): the sliding row of wmrgen's castor for a pivot pulled along x."""

    def check(f: Form) -> Finding:
        row = engine.sliding("castor", alpha=0, l=0)
        swing = -(row[0] * SPEED) / engine.castor_rate()  # beta'
        cases = []
        for sign in signs:
            for angle in (pi / 2, -pi / 2):
                slope = sympy.diff(swing, BETA).xreplace({BETA: angle, D: sympy.S(sign)})
                if swing.xreplace({BETA: angle}) == 0 and slope < 0:
                    along = sin(angle)  # e_x at alpha = 0
                    said = f.rights[0].xreplace({D: sympy.S(sign)})
                    cases.append((said == along, f"d {'>' if sign > 0 else '<'} 0: stable at e = {along} V/|V|, "
                                                 f"β̇ falls by {-slope}/|d| per radian"))
        return each("linearised (3.18): ", cases)

    return check

ALIGN = Record(TEXT, "castor, self-alignment", _alignment((1, -1)),
    form(ALONG, EQ, sympy.S.One), form(ALONG, EQ, -sympy.sign(D)),
    part=_alignment((-1,)), condition="d < 0",
    remark="Not printed: what a reader expects of a trailing castor, that it rolls forwards when towed.")

BICYCLE, OMNI_STEER = "fixed 0 0 0; steered 1.1 0 0", "steered 0.3 0 0; spherical -0.2 0.2; spherical -0.2 -0.2"
ROBOTS = {
    "automobile": "fixed 0 0.6 0; fixed 0 -0.6 0; steered 2.5 0.6 0; steered 2.5 -0.6 0", "bicycle": BICYCLE,
    "two-steer": "steered 0.3 0.1 0; steered -0.3 0.1 0; spherical 0 -0.3", "omni-steer": OMNI_STEER,
}
RANK_S, RANK, RANK_F = (symbol(rf"\mathrm{{rank}}\,{n}") for n in ("C_{1s}", "C_1", "C_{1f}"))

def literal_rank(d: Derivation) -> int:
    """rank C1s with all wheels steered to one ICR, (0, 2) in the robot frame or (0.2, 2) without fixed wheels."""
    fixed = any(w.kind.fixed_axle for w in d.robot.wheels)
    icr = (sympy.S.Zero if fixed else sympy.Rational(1, 5), sympy.Integer(2))
    at = {}
    for w in d.robot.wheels:
        if w.kind.steers:
            x, y = (number_of(e) for e in (w.nominal.x, w.nominal.y))
            at[signal(f"{w.name}.steer")] = sympy.atan2(x - icr[0], icr[1] - y)
    return generic_rank(d.C1s.xreplace(at))

def _steerability(names: tuple[str, ...]) -> Check:
    """The formula against the degree of steerability, dimension of the ICR's freedom, of wmrgen's analysis."""

    def check(f: Form) -> Finding:
        cases = []
        for name in names:
            d = engine.robot(ROBOTS[name])
            m = d.mobility
            ranks = {RANK_S: literal_rank(d), RANK: m.rank_C1.value, RANK_F: m.rank_C1f.value}
            said = f.rights[0].xreplace({k: sympy.Integer(n) for k, n in ranks.items()})
            right = said == m.degree_of_steerability
            cases.append((right, f"{name}: {said}, steerability {m.degree_of_steerability}"))
        return each("formula and wmrgen's analysis: ", cases)

    return check

STEERABILITY = Record(TEXT, "(3.41)", _steerability(tuple(ROBOTS)),
    form(symbol(r"\delta_s"), EQ, RANK_S), form(symbol(r"\delta_s"), EQ, RANK - RANK_F),
    part=_steerability(("bicycle", "two-steer", "omni-steer")),
    condition="no steered wheel is tied to the ICR that others fix",
    remark="All ranks with the wheels steered to one ICR; couplings (synchro drive) reduce δ_s further.")

PHI1, PHI2, X = symbol(r"\dot{\varphi}_1"), symbol(r"\dot{\varphi}_2"), symbol(r"\dot{x}")

def _bicycle(beta2: sympy.Expr) -> Check:
    """Wheel speeds from wmrgen's rolling rows at alpha = 0 and pi, driving along x."""

    def residual(*right: sympy.Expr) -> list[sympy.Expr]:
        rows = engine.rolling("fixed", alpha=0, beta=pi / 2), engine.rolling("fixed", alpha=pi, beta=beta2)
        truth = [row[0] * X / engine.radius("fixed") for row in rows]
        return [e - t for e, t in zip(right, truth, strict=True)]

    return rights(residual, f"wmrgen's rolling rows with β₂ = {'π/2' if beta2 > 0 else '−π/2'}")

LOCKED = Record(TEXT, "3.4.2, locked bicycle", _bicycle(pi / 2),
    forms((PHI1, EQ, X / R), (PHI2, EQ, X / R)), forms((PHI1, EQ, X / R), (PHI2, EQ, -X / R)),
    part=_bicycle(-pi / 2), condition="β₂ = −π/2",
    remark="φ = x/r + φ₀ differentiated. With α₂ = π and β₂ = π/2 the second wheel points backwards.")

def _problem(left: sympy.Expr, right: sympy.Expr) -> Check:
    """Twist in the world frame of a differential drive: l = 5, theta = pi/4, both wheels at 6 rad/s."""

    def check(f: Form) -> Finding:
        twist = engine.inverse(engine.differential(l=5)) * M([6 * right, 6 * left, 0])
        truth = world_to_robot_rows(pi / 4).T * twist
        verdict = vanishes(f.values[-1] - truth, f"wmrgen's rows with radii {number(left)} and {number(right)}")
        return Finding(verdict.holds, f"{verdict.text}; twist ({', '.join(number(e) for e in truth)})")

    return check

def _twist(side: sympy.Expr, turn: sympy.Expr) -> Form:
    return form(M([xd, yd, thd]), EQ, M([side / sympy.sqrt(2), side / sympy.sqrt(2), turn]))

PROBLEM = Record(TEXT, "Problem 3.7.1", _problem(sympy.S.One, sympy.Rational(3, 2)),
    _twist(sympy.Integer(15), sympy.Rational(3, 5)), _twist(sympy.Rational(15, 2), sympy.Rational(3, 10)),
    part=_problem(sympy.Integer(2), sympy.Integer(3)), condition="the diameters 2 and 3 taken for r",
    remark="The answer if the book's “diameter r” is put into its formulas, and the answer for diameters 2 and 3.")

H1, H2, A1, A2 = symbol("h_1"), symbol("h_2"), symbol(r"\alpha_1"), symbol(r"\alpha_2")
DEGREE = pi / 180

def _spin(places: tuple[int, int]) -> Check:
    """Turning about P: the sliding row's third entry is 0 with the wheel at alpha heading h = alpha + beta - pi/2."""

    def check(f: Form) -> Finding:
        entries = []
        for heading, place in zip(f.rights, places, strict=True):
            at = {A1: sympy.S(places[0]), A2: sympy.S(places[1])}
            h = heading.xreplace(at) * DEGREE
            entries.append(engine.sliding("fixed", alpha=place * DEGREE, beta=h + pi / 2 - place * DEGREE, l=1)[2])
        angles = f"{places[0]}° and {places[1]}°".replace("-", "−")
        return vanishes(entries, f"sideways velocity while spinning, wheels at polar angles {angles}")

    return check

FIGURE = Record(TEXT, "figure 3.16", _spin((90, -90)),
    forms((H1, EQ, sympy.Integer(-50)), (H2, EQ, sympy.Integer(50))), forms((H1, EQ, A1 + 90), (H2, EQ, A2 - 90)),
    part=_spin((-140, 140)), condition="the wheels stand at polar angles −140° and 140°",
    remark="Headings in degrees. Printed for a two-steer robot whose wheels stand in line.")

CONVENTIONS = (FRAME, CASTOR, ALIGN, STEERABILITY, LOCKED, PROBLEM, FIGURE)
