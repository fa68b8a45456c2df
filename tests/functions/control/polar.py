"""The polar feedback law in symbols: coordinates, closed loop, linearisation (Siegwart 3.6.2).

The goal is the origin, reached with heading 0. rho: distance; alpha: direction of the goal against the heading;
beta = -theta - alpha. Everything is derived from the unicycle by the chain rule; nothing is typed in.
"""

from __future__ import annotations

from functools import cache

import sympy

from wmrgen.geometry.symbolic import Expr, signal

RHO, ALPHA, BETA = (signal(n) for n in ("rho", "alpha", "beta"))
V, OMEGA = signal("v"), signal("omega")
K_RHO, K_ALPHA, K_BETA = (signal(n) for n in ("k_rho", "k_alpha", "k_beta"))
STATE = (RHO, ALPHA, BETA)


def pose() -> tuple[Expr, Expr, Expr]:
    """(x, y, theta) of the polar coordinates: Siegwart (3.50)-(3.52) solved."""
    return -RHO * sympy.cos(BETA), RHO * sympy.sin(BETA), -ALPHA - BETA


@cache
def rates(reverse: bool = False) -> tuple[Expr, Expr, Expr]:
    """Rates of (rho, alpha, beta) driving at V and OMEGA: Siegwart (3.53); reversed (3.55), corrected.

    ``reverse``: V is the speed backwards; the turning rate keeps its sign.
    """
    x, y, theta = pose()
    jacobian = sympy.Matrix([x, y, theta]).jacobian(sympy.Matrix(STATE))
    v = -V if reverse else V
    field = sympy.Matrix([v * sympy.cos(theta), v * sympy.sin(theta), OMEGA])
    a, b, c = (sympy.trigsimp(sympy.expand_trig(e)) for e in jacobian.LUsolve(field))
    return sympy.simplify(a), sympy.simplify(b), sympy.simplify(c)


def law() -> tuple[Expr, Expr]:
    """(v, omega): Siegwart (3.56), (3.57)."""
    return K_RHO * RHO, K_ALPHA * ALPHA + K_BETA * BETA


@cache
def closed_loop() -> tuple[Expr, Expr, Expr]:
    """Rates of (rho, alpha, beta) under the law: Siegwart (3.58); no quotient by rho is left."""
    v, omega = law()
    a, b, c = (sympy.expand(sympy.simplify(e.subs({V: v, OMEGA: omega}))) for e in rates())
    return a, b, c


@cache
def linearisation() -> sympy.ImmutableMatrix:
    """A of d/dt (rho, alpha, beta) = A (rho, alpha, beta) at the goal: Siegwart (3.60), (3.61)."""
    at = dict.fromkeys(STATE, 0)
    return sympy.ImmutableMatrix(sympy.Matrix(closed_loop()).jacobian(sympy.Matrix(STATE)).subs(at))


def characteristic_polynomial(variable: Expr) -> Expr:
    """det(variable I - A), factored: Siegwart (3.62)."""
    return sympy.factor((variable * sympy.eye(3) - linearisation()).det())
