"""The operations: `Op`, the record of one, and a module for each family of them."""

from wmrgen.ir.ops import order, quotients, ring, waves, whole
from wmrgen.ir.ops.record import OPERATIONS, Choice, Op

__all__ = ["OPERATIONS", "Choice", "Op", "order", "quotients", "ring", "waves", "whole"]
