"""Geometry: from the records of a robot file to exact constraint rows.

The input is a `RobotSpec`. The output is a `Robot`, with exact positions and headings of its wheels in metres and
radians in the robot frame, and the rolling and sliding rows of each wheel. This room must not round, decide a rank or
solve a system of equations.
"""
