"""Read robot files.

YAML text comes in, and frozen records with their places go out (`RobotSpec`); keys and the form of values are checked.
This room must not import sympy or numpy, and must not evaluate anything: values are computed by `wmrgen.geometry`.
"""
