"""Where generated C computes what its comments name: for the report, which never sees the C itself."""

from __future__ import annotations

import re
from dataclasses import dataclass

_FUNCTION = re.compile(r"^void (\w+)\(")
_NAMED = re.compile(r"^    const \w+ \w+ = .*; /\* (.+) \*/$")
_STORED = re.compile(r"^    out->([\w.]+) = ")


@dataclass(frozen=True, slots=True)
class Place:
    """A function of a C file: its line, and the lines of the quantities that it names."""

    function: str
    line: int
    quantities: tuple[tuple[str, int], ...]


def places(source: str) -> tuple[Place, ...]:
    """Every function of a generated C file."""
    found: list[Place] = []
    for number, line in enumerate(source.splitlines(), 1):
        begun, named = _FUNCTION.match(line), _NAMED.match(line) or _STORED.match(line)
        if begun:
            found.append(Place(begun[1], number, ()))
        elif named and found:
            last = found[-1]
            found[-1] = Place(last.function, last.line, (*last.quantities, (named[1], number)))
    return tuple(found)
