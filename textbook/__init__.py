"""Formulas of the texts that need no robot, each with its equation, for every backend; and the errata.

>>> from textbook import textbook, generalised_inverse
>>> textbook("pursuit").casadi()["pursuit"]
"""

from textbook.canonical import INPUT_SETS
from textbook.inverses import GeneralisedInverse, generalised_inverse, penrose
from textbook.library import FUNCTIONS, Textbook, formula, textbook

__all__ = [
    "FUNCTIONS",
    "INPUT_SETS",
    "GeneralisedInverse",
    "Textbook",
    "formula",
    "generalised_inverse",
    "penrose",
    "textbook",
]
