"""Siegwart, Nourbakhsh and Scaramuzza, 2.3 and 3: errors of the text, and damage of the copy."""

from __future__ import annotations

from functools import reduce
from operator import mul
from typing import Any

import numpy as np
import sympy
from numpy.typing import NDArray

from textbook.errata import engine
from textbook.errata.checks import identity, number, rights, shape_of, units, vanishes
from textbook.errata.claims import along, book
from textbook.errata.engine import ALPHA, BETA, GAMMA, L, R
from textbook.errata.forms import AND, EQ, TIMES, Form, form, forms, symbol
from textbook.errata.records import Check, Class, Finding, Quote, Record
from textbook.errata.zero import is_zero
from textbook.transforms import world_to_robot_rows

# Pages of formulas, laid out by hand.
# fmt: off

TEXT = "Siegwart"
Array = NDArray[np.float64]
M = sympy.Matrix
cos, sin, pi = sympy.cos, sympy.sin, sympy.pi
theta, vx, vy, omega = symbol(r"\theta"), symbol("v_x"), symbol("v_y"), symbol(r"\omega")
phid, xd, yd, thd = symbol(r"\dot{\varphi}"), symbol(r"\dot{x}"), symbol(r"\dot{y}"), symbol(r"\dot{\theta}")
WORLD = M([xd, yd, thd])
XI = M([vx, vy, omega])

RIM = Record(TEXT, "3.2.2, “diameter r”",
    rights(lambda v: v - engine.radius("fixed") * phid, "rim speed, the coefficient of the wheel speed in (3.12)"),
    form(symbol("v"), EQ, R * phid / 2), form(symbol("v"), EQ, R * phid), kind=Class.OPEN,
    words="each with diameter r",
    remark="With r the diameter the rim would move at r φ̇/2; (3.7)–(3.9), (3.12) and (3.29) take r for the radius.")

ROW = M([[1, 0, 0]])
EXAMPLE = engine.sliding("fixed", alpha=0, beta=0)

def _sides(f: Form) -> Finding:
    """Left and right product of the display have one shape, and are the example's sliding row."""
    cut = f.lines[0].index(EQ)
    left, right = (
        reduce(mul, (v for v in part if isinstance(v, sympy.MatrixBase)))
        for part in (f.lines[0][:cut], f.lines[0][cut + 1 :])
    )
    if left.shape != right.shape:
        return Finding(False, f"{shape_of(left)} = {shape_of(right)}; set to 0 it would freeze all motion")
    return vanishes([left - right, right - EXAMPLE * WORLD], "wmrgen's sliding row at α = β = 0, θ = 0")

STANDARD = Record(TEXT, "(3.14)", _sides,
    form(sympy.eye(3), TIMES, WORLD, EQ, ROW, TIMES, WORLD),
    form(ROW, TIMES, sympy.eye(3), TIMES, WORLD, EQ, ROW, TIMES, WORLD), kind=Class.LIKELY,
    line="eye(3)[xd;yd;thd] = [1 0 0][xd;yd;thd] = 0", remark="The row before the unit matrix was probably lost.")

RSW, PSW = symbol(r"r_{sw}"), symbol(r"\dot{\varphi}_{sw}")
_TURNED = BETA + GAMMA
LEAD = cos(ALPHA + _TURNED) * vx + sin(ALPHA + _TURNED) * vy + L * sin(_TURNED) * omega

def _locked(left: sympy.Expr, _: sympy.Expr) -> sympy.Expr:
    """Rollers locked, the hub of a fixed wheel moves at r spin along e, the fixed wheel's rolling direction."""
    e = engine.rolling("fixed")[:2]
    at = {PSW: sympy.S.Zero, omega: sympy.S.Zero, vx: R * phid * e[0], vy: R * phid * e[1]}
    return left.xreplace(at)

ROLLERS = Record(
    TEXT, "(3.20)", identity(_locked, "with locked rollers the wheel is a fixed wheel, v = r φ̇ e of wmrgen's row"),
    form(LEAD - R * phid * sin(GAMMA) - RSW * PSW, EQ, sympy.S.Zero),
    form(LEAD + R * phid * sin(GAMMA) - RSW * PSW, EQ, sympy.S.Zero), kind=Class.ERROR,
    line="[cos(a+b+g),sin(a+b+g),l sin(b+g)]xi - r f sin g - r_sw f_sw = 0",
    second=Quote(59, "cos ( α + β + γ) sin ( α + β + γ) lsin ( β + γ) R θ()ξ – rϕsin – r ϕ · = 0 (3.20)"),
    remark="(3.19) and (3.20) project one velocity on two directions at right angles; with the minus sign a wheel "
           "whose rollers are locked would roll 2γ off its own plane. Two copies, of two editions, have that sign.")

ZERO_GLYPH = symbol("0")

def _any_heading(*left: sympy.Expr) -> list[sympy.Expr]:
    """row R(.) xi_I = row xi_R for every heading, with xi_R = R(theta) xi_I."""
    rows = (engine.rolling("fixed"), engine.sliding("fixed"))
    truth = [(row * world_to_robot_rows(theta) * WORLD)[0] for row in rows]
    return [e.xreplace({ZERO_GLYPH: sympy.S.Zero}) - t for e, t in zip(left, truth, strict=True)]

def _sphere(angle: sympy.Expr) -> Form:
    at = ALPHA + BETA
    rows = M([[sin(at), -cos(at), -L * cos(BETA)]]), M([[cos(at), sin(at), L * sin(BETA)]])
    c, s = sympy.cos(angle), sympy.sin(angle)
    xi = (c * xd + s * yd, c * yd - s * xd, thd)
    values = [sympy.Add(*(a * b for a, b in zip(row, xi, strict=True))) for row in rows]
    return forms((R * phid, EQ, values[0]), (sympy.S.Zero, EQ, values[1]))

SPHERE = Record(TEXT, "(3.21), (3.22)", rights(_any_heading, "ξ_R = R(θ) ξ_I for every heading θ"),
    _sphere(ZERO_GLYPH), _sphere(theta), kind=Class.DAMAGE, line="spherical wheel, printed R(0)",
    remark="θ was read as 0. Shown with the product multiplied out.")

PHI1, PHI2, DOT1, DOT2 = (symbol(n) for n in (r"\varphi_1", r"\varphi_2", r"\dot{\varphi}_1", r"\dot{\varphi}_2"))

def _stack(f: Form) -> Finding:
    """J1 xi - J2 spin and the sliding row, from wmrgen's rows at alpha = -+ pi/2, beta = pi and 0."""
    left, right = f.values
    truth = engine.differential() * XI - M([R * DOT1, R * DOT2, 0])
    return vanishes(left - right - truth, "wmrgen's two rolling rows and one sliding row")

STACKED = M([vx + L * omega, vx - L * omega, vy])
STACK = Record(TEXT, "(3.29), (3.30)", _stack,
    form(STACKED, EQ, M([R * PHI1, R * PHI2, 0])), form(STACKED, EQ, M([R * DOT1, R * DOT2, 0])),
    slip=units({vx: (1, -1), vy: (1, -1), omega: (0, -1), L: (1, 0), R: (1, 0), DOT1: (0, -1), DOT2: (0, -1)}),
    kind=Class.LIKELY, line="[[1,0,l],[1,0,-l],[0,1,0]]R xi=[J2 phi;0]",
    second=Quote(64, "· – 1 J ϕ – 1 J ϕ … ξ = R θ() 10 l = R θ() 0 0 1 (3.30)"),
    remark="The dots over φ were probably lost; right α = −π/2, β = π, left α = π/2, β = 0. The second copy keeps the "
           "dot over ξ and has none over φ either: the page may lack them.")

rho, alpha, beta, v = symbol(r"\rho"), symbol(r"\alpha"), symbol(r"\beta"), symbol("v")
RHO_D, ALPHA_D, BETA_D = symbol(r"\dot{\rho}"), symbol(r"\dot{\alpha}"), symbol(r"\dot{\beta}")

def polar_motion(rates: tuple[sympy.Expr, ...], speed: sympy.Expr) -> list[sympy.Expr]:
    """Velocity of the pose x = -rho cos beta, y = rho sin beta, theta = -alpha - beta, less that of the unicycle."""
    pose = M([-rho * cos(beta), rho * sin(beta), -alpha - beta])
    moved = pose.jacobian([rho, alpha, beta]) * M(rates)
    heading = -alpha - beta
    return list(moved - M([speed * cos(heading), speed * sin(heading), omega]))

def _polar(sign: int) -> Form:
    rates = M([RHO_D, ALPHA_D, BETA_D])
    matrix = M([[cos(alpha), 0], [-sin(alpha) / rho, sign], [sin(alpha) / rho, 0]])
    return form(rates, EQ, matrix, TIMES, M([v, omega]))

REVERSE = Record(TEXT, "(3.55)",
    lambda f: vanishes(polar_motion(tuple(f.values[1] * M([v, omega])), -v),
                       "the pose, differentiated, drives backwards at v and turns at ω"),
    _polar(1), _polar(-1), kind=Class.ERROR, words="v=-v",
    line="alpha in I2, v=-v: [[cos a,0],[-sin a/rho, 1],[sin a/rho,0]]",
    second=Quote(85, "redefining the forward direction of the robot by setting v = v – , we obtain a system … "
                     "α = – ----------- 1 ω (3.55)"),
    remark="With v alone reversed ω keeps its sign. As it stands it is −(3.53), which reverses ω as well. Two copies, "
           "of two editions, have it.")

K_RHO, K_ALPHA, K_BETA = symbol(r"k_\rho"), symbol(r"k_\alpha"), symbol(r"k_\beta")
GAINS = (sympy.Rational(1, 2), sympy.Rational(21, 2), sympy.Integer(-6))
START = (1.0, 1.55, 3.1)  # rho, alpha, beta

def _margin(condition: sympy.Expr, bound: sympy.Expr) -> sympy.Expr:
    """alpha' at alpha = pi/2, beta = bound on the edge of the condition, as a multiple of -k_beta."""
    edge = sympy.solve(condition, K_ALPHA)[0]
    at = {"alpha": pi / 2, "beta": bound, "rho": rho, "k_rho": K_RHO, "k_alpha": edge, "k_beta": K_BETA}
    return sympy.simplify(sympy.expand(book("polar_closed_loop", **at)["alpha_rate"]) / -K_BETA)

def _swings() -> sympy.Expr:
    """alpha'' + (k_alpha - k_rho cos alpha) alpha' - k_beta k_rho sin alpha along the closed loop."""
    names = {"rho": rho, "alpha": alpha, "beta": beta, "k_rho": K_RHO, "k_alpha": K_ALPHA, "k_beta": K_BETA}
    rates = book("polar_closed_loop", **names)
    turn = rates["alpha_rate"]
    second = along(turn, {alpha: turn, beta: rates["beta_rate"]})
    return second + (K_ALPHA - K_RHO * cos(alpha)) * turn - K_BETA * K_RHO * sin(alpha)

def _stays(bound: sympy.Expr, says: str, damped: bool = False) -> Check:
    """The condition keeps alpha below pi/2 from every |beta| <= bound; ``damped``: where k_alpha > k_rho."""

    def check(f: Form) -> Finding:
        condition = f.values[0]
        if _margin(condition, bound) <= 0 and (damped or K_ALPHA - K_RHO in f.values) and is_zero(_swings()):
            return Finding(True, f"{says}: on the edge of the condition α̇ at α = π/2 is at most 0, and |β| is then no "
                                 "larger than at first: α̈ + (k_α − k_ρ cos α) α̇ − k_β k_ρ sin α = 0 swings damped")
        value = condition.xreplace(dict(zip((K_RHO, K_ALPHA, K_BETA), GAINS, strict=True)))
        largest = _largest_alpha()
        if not (value > 0 and largest > float(pi) / 2):
            return Finding(True, f"{says}: no counterexample")
        gains = ", ".join(number(g) for g in GAINS)
        start = f"({number(START[1])}, {number(START[2])})"
        return Finding(False, f"{says}: k = ({gains}) satisfies the condition ({number(value)} > 0), and from "
                              f"(α, β) = {start} α rises to {number(largest)} > π/2")

    return check

def _largest_alpha() -> float:
    """The largest alpha along the closed loop (3.58) in the first half second, by Runge-Kutta."""
    k_rho, k_alpha, k_beta = (float(k) for k in GAINS)

    def rates(s: Array) -> Array:
        return np.array([k_rho * np.sin(s[0]) - k_alpha * s[0] - k_beta * s[1], -k_rho * np.sin(s[0])])

    state, h, top = np.array(START[1:]), 1e-3, START[1]
    for _ in range(500):
        p = rates(state)
        q = rates(state + h / 2 * p)
        u = rates(state + h / 2 * q)
        state = state + h / 6 * (p + 2 * q + 2 * u + rates(state + h * u))
        top = max(top, float(state[0]))
    return top

def _strong(factor: sympy.Expr, *more: Any) -> Form:
    return form(K_ALPHA + factor * K_BETA - 2 / pi * K_RHO, symbol(r"> 0"), AND, symbol(r"k_\rho > 0"), AND,
                symbol(r"k_\beta < 0"), *more)

STRONG = Record(TEXT, "(3.65)", _stays(pi, "α stays in I₁ for every β(0) in (−π, π)"),
    _strong(sympy.Rational(5, 3)), _strong(sympy.Integer(2), AND, K_ALPHA - K_RHO, symbol(r"> 0")),
    part=_stays(5 * pi / 6, "the same for |β(0)| ≤ 5π/6", damped=True), condition="|β(0)| ≤ 5π/6 and k_α > k_ρ",
    kind=Class.ERROR,
    line="k_rho>0, k_beta<0, k_alpha+(5/3)k_beta-(2/pi)k_rho>0 implies alpha(t) in I1 for all t",
    second=Quote(88, "k > 0 ; k < 0 ; k + 5 β 2 0 (3.65) … This implies that α ∈ I 1 for all t, whenever α 0() ∈ I 1"),
    remark="The gains (3, 8, −1.5) of (3.59) satisfy the corrected condition, which has k_α > k_ρ of (3.64) in it: "
           "without that the swing grows, and with k = (5, 3.3, −0.05) α leaves I₁ from (−1, 0). Two copies, of two "
           "editions, have the claim.")

ENTRIES = (RIM, STANDARD, ROLLERS, SPHERE, STACK, REVERSE, STRONG)
