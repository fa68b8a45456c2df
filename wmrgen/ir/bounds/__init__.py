"""Bounds of the generated code: ranges, rounding errors, and that every operation is defined."""
