"""Taylor series of a tractor with trailers along the path of its last axle.

The headings are theta_0 (tractor) .. theta_N (last). d_j = theta_(j-1) - theta_j, d_(N+1) = theta_N, and s = x of the
last axle. If the robot drives so that ds = 1, the states satisfy (Tzafestas (2.70), divided by the speed of the last
axle along x)

    y' = T_(N+1),    theta_j' = T_j w_j / L_j,    theta_0' = kappa w_0,
    T_j = tan d_j,   w_N = 1/cos theta_N,   w_(j-1) = w_j / cos d_j.

Derivatives of y with respect to s are then coefficients of a power series. Its recurrences share every intermediate
result, so N trailers cost about N**3 operations. Repeated differentiation doubles the cost with each order.

The order N + 3 grows like 1/cos to the power 2 N + 5. If the product of all cosines is below `threshold`, near the
edge of the domain, every 1/cos is replaced by 0: the derivatives are 0 and the tractor stands, also in float32.
"""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Locals
from wmrgen.functions.system import Gate
from wmrgen.geometry.symbolic import Expr, add, subtract, times

DIGITS = 24  # decimal digits; float32 allows 38, and the rest is for lengths and factorials
NARROW = sympy.Rational(1, 10**5)  # no unit: a smaller divisor of the steering is treated as zero

Series = list[Expr]


class Link(NamedTuple):
    """One angle of the train."""

    name: str
    cosine: Expr  # of d_j
    sine: Expr  # of d_j
    inverse_length: Expr  # 1/L_j [1/m]; 1 for d_(N+1)


class Path(NamedTuple):
    """The path of the last axle."""

    # ``slopes[m]``: m-th derivative of y by x along the path of the last axle, with the steering input
    # at 0
    slopes: tuple[Expr, ...]
    speed: Expr  # w_0: speed of the tractor's axle per unit of dx/dt
    along: Expr  # 1/w_0: a product of cosines
    gain: Expr  # derivative of the last order but one by the tractor's heading
    inverse_gain: Expr  # 1 / gain


def threshold(trailers: int) -> Expr:
    """Return the smallest product of cosines, a power of two: its power 2 N + 5 has at most DIGITS digits."""
    return sympy.Rational(1, 2 ** (DIGITS * 332 // (100 * (2 * trailers + 5))))


class _Level:
    """The series of one angle: d, T = tan d, c = 1/cos d, w, and the state that they drive."""

    def __init__(self, names: Locals, link: Link, orders: int, first: bool, gate: Gate) -> None:
        self.names, self.link, self.orders, self.first = names, link, orders, first
        sec = gate.inverse(names, link.cosine, f"{link.name}_kept", f"{link.name}_sec")
        tan = names.define(f"{link.name}_tan", times(link.sine, sec))
        self.d: Series = [sympy.S.Zero]
        self.tan, self.sec, self.state = [tan], [sec], [sympy.S.Zero]
        # Coefficients of the state after the first; the state itself is never needed.
        self.squared: Series = [add(sympy.S.One, names.define(f"{link.name}_tan_squared", times(tan, tan)))]
        self.product: Series = []

    def advance(self, k: int, w: Series, front: Series) -> None:
        """Compute order k of tan d and 1/cos d, then order k + 1 of the state.

        Args:
            k: The order.
            w: The series of w_j.
            front: The series of the state ahead.
        """
        if k:
            turned = front[k] if self.first else subtract(front[k], self.state[k])
            self.d.append(self._named("turn", k, turned))
            steps = [times(sympy.Integer(i), self.d[i]) for i in range(1, k + 1)]
            share = sympy.Rational(1, k)
            self.product.append(self._named("slope", k - 1, convolve(self.tan, self.sec, k - 1)))
            self.tan.append(self._named("tan", k, times(share, _against(steps, self.squared))))
            self.sec.append(self._named("sec", k, times(share, _against(steps, self.product))))
            self.squared.append(self._named("tan_squared", k, convolve(self.tan, self.tan, k)))
        rate = times(convolve(self.tan, w, k), self.link.inverse_length, sympy.Rational(1, k + 1))
        self.state.append(self._named("state", k + 1, rate))

    def _named(self, what: str, k: int, value: Expr) -> Expr:
        """Return a coefficient as an intermediate result; numbers and symbols need no name."""
        trivial = not value.args or value.is_Number
        return value if trivial else self.names.define(f"{self.link.name}_{what}_{k}", value)


def path(names: Locals, links: list[Link], curvature: Expr | None) -> Path:
    """Return the path of the last axle.

    Args:
        names: Takes the intermediate results.
        links: d_(N+1) first, d_1 last.
        curvature: Curvature of the tractor's path [1/m]; None if the yaw rate is an input, which is 0 in ``slopes``.

    Returns:
        The path up to order len(links) + 2 with a curvature, else one order less.
    """
    orders = len(links) + (2 if curvature is not None else 1)
    links = [x._replace(cosine=names.define(f"{x.name}_cosine", x.cosine)) for x in links]
    cosines = [x.cosine for x in links]
    gate = Gate(names.define("cosines", times(*cosines)), threshold(len(links) - 1))
    levels = [_Level(names, link, orders - i, i == 0, gate) for i, link in enumerate(links)]
    w: list[Series] = [[sympy.S.One]] + [[] for _ in levels]
    head: Series = [sympy.S.Zero]
    for k in range(orders):
        for i, level in enumerate(levels):
            if k < level.orders:
                front = levels[i + 1].state if i + 1 < len(levels) else head
                if k and i == 0:
                    w[0].append(sympy.S.Zero)
                level.advance(k, w[i], front)
                w[i + 1].append(names.define(f"{level.link.name}_ratio_{k}", convolve(w[i], level.sec, k)))
        turning = curvature is not None and k < orders - len(levels)
        head.append(times(curvature, w[-1][k], sympy.Rational(1, k + 1)) if turning else sympy.S.Zero)
    slopes = tuple(times(sympy.Integer(factorial(m)), value) for m, value in enumerate(levels[0].state))
    gains, inverses = [], []
    for i, (level, link) in enumerate(zip(levels, links, strict=True)):
        gains.append(times(level.sec[0], level.sec[0], w[i][0], link.inverse_length))
        length = sympy.Pow(link.inverse_length, -1)
        inverses.append(times(link.cosine, link.cosine, *cosines[:i], length))
    return Path(slopes, w[-1][0], gate.value, times(*gains), times(*inverses))


def convolve(a: Series, b: Series, k: int) -> Expr:
    """Return coefficient k of the product of two series; equal products are written once.

    Args:
        a: A series.
        b: A series.
        k: The order.
    """
    if a is b:
        pairs = [times(sympy.Integer(2), a[i], a[k - i]) for i in range((k + 1) // 2)]
        return add(*pairs, *([times(a[k // 2], a[k // 2])] if k % 2 == 0 else []))
    return add(*(times(a[i], b[k - i]) for i in range(k + 1)))


def _against(steps: Series, series: Series) -> Expr:
    """Return the sum over i of i d_i series_(k-i), i from 1 to k."""
    k = len(steps)
    return add(*(times(steps[i - 1], series[k - i]) for i in range(1, k + 1)))
