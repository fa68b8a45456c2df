"""Vectors and matrices of space as tuples of expressions."""

from __future__ import annotations

from collections.abc import Sequence

import sympy

from textbook.page import Rows, Vector
from wmrgen.symbolic import Expr

ZERO, ONE = sympy.S.Zero, sympy.S.One


def plus(*vectors: Vector) -> Vector:
    """The sum of vectors."""
    x, y, z = (sympy.Add(*entries) for entries in zip(*vectors, strict=True))
    return x, y, z


def scaled(factor: Expr, v: Vector) -> Vector:
    """factor v."""
    return factor * v[0], factor * v[1], factor * v[2]


def cross(a: Vector, b: Vector) -> Vector:
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def skew(u: Vector) -> Rows:
    """[u]x, 3 x 3, with [u]x v = u x v (Kelly 4.1.4.1)."""
    return (ZERO, -u[2], u[1]), (u[2], ZERO, -u[0]), (-u[1], u[0], ZERO)


def product(a: Sequence[Sequence[Expr]], b: Sequence[Sequence[Expr]]) -> Rows:
    """The matrix product a b."""
    columns = tuple(zip(*b, strict=True))
    return tuple(
        tuple(sympy.Add(*(x * y for x, y in zip(row, column, strict=True))) for column in columns)
        for row in a
    )


def transposed(a: Sequence[Sequence[Expr]]) -> Rows:
    """The transpose of a."""
    return tuple(zip(*a, strict=True))


def beside(a: Rows, b: Rows) -> Rows:
    """[a | b]."""
    return tuple((*left, *right) for left, right in zip(a, b, strict=True))


IDENTITY: Rows = ((ONE, ZERO, ZERO), (ZERO, ONE, ZERO), (ZERO, ZERO, ONE))


def apply(a: Rows, v: Sequence[Expr]) -> tuple[Expr, ...]:
    """a v."""
    return tuple(row[0] for row in product(a, tuple((entry,) for entry in v)))
