"""Frames: planar rotations (Siegwart (3.2)-(3.5), Tzafestas (2.16), (2.17)), SE(2), and homogeneous transforms
of space (Tzafestas (2.9)-(2.15), (2.15b) with the corrected sign).

Siegwart's R(theta) takes world to robot coordinates, Tzafestas's R(phi) is its transpose.
"""

from __future__ import annotations

import sympy

from textbook.page import Page, Rows
from textbook.vectors import ONE, ZERO, apply, product, transposed
from wmrgen.kinematics.records import Formula
from wmrgen.symbolic import Expr

HEADING = "heading of the robot, counter-clockwise from world x"


def world_to_robot_rows(theta: Expr) -> Rows:
    """Siegwart (3.2): R(theta), 3 x 3, xi_R = R(theta) xi_I."""
    c, s = sympy.cos(theta), sympy.sin(theta)
    return (c, s, ZERO), (-s, c, ZERO), (ZERO, ZERO, ONE)


def rotation_rows(axis: str, angle: Expr) -> Rows:
    """Right-handed rotation about an axis: Tzafestas (2.15a), (2.15b) corrected, (2.15c)."""
    c, s = sympy.cos(angle), sympy.sin(angle)
    return {
        "x": ((ONE, ZERO, ZERO), (ZERO, c, -s), (ZERO, s, c)),
        "y": ((c, ZERO, s), (ZERO, ONE, ZERO), (-s, ZERO, c)),
        "z": ((c, -s, ZERO), (s, c, ZERO), (ZERO, ZERO, ONE)),
    }[axis]


def rotation_world_to_robot() -> Formula:
    """R(theta) of Siegwart (3.2), row by row."""
    page = Page("rotation_world_to_robot", "rotation from world to robot coordinates, Siegwart (3.2)")
    page.gives_matrix("m", world_to_robot_rows(page.given("theta", "rad", HEADING)))
    return page.formula()


def rotation_robot_to_world() -> Formula:
    """R(theta)^-1 = R(theta)^T (Siegwart (3.10)), R(phi) of Tzafestas (2.17), row by row."""
    page = Page(
        "rotation_robot_to_world",
        "rotation from robot to world coordinates, Siegwart (3.10), Tzafestas (2.17)",
    )
    page.gives_matrix("m", transposed(world_to_robot_rows(page.given("theta", "rad", HEADING))))
    return page.formula()


def world_to_robot() -> Formula:
    """Siegwart (3.3)-(3.5): xi_R = R(theta) xi_I."""
    page = Page("world_to_robot", "twist in the robot frame of a velocity in the world frame, Siegwart (3.5)")
    theta = page.given("theta", "rad", HEADING)
    rates = (
        page.given("x_rate", "m/s", "velocity in the world frame"),
        page.given("y_rate", "m/s", "velocity in the world frame"),
        page.given("theta_rate", "rad/s", "turning rate"),
    )
    vx, vy, omega = apply(world_to_robot_rows(theta), rates)
    page.gives("vx", "m/s", vx, "velocity of P forward, robot frame")
    page.gives("vy", "m/s", vy, "velocity of P to the left, robot frame")
    page.gives("omega", "rad/s", omega, "turning rate")
    return page.formula()


def robot_to_world() -> Formula:
    """xi_I = R(theta)^-1 xi_R (Siegwart (3.10), Tzafestas (2.83))."""
    page = Page(
        "robot_to_world",
        "velocity in the world frame of a twist in the robot frame, Siegwart (3.10), Tzafestas (2.83)",
    )
    theta = page.given("theta", "rad", HEADING)
    twist = (
        page.given("vx", "m/s", "velocity of P forward, robot frame"),
        page.given("vy", "m/s", "velocity of P to the left, robot frame"),
        page.given("omega", "rad/s", "turning rate"),
    )
    x, y, turn = apply(transposed(world_to_robot_rows(theta)), twist)
    page.gives("x_rate", "m/s", x, "velocity in the world frame")
    page.gives("y_rate", "m/s", y, "velocity in the world frame")
    page.gives("theta_rate", "rad/s", turn, "turning rate")
    return page.formula()


def rotate() -> Formula:
    """Tzafestas (2.17): a vector of the plane, turned by an angle."""
    page = Page("rotate", "a vector of the plane turned counter-clockwise, Tzafestas (2.17)")
    angle = page.given("angle", "rad", "counter-clockwise")
    x, y = page.given("x", "m", "before"), page.given("y", "m", "before")
    page.gives("x", "m", sympy.cos(angle) * x - sympy.sin(angle) * y, "after")
    page.gives("y", "m", sympy.sin(angle) * x + sympy.cos(angle) * y, "after")
    return page.formula()


def _pose(page: Page, name: str, text: str) -> tuple[Expr, Expr, Expr]:
    return (
        page.given(f"{name}.x", "m", text),
        page.given(f"{name}.y", "m", text),
        page.given(f"{name}.theta", "rad", text),
    )


def _gives_pose(page: Page, x: Expr, y: Expr, theta: Expr) -> None:
    page.gives("x", "m", x)
    page.gives("y", "m", y)
    page.gives("theta", "rad", theta)


def pose_compose() -> Formula:
    """a b in SE(2): pose b, given in the frame of pose a, in the frame in which a is given."""
    page = Page(
        "pose_compose", "pose b, given in the frame of pose a, in the frame of a itself, Tzafestas (2.12)"
    )
    ax, ay, at = _pose(page, "a", "first pose")
    bx, by, bt = _pose(page, "b", "second pose, in the frame of the first")
    c, s = sympy.cos(at), sympy.sin(at)
    _gives_pose(page, ax + c * bx - s * by, ay + s * bx + c * by, at + bt)
    return page.formula()


def pose_inverse() -> Formula:
    """a^-1 in SE(2): [R^T, -R^T p; 0, 1] (Tzafestas (2.14) in the plane)."""
    page = Page("pose_inverse", "pose of the outer frame seen from the pose, Tzafestas (2.14) in the plane")
    x, y, theta = _pose(page, "a", "pose")
    c, s = sympy.cos(theta), sympy.sin(theta)
    _gives_pose(page, -(c * x) - s * y, s * x - c * y, -theta)
    return page.formula()


def rotation_about(axis: str) -> Formula:
    """R_x, R_y or R_z, row by row (Tzafestas (2.15), R_y corrected)."""
    number = {"x": "(2.15a)", "y": "(2.15b), corrected", "z": "(2.15c)"}[axis]
    page = Page(f"rotation_{axis}", f"right-handed rotation about the {axis} axis, Tzafestas {number}")
    page.gives_matrix("m", rotation_rows(axis, page.given("angle", "rad", "right-handed")))
    return page.formula()


def transform_apply() -> Formula:
    """Tzafestas (2.9)-(2.11): x = p + R x_b."""
    page = Page("transform_apply", "a point of a frame in the outer frame, Tzafestas (2.11)")
    r = page.matrix("r", 3, 3, "", "rotation of the frame")
    p = page.vector("p", "m", "origin of the frame")
    b = page.vector("b", "m", "point in the frame")
    moved = apply(r, b)
    for axis, origin, entry in zip("xyz", p, moved, strict=True):
        page.gives(axis, "m", origin + entry, "point in the outer frame")
    return page.formula()


def transform_compose() -> Formula:
    """Tzafestas (2.12): the product of two homogeneous transforms."""
    page = Page("transform_compose", "transform a followed by b in the frame of a, Tzafestas (2.12)")
    ra, pa = page.matrix("a", 3, 3, "", "rotation of a"), page.vector("pa", "m", "origin of a")
    rb, pb = page.matrix("b", 3, 3, "", "rotation of b"), page.vector("pb", "m", "origin of b")
    page.gives_matrix("r", product(ra, rb))
    page.gives_vector("p", "m", [x + y for x, y in zip(pa, apply(ra, pb), strict=True)])
    return page.formula()


def transform_inverse() -> Formula:
    """Tzafestas (2.14): [R p; 0 1]^-1 = [R^T -R^T p; 0 1]."""
    page = Page("transform_inverse", "inverse of a homogeneous transform, Tzafestas (2.14)")
    r = page.matrix("r", 3, 3, "", "rotation")
    p = page.vector("p", "m", "origin")
    back = transposed(r)
    page.gives_matrix("r", back)
    page.gives_vector("p", "m", [-entry for entry in apply(back, p)])
    return page.formula()
