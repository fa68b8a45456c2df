"""How deep the tests go: `make test` is everyday, `make check` (and so CI) sets WMRGEN_DEEP."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

import pytest

DEEP = os.environ.get("WMRGEN_DEEP") == "1"


def examples(count: int, share: int = 6) -> int:
    """How many random examples of ``count`` to draw: all in depth, one of ``share`` every day, never under 4."""
    return count if DEEP else max(count // share, min(count, 4))


def everyday(values: Iterable[object], kept: Iterable[object]) -> list[object]:
    """``values`` as parameters, those not in ``kept`` marked slow."""
    chosen = list(kept)
    return [v if v in chosen else pytest.param(v, marks=pytest.mark.slow) for v in values]


# Of cases of numbers that are computed by every backend, those in C are everyday: they pass through all that stands
# before the others, too.
BACKENDS = everyday(("exact", "casadi", "c"), ["c"])

# Of tests over the whole gallery, the robots whose cases are everyday: each kind of wheel, limits, couplings, tunable
# parameters, castors and trailers once. The cases of every other robot are slow.
EVERYDAY = frozenset(
    {
        "ackermann_car", "agilex_ranger", "car_with_trailers", "clearpath_do100", "locked_bicycle", "nomad_xr4000",
        "pioneer3dx", "synchro_drive", "wpilib_swervebot",
    }
)  # fmt: skip
GALLERY = frozenset(p.stem for p in (Path(__file__).resolve().parent.parent / "robots").glob("*.yaml"))


def mark_slow(items: Iterable[pytest.Item]) -> None:
    """Marks the cases of robots that are not `EVERYDAY` as slow, where a test has cases of such as are."""
    cases = {item: set(_case(item).split("-")) for item in items}
    with_everyday = {_test(item) for item, words in cases.items() if words & EVERYDAY}
    for item, words in cases.items():
        if words & (GALLERY - EVERYDAY) and _test(item) in with_everyday:
            item.add_marker(pytest.mark.slow)


def _test(item: pytest.Item) -> str:
    return item.nodeid.partition("[")[0]


def _case(item: pytest.Item) -> str:
    return item.nodeid.partition("[")[2].rstrip("]")
