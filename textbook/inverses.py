"""Generalised inverses (Tzafestas (2.6)-(2.8b)): symbolic with the condition on the rank in words, and as
functions of a fixed size.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product as pairs

import mpmath
import sympy

from textbook.page import Page, Rows
from textbook.vectors import product, transposed
from wmrgen.errors import NotDerivableError
from wmrgen.kinematics.records import Formula
from wmrgen.symbolic import Expr

_DIGITS, _SMALL = 50, 1e-30


@dataclass(frozen=True, slots=True)
class GeneralisedInverse:
    """``matrix`` is J+; ``kind``: inverse, left, right or full; ``condition``: where it holds, in words.

    ``divisor`` is the determinant that must not be 0.
    """

    matrix: sympy.Matrix
    kind: str
    rank: int
    condition: str
    divisor: Expr


def generalised_inverse(J: sympy.Matrix, full: bool = False) -> GeneralisedInverse:
    """J+ of an m x n matrix of numbers or expressions.

    Full column rank: (J^T J)^-1 J^T, least squares (Tzafestas (2.8a)). Full row rank: J^T (J J^T)^-1, minimum
    norm (2.8b). Else NotDerivableError with the condition that is violated, or with ``full`` the Moore-Penrose
    inverse from the factors of a rank factorisation.
    """
    m, n = J.shape
    r = generic_rank(J)
    if r == m == n:
        return _one_sided(J, J, "inverse", r, "J is square and regular", lambda inv: inv)
    if r == n:
        words = f"J has full column rank {n}: least squares of |p - J q|"
        return _one_sided(J, J.T * J, "left", r, words, lambda inverse: inverse * J.T)
    if r == m:
        words = f"J has full row rank {m}: the smallest |q| of all solutions of J q = p"
        return _one_sided(J, J * J.T, "right", r, words, lambda inverse: J.T * inverse)
    if not full:
        raise NotDerivableError(
            f"a {m} x {n} matrix of rank {r} has neither a left inverse (needs rank {n}) nor a right inverse "
            f"(needs rank {m}); ask for the Moore-Penrose inverse of a rank factorisation (full=True)"
        )
    return _factored(J, r)


def penrose(J: sympy.Matrix, P: sympy.Matrix) -> tuple[sympy.Matrix, ...]:
    """The four Penrose conditions as differences; all 0 where P is J+ (Tzafestas 2.2)."""
    return J * P * J - J, P * J * P - P, (J * P).T - J * P, (P * J).T - P * J


def generic_rank(J: sympy.Matrix) -> int:
    """The rank at general values of the symbols: the largest at two fixed points, to 50 digits."""
    symbols = sorted(J.free_symbols, key=lambda s: str(s))
    best = 0
    for start in (11, 29):
        point = {s: sympy.Rational(start + 7 * k, 13 + 2 * k) for k, s in enumerate(symbols)}
        best = max(best, _numeric_rank(J.xreplace(point)))
    return best


def _numeric_rank(J: sympy.Matrix) -> int:
    rows, columns = J.shape
    if not rows or not columns:
        return 0
    with mpmath.workdps(_DIGITS):
        values = mpmath.matrix(rows, columns)
        for i, j in pairs(range(rows), range(columns)):
            values[i, j] = mpmath.mpf(sympy.Float(sympy.N(J[i, j], _DIGITS), _DIGITS)._mpf_)
        singular = mpmath.svd_r(values, compute_uv=False)
        return sum(1 for s in singular if s > _SMALL * max(singular[0], 1))


def _one_sided(
    J: sympy.Matrix, gram: sympy.Matrix, kind: str, rank: int, words: str, finish: object
) -> GeneralisedInverse:
    divisor = sympy.simplify(gram.det(method="berkowitz"))
    inverse = gram.adjugate() / divisor
    made = finish(inverse) if callable(finish) else inverse
    what = "det J" if kind == "inverse" else "det(J^T J)" if kind == "left" else "det(J J^T)"
    condition = words if divisor.is_number else f"{words}, wherever {what} is not 0"
    return GeneralisedInverse(made.applyfunc(sympy.simplify), kind, rank, condition, divisor)


def _factored(J: sympy.Matrix, rank: int) -> GeneralisedInverse:
    """J = F G with F of full column and G of full row rank: J+ = G^T (G G^T)^-1 (F^T F)^-1 F^T."""
    if rank == 0:
        return GeneralisedInverse(J.T * 0, "full", 0, "J is 0", sympy.S.One)
    reduced, pivots = J.rref(simplify=True)
    F, G = J[:, list(pivots)], reduced[:rank, :]
    left, right = generalised_inverse(F), generalised_inverse(G)
    m, n = J.shape
    words = f"J has rank {rank}, below {min(m, n)}: least squares, and the smallest |q| among them"
    return GeneralisedInverse(
        (right.matrix * left.matrix).applyfunc(sympy.simplify), "full", rank, words,
        left.divisor * right.divisor,
    )  # fmt: skip


# ---- as functions of a fixed size

SIZES = ((2, 2), (3, 3), (3, 2), (4, 2), (4, 3), (2, 3), (2, 4), (3, 4))


def _cofactors(page: Page, a: Rows) -> tuple[Rows, Expr]:
    """Adjugate and determinant of a 2 x 2 or 3 x 3 matrix; both as named results."""
    if len(a) == 2:
        (p, q), (r, s) = a
        return ((s, -q), (-r, p)), p * s - q * r
    others = ((1, 2), (2, 0), (0, 1))
    rows = tuple(
        tuple(
            page.let(f"c{i}{j}", a[others[j][0]][others[i][0]] * a[others[j][1]][others[i][1]]
                     - a[others[j][0]][others[i][1]] * a[others[j][1]][others[i][0]])
            for j in range(3)
        )
        for i in range(3)
    )  # fmt: skip
    return rows, sympy.Add(*(a[0][k] * rows[k][0] for k in range(3)))


def inverse_of_size(m: int, n: int) -> Formula:
    """J+ of an m x n matrix, row by row; all 0 where the determinant vanishes (Tzafestas (2.8a), (2.8b))."""
    kind = "inverse" if m == n else "left inverse" if m > n else "right inverse"
    number = {"inverse": "(2.6)", "left inverse": "(2.8a)", "right inverse": "(2.8b)"}[kind]
    page = Page(f"inverse_{m}x{n}", f"{kind} of a {m} x {n} matrix, Tzafestas {number}")
    J = page.matrix("j", m, n, "", "entry of J")
    back = transposed(J)
    square = J if m == n else product(back, J) if m > n else product(J, back)
    if m != n:
        square = tuple(
            tuple(page.let(f"g{min(i, j)}{max(i, j)}", e) if i <= j else e for j, e in enumerate(row))
            for i, row in enumerate(square)
        )
        square = tuple(
            tuple(square[min(i, j)][max(i, j)] for j in range(len(square))) for i in range(len(square))
        )
    adjugate, value = _cofactors(page, square)
    determinant = page.let("determinant", value)
    factor = page.quotient("factor", sympy.S.One, determinant)
    inverse = tuple(tuple(factor * entry for entry in row) for row in adjugate)
    made = inverse if m == n else product(inverse, back) if m > n else product(back, inverse)
    page.gives_matrix("p", made, "", "entry of J+")
    what = "J" if m == n else "J^T J" if m > n else "J J^T"
    page.gives("det", "", determinant, f"determinant of {what}; where it is 0 the rank is too low")
    return page.formula()
