"""Exact arithmetic: numbers of Q(sqrt2, sqrt3), polynomials over them, angles with exact sines."""

from wmrgen.geometry.exact.number import Exact

__all__ = ["Exact"]
