"""Siegwart, Nourbakhsh and Scaramuzza, 2.3 and 3: what is to be read with care."""

from __future__ import annotations

import sympy

from textbook.errata import engine
from textbook.errata.checks import each, identity, rights
from textbook.errata.engine import ALPHA, BETA, D, L, R
from textbook.errata.forms import EQ, Form, form, forms, symbol
from textbook.errata.records import Check, Class, Finding, Quote, Record
from textbook.errata.siegwart import TEXT, omega, vx, vy
from textbook.inverses import generic_rank
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.symbolic import number as number_of
from wmrgen.geometry.symbolic import signal

# Pages of formulas, laid out by hand.
# fmt: off

M = sympy.Matrix
cos, sin, pi = sympy.cos, sympy.sin, sympy.pi
SIGMA, BETAD = symbol(r"\sigma"), symbol(r"\dot{\beta}")

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
    part=identity(_contact, "the same with B = A + d e", {SIGMA: sympy.S.One}), condition="σ = 1, that is B = A + d e",
    kind=Class.CARE, line="castor: [.. d+l sin b] xi + d bdot = 0; rolling row unchanged",
    second=Quote(57, "cos ( α + β) sin ( α + β) d + lsin β R θ()ξ + dβ = 0 (3.18)"),
    remark="A castor that trails then has φ̇ < 0; for d > 0 with φ̇ > 0 read −d for d.")

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
    condition="no steered wheel is tied to the ICR that others fix", kind=Class.CARE,
    line="delta_s = rank[C1s(beta_s)]; automobile: rank[C1s]=1",
    second=Quote(72, "Therefore, the second steerable wheel cannot impose any independent kinematic constraint and so "
                     "rank C () = 1"),
    remark="The sentence shows how the text means it: a wheel that must follow another is not counted. The matrix "
           "itself has rank 2. All ranks with the wheels steered to one ICR; couplings (synchro drive) reduce δ_s "
           "further.")

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
    part=_bicycle(-pi / 2), condition="β₂ = −π/2", kind=Class.CARE,
    line="phi=(x/r)+phi_o for both wheels, beta=pi/2, alpha=(0,pi)",
    second=Quote(76, "{ β 12 = π 2 α = 0 α = π}"),
    remark="φ = x/r + φ₀ differentiated; that line is on the next page, which could not be read. With α₂ = π and "
           "β₂ = π/2 the second wheel points backwards.")

ENTRIES = (CASTOR, STEERABILITY, LOCKED)
