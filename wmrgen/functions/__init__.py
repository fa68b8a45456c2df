"""The functions of a robot beyond its kinematics, with the registry of all functions.

A robot with its mobility comes in; `Formula` records go out, one for each function, and systems q' = G(q) u, one for
each form of a model. Each function has one builder, declared by a decorator at the builder. This room must not know a
language or a back end, and must not round: numbers stay exact.
"""
