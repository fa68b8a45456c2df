"""Derivatives of polynomials by the chain rule over their generators."""

from __future__ import annotations

from collections.abc import Callable

from wmrgen.exact.poly import Gen, Poly


def derivative(poly: Poly, of_generator: Callable[[Gen], Poly]) -> Poly:
    """The sum over generators g of d poly / d g times ``of_generator(g)``, the derivative of g."""
    parts = []
    for monomial, coefficient in poly.terms.items():
        for g, e in monomial:
            inner = of_generator(g)
            if inner:
                rest = tuple((h, n - (h == g)) for h, n in monomial if n - (h == g))
                parts.append(Poly({rest: coefficient * e}) * inner)
    return Poly.sum(parts)


def by_angle(poly: Poly, cosine: Gen, sine: Gen) -> Poly:
    """The derivative by an angle that enters through this cosine and sine alone."""
    rates = {cosine: -_alone(sine), sine: _alone(cosine)}
    return derivative(poly, lambda g: rates.get(g, Poly({})))


def _alone(g: Gen) -> Poly:
    return Poly.gen(g.kind, g.name, *g.args)
