"""C99: ``<robot>.h`` and ``<robot>.c``, straight-line code over structs with named wheels."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.backends.c99.emit import emit, sources
from wmrgen.backends.c99.places import places
from wmrgen.backends.registry import Request
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module

__all__ = ["emit", "evaluate", "places", "sources"]


def evaluate(module: Module, requests: Sequence[Request], **words: str) -> list[dict[str, float]]:
    """Outputs by contract name of each request, from the C of the `Choice` that ``words`` say, compiled."""
    from wmrgen.backends.c99.driver import evaluate_c

    return evaluate_c(module, requests, Choice(**words))
