"""Integrability of one constraint over three coordinates (Tzafestas Def. 2.1, 2.2; Kelly; AA274)."""

from __future__ import annotations

from collections.abc import Sequence

import sympy

from wmrgen.symbolic import Expr


def frobenius(row: Sequence[Expr], coordinates: Sequence[sympy.Symbol]) -> Expr:
    """c . curl c of the constraint c . q' = 0: the constraint is integrable exactly where this is 0."""
    c1, c2, c3 = row
    x, y, z = coordinates
    curl = (
        sympy.diff(c3, y) - sympy.diff(c2, z),
        sympy.diff(c1, z) - sympy.diff(c3, x),
        sympy.diff(c2, x) - sympy.diff(c1, y),
    )
    return sympy.simplify(c1 * curl[0] + c2 * curl[1] + c3 * curl[2])
