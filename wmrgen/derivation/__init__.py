"""Derivation: the facade over all stages of one robot.

In comes a `Robot`; out come its matrices, formulas, functions and files, each computed when first asked for. The one
writer of files is here. Back ends are called through their registry alone.
"""
