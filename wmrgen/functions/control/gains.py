"""Stability of the gains of the polar feedback law, decided exactly.

The linearised closed loop has the characteristic polynomial (s + k_rho)(s^2 + (k_alpha - k_rho) s - k_rho k_beta)
(Siegwart (3.60)-(3.64)). Comparisons with pi use rational bounds. They terminate because pi is irrational.
"""

from __future__ import annotations

import cmath
from fractions import Fraction
from typing import NamedTuple

import mpmath

from wmrgen.geometry.exact.evaluate import to_fraction
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.records import Robot

# 1/s: the example of Siegwart (3.59).
TEXTBOOK = {"k_rho": Exact(3), "k_alpha": Exact(8), "k_beta": Exact(Fraction(-3, 2))}
_STRONG = "k_alpha + 5/3 k_beta - 2/pi k_rho > 0"
_ALL_BETA = "k_alpha + 2 k_beta - 2/pi k_rho > 0"


class Verdict(NamedTuple):
    """What a set of gains achieves."""

    stable: bool  # the loop is locally stable
    # Siegwart (3.65), and the signs of k_rho and k_beta: if also stable, |alpha| stays within 90 deg
    # from |beta| <= 5 pi / 6
    strong: bool
    # stable, and (3.65) corrected: |alpha| stays within 90 deg from every beta in (-pi, pi)
    strong_all_beta: bool
    violated: tuple[str, ...]  # conditions of local stability that fail, as text
    eigenvalues: tuple[complex, complex, complex]  # 1/s, of the linearisation

    @property
    def lost(self) -> tuple[str, ...]:
        """Return the strong conditions that fail."""
        return tuple(
            text for text, holds in ((_STRONG, self.strong), (_ALL_BETA, self.strong_all_beta)) if not holds
        )


def judge(k_rho: Exact, k_alpha: Exact, k_beta: Exact) -> Verdict:
    """Return local stability (Siegwart (3.61)-(3.64)) and the strong conditions (Siegwart (3.65), corrected).

    Args:
        k_rho: Gain of the distance [1/s].
        k_alpha: Gain of the bearing of the goal [1/s].
        k_beta: Gain of the final heading [1/s].

    Returns:
        The conditions that hold or fail, and the eigenvalues.
    """
    conditions = {
        "k_rho > 0": k_rho.sign > 0,
        "k_beta < 0": k_beta.sign < 0,
        "k_alpha - k_rho > 0": (k_alpha - k_rho).sign > 0,
    }
    signs = conditions["k_rho > 0"] and conditions["k_beta < 0"]
    stable = all(conditions.values())
    return Verdict(
        stable,
        signs and exceeds(k_alpha + k_beta * Fraction(5, 3), k_rho),
        stable and exceeds(k_alpha + k_beta * 2, k_rho),
        tuple(text for text, holds in conditions.items() if not holds),
        _eigenvalues(float(k_rho), float(k_alpha), float(k_beta)),
    )


def exceeds(a: Exact, k: Exact) -> bool:
    """Return whether a > (2/pi) k, exactly."""
    if not (a or k):
        return False
    digits = 60
    while True:
        low, high = _pi_bounds(digits)
        signs = {(a * bound - k * 2).sign for bound in (low, high)}
        if len(signs) == 1 and 0 not in signs:
            return signs == {1}
        digits *= 2


def _pi_bounds(digits: int) -> tuple[Fraction, Fraction]:
    """Return fractions below and above pi, 2 * 10**-digits apart."""
    with mpmath.workdps(digits + 5):
        middle = to_fraction(+mpmath.pi)
    width = Fraction(1, 10**digits)
    return middle - width, middle + width


def _eigenvalues(k_rho: float, k_alpha: float, k_beta: float) -> tuple[complex, complex, complex]:
    """Return -k_rho and the roots of s^2 + 2 m s - k_rho k_beta: the larger root, and the product over it."""
    middle = (k_alpha - k_rho) / 2
    root = cmath.sqrt(middle * middle + k_rho * k_beta)
    large = -middle - root if middle > 0 else -middle + root
    small = -k_rho * k_beta / large if large and not root.imag else -2 * middle - large
    pair = (small, large) if middle > 0 else (large, small)
    return complex(0.0 - k_rho), pair[0], pair[1]


def linearisation(k_rho: Exact, k_alpha: Exact, k_beta: Exact) -> list[list[Exact]]:
    """Return A of d/dt (rho, alpha, beta) = A (rho, alpha, beta) at the goal: Siegwart (3.60), (3.61).

    Args:
        k_rho: Gain of the distance [1/s].
        k_alpha: Gain of the bearing of the goal [1/s].
        k_beta: Gain of the final heading [1/s].

    Returns:
        The 3 x 3 matrix A, row by row.
    """
    zero = Exact(0)
    return [[-k_rho, zero, zero], [zero, k_rho - k_alpha, -k_beta], [zero, -k_rho, zero]]


def polynomial(k_rho: Exact, k_alpha: Exact, k_beta: Exact) -> list[Exact]:
    """Return the characteristic polynomial det(s I - A): Siegwart (3.62).

    Args:
        k_rho: Gain of the distance [1/s].
        k_alpha: Gain of the bearing of the goal [1/s].
        k_beta: Gain of the final heading [1/s].

    Returns:
        Four coefficients, the highest power first.
    """
    return [Exact(1), k_alpha, k_rho * (k_alpha - k_rho - k_beta), -(k_rho * k_rho * k_beta)]


def nominal_gains(robot: Robot) -> dict[str, Exact]:
    """Return the gains of the robot file, or the gains of the textbook that the file does not give."""
    return {
        name: robot.gains[name].nominal if name in robot.gains else value for name, value in TEXTBOOK.items()
    }


def warnings(robot: Robot, asked: bool) -> tuple[str, ...]:
    """Return warnings about the gains of a robot file; none if the file has no gains.

    If goto_pose is ``asked`` for, gains that do not stabilise it are an error there and no warning here.
    """
    if not robot.gains.keys() & TEXTBOOK.keys():
        return ()
    gains = nominal_gains(robot)
    verdict = judge(**gains)
    if not verdict.stable:
        what = f"gains {shown(gains)} do not stabilise goto_pose: {_failing(verdict.violated)}"
        return () if asked else (what,)
    if verdict.lost:
        return (
            f"gains {shown(gains)} stabilise goto_pose near the goal, but {_failing(verdict.lost)}: "
            "from some poses the robot turns its back to the goal before it arrives",
        )
    return ()


def _failing(conditions: tuple[str, ...]) -> str:
    """Return the clause that conditions fail."""
    return f"{' and '.join(conditions)} fail{'s' * (len(conditions) == 1)}"


def shown(gains: dict[str, Exact]) -> str:
    """Return gains as text: ``k_rho = 3, k_alpha = 8, k_beta = -1.5``."""
    return ", ".join(f"{name} = {float(value):g}" for name, value in gains.items())
