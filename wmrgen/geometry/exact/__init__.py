"""Exact arithmetic: numbers of the field Q(sqrt2, sqrt3), polynomials over it, and angles with exact sines."""

from wmrgen.geometry.exact.number import Exact

__all__ = ["Exact"]
