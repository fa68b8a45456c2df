"""The operations: `Op`, the record of one, and a module for each family of them."""

from wmrgen.ir.ops import order, quotients, ring, waves, whole
from wmrgen.ir.ops.record import OPERATIONS, Conditional, Op

__all__ = ["OPERATIONS", "Conditional", "Op", "order", "quotients", "ring", "waves", "whole"]
