"""C99: ``<robot>.h`` and ``<robot>.c``, straight-line code over structs with named wheels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from wmrgen.backends.c99.emit import emit, sources
from wmrgen.backends.c99.trace import places
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module

__all__ = ["emit", "evaluate", "places", "sources"]


def evaluate(
    module: Module, function: str, cases: Sequence[Mapping[str, float]], **words: str
) -> list[dict[str, float]]:
    """Outputs by contract name for each case, from the C of the `Choice` that ``words`` say, compiled."""
    from wmrgen.backends.c99.driver import evaluate_c

    return evaluate_c(module, function, cases, Choice(**words))
