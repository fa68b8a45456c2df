"""Moving frames (Kelly 4.1): what an observer who moves sees, and wheels at the end of a chain of frames.

All vectors of a function are written in the coordinates of one common frame. Positions in m, velocities in m/s,
accelerations in m/s^2.
"""

from __future__ import annotations

from textbook.page import Page, Rows, Vector
from textbook.vectors import IDENTITY, beside, cross, plus, product, scaled, skew
from wmrgen.kinematics.records import Formula
from wmrgen.symbolic import Expr

ACCELERATION, RATE2 = "m/s^2", "rad/s^2"


def centripetal(omega: Vector, r: Vector) -> Vector:
    """omega x (omega x r)."""
    return cross(omega, cross(omega, r))


def coriolis(omega: Vector, v: Vector) -> Vector:
    """2 omega x v."""
    a, b, c = (2 * entry for entry in cross(omega, v))
    return a, b, c


def h_rows(r: Vector) -> Rows:
    """Kelly (4.24): H(r) = [I | -[r]x], 3 x 6."""
    return beside(IDENTITY, tuple(tuple(-entry for entry in row) for row in skew(r)))


def omega_rows(omega: Vector) -> Rows:
    """Kelly (4.25), corrected: Omega(omega) = [[omega]x [omega]x | 2 [omega]x], 3 x 6."""
    s = skew(omega)
    return beside(product(s, s), tuple(tuple(2 * entry for entry in row) for row in s))


def transport_theorem() -> Formula:
    """Kelly 4.1.2.3: (du/dt)_f = (du/dt)_m + omega x u."""
    page = Page("transport_theorem", "rate of a vector for a fixed observer, Kelly 4.1.2.3")
    u_rate = page.vector("u_rate", "1/s", "rate of u for the moving observer")
    omega = page.vector("omega", "rad/s", "angular velocity of the moving observer")
    u = page.vector("u", "", "the vector")
    page.gives_vector("rate", "1/s", plus(u_rate, cross(omega, u)), "rate of u for the fixed observer")
    return page.formula()


def galilean() -> Formula:
    """Kelly 4.1.2.2: r_f = r_m + r_0 + v t, between observers that do not turn."""
    page = Page("galilean", "position for the other of two observers in uniform motion, Kelly 4.1.2.2")
    r = page.vector("r", "m", "position for the moving observer")
    start = page.vector("r_start", "m", "place of the moving observer at time 0")
    v = page.vector("v", "m/s", "velocity of the moving observer")
    t = page.given("t", "s", "time")
    page.gives_vector("r", "m", plus(r, start, scaled(t, v)), "position for the fixed observer")
    return page.formula()


def moving_frame_velocity() -> Formula:
    """Kelly 4.1.2.4 and (4.23): v_o = v_m + omega x r + v_o^m, one step of the velocity recursion."""
    page = Page("moving_frame_velocity", "velocity of what moves in a moving frame, Kelly 4.1.2.4, (4.23)")
    v_m = page.vector("v_m", "m/s", "velocity of the moving frame")
    omega = page.vector("omega", "rad/s", "angular velocity of the moving frame")
    r = page.vector("r", "m", "position in the moving frame")
    v_o = page.vector("v_o", "m/s", "velocity in the moving frame")
    page.gives_vector("v", "m/s", plus(v_m, cross(omega, r), v_o), "velocity in the fixed frame")
    return page.formula()


def moving_frame_acceleration() -> Formula:
    """Kelly 4.1.2.5: a = a_m + alpha x r + omega x (omega x r) + 2 omega x v_o^m + a_o^m."""
    page = Page("moving_frame_acceleration", "acceleration of what moves in a moving frame, Kelly 4.1.2.5")
    a_m = page.vector("a_m", ACCELERATION, "acceleration of the moving frame")
    alpha = page.vector("alpha", RATE2, "angular acceleration of the moving frame")
    omega = page.vector("omega", "rad/s", "angular velocity of the moving frame")
    r = page.vector("r", "m", "position in the moving frame")
    v_o = page.vector("v_o", "m/s", "velocity in the moving frame")
    a_o = page.vector("a_o", ACCELERATION, "acceleration in the moving frame")
    euler, inward, sideways = cross(alpha, r), centripetal(omega, r), coriolis(omega, v_o)
    page.gives_vector("a", ACCELERATION, plus(a_m, euler, inward, sideways, a_o), "in the fixed frame")
    page.gives_vector("euler", ACCELERATION, euler, "alpha x r")
    page.gives_vector("centripetal", ACCELERATION, inward, "omega x (omega x r)")
    page.gives_vector("coriolis", ACCELERATION, sideways, "2 omega x v_o")
    return page.formula()


def skew_matrix() -> Formula:
    """Kelly 4.1.4.1: [u]x, row by row."""
    page = Page("skew_matrix", "the matrix of u x, Kelly 4.1.4.1")
    page.gives_matrix("m", skew(page.vector("u", "", "the vector")))
    return page.formula()


def h_matrix() -> Formula:
    """Kelly (4.24): H(r), row by row."""
    page = Page("h_matrix", "H(r) = [I, -[r]x], Kelly (4.24)")
    page.gives_matrix("h", h_rows(page.vector("r", "m", "position in the moving frame")))
    return page.formula()


def omega_matrix() -> Formula:
    """Kelly (4.25), corrected: Omega(omega), row by row."""
    page = Page("omega_matrix", "Omega = [[omega]x [omega]x, 2 [omega]x], Kelly (4.25), corrected")
    page.gives_matrix("o", omega_rows(page.vector("omega", "rad/s", "angular velocity of the moving frame")))
    return page.formula()


def two_velocities(page: Page, first: str, second: str) -> tuple[Vector, Vector]:
    """Kelly (4.27): velocity of a point seen through two frames, and as the first frame sees it."""
    r1 = page.vector(f"r_{first}", "m", f"position of the point from frame {first}")
    r2 = page.vector(f"r_{second}", "m", f"position of the point from frame {second}")
    v1 = page.vector(f"v_{first}", "m/s", f"velocity of frame {first}")
    w1 = page.vector(f"omega_{first}", "rad/s", f"angular velocity of frame {first}")
    v2 = page.vector(f"v_{second}", "m/s", f"velocity of frame {second} in frame {first}")
    w2 = page.vector(f"omega_{second}", "rad/s", f"angular velocity of frame {second} in frame {first}")
    v_o = page.vector("v_o", "m/s", f"velocity of the point in frame {second}")
    seen = plus(v2, cross(w2, r2), v_o)
    return plus(v1, cross(w1, r1), seen), seen


def two_accelerations(page: Page, first: str, second: str) -> tuple[Vector, Vector]:
    """Kelly (4.29): acceleration of a point seen through two frames, and its velocity in the first."""
    r1 = page.vector(f"r_{first}", "m", f"position of the point from frame {first}")
    r2 = page.vector(f"r_{second}", "m", f"position of the point from frame {second}")
    a1 = page.vector(f"a_{first}", ACCELERATION, f"acceleration of frame {first}")
    alpha1 = page.vector(f"alpha_{first}", RATE2, f"angular acceleration of frame {first}")
    w1 = page.vector(f"omega_{first}", "rad/s", f"angular velocity of frame {first}")
    v2 = page.vector(f"v_{second}", "m/s", f"velocity of frame {second} in frame {first}")
    a2 = page.vector(f"a_{second}", ACCELERATION, f"acceleration of frame {second} in frame {first}")
    alpha2 = page.vector(f"alpha_{second}", RATE2, f"angular acceleration of frame {second} in frame {first}")
    w2 = page.vector(f"omega_{second}", "rad/s", f"angular velocity of frame {second} in frame {first}")
    v_o = page.vector("v_o", "m/s", f"velocity of the point in frame {second}")
    a_o = page.vector("a_o", ACCELERATION, f"acceleration of the point in frame {second}")
    seen_velocity = plus(v2, cross(w2, r2), v_o)
    seen = plus(a2, cross(alpha2, r2), centripetal(w2, r2), coriolis(w2, v_o), a_o)
    total = plus(a1, cross(alpha1, r1), centripetal(w1, r1), coriolis(w1, seen_velocity), seen)
    return total, seen_velocity


def two_step_velocity() -> Formula:
    """Kelly (4.27)."""
    page = Page("two_step_velocity", "velocity of a point through a chain of two frames, Kelly (4.27)")
    v, _ = two_velocities(page, "1", "2")
    page.gives_vector("v", "m/s", v, "velocity in the fixed frame")
    return page.formula()


def two_step_acceleration() -> Formula:
    """Kelly (4.29)."""
    page = Page("two_step_acceleration", "acceleration of a point through two frames, Kelly (4.29)")
    a, _ = two_accelerations(page, "1", "2")
    page.gives_vector("a", ACCELERATION, a, "acceleration in the fixed frame")
    return page.formula()


def articulated_wheel_velocity() -> Formula:
    """Kelly (4.30): contact velocity through vehicle and suspension or steering."""
    page = Page("articulated_wheel_velocity", "velocity of the contact of an articulated wheel, Kelly (4.30)")
    v, seen = two_velocities(page, "vehicle", "steer")
    page.gives_vector("v", "m/s", v, "velocity of the contact")
    page.gives_vector("v_seen", "m/s", seen, "velocity of the contact seen from the vehicle")
    return page.formula()


def articulated_wheel_acceleration() -> Formula:
    """Kelly (4.31): contact acceleration through vehicle and suspension or steering."""
    page = Page(
        "articulated_wheel_acceleration", "acceleration of the contact of an articulated wheel, Kelly (4.31)"
    )
    a, seen = two_accelerations(page, "vehicle", "steer")
    page.gives_vector("a", ACCELERATION, a, "acceleration of the contact")
    page.gives_vector("v_seen", "m/s", seen, "velocity of the contact seen from the vehicle")
    return page.formula()


def _vehicle(page: Page) -> tuple[Vector, Vector, Vector]:
    return (
        page.vector("v", "m/s", "velocity of the vehicle"),
        page.vector("omega", "rad/s", "angular velocity of the vehicle"),
        page.vector("r", "m", "contact point from the vehicle's origin"),
    )


def wheel_velocity() -> Formula:
    """Kelly (4.40): v_c = v - [r]x omega, with all three components."""
    page = Page("wheel_velocity", "velocity of a contact of the vehicle in space, Kelly (4.40)")
    v, omega, r = _vehicle(page)
    page.gives_vector("v", "m/s", plus(v, cross(omega, r)), "velocity of the contact")
    return page.formula()


def offset_wheel_velocity() -> Formula:
    """Kelly (4.39): v_c = v - [r]x omega - [R_s r_s]x omega_s."""
    page = Page("offset_wheel_velocity", "velocity of the contact of an offset steered wheel, Kelly (4.39)")
    v, omega, r = _vehicle(page)
    r_s = page.vector("r_steer", "m", "contact point from the steering axis, vehicle coordinates")
    omega_s = page.vector("omega_steer", "rad/s", "angular velocity of steering against the vehicle")
    total = plus(v, cross(omega, r), cross(omega_s, r_s))
    page.gives_vector("v", "m/s", total, "velocity of the contact")
    return page.formula()


def specific_force() -> Formula:
    """Kelly 4.1.3: t_c = t_s + alpha x r + omega x (omega x r) + 2 omega x v + a, with t = a - g."""
    page = Page(
        "specific_force", "specific force at the centre of gravity from that at a sensor, Kelly 4.1.3"
    )
    t = page.vector("t", ACCELERATION, "specific force a - g at the sensor")
    alpha = page.vector("alpha", RATE2, "angular acceleration")
    omega = page.vector("omega", "rad/s", "angular velocity")
    r = page.vector("r", "m", "centre of gravity from the sensor")
    v = page.vector("v", "m/s", "velocity of the centre of gravity against the sensor")
    a = page.vector("a", ACCELERATION, "acceleration of the centre of gravity against the sensor")
    total: tuple[Expr, ...] = plus(t, cross(alpha, r), centripetal(omega, r), coriolis(omega, v), a)
    page.gives_vector("t", ACCELERATION, total, "specific force at the centre of gravity")
    return page.formula()
