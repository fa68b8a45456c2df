"""Derivation: the facade over all stages of one robot, and the files that are written for it.

In comes a `Robot`; out come its matrices, formulas, functions and files, each computed when it is first used. This room
calls back ends only through their registry. It has the only module that writes files, and decides which are up to date.
"""
