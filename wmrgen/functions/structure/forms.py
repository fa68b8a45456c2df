"""Pfaffian rows as differential forms on the configuration, with exact exterior derivatives.

A row a . xi + (joint rates) becomes the form c = c_x dx + c_y dy + c_theta dtheta + ... in the world frame, by
xi = R(theta) (x', y', theta'). Coefficients are polynomials in the cosine and sine of theta and of steering angles,
in which zero is zero: sin**2 is replaced by 1 - cos**2, and then every polynomial has one form.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

from wmrgen.constraints import ConstraintRow
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Gen, Poly, by_angle

ZERO = Poly({})
THETA = Poly.gen("input", "theta")
COS_THETA = Gen("cosf", "", (THETA,))
SIN_THETA = Gen("sinf", "", (THETA,))


@dataclass(frozen=True, slots=True)
class Form:
    """A one-form: ``coefficients[k]`` belongs to d(``coordinates[k]``)."""

    coordinates: tuple[str, ...]
    coefficients: tuple[Poly, ...]


def world_form(row: ConstraintRow) -> Form:
    """The form of a constraint row on x, y, theta, the wheel's steering angle and its wheel angle."""
    a, b, k = row.row
    c, s = Poly({((COS_THETA, 1),): Exact(1)}), Poly({((SIN_THETA, 1),): Exact(1)})
    coordinates = ["x", "y", "theta"]
    coefficients = [a * c - b * s, a * s + b * c, k]
    rates = dict(row.rates)
    if row.wheel.turns:
        coordinates.append(f"{row.wheel.name}.steer")
        coefficients.append(rates.get((row.wheel.index, "steer"), ZERO))
    if (row.wheel.index, "spin") in rates:
        coordinates.append(f"{row.wheel.name}.angle")
        coefficients.append(rates[row.wheel.index, "spin"])
    return Form(tuple(coordinates), tuple(coefficients))


def partial(poly: Poly, coordinate: str) -> Poly:
    """d poly / d coordinate, for theta and steering angles; no coefficient depends on any other."""
    if coordinate == "theta":
        return by_angle(poly, COS_THETA, SIN_THETA)
    if coordinate.endswith(".steer"):
        name = coordinate.removesuffix(".steer")
        return by_angle(poly, Gen("cos", name), Gen("sin", name))
    return ZERO


def exterior(form: Form) -> dict[tuple[int, int], Poly]:
    """dc: the coefficient of dq_i ^ dq_j, i < j, is d_i c_j - d_j c_i."""
    q, c = form.coordinates, form.coefficients
    return {(i, j): partial(c[j], q[i]) - partial(c[i], q[j]) for i, j in combinations(range(len(q)), 2)}


def frobenius_components(form: Form) -> Iterator[tuple[tuple[str, str, str], Poly]]:
    """c ^ dc: the coefficient of dq_i ^ dq_j ^ dq_k is c_i (dc)_jk - c_j (dc)_ik + c_k (dc)_ij."""
    d = exterior(form)
    q, c = form.coordinates, form.coefficients
    for i, j, k in combinations(range(len(q)), 3):
        yield (q[i], q[j], q[k]), c[i] * d[j, k] - c[j] * d[i, k] + c[k] * d[i, j]
