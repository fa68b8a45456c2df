"""The operations of the IR: the record `Op`, and a module for each family of operations.

A record has everything about an operation: numbers, checks, texts of languages, and bounds. Passes, back ends and
analyses read the record. This package must not know a function, a robot or a back end.
"""

from wmrgen.ir.ops import arithmetic, comparison, quotients, rounding, trigonometric
from wmrgen.ir.ops.record import OPERATIONS, Conditional, Op

__all__ = [
    "OPERATIONS",
    "Conditional",
    "Op",
    "arithmetic",
    "comparison",
    "quotients",
    "rounding",
    "trigonometric",
]
