"""Joints that turn together by a shaft, a belt or gears, as two files have them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence

from wmrgen.comparing.record import JOINTS, Difference, Layout, Side, Tie
from wmrgen.errors import Mark

COUPLED = "WMR051"


def coupled(a: Layout, b: Layout, pairs: Sequence[tuple[Side, Side]]) -> Iterator[Difference]:
    """Couplings that one file alone has, or in another ratio, of the wheels that both have."""
    if a.ties is None or b.ties is None:
        return
    for joint in JOINTS:
        own_ties, told_ties = ([tie for tie in ties if tie.joint == joint] for ties in (a.ties, b.ties))
        own = [{v.name: t.turns[v.name] for v, _ in pairs if v.name in t.turns} for t in own_ties]
        told = [
            {v.name: t.turns[w.name] * _sense(v, w, joint) for v, w in pairs if w.name in t.turns}
            for t in told_ties
        ]
        for wheels in dict.fromkeys(tuple(shaft) for shaft in (*own, *told) if len(shaft) > 1):
            p, q = (next((_shown(s) for s in side if tuple(s) == wheels), None) for side in (own, told))
            if p == q:
                continue
            joints = ", ".join(f"{name}.{joint}" for name in wheels)
            alone = f"together only by {(a if p else b).source}"
            words = f"{joints} turn {f'{p} -> {q}' if p and q else alone}"
            names = {w.name for v, w in pairs if v.name in wheels}
            marks = (*_marks(told_ties, names), *_marks(own_ties, {*wheels}))
            yield Difference(COUPLED, "coupling", wheels[0], p, q, words, marks)


def _sense(v: Side, w: Side, joint: str) -> int:
    """-1 where a spin of the second file counts the other way."""
    return -1 if joint == "spin" and math.cos(w.of("heading") - v.of("heading")) < 0 else 1


def _shown(turns: Mapping[str, float]) -> str:
    """The ratio to the first, as far as it counts."""
    first = next(iter(turns.values()))
    return " : ".join(f"{each / first:.4g}" for each in turns.values())


def _marks(ties: Iterable[Tie], wheels: set[str]) -> Iterator[Mark]:
    return (mark for tie in ties if tie.turns.keys() & wheels for mark in tie.marks)
