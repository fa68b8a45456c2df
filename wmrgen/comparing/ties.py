"""Joints that turn together by a shaft, a belt or gears, as two files have them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

from wmrgen.comparing.record import Difference, Layout, Side, Tie
from wmrgen.errors import Mark

COUPLED = "WMR051"
JOINTS = ("spin", "steer")
Shaft = dict[str, float]  # wheel -> turns of its joint for one of the shaft; the first has the motor


def shafts(ties: Iterable[Tie], joint: str) -> list[Shaft]:
    """What turns together, also through others."""
    result: list[Shaft] = []
    for tie in ties:
        if tie.joint != joint:
            continue
        own = dict(tie.turns)
        for other in [shaft for shaft in result if shaft.keys() & own.keys()]:
            k = next(own[w] / turns for w, turns in other.items() if w in own)
            own = {w: turns * k for w, turns in other.items()} | own
            result.remove(other)
        result.append(own)
    return result


def coupled(a: Layout, b: Layout, pairs: Sequence[tuple[Side, Side]]) -> Iterator[Difference]:
    """Couplings that one file alone has, or in another ratio, of the wheels that both have."""
    if a.ties is None or b.ties is None:
        return
    for joint in JOINTS:
        own = [{v.name: s[v.name] for v, _ in pairs if v.name in s} for s in shafts(a.ties, joint)]
        told = [
            {v.name: s[w.name] * _sense(v, w, joint) for v, w in pairs if w.name in s}
            for s in shafts(b.ties, joint)
        ]
        for wheels in dict.fromkeys(tuple(shaft) for shaft in (*own, *told) if len(shaft) > 1):
            p, q = (next((_shown(s) for s in side if tuple(s) == wheels), None) for side in (own, told))
            if p == q:
                continue
            joints = ", ".join(f"{name}.{joint}" for name in wheels)
            alone = f"together only by {(a if p else b).source}"
            words = f"{joints} turn {f'{p} -> {q}' if p and q else alone}"
            names = {w.name for v, w in pairs if v.name in wheels}
            marks = (*_marks(b.ties, names, joint), *_marks(a.ties, {*wheels}, joint))
            yield Difference(COUPLED, "coupling", wheels[0], p, q, words, marks)


def _sense(v: Side, w: Side, joint: str) -> int:
    """-1 where a spin of the second file counts the other way."""
    return -1 if joint == "spin" and math.cos(w.of("heading") - v.of("heading")) < 0 else 1


def _shown(shaft: Shaft) -> str:
    """The ratio to the first, as far as it counts."""
    first = next(iter(shaft.values()))
    return " : ".join(f"{turns / first:.4g}" for turns in shaft.values())


def _marks(ties: Iterable[Tie], wheels: set[str], joint: str) -> Iterator[Mark]:
    return (tie.mark for tie in ties if tie.mark and tie.joint == joint and tie.turns.keys() & wheels)
