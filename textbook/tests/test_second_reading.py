"""A second computation of what fails in the texts: the forms that the page shows are put into small simulations and
finite differences written here, which share nothing with the checks of the page but the forms.

Each form of a copy must fail, each corrected form hold, and corrections must agree with one another and with what the
page says holds.
"""

from __future__ import annotations

from math import asin, cos, hypot, isclose, pi, sin, sqrt

import numpy as np
import pytest

from textbook.errata.records import Class
from textbook.errata.texts import ENTRIES
from textbook.tests.common import integrate
from textbook.tests.reading import copied, forms, slope, value

FAILS = [r for r in ENTRIES if r.kind in (Class.ERROR, Class.OPEN)]
SMALL = 1e-6


def test_everything_that_fails_is_computed_again() -> None:
    here = {
        ("Tzafestas", "(2.15b)"), ("Tzafestas", "Example 2.2, slip with ζ ≠ 0"), ("Tzafestas", "(2.81)"),
        ("Konstantinov", "(2)"), ("Konstantinov", "R"),
        ("Siegwart", "3.2.2, “diameter r”"), ("Siegwart", "(3.20)"), ("Siegwart", "(3.55)"), ("Siegwart", "(3.65)"),
    }  # fmt: skip
    assert {(r.text, r.equation) for r in FAILS} == here


def test_rotation_about_y_takes_z_to_x() -> None:
    """As R_x takes y to z and R_z takes x to y: a quarter turn, right-handed."""
    copy, corrected = forms("Tzafestas", "(2.15b)")
    z, x = np.array([0, 0, 1]), np.array([1, 0, 0])
    assert np.allclose(value(corrected.rights[0], phi=pi / 2) @ z, x)
    assert np.allclose(value(copy.rights[0], phi=pi / 2) @ z, -x)
    cycle = copied("Tzafestas", "(2.15a)"), corrected, copied("Tzafestas", "(2.15c)")
    turns = [value(f.rights[0], phi=0.4) for f in cycle]
    cyclic = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])  # x to y, y to z, z to x
    assert np.allclose(cyclic @ turns[0] @ cyclic.T, turns[1])
    assert np.allclose(cyclic @ turns[1] @ cyclic.T, turns[2])


@pytest.mark.parametrize("zeta", [-1.1, 0.0, 0.4, 2.0])
def test_slip_of_a_turned_wheel(zeta: float) -> None:
    copy, corrected = forms("Tzafestas", "Example 2.2, slip with ζ ≠ 0")
    r, spin, w, z = 0.3, 4.0, 0.25, -0.6
    velocity = (r * spin - w + 1j * z) * complex(cos(zeta), sin(zeta))  # along the wheel + i across, turned
    at = {"r": r, "dottheta": spin, "w": w, "z": z, "zeta": zeta}
    assert np.allclose([value(e, **at) for e in corrected.rights], [velocity.real, velocity.imag])
    same = np.allclose([value(e, **at) for e in copy.rights], [velocity.real, velocity.imag])
    assert same == (zeta == 0)


HEADINGS, LENGTHS = (0.2, 0.5, -0.3, 0.9), (0.8, 1.3, 0.6)
TRAILERS = {f"phi_{k}": v for k, v in enumerate(HEADINGS)} | {f"L_{k}": v for k, v in enumerate(LENGTHS, 1)}


def trailer_angles(v1: float, h: float) -> list[float]:
    """Three trailers after the tractor has gone h v1 along its heading: each axle is drawn straight to its hitch."""
    axles = [0j]
    for angle, length in zip(HEADINGS[1:], LENGTHS, strict=True):
        axles.append(axles[-1] - length * complex(cos(angle), sin(angle)))
    axles[0] += h * v1 * complex(cos(HEADINGS[0]), sin(HEADINGS[0]))
    angles = []
    for i, length in enumerate(LENGTHS, 1):
        ahead = complex(cos(HEADINGS[i]), sin(HEADINGS[i]))
        rod = (axles[i - 1] - axles[i]) * ahead.conjugate()  # along and across the trailer
        # the axle moves along its own heading until the rod has its length again
        axles[i] += (rod.real - sqrt(length**2 - rod.imag**2)) * ahead
        angles.append(HEADINGS[i] + asin(rod.imag / length))
    return angles


@pytest.mark.parametrize("v1", [1.7, -0.4, 0.0, 1.0])
def test_trailers_are_drawn(v1: float) -> None:
    copy, corrected = forms("Tzafestas", "(2.70)")
    rates = slope(lambda h: trailer_angles(v1, h))
    at = {"v_1": v1, **TRAILERS}
    assert np.allclose([value(e, **at) for e in corrected.rights], rates, atol=SMALL)
    assert np.allclose([value(e, **at) for e in copy.rights], rates, atol=SMALL) == (v1 == 1)


def test_trailers_keep_the_constraint_that_was_mended() -> None:
    """(2.70) and the constraint of 2.3.6, both corrected, agree; the constraint of the copy contradicts (2.70)."""
    copy, corrected = forms("Tzafestas", "2.3.6, constraint of trailer i")
    _, rates = forms("Tzafestas", "(2.70)")
    at = {"v_1": 1.7, **TRAILERS}
    at |= {f"dotphi_{i}": value(e, **at) for i, e in enumerate(rates.rights, 1)}
    at |= {"dotx_Q": 1.7 * cos(0.2), "doty_Q": 1.7 * sin(0.2)}
    assert abs(value(corrected.values[0], **at)) < SMALL < 0.01 < abs(value(copy.values[0], **at))


def test_four_omni_wheels_in_the_world() -> None:
    """The rim speed is that of the hub along the tangent, by finite differences of the hub's place."""
    copy, corrected = forms("Tzafestas", "(2.75c, d)")
    phi, far, r, rates = 0.7, 0.35, 0.05, (0.4, -0.9, 1.3)
    places = [0.3, 1.9, -2.2, 0.0]

    def hubs(t: float) -> list[complex]:
        heading = phi + rates[2] * t
        start = complex(rates[0], rates[1]) * t
        return [start + far * complex(cos(heading + b), sin(heading + b)) for b in places]

    tangents = [1j * complex(cos(phi + b), sin(phi + b)) for b in places]
    truth = [(v * t.conjugate()).real / r for v, t in zip(slope(hubs), tangents, strict=True)]
    at = {"phi": phi, "r": r, "D": far} | {f"beta_{k}": b for k, b in enumerate(places, 1)}
    _, scale, left, right = corrected.values
    made = value(scale, **at) * np.hstack([value(left, **at), value(right, **at)])
    assert np.allclose(made @ rates, truth, atol=SMALL)
    assert copy.values[2].shape != copy.values[3].shape  # no sum


def test_mecanum_jacobians_agree_with_the_forward_solution() -> None:
    """Drive by (2.82): the corrected J_i give back every wheel's rate, those of the copy do not."""
    copy, corrected = forms("Tzafestas", "(2.81)")
    forward = copied("Tzafestas", "(2.82)")
    at = {"R": 0.1, "r": 0.02, "d_1": 0.3, "d_2": 0.5}
    spins = np.array([3.0, 1.0, 2.5, 1.5])  # compatible: 1 + 2 = 3 + 4
    twist = value(forward.rights[0], **at) @ spins
    back = [np.linalg.solve(value(j, **at), twist)[0] for j in corrected.rights]
    wrong = [np.linalg.solve(value(j, **at), twist)[0] for j in copy.rights]
    assert np.allclose(back, spins) and not np.allclose(wrong, spins, atol=0.1)


def test_mecanum_wheels_stand_where_the_correction_puts_them() -> None:
    """A wheel on the ground: its hub moves at R spin along y and r times the roller's rate along the roller."""
    _, corrected = forms("Tzafestas", "(2.81)")
    at = {"R": 0.1, "r": 0.02, "d_1": 0.3, "d_2": 0.5}
    places = [(0.3, 0.5), (-0.3, 0.5), (-0.3, -0.5), (0.3, -0.5)]
    for jacobian, (x, y) in zip(corrected.rights, places, strict=True):
        spin_only = np.linalg.solve(value(jacobian, **at), [0.0, 0.0, 1.0])  # turning in place at 1 rad/s
        hub = np.array([-y, x])
        moved = value(jacobian, **at)[:2, :2] @ spin_only[:2]
        assert np.allclose(moved, hub)


@pytest.mark.parametrize("angle", [0.0, 0.9, -2.5])
def test_hub_of_the_three_wheeled_robot(angle: float) -> None:
    copy, corrected = forms("Konstantinov", "(2)")
    a, rates = 0.3, (0.5, -0.2, 1.6)
    hub = slope(
        lambda t: [rates[0] * t + a * cos(angle + rates[2] * t), rates[1] * t + a * sin(angle + rates[2] * t)]
    )
    at = {"a": a, "dotx": rates[0], "doty": rates[1], "dotphi": rates[2], "phi_i": angle}
    assert np.allclose([value(e, **at) for e in corrected.rights], hub, atol=SMALL)
    assert not np.allclose([value(e, **at) for e in copy.rights], hub, atol=0.05)
    speed = copied("Konstantinov", "vᵢ²")  # the paper's own line agrees with the correction
    assert isclose(value(speed.rights[0], **at), hub @ hub, rel_tol=1e-6)


@pytest.mark.parametrize("spins", [(2.0, -1.0, 4.0), (-3.0, 1.0, 0.5), (1.0, 0.2, 0.1)])
def test_circle_of_the_three_wheeled_robot(spins: tuple[float, float, float]) -> None:
    """Drive by (5): the radius of the circle through three points of the path is R."""
    copy, corrected = forms("Konstantinov", "R")
    a, r = 0.3, 0.05

    def drive(pose: np.ndarray) -> np.ndarray:
        turns = pose[2] + 2 * pi / 3 * np.arange(3)
        return r / 3 * np.array([2 * np.sin(turns) @ spins, -2 * np.cos(turns) @ spins, -sum(spins) / a])

    p, q, s = (complex(*integrate(drive, (0, 0, 0), t, 400)[:2]) for t in (0, 2, 4))
    radius = abs(p - q) * abs(q - s) * abs(s - p) / (2 * abs(((q - p) * (s - p).conjugate()).imag))
    # Omega_1, by v = 2 r Omega_1 / 3, from the speed that was driven
    at = {
        "a": a,
        "left|Omegaright|": abs(sum(spins)),
        "Omega_1": 3 * hypot(*drive(np.zeros(3))[:2]) / (2 * r),
    }
    assert isclose(value(corrected.rights[0], **at), radius, rel_tol=1e-4)
    assert isclose(value(copy.rights[0], **at), radius / 2, rel_tol=1e-4)


def test_rim_of_a_wheel() -> None:
    """One turn rolls off the circumference, pi times the diameter; (3.7) of the text agrees with the radius."""
    copy, corrected = forms("Siegwart", "3.2.2, “diameter r”")
    diameter, per_second = 0.2, 3.0
    rolled = per_second * pi * diameter
    at = {"dotvarphi": per_second * 2 * pi}
    assert isclose(value(corrected.rights[0], r=diameter / 2, **at), rolled)
    assert isclose(value(copy.rights[0], r=diameter, **at), rolled)  # only as a formula in the diameter
    turn, *_ = copied("Siegwart", "(3.7)–(3.9)").rights
    rate = value(turn, r=diameter / 2, l=0.25, dotvarphi_1=per_second * 2 * pi)
    assert isclose(rate, rolled / 0.5)  # about the other wheel, which stands still at distance 2 l


@pytest.mark.parametrize(("spin", "roller"), [(2.0, 0.0), (0.0, 5.0), (2.0, -3.0)])
def test_swedish_wheel(spin: float, roller: float) -> None:
    """The hub moves at r spin along the wheel and r_sw times the roller's rate across the roller's axis; (3.19) and
    (3.20) are the two parts of it."""
    copy, corrected = forms("Siegwart", "(3.20)")
    alpha, beta, gamma, far, r, small, omega = 0.8, 0.3, 0.7, 0.4, 0.1, 0.02, 0.9
    wheel = complex(cos(alpha + beta - pi / 2), sin(alpha + beta - pi / 2))
    axis = wheel * complex(cos(gamma), sin(gamma))
    hub = r * spin * wheel + small * roller * 1j * axis
    pivot = far * complex(cos(alpha), sin(alpha))
    body = hub - 1j * omega * pivot
    at = {"alpha": alpha, "beta": beta, "gamma": gamma, "l": far, "r": r, "r_sw": small, "dotvarphi": spin,
          "dotvarphi_sw": roller, "v_x": body.real, "v_y": body.imag, "omega": omega}  # fmt: skip
    assert abs(value(corrected.values[0], **at)) < 1e-12
    assert (abs(value(copy.values[0], **at)) < 1e-12) == (spin == 0)
    row, scale = copied("Siegwart", "(3.19)").rights
    rolled = (value(row, **at) @ [body.real, body.imag, omega])[0]
    assert isclose(rolled, value(scale, **at) * spin, abs_tol=1e-12)
