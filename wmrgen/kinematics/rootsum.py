"""Norms of residuals: the root of a sum of squares, in its shortest exact form."""

from __future__ import annotations

from collections.abc import Sequence

import sympy

from wmrgen.exact.evaluate import fix, sqrt_poly
from wmrgen.exact.number import ONE, Exact
from wmrgen.exact.poly import Poly
from wmrgen.symbolic import Expr, absolute, add, expression, number, root, square, times

NEGLIGIBLE = 1e-12


def norm(forms: Sequence[Poly], weight: Exact = ONE) -> Expr:
    """sqrt(weight * sum of squares). Proportional forms are merged: one form needs no square root."""
    groups: list[tuple[Poly, Exact]] = []
    for form in forms:
        if not form or _size(form) < NEGLIGIBLE:
            continue
        for i, (base, total) in enumerate(groups):
            ratio = _ratio(form, base)
            if ratio is not None:
                groups[i] = (base, total + ratio * ratio)
                break
        else:
            groups.append((form, ONE))
    if not groups:
        return sympy.S.Zero
    if len(groups) == 1:
        base, total = groups[0]
        factor = fix(sqrt_poly(Poly.of(total * weight)), {})
        return absolute(expression(base * factor))
    return root(add(*(times(number(t * weight), square(expression(b))) for b, t in groups)))


def _size(form: Poly) -> float:
    return max(abs(float(c)) for c in form.terms.values())


def _ratio(a: Poly, b: Poly) -> Exact | None:
    """a / b when it is a number."""
    if a.terms.keys() != b.terms.keys():
        return None
    m = next(iter(a.terms))
    ratio = a.terms[m] / b.terms[m]
    return ratio if all(c == ratio * b.terms[k] for k, c in a.terms.items()) else None
