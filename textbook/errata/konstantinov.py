"""Konstantinov: errors of the text, damage of the copy, and what holds.

Three omni wheels stand at distance a, wheel i at angle phi_i = phi + 2 pi (i-1)/3.
"""

from __future__ import annotations

from functools import partial

import sympy

from textbook.errata import engine
from textbook.errata.checks import identity, rights, undefined, units, vanishes
from textbook.errata.claims import claim, residual
from textbook.errata.forms import EQ, Form, form, forms, symbol
from textbook.errata.records import Class, Finding, Record
from textbook.transforms import world_to_robot_rows
from wmrgen.geometry.symbolic import Expr

# Pages of formulas, laid out by hand.
# fmt: off

TEXT = "Konstantinov"
M = sympy.Matrix
cos, sin, sqrt = sympy.cos, sympy.sin, sympy.sqrt
a, r, x, y, phi, phid = (symbol(n) for n in ("a", "r", "x", "y", r"\phi", r"\dot{\phi}"))
xd, yd, phi_i = symbol(r"\dot{x}"), symbol(r"\dot{y}"), symbol(r"\phi_i")
lam, mu = symbol(r"\lambda_i"), symbol(r"\mu_i")
w = [symbol(rf"\omega_{k}") for k in (1, 2, 3)]
MU = [symbol(rf"\mu_{k}") for k in (1, 2, 3)]

def angle(i: int) -> sympy.Expr:
    """phi_i of wheel i = 1, 2, 3."""
    return phi + sympy.Rational(2 * (i - 1), 3) * sympy.pi

def wheel_row(i: int) -> sympy.Matrix:
    """wmrgen's rolling row of wheel i in world coordinates: lambda_i = row (x', y', phi')."""
    place = sympy.Rational(2 * (i - 1), 3) * sympy.pi
    return engine.rolling("swedish", alpha=place, beta=0, g=0, l=a) * world_to_robot_rows(phi)

RATES = M([xd, yd, phid])
LAMBDA = xd * sin(phi_i) - yd * cos(phi_i) - a * phid  # (3)
E_I, N_I = M([[sin(phi_i), -cos(phi_i)]]), M([[cos(phi_i), sin(phi_i)]])

MU_AT = {m: xd * cos(angle(i)) + yd * sin(angle(i)) for i, m in enumerate(MU, 1)}  # (3)

def _derivative(*right: sympy.Expr) -> list[sympy.Expr]:
    place = M([x + a * cos(phi_i), y + a * sin(phi_i)])
    truth = M([xd, yd]) + sympy.diff(place, phi_i) * phid
    return [e - t for e, t in zip(right, truth, strict=True)]

XI, YI = symbol(r"\dot{x}_i"), symbol(r"\dot{y}_i")
HUB = Record(TEXT, "(2)", rights(_derivative, "(1), x_i = x + a cos φᵢ and y_i = y + a sin φᵢ, differentiated"),
    forms((XI, EQ, xd - a * phid * sin(phi_i)), (YI, EQ, yd - a * phid * cos(phi_i))),
    forms((XI, EQ, xd - a * phid * sin(phi_i)), (YI, EQ, yd + a * phid * cos(phi_i))), kind=Class.OPEN,
    line="xi_dot = xd - a pd sin phi_i ; yi_dot = yd - a pd cos phi_i",
    remark="It contradicts (1), and the paper's own vᵢ², which follows from the corrected form.")

U, OMEGA_I, W_I = symbol("u_i"), symbol(r"\omega_i"), symbol("w_i")

def _drive_speed(left: sympy.Expr, right: sympy.Expr) -> sympy.Expr:
    """|u_i|^2 = lambda_i^2 (sin^2 + cos^2) with lambda_i = r omega_i of (4)."""
    at = {U: sqrt((lam * E_I).dot(lam * E_I))}
    return (left.xreplace(at) ** 2 - right**2).xreplace({lam: r * OMEGA_I})

ABSOLUTE = Record(
    TEXT, "|u_i|", identity(_drive_speed, "squares, with uᵢ = λᵢ [sin φᵢ, −cos φᵢ] and λᵢ = r ωᵢ of (4)"),
    form(sympy.Abs(U), EQ, r * sympy.Abs(W_I)), form(sympy.Abs(U), EQ, r * sympy.Abs(OMEGA_I)),
    slip=units({U: (1, -1), W_I: (1, -1), r: (1, 0), OMEGA_I: (0, -1)}),
    kind=Class.DAMAGE, line="|u_i| = r|w_i|", remark="wᵢ is the velocity along the roller; ω was read as w.")

def _components(f: Form) -> Finding:
    """u_i + w_i is the velocity of the hub (2)."""
    u, v = f.rights
    if not all(isinstance(e, sympy.MatrixBase) for e in (u, v)):
        return Finding(False, "uᵢ and wᵢ are velocities of the plane; the printed right-hand sides are numbers")
    at = {lam: LAMBDA, mu: xd * cos(phi_i) + yd * sin(phi_i)}
    hub = M([[xd - a * phid * sin(phi_i), yd + a * phid * cos(phi_i)]])
    return vanishes(((u + v).xreplace(at) - hub), "uᵢ + wᵢ is the velocity of the hub")

COMPONENTS = Record(TEXT, "u_i, w_i before (3)", _components,
    forms((U, EQ, lam * (sin(phi_i) - cos(phi_i))), (W_I, EQ, mu * (cos(phi_i) - sin(phi_i)))),
    forms((U, EQ, lam * E_I), (W_I, EQ, mu * N_I)), kind=Class.LIKELY,
    line="u_i = lam_i(sin phi_i - cos phi_i); w_i = mu_i(cos phi_i - sin phi_i)", words="vectors u_i and v_i",
    remark="The text calls them vectors: the commas between two components probably became signs.")

DETAIL = Record(TEXT, "(4) in detail, ω₁",
    rights(lambda e: e - (wheel_row(1) * RATES)[0] / r, "wmrgen's rolling row of wheel 1"),
    form(w[0], EQ, (xd * sin(phi_i) - yd * cos(phi_i) - a * phid) / r),
    form(w[0], EQ, (xd * sin(phi) - yd * cos(phi) - a * phid) / r),
    slip=undefined(*w, xd, yd, phi, phid, a, r),
    kind=Class.LIKELY, line="omega_1 printed with phi_i",
    remark="The index i has no value here; wheel 1 is at φ₁ = φ. ω₂ and ω₃ hold.")

V = symbol("v")
SPEED = Record(TEXT, "v²",
    rights(lambda e: e.xreplace(MU_AT) - xd**2 - yd**2, "v² = ẋ² + ẏ²"),
    form(V**2, EQ, sympy.Rational(2, 3) * sum(MU)),
    form(V**2, EQ, sympy.Rational(2, 3) * sum(m**2 for m in MU)),
    kind=Class.LIKELY, line="v^2=(2/3)(mu1+mu2+mu3)",
    remark="μ₁ + μ₂ + μ₃ is 0 for every motion, so the line cannot be meant. Each missing exponent is above an "
           "index, where extractions lose them.")

OMEGA = sympy.Symbol(r"\left|\Omega\right|", positive=True)
OMEGA1 = symbol(r"\Omega_1")

CIRCLE = Record(TEXT, "R",
    rights(lambda e: e - 2 * r * OMEGA1 / 3 / (r * OMEGA / (3 * a)), "R = v/ω₀ with v = 2 r Ω₁/3 and ω₀ = r |Ω|/(3a)"),
    form(symbol("R"), EQ, a * OMEGA1 / OMEGA), form(symbol("R"), EQ, 2 * a * OMEGA1 / OMEGA), kind=Class.OPEN,
    line="R = 3av/(r|Omega|) = a Omega1/|Omega|",
    remark="The second equality contradicts the first: v = 2 r Ω₁/3 of the same page gives the factor 2.")

theta = symbol(r"\theta")
ABOVE, RIGHT = w[1] + w[2] - 2 * w[0], sqrt(3) * (w[1] - w[2])

ENTRIES = (HUB, ABSOLUTE, COMPONENTS, DETAIL, SPEED, CIRCLE)

# ---- what holds

BODY = M.vstack(*(wheel_row(i) for i in (1, 2, 3))).xreplace({phi: sympy.S.Zero})
TWIST = world_to_robot_rows(phi).T * engine.inverse(BODY) * (r * M(w))  # world velocity from wheel speeds
PLACES = [M([x + a * cos(angle(i)), y + a * sin(angle(i))]) for i in (1, 2, 3)]
HUBS = [M([xd, yd]) + sympy.diff(p, phi) * phid for p in PLACES]
E = [M([[sin(angle(i)), -cos(angle(i))]]) for i in (1, 2, 3)]
N = [M([[cos(angle(i)), sin(angle(i))]]) for i in (1, 2, 3)]
DRIVES = [(E[k] * HUBS[k])[0] * E[k].T for k in range(3)]
SLIDES = [(N[k] * HUBS[k])[0] * N[k].T for k in range(3)]
V3 = M([xd, yd])
STEP = 2 * sympy.pi / 3
HUB_I = V3 + a * phid * M([-sin(phi_i), cos(phi_i)])
MU1 = TWIST[0] * cos(phi) + TWIST[1] * sin(phi)
TIME, W0, PACE, PHI0, X0, Y0 = (symbol(n) for n in ("t", r"\omega_0", "v", r"\phi_0", "x_0", "y_0"))
PSI = [symbol(rf"\psi_{k}") for k in (1, 2, 3)]

def _drive(k: int) -> Expr:
    """lambda_k / r by wmrgen's rolling row."""
    return (wheel_row(k) * RATES)[0] / r

holds = partial(claim, TEXT)  # a claim of this text

HEADING = PHI0 - W0 * TIME  # with constant wheel speeds
CENTRE = (X0 + PACE / W0 * sin(PHI0 + theta), Y0 - PACE / W0 * cos(PHI0 + theta))
RADIUS = PACE / W0
STRAIGHT = {w[2]: -w[0] - w[1]}

HOLDS: tuple[Record, ...] = (
    holds("(1)", "wheel 2 is at distance a in direction φ + 120°: wmrgen's layout, turned by φ",
          ("x_2", x + a * cos(angle(2)), x + a * (cos(phi) * cos(STEP) - sin(phi) * sin(STEP))),
          ("y_2", y + a * sin(angle(2)), y + a * (sin(phi) * cos(STEP) + cos(phi) * sin(STEP)))),
    holds("vᵢ²", "square of the hub's velocity, (1) differentiated",
          ("v_i^2", xd**2 + yd**2 + a**2 * phid**2 - 2 * a * phid * (xd * sin(phi_i) - yd * cos(phi_i)),
           (HUB_I.T * HUB_I)[0]), remark="The next line, “vᵢ² = ẋ² + ẏ²”, is to be read as v² = ẋ² + ẏ²."),
    holds("(3)", "components of the hub's velocity along e and n",
          (r"\lambda_i", LAMBDA, (E_I * HUB_I)[0]), (r"\mu_i", xd * cos(phi_i) + yd * sin(phi_i), (N_I * HUB_I)[0])),
    holds("sums", "hub velocities and their components, added over the three wheels",
          ("v_1+v_2+v_3", 3 * V3, HUBS[0] + HUBS[1] + HUBS[2]),
          (r"\sum u_i", sympy.Rational(3, 2) * V3, DRIVES[0] + DRIVES[1] + DRIVES[2]),
          (r"\sum w_i", sympy.Rational(3, 2) * V3, SLIDES[0] + SLIDES[1] + SLIDES[2])),
    holds("(4)", "wmrgen's rolling rows; in detail for ω₂ and ω₃",
          *((rf"\omega_{i}", (xd * sin(angle(i)) - yd * cos(angle(i)) - a * phid) / r, _drive(i)) for i in (2, 3)),
          remark="“ω = ψ̇ᵢ” is to be read as ωᵢ = ψ̇ᵢ."),
    holds("(5)", "wmrgen's rolling rows, solved",
          (r"\dot{\phi}", -r / (3 * a) * sum(w), TWIST[2]),
          (r"\dot{x}", 2 * r / 3 * sum(w[k] * sin(angle(k + 1)) for k in range(3)), TWIST[0]),
          (r"\dot{y}", -2 * r / 3 * sum(w[k] * cos(angle(k + 1)) for k in range(3)), TWIST[1])),
    holds("(6)", "(5) integrated: the rate of the right-hand side along ψ̇ᵢ = ωᵢ is φ̇",
          (r"\dot{\phi}", sympy.Add(*(sympy.diff(PHI0 - r / (3 * a) * sum(PSI), p) * s
                                      for p, s in zip(PSI, w, strict=True))), TWIST[2]),
          remark="A holonomic relation between φ and the wheel angles."),
    holds("μᵢ", "component along n of the velocity solved from wmrgen's rows",
          (r"\mu_1", r / sqrt(3) * (w[1] - w[2]), MU1)),
    holds("constant wheel speeds, φ", "rate of φ₀ − ω₀ t with ω₀ = r Ω/(3a), against (5)",
          (r"\dot{\phi}", sympy.diff(HEADING, TIME).xreplace({W0: r * sum(w) / (3 * a)}), TWIST[2])),
    holds("case Ω = 0", "v² at ω₁ + ω₂ + ω₃ = 0 from wmrgen's rows",
          ("v^2", 4 * r**2 * (w[0] ** 2 + w[0] * w[1] + w[1] ** 2) / 3,
           (TWIST[0] ** 2 + TWIST[1] ** 2).xreplace(STRAIGHT))),
    residual(TEXT, "case Ω ≠ 0, θ", "direction of the velocity from wmrgen's rolling rows at φ = 0", r"\tan\theta",
             ABOVE / RIGHT, lambda e: e - (TWIST[1] / TWIST[0]).xreplace({phi: sympy.S.Zero}),
             remark="The tangent leaves a half turn open: θ = atan2(ω₂ + ω₃ − 2ω₁, √3 (ω₂ − ω₃))."),
    holds("x_C, y_C", "centre of the circle: the start, v/ω₀ to the right of the velocity at φ₀ + θ (turning at −ω₀)",
          ("x_C", CENTRE[0], X0 + RADIUS * cos(PHI0 + theta - sympy.pi / 2)),
          ("y_C", CENTRE[1], Y0 + RADIUS * sin(PHI0 + theta - sympy.pi / 2))))
