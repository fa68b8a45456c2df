"""Polynomials of least worst error with float32 coefficients (Remez 1934), the coefficients rounded one at a time.

Degrees are the smallest whose approximation error is under `ENOUGH`, a quarter of what rounding a result near 1 adds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
import numpy as np
from mpmath import mp

from wmrgen.codegen.c.text import literal
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.rounding import nearest_float32

DIGITS, GRID = 40, 2000
ENOUGH = 2.0**-26
Function = Callable[[Any], Any]


@dataclass(frozen=True)
class Kernel:
    """``function``(x) is approximated by the sum of c x**p over ``powers`` on (0, ``end``], by absolute error."""

    name: str
    function: Function
    powers: tuple[int, ...]
    end: Function


KERNELS = (
    Kernel("SIN", lambda x: mp.sin(x) - x, (3, 5, 7, 9), lambda: mp.pi / 2 * mp.mpf("1.0001")),
    Kernel("COS", lambda x: mp.cos(x) - 1, (2, 4, 6, 8, 10), lambda: mp.pi / 2 * mp.mpf("1.0001")),
    Kernel("ATAN", lambda x: mp.atan(x) - x, (3, 5, 7, 9, 11, 13, 15, 17), lambda: mp.mpf(1)),
)


@dataclass(frozen=True)
class Grid:
    """Where errors are looked at: ``x``, and the function there, in double; the points themselves to 40 digits."""

    exact: tuple[Any, ...]
    x: Any
    wanted: Any


@cache
def _grid(kernel: Kernel) -> Grid:
    start, end = mp.mpf("1e-6"), kernel.end()
    exact = tuple(start + (end - start) * mp.mpf(i) / GRID for i in range(GRID + 1))
    wanted = np.array([float(kernel.function(x)) for x in exact])
    return Grid(exact, np.array([float(x) for x in exact]), wanted)


def minimax(kernel: Kernel, fixed: Sequence[Any], powers: Sequence[int]) -> list[Any]:
    """Return the best coefficients of ``powers``, given the first ones, which are ``fixed``."""
    grid, n = _grid(kernel), len(powers)
    fixed_powers = kernel.powers[: len(fixed)]
    places = [round(GRID * (1 - math.cos(math.pi * (2 * i + 1) / (2 * n + 2))) / 2) for i in range(n + 1)]
    best: list[Any] = []
    for _ in range(40):
        a, b = mp.matrix(n + 1, n + 1), mp.matrix(n + 1, 1)
        for i, place in enumerate(places):
            x = grid.exact[place]
            for j, p in enumerate(powers):
                a[i, j] = x**p
            a[i, n] = (-1) ** i
            b[i] = kernel.function(x) - sum(c * x**p for c, p in zip(fixed, fixed_powers, strict=True))
        solved = mp.lu_solve(a, b)
        best = [solved[j] for j in range(n)]
        errors = _errors(grid, [*fixed, *best], [*fixed_powers, *powers])
        chosen = _alternating(errors, n + 1)
        if len(chosen) < n + 1 or max(map(abs, errors)) - float(abs(solved[n])) < 1e-6 * max(
            map(abs, errors)
        ):
            break
        places = chosen
    return best


def _errors(grid: Grid, coefficients: Sequence[Any], powers: Sequence[int]) -> list[float]:
    """Return the errors of the polynomial on the grid. Its powers increase by two."""
    square, total = grid.x * grid.x, np.zeros_like(grid.x)
    for c in reversed(coefficients):
        total = total * square + float(c)
    first = grid.x if powers[0] % 2 else np.ones_like(grid.x)
    for _ in range(powers[0] // 2):
        first = first * square
    return list(grid.wanted - total * first)


def _alternating(errors: Sequence[float], count: int) -> list[int]:
    """Places of extremes whose signs alternate, the largest of each run; ``count`` of them where there are more."""
    chosen: list[int] = []
    for i, error in enumerate(errors):
        before = abs(errors[i - 1]) if i else 0.0
        after = abs(errors[i + 1]) if i + 1 < len(errors) else 0.0
        if abs(error) < before or abs(error) < after:
            continue
        if chosen and (errors[chosen[-1]] > 0) == (error > 0):
            if abs(error) > abs(errors[chosen[-1]]):
                chosen[-1] = i
        else:
            chosen.append(i)
    while len(chosen) > count:
        chosen.pop(0 if abs(errors[chosen[0]]) < abs(errors[chosen[-1]]) else -1)
    return chosen


@cache
def coefficients(kernel: Kernel) -> tuple[tuple[str, ...], float]:
    """The float32 coefficients as the decimals of ir/kernels/trigonometry.py, and their worst approximation error."""
    with mpmath.workdps(DIGITS):
        fixed: list[Any] = []
        while len(fixed) < len(kernel.powers):
            best = minimax(kernel, fixed, kernel.powers[len(fixed) :])
            fixed.append(mp.mpf(nearest_float32(float(best[0]))))
        worst = max(map(abs, _errors(_grid(kernel), fixed, kernel.powers)))
    return tuple(_decimal(float(c)) for c in fixed), worst


@cache
def shorter(kernel: Kernel) -> float:
    """Return the worst error of the best polynomial with one coefficient less, not rounded."""
    with mpmath.workdps(DIGITS):
        powers = kernel.powers[:-1]
        return max(map(abs, _errors(_grid(kernel), minimax(kernel, (), powers), powers)))


def _decimal(value: float) -> str:
    return literal(Exact(Fraction(value)), "float").strip("()").removesuffix("f")


# Of the integer kernels, and the bits of their coefficients.
INTEGER = (
    (Kernel("SINE", lambda x: mp.sin(mp.pi / 2 * x), (1, 3, 5, 7, 9), lambda: mp.mpf(1)), 31),
    (Kernel("ATAN", mp.atan, (1, 3, 5, 7, 9, 11, 13, 15, 17), lambda: mp.mpf(1)), 32),
)


@cache
def whole_coefficients(kernel: Kernel, bits: int) -> tuple[int, ...]:
    """The coefficients in units of 2**-``bits``, signs aside: they alternate."""
    with mpmath.workdps(DIGITS):
        return tuple(int(mp.nint(abs(c) * 2**bits)) for c in minimax(kernel, (), kernel.powers))
