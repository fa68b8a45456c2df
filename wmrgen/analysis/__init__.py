"""Analysis: what a layout allows, and how its wheels and its twist go together.

In comes a `Robot`; out go its mobility record and the formulas of `inverse`, `forward` and `odometry` as sympy
expressions. This room knows no language that code is written in.
"""
