"""Relations of a single wheel: disk, unicycle, sensed wheel, contributions, Swedish and mecanum wheel, omni pair."""

from __future__ import annotations

import sympy

from textbook.page import Page, Rows
from textbook.vectors import ONE, ZERO
from wmrgen.kinematics.records import Formula
from wmrgen.symbolic import Expr, absolute

SPIN = "wheel speed about its axle"
cos, sin = sympy.cos, sympy.sin


def rolling_disk() -> Formula:
    """Tzafestas (2.24), Kelly 4.2.1.3: x' = r spin cos phi, y' = r spin sin phi."""
    page = Page(
        "rolling_disk", "velocity of a disk that rolls without slipping, Tzafestas (2.24), Kelly 4.2.1.3"
    )
    r, spin = page.given("r", "m", "radius"), page.given("spin", "rad/s", SPIN)
    phi = page.given("phi", "rad", "heading")
    page.gives("x_rate", "m/s", r * spin * cos(phi), "world frame")
    page.gives("y_rate", "m/s", r * spin * sin(phi), "world frame")
    return page.formula()


def disk_constraint() -> Formula:
    """Tzafestas (2.25), Kelly 4.2.1.4 corrected, AA274: x' sin phi - y' cos phi = 0."""
    page = Page(
        "disk_constraint",
        "sideways speed of a disk, 0 while it rolls, Tzafestas (2.25), Kelly 4.2.1.4, AA274",
    )
    phi = page.given("phi", "rad", "heading")
    x_rate, y_rate = page.given("x_rate", "m/s", "world frame"), page.given("y_rate", "m/s", "world frame")
    page.gives("w1", "", sin(phi), "coefficient of x_rate")
    page.gives("w2", "", -cos(phi), "coefficient of y_rate")
    page.gives("slide", "m/s", x_rate * sin(phi) - y_rate * cos(phi), "speed to the right")
    return page.formula()


def unicycle() -> Formula:
    """Tzafestas (2.26)-(2.28), AA274: x' = v cos theta, y' = v sin theta, theta' = omega."""
    page = Page("unicycle", "rates of the unicycle, Tzafestas (2.28), AA274")
    theta = page.given("theta", "rad", "heading")
    v, omega = page.given("v", "m/s", "speed"), page.given("omega", "rad/s", "turning rate")
    page.gives("x_rate", "m/s", v * cos(theta), "world frame")
    page.gives("y_rate", "m/s", v * sin(theta), "world frame")
    page.gives("theta_rate", "rad/s", omega)
    return page.formula()


def steer_sense() -> Formula:
    """Kelly 4.2.2.2.1: v = r spin along the steering angle."""
    page = Page("steer_sense", "velocity that a steered wheel senses, Kelly 4.2.2.2.1")
    r, spin = page.given("r", "m", "radius"), page.given("spin", "rad/s", SPIN)
    steer = page.given("steer", "rad", "heading of the wheel")
    page.gives("v", "m/s", r * spin, "along the wheel")
    page.gives("vx", "m/s", r * spin * cos(steer), "forward")
    page.gives("vy", "m/s", r * spin * sin(steer), "to the left")
    return page.formula()


def wheel_contributions() -> Formula:
    """Siegwart (3.6)-(3.8): what each wheel of a differential drive contributes to the twist."""
    page = Page(
        "wheel_contributions", "what the wheels of a differential drive contribute, Siegwart (3.7), (3.8)"
    )
    r, l = page.given("r", "m", "radius"), page.given("l", "m", "half track")
    right, left = page.given("right.spin", "rad/s", SPIN), page.given("left.spin", "rad/s", SPIN)
    turn_right = page.quotient("turn_right", r * right, 2 * l)
    turn_left = page.quotient("turn_left", -r * left, 2 * l)
    page.gives("right.omega", "rad/s", turn_right, "turning rate from this wheel")
    page.gives("left.omega", "rad/s", turn_left, "turning rate from this wheel")
    page.gives("vx", "m/s", r * right / 2 + r * left / 2, "forward")
    page.gives("omega", "rad/s", turn_right + turn_left, "turning rate of both")
    return page.formula()


def swedish_wheel() -> Formula:
    """Siegwart (3.19) and (3.20), the latter with the corrected sign: spin and roller rate of a twist."""
    page = Page(
        "swedish_wheel", "wheel and roller rates of a Swedish wheel, Siegwart (3.19), (3.20) corrected"
    )
    vx, vy = page.given("vx", "m/s", "forward"), page.given("vy", "m/s", "to the left")
    omega, l = page.given("omega", "rad/s", "turning rate"), page.given("l", "m", "distance from P")
    alpha, beta = page.given("alpha", "rad", "direction from P"), page.given("beta", "rad", "wheel plane")
    gamma = page.given("gamma", "rad", "wheel plane to roller axis at the ground")
    r, r_sw = page.given("r", "m", "radius"), page.given("r_sw", "m", "roller radius")
    a = page.let("direction", alpha + beta + gamma)
    b = page.let("lever", beta + gamma)
    along = page.let("along", sin(a) * vx - cos(a) * vy - l * cos(b) * omega)
    across = page.let("across", cos(a) * vx + sin(a) * vy + l * sin(b) * omega)
    spin = page.quotient("spin", along, r * cos(gamma))
    page.gives("spin", "rad/s", spin, SPIN)
    page.gives(
        "roller", "rad/s", page.quotient("roller", across + r * sin(gamma) * spin, r_sw), "roller rate"
    )
    return page.formula()


def mecanum_rows(R: Expr, r: Expr, alpha: Expr, phi: Expr, dx: Expr, dy: Expr) -> Rows:
    """Tzafestas (2.79): columns are wheel rate, roller rate and turning about the contact."""
    return (
        (-R * sin(phi), r * sin(phi + alpha), dy),
        (R * cos(phi), -r * cos(phi + alpha), -dx),
        (ZERO, ZERO, ONE),
    )


def _mecanum(page: Page) -> tuple[Expr, ...]:
    return (
        page.given("radius", "m", "radius R of the wheel"),
        page.given("r_sw", "m", "roller radius"),
        page.given("alpha", "rad", "hub axis to roller axis"),
        page.given("phi", "rad", "wheel frame against the robot frame"),
        page.given("dx", "m", "contact point, robot frame"),
        page.given("dy", "m", "contact point, robot frame"),
    )


def mecanum_wheel() -> Formula:
    """Tzafestas (2.76)-(2.79): the Jacobian of one mecanum wheel, row by row, and det J = -R r sin alpha."""
    page = Page("mecanum_wheel", "Jacobian of one mecanum wheel and its determinant, Tzafestas (2.79)")
    R, r, alpha, phi, dx, dy = _mecanum(page)
    page.gives_matrix("m", mecanum_rows(R, r, alpha, phi, dx, dy))
    page.gives("det", "m^2", -R * r * sin(alpha), "regular where it is not 0")
    return page.formula()


def mecanum_wheel_inverse() -> Formula:
    """Tzafestas (2.79) inverted: wheel rate, roller rate and turning about the contact of a twist."""
    page = Page("mecanum_wheel_inverse", "wheel and roller rate of a twist, Tzafestas (2.79) inverted")
    R, r, alpha, phi, dx, dy = _mecanum(page)
    vx, vy = page.given("vx", "m/s", "forward"), page.given("vy", "m/s", "to the left")
    omega = page.given("omega", "rad/s", "turning rate")
    a, b = page.let("a", vx - dy * omega), page.let("b", vy + dx * omega)
    spin = -(a * cos(phi + alpha) + b * sin(phi + alpha))
    roller = -(a * cos(phi) + b * sin(phi))
    page.gives("spin", "rad/s", page.quotient("wheel", spin, -R * sin(alpha)), SPIN)
    page.gives("roller", "rad/s", page.quotient("rolling", roller, -r * sin(alpha)), "roller rate")
    page.gives("turn", "rad/s", omega, "turning about the contact")
    return page.formula()


def omni_wheel() -> Formula:
    """Tzafestas (2.71), v_h^2 = v_i^2 + v_roller^2: drive and roller speed, velocity augmentation factor."""
    page = Page(
        "omni_wheel", "drive speed, roller speed and velocity augmentation of a wheel, Tzafestas (2.71)"
    )
    v = page.given("v", "m/s", "speed of the hub")
    beta = page.given("beta", "rad", "drive direction of the wheel")
    gamma = page.given("gamma", "rad", "direction of the hub's velocity")
    c = page.let("c", cos(gamma - beta))
    page.gives("drive", "m/s", v * c, "rim speed of the wheel")
    page.gives("roller", "m/s", absolute(v * sin(gamma - beta)), "speed taken up by the roller")
    page.gives("vaf", "", page.quotient("factor", ONE, absolute(c)), "hub speed by rim speed")
    return page.formula()
