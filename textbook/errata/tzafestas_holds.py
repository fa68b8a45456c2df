"""Equations of Tzafestas, chapter 2, that hold."""

from __future__ import annotations

from functools import partial

import sympy

from textbook.errata import engine
from textbook.errata.claims import along, book, claim, residual
from textbook.errata.forms import symbol
from textbook.errata.records import Record
from textbook.frames import skew
from textbook.inverses import generalised_inverse, penrose
from textbook.transforms import rotation_rows, world_to_robot_rows

# Pages of formulas, laid out by hand.
# fmt: off
# isort: off
from textbook.errata.tzafestas import (
    D1, D2, IK4, LEN, PHI, RR, RS, TEXT, D, M, b, cos, phi, phid, psi, r, sin, sqrt, u1, u2, v, zeta)

ZERO, ONE, HALF, PI = sympy.S.Zero, sympy.S.One, sympy.S.Half, sympy.pi
x, y, xd, yd = symbol("x"), symbol("y"), symbol(r"\dot{x}"), symbol(r"\dot{y}")
p, q, s, a = symbol("p"), symbol("q"), symbol("s"), symbol("a")
vq = symbol("v_Q")
BACK = world_to_robot_rows(phi)  # world to robot
TALL = M([[p, 1], [1, q], [0, s]])
WIDE = TALL.T

holds = partial(claim, TEXT)  # a claim of this text

# ---- 2.2: inverses and transforms

LEFT = engine.inverse(TALL.T * TALL) * TALL.T
RIGHT = WIDE.T * engine.inverse(WIDE * WIDE.T)
NUMBERS = M([[1, 2], [3, -1], [2, 5]])
PLUS = generalised_inverse(NUMBERS).matrix
TURN = rotation_rows("z", phi) * rotation_rows("x", psi)
SHIFT = M([p, q, s])

def _homogeneous(turn: sympy.Matrix, shift: sympy.Matrix) -> sympy.Matrix:
    return turn.row_join(shift).col_join(M([[0, 0, 0, 1]]))

INVERSES = (
    residual(TEXT, "(2.8a)", "the normal equations JᵀJ J⁺ = Jᵀ, for a 3×2 matrix of rank 2", "J^+", LEFT,
             lambda e: TALL.T * TALL * e - TALL.T),
    residual(TEXT, "(2.8b)", "J J⁺ = 1 and J⁺ = Jᵀ λ/2 with λ = 2 (J Jᵀ)⁻¹, for a 2×3 matrix of rank 2", "J^+", RIGHT,
             lambda e: [WIDE * e - sympy.eye(2), e - WIDE.T * (2 * engine.inverse(WIDE * WIDE.T)) / 2]),
    residual(TEXT, "Penrose conditions", "the four conditions, (J⁺)⁺ = J, (Jᵀ)⁺ = (J⁺)ᵀ and (J Jᵀ)⁺ = (J⁺)ᵀ J⁺", "J^+",
             PLUS, lambda e: [*penrose(NUMBERS, e), generalised_inverse(e).matrix - NUMBERS,
                              generalised_inverse(NUMBERS.T).matrix - e.T,
                              generalised_inverse(NUMBERS * NUMBERS.T, full=True).matrix - e.T * e]),
    residual(TEXT, "(2.9)–(2.14)", "A A⁻¹ = 1 for R = R_z(φ) R_x(ψ)", "A^{-1}",
             _homogeneous(TURN.T, -TURN.T * SHIFT), lambda e: _homogeneous(TURN, SHIFT) * e - sympy.eye(4)),
    residual(TEXT, "(2.15a)", "dR/dφ = [e_x]× R, right-handed", "R_x", rotation_rows("x", phi),
             lambda e: sympy.diff(e, phi) - skew(M([1, 0, 0])) * e),
    residual(TEXT, "(2.15c)", "dR/dφ = [e_z]× R, right-handed", "R_z", rotation_rows("z", phi),
             lambda e: sympy.diff(e, phi) - skew(M([0, 0, 1])) * e),
    holds("(2.16), (2.17)", "Siegwart's R(φ)⁻¹ in the plane",
          (r"R(\phi)", M([[cos(phi), -sin(phi)], [sin(phi), cos(phi)]]), BACK.T[:2, :2])))

# ---- disk, unicycle, differential drive

ROLL, SLIDE = engine.wheel(ZERO, ZERO, ZERO)
UNI = M([[cos(phi), 0], [sin(phi), 0], [0, 1]])
PAIR = [engine.wheel(ZERO, side * a, ZERO)[0] for side in (-1, 1)]  # right, left
STACK = M.vstack(*PAIR, SLIDE)
FORWARD = r / 2 * M([[cos(phi), cos(phi)], [sin(phi), sin(phi)], [1 / a, -1 / a]])
INVERSE = M([[cos(phi), sin(phi), a], [cos(phi), sin(phi), -a]]) / r
REAR = [engine.wheel(b, side * a, ZERO) for side in (-1, 1)]
WORLD = M([xd, yd, phid])
PFAFF = M([[-sin(phi), cos(phi), b, 0, 0, -1, 0], [-sin(phi), cos(phi), b, 0, 0, 0, -1]])
SLIP_INVERSE = M([[cos(phi), sin(phi), a, 1, 0, 0, 0], [cos(phi), sin(phi), -a, 0, 1, 0, 0]]) / r
thd = symbol(r"\dot{\theta}")

DRIVES = (
    holds("(2.24), (2.25)", "the disk rolls: the library's rates in the constraint",
          (r"\dot{x}\sin\phi-\dot{y}\cos\phi", ZERO,
           book("disk_constraint", phi=phi, x_rate=r * thd * cos(phi), y_rate=r * thd * sin(phi))["slide"]),
          remark="In step 1 “line of length” is to be read as “curve of length”."),
    holds("(2.25), nonholonomic", "c · curl c of (sin φ, −cos φ, 0): not 0, not integrable",
          (r"c\cdot\nabla\times c", -ONE, engine.disk_curl())),
    residual(TEXT, "(2.26)–(2.32)", "wmrgen's sliding row at Q annihilates J in the world frame", "J", UNI,
             lambda e: SLIDE * BACK * e),
    holds("(2.34)", "wmrgen's rolling rows of the right and the left wheel",
          ("v_r", vq + a * phid, (PAIR[0] * M([vq, 0, phid]))[0]),
          ("v_l", vq - a * phid, (PAIR[1] * M([vq, 0, phid]))[0]), remark="a is half the track."),
    holds("(2.36)–(2.38)", "wmrgen's rows, solved and turned into the world frame",
          ("J", FORWARD, BACK.T * engine.inverse(STACK) * M([[r, 0], [0, r], [0, 0]]))),
    residual(TEXT, "(2.39), (2.42)", "M J = 0 with J of (2.37d), and M is wmrgen's sliding row", "M",
             M([[-sin(phi), cos(phi), 0]]), lambda e: [e * FORWARD, e - SLIDE * BACK]),
    residual(TEXT, "(2.41c)", "the four Penrose conditions with (2.37d): it is (JᵀJ)⁻¹Jᵀ", "J^+", INVERSE,
             lambda e: penrose(FORWARD, e)),
    holds("Example 2.2", "wmrgen's rows of wheels at (b, ∓a)",
          (r"r\dot{\theta}_r", xd * cos(phi) + yd * sin(phi) + a * phid, (REAR[0][0] * BACK * WORLD)[0]),
          (r"r\dot{\theta}_l", xd * cos(phi) + yd * sin(phi) - a * phid, (REAR[1][0] * BACK * WORLD)[0]),
          ("0", -xd * sin(phi) + yd * cos(phi) + b * phid, (REAR[0][1] * BACK * WORLD)[0])),
    holds("Example 2.2, slip", "wmrgen's rows at (b, ∓a) with slip columns w (along) and z (across), at ζ = 0",
          ("J^+", SLIP_INVERSE, M.vstack(*(row * BACK for row, _ in REAR)).row_join(sympy.eye(2))
           .row_join(sympy.zeros(2)) / r),
          ("M", PFAFF, M.vstack(*(row * BACK for _, row in REAR)).row_join(sympy.zeros(2))
           .row_join(-sympy.eye(2)))),
    holds("2.2.3, freedom", "rank of wmrgen's C1f of the differential drive: one constraint for three coordinates",
          ("n-k", ONE, sympy.Integer(M.vstack(SLIDE, SLIDE).rank()))))

# ---- tricycle and car: q = (x, y, phi, psi)

FRONT = engine.wheel(D, ZERO, psi)
FRONT_XY = M.vstack(*engine.wheel(D, ZERO, ZERO))  # velocity of the front wheel along and across the robot

def _car_rolls(field: sympy.Matrix, front_speed: sympy.Expr | None) -> list[sympy.Expr]:
    """Both axles do not slide along the field, and the front wheel rolls at ``front_speed``."""
    rates = BACK * field[:3, :1]
    slides = [(SLIDE * rates)[0], (FRONT[1] * rates)[0]]
    return slides if front_speed is None else [*slides, (FRONT[0] * rates)[0] - front_speed]

def _field(forward: sympy.Expr, turn: sympy.Expr) -> sympy.Matrix:
    return M([[forward * cos(phi), 0], [forward * sin(phi), 0], [turn, 0], [0, 1]])

TRI = _field(r * cos(psi), r * sin(psi) / D)
RWD = _field(ONE, sympy.tan(psi) / D)
FWD = _field(cos(psi), sin(psi) / D)
CAR_M = M([[-sin(phi), cos(phi), 0, 0], [-sin(phi + psi), cos(phi + psi), D * cos(psi), 0]])
ZETA_STATE = (x + D * cos(phi), y + D * sin(phi), phi, phi + psi)
ZFLOW = {x: cos(phi) * cos(psi) * u1, y: sin(phi) * cos(psi) * u1, phi: sin(psi) / D * u1, psi: u2}
EPS, DIST = symbol(r"\epsilon"), symbol("L")

def _zeta_rates(right: sympy.Matrix) -> list[sympy.Expr]:
    """Against the rates along the flow, whose inputs are v1 = u1 and v2."""
    at = {u2: sin(zeta - phi) / D * u1 + u2}
    return [(e.xreplace(at) - along(s, ZFLOW)).xreplace({zeta: phi + psi})
            for e, s in zip(right, ZETA_STATE, strict=True)]

CHAIN = (x, sympy.tan(psi) / (D * cos(phi) ** 3), sympy.tan(phi), y)
W1 = u1 / cos(phi)
W2 = -3 * sin(psi) ** 2 * sin(phi) / (D * cos(phi) ** 2) * u1 + D * cos(psi) ** 2 * cos(phi) ** 3 * u2
CAR_FLOW = {x: cos(phi) * W1, y: sin(phi) * W1, phi: sympy.tan(psi) / D * W1, psi: W2}

CARS = (
    residual(TEXT, "(2.45), (2.46)",
             "wmrgen's rows: rear axle and front wheel do not slide, front wheel rolls at r", "J", TRI,
             lambda e: _car_rolls(e, r)),
    residual(TEXT, "(2.47b)", "square of the front wheel's velocity (v, D φ′): its rim turns as fast",
             r"\dot{\theta}_w", sqrt(v**2 + (D * phid) ** 2) / r,
             lambda e: (r * e) ** 2 - (FRONT_XY * M([v, ZERO, phid])).dot(FRONT_XY * M([v, ZERO, phid])),
             remark="With ψ of (2.47a) as atan2."),
    holds("(2.48)", "v/ω along (2.46)",
          ("R", D * sympy.tan(PI / 2 - psi), sympy.simplify(TRI[0, 0] / cos(phi) / TRI[2, 0]))),
    holds("(2.50), (2.51)", "wmrgen's sliding rows at Q and at P = Q + D (cos φ, sin φ)",
          ("M", CAR_M, M.vstack(SLIDE * BACK, FRONT[1] * BACK).row_join(sympy.zeros(2, 1)))),
    residual(TEXT, "(2.52)–(2.55)", "M J = 0, and v₁ is the speed of the rear axle", "J", RWD,
             lambda e: [*_car_rolls(e, None), CAR_M * e, (ROLL * BACK * e[:3, :1])[0] - 1],
             remark="Singular at ψ = ±π/2; v₁ = v_w cos ψ."),
    residual(TEXT, "(2.56a)", "M J = 0, and v₁ is the speed of the front wheel", "J", FWD,
             lambda e: [*_car_rolls(e, ONE), CAR_M * e]),
    residual(TEXT, "(2.56b)", "rates of x_p, y_p, φ and ζ = φ + ψ along (2.56a), u₁ = v₁, u₂ = sin(ζ − φ) v₁/D + v₂",
             r"\begin{bmatrix}\dot{x}_p\\ \dot{y}_p\\ \dot{\phi}\\ \dot{\zeta}\end{bmatrix}",
             M([cos(zeta) * u1, sin(zeta) * u1, sin(zeta - phi) / D * u1, u2]), _zeta_rates,
             remark="Noted were the coordinates, u₁ and u₂; that the line is written so is ours."),
    holds("(2.57a–c)", "the circle through Q, tangent to the heading, through the goal at distance L in direction ε",
          ("R", DIST / (2 * sin(EPS)), ((DIST * cos(EPS)) ** 2 + (DIST * sin(EPS)) ** 2) / (2 * DIST * sin(EPS))),
          (r"\tan\psi", 2 * D * sin(EPS) / DIST, D / (DIST / (2 * sin(EPS)))),
          ("1/R", 2 * (DIST * sin(EPS)) / DIST**2,
           2 * (DIST * sin(EPS)) / ((DIST * cos(EPS)) ** 2 + (DIST * sin(EPS)) ** 2))),
    holds("(2.66)–(2.69)", "rates of the new coordinates along (2.53) with v₁, v₂ of (2.68)",
          (r"\dot{x}_1", u1, along(CHAIN[0], CAR_FLOW)), (r"\dot{x}_2", u2, along(CHAIN[1], CAR_FLOW)),
          (r"\dot{x}_3", CHAIN[1] * u1, along(CHAIN[2], CAR_FLOW)),
          (r"\dot{x}_4", CHAIN[2] * u1, along(CHAIN[3], CAR_FLOW)), remark="For φ, ψ ≠ π/2 + kπ."))

# ---- canonical forms, trailers, omnidirectional wheels

Z1, Z2, Z3 = symbol("z_1"), symbol("z_2"), symbol("z_3")
NEW = book("chain_to_brockett", z1=Z1, z2=Z2, z3=Z3)
CHAIN3 = {Z1: u1, Z2: u2, Z3: Z2 * u1}
X4 = [symbol(f"x_{k}") for k in range(1, 5)]
FOUR = book("chain_4", **{f"x{k}": e for k, e in enumerate(X4, 1)}, u1=u1, u2=u2)
BROCKETT = book("brockett", **{f"x{k}": e for k, e in enumerate(X4[:3], 1)}, u1=u1, u2=u2)
XQ, YQ = symbol("x_Q"), symbol("y_Q")

def _hitch(i: int) -> tuple[sympy.Expr, sympy.Expr]:
    """Axle of trailer i: L_i behind the axle before it, along the trailer's heading."""
    px, py = (XQ, YQ) if i == 0 else _hitch(i - 1)
    return (px, py) if i == 0 else (px - LEN[i] * cos(PHI[i]), py - LEN[i] * sin(PHI[i]))

beta, vhx, vhy = symbol(r"\beta"), symbol("v_{hx}"), symbol("v_{hy}")

def omni_row(direction: sympy.Expr) -> sympy.Matrix:
    """wmrgen's rolling row of an omni wheel whose drive direction is ``direction``, at distance D to its right."""
    return engine.rolling("swedish", alpha=direction - PI / 2, beta=PI, g=0, l=D)

THREE = M([[1, 0, D], [-HALF, sqrt(3) / 2, D], [-HALF, -sqrt(3) / 2, D]]) / r
THREE_INVERSE = r * M([
    [sympy.Rational(2, 3), -sympy.Rational(1, 3), -sympy.Rational(1, 3)], [0, 1 / sqrt(3), -1 / sqrt(3)],
    [1 / (3 * D), 1 / (3 * D), 1 / (3 * D)],
])
ALPHA_C, PHI_C, DX, DY = symbol(r"\alpha"), symbol(r"\phi_c"), symbol("d_x"), symbol("d_y")
SUM = D1 + D2
FK4 = RR / 4 * M([[-1, 1, -1, 1], [1, 1, 1, 1], [1 / SUM, -1 / SUM, -1 / SUM, 1 / SUM]])
N_ROLL = sympy.Symbol("n", positive=True)
ROLLER = book("mecanum_wheel", radius=RR, r_sw=RS, alpha=ALPHA_C, phi=PHI_C, dx=DX, dy=DY)

def _mecanum_truth() -> sympy.Matrix:
    """wmrgen's rolling rows of Swedish wheels, y forward: heading 90 deg, gamma = +-45 deg."""
    places = [(D1, D2), (-D1, D2), (-D1, -D2), (D1, -D2)]
    rows = []
    for k, (px, py) in enumerate(places):
        angle = PI / 4 if k % 2 == 0 else -PI / 4
        rows.append(engine.wheel(px, py, PI / 2 + angle)[0] / (RR * cos(angle)))
    return M.vstack(*rows)

AUGMENTATION = holds(
      "2.4.1, velocity augmentation", "1/|cos(γ − β)|, for three wheels at (60°, 90°) and four at (45°, 90°)",
      (r"v_h/v_i", 2 / sqrt(3), 1 / cos(PI / 2 - PI / 3)), (r"v_h/v_i", sqrt(2), 1 / cos(PI / 2 - PI / 4)),
      remark="“Maximum angular velocity of each wheel” is to be read as rim speed.")

OTHERS = (
    holds("(2.58), (2.59)", "the library's chain of four and Brockett's integrator (definitions)",
          (r"\dot{x}_3", X4[1] * u1, FOUR["x3_rate"]), (r"\dot{x}_4", X4[2] * u1, FOUR["x4_rate"]),
          (r"\dot{x}_3^{B}", X4[0] * u2 - X4[1] * u1, BROCKETT["x3_rate"])),
    holds("(2.64), (2.65)", "rates of x of (2.64) along the (2,3) chain",
          (r"\dot{x}_1", u1, along(NEW["x1"], CHAIN3)), (r"\dot{x}_2", u2, along(NEW["x2"], CHAIN3)),
          (r"\dot{x}_3", NEW["x1"] * u2 - NEW["x2"] * u1, along(NEW["x3"], CHAIN3))),
    holds("2.3.6, geometry", "each axle L behind the one before, along its own heading",
          ("x_3", XQ - sum(LEN[j] * cos(PHI[j]) for j in (1, 2, 3)), _hitch(3)[0]),
          ("y_3", YQ - sum(LEN[j] * sin(PHI[j]) for j in (1, 2, 3)), _hitch(3)[1])),
    holds("(2.71b), (2.72)", "wmrgen's rolling row; β is the drive direction, the wheel is at β − 90°",
          ("v_i", vhx * cos(beta) + vhy * sin(beta) + D * phid, (omni_row(beta) * M([vhx, vhy, phid]))[0])),
    holds("(2.73), (2.74)", "wmrgen's rolling rows at β = 0°, 120°, 240°, and their inverse",
          ("J^{-1}", THREE, M.vstack(*(omni_row(k * PI * 2 / 3) for k in range(3))) / r),
          ("J", THREE_INVERSE, engine.inverse(M.vstack(*(omni_row(k * PI * 2 / 3) for k in range(3))) / r))),
    AUGMENTATION,
    holds("(2.76)–(2.79)", "determinant of the product of the wheel's and the body's matrix",
          (r"\det J_i", -RR * RS * sin(ALPHA_C),
           M(3, 3, [ROLLER[f"m{i}{j}"] for i in (1, 2, 3) for j in (1, 2, 3)]).det()),
          remark="Square, and invertible where sin α ≠ 0."),
    holds("(2.84)", "wmrgen's rolling rows of four Swedish wheels, y forward, γ = ±45°",
          ("J^{-1}", IK4, _mecanum_truth())),
    residual(TEXT, "(2.82)", "the four Penrose conditions with (2.84)", "J", FK4, lambda e: penrose(IK4, e),
             remark="Consistent where θ̇₁ + θ̇₂ = θ̇₃ + θ̇₄."),
    holds("(2.83), (2.85)", "the library's rotation into the world frame",
          (r"\dot{x}", vhx * cos(phi) - vhy * sin(phi),
           book("robot_to_world", theta=phi, vx=vhx, vy=vhy, omega=phid)["x_rate"]),
          (r"\dot{y}", vhx * sin(phi) + vhy * cos(phi),
           book("robot_to_world", theta=phi, vx=vhx, vy=vhy, omega=phid)["y_rate"])),
    holds("(2.86)–(2.91)",
          "the chord between neighbours of n points on the wheel's circle is the projection of a roller at angle α",
          (r"D_r^2\sin^2\alpha", (2 * RR * sin(PI / N_ROLL)) ** 2,
           (RR * cos(2 * PI / N_ROLL) - RR) ** 2 + (RR * sin(2 * PI / N_ROLL)) ** 2),
          ("d", 2 * RR * sin(PI / N_ROLL) / sympy.tan(ALPHA_C),
           2 * RR * sin(PI / N_ROLL) / sin(ALPHA_C) * cos(ALPHA_C)),
          remark="α from the hub axis: 90° is an omni wheel; α = 90° − |γ|."))

HOLDS: tuple[Record, ...] = (*INVERSES, *DRIVES, *CARS, *OTHERS)
