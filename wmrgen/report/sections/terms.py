"""What a formula is made of: terms, each a number and factors; how wide it is, and long sums on several lines."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.notation import Style


@dataclass(frozen=True, slots=True)
class Factor:
    """base**power. ``rank``: parameters 0, functions 1, velocities 2 (collected). ``order``: within a rank."""

    base: str
    power: int
    rank: int
    order: tuple[int, str]
    compound: bool = False  # the base is a sum

    def shown(self) -> str:
        """The factor with a positive power."""
        n = abs(self.power)
        base = rf"\left({self.base}\right)" if self.compound else self.base
        if n == 1:
            return base
        for f in (r"\cos", r"\sin"):
            if base.startswith(f) and not base.startswith(f + "("):
                return f"{f}^{{{n}}}{base.removeprefix(f)}"
        return f"{{{base}}}^{{{n}}}"


@dataclass(frozen=True, slots=True)
class Term:
    """number * product of factors. ``style``: how the sum it stands in writes numbers, see `notation.magnitude`."""

    number: Exact
    factors: tuple[Factor, ...]
    style: Style = ""


def merged(factors: Iterable[Factor]) -> tuple[Factor, ...]:
    """Powers of one base together."""
    by_base: dict[str, Factor] = {}
    for f in factors:
        by_base[f.base] = replace(f, power=f.power + by_base[f.base].power) if f.base in by_base else f
    return tuple(f for f in by_base.values() if f.power)


# ---- how wide LaTeX is, and long sums on several lines

_COMMAND, _UNSEEN = re.compile(r"\\[A-Za-z]+"), re.compile(r"[{}^_ \\,]")
WIDE = 80  # characters of a line before a sum is broken


def width(text: str) -> int:
    """Roughly how many characters a reader sees."""
    return len(_UNSEEN.sub("", _COMMAND.sub("x", text)))


def wrapped(parts: Sequence[str], limit: int = WIDE) -> str:
    """Signed summands on one line, or on several inside ``aligned``: each further line begins with a sign."""
    texts, used = [""], 0
    for part in parts:
        size = width(part)
        if used and used + size > limit:
            texts.append("")
            used = 0
        texts[-1] += part
        used += size
    texts[0] = texts[0].removeprefix("+")
    return "\\\\\n&\\qquad ".join(texts) or "0"
