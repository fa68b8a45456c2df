"""Equations of Siegwart, Nourbakhsh and Scaramuzza that hold."""

from __future__ import annotations

from functools import partial

import sympy

from textbook.errata import engine
from textbook.errata.checks import vanishes
from textbook.errata.claims import book, claim, residual
from textbook.errata.engine import ALPHA, BETA, GAMMA, L, R
from textbook.errata.forms import EQ, Form, Value, forms, symbol
from textbook.errata.records import Finding, Record
from textbook.errata.siegwart_conventions import BICYCLE, OMNI_STEER, ROBOTS
from textbook.transforms import world_to_robot_rows

# Pages of formulas, laid out by hand.
# fmt: off
# isort: off
from textbook.errata.siegwart import (
    K_ALPHA, K_BETA, K_RHO, TEXT, XI, M, alpha, beta, cos, omega, phid, pi, polar_motion, rho, sin, thd, theta,
    v, xd, yd)

ZERO, ONE, HALF, sqrt = sympy.S.Zero, sympy.S.One, sympy.S.Half, sympy.sqrt
TURN = world_to_robot_rows(theta)
F1, F2 = (symbol(rf"\dot{{\varphi}}_{k}") for k in (1, 2))
STACK = engine.differential()
TWIST = engine.inverse(STACK) * M([R * F1, R * F2, 0])
SUM = ALPHA + BETA
ROLL = M([[sin(SUM), -cos(SUM), -L * cos(BETA)]])
SLIDE = M([[cos(SUM), sin(SUM), L * sin(BETA)]])
SWEDISH = M([[sin(SUM + GAMMA), -cos(SUM + GAMMA), -L * cos(BETA + GAMMA)]])

holds = partial(claim, TEXT)  # a claim of this text

CONTRIBUTION = book("wheel_contributions", r=R, l=L, right_spin=F1, left_spin=F2)
EXAMPLE = {R: ONE, L: ONE, F1: sympy.Integer(4), F2: sympy.Integer(2)}
THREE = M.vstack(*(engine.rolling("swedish", alpha=a, beta=0, g=0) for a in (pi / 3, pi, -pi / 3)))
THREE_INVERSE = M([
    [1 / sqrt(3), 0, -1 / sqrt(3)],
    [-sympy.Rational(1, 3), sympy.Rational(2, 3), -sympy.Rational(1, 3)],
    [-1 / (3 * L), -1 / (3 * L), -1 / (3 * L)],
])

WHEELS = (
    holds("(3.2), (3.4), (3.5), (3.10)", "R(θ) R(θ)ᵀ = 1, and wmrgen's rotation of a velocity",
          (r"R(\theta)^{-1}", TURN.T, engine.inverse(TURN)),
          (r"\dot{x}_R", cos(theta) * xd + sin(theta) * yd,
           book("world_to_robot", theta=theta, x_rate=xd, y_rate=yd, theta_rate=thd)["vx"])),
    holds("(3.3)", "the rotation at heading π/2, which the text takes for its example",
          (r"\dot{\xi}_R", M([yd, -xd, thd]), TURN.xreplace({theta: pi / 2}) * M([xd, yd, thd]))),
    holds("(3.7)–(3.9)", "wmrgen's rows of the differential drive, solved; wheel 1 is the right one",
          (r"\omega_1", R * F1 / (2 * L), CONTRIBUTION["right.omega"]),
          (r"\omega_2", -R * F2 / (2 * L), CONTRIBUTION["left.omega"]),
          (r"\dot{\xi}_R", M([R * F1 / 2 + R * F2 / 2, 0, R * F1 / (2 * L) - R * F2 / (2 * L)]), TWIST)),
    holds("(3.12), (3.13)", "wmrgen's rolling and sliding row of a fixed wheel",
          ("J_1", ROLL, engine.rolling("fixed")), ("C_1", SLIDE, engine.sliding("fixed"))),
    holds("(3.15), (3.16)", "wmrgen's rows of a steered wheel", ("J_1", ROLL, engine.rolling("steered")),
          ("C_1", SLIDE, engine.sliding("steered")), remark="β(t) is the steering angle; its rate is absent."),
    holds("(3.19)", "wmrgen's rolling row of a Swedish wheel",
          ("J_1", SWEDISH, engine.rolling("swedish")), ("J_2", R * cos(GAMMA), engine.radius("swedish"))),
    holds("(3.19), limits", "γ = 0 gives (3.12), γ = π/2 gives (3.13)",
          (r"J_1|_{\gamma=0}", ROLL, engine.rolling("swedish", g=0)),
          (r"J_1|_{\gamma=\pi/2}", SLIDE, engine.rolling("swedish", g=pi / 2))),
    holds("(3.24)–(3.28)", "wmrgen's J₁, J₂ and C₁ of the differential drive, with the twist (3.9)",
          (r"J_1\dot{\xi}_R-J_2\dot{\varphi}", M([0, 0]), STACK[:2, :] * TWIST - R * M([F1, F2])),
          (r"C_1\dot{\xi}_R", M([0]), STACK[2, :] * TWIST)),
    holds("(3.30)", "inverse of wmrgen's stacked rows",
          (r"\begin{bmatrix}J_1\\C_1\end{bmatrix}^{-1}",
           M([[HALF, HALF, 0], [0, 0, 1], [1 / (2 * L), -1 / (2 * L), 0]]), engine.inverse(STACK))),
    holds("(3.31), (3.32)", "wmrgen's rolling rows at α = 60°, 180°, −60°",
          ("J_{1f}", M([[sqrt(3) / 2, -HALF, -L], [0, 1, -L], [-sqrt(3) / 2, -HALF, -L]]), THREE)),
    holds("(3.33)", "inverse of wmrgen's rolling rows", ("J_{1f}^{-1}", THREE_INVERSE, engine.inverse(THREE))),
    residual(TEXT, "(3.44)", "−1 times wmrgen's rolling row and spin",
             r"[-\sin,\cos,l\cos\beta]\dot{\xi}_R+r\dot{\varphi}", (-ROLL * XI)[0] + R * phid,
             lambda e: e + (engine.rolling("fixed") * XI)[0] - engine.radius("fixed") * phid))

# ---- ranks and degrees, decided on robots by wmrgen's analysis

DIFFERENTIAL, LOCKED, SINGLE = "fixed 0 -0.2 0; fixed 0 0.2 0", "fixed 0.6 0 0; fixed -0.4 0 pi", "fixed 0.2 0.1 0.3"
SYNCHRO = ("steered 0.3 0 0; steered -0.15 0.15*sqrt(3) 0; steered -0.15 -0.15*sqrt(3) 0; "
           "equal w1.steer, w2.steer, w3.steer; equal w1.spin, w2.spin, w3.spin")
NAMES = {"rank_C1f": r"\mathrm{rank}\,C_{1f}", "rank_C1": r"\mathrm{rank}\,C_1", "degree_of_mobility": r"\delta_m",
         "degree_of_steerability": r"\delta_s", "degree_of_maneuverability": r"\delta_M", "dof": r"\mathrm{DOF}",
         "ddof": r"\mathrm{DDOF}"}

def facts(text: str) -> dict[str, int]:
    """Ranks and degrees by wmrgen's analysis."""
    m = engine.robot(text).mobility
    degrees_of = {key: getattr(m, key) for key in NAMES}
    return {key: int(getattr(value, "value", value)) for key, value in degrees_of.items()}

def degrees(equation: str, says: str, *said: tuple[str, str, int], remark: str = "") -> Record:
    """Printed ranks and degrees: (robot, key, number) each."""
    shown = forms(*((symbol(NAMES[key]), EQ, sympy.Integer(n)) for _, key, n in said))

    def check(f: Form) -> Finding:
        pairs = zip(f.rights, said, strict=True)
        return vanishes([e - facts(text)[key] for e, (text, key, _) in pairs], f"wmrgen's analysis: {says}")

    return Record(TEXT, equation, check, shown, remark=remark)

def relation(equation: str, says: str, key: str, right: Value) -> Record:
    """A degree as a function of other ranks and degrees, on every robot of this page."""
    every = (*ROBOTS.values(), DIFFERENTIAL, LOCKED, SINGLE, SYNCHRO)
    shown = forms((symbol(NAMES[key]), EQ, right))

    def check(f: Form) -> Finding:
        entries = []
        for text in every:
            ranks = {symbol(NAMES[k]): sympy.Integer(n) for k, n in facts(text).items()}
            entries.append(f.rights[0].xreplace(ranks) - facts(text)[key])
        return vanishes(entries, f"{says}, for {len(every)} robots")

    return Record(TEXT, equation, check, shown)

RANKS = (
    degrees("(3.35)–(3.37)", "a single fixed wheel", (SINGLE, "rank_C1f", 1), (SINGLE, "degree_of_mobility", 2)),
    degrees("(3.38)", "differential drive", (DIFFERENTIAL, "rank_C1f", 1),
            remark="β = 0 for both wheels here, β_right = π in (3.29): the same sliding rows."),
    holds("(3.39)", "wmrgen's sliding rows at α = 0 and π, β = π/2",
          ("C_{1f}", M([[0, 1, L], [0, -1, L]]),
           M.vstack(*(engine.sliding("fixed", alpha=a, beta=pi / 2) for a in (ZERO, pi))))),
    degrees("(3.39), rank", "locked bicycle", (LOCKED, "rank_C1f", 2), (LOCKED, "degree_of_mobility", 1)),
    relation("(3.40)", "wmrgen's analysis, ranks at steering angles that meet in one ICR", "degree_of_mobility",
             3 - symbol(NAMES["rank_C1"])),
    relation("(3.42)", "wmrgen's analysis (a definition)", "degree_of_maneuverability",
             symbol(NAMES["degree_of_mobility"]) + symbol(NAMES["degree_of_steerability"])),
    degrees("3.3.3, synchro drive", "three wheels steered and driven by belts",
            (SYNCHRO, "degree_of_mobility", 1), (SYNCHRO, "degree_of_steerability", 1),
            (SYNCHRO, "degree_of_maneuverability", 2), (SYNCHRO, "dof", 2)),
    degrees("3.4.1, DOF", "by Lie brackets: differential drive, bicycle, synchro drive, locked bicycle",
            (DIFFERENTIAL, "dof", 3), (BICYCLE, "dof", 3), (SYNCHRO, "dof", 2), (LOCKED, "dof", 1)),
    degrees("fig. 3.14, omni-steer", "one steered wheel and two spheres", (OMNI_STEER, "degree_of_maneuverability", 3)))

# ---- models

UNI = M([cos(theta) * v, sin(theta) * v, omega])
FORWARD = M([[-cos(alpha), 0], [sin(alpha) / rho, -1], [-sin(alpha) / rho, 0]])
POLAR = M([[-rho * cos(beta)], [rho * sin(beta)], [-alpha - beta]])
LAW = {v: K_RHO * rho, omega: K_ALPHA * alpha + K_BETA * beta}
CLOSED = M([-K_RHO * rho * cos(alpha), K_RHO * sin(alpha) - K_ALPHA * alpha - K_BETA * beta, -K_RHO * sin(alpha)])
LINEAR = M([[-K_RHO, 0, 0], [0, -(K_ALPHA - K_RHO), -K_BETA], [0, -K_RHO, 0]])
LAMBDA = symbol(r"\lambda")
MECANUM = M.vstack(*(
    engine.wheel(px, py, angle)[0] / cos(angle)
    for px, py, angle in ((1, -1, pi / 4), (1, 1, -pi / 4), (-1, 1, pi / 4), (-1, -1, -pi / 4))
))

MODELS = (
    holds("(3.43)", "(3.43) is wmrgen's sliding row; c · curl c of a fixed wheel at P, not 0: not integrable",
          ("C_1", SLIDE, engine.sliding("fixed")),
          (r"c\cdot\nabla\times c", -ONE, engine.disk_curl())),
    holds("(3.48)", "the library's unicycle",
          *((n, e, book("unicycle", theta=theta, v=v, omega=omega)[k]) for n, e, k in zip(
              (r"\dot{x}", r"\dot{y}", r"\dot{\theta}"), UNI, ("x_rate", "y_rate", "theta_rate"), strict=True))),
    residual(TEXT, "(3.50)–(3.53)", "the pose of (ρ, α, β), differentiated, drives forwards at v and turns at ω",
             r"\begin{bmatrix}\dot{\rho}\\ \dot{\alpha}\\ \dot{\beta}\end{bmatrix}", FORWARD * M([v, omega]),
             lambda e: polar_motion(tuple(e), v), remark="Δ is goal minus robot, the goal is the origin."),
    holds("(3.56)–(3.58)", "(3.53) with the control law; 0 at (0, 0, 0)",
          (r"\begin{bmatrix}\dot{\rho}\\ \dot{\alpha}\\ \dot{\beta}\end{bmatrix}", CLOSED,
           (FORWARD * M([v, omega])).xreplace(LAW)),
          (r"f(0,0,0)", M([0, 0, 0]), CLOSED.xreplace(dict.fromkeys((rho, alpha, beta), ZERO)))),
    holds("(3.60)–(3.62)", "Jacobian of (3.58) at the goal",
          ("A", LINEAR, CLOSED.jacobian([rho, alpha, beta]).xreplace(dict.fromkeys((rho, alpha, beta), ZERO)))),
    holds("(3.63), (3.64)",
          "characteristic polynomial of A; a quadratic is Hurwitz exactly if both coefficients are positive",
          (r"\det(\lambda-A)", (LAMBDA + K_RHO) * (LAMBDA**2 + LAMBDA * (K_ALPHA - K_RHO) - K_RHO * K_BETA),
           (LAMBDA * sympy.eye(3) - LINEAR).det()), remark="Hurwitz: k_ρ > 0, k_β < 0, k_α − k_ρ > 0."),
    holds("3.6.2.3, polar coordinates",
          "determinant of the pose's Jacobian: 0 at ρ = 0, so the transform is singular there",
          (r"\det\frac{\partial(x,y,\theta)}{\partial(\rho,\alpha,\beta)}", -rho,
           POLAR.jacobian([rho, alpha, beta]).det())),
    holds("2.3.2.2, mecanum",
          "wheel speeds r φ̇ by wmrgen's rows: straight ahead all equal, sideways diagonals opposite",
          (r"r\dot{\varphi}(1,0,0)", M([1, 1, 1, 1]), MECANUM * M([1, 0, 0])),
          (r"r\dot{\varphi}(0,1,0)", M([1, -1, 1, -1]), MECANUM * M([0, 1, 0]))))

# ---- worked numbers

NUMBERS = (
    holds("(3.11)", "wmrgen's rows at r = l = 1, θ = π/2 and φ̇ = (4, 2)",
          (r"\dot{\xi}_I", M([0, 3, 1]), TURN.T.xreplace({theta: pi / 2}) * TWIST.xreplace(EXAMPLE))),
    holds("(3.34)", "wmrgen's rolling rows at r = l = 1, θ = 0 and φ̇ = (4, 1, 2)",
          (r"\dot{\xi}_I", M([2 / sqrt(3), -sympy.Rational(4, 3), -sympy.Rational(7, 3)]),
           engine.inverse(THREE).xreplace({L: ONE}) * M([4, 1, 2])), remark="The text's “speeds (φ₁ = 4)” are φ̇."))

HOLDS: tuple[Record, ...] = (*WHEELS, *RANKS, *MODELS, *NUMBERS)
