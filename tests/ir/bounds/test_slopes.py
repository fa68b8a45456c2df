"""Sums and products of slopes: derivatives within the bounds of two slopes stay within the combined bounds."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from wmrgen.ir.bounds.walk import Slope
from wmrgen.ir.ops.analysis import Partial

COUNT = 4000
J, K = 7, 8  # two lengths


def _walk(shares: dict[tuple[int, int], float]) -> Any:
    """Node 0 depends on divisions by both lengths."""
    return SimpleNamespace(lengths_behind=[frozenset({J, K})], share=lambda j, like: shares.get((j, like)))


class _Sample:
    """Random lengths, a slope, and derivatives that obey it: one per box."""

    def __init__(self, seed: int, over: bool = True, shared: bool = True) -> None:
        rng = np.random.default_rng(seed)
        self.rng, self.h = rng, {j: 10.0 ** rng.uniform(-6, 1, COUNT) for j in (J, K)}
        low, high = -rng.random((1, COUNT)), rng.random((1, COUNT))
        over_ = {J: rng.uniform(0, 1, (1, COUNT))} if over else {}
        size = np.maximum(-low, high)
        a, b = rng.uniform(0, 1, (1, COUNT)) * size, rng.uniform(0, 2, (1, COUNT))
        shared_ = {J: (a, b)} if shared else {}
        self.slope = Slope((low, high), over_, shared_)
        plain = low + (high - low) * rng.random((1, COUNT))
        if shared:  # the first part obeys its second bound as well
            plain = np.clip(plain, -(a + b * self.h[J]), a + b * self.h[J])
        self.value = plain + sum(c / self.h[j] * rng.uniform(-1, 1, COUNT) for j, c in over_.items())


def _obeys(slope: Slope, value: np.ndarray, h: dict[int, np.ndarray]) -> None:
    """Both bounds of a derivative."""
    rest = sum((c / h[j] for j, c in slope.per_length.items()), np.zeros(COUNT))
    room = 1e-9 * (np.abs(value) + slope.size + rest)
    assert (np.abs(value) <= slope.size + rest + room).all()
    low, high = slope.plain
    assert (low - rest - room <= value).all() and (value <= high + rest + room).all()
    for j in (J, K):
        a, b = slope.second_bound(j)
        assert (np.abs(value) <= a + b * h[j] + rest + room).all()


@pytest.mark.parametrize("seed", range(6))
def test_sums(seed: int) -> None:
    x, y = _Sample(seed, over=seed % 2 == 0), _Sample(seed, shared=seed % 3 == 0)
    y.h = x.h
    _obeys(x.slope, x.value, x.h)
    total = x.slope.plus(y.slope)
    if not y.slope.shared:
        _obeys(total, x.value + y.value, x.h)


@pytest.mark.parametrize("share", [None, 0.0, 1.5])
@pytest.mark.parametrize("seed", range(4))
def test_products(seed: int, share: float | None) -> None:
    """With a partial that is like a node of at most ``share`` h."""
    x = _Sample(seed, over=seed % 2 == 0, shared=seed < 2)
    low, high = np.sort(x.rng.normal(0, 1, (2, COUNT)), axis=0)
    by = low + (high - low) * x.rng.random(COUNT)
    if share is not None:
        by = np.clip(by, -2 * share * x.h[J], 2 * share * x.h[J])
        low, high = np.minimum(low, by), np.maximum(high, by)
    shares = {} if share is None else {(J, 3): share}
    _obeys(x.slope.times(Partial(0, (low, high), like=3, times=2.0), _walk(shares)), x.value * by, x.h)


@pytest.mark.parametrize("shared", [True, False])
@pytest.mark.parametrize("seed", range(4))
def test_quotients_by_a_length(seed: int, shared: bool) -> None:
    x = _Sample(seed, over=False, shared=shared)
    steep = x.rng.uniform(0, 2, COUNT)
    by = steep / x.h[J] * x.rng.uniform(-1, 1, COUNT)
    far = (np.full(COUNT, -1e30), np.full(COUNT, 1e30))
    _obeys(x.slope.times(Partial(0, far, length=J, steep=steep), _walk({})), x.value * by, x.h)


def test_a_length_twice_is_infinite() -> None:
    x = _Sample(1)
    far = (np.full(COUNT, -1e30), np.full(COUNT, 1e30))
    twice = x.slope.times(Partial(0, far, length=K, steep=np.ones(COUNT)), _walk({}))
    assert np.isinf(twice.size).all()
