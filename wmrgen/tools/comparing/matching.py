"""Match the wheels of two descriptions: by name, by the position that the names say, by position."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from wmrgen.robotfile.names import role
from wmrgen.tools.comparing.record import Side

_FILLER = re.compile(r"wheel|joint|link|hub|axle|[^a-z0-9]")
Key = Callable[[Side], set[str]]


def bare(name: str) -> str:
    """Return the part of a name that distinguishes a wheel: ``left`` of ``wheel_left_joint``."""
    return _FILLER.sub("", name.lower())


_KEYS: tuple[Key, ...] = (
    lambda w: {name.lower() for name in w.names},
    lambda w: {bare(name) for name in w.names} - {""},
    lambda w: {where} if (where := role(*w.names)) else set(),
)


def matched(a: Sequence[Side], b: Sequence[Side]) -> tuple[list[tuple[Side, Side]], list[Side], list[Side]]:
    """Return the pairs in the order of ``a``, and the wheels of either that have no partner.

    A key counts if it distinguishes a wheel from all others. The remaining wheels are matched by position, the nearest
    first.
    """
    partner: dict[int, int] = {}
    for key in _KEYS:
        for i, w in enumerate(a):
            free = [j for j in range(len(b)) if j not in partner.values()]
            candidates = [j for j in free if key(w) & key(b[j])]
            rivals = [k for k in range(len(a)) if k not in partner and key(w) & key(a[k])]
            if i not in partner and len(candidates) == 1 and rivals == [i]:
                partner[i] = candidates[0]
    near = sorted(
        (abs(a[i].pivot - b[j].pivot), i, j)
        for i in range(len(a))
        for j in range(len(b))
        if a[i].type == b[j].type and i not in partner and j not in partner.values()
    )
    for _, i, j in near:
        if i not in partner and j not in partner.values():
            partner[i] = j
    pairs = [(a[i], b[partner[i]]) for i in sorted(partner)]
    return (
        pairs,
        [w for i, w in enumerate(a) if i not in partner],
        [w for j, w in enumerate(b) if j not in partner.values()],
    )
