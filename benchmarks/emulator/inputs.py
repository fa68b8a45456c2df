"""Inputs for counting: the same in every run and on every machine."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence


def cases(
    names: Sequence[str], tunables: dict[str, float], seed: str, count: int
) -> Iterator[dict[str, float]]:
    """Return a standstill, then inputs uniform in [-1, 1]; ``tunables`` keep their values."""
    source = random.Random(seed)
    yield {name: tunables.get(name, 0.0) for name in names}
    for _ in range(count):
        yield {name: tunables.get(name, source.uniform(-1.0, 1.0)) for name in names}
