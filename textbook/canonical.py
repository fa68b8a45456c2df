"""Canonical forms without drift: the (2,n) chain (Tzafestas (2.58)), Brockett's integrator (2.59), its double
integrator form ((2.60), corrected), and the ways between them ((2.62)-(2.65)).
"""

from __future__ import annotations

from fractions import Fraction

import sympy

from textbook.page import Chapter, Page

CANONICAL = Chapter("Canonical forms")
# Tzafestas 2.3.4: the values that the speed v1 of a car may take; AA274 scales them by the largest speed.
INPUT_SETS: dict[str, tuple[Fraction, ...]] = {
    "reeds_shepp": (Fraction(-1), Fraction(0), Fraction(1)),
    "dubins": (Fraction(0), Fraction(1)),
}
INPUTS = "u1 [] input; u2 [] input"


def _state(letter: str, n: int) -> str:
    return "; ".join(f"{letter}{k} [] state" for k in range(1, n + 1))


def _chain(n: int) -> None:
    @CANONICAL(f"rates of the (2,{n}) chain, Tzafestas (2.58)", f"chain_{n}")
    def chain(page: Page) -> None:
        """x1' = u1, x2' = u2, x_{k+1}' = x_k u1 for k = 2 ... n-1."""
        x, (u1, u2) = page.read(_state("x", n)), page.read(INPUTS)
        rates = "; ".join(f"x{k}_rate []" for k in range(1, n + 1))
        page.write(rates, u1, u2, *(x[j] * u1 for j in range(1, n - 1)))


for _n in (3, 4, 5, 6):
    _chain(_n)


@CANONICAL("rates of Brockett's integrator, Tzafestas (2.59)")
def brockett(page: Page) -> None:
    """x1' = u1, x2' = u2, x3' = x1 u2 - x2 u1."""
    (x1, x2, _), (u1, u2) = page.read(_state("x", 3)), page.read(INPUTS)
    page.write("x1_rate []; x2_rate []; x3_rate []", u1, u2, x1 * u2 - x2 * u1)


@CANONICAL("Brockett's integrator driven by accelerations, Tzafestas (2.60), corrected")
def brockett_double(page: Page) -> None:
    """x1'' = u1, x2'' = u2, x3' = x1 x2' - x2 x1'."""
    x1, x2, v1, v2 = page.read("x1 [] state; x2 [] state; x1_rate [] state; x2_rate [] state")
    u1, u2 = page.read(INPUTS)
    page.write("x1_rate_rate []; x2_rate_rate []; x3_rate []", u1, u2, x1 * v2 - x2 * v1)


@CANONICAL("state and inputs of the unicycle as a (2,3) chain, Tzafestas (2.62), (2.63)")
def unicycle_to_chain(page: Page) -> None:
    x, y, theta, v, omega = page.read(
        "x [m] position; y [m] position; theta [rad] heading; v [m/s] speed; omega [rad/s] turning rate"
    )
    c, s = sympy.cos(theta), sympy.sin(theta)
    z3 = page.let("z3_value", x * s - y * c)
    page.write(
        "z1 [rad]; z2 [m]; z3 [m]; u1 [rad/s]; u2 [m/s]", theta, x * c + y * s, z3, omega, v - z3 * omega
    )


@CANONICAL("a (2,3) chain as Brockett's integrator, Tzafestas (2.64)")
def chain_to_brockett(page: Page) -> None:
    """x1 = z1, x2 = z2, x3 = -2 z3 + z1 z2 gives (2.65)."""
    z1, z2, z3 = page.read(_state("z", 3))
    page.write("x1 []; x2 []; x3 []", z1, z2, -2 * z3 + z1 * z2)


@CANONICAL("Brockett's integrator as a (2,3) chain, Tzafestas (2.64) solved")
def brockett_to_chain(page: Page) -> None:
    """z1 = x1, z2 = x2, z3 = (x1 x2 - x3)/2."""
    x1, x2, x3 = page.read(_state("x", 3))
    page.write("z1 []; z2 []; z3 []", x1, x2, (x1 * x2 - x3) / 2)
