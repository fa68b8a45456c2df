"""Scalar relations of cars: turning radius, pursuit steering, reduction to the unicycle and its bounds."""

from __future__ import annotations

import sympy

from textbook.page import Chapter, Page
from wmrgen.analysis.kinematics.contacts import TINY
from wmrgen.geometry.symbolic import absolute, angle_of, maximum, minimum, root, select

CARS = Chapter("Cars")
cos, sin = sympy.cos, sympy.sin


@CARS("turning radius of a car or tricycle, Tzafestas (2.48)")
def turning_radius(page: Page) -> None:
    """R = D tan(pi/2 - psi) = D cot psi; the curvature is defined for psi = 0 as well."""
    D, psi = page.read("wheelbase [m] rear axle to front wheel, D; psi [rad] steering angle")
    page.write("radius [m] 0 where the car drives straight", page.quotient("r", D * cos(psi), sin(psi)))
    page.write("curvature [1/m] counter-clockwise", page.quotient("k", sin(psi), D * cos(psi)))


@CARS("steering towards a goal on an arc, Tzafestas (2.57a-c)")
def pursuit(page: Page) -> None:
    """Steer so that the arc tangent to the heading meets the goal.

    The goal is at distance L in direction epsilon: L = 2 R sin epsilon, psi = atan(2 D sin epsilon / L),
    1/R = 2 d / L^2 with the goal's lateral offset d = L sin epsilon; the arc is L epsilon / sin epsilon long.
    """
    D, L, epsilon = page.read(
        "wheelbase [m] rear axle to front wheel, D; distance [m] to the goal, L > 0; "
        "epsilon [rad] direction of the goal against the heading"
    )
    s = page.let("s", sin(epsilon))
    page.write("psi [rad] steering angle", angle_of(2 * D * s, L))
    page.write("curvature [1/m] of the arc", page.quotient("k", 2 * s, L))
    page.write("offset [m] lateral offset d of the goal", L * s)
    page.write("gain [1/m^2] curvature by offset, 2/L^2", page.quotient("g", sympy.Integer(2), L * L))
    stretch = page.let("stretch", page.quotient("ratio", epsilon, s))
    straight = page.let("straight", absolute(s))
    page.write(
        "arc [m] length of the arc", L * page.let("longer", select(TINY, straight, stretch, sympy.S.One))
    )


@CARS("unicycle inputs of a front-driven car, AA274")
def car_reduction(page: Page) -> None:
    """v = u1 cos xi, omega = u1 sin xi / L makes the tricycle a unicycle (printed with L = 1)."""
    u1, xi, L = page.read(
        "u1 [m/s] speed of the front wheel; xi [rad] steering angle; "
        "wheelbase [m] rear axle to front wheel, L"
    )
    along, across = page.vector_at("velocity", u1, xi)
    page.write("v [m/s]", along)
    page.write("omega [rad/s]", page.quotient("turn", across, L))


@CARS("bounds of speed and turning rate of a car, AA274")
def car_bounds(page: Page) -> None:
    """Inner bounds of the unicycle inputs of a car, and the exact set.

    Inner: |v| <= u1_max cos(zeta_max), |omega| <= |v| tan(zeta_max)/L. Exact: v^2 + (omega L)^2 <= u1_max^2 and
    |omega| <= |v| tan(zeta_max)/L. Reeds-Shepp takes |v| = v_max, Dubins v = v_max.
    """
    top, zeta, v, L = page.read(
        "u1_max [m/s] largest speed of the front wheel; zeta_max [rad] largest steering angle; "
        "v [m/s] speed at which omega is bounded; wheelbase [m] rear axle to front wheel, L"
    )
    slope = page.quotient("slope", sin(zeta), page.let("slope_cos", cos(zeta)))
    fastest = page.let("fastest", top * cos(zeta))
    turn = page.let("turn", page.quotient("turn_inner", absolute(v) * slope, L))
    rest = page.let("rest", root(maximum(top**2 - v**2, sympy.S.Zero)))
    outer = page.quotient("turn_outer", rest, L)
    page.write("v_max [m/s] inner bound of |v|", fastest)
    page.write("omega_max [rad/s] inner bound of |omega| at v", turn)
    page.write("omega_max_exact [rad/s] exact bound of |omega| at v", minimum(turn, outer))
    page.write("reeds_shepp [m/s] |v| of Reeds-Shepp", fastest)
    page.write("dubins [m/s] v of Dubins", fastest)
