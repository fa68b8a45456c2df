"""The swivel of a towed castor in closed form, from Siegwart (3.18).

At constant pivot velocity V along nu without turning, beta' = -(V/d) cos(alpha + beta - nu). With
psi = alpha + beta - nu this is the inverse Gudermannian running at -V/d, so that tan(pi/4 + psi/2) decays
by exp(-V t/d). The contact is B = A + d e: a castor with d > 0 trails with its wheel running backwards.
"""

from __future__ import annotations

import sympy

from textbook.page import Chapter, Page
from wmrgen.geometry.symbolic import Expr, absolute, angle_of, clamp_between, root, select

CASTORS = Chapter("Castors")
HALVINGS, TERMS = 6, 15
LARGEST = 40  # beyond, the wheel is within exp(-40) of its equilibrium
# |x| / 2**6 <= 5/8: the first term left out is (5/8)**16/16! = 2.6e-17, raised 64 times: 1.7e-15 of the value.


def exponential(page: Page, name: str, x: Expr) -> Expr:
    """exp(x) for x clamped to [-40, 40], to within 2e-15 of its value by the series.

    The report shows the local ``NAME_exp`` as the exponential of ``NAME_exp_of``.
    """
    exponent = page.let(f"{name}_exp_of", x)
    clamped = clamp_between(sympy.Integer(-LARGEST), exponent, sympy.Integer(LARGEST))
    y = page.let(f"{name}_exp_part", clamped / 2**HALVINGS)
    series: Expr = sympy.S.One
    for k in range(TERMS, 0, -1):
        series = 1 + sympy.Mul(y / k, series, evaluate=False)
    # The root halves the exponent once more: it leaves exact arithmetic 60 digits to square, not thousands.
    value = page.let(f"{name}_exp_root", root(series))
    for k in range(HALVINGS):
        value = page.let(f"{name}_exp_{k}", value * value)
    return page.let(f"{name}_exp", value * value)


@CASTORS("angle of a towed castor after a time, Siegwart (3.18) integrated")
def castor_swivel(page: Page) -> None:
    """The angle of a castor's joint after a time at constant pivot velocity."""
    beta, alpha, d, vx, vy, t = page.read(
        "beta [rad] joint angle at time 0; alpha [rad] direction of the pivot from P; "
        "d [m] contact minus pivot along the rolling direction; vx [m/s] velocity of the pivot; "
        "vy [m/s] velocity of the pivot; t [s] time"
    )
    speed = page.let("speed", root(vx**2 + vy**2))
    growth = exponential(page, "growth", page.quotient("exponent", -speed * t, d))
    quarter = page.let("quarter", (alpha + beta - angle_of(vy, vx)) / 2 + sympy.pi / 4)
    c, s = page.let("c", sympy.cos(quarter)), page.let("s", sympy.sin(quarter))
    swing = angle_of(c * s * (growth - 1), c * c + s * s * growth)
    page.write("beta [rad] joint angle at time t", beta + 2 * swing)


@CASTORS("where a towed castor comes to rest, Siegwart (3.18)")
def castor_alignment(page: Page) -> None:
    """Equilibria of (3.18): stable with the contact behind the pivot, and how fast it is reached."""
    alpha, d, r, vx, vy = page.read(
        "alpha [rad] direction of the pivot from P; "
        "d [m] contact minus pivot along the rolling direction; r [m] radius; "
        "vx [m/s] velocity of the pivot; vy [m/s] velocity of the pivot"
    )
    speed = page.let("speed", root(vx**2 + vy**2))
    side = page.let("side", select(sympy.S.Zero, d, sympy.S.One, sympy.S.NegativeOne))
    # e = -+ V / |V| at beta = nu - alpha -+ pi/2
    ahead = page.let("ahead", angle_of(vy, vx) - alpha)
    c, s = page.vector_at("way", side, ahead)
    page.write("beta_stable [rad] contact behind the pivot", angle_of(-c, s))
    page.write("beta_unstable [rad] contact ahead of the pivot", angle_of(c, -s))
    page.write("rate [1/s] of the approach to beta_stable", -page.quotient("fall", speed, absolute(d)))
    page.write("spin [rad/s] wheel speed at beta_stable", -side * page.quotient("turning", speed, r))
