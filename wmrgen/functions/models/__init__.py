"""A robot as a control system: coordinates and inputs, models as systems, Lie brackets, integrability.

A robot with its mobility comes in; systems q' = G(q) u, their state space and statements about them go out. No
function here evaluates a model or simulates it.
"""
