"""C99: ``<robot>.h`` and ``<robot>.c``, straight-line code over structs with named wheels."""

from __future__ import annotations

from wmrgen.backends.c99.emit import emit, sources
from wmrgen.backends.c99.evaluate import evaluate, evaluate_c
from wmrgen.backends.c99.trace import places

__all__ = ["emit", "evaluate", "evaluate_c", "places", "sources"]
