"""Tzafestas, chapter 2: what fails in the copy, damaged or not."""

from __future__ import annotations

import sympy

from textbook.errata import engine
from textbook.errata.checks import identity, rights, shape_of, undefined, vanishes
from textbook.errata.claims import along, book
from textbook.errata.forms import BAR, EQ, PLUS, TIMES, Form, form, forms, symbol
from textbook.errata.records import Class, Finding, Record
from textbook.frames import skew
from textbook.transforms import rotation_rows, world_to_robot_rows

# Pages of formulas, laid out by hand.
# fmt: off

TEXT = "Tzafestas"
M = sympy.Matrix
cos, sin, sqrt = sympy.cos, sympy.sin, sympy.sqrt
phi, psi, zeta, beta, gamma = (symbol(rf"\{n}") for n in ("phi", "psi", "zeta", "beta", "gamma"))
phid = symbol(r"\dot{\phi}")
r, b, D, v, w, z, theta_d = (symbol(n) for n in ("r", "b", "D", "v", "w", "z", r"\dot{\theta}"))
u1, u2, v1 = symbol("u_1"), symbol("u_2"), symbol("v_1")

RY = rotation_rows("y", phi)
RY_DOT = symbol("R_y")

def _right_handed(matrix: sympy.Matrix) -> sympy.Matrix:
    """dR/dphi - [e_y]x R, which is 0 for the right-handed rotation about y that is 1 at phi = 0."""
    return sympy.diff(matrix, phi) - skew(M([0, 1, 0])) * matrix

ROTATION = Record(TEXT, "(2.15b)",
    rights(_right_handed, "dR/dφ = [e_y]× R, as for a right-handed rotation"),
    form(RY_DOT, EQ, RY.T), form(RY_DOT, EQ, RY), kind=Class.OPEN, line="R_y = [[c,0,-s],[0,1,0],[s,0,c]]",
    remark="The matrix is R_y(−φ), while R_x and R_z of (2.15a, c) are right-handed. Two signs are exchanged, which "
           "an extraction does not do.")

Q = [symbol(f"q_{k}") for k in (1, 2, 3)]
QD = [symbol(rf"\dot{{q}}_{k}") for k in (1, 2, 3)]
MU = symbol(r"\mu(q)\,\dot{q}")
SUM = sympy.Add(*(a * c for a, c in zip(Q, QD, strict=True)))

def _equation_to_zero(f: Form) -> str:
    says = "the line names a sum and sets it equal to nothing: no motion is excluded"
    return "" if f.rights[-1] == 0 else says

SPHERE = Record(TEXT, "(2.23)",
    identity(
        lambda left, _: [sympy.diff(left, qd) - sympy.diff(sum(q**2 for q in Q) / 2, q)
                         for q, qd in zip(Q, QD, strict=True)],
        "the coefficients are the gradient of (q₁² + q₂² + q₃²)/2, so the constraint is integrable",
    ),
    form(MU, EQ, SUM), form(SUM, EQ, sympy.S.Zero), slip=_equation_to_zero, kind=Class.LIKELY,
    line="mu(q)qdot = q1 q1dot+...+qn qndot",
    remark="“= 0” is missing. Shown for three coordinates.")

XR, YR, VQ, V0 = symbol(r"\dot{x}_r"), symbol(r"\dot{y}_r"), symbol("v_Q"), symbol("v_0")

def _robot_to_world(x: sympy.Expr, y: sympy.Expr) -> sympy.Matrix:
    back = world_to_robot_rows(phi).T * M([x, y, 0])
    return back[:2, :] - VQ * M([cos(phi), sin(phi)])

EXAMPLE_21 = Record(TEXT, "Example 2.1, (2.44)",
    rights(_robot_to_world, "turned into the world frame the velocity is (2.35), v_Q (cos φ, sin φ)"),
    forms((XR, EQ, V0), (YR, EQ, symbol(r"0\,\cos/\sin{}-\sin/\cos"))),
    forms((XR, EQ, VQ), (YR, EQ, sympy.S.Zero)),
    slip=undefined(XR, YR, VQ, phi), kind=Class.DAMAGE, line="ydot_r = 0 cos/sin -sin/cos, xdot_r = v_0",
    remark="Pieces of a matrix have run into the line.")

def _slipping(x: sympy.Expr, y: sympy.Expr) -> list[sympy.Expr]:
    """(r theta' - w) e + z n: velocity of a slipping contact of a wheel turned by zeta."""
    row = engine.rolling("steered", alpha=0, beta=zeta + sympy.pi / 2)
    across = engine.sliding("steered", alpha=0, beta=zeta + sympy.pi / 2)
    return [x - (r * theta_d - w) * row[0] - z * across[0], y - (r * theta_d - w) * row[1] - z * across[1]]

_SAYS = "velocity of the contact of a wheel at angle ζ, from wmrgen's rolling and sliding rows"
SLIP_ZETA = Record(TEXT, "Example 2.2, slip with ζ ≠ 0", rights(_slipping, _SAYS),
    forms((symbol("v_x"), EQ, (r * theta_d - w) * cos(zeta)), (symbol("v_y"), EQ, z * cos(zeta))),
    forms((symbol("v_x"), EQ, (r * theta_d - w) * cos(zeta) - z * sin(zeta)),
          (symbol("v_y"), EQ, (r * theta_d - w) * sin(zeta) + z * cos(zeta))),
    part=rights(_slipping, _SAYS, {zeta: sympy.S.Zero}), condition="ζ = 0", kind=Class.OPEN,
    line="v_r=(r th_r - w_r)cos zeta_r ; -xG sin+yG cos+b pd - z_r cos zeta_r = 0 (zeta != 0)",
    remark="w is the slip along the wheel and z the slip across it, as at ζ = 0; then the pair lacks both sine terms. "
           "Shown for one wheel: forward and lateral velocity v_x, v_y of its contact in the robot frame.")

T = sympy.Symbol("t")
X1, X2, X3 = (sympy.Function(f"x_{k}")(T) for k in (1, 2, 3))

def _double_integrator(f: Form) -> Finding:
    """The first two lines set second derivatives; the third is Brockett's with rates for inputs."""
    a, c, third = (line[0] for line in f.lines)
    orders = [sympy.Integer(e.derivative_count) for e in (a, c)]
    dots = {sympy.diff(X1, T): u1, sympy.diff(X2, T): u2}
    last = f.lines[2][-1].xreplace(dots) - book("brockett", x1=X1, x2=X2, u1=u1, u2=u2)["x3_rate"]
    as_259 = vanishes(last.xreplace({X1: symbol("x_1"), X2: symbol("x_2")}), "the third line is that of (2.59)")
    if orders != [2, 2]:
        return Finding(False, f"the inputs set derivatives of order {orders[0]} and {orders[1]}: "
                              "the three lines are those of (2.59), which integrates once")
    return Finding(as_259.holds and third == sympy.diff(X3, T), f"both inputs are accelerations; {as_259.text}")

def _brockett(order: int) -> Form:
    return forms(
        (sympy.diff(X1, T, order), EQ, u1), (sympy.diff(X2, T, order), EQ, u2),
        (sympy.diff(X3, T), EQ, X1 * sympy.diff(X2, T) - X2 * sympy.diff(X1, T)),
    )

DOUBLE = Record(TEXT, "(2.60)", _double_integrator, _brockett(1), _brockett(2), kind=Class.LIKELY,
    line="x1dot=u1, x2dot=u2, x3dot=x1 x2dot - x2 x1dot",
    remark="The text calls it a double integrator: the extraction probably lost one of two dots over a letter.")

Z = [symbol(rf"\dot{{z}}_{k}") for k in (1, 2, 3)]

def _chain_rates(*right: sympy.Expr) -> list[sympy.Expr]:
    """Right-hand sides against the rates of z of (2.62) along the unicycle."""
    x, y, turn = symbol("x"), symbol("y"), symbol(r"\omega")
    chain = book("unicycle_to_chain", x=x, y=y, theta=phi, v=v, omega=turn)
    flow = {x: v * cos(phi), y: v * sin(phi), phi: turn}
    at = {u1: chain["u1"], u2: chain["u2"], symbol("z_2"): chain["z2"]}
    return [along(chain[f"z{k}"], flow) - e.xreplace(at) for k, e in enumerate(right, 1)]

CHAIN_MISSING = Record(TEXT, "(2.63)",
    rights(_chain_rates, "rates of z of (2.62) along the unicycle (2.26)"),
    None,
    forms((Z[0], EQ, u1), (Z[1], EQ, u2), (Z[2], EQ, symbol("z_2") * u1)),
    kind=Class.DAMAGE, remark="u₁ = v_φ, u₂ = v_Q − z₃ u₁.")

PHI = [symbol(rf"\phi_{k}") for k in range(4)]
PHID = [symbol(rf"\dot{{\phi}}_{k}") for k in range(4)]
LEN = [symbol(f"L_{k}") for k in range(4)]
XQ, YQ = symbol(r"\dot{x}_Q"), symbol(r"\dot{y}_Q")
SECOND = 2  # the trailer that is shown

def sideways(i: int) -> sympy.Expr:
    """Velocity of trailer i's axle across its heading, by differentiating x_i = x_Q - sum L_j cos phi_j."""
    x, y = XQ, YQ
    for j in range(1, i + 1):
        x += LEN[j] * sin(PHI[j]) * PHID[j]
        y -= LEN[j] * cos(PHI[j]) * PHID[j]
    return x * sin(PHI[i]) - y * cos(PHI[i])

def _constraint(rates: list[sympy.Expr]) -> Form:
    i = SECOND
    terms = [rates[j] * LEN[j] * cos(PHI[i] - PHI[j]) for j in range(1, i + 1)]
    return form(XQ * sin(PHI[i]) - YQ * cos(PHI[i]) + sympy.Add(*terms), EQ, sympy.S.Zero)

TRAILER_CONSTRAINT = Record(TEXT, "2.3.6, constraint of trailer i",
    identity(lambda left, _: left - sideways(SECOND), "sideways velocity of the trailer, by differentiation"),
    _constraint([PHID[SECOND]] * 4), _constraint(PHID), kind=Class.LIKELY,
    line="xQ sin phi_i - yQ cos phi_i + sum_{i=1}^{i} phidot_i L_j cos(phi_i-phi_j)=0",
    remark="The bound index reads i, as does the index of the rate; L_j and φ_j show that it was j, which looks like "
           "i. xQ and yQ are rates. Shown for i = 2.")

VH, VI, VR, VB = (symbol(n) for n in ("v_h", "v_i", r"v_{\mathrm{roller}}", "v_b"))

def _pythagoras(left: sympy.Expr, right: sympy.Expr) -> sympy.Expr:
    at = {VI: VH * cos(gamma - beta), VR: VH * sin(gamma - beta)}
    return (right - left).xreplace(at)

OMNI_PAIR = Record(TEXT, "(2.71a)",
    identity(_pythagoras, "with v_i = v_h cos(γ − β) and the rest taken up by the roller"),
    form(VB**2, EQ, VI**2 + VR**2), form(VH**2, EQ, VI**2 + VR**2),
    slip=undefined(VH, VI, VR, beta, gamma), kind=Class.DAMAGE, line="v_b^2 = v_i^2 + v_roller^2")

BETAS = [symbol(rf"\beta_{k}") for k in (1, 2, 3, 4)]
UT = M([[-sin(e), cos(e)] for e in BETAS])
BACK = M([[cos(phi), sin(phi)], [-sin(phi), cos(phi)]])
DD4 = M([D, D, D, D])

def _omni4(f: Form) -> Finding:
    """(1/r) [U^T R^-1 | D] against wmrgen's rolling rows of four omni wheels at position angles beta_i."""
    _, scale, left, right = f.values
    sign = f.lines[0][-2]
    if sign is PLUS and left.shape != right.shape:
        return Finding(False, f"a sum of {shape_of(left)} and {shape_of(right)} does not exist")
    if left.rows != right.rows:
        return Finding(False, f"{shape_of(left)} and {shape_of(right)} do not stand side by side")
    inverse = scale * (left.row_join(right) if sign is BAR else left + right)
    rows = [engine.rolling("swedish", alpha=e, beta=sympy.pi, g=0, l=D) for e in BETAS]
    truth = M.vstack(*rows) * world_to_robot_rows(phi) / r
    return vanishes(inverse - truth, f"{shape_of(inverse)}, against wmrgen's rolling rows of four omni wheels")

JINV, ONE_R = symbol("J^{-1}"), 1 / r
OMNI4 = Record(TEXT, "(2.75c, d)", _omni4,
    form(JINV, EQ, ONE_R, TIMES, UT * BACK, PLUS, DD4), form(JINV, EQ, ONE_R, TIMES, UT * BACK, BAR, DD4),
    kind=Class.LIKELY, line="J^-1 = (1/r)(U^T R^-1(phi) + Dbar), Dbar=[D,D,D,]^T",
    remark="The column is next to the matrix: the sign between the two blocks probably became a plus. The "
           "fourth D was lost after the last comma, and is put back above. βᵢ is the angle of the wheel's position "
           "here, unlike in (2.72).")

RR, RS, D1, D2 = (symbol(n) for n in ("R", "r", "d_1", "d_2"))
S = D1 + D2
IK4 = M([[-1, 1, S], [1, 1, -S], [-1, 1, -S], [1, 1, S]]) / RR  # (2.84)
SIGNS = (-1, 1, -1, 1)

def _mecanum_form(third: list[tuple[sympy.Expr, sympy.Expr]]) -> Form:
    """J_i of (2.79) for the four wheels, with the third columns (dy, -dx)."""
    pairs = zip(SIGNS, third, strict=True)
    jacobians = [M([[0, s * RS / sqrt(2), a], [RR, -RS / sqrt(2), c], [0, 0, 1]]) for s, (a, c) in pairs]
    return forms(*((symbol(f"J_{k}"), EQ, J) for k, J in enumerate(jacobians, 1)))

def _mecanum(f: Form) -> Finding:
    """Wheel rates from the J_i, against (2.84), and their rank where d1 = d2."""
    rows = M.vstack(*(engine.inverse(J)[0, :] for J in f.rights)).applyfunc(sympy.cancel)
    rank = rows.xreplace({D2: D1}).rank()
    rates = vanishes(rows - IK4, "wheel rates from the Jᵢ⁻¹ against (2.84)")
    return Finding(rates.holds, f"{rates.text}; their rank at d₁ = d₂ is {rank}")

PRINTED_THIRD = [(D2, D1), (D2, -D1), (-D2, -D1), (-D2, D1)]
THIRD = [(D2, -D1), (D2, D1), (-D2, D1), (-D2, -D1)]
MECANUM = Record(TEXT, "(2.81)", _mecanum, _mecanum_form(PRINTED_THIRD), _mecanum_form(THIRD),
    kind=Class.OPEN, line="J1..J4 with third columns (d2, +d1), (d2,-d1), (-d2,-d1), (-d2,+d1)",
    remark="(2.82) and (2.84) of the same text are each other's inverse and contradict (2.81): all four signs of d₁ "
           "are reversed. y forward; wheels 1 to 4 are front right, front left, rear left, rear right.")

ENTRIES = (
    ROTATION, SPHERE, EXAMPLE_21, SLIP_ZETA, DOUBLE, CHAIN_MISSING, TRAILER_CONSTRAINT, OMNI_PAIR, OMNI4, MECANUM)
