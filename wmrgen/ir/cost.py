"""Operation counts of functions."""

from __future__ import annotations

from collections import Counter
from dataclasses import astuple, dataclass

from wmrgen.ir.nodes import Function


@dataclass(frozen=True, slots=True)
class Cost:
    """How many operations of each kind one call takes."""

    additions: int = 0
    multiplications: int = 0
    divisions: int = 0
    roots: int = 0
    sines: int = 0  # and cosines
    arctangents: int = 0
    comparisons: int = 0  # select, min, max
    signs: int = 0  # negation, absolute value
    roundings: int = 0  # to whole numbers

    @property
    def flops(self) -> int:
        """Additions and multiplications: the figure that robots are compared by."""
        return self.additions + self.multiplications

    @property
    def weight(self) -> int:
        """All operations in units of an addition, roughly as a Cortex-M4F has them."""
        return (
            self.flops + 14 * (self.divisions + self.roots) + 60 * self.sines + 90 * self.arctangents
            + 2 * (self.comparisons + self.roundings) + self.signs
        )  # fmt: skip

    def __add__(self, other: Cost) -> Cost:
        return Cost(*(a + b for a, b in zip(astuple(self), astuple(other), strict=True)))

    def __str__(self) -> str:
        """``6 additions, 3 multiplications``; ``none``."""
        names = (
            ("addition", "additions"), ("multiplication", "multiplications"), ("division", "divisions"),
            ("square root", "square roots"), ("sine or cosine", "sines and cosines"),
            ("arctangent", "arctangents"), ("comparison", "comparisons"),
            ("sign operation", "sign operations"), ("rounding", "roundings"),
        )  # fmt: skip
        counted = zip(astuple(self), names, strict=True)
        return ", ".join(f"{n} {name[n != 1]}" for n, name in counted if n) or "none"


def count(function: Function) -> Cost:
    """The operations in the list of ``function``; unused nodes count too."""
    return Cost(**Counter(node.op.cost for node in function.nodes if node.op.cost))
