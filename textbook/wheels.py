"""Relations of a single wheel: disk, unicycle, sensed wheel, contributions, Swedish and mecanum wheel, omni pair."""

from __future__ import annotations

import sympy

from textbook.page import Chapter, Page
from wmrgen.analysis.kinematics.contacts import mecanum_roller
from wmrgen.geometry.symbolic import absolute

WHEELS = Chapter("Single wheels")
SPIN = "wheel speed about its axle"
TWIST = "vx [m/s] forward; vy [m/s] to the left; omega [rad/s] turning rate"
MECANUM = (
    "radius [m] radius R of the wheel; r_sw [m] roller radius; alpha [rad] hub axis to roller axis; "
    "phi [rad] wheel frame against the robot frame; dx [m] contact point, robot frame; "
    "dy [m] contact point, robot frame"
)
cos, sin = sympy.cos, sympy.sin


@WHEELS("velocity of a disk that rolls without slipping, Tzafestas (2.24), Kelly 4.2.1.3")
def rolling_disk(page: Page) -> None:
    """x' = r spin cos phi, y' = r spin sin phi."""
    r, spin, phi = page.read(f"r [m] radius; spin [rad/s] {SPIN}; phi [rad] heading")
    velocity = page.vector_at("velocity", r * spin, phi)
    page.write("x_rate [m/s] world frame; y_rate [m/s] world frame", *velocity)


@WHEELS("sideways speed of a disk, 0 while it rolls, Tzafestas (2.25), Kelly 4.2.1.4, AA274")
def disk_constraint(page: Page) -> None:
    """x' sin phi - y' cos phi = 0 (Kelly's corrected)."""
    phi, x_rate, y_rate = page.read("phi [rad] heading; x_rate [m/s] world frame; y_rate [m/s] world frame")
    page.write("w1 [] coefficient of x_rate; w2 [] coefficient of y_rate", sin(phi), -cos(phi))
    page.write("slide [m/s] speed to the right", x_rate * sin(phi) - y_rate * cos(phi))


@WHEELS("rates of the unicycle, Tzafestas (2.28), AA274")
def unicycle(page: Page) -> None:
    """x' = v cos theta, y' = v sin theta, theta' = omega (Tzafestas (2.26)-(2.28))."""
    theta, v, omega = page.read("theta [rad] heading; v [m/s] speed; omega [rad/s] turning rate")
    velocity = page.vector_at("velocity", v, theta)
    page.write("x_rate [m/s] world frame; y_rate [m/s] world frame", *velocity)
    page.write("theta_rate [rad/s]", omega)


@WHEELS("velocity that a steered wheel senses, Kelly 4.2.2.2.1")
def steer_sense(page: Page) -> None:
    """v = r spin along the steering angle."""
    r, spin, steer = page.read(f"r [m] radius; spin [rad/s] {SPIN}; steer [rad] heading of the wheel")
    along = "v [m/s] along the wheel; vx [m/s] forward; vy [m/s] to the left"
    page.write(along, r * spin, *page.vector_at("velocity", r * spin, steer))


@WHEELS("what the wheels of a differential drive contribute, Siegwart (3.7), (3.8)")
def wheel_contributions(page: Page) -> None:
    r, l, right, left = page.read(
        f"r [m] radius; l [m] half track; right.spin [rad/s] {SPIN}; left.spin [rad/s] {SPIN}"
    )
    turn_right = page.quotient("turn_right", r * right, 2 * l)
    turn_left = page.quotient("turn_left", -r * left, 2 * l)
    text = "turning rate from this wheel"
    page.write(f"right.omega [rad/s] {text}; left.omega [rad/s] {text}", turn_right, turn_left)
    forward = r * right / 2 + r * left / 2
    page.write("vx [m/s] forward; omega [rad/s] turning rate of both", forward, turn_right + turn_left)


@WHEELS("wheel and roller rates of a Swedish wheel, Siegwart (3.19), (3.20) corrected")
def swedish_wheel(page: Page) -> None:
    vx, vy, omega, l, alpha, beta, gamma, r, r_sw = page.read(
        f"{TWIST}; l [m] distance from P; alpha [rad] direction from P; beta [rad] wheel plane; "
        "gamma [rad] wheel plane to roller axis at the ground; r [m] radius; r_sw [m] roller radius"
    )
    a = page.let("direction", alpha + beta + gamma)
    b = page.let("lever", beta + gamma)
    turning_along, turning_across = page.vector_at("turning", l * omega, b)
    along = page.let("along", sin(a) * vx - cos(a) * vy - turning_along)
    across = page.let("across", cos(a) * vx + sin(a) * vy + turning_across)
    spin = page.quotient("spin", along, r * cos(gamma))
    roller = page.quotient("roller", across + r * sin(gamma) * spin, r_sw)
    page.write(f"spin [rad/s] {SPIN}; roller [rad/s] roller rate", spin, roller)


@WHEELS("Jacobian of one mecanum wheel and its determinant, Tzafestas (2.79)")
def mecanum_wheel(page: Page) -> None:
    """Columns are wheel rate, roller rate and turning about the contact; det J = -R r sin alpha."""
    R, r, alpha, phi, dx, dy = page.read(MECANUM)
    wheel_x, wheel_y = page.vector_at("wheel", R, phi)
    roller_x, roller_y = page.vector_at("roller", r, phi + alpha)
    rows = [[-wheel_y, roller_y, dy], [wheel_x, -roller_x, -dx], [0, 0, 1]]
    page.write_matrix("m []", sympy.Matrix(rows))
    page.write("det [m^2] regular where it is not 0", -R * r * sin(alpha))


@WHEELS("wheel and roller rate of a twist, Tzafestas (2.79) inverted")
def mecanum_wheel_inverse(page: Page) -> None:
    R, r, alpha, phi, dx, dy = page.read(MECANUM)
    vx, vy, omega = page.read(TWIST)
    a, b = page.let("a", vx - dy * omega), page.let("b", vy + dx * omega)
    spin = page.quotient("wheel", -(a * cos(phi + alpha) + b * sin(phi + alpha)), -R * sin(alpha))
    roller = page.quotient("rolling", -(a * cos(phi) + b * sin(phi)), -r * sin(alpha))
    rates = f"spin [rad/s] {SPIN}; roller [rad/s] roller rate; turn [rad/s] turning about the contact"
    page.write(rates, spin, roller, omega)


WHEELS.functions["mecanum_roller"] = mecanum_roller


@WHEELS("drive speed, roller speed and velocity augmentation of a wheel, Tzafestas (2.71)")
def omni_wheel(page: Page) -> None:
    """v_h^2 = v_i^2 + v_roller^2."""
    v, beta, gamma = page.read(
        "v [m/s] speed of the hub; beta [rad] drive direction of the wheel; "
        "gamma [rad] direction of the hub's velocity"
    )
    c = page.let("c", cos(gamma - beta))
    page.write("drive [m/s] rim speed of the wheel", v * c)
    page.write("roller [m/s] speed taken up by the roller", absolute(v * sin(gamma - beta)))
    page.write("vaf [] hub speed by rim speed", page.quotient("factor", sympy.S.One, absolute(c)))
