"""Equations of Kelly, chapter 4, that hold."""

from __future__ import annotations

from functools import partial

import sympy

from textbook.errata import engine
from textbook.errata.claims import claim
from textbook.errata.forms import symbol
from textbook.errata.kelly import MOTION, TEXT, L, M, W, cos, omega, sin, vx
from textbook.errata.motion import vector
from textbook.errata.records import Record
from textbook.frames import h_rows, skew

# Pages of formulas, laid out by hand.
# fmt: off

W_, AL = MOTION.omega, MOTION.alpha
R_, V_, A_ = MOTION.r, MOTION.v, MOTION.acc
ZERO = sympy.S.Zero
u, g, t = vector("u"), vector("g"), symbol("t")
r0, vel = vector("r_0"), vector("v_0")
gamma, psi, x, y = (symbol(n) for n in (r"\gamma", r"\psi", "x", "y"))

holds = partial(claim, TEXT)  # a claim of this text

# A second frame inside the first: the same motion with symbols of its own.
W2, AL2, R2, V2, A2 = (vector(n) for n in (r"\omega_s", r"\alpha_s", "r_s", "v_c", "a_c"))
VS, AS = vector("v_s"), vector("a_s")

def _swap(value: sympy.Matrix, *pairs: tuple[sympy.Matrix, sympy.Matrix]) -> sympy.Matrix:
    return value.xreplace({s: e for old, new in pairs for s, e in zip(old, new, strict=True)})

def _inside(value: sympy.Matrix) -> sympy.Matrix:
    """A derivative of the first frame in the letters of the second, which turns at W2 and AL2 against it."""
    seconds = sorted((s for s in AL.free_symbols if s.name.startswith("\\ddot")), key=lambda s: str(s.name))
    at = sympy.solve(list(AL - AL2), seconds, dict=True)[0]
    letters = ((W_, W2), (R_, R2), (V_, V2), (A_, A2), (MOTION.vm, VS), (MOTION.am, AS))
    return _swap(value.xreplace(at), *letters)

SEEN_V, SEEN_A = _inside(MOTION.velocity), _inside(MOTION.acceleration)
CHAIN_V = _swap(MOTION.velocity, (V_, SEEN_V))
CHAIN_A = _swap(MOTION.acceleration, (V_, SEEN_V), (A_, SEEN_A))

SEEN = VS + W2.cross(R2) + V2  # as the text has it, of a point in the second frame
PRINTED_V = MOTION.vm + W_.cross(R_) + SEEN
PRINTED_A = (MOTION.am + AL.cross(R_) + W_.cross(W_.cross(R_)) + 2 * W_.cross(SEEN)
             + AS + AL2.cross(R2) + W2.cross(W2.cross(R2)) + 2 * W2.cross(V2) + A2)

FRAMES = (
    holds("4.1.2.1, 4.1.2.2", "a uniform motion, differentiated: v_p = v + v₀",
          (r"\dot{r}_p^f", V_ + vel, sympy.diff(R_ + t * V_ + r0 + t * vel, t))),
    holds("4.1.2.3", "d/dt (R u) of a turning frame",
          (r"(dr/dt)_f", V_ + W_.cross(R_), MOTION.velocity - MOTION.vm)),
    holds("4.1.2.5", "d²/dt² (m + R r) of a frame that turns and moves",
          ("a", MOTION.am + AL.cross(R_) + W_.cross(W_.cross(R_)) + 2 * W_.cross(V_) + A_, MOTION.acceleration)),
    holds("4.1.3, specific force", "d²/dt² (m + R r) less g, with t = a − g at the sensor",
          ("t_c", (MOTION.am - g) + AL.cross(R_) + W_.cross(W_.cross(R_)) + 2 * W_.cross(V_) + A_,
           MOTION.acceleration - g),
          remark="4.1.3.2, the margin itself, is not in the slides: wmrgen's margin is its own."),
    holds("4.1.4.1, skew", "ω × u and −[u]× ω",
          (r"\omega\times u", skew(W_) * u, W_.cross(u)), (r"\omega\times u", -skew(u) * W_, W_.cross(u))),
    holds("(4.23), (4.24)", "H(r) ẋ with the library's H, and d/dt (m + R r)",
          ("v_o^k", h_rows(R_) * MOTION.vm.col_join(W_) + V_, MOTION.velocity)),
    holds("(4.27), (4.30)", "a frame in a frame, differentiated",
          ("v_c", PRINTED_V, CHAIN_V), remark="Ω of (4.30) is ω; r_c^s in common coordinates."),
    holds("(4.29), (4.31)", "a frame in a frame, differentiated twice", ("a_c", PRINTED_A, CHAIN_A)),
    holds("4.2.1.1", "r (cos, sin) differentiated at the turning rate ω is ω × r",
          ("v_p", M([-x * omega * sin(psi), x * omega * cos(psi)]),
           omega * sympy.diff(M([x * cos(psi), x * sin(psi)]), psi))),
    holds("(4.40)", "wmrgen's rows along x and y at the contact, for a planar twist",
          ("v_{c,x}", vx - y * omega, (engine.wheel(x, y, ZERO)[0] * M([vx, ZERO, omega]))[0]),
          ("v_{c,y}", x * omega, (engine.wheel(x, y, ZERO)[1] * M([vx, ZERO, omega]))[0])))

# ---- vehicles

DD = M([[1, W], [1, -W]])
SIDES = [engine.wheel(ZERO, side * W, ZERO)[0] for side in (-1, 1)]
FRONT = engine.wheel(L, ZERO, gamma)
FOUR_ROWS = engine.offset_wheel()
P1, P2 = [symbol(n) for n in ("x_1", "y_1")], [symbol(n) for n in ("x_2", "y_2")]
HH = M.vstack(*(M([[1, 0, -p[1]], [0, 1, p[0]]]) for p in (P1, P2)))
A_ARM, B_ARM = -engine.O * sin(engine.H), engine.O * cos(engine.H)
BACKED = M([[cos(engine.H), -sin(engine.H)], [sin(engine.H), cos(engine.H)]]) * M.vstack(*FOUR_ROWS)
HQ = M([[1, 0, -(engine.Y + B_ARM), -B_ARM], [0, 1, engine.X + A_ARM, A_ARM]])

OFFSET_V = _swap(CHAIN_V, (VS, sympy.zeros(3, 1)), (V2, sympy.zeros(3, 1)))
SPEED = symbol(r"\vert v_c\vert")
VFX, VFY = symbol("v_{f,x}"), symbol("v_{f,y}")

VEHICLES = (
    holds("(4.39)", "a frame in a frame, differentiated, with v_s^v = v_c^s = 0 as the slide assumes",
          ("v_c", MOTION.vm - skew(R_) * W_ - skew(R2) * W2, OFFSET_V), remark="r_c^s in vehicle coordinates."),
    holds("4.2.2.1.2, wheel speed", "wmrgen's rolling row of a wheel steered along v_c, as the slide assumes",
          (r"r\,\omega_{wheel}", SPEED,
           (engine.wheel(ZERO, ZERO, gamma)[0] * M([SPEED * cos(gamma), SPEED * sin(gamma), 0]))[0])),
    holds("Box 4.2", "determinant of the normal matrix: rank 3 for contacts apart",
          (r"\det H^TH", 2 * ((P1[0] - P2[0]) ** 2 + (P1[1] - P2[1]) ** 2), (HH.T * HH).det()),
          remark="Needs at least two wheels at different contact points."),
    holds("differential steer", "wmrgen's rolling rows of the right and the left wheel, and their inverse",
          ("H", DD, M.vstack(*(row.extract([0], [0, 2]) for row in SIDES))),
          ("H^{-1}", M([[W, W], [1, -1]]) / (2 * W), engine.inverse(DD))),
    holds("Ackermann, steering", "the front wheel of wmrgen's rows does not slide at tan γ = ω L/v_x",
          (r"v_x\sin\gamma-\omega L\cos\gamma", ZERO,
           (FRONT[1] * M([vx, ZERO, sympy.tan(gamma) * vx / L]))[0])),
    holds("Ackermann, forward", "velocity of the front wheel by wmrgen's rows along x and y, solved",
          (r"\begin{bmatrix} v_x\\ \omega\end{bmatrix}", M([VFX, VFY / L]),
           M.vstack(*(row.extract([0], [0, 2]) for row in engine.wheel(L, ZERO, ZERO))).inv() * M([VFX, VFY]))),
    holds("(4.62), 4WS", "wmrgen's rows of a wheel with axle offset, turned back into vehicle axes",
          (r"[H\,|\,Q]", HQ, BACKED),
          remark="Contact offset (a, b) = o (−sin, cos); o > 0 on the left. [v̇_x v̇_y ω̇] is [v_x v_y ω]."))

HOLDS: tuple[Record, ...] = (*FRAMES, *VEHICLES)
