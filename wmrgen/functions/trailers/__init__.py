"""Trailers behind a robot, and the chained, Brockett and flat forms of the train that they make.

A robot with its trailers comes in; models, transformations and their proofs go out. Robots for which a construction is
not known are refused with the reason; no function here approximates.
"""
