"""Parts that repeat, each written once as a function: the smallest code.

Straight-line code repeats what it does for every wheel. Here what repeats is found in the finished operations of all
functions, whatever the robot, and becomes a function that the others call. Every value is still computed by the same
operations on the same values, so no bit changes.
"""

from __future__ import annotations

from wmrgen.ir.outline.outline import Outlined, outline
from wmrgen.ir.outline.sizes import sizes

__all__ = ["Outlined", "outline", "sizes"]
