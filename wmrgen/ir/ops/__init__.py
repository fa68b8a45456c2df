"""The operations: `Op`, the record of one, and a module for each family of them."""

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
