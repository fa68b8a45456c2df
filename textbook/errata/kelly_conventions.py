"""What Kelly prints and what holds only under a condition."""

from __future__ import annotations

import sympy

from textbook.errata import engine
from textbook.errata.checks import at_points, identity, rights
from textbook.errata.forms import EQ, Form, form, symbol
from textbook.errata.kelly import OM, RC, TEXT, VV, M, cos, omega, sin
from textbook.errata.records import Check, Finding, Record

# Pages of formulas, laid out by hand.
# fmt: off

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
        found = []
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
            found.append((name, says == integrable, f"{name}: {value}"))
        wrong = [text for _, right, text in found if not right]
        if wrong:
            return Finding(False, f"calls an integrable constraint non-holonomic: {wrong[0]}")
        return Finding(True, "tells them apart: " + "; ".join(text for *_, text in found))

    return check

FRESNEL = Record(TEXT, "Fresnel argument", _criterion(tuple(EXAMPLES)),
    form(sympy.Integral(cos(S**2 / 2), S), symbol(r"\text{has no closed form}\;\Rightarrow\;\text{nonholonomic}")),
    form(symbol(r"c\cdot\nabla\times c \ne 0 \;\Leftrightarrow\; \text{nonholonomic}")),
    part=_criterion(tuple(EXAMPLES)[:1]), condition="the rolling disk, which is non-holonomic for another reason")

VS, VC, RCS, WS = symbol("v_s^v"), symbol("v_c^s"), symbol(r"[r_c^s]_\times"), symbol(r"\omega_s^v")

def _offset(e: sympy.Expr) -> sympy.Expr:
    """Against (4.30), term by term."""
    return e - (VV - RC * OM + VS - RCS * WS + VC)

OFFSET = Record(TEXT, "(4.39)", rights(_offset, "the articulated wheel (4.30)"),
    form(symbol("v_c^w"), EQ, VV - RC * OM - RCS * WS),
    form(symbol("v_c^w"), EQ, VV - RC * OM - RCS * WS + VS + VC),
    part=rights(_offset, "the articulated wheel (4.30)", {VS: sympy.S.Zero, VC: sympy.S.Zero}),
    condition="v_s^v = v_c^s = 0, and r_c^s in vehicle coordinates")

GAMMA, VSX, VSY, GD, DD = (
    symbol(r"\gamma"),
    symbol("v_{sx}"),
    symbol("v_{sy}"),
    symbol(r"\dot{\gamma}"),
    symbol("d"),
)

def _steer(left: sympy.Expr, _: sympy.Expr) -> sympy.Expr:
    """The sliding row of wmrgen's castor at the pivot (l = 0), whose heading is gamma."""
    known = {engine.L: sympy.S.Zero, engine.ALPHA: sympy.S.Zero, engine.BETA: GAMMA + sympy.pi / 2}
    row = engine.sliding("castor").xreplace(known)
    return left - (row * M([VSX, VSY, omega]))[0] - engine.castor_rate() * GD

STEERING = Record(
    TEXT, "4.2.2.1.1, steering", identity(_steer, "wmrgen's sliding row of a wheel with castor offset d"),
    form(VSY * cos(GAMMA) - VSX * sin(GAMMA), EQ, sympy.S.Zero),
    form(VSY * cos(GAMMA) - VSX * sin(GAMMA) + DD * (omega + GD), EQ, sympy.S.Zero),
    part=identity(_steer, "the same with d = 0", {DD: sympy.S.Zero}),
    condition="the contact is offset along the axle only (d = 0)",
    remark="γ = atan2(v_sy, v_sx), written as the equation that it solves.")

VCX, VCY, RW = symbol("v_{cx}"), symbol("v_{cy}"), symbol("r")
_WAYS = [(1, 0), (sympy.Rational(3, 5), sympy.Rational(4, 5)), (-1, 0), (-3, -4)]

def _rim(e: sympy.Expr) -> sympy.Expr:
    """Wheel along x: its speed is the forward component, with GAMMA its heading modulo a half turn."""
    forward = sympy.sign(VCX) * sympy.sqrt(VCX**2 + VCY**2)
    return (e - forward / RW).xreplace({RW: sympy.S.One})

def _speeds(forward_only: bool) -> Check:
    points = [tuple(map(sympy.S, p)) for p in _WAYS if p[0] > 0 or not forward_only]
    return at_points(_rim, (VCX, VCY), points, "component of the contact velocity along the wheel, r = 1")

SIZE = sympy.sqrt(VCX**2 + VCY**2) / RW
RIM = Record(TEXT, "4.2.2.1.2, wheel speed", _speeds(False),
    form(symbol(r"\omega_{wheel}"), EQ, SIZE), form(symbol(r"\omega_{wheel}"), EQ, sympy.sign(VCX) * SIZE),
    part=_speeds(True), condition="the wheel rolls forwards, e · v_c > 0")

CONVENTIONS = (FRESNEL, OFFSET, STEERING, RIM)
