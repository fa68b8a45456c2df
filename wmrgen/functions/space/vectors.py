"""Vectors of space as triples of expressions, and one step of the recursion through moving frames.

All vectors of a step are written in the coordinates of one common frame.
"""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.symbolic import Expr, add, subtract, times

Vector = tuple[Expr, Expr, Expr]


def plus(*vectors: Vector) -> Vector:
    """The sum of vectors."""
    x, y, z = (add(*entries) for entries in zip(*vectors, strict=True))
    return x, y, z


def scaled(factor: Expr, v: Vector) -> Vector:
    """factor v."""
    return times(factor, v[0]), times(factor, v[1]), times(factor, v[2])


def cross(a: Vector, b: Vector) -> Vector:
    """a x b."""
    x, y, z = (subtract(times(a[i], b[j]), times(a[j], b[i])) for i, j in ((1, 2), (2, 0), (0, 1)))
    return x, y, z


def dot(a: Vector, b: Vector) -> Expr:
    """a . b."""
    return add(*(times(p, q) for p, q in zip(a, b, strict=True)))


@dataclass(frozen=True, slots=True)
class Frame:
    """What a frame does as the frame before it sees it: velocity, angular velocity and their rates."""

    v: Vector
    omega: Vector
    a: Vector
    alpha: Vector


@dataclass(frozen=True, slots=True)
class Point:
    """A point as a frame sees it: position, velocity, acceleration."""

    r: Vector
    v: Vector
    a: Vector


def seen_from_before(frame: Frame, origin: Vector, point: Point) -> Point:
    """One step of the recursion (Kelly (4.23)-(4.25), corrected): the point as the frame before sees it.

    v = v_f + omega x r + v_o,  a = a_f + alpha x r + omega x (omega x r) + 2 omega x v_o + a_o. ``origin``: of the
    frame, from the frame before.
    """
    turning = cross(frame.omega, point.r)
    v = plus(frame.v, turning, point.v)
    euler, inward = cross(frame.alpha, point.r), cross(frame.omega, turning)
    coriolis = scaled(2, cross(frame.omega, point.v))
    return Point(plus(origin, point.r), v, plus(frame.a, euler, inward, coriolis, point.a))
