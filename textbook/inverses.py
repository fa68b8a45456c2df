"""Generalised inverses (Tzafestas (2.6)-(2.8b)): symbolic with the condition on the rank in words, and as
functions of a fixed size.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy

from textbook.page import Chapter, Page
from wmrgen.errors import NotDerivableError
from wmrgen.geometry.symbolic import Expr


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
        return _one_sided(J, "inverse", r, "J is square and regular")
    if r == n:
        return _one_sided(J, "left", r, f"J has full column rank {n}: least squares of |p - J q|")
    if r == m:
        return _one_sided(
            J, "right", r, f"J has full row rank {m}: the smallest |q| of all solutions of J q = p"
        )
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
    points = [
        {s: sympy.Rational(start + 7 * k, 13 + 2 * k) for k, s in enumerate(symbols)} for start in (11, 29)
    ]
    return max(int(J.xreplace(p).rank(iszerofunc=lambda e: abs(sympy.N(e, 50)) < 1e-30)) for p in points)


def _one_sided(J: sympy.Matrix, kind: str, rank: int, words: str) -> GeneralisedInverse:
    grams = {"inverse": (J, "det J"), "left": (J.T * J, "det(J^T J)"), "right": (J * J.T, "det(J J^T)")}
    gram, what = grams[kind]
    divisor = sympy.simplify(gram.det(method="berkowitz"))
    inverse = gram.adjugate() / divisor
    result = inverse * J.T if kind == "left" else J.T * inverse if kind == "right" else inverse
    condition = words if divisor.is_number else f"{words}, wherever {what} is not 0"
    return GeneralisedInverse(result.applyfunc(sympy.simplify), kind, rank, condition, divisor)


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

INVERSES = Chapter("Generalised inverses")
SIZES = ((2, 2), (3, 3), (3, 2), (4, 2), (4, 3), (2, 3), (2, 4), (3, 4))


def _named_adjugate(page: Page, a: sympy.Matrix) -> sympy.Matrix:
    """The adjugate of a 2 x 2 or 3 x 3 matrix, cofactors of the larger one as named results."""
    adjugate = a.adjugate()
    if a.rows == 2:
        return adjugate
    return sympy.Matrix(3, 3, [page.let(f"c{i}{j}", adjugate[i, j]) for i in range(3) for j in range(3)])


def _of_size(m: int, n: int) -> None:
    """J+ of an m x n matrix, row by row; all 0 where the determinant vanishes."""
    kind, number, what = (
        ("inverse", "(2.7)", "J") if m == n
        else ("left inverse", "(2.8a)", "J^T J") if m > n
        else ("right inverse", "(2.8b)", "J J^T")
    )  # fmt: skip

    @INVERSES(f"{kind} of a {m} x {n} matrix, Tzafestas {number}", f"inverse_{m}x{n}")
    def inverse(page: Page) -> None:
        J = page.matrix("j", m, n, "entry of J")
        square = J
        if m != n:
            gram = J.T * J if m > n else J * J.T
            named = {
                (i, j): page.let(f"g{i}{j}", gram[i, j])
                for i in range(gram.rows)
                for j in range(i, gram.rows)
            }
            square = sympy.Matrix(gram.rows, gram.rows, lambda i, j: named[min(i, j), max(i, j)])
        adjugate = _named_adjugate(page, square)
        determinant = page.let("determinant", (square[0, :] * adjugate[:, 0])[0])
        back = page.quotient("factor", sympy.S.One, determinant) * adjugate
        page.write_matrix("p [] entry of J+", back if m == n else back * J.T if m > n else J.T * back)
        page.write(f"det [] determinant of {what}; where it is 0 the rank is too low", determinant)


for _m, _n in SIZES:
    _of_size(_m, _n)
