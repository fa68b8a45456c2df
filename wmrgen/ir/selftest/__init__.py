"""Test vectors for generated code: points, the exact results there, and how far rounding may move them.

Optimised functions and the site of a robot (limits, pivots) come in; tables of `vectors.Vector` go out, which back ends
print as self-tests. This package must not know a language.
"""
