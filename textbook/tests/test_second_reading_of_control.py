"""A second reading of what the texts say of control: polar coordinates, gains, a tricycle that is sent somewhere."""

from __future__ import annotations

from math import atan2, cos, hypot, pi, sin

import numpy as np
import pytest
import sympy

from textbook.errata.forms import Form
from textbook.tests.reading import copied, forms, slope, value

SMALL = 1e-6


@pytest.mark.parametrize("reverse", [False, True])
def test_polar_rates(reverse: bool) -> None:
    """rho, alpha, beta measured on a robot that drives a little: forwards by (3.53), backwards by (3.55)."""
    v, omega = 0.7, -1.1
    x, speed = (1.2, -v) if reverse else (-1.2, v)  # the goal lies behind or ahead
    y, theta = 0.6, 0.4

    def polar(t: float) -> list[float]:
        heading = theta + omega * t
        px, py = x + speed * cos(theta) * t, y + speed * sin(theta) * t
        angle = atan2(-py, -px)
        return [hypot(px, py), (angle - heading + pi) % (2 * pi) - pi, -angle]

    rates, (rho, alpha, _) = slope(polar), polar(0.0)
    assert (abs(alpha) > pi / 2) == reverse
    at = {"rho": rho, "alpha": alpha, "v": v, "omega": omega}
    if reverse:
        copy, corrected = forms("Siegwart", "(3.55)")
        products = [value(f.values[1], **at) @ value(f.values[2], **at) for f in (copy, corrected)]
        assert np.allclose(products[1].ravel(), rates, atol=SMALL)
        assert abs(products[0].ravel() - rates)[1] == pytest.approx(2 * abs(omega))
    else:
        forward = copied("Siegwart", "(3.50)–(3.53)")
        assert np.allclose(value(forward.rights[0], **at).ravel(), rates, atol=SMALL)


def leaves(gains: tuple[float, float, float], alpha: float, beta: float) -> bool:
    """Does alpha leave (-pi/2, pi/2) along rho' = ..., alpha' = k_rho sin alpha - k_alpha alpha - k_beta beta?"""
    k_rho, k_alpha, k_beta = gains
    for _ in range(4000):  # Heun
        a = k_rho * sin(alpha) - k_alpha * alpha - k_beta * beta, -k_rho * sin(alpha)
        p, q = alpha + 1e-3 * a[0], beta + 1e-3 * a[1]
        b = k_rho * sin(p) - k_alpha * p - k_beta * q, -k_rho * sin(p)
        alpha, beta = alpha + 5e-4 * (a[0] + b[0]), beta + 5e-4 * (a[1] + b[1])
        if abs(alpha) > pi / 2:
            return True
    return False


def test_strong_stability() -> None:
    """Gains just inside the condition of the copy let alpha leave; just inside the corrected one it stays."""
    copy, corrected = forms("Siegwart", "(3.65)")
    k_rho, k_beta = 0.5, -6.0
    names = {s.name: s for s in copy.values[0].free_symbols}

    def edge(f: Form) -> float:
        at = {names[r"k_\rho"]: k_rho, names[r"k_\beta"]: k_beta}
        return float(sympy.solve(f.values[0].subs(at), names[r"k_\alpha"])[0])

    starts = [(a, b) for a in (-1.57, -0.8, 0.0, 0.8, 1.57) for b in (-3.14, -1.5, 0.0, 1.5, 3.14)]
    assert any(leaves((k_rho, edge(copy) + 0.1, k_beta), *s) for s in starts)
    assert not any(leaves((k_rho, edge(corrected) + 0.1, k_beta), *s) for s in starts)
    assert not any(leaves((3.0, 8.0, -1.5), *s) for s in starts)  # (3.59)


@pytest.mark.parametrize("v", [1.0, -1.0, 0.3, -2.5])
@pytest.mark.parametrize("turn", [0.4, -0.7])
def test_the_tricycle_goes_where_it_is_sent(v: float, turn: float) -> None:
    """(2.47a) as the page has it and (2.47b) together: the front wheel draws the robot at v and turns it at phi'."""
    copy, general = forms("Tzafestas", "(2.47a)")
    rate = copied("Tzafestas", "(2.47b)")
    wheelbase, r = 1.4, 0.2
    at = {"D": wheelbase, "r": r, "v": v, "dotphi": turn}
    rim = r * value(rate.rights[0], **at)

    def driven(f: Form) -> tuple[float, float]:
        psi = value(f.rights[0], **at)
        return rim * cos(psi), rim * sin(psi) / wheelbase

    assert np.allclose(driven(general), (v, turn))
    assert np.allclose(driven(copy), (v, turn)) == (v > 0)
