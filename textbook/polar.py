"""Polar coordinates of the goal (Siegwart 3.6.2): the goal is the origin, reached with heading 0.

rho is the distance to the goal, alpha the goal's direction against the heading, beta = -theta - alpha.
The rates have a quotient by rho; on the goal itself they are given as if it were 0.
"""

from __future__ import annotations

import sympy

from textbook.page import Chapter, Page
from wmrgen.geometry.symbolic import angle_of, minimum, root

POLAR = Chapter("Polar coordinates of the goal")
COORDINATES = (
    "rho [m] distance to the goal; alpha [rad] direction of the goal against the heading; "
    "beta [rad] -theta - alpha"
)
RATES = "rho_rate [m/s]; alpha_rate [rad/s]; beta_rate [rad/s]"
GAINS = "k_rho [1/s] gain; k_alpha [1/s] gain; k_beta [1/s] gain"
cos, sin = sympy.cos, sympy.sin


@POLAR("polar coordinates of the goal at the origin, Siegwart (3.50)-(3.52)")
def polar_coordinates(page: Page) -> None:
    """alpha lies in (-pi, pi]."""
    x, y, theta = page.read("x [m] position; y [m] position; theta [rad] heading")
    c, s = page.let("c", cos(theta)), page.let("s", sin(theta))
    # The goal is at (-x, -y), turned into the robot frame: alpha needs no wrapping.
    alpha = page.let("alpha_value", angle_of(s * x - c * y, -(c * x) - s * y))
    page.write("rho [m]; alpha [rad]; beta [rad]", root(x**2 + y**2), alpha, -theta - alpha)


@POLAR("pose of the robot from polar coordinates, Siegwart (3.50)-(3.52) solved")
def polar_pose(page: Page) -> None:
    rho, alpha, beta = page.read(COORDINATES)
    x, y = page.vector_at("place", rho, beta)
    page.write("x [m]; y [m]; theta [rad]", -x, y, -alpha - beta)


@POLAR("rates of the polar coordinates, driving forward, Siegwart (3.53)")
def polar_rates(page: Page) -> None:
    """alpha lies in (-pi/2, pi/2]."""
    rho, alpha, _ = page.read(COORDINATES)
    v, omega = page.read("v [m/s] speed forward; omega [rad/s] turning rate")
    along, across = page.vector_at("velocity", v, alpha)
    turn = page.quotient("turn", across, rho)
    page.write(RATES, -along, turn - omega, -turn)


@POLAR("rates of the polar coordinates, driving backwards, Siegwart (3.55), corrected")
def polar_rates_reverse(page: Page) -> None:
    """v is the speed backwards, omega is not reversed."""
    rho, alpha, _ = page.read(COORDINATES)
    v, omega = page.read("v [m/s] speed backwards; omega [rad/s] turning rate")
    along, across = page.vector_at("velocity", v, alpha)
    turn = page.quotient("turn", across, rho)
    page.write(RATES, along, -turn - omega, turn)


@POLAR("closed loop of the polar feedback law, Siegwart (3.58)")
def polar_closed_loop(page: Page) -> None:
    """v = k_rho rho, omega = k_alpha alpha + k_beta beta (Siegwart (3.56), (3.57)); no quotient is left."""
    rho, alpha, beta = page.read(COORDINATES)
    k_rho, k_alpha, k_beta = page.read(GAINS)
    omega = page.let("steer", k_alpha * alpha + k_beta * beta)
    swing = page.let("swing", k_rho * sin(alpha))
    page.write(RATES, -k_rho * rho * cos(alpha), swing - omega, -swing)
    page.write("v [m/s] speed forward; omega [rad/s] turning rate", k_rho * rho, omega)


@POLAR("linearised closed loop of the polar law at the goal, Siegwart (3.60)-(3.63)")
def polar_linearisation(page: Page) -> None:
    """A of d/dt (rho, alpha, beta) at the goal; s^3 + p2 s^2 + p1 s + p0 = det(s I - A)."""
    k_rho, k_alpha, k_beta = page.read(GAINS)
    page.write_matrix(
        "a [1/s]", sympy.Matrix([[-k_rho, 0, 0], [0, k_rho - k_alpha, -k_beta], [0, -k_rho, 0]])
    )
    text = "of the characteristic polynomial"
    page.write(
        f"p2 [1/s] {text}; p1 [1/s^2] {text}; p0 [1/s^3] {text}",
        k_alpha, k_rho * (k_alpha - k_rho - k_beta), -(k_rho**2) * k_beta,
    )  # fmt: skip


@POLAR("do gains stabilise the polar law, Siegwart (3.61)-(3.65), (3.65) corrected")
def polar_gains(page: Page) -> None:
    """Slack of the tightest condition: positive where all hold."""
    k_rho, k_alpha, k_beta = page.read(GAINS)
    signs = page.let("signs", minimum(k_rho, -k_beta))
    share = page.let("share", k_rho * 2 / sympy.pi)
    stable = page.let("hurwitz", minimum(signs, k_alpha - k_rho))
    page.write(
        "stable [1/s] Hurwitz: k_rho, -k_beta, k_alpha - k_rho; strong_3_65 [1/s] (3.65): k_rho, -k_beta, "
        "k_alpha + 5/3 k_beta - 2/pi k_rho; where stable > 0, too, alpha stays in I1 from |beta| <= 5 pi/6; "
        "strong_all_beta [1/s] corrected: stable, k_alpha + 2 k_beta - 2/pi k_rho; alpha stays in I1 from every beta",
        stable,
        minimum(signs, k_alpha + k_beta * sympy.Rational(5, 3) - share),
        minimum(stable, k_alpha + k_beta * 2 - share),
    )
