"""Scalar relations of cars: turning radius, pursuit steering, reduction to the unicycle and its bounds."""

from __future__ import annotations

import sympy

from textbook.page import Page
from textbook.vectors import ONE, ZERO
from wmrgen.kinematics.records import Formula
from wmrgen.kinematics.rollers import TINY
from wmrgen.symbolic import absolute, angle_of, maximum, minimum, root, select

cos, sin = sympy.cos, sympy.sin


def turning_radius() -> Formula:
    """Tzafestas (2.48): R = D tan(pi/2 - psi) = D cot psi; the curvature is defined for psi = 0 as well."""
    page = Page("turning_radius", "turning radius of a car or tricycle, Tzafestas (2.48)")
    D = page.given("wheelbase", "m", "rear axle to front wheel, D")
    psi = page.given("psi", "rad", "steering angle")
    page.gives("radius", "m", page.quotient("r", D * cos(psi), sin(psi)), "0 where the car drives straight")
    page.gives("curvature", "1/m", page.quotient("k", sin(psi), D * cos(psi)), "counter-clockwise")
    return page.formula()


def pursuit() -> Formula:
    """Tzafestas (2.57a-c): steer so that the arc tangent to the heading meets the goal.

    The goal is at distance L in direction epsilon: L = 2 R sin epsilon, psi = atan(2 D sin epsilon / L),
    1/R = 2 d / L^2 with the goal's lateral offset d = L sin epsilon; the arc is L epsilon / sin epsilon long.
    """
    page = Page("pursuit", "steering towards a goal on an arc, Tzafestas (2.57a-c)")
    D = page.given("wheelbase", "m", "rear axle to front wheel, D")
    L = page.given("distance", "m", "to the goal, L > 0")
    epsilon = page.given("epsilon", "rad", "direction of the goal against the heading")
    s = page.let("s", sin(epsilon))
    page.gives("psi", "rad", angle_of(2 * D * s, L), "steering angle")
    page.gives("curvature", "1/m", page.quotient("k", 2 * s, L), "of the arc")
    page.gives("offset", "m", L * s, "lateral offset d of the goal")
    page.gives("gain", "1/m^2", page.quotient("g", sympy.Integer(2), L * L), "curvature by offset, 2/L^2")
    stretch = page.let("stretch", page.quotient("ratio", epsilon, s))
    straight = page.let("straight", absolute(s))
    page.gives("arc", "m", L * page.let("longer", select(TINY, straight, stretch, ONE)), "length of the arc")
    return page.formula()


def car_reduction() -> Formula:
    """AA274: v = u1 cos xi, omega = u1 sin xi / L makes the tricycle a unicycle (printed with L = 1)."""
    page = Page("car_reduction", "unicycle inputs of a front-driven car, AA274")
    u1 = page.given("u1", "m/s", "speed of the front wheel")
    xi = page.given("xi", "rad", "steering angle")
    L = page.given("wheelbase", "m", "rear axle to front wheel, L")
    page.gives("v", "m/s", u1 * cos(xi))
    page.gives("omega", "rad/s", page.quotient("turn", u1 * sin(xi), L))
    return page.formula()


def car_bounds() -> Formula:
    """AA274: inner bounds of the unicycle inputs of a car, and the exact set beside them.

    Inner: |v| <= u1_max cos(zeta_max), |omega| <= |v| tan(zeta_max)/L. Exact: v^2 + (omega L)^2 <= u1_max^2 and
    |omega| <= |v| tan(zeta_max)/L. Reeds-Shepp takes |v| = v_max, Dubins v = v_max.
    """
    page = Page("car_bounds", "bounds of speed and turning rate of a car, AA274")
    top = page.given("u1_max", "m/s", "largest speed of the front wheel")
    zeta = page.given("zeta_max", "rad", "largest steering angle")
    v = page.given("v", "m/s", "speed at which omega is bounded")
    L = page.given("wheelbase", "m", "rear axle to front wheel, L")
    slope = page.tangent("slope", zeta)
    fastest = page.let("fastest", top * cos(zeta))
    turn = page.let("turn", page.quotient("turn_inner", absolute(v) * slope, L))
    rest = page.let("rest", root(maximum(top**2 - v**2, ZERO)))
    outer = page.quotient("turn_outer", rest, L)
    page.gives("v_max", "m/s", fastest, "inner bound of |v|")
    page.gives("omega_max", "rad/s", turn, "inner bound of |omega| at v")
    page.gives("omega_max_exact", "rad/s", minimum(turn, outer), "exact bound of |omega| at v")
    page.gives("reeds_shepp", "m/s", fastest, "|v| of Reeds-Shepp")
    page.gives("dubins", "m/s", fastest, "v of Dubins")
    return page.formula()
