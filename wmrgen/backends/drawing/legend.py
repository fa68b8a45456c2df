"""What the signs mean: one short line of symbols under the picture, for what occurs in it."""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.backends.drawing.svg import arrow, bar, circle, line, text
from wmrgen.wheels import WHEEL_TYPES, WheelType

_CHARACTER = 5.7  # mean width of a sans-serif character at 11.5 px, with reserve
_SYMBOL, _SPACE, ROW = 24.0, 14.0, 20.0


@dataclass(frozen=True, slots=True)
class Signs:
    """What occurs in the picture."""

    kinds: tuple[WheelType, ...]
    axles: bool
    icr: bool
    pivots: bool


def legend(signs: Signs, width: float, top: float) -> tuple[list[str], float]:
    """Lines of the legend, and its height."""
    x, y = 24.0, top
    lines: list[str] = []
    for kind, words in _entries(signs):
        size = _SYMBOL + len(words) * _CHARACTER + _SPACE
        if x + size > width - 16 and x > 24:
            x, y = 24.0, y + ROW
        lines += [*_symbol(kind, x + 8, y), text((x + _SYMBOL, y + 4), words, "key")]
        x += size
    return lines, y + ROW - top


def _entries(signs: Signs) -> list[tuple[str, str]]:
    entries = [(name, kind.noun) for name, kind in WHEEL_TYPES.items() if kind in signs.kinds]
    if any(kind.has_spin for kind in signs.kinds):
        entries.append(("roll", "positive rolling"))
    if signs.pivots:
        entries.append(("pivot", "pivot"))
    if any(kind.rollers for kind in signs.kinds):
        entries.append(("roller", "roller axis at the ground (on top: mirrored)"))
    if signs.axles:
        entries.append(("axle", "zero-motion line"))
    if signs.icr:
        entries.append(("icr", "instantaneous centre of rotation"))
    return entries


def _symbol(kind: str, x: float, y: float) -> list[str]:
    if kind in WHEEL_TYPES:
        glyph = WHEEL_TYPES[kind].glyph
        if glyph.ball:
            return [circle((x, y), 6, f"wheel {kind}"), circle((x, y), 1.4, "dot")]
        return [bar((x, y), (glyph.sign, 7), 2, 0, f"wheel {kind}")]
    if kind == "roll":
        return arrow((x - 8, y), (x + 9, y), "roll", 4.2)
    if kind == "pivot":
        return [circle((x, y), 3.2, "pivot")]
    if kind == "roller":
        return [line((x - 6, y + 5), (x + 6, y - 5), "roller")]
    if kind == "axle":
        return [line((x - 9, y), (x + 10, y), "axle")]
    return icr_mark((x, y))


def icr_mark(p: tuple[float, float]) -> list[str]:
    """The sign of the ICR."""
    return [circle(p, 5.5, "icr"), circle(p, 1.8, "icr-dot")]
