"""Moving frames (Kelly 4.1): what an observer who moves sees, and wheels at the end of a chain of frames.

All vectors of a function are written in the coordinates of one common frame. Positions in m, velocities in m/s,
accelerations in m/s^2. The recursion is the one that wmrgen takes through the frames of a robot.
"""

from __future__ import annotations

import sympy

from textbook.page import Chapter, Page
from wmrgen.functions.space.wheel_motion import Frame, Point, Vector, cross, plus, scaled, seen_from_before

FRAMES = Chapter("Moving frames")
ZERO: Vector = (sympy.S.Zero, sympy.S.Zero, sympy.S.Zero)


def skew(u: Vector) -> sympy.Matrix:
    """[u]x, 3 x 3, with [u]x v = u x v (Kelly 4.1.4.1)."""
    x, y, z = u
    return sympy.Matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def h_rows(r: Vector) -> sympy.Matrix:
    """Kelly (4.24): H(r) = [I | -[r]x], 3 x 6."""
    return sympy.eye(3).row_join(-skew(r))


def omega_rows(omega: Vector) -> sympy.Matrix:
    """Kelly (4.25), corrected: Omega(omega) = [[omega]x [omega]x | 2 [omega]x], 3 x 6."""
    return (skew(omega) * skew(omega)).row_join(2 * skew(omega))


@FRAMES("rate of a vector for a fixed observer, Kelly 4.1.2.3")
def transport_theorem(page: Page) -> None:
    """(du/dt)_f = (du/dt)_m + omega x u."""
    u_rate, omega, u = page.vectors(
        "u_rate [1/s] rate of u for the moving observer; "
        "omega [rad/s] angular velocity of the moving observer; u [] the vector"
    )
    page.write_vector("rate [1/s] rate of u for the fixed observer", plus(u_rate, cross(omega, u)))


@FRAMES("position for the other of two observers in uniform motion, Kelly 4.1.2.2")
def galilean(page: Page) -> None:
    """r_f = r_m + r_0 + v t, between observers that do not turn."""
    r, start, v = page.vectors(
        "r [m] position for the moving observer; r_start [m] place of the moving observer at time 0; "
        "v [m/s] velocity of the moving observer"
    )
    (t,) = page.read("t [s] time")
    page.write_vector("r [m] position for the fixed observer", plus(r, start, scaled(t, v)))


@FRAMES("velocity of what moves in a moving frame, Kelly 4.1.2.4, (4.23)")
def moving_frame_velocity(page: Page) -> None:
    """v_o = v_m + omega x r + v_o^m, one step of the velocity recursion."""
    v_m, omega, r, v_o = page.vectors(
        "v_m [m/s] velocity of the moving frame; omega [rad/s] angular velocity of the moving frame; "
        "r [m] position in the moving frame; v_o [m/s] velocity in the moving frame"
    )
    moved = seen_from_before(Frame(v_m, omega, ZERO, ZERO), ZERO, Point(r, v_o, ZERO))
    page.write_vector("v [m/s] velocity in the fixed frame", moved.v)


@FRAMES("acceleration of what moves in a moving frame, Kelly 4.1.2.5")
def moving_frame_acceleration(page: Page) -> None:
    """a = a_m + alpha x r + omega x (omega x r) + 2 omega x v_o^m + a_o^m."""
    a_m, alpha, omega, r, v_o, a_o = page.vectors(
        "a_m [m/s^2] acceleration of the moving frame; "
        "alpha [rad/s^2] angular acceleration of the moving frame; "
        "omega [rad/s] angular velocity of the moving frame; r [m] position in the moving frame; "
        "v_o [m/s] velocity in the moving frame; a_o [m/s^2] acceleration in the moving frame"
    )
    moved = seen_from_before(Frame(ZERO, omega, a_m, alpha), ZERO, Point(r, v_o, a_o))
    page.write_vector("a [m/s^2] in the fixed frame", moved.a)
    page.write_vector("euler [m/s^2] alpha x r", cross(alpha, r))
    page.write_vector("centripetal [m/s^2] omega x (omega x r)", cross(omega, cross(omega, r)))
    page.write_vector("coriolis [m/s^2] 2 omega x v_o", scaled(sympy.Integer(2), cross(omega, v_o)))


@FRAMES("the matrix of u x, Kelly 4.1.4.1")
def skew_matrix(page: Page) -> None:
    page.write_matrix("m []", skew(*page.vectors("u [] the vector")))


@FRAMES("H(r) = [I, -[r]x], Kelly (4.24)")
def h_matrix(page: Page) -> None:
    page.write_matrix("h []", h_rows(*page.vectors("r [m] position in the moving frame")))


@FRAMES("Omega = [[omega]x [omega]x, 2 [omega]x], Kelly (4.25), corrected")
def omega_matrix(page: Page) -> None:
    page.write_matrix("o []", omega_rows(*page.vectors("omega [rad/s] angular velocity of the moving frame")))


def two_velocities(page: Page, first: str, second: str) -> tuple[Vector, Vector]:
    """Kelly (4.27): velocity of a point seen through two frames, and as the first frame sees it."""
    r1, r2, v1, w1, v2, w2, v_o = page.vectors(
        f"r_{first} [m] position of the point from frame {first}; "
        f"r_{second} [m] position of the point from frame {second}; "
        f"v_{first} [m/s] velocity of frame {first}; omega_{first} [rad/s] angular velocity of frame {first}; "
        f"v_{second} [m/s] velocity of frame {second} in frame {first}; "
        f"omega_{second} [rad/s] angular velocity of frame {second} in frame {first}; "
        f"v_o [m/s] velocity of the point in frame {second}"
    )
    seen = seen_from_before(Frame(v2, w2, ZERO, ZERO), ZERO, Point(r2, v_o, ZERO))
    return seen_from_before(Frame(v1, w1, ZERO, ZERO), ZERO, Point(r1, seen.v, ZERO)).v, seen.v


def two_accelerations(page: Page, first: str, second: str) -> tuple[Vector, Vector]:
    """Kelly (4.29): acceleration of a point seen through two frames, and its velocity in the first."""
    r1, r2, a1, alpha1, w1, v2, a2, alpha2, w2, v_o, a_o = page.vectors(
        f"r_{first} [m] position of the point from frame {first}; "
        f"r_{second} [m] position of the point from frame {second}; "
        f"a_{first} [m/s^2] acceleration of frame {first}; "
        f"alpha_{first} [rad/s^2] angular acceleration of frame {first}; "
        f"omega_{first} [rad/s] angular velocity of frame {first}; "
        f"v_{second} [m/s] velocity of frame {second} in frame {first}; "
        f"a_{second} [m/s^2] acceleration of frame {second} in frame {first}; "
        f"alpha_{second} [rad/s^2] angular acceleration of frame {second} in frame {first}; "
        f"omega_{second} [rad/s] angular velocity of frame {second} in frame {first}; "
        f"v_o [m/s] velocity of the point in frame {second}; "
        f"a_o [m/s^2] acceleration of the point in frame {second}"
    )
    seen = seen_from_before(Frame(v2, w2, a2, alpha2), ZERO, Point(r2, v_o, a_o))
    return seen_from_before(Frame(ZERO, w1, a1, alpha1), ZERO, Point(r1, seen.v, seen.a)).a, seen.v


@FRAMES("velocity of a point through a chain of two frames, Kelly (4.27)")
def two_step_velocity(page: Page) -> None:
    page.write_vector("v [m/s] velocity in the fixed frame", two_velocities(page, "1", "2")[0])


@FRAMES("acceleration of a point through two frames, Kelly (4.29)")
def two_step_acceleration(page: Page) -> None:
    page.write_vector("a [m/s^2] acceleration in the fixed frame", two_accelerations(page, "1", "2")[0])


@FRAMES("velocity of the contact of an articulated wheel, Kelly (4.30)")
def articulated_wheel_velocity(page: Page) -> None:
    """The second frame is that of suspension or steering."""
    v, seen = two_velocities(page, "vehicle", "steer")
    page.write_vector("v [m/s] velocity of the contact", v)
    page.write_vector("v_seen [m/s] velocity of the contact seen from the vehicle", seen)


@FRAMES("acceleration of the contact of an articulated wheel, Kelly (4.31)")
def articulated_wheel_acceleration(page: Page) -> None:
    """The second frame is that of suspension or steering."""
    a, seen = two_accelerations(page, "vehicle", "steer")
    page.write_vector("a [m/s^2] acceleration of the contact", a)
    page.write_vector("v_seen [m/s] velocity of the contact seen from the vehicle", seen)


_VEHICLE = (
    "v [m/s] velocity of the vehicle; omega [rad/s] angular velocity of the vehicle; "
    "r [m] contact point from the vehicle's origin"
)


@FRAMES("velocity of a contact of the vehicle in space, Kelly (4.40)")
def wheel_velocity(page: Page) -> None:
    """v_c = v - [r]x omega, with all three components."""
    v, omega, r = page.vectors(_VEHICLE)
    page.write_vector("v [m/s] velocity of the contact", plus(v, cross(omega, r)))


@FRAMES("velocity of the contact of an offset steered wheel, Kelly (4.39)")
def offset_wheel_velocity(page: Page) -> None:
    """v_c = v - [r]x omega - [R_s r_s]x omega_s."""
    v, omega, r, r_s, omega_s = page.vectors(
        f"{_VEHICLE}; r_steer [m] contact point from the steering axis, vehicle coordinates; "
        "omega_steer [rad/s] angular velocity of steering against the vehicle"
    )
    page.write_vector("v [m/s] velocity of the contact", plus(v, cross(omega, r), cross(omega_s, r_s)))


@FRAMES("specific force at the centre of gravity from that at a sensor, Kelly 4.1.3")
def specific_force(page: Page) -> None:
    """t_c = t_s + alpha x r + omega x (omega x r) + 2 omega x v + a, with t = a - g."""
    t, alpha, omega, r, v, a = page.vectors(
        "t [m/s^2] specific force a - g at the sensor; alpha [rad/s^2] angular acceleration; "
        "omega [rad/s] angular velocity; r [m] centre of gravity from the sensor; "
        "v [m/s] velocity of the centre of gravity against the sensor; "
        "a [m/s^2] acceleration of the centre of gravity against the sensor"
    )
    moved = seen_from_before(Frame(ZERO, omega, t, alpha), ZERO, Point(r, v, a))
    page.write_vector("t [m/s^2] specific force at the centre of gravity", moved.a)
