"""Frames: planar rotations (Siegwart (3.2)-(3.5), Tzafestas (2.16), (2.17)), SE(2), and homogeneous transforms
of space (Tzafestas (2.9)-(2.18), (2.15b) with the corrected sign).

Siegwart's R(theta) takes world to robot coordinates, Tzafestas's R(phi) is its transpose.
"""

from __future__ import annotations

import sympy

from textbook.page import Chapter, Page
from wmrgen.geometry.symbolic import Expr

PLANE, SPACE = Chapter("Frames of the plane"), Chapter("Frames of space")
HEADING = "theta [rad] heading of the robot, counter-clockwise from world x"
TWIST = (
    "vx [m/s] velocity of P forward, robot frame; vy [m/s] velocity of P to the left, robot frame; "
    "omega [rad/s] turning rate"
)
RATES = (
    "x_rate [m/s] velocity in the world frame; y_rate [m/s] velocity in the world frame; "
    "theta_rate [rad/s] turning rate"
)


def world_to_robot_rows(theta: Expr) -> sympy.Matrix:
    """Siegwart (3.2): R(theta), 3 x 3, xi_R = R(theta) xi_I."""
    return rotation_rows("z", theta).T


def rotation_rows(axis: str, angle: Expr) -> sympy.Matrix:
    """Right-handed rotation about an axis: Tzafestas (2.15a), (2.15b) corrected, (2.15c)."""
    c, s = sympy.cos(angle), sympy.sin(angle)
    rows = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }
    return sympy.Matrix(rows[axis])


@PLANE("rotation from world to robot coordinates, Siegwart (3.2)")
def rotation_world_to_robot(page: Page) -> None:
    page.write_matrix("m []", world_to_robot_rows(*page.read(HEADING)))


@PLANE("rotation from robot to world coordinates, Siegwart (3.10), Tzafestas (2.17)")
def rotation_robot_to_world(page: Page) -> None:
    """R(theta)^-1 = R(theta)^T (Siegwart (3.10)), R(phi) of Tzafestas (2.17)."""
    page.write_matrix("m []", world_to_robot_rows(*page.read(HEADING)).T)


@PLANE("twist in the robot frame of a velocity in the world frame, Siegwart (3.5)")
def world_to_robot(page: Page) -> None:
    """xi_R = R(theta) xi_I."""
    (theta,) = page.read(HEADING)
    page.write(TWIST, *(world_to_robot_rows(theta) * sympy.Matrix(page.read(RATES))))


@PLANE("velocity in the world frame of a twist in the robot frame, Siegwart (3.10), Tzafestas (2.83)")
def robot_to_world(page: Page) -> None:
    """xi_I = R(theta)^-1 xi_R."""
    (theta,) = page.read(HEADING)
    page.write(RATES, *(world_to_robot_rows(theta).T * sympy.Matrix(page.read(TWIST))))


@PLANE("a vector of the plane turned counter-clockwise, Tzafestas (2.17)")
def rotate(page: Page) -> None:
    angle, x, y = page.read("angle [rad] counter-clockwise; x [m] before; y [m] before")
    turned = rotation_rows("z", angle)[:2, :2] * sympy.Matrix([x, y])
    page.write("x [m] after; y [m] after", *turned)


@PLANE("pose b, given in the frame of pose a, in the frame of a itself, Tzafestas (2.18)")
def pose_compose(page: Page) -> None:
    """a b in SE(2): pose b, given in the frame of pose a, in the frame in which a is given."""
    ax, ay, at = page.read("a.x [m] first pose; a.y [m] first pose; a.theta [rad] first pose")
    text = "second pose, in the frame of the first"
    bx, by, bt = page.read(f"b.x [m] {text}; b.y [m] {text}; b.theta [rad] {text}")
    c, s = sympy.cos(at), sympy.sin(at)
    page.write("x [m]; y [m]; theta [rad]", ax + c * bx - s * by, ay + s * bx + c * by, at + bt)


@PLANE("pose of the outer frame seen from the pose, Tzafestas (2.14) in the plane")
def pose_inverse(page: Page) -> None:
    """a^-1 in SE(2): [R^T, -R^T p; 0, 1]."""
    x, y, theta = page.read("a.x [m] pose; a.y [m] pose; a.theta [rad] pose")
    c, s = sympy.cos(theta), sympy.sin(theta)
    page.write("x [m]; y [m]; theta [rad]", -(c * x) - s * y, s * x - c * y, -theta)


def _rotation(axis: str, number: str) -> None:
    @SPACE(f"right-handed rotation about the {axis} axis, Tzafestas {number}", f"rotation_{axis}")
    def rotation(page: Page) -> None:
        page.write_matrix("m []", rotation_rows(axis, *page.read("angle [rad] right-handed")))


_rotation("x", "(2.15a)")
_rotation("y", "(2.15b), corrected")
_rotation("z", "(2.15c)")


@SPACE("a point of a frame in the outer frame, Tzafestas (2.13a)")
def transform_apply(page: Page) -> None:
    """x = p + R x_b."""
    r = page.matrix("r", 3, 3, "rotation of the frame")
    p, b = (sympy.Matrix(v) for v in page.vectors("p [m] origin of the frame; b [m] point in the frame"))
    text = "point in the outer frame"
    page.write(f"x [m] {text}; y [m] {text}; z [m] {text}", *(p + r * b))


@SPACE("transform a followed by b in the frame of a, Tzafestas (2.18)")
def transform_compose(page: Page) -> None:
    """The product of two homogeneous transforms."""
    ra, pa = page.matrix("a", 3, 3, "rotation of a"), sympy.Matrix(*page.vectors("pa [m] origin of a"))
    rb, pb = page.matrix("b", 3, 3, "rotation of b"), sympy.Matrix(*page.vectors("pb [m] origin of b"))
    page.write_matrix("r []", ra * rb)
    page.write_vector("p [m]", pa + ra * pb)


@SPACE("inverse of a homogeneous transform, Tzafestas (2.14)")
def transform_inverse(page: Page) -> None:
    """[R p; 0 1]^-1 = [R^T -R^T p; 0 1]."""
    r = page.matrix("r", 3, 3, "rotation")
    p = sympy.Matrix(*page.vectors("p [m] origin"))
    page.write_matrix("r []", r.T)
    page.write_vector("p [m]", -(r.T * p))
