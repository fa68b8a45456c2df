"""Tzafestas, chapter 2: what is to be read with care."""

from __future__ import annotations

import sympy

from textbook.errata.checks import at_points, rights, vanishes
from textbook.errata.forms import AND, EQ, Form, form, forms, symbol
from textbook.errata.records import Class, Finding, Record
from textbook.errata.tzafestas import (
    LEN,
    PHI,
    PHID,
    TEXT,
    XQ,
    YQ,
    D,
    b,
    cos,
    phi,
    phid,
    psi,
    sideways,
    sin,
    sqrt,
    v,
    v1,
)

# Pages of formulas, laid out by hand.
# fmt: off

VRT, VL, A = symbol("v_r"), symbol("v_l"), symbol("a")
RADIUS = A * (VRT + VL) / (VRT - VL)

def _radius(f: Form) -> Finding:
    """R = v / omega of the differential drive, on the whole of the printed domain."""
    expr, domain = f.values[1], f.values[2]
    at_bound = bool(domain.func(1, 1))
    if at_bound and sympy.denom(sympy.together(expr)).subs(VRT, VL) == 0:
        return Finding(False, "the domain contains v_r = v_l, where the divisor is 0 (at v_r = v_l = 1: 2a/0)")
    speed, turn = (VRT + VL) / 2, (VRT - VL) / (2 * A)
    return vanishes(expr - speed / turn, "R = v_Q / φ′ for v_r ≠ v_l, with v_Q and φ′ of (2.34)")

def _open_domain(f: Form) -> Finding:
    return _radius(Form(((f.values[0], EQ, f.values[1], AND, sympy.StrictGreaterThan(VRT, VL)),)))

TURNING = Record(TEXT, "(2.43a)", _radius,
    form(symbol("R"), EQ, RADIUS, AND, sympy.GreaterThan(VRT, VL)),
    form(symbol("R"), EQ, RADIUS, AND, sympy.StrictGreaterThan(VRT, VL)),
    part=_open_domain, condition="v_r ≠ v_l (R is signed: positive turns left)", kind=Class.CARE,
    line="R = vQ/pd = a(vr+vl)/(vr-vl), vr >= vl", remark="At v_r = v_l the robot drives straight, R is infinite.")

SIDE = symbol(r"\sigma")
XG, YG = symbol(r"\dot{x}_G"), symbol(r"\dot{y}_G")

def _offset(x: sympy.Expr, y: sympy.Expr) -> list[sympy.Expr]:
    """G = Q + sigma b (cos phi, sin phi), differentiated."""
    return [x - (XQ - SIDE * b * phid * sin(phi)), y - (YQ + SIDE * b * phid * cos(phi))]

CENTRE = Record(TEXT, "Example 2.2, G", rights(_offset, "G = Q + σ b (cos φ, sin φ), differentiated"),
    forms((XG, EQ, XQ + b * phid * sin(phi)), (YG, EQ, YQ - b * phid * cos(phi))),
    forms((XG, EQ, XQ - SIDE * b * phid * sin(phi)), (YG, EQ, YQ + SIDE * b * phid * cos(phi))),
    part=rights(_offset, "G = Q − b (cos φ, sin φ), differentiated", {SIDE: sympy.S.NegativeOne}),
    condition="σ = −1, that is G lies behind the axle", kind=Class.CARE,
    line="xG_dot = xQ_dot + b pd sin, yG_dot = yQ_dot - b pd cos", remark="For G ahead of the axle read −b for b.")

_POINTS = [(sympy.S(a), sympy.Rational(c, 2)) for a in (1, -1) for c in (1, -1)]  # v and phi', forwards first

def _front_heading(angle: sympy.Expr) -> list[sympy.Expr]:
    """The front wheel, turning forwards, rolls along (v, D phi'): its velocity in the robot frame."""
    speed = sqrt(v**2 + (D * phid) ** 2)
    at = {D: sympy.S.One}
    return [(speed * cos(angle) - v).xreplace(at), (speed * sin(angle) - D * phid).xreplace(at)]

_SAYS = "velocity of the front wheel, (v, D φ′) with D = 1, along the wheel turning forwards as (2.47b) has it"
STEER = Record(TEXT, "(2.47a)", at_points(_front_heading, (v, phid), _POINTS, _SAYS),
    form(psi, EQ, sympy.atan(D * phid / v)), form(psi, EQ, sympy.atan2(D * phid, v)),
    part=at_points(_front_heading, (v, phid), _POINTS[:2], _SAYS), condition="v > 0", kind=Class.CARE,
    line="psi = arctg(D pd/v)",
    remark="(2.47b), θ′_w = √(v² + (D φ′)²)/r, then holds unchanged, forwards and backwards. If you keep "
           "|ψ| < π/2 instead, give θ′_w the sign of v. Do one of the two, never both.")

def _rates(speed: sympy.Expr) -> list[sympy.Expr]:
    rates = []
    for i in (1, 2, 3):
        product = sympy.Mul(*(cos(PHI[j - 1] - PHI[j]) for j in range(1, i)))
        rates.append(speed / LEN[i] * product * sin(PHI[i - 1] - PHI[i]))
    return rates

def _trailers_roll(*right: sympy.Expr) -> list[sympy.Expr]:
    at = {XQ: v1 * cos(PHI[0]), YQ: v1 * sin(PHI[0]), **dict(zip(PHID[1:], right, strict=True))}
    return [sideways(i).xreplace(at) for i in (1, 2, 3)]

TRAILER_RATES = Record(TEXT, "(2.70)",
    rights(_trailers_roll, "the three trailers roll without slipping while Q drives at v₁ along φ₀"),
    forms(*((PHID[i], EQ, e) for i, e in enumerate(_rates(sympy.S.One), 1))),
    forms(*((PHID[i], EQ, e) for i, e in enumerate(_rates(v1), 1))),
    part=rights(_trailers_roll, "the same at v₁ = 1", {v1: sympy.S.One}),
    condition="the right-hand sides are rates per unit of v₁, components of the vector field that v₁ multiplies",
    kind=Class.CARE,
    line="phidot_i = (1/L_i) prod_{j=1}^{i-1} cos(phi_{j-1}-phi_j) sin(phi_{i-1}-phi_i)",
    remark="Read as rates in time, it has the trailers turn while the robot is at rest. (The index of the last "
           "product reads prod_{i=1}^{N-1}, for j: likely damage.)")

ENTRIES = (TURNING, CENTRE, STEER, TRAILER_RATES)
