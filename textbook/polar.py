"""Polar coordinates of the goal (Siegwart 3.6.2): the goal is the origin, reached with heading 0.

rho is the distance to the goal, alpha the goal's direction against the heading, beta = -theta - alpha.
The rates have a quotient by rho; on the goal itself they are given as if it were 0.
"""

from __future__ import annotations

import sympy

from textbook.page import Page
from wmrgen.kinematics.records import Formula
from wmrgen.symbolic import Expr, angle_of, minimum, root

cos, sin = sympy.cos, sympy.sin


def _polar(page: Page) -> tuple[Expr, Expr, Expr]:
    return (
        page.given("rho", "m", "distance to the goal"),
        page.given("alpha", "rad", "direction of the goal against the heading"),
        page.given("beta", "rad", "-theta - alpha"),
    )


def _gives(page: Page, rho: Expr, alpha: Expr, beta: Expr) -> None:
    page.gives("rho_rate", "m/s", rho)
    page.gives("alpha_rate", "rad/s", alpha)
    page.gives("beta_rate", "rad/s", beta)


def polar_coordinates() -> Formula:
    """Siegwart (3.50)-(3.52), alpha in (-pi, pi]."""
    page = Page("polar_coordinates", "polar coordinates of the goal at the origin, Siegwart (3.50)-(3.52)")
    x, y = page.given("x", "m", "position"), page.given("y", "m", "position")
    theta = page.given("theta", "rad", "heading")
    c, s = page.let("c", cos(theta)), page.let("s", sin(theta))
    # The goal is at (-x, -y), turned into the robot frame: alpha needs no wrapping.
    alpha = page.let("alpha_value", angle_of(s * x - c * y, -(c * x) - s * y))
    page.gives("rho", "m", root(x**2 + y**2))
    page.gives("alpha", "rad", alpha)
    page.gives("beta", "rad", -theta - alpha)
    return page.formula()


def polar_pose() -> Formula:
    """Siegwart (3.50)-(3.52) solved for the pose."""
    page = Page("polar_pose", "pose of the robot from polar coordinates, Siegwart (3.50)-(3.52) solved")
    rho, alpha, beta = _polar(page)
    page.gives("x", "m", -rho * cos(beta))
    page.gives("y", "m", rho * sin(beta))
    page.gives("theta", "rad", -alpha - beta)
    return page.formula()


def polar_rates() -> Formula:
    """Siegwart (3.53): alpha in (-pi/2, pi/2], driving forward."""
    page = Page("polar_rates", "rates of the polar coordinates, driving forward, Siegwart (3.53)")
    rho, alpha, _ = _polar(page)
    v, omega = page.given("v", "m/s", "speed forward"), page.given("omega", "rad/s", "turning rate")
    turn = page.quotient("turn", sin(alpha) * v, rho)
    _gives(page, -cos(alpha) * v, turn - omega, -turn)
    return page.formula()


def polar_rates_reverse() -> Formula:
    """Siegwart (3.55), corrected: v is the speed backwards, omega is not reversed."""
    page = Page(
        "polar_rates_reverse", "rates of the polar coordinates, driving backwards, Siegwart (3.55), corrected"
    )
    rho, alpha, _ = _polar(page)
    v, omega = page.given("v", "m/s", "speed backwards"), page.given("omega", "rad/s", "turning rate")
    turn = page.quotient("turn", sin(alpha) * v, rho)
    _gives(page, cos(alpha) * v, -turn - omega, turn)
    return page.formula()


def polar_closed_loop() -> Formula:
    """Siegwart (3.56)-(3.58): v = k_rho rho, omega = k_alpha alpha + k_beta beta; no quotient is left."""
    page = Page("polar_closed_loop", "closed loop of the polar feedback law, Siegwart (3.58)")
    rho, alpha, beta = _polar(page)
    k_rho, k_alpha, k_beta = _gains(page)
    omega = page.let("steer", k_alpha * alpha + k_beta * beta)
    swing = page.let("swing", k_rho * sin(alpha))
    _gives(page, -k_rho * rho * cos(alpha), swing - omega, -swing)
    page.gives("v", "m/s", k_rho * rho, "speed forward")
    page.gives("omega", "rad/s", omega, "turning rate")
    return page.formula()


def _gains(page: Page) -> tuple[Expr, Expr, Expr]:
    k_rho, k_alpha, k_beta = (page.given(f"k_{n}", "1/s", "gain") for n in ("rho", "alpha", "beta"))
    return k_rho, k_alpha, k_beta


def polar_linearisation() -> Formula:
    """Siegwart (3.60)-(3.63): A of d/dt (rho, alpha, beta) at the goal; s^3 + p2 s^2 + p1 s + p0 = det(s I - A)."""
    page = Page(
        "polar_linearisation", "linearised closed loop of the polar law at the goal, Siegwart (3.60)-(3.63)"
    )
    k_rho, k_alpha, k_beta = _gains(page)
    zero = sympy.S.Zero
    rows = ((-k_rho, zero, zero), (zero, k_rho - k_alpha, -k_beta), (zero, -k_rho, zero))
    page.gives_matrix("a", rows, "1/s")
    page.gives("p2", "1/s", k_alpha, "of the characteristic polynomial")
    page.gives("p1", "1/s^2", k_rho * (k_alpha - k_rho - k_beta), "of the characteristic polynomial")
    page.gives("p0", "1/s^3", -(k_rho**2) * k_beta, "of the characteristic polynomial")
    return page.formula()


def polar_gains() -> Formula:
    """Siegwart (3.61)-(3.65), (3.65) also corrected: slack of the tightest condition, positive where all hold."""
    page = Page("polar_gains", "do gains stabilise the polar law, Siegwart (3.61)-(3.65), (3.65) corrected")
    k_rho, k_alpha, k_beta = _gains(page)
    signs = page.let("signs", minimum(k_rho, -k_beta))
    share = page.let("share", k_rho * 2 / sympy.pi)
    for name, value, text in (
        ("stable", k_alpha - k_rho, "Hurwitz: k_rho, -k_beta, k_alpha - k_rho"),
        ("strong_3_65", k_alpha + k_beta * sympy.Rational(5, 3) - share,
         "(3.65): k_rho, -k_beta, k_alpha + 5/3 k_beta - 2/pi k_rho; alpha stays in I1 from |beta| <= 5 pi/6"),
        ("strong_all_beta", k_alpha + k_beta * 2 - share,
         "corrected: k_rho, -k_beta, k_alpha + 2 k_beta - 2/pi k_rho; alpha stays in I1 from every beta"),
    ):  # fmt: skip
        page.gives(name, "1/s", minimum(signs, value), text)
    return page.formula()
