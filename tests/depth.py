"""How deep the tests go: `make test` is everyday, `make check` (and so CI) sets WMRGEN_DEEP."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Sequence

import pytest

DEEP = os.environ.get("WMRGEN_DEEP") == "1"


def examples(count: int) -> int:
    """How many random examples of ``count`` to draw: all in depth, a quarter every day, never under 4."""
    return count if DEEP else max(count // 4, min(count, 4))


def everyday(values: Iterable[object], kept: Iterable[object]) -> list[object]:
    """``values`` as parameters, those not in ``kept`` marked slow."""
    chosen = list(kept)
    return [v if v in chosen else pytest.param(v, marks=pytest.mark.slow) for v in values]


_FEW, _SHARE = 8, 4


def thin_out(items: Sequence[pytest.Item]) -> None:
    """Of a test with many parameters every fourth case stays everyday; the others are marked slow."""
    many = Counter(_test(item) for item in items)
    seen: Counter[str] = Counter()
    for item in items:
        name = _test(item)
        if many[name] > _FEW and seen[name] % _SHARE:
            item.add_marker(pytest.mark.slow)
        seen[name] += 1


def _test(item: pytest.Item) -> str:
    return item.nodeid.partition("[")[0]
