"""Inputs for counting: the same in every run and on every machine."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

from wmrgen.ir.nodes import Module


def nominal(module: Module) -> dict[str, float]:
    """The tunable parameters of ``module``."""
    every = (*module.functions, *([module.prepare] if module.prepare else []))
    return {p.name: float(p.default) for f in every for p in f.inputs if p.default is not None}


def cases(names: Sequence[str], known: dict[str, float], seed: str, count: int) -> Iterator[dict[str, float]]:
    """Standstill, then uniform in [-1, 1]; what is ``known`` stays as it is."""
    source = random.Random(seed)
    yield {name: known.get(name, 0.0) for name in names}
    for _ in range(count):
        yield {name: known.get(name, source.uniform(-1.0, 1.0)) for name in names}
