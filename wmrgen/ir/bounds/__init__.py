"""Proved bounds of generated float32 code: ranges of results, rounding errors, and that every operation is defined.

Functions as they are printed and the limits of a robot come in; `robot.Bounds` goes out, for the header, the report,
model.json and `wmrgen prove`. This package must not run any code and must not change a function.
"""
