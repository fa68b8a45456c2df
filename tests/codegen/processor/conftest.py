"""Images of the gallery, each built once."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import pytest

from benchmarks.emulator.fleet import Fleet
from benchmarks.emulator.zig import Target
from tests.codegen.processor.fleets import every, fleet

Built = Callable[..., Fleet]


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    """(processor, mathematics, kernels called) -> the image of the gallery."""

    @cache
    def one(target: Target, math: str, small: bool = False) -> Fleet:
        return fleet(target, tmp_path_factory.mktemp("gallery"), every(), math, small)

    return one
