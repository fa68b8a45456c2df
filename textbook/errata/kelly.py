"""Kelly, chapter 4 (slides): damage of the copy, and what is to be read with care."""

from __future__ import annotations

from collections.abc import Mapping

import sympy

from textbook.errata import engine
from textbook.errata.checks import identity, undefined, units, vanishes
from textbook.errata.forms import EQ, PLUS, Form, form, symbol
from textbook.errata.motion import Turning
from textbook.errata.records import Check, Class, Finding, Record
from textbook.frames import skew

# Pages of formulas, laid out by hand.
# fmt: off

TEXT = "Kelly"
M = sympy.Matrix
cos, sin = sympy.cos, sympy.sin
MOTION = Turning()
SPEED_UNIT, RATE_UNIT, LENGTH = (1, -1), (0, -1), (1, 0)

VO, VM, VR, CROSS = (symbol(n) for n in (r"v_o^f", r"v_m^f", r"v_o^m", r"\omega_m^f\times r_o^m"))
DOT_VO, DOT_VM, DOT_VR = (symbol(n) for n in (r"\dot{v}_o^f", r"\dot{v}_m^f", r"\dot{v}_o^m"))

def _sum(right: sympy.Expr, values: Mapping[sympy.Expr, sympy.Matrix]) -> sympy.Matrix:
    """The terms of a sum of symbols, each with its value."""
    return sum((values[term] for term in sympy.Add.make_args(right)), sympy.zeros(3, 1))

def _velocity(f: Form) -> Finding:
    """Every term as it is for a point of a turning frame, at a moment when the frames are parallel."""
    truth = {VO: MOTION.velocity, VM: MOTION.vm, VR: MOTION.v, CROSS: skew(MOTION.omega) * MOTION.r}
    left, right = f.values
    return vanishes(_sum(right, truth) - truth[left], "d/dt (m + R r) of a frame that turns and moves")

VELOCITY = Record(TEXT, "4.1.2.4", _velocity,
    form(DOT_VO, EQ, DOT_VM + CROSS + DOT_VR), form(VO, EQ, VM + CROSS + VR),
    slip=units({CROSS: SPEED_UNIT, **dict.fromkeys((VO, VM, VR), SPEED_UNIT),
                **dict.fromkeys((DOT_VO, DOT_VM, DOT_VR), (1, -2))}),
    kind=Class.DAMAGE, line="vdot_o^f = vdot_m^f + omega x r + vdot_o^m",
    remark="The arrows over the vectors came out as dots.")

AO, WXX = symbol("a_o^k"), symbol(r"[\omega]_{\times\times}")
I3, R_X, W_X, TWO_W = (symbol(n) for n in ("I", r"-[r]_\times", r"[\omega]_\times", r"2[\omega]_\times"))
WW = symbol(r"[\omega]_\times[\omega]_\times")
A_K, ALPHA_K, R_K, V_K, W_K, A_N = (symbol(n) for n in ("a", r"\alpha", "r", "v", r"\omega", "a_o^{k+1}"))
BLOCKS = {
    I3: sympy.eye(3), R_X: -skew(MOTION.r), W_X: skew(MOTION.omega),
    TWO_W: 2 * skew(MOTION.omega), WW: skew(MOTION.omega) * skew(MOTION.omega),
}
STACK = {A_K: MOTION.am, ALPHA_K: MOTION.alpha, R_K: MOTION.r, V_K: MOTION.v, A_N: MOTION.acc}

def _product(blocks: sympy.Matrix, stack: sympy.Matrix) -> sympy.Matrix:
    return sum((BLOCKS[a] * STACK[b] for a, b in zip(blocks, stack, strict=True)), sympy.zeros(3, 1))

def _blocks(f: Form) -> Finding:
    """Sum of block row times stack over the pairs of the display, against the second derivative."""
    rows = [v for v in f.values if isinstance(v, sympy.MatrixBase)]
    total = -MOTION.acceleration
    for block, stack in zip(rows[::2], rows[1::2], strict=True):
        if block.cols != stack.rows:
            return Finding(False, f"{block.cols} blocks do not act on a stack of {stack.rows}")
        total += _product(block, stack)
    return vanishes(total, "d²/dt² (m + R r) of a frame that turns and moves")

DEFINED = (AO, *BLOCKS, *STACK, W_K)
ACCELERATION = Record(TEXT, "4.1.4.1, acceleration", _blocks,
    form(AO, EQ, M([[I3, R_X]]), M([A_K, ALPHA_K]), PLUS, M([[WXX, TWO_W, I3]]), M([R_K, V_K, W_K, A_N])),
    form(AO, EQ, M([[I3, R_X]]), M([A_K, ALPHA_K]), PLUS, M([[WW, TWO_W, I3]]), M([R_K, V_K, A_N])),
    slip=undefined(*DEFINED),
    kind=Class.LIKELY, line="a_o^k=[I|-[r]x][a;alpha]+[[w]xx|2[w]x|I][r;v;omega;a]",
    remark="The stack of four does not fit the three blocks either.")

def _omega(f: Form) -> Finding:
    """Omega (r, v) is the centripetal and the Coriolis acceleration."""
    rest = MOTION.acceleration - MOTION.am - skew(MOTION.alpha) * MOTION.r - MOTION.acc
    block, stack = f.values[1:]
    return vanishes(_product(block, stack) - rest, "d²/dt² (m + R r) less a, α × r and the relative acceleration")

OMEGA = Record(TEXT, "(4.25)", _omega,
    form(symbol(r"\Omega\rho"), EQ, M([[W_X, TWO_W]]), M([R_K, V_K])),
    form(symbol(r"\Omega\rho"), EQ, M([[WW, TWO_W]]), M([R_K, V_K])),
    kind=Class.LIKELY, line="[[omega]x | 2[omega]x][r;v]",
    remark="(4.31) of the slides has the double cross: one of two equal glyphs side by side was probably lost.")

xd, yd, psi, DASH = symbol(r"\dot{x}"), symbol(r"\dot{y}"), symbol(r"\psi"), symbol("-")

def _rolls(left: sympy.Expr, _: sympy.Expr) -> sympy.Expr:
    v = symbol("v")
    at = {DASH: sympy.S.NegativeOne, xd: v * cos(psi), yd: v * sin(psi)}
    return left.xreplace(at)

DISK = Record(TEXT, "4.2.1.4", identity(_rolls, "a disk that rolls, (ẋ, ẏ) = v (cos ψ, sin ψ), satisfies it"),
    form(DASH * xd * sin(psi) - yd * cos(psi), EQ, sympy.S.Zero),
    form(xd * sin(psi) - yd * cos(psi), EQ, sympy.S.Zero),
    kind=Class.DAMAGE, line="- xd s psi - yd c psi = 0", remark="The first dash is the bullet of the slide.")

W, vx, omega, L = symbol("W"), symbol("v_x"), symbol(r"\omega"), symbol("L")
RL, VL = symbol("r_l^v"), symbol("v_l^v")

def _left_wheel(x: sympy.Expr, y: sympy.Expr) -> sympy.Expr:
    """The left wheel of the H matrix, v_l = v_x - W omega, with the wheel at (x, y)."""
    return (vx - y * omega) - (vx - W * omega) + 0 * x

POSITION = Record(TEXT, "differential steer, positions",
    lambda f: vanishes(_left_wheel(*f.values[1]), "speed v_x − y ω of the left wheel against row [1, −W]"),
    form(VL, EQ, M([[0, W]])), form(RL, EQ, M([[0, W]])),
    slip=units({VL: SPEED_UNIT, RL: LENGTH, W: LENGTH}),
    kind=Class.LIKELY, line="v_l^v=[0 W]^T, v_r^v=[0 -W]^T",
    remark="A position, so r was read as v. The same for the right wheel; W is half the track.")

VF, VV, RC, RF, OM = (symbol(n) for n in ("v_f^w", "v_v^w", r"[r_c^v]_\times", r"[r_f^v]_\times", r"\omega_v^w"))

def _front_wheel(f: Form) -> Finding:
    position, twist = skew(M([L, 0, 0])), M([0, 0, omega])
    truth = {VV: M([vx, 0, 0]), -RF * OM: -position * twist}
    return vanishes(_sum(f.values[1], truth) - M([vx, omega * L, 0]), "the slide's own result v_f = [v_x, ω L]")

ACKERMANN = Record(TEXT, "Ackermann, wheel equation", _front_wheel,
    form(VF, EQ, VV - RC * VV), form(VF, EQ, VV - RF * OM),
    slip=units({VF: SPEED_UNIT, VV: SPEED_UNIT, RC: LENGTH, RF: LENGTH, OM: RATE_UNIT}), kind=Class.LIKELY,
    line="v_f^w = v_v^w - [r_c^v]x v_v^w", remark="ω was read as v; the slide's result holds.")

VI, RI, OWN = symbol("v_i^w"), symbol(r"[r_i^v]_\times"), symbol(r"\omega_v^v")
xi, yi, vy = symbol("x_i"), symbol("y_i"), symbol("v_y")

def _bicycle(f: Form) -> Finding:
    """omega_v^v, the turning of the vehicle against itself, is 0."""
    turned = -skew(M([xi, yi, 0])) * M([0, 0, omega])
    truth = {VV: M([vx, vy, 0]), -RI * OWN: sympy.zeros(3, 1), -RI * OM: turned}
    result = M([vx - omega * yi, vy + omega * xi, 0])
    return vanishes(_sum(f.values[1], truth) - result,
                    "the slide's own result v_i = [V_x − ω y_i, V_y + ω x_i], with ω_v^v = 0")

BICYCLE = Record(TEXT, "generalized bicycle", _bicycle,
    form(VI, EQ, VV - RI * OWN), form(VI, EQ, VV - RI * OM), kind=Class.LIKELY,
    line="v_i^w = v_v^w - [r_i^v]x omega_v^v", remark="An upper index w was read as v; the slide's result holds.")

S, X, Y, Z = symbol("s"), symbol("x"), symbol("y"), symbol("z")
EXAMPLES = {
    "the rolling disk": (M([sin(Z), -cos(Z), 0]), False),
    "dy = sin(x²) dx, the graph of y = ∫ sin x²": (M([sin(X**2), -1, 0]), True),
}

def _with_curl(row: sympy.Matrix) -> sympy.Expr:
    """c . curl c of a constraint c . (x', y', z') = 0: 0 where it is integrable (Tzafestas Def. 2.1, 2.2)."""
    J = row.jacobian([X, Y, Z])
    return sympy.simplify(row.dot(M([J[2, 1] - J[1, 2], J[0, 2] - J[2, 0], J[1, 0] - J[0, 1]])))

def _criterion(names: tuple[str, ...]) -> Check:
    """Does a test tell integrable from non-integrable constraints?"""

    def check(f: Form) -> Finding:
        cases = []
        for name in names:
            row, integrable = EXAMPLES[name]
            if f.values[0].has(sympy.Integral):
                root = sympy.sqrt(sympy.pi / 2)
                path = root * sympy.fresnels(X / root)  # not elementary, by Liouville's theorem
                says = sympy.simplify(sympy.diff(path, X) - sin(X**2)) != 0
                value = "Fresnel integral"
            else:
                c = _with_curl(row)
                says, value = c == 0, f"c · curl c = {c}"
            cases.append((name, says == integrable, f"{name}: {value}"))
        wrong = [text for _, right, text in cases if not right]
        if wrong:
            return Finding(False, f"the criterion calls an integrable constraint non-holonomic: {wrong[0]}")
        return Finding(True, "the criterion tells them apart: " + "; ".join(text for *_, text in cases))

    return check

FRESNEL = Record(TEXT, "Fresnel argument", _criterion(tuple(EXAMPLES)),
    form(sympy.Integral(cos(S**2 / 2), S), symbol(r"\text{has no closed form}\;\Rightarrow\;\text{nonholonomic}")),
    form(symbol(r"c\cdot\nabla\times c \ne 0 \;\Leftrightarrow\; \text{nonholonomic}")),
    part=_criterion(tuple(EXAMPLES)[:1]),
    condition="the constraint is the rolling disk's, which is non-holonomic for another reason",
    kind=Class.CARE, line="integral has no closed form, hence not reducible to c(x)=0",
    remark="The conclusion is right, the argument is no proof: the test is Frobenius's, c · curl c = −1 ≠ 0.")

GAMMA, VSX, VSY, GD, DD = (symbol(n) for n in (r"\gamma", "v_{sx}", "v_{sy}", r"\dot{\gamma}", "d"))

def _steer(left: sympy.Expr, _: sympy.Expr) -> sympy.Expr:
    """The sliding row of wmrgen's castor at the pivot (l = 0), whose heading is gamma."""
    row = engine.sliding("castor", l=0, alpha=0, beta=GAMMA + sympy.pi / 2)
    return left - (row * M([VSX, VSY, omega]))[0] - engine.castor_rate() * GD

STEERING = Record(
    TEXT, "4.2.2.1.1, steering", identity(_steer, "wmrgen's sliding row of a wheel with castor offset d"),
    form(VSY * cos(GAMMA) - VSX * sin(GAMMA), EQ, sympy.S.Zero),
    form(VSY * cos(GAMMA) - VSX * sin(GAMMA) + DD * (omega + GD), EQ, sympy.S.Zero),
    part=identity(_steer, "the same with d = 0", {DD: sympy.S.Zero}),
    condition="the contact is offset along the axle only (d = 0)", kind=Class.CARE,
    line="gamma = atan2(v_sy, v_sx) at the steer pivot",
    remark="γ = atan2(v_sy, v_sx), written as the equation that it solves.")

ENTRIES = (VELOCITY, ACCELERATION, OMEGA, DISK, POSITION, ACKERMANN, BICYCLE, FRESNEL, STEERING)
