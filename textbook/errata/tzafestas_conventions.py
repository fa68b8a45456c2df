"""What Tzafestas prints and what holds only under a condition."""

from __future__ import annotations

import sympy

from textbook.errata.checks import at_points, rights, vanishes
from textbook.errata.forms import AND, EQ, Form, form, forms, symbol
from textbook.errata.records import Check, Finding, Record
from textbook.errata.tzafestas import TEXT, XQ, YQ, D, b, cos, phi, phid, psi, r, sin, sqrt, v

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
    part=_open_domain, condition="v_r ≠ v_l (R is signed: positive turns left)")

SIDE = symbol(r"\sigma")
XG, YG = symbol(r"\dot{x}_G"), symbol(r"\dot{y}_G")

def _offset(x: sympy.Expr, y: sympy.Expr) -> list[sympy.Expr]:
    """G = Q + sigma b (cos phi, sin phi), differentiated."""
    return [x - (XQ - SIDE * b * phid * sin(phi)), y - (YQ + SIDE * b * phid * cos(phi))]

CENTRE = Record(TEXT, "Example 2.2, G", rights(_offset, "G = Q + σ b (cos φ, sin φ), differentiated"),
    forms((XG, EQ, XQ + b * phid * sin(phi)), (YG, EQ, YQ - b * phid * cos(phi))),
    forms((XG, EQ, XQ - SIDE * b * phid * sin(phi)), (YG, EQ, YQ + SIDE * b * phid * cos(phi))),
    part=rights(_offset, "G = Q − b (cos φ, sin φ), differentiated", {SIDE: sympy.S.NegativeOne}),
    condition="σ = −1: G lies behind the axle")

_QUADRANTS = [(sympy.S(a), sympy.Rational(c, 2)) for a in (1, -1) for c in (1, -1)]

def _points(forward_only: bool) -> list[tuple[sympy.Expr, sympy.Expr]]:
    return [p for p in _QUADRANTS if p[0] > 0 or not forward_only]

def _front_heading(angle: sympy.Expr) -> list[sympy.Expr]:
    """The front wheel, turning forwards, rolls along (v, D phi'): its velocity in the robot frame."""
    speed = sqrt(v**2 + (D * phid) ** 2)
    at = {D: sympy.S.One}
    return [(speed * cos(angle) - v).xreplace(at), (speed * sin(angle) - D * phid).xreplace(at)]

def _steer_check(forward_only: bool) -> Check:
    says = "velocity of the front wheel, (v, D φ′) with D = 1, along the wheel turning forwards"
    return at_points(_front_heading, (v, phid), _points(forward_only), says)

STEER = Record(TEXT, "(2.47a)", _steer_check(False),
    form(psi, EQ, sympy.atan(D * phid / v)), form(psi, EQ, sympy.atan2(D * phid, v)),
    part=_steer_check(True), condition="v > 0")

def _front_rate(rate: sympy.Expr) -> sympy.Expr:
    """r theta_w is the component of (v, D phi') along the wheel at |psi| < pi/2."""
    angle = sympy.atan(D * phid / v)
    at = {D: sympy.S.One, r: sympy.S.One}
    return (r * rate - v * cos(angle) - D * phid * sin(angle)).xreplace(at)

def _rate_check(forward_only: bool) -> Check:
    says = "component of (v, D φ′) along the wheel at |ψ| < π/2, with D = r = 1"
    return at_points(_front_rate, (v, phid), _points(forward_only), says)

SPEED = sqrt(v**2 + (D * phid) ** 2) / r
FRONT_RATE = Record(TEXT, "(2.47b)", _rate_check(False),
    form(symbol(r"\dot{\theta}_w"), EQ, SPEED), form(symbol(r"\dot{\theta}_w"), EQ, sympy.sign(v) * SPEED),
    part=_rate_check(True), condition="v > 0, the wheel turning forwards")

CONVENTIONS = (TURNING, CENTRE, STEER, FRONT_RATE)
