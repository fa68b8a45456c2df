"""Geometry: from the records of a robot file to exact rows.

In comes a `RobotSpec`; out goes a `Robot`: exact places and orientations of its wheels, in metres and radians in the
robot frame, and the rolling and sliding rows of each wheel. This room decides no rank and solves no system.
"""
