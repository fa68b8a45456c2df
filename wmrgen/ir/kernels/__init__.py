"""Sine, cosine, arctangents and rounding as float operations: what generated C computes instead of calling libm."""

from wmrgen.ir.kernels.expand import expand, rounds, with_kernels

__all__ = ["expand", "rounds", "with_kernels"]
