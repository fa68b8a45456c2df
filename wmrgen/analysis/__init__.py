"""Analysis: the mobility of a layout, and its kinematics in symbols.

The input is a `Robot`. The output is its `Mobility` record and the formulas of `inverse`, `forward` and `odometry` as
sympy expressions. This room must not know a programming language or a back end.
"""
