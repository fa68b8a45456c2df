"""Taylor series of a tractor with trailers along the path of its last axle.

Headings theta_0 (tractor) .. theta_N (last), d_j = theta_(j-1) - theta_j, d_(N+1) = theta_N, s = x of the last axle.
Driving so that ds = 1, the states follow (Tzafestas (2.70), divided by the speed of the last axle along x)

    y' = T_(N+1),    theta_j' = T_j w_j / L_j,    theta_0' = kappa w_0,
    T_j = tan d_j,   w_N = 1/cos theta_N,   w_(j-1) = w_j / cos d_j.

Derivatives of y with respect to s are then coefficients of a power series. Its recurrences share every
intermediate result, so N trailers cost some N**3 operations where repeated differentiation doubles with each order.

The order N + 3 grows like 1/cos to the power 2 N + 5. Where the product of all cosines is below `threshold`, at the
edge of the domain, every 1/cos reads 0: the derivatives are 0 and the tractor stands, in float32 too.
"""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import sympy

from wmrgen.analysis.kinematics.records import Locals
from wmrgen.functions.system import Gate
from wmrgen.geometry.symbolic import Expr, add, subtract, times

DIGITS = 24  # float32 holds 38; what is left is for lengths and factorials
NARROW = sympy.Rational(1, 10**5)  # a divisor of the steering nearer to zero than this counts as zero

Series = list[Expr]


class Link(NamedTuple):
    """One angle of the train: cosine and sine of d_j, and 1/L_j [1/m] (1 for d_(N+1))."""

    name: str
    cosine: Expr
    sine: Expr
    inverse_length: Expr


class Path(NamedTuple):
    """``slopes[m]``: the m-th derivative of y by x along the path of the last axle, the steering input at rest.

    ``speed``: w_0, speed of the tractor's axle per unit of dx/dt. ``along``: 1/w_0, a product of cosines.
    ``gain`` and ``inverse_gain``: how the order before the last answers to the tractor's heading.
    """

    slopes: tuple[Expr, ...]
    speed: Expr
    along: Expr
    gain: Expr
    inverse_gain: Expr


def threshold(trailers: int) -> Expr:
    """The least product of cosines, a power of two: its power 2 N + 5 keeps to DIGITS."""
    return sympy.Rational(1, 2 ** (DIGITS * 332 // (100 * (2 * trailers + 5))))


class _Level:
    """The series of one angle: d, T = tan d, c = 1/cos d, w, and the state that it drives."""

    def __init__(self, names: Locals, link: Link, orders: int, first: bool, gate: Gate) -> None:
        self.names, self.link, self.orders, self.first = names, link, orders, first
        sec = gate.inverse(names, link.cosine, f"{link.name}_kept", f"{link.name}_sec")
        tan = names.define(f"{link.name}_tan", times(link.sine, sec))
        self.d: Series = [sympy.S.Zero]
        self.tan, self.sec, self.state = [tan], [sec], [sympy.S.Zero]
        # Coefficients of the state after the first; its value itself is never needed.
        self.squared: Series = [add(sympy.S.One, names.define(f"{link.name}_tan_squared", times(tan, tan)))]
        self.product: Series = []

    def advance(self, k: int, w: Series, front: Series) -> None:
        """Order k of tan d and 1/cos d, then order k + 1 of the state. ``w``: w_j; ``front``: the state ahead."""
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
        trivial = not value.args or value.is_Number
        return value if trivial else self.names.define(f"{self.link.name}_{what}_{k}", value)


def path(names: Locals, links: list[Link], curvature: Expr | None) -> Path:
    """The path of the last axle. ``links``: d_(N+1) first, d_1 last. ``curvature``: of the tractor; None: it turns
    by an input of its own, at rest in ``slopes``. Orders 0 to len(links) + 2 with a curvature, else one less."""
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
    gain = times(*(times(x.sec[0], x.sec[0], w[i][0], x.link.inverse_length) for i, x in enumerate(levels)))
    inverse = times(
        *(
            times(x.cosine, x.cosine, *cosines[:i], sympy.Pow(x.inverse_length, -1))
            for i, x in enumerate(links)
        )
    )
    return Path(slopes, w[-1][0], gate.value, gain, inverse)


def convolve(a: Series, b: Series, k: int) -> Expr:
    """Coefficient k of the product of two series; equal products are written once."""
    if a is b:
        pairs = [times(sympy.Integer(2), a[i], a[k - i]) for i in range((k + 1) // 2)]
        return add(*pairs, *([times(a[k // 2], a[k // 2])] if k % 2 == 0 else []))
    return add(*(times(a[i], b[k - i]) for i in range(k + 1)))


def _against(steps: Series, series: Series) -> Expr:
    """sum over i of i d_i series_(k-i), i from 1 to k."""
    k = len(steps)
    return add(*(times(steps[i - 1], series[k - i]) for i in range(1, k + 1)))
