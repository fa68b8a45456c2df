"""Canonical forms without drift: the (2,n) chain (Tzafestas (2.58)), Brockett's integrator (2.59), its double
integrator form ((2.60), corrected), and the ways between them ((2.62)-(2.65)).
"""

from __future__ import annotations

from fractions import Fraction

import sympy

from textbook.page import Page
from wmrgen.kinematics.records import Formula
from wmrgen.symbolic import Expr

# Tzafestas 2.3.4: the values that the speed v1 of a car may take; AA274 scales them by the largest speed.
INPUT_SETS: dict[str, tuple[Fraction, ...]] = {
    "reeds_shepp": (Fraction(-1), Fraction(0), Fraction(1)),
    "dubins": (Fraction(0), Fraction(1)),
}


def _state(page: Page, letter: str, n: int) -> list[Expr]:
    return [page.given(f"{letter}{k}", "", "state") for k in range(1, n + 1)]


def _inputs(page: Page) -> tuple[Expr, Expr]:
    return page.given("u1", "", "input"), page.given("u2", "", "input")


def chain(n: int) -> Formula:
    """Tzafestas (2.58): x1' = u1, x2' = u2, x_{k+1}' = x_k u1 for k = 2 ... n-1."""
    page = Page(f"chain_{n}", f"rates of the (2,{n}) chain, Tzafestas (2.58)")
    x = _state(page, "x", n)
    u1, u2 = _inputs(page)
    for k, rate in enumerate([u1, u2, *(x[j] * u1 for j in range(1, n - 1))], 1):
        page.gives(f"x{k}_rate", "", rate)
    return page.formula()


def brockett() -> Formula:
    """Tzafestas (2.59): x1' = u1, x2' = u2, x3' = x1 u2 - x2 u1."""
    page = Page("brockett", "rates of Brockett's integrator, Tzafestas (2.59)")
    x1, x2, _ = _state(page, "x", 3)
    u1, u2 = _inputs(page)
    page.gives("x1_rate", "", u1)
    page.gives("x2_rate", "", u2)
    page.gives("x3_rate", "", x1 * u2 - x2 * u1)
    return page.formula()


def brockett_double() -> Formula:
    """Tzafestas (2.60), corrected: x1'' = u1, x2'' = u2, x3' = x1 x2' - x2 x1'."""
    page = Page(
        "brockett_double", "Brockett's integrator driven by accelerations, Tzafestas (2.60), corrected"
    )
    x1, x2 = page.given("x1", "", "state"), page.given("x2", "", "state")
    v1, v2 = page.given("x1_rate", "", "state"), page.given("x2_rate", "", "state")
    u1, u2 = _inputs(page)
    page.gives("x1_rate_rate", "", u1)
    page.gives("x2_rate_rate", "", u2)
    page.gives("x3_rate", "", x1 * v2 - x2 * v1)
    return page.formula()


def unicycle_to_chain() -> Formula:
    """Tzafestas (2.62): the unicycle as a (2,3) chain, state and inputs."""
    page = Page(
        "unicycle_to_chain", "state and inputs of the unicycle as a (2,3) chain, Tzafestas (2.62), (2.63)"
    )
    x, y = page.given("x", "m", "position"), page.given("y", "m", "position")
    theta = page.given("theta", "rad", "heading")
    v, omega = page.given("v", "m/s", "speed"), page.given("omega", "rad/s", "turning rate")
    c, s = sympy.cos(theta), sympy.sin(theta)
    z3 = page.let("z3_value", x * s - y * c)
    page.gives("z1", "rad", theta)
    page.gives("z2", "m", x * c + y * s)
    page.gives("z3", "m", z3)
    page.gives("u1", "rad/s", omega)
    page.gives("u2", "m/s", v - z3 * omega)
    return page.formula()


def chain_to_brockett() -> Formula:
    """Tzafestas (2.64): x1 = z1, x2 = z2, x3 = -2 z3 + z1 z2 gives (2.65)."""
    page = Page("chain_to_brockett", "a (2,3) chain as Brockett's integrator, Tzafestas (2.64)")
    z1, z2, z3 = _state(page, "z", 3)
    page.gives("x1", "", z1)
    page.gives("x2", "", z2)
    page.gives("x3", "", -2 * z3 + z1 * z2)
    return page.formula()


def brockett_to_chain() -> Formula:
    """Tzafestas (2.64) solved: z1 = x1, z2 = x2, z3 = (x1 x2 - x3)/2."""
    page = Page("brockett_to_chain", "Brockett's integrator as a (2,3) chain, Tzafestas (2.64) solved")
    x1, x2, x3 = _state(page, "x", 3)
    page.gives("z1", "", x1)
    page.gives("z2", "", x2)
    page.gives("z3", "", (x1 * x2 - x3) / 2)
    return page.formula()
