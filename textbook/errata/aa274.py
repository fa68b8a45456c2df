"""AA274, lecture 1: what is to be read with care, and what holds."""

from __future__ import annotations

from itertools import product

import sympy

from textbook.errata import engine
from textbook.errata.checks import each, number, rights
from textbook.errata.claims import book, claim
from textbook.errata.forms import EQ, Form, form, forms, symbol
from textbook.errata.records import Check, Class, Finding, Record
from textbook.transforms import world_to_robot_rows

# Pages of formulas, laid out by hand.
# fmt: off

TEXT = "AA274"
M = sympy.Matrix
cos, sin, tan = sympy.cos, sympy.sin, sympy.tan
xi, u1, L = symbol(r"\xi"), symbol("u_1"), symbol("L")

def _front(turn: sympy.Expr) -> list[sympy.Expr]:
    """Front wheel at (L, 0) and heading xi: wmrgen's rows with twist (u1 cos xi, 0, turn) and rim speed u1."""
    twist = M([u1 * cos(xi), 0, turn])
    rolls, slides = (row("steered", alpha=0, beta=xi + sympy.pi / 2, l=L) for row in (engine.rolling, engine.sliding))
    return [(rolls * twist)[0] - u1, (slides * twist)[0]]

_SAYS = "wmrgen's rolling and sliding row of the front wheel"
TRICYCLE = Record(TEXT, "tricycle", rights(_front, _SAYS),
    form(symbol(r"\dot{\theta}"), EQ, sin(xi) * u1), form(symbol(r"\dot{\theta}"), EQ, sin(xi) * u1 / L),
    part=rights(_front, f"{_SAYS}, with L = 1", {L: sympy.S.One}), condition="the wheelbase L is 1",
    kind=Class.CARE, line="thetadot = sin(xi) u1")

V, W, TOP, ZMAX = symbol("v"), symbol(r"\omega"), symbol(r"u_1^{max}"), symbol(r"\zeta_{max}")
_TOP, _ZETA = sympy.S.One, sympy.pi / 6
_GRID = [(sympy.Rational(a, 5), sympy.Rational(b, 5)) for a, b in product(range(-5, 6), range(-3, 4))]

def _attained(v: sympy.Expr, w: sympy.Expr) -> bool:
    """(v, omega) = u1 (cos zeta, sin zeta) for some |u1| <= 1 and |zeta| <= 30 deg (L = 1)."""
    return bool(v**2 + w**2 <= 1) and bool(3 * w**2 <= v**2)

def _set(inner: bool) -> Check:
    """The bounds describe the inputs of the car exactly; with ``inner``: no more than those."""

    def check(f: Form) -> Finding:
        said = {
            (v, w): all(bool(r.xreplace({V: v, W: w, TOP: _TOP, ZMAX: _ZETA})) for r in f.values) for v, w in _GRID
        }
        extra = [p for p in _GRID if said[p] and not _attained(*p)]
        lost = [p for p in _GRID if not said[p] and _attained(*p)]
        wrong = extra if inner else extra + lost
        of = f"{len(_GRID)} points (v, ω), u₁ᵐᵃˣ = 1, ζ_max = 30°, L = 1"
        if wrong:
            v, w = wrong[-1]
            what = "allowed but not attained" if wrong[-1] in extra else "attained but excluded"
            return Finding(False, f"{of}: {len(wrong)} wrong, as ({number(v)}, {number(w)}), {what}")
        return Finding(True, f"{of}: {'all that it allows are attained' if inner else 'all agree'}")

    return check

SLOPE = sympy.LessThan(sympy.Abs(W), sympy.Abs(V) * tan(ZMAX), evaluate=False)
BOUNDS = Record(TEXT, "bounds", _set(False),
    forms((sympy.LessThan(sympy.Abs(V), TOP * cos(ZMAX), evaluate=False),), (SLOPE,)),
    forms((sympy.LessThan(V**2 + W**2, TOP**2, evaluate=False),), (SLOPE,)),
    part=_set(True), condition="it is taken for an inner approximation (ζ = ξ, L = 1)", kind=Class.CARE,
    line="|v|<=u1max cos(zmax), |w|<=|v|tan(zmax) (car-like); |v|=.. (RS); v=.. (Dubins)")

CONCURRENT = "fixed 0.15 0.15*sqrt(3) -pi/6; fixed -0.3 0 pi/2; fixed 0.15 -0.15*sqrt(3) -5*pi/6"
APART = "fixed 0.3 0 pi/6; fixed -0.2 0.3 pi/3; fixed -0.2 -0.3 -pi/4"
RANK, DELTA = symbol(r"\mathrm{rank}\,C_1"), symbol(r"\delta_m")

def _mobility(robots: tuple[str, ...]) -> Check:
    """The claim against wmrgen's degree of mobility."""

    def check(f: Form) -> Finding:
        cases = []
        for text in robots:
            m = engine.robot(text).mobility
            said = f.rights[0].xreplace({RANK: sympy.Integer(m.rank_C1.value)})
            name = "axles in one point" if text is CONCURRENT else "axles apart"
            right = said == m.degree_of_mobility
            cases.append((right, f"{name}: rank {m.rank_C1.value}, mobility {m.degree_of_mobility}"))
        return each("three fixed wheels at different angles, ", cases)

    return check

THREE_FIXED = Record(TEXT, "degree of mobility, three fixed wheels", _mobility((CONCURRENT, APART)),
    form(DELTA, EQ, sympy.S.Zero), form(DELTA, EQ, 3 - RANK),
    part=_mobility((APART,)), condition="the axles do not meet in one point", kind=Class.CARE,
    words="three fixed wheels at different angles")

ENTRIES = (TRICYCLE, BOUNDS, THREE_FIXED)

# ---- what holds

ZERO, ONE = sympy.S.Zero, sympy.S.One
theta, xd, yd, thd, v, omega = map(symbol, (r"\theta", r"\dot{x}", r"\dot{y}", r"\dot{\theta}", "v", r"\omega"))
TURN = world_to_robot_rows(theta)
SLIDE = engine.wheel(ZERO, ZERO, ZERO)[1]
UNICYCLE = book("unicycle", theta=theta, v=v, omega=omega)
REDUCED = book("car_reduction", u1=u1, xi=xi, wheelbase=ONE)
RATES = M([cos(xi) * cos(theta), cos(xi) * sin(theta), sin(xi)]) * u1

HOLDS: tuple[Record, ...] = (
    claim(TEXT, "no slip disk", "−1 times wmrgen's sliding row at P, in world coordinates",
          (r"[\dot{x}\;\dot{y}]\cdot(\sin\theta,-\cos\theta)", xd * sin(theta) - yd * cos(theta),
           -(SLIDE * TURN * M([xd, yd, thd]))[0])),
    claim(TEXT, "unicycle", "the library's unicycle, Tzafestas (2.28)",
          (r"\dot{x}", v * cos(theta), UNICYCLE["x_rate"]), (r"\dot{y}", v * sin(theta), UNICYCLE["y_rate"]),
          (r"\dot{\theta}", omega, UNICYCLE["theta_rate"])),
    claim(TEXT, "simple car", "the tricycle with v = u₁ cos ξ, ω = u₁ sin ξ is the unicycle",
          (r"\dot{q}", RATES,
           M([UNICYCLE[k] for k in ("x_rate", "y_rate", "theta_rate")]).xreplace(
               {v: REDUCED["v"], omega: u1 * sin(xi)}))))
