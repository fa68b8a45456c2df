"""On which lines the C that is printed computes what: for the report, which never sees the C itself."""

from __future__ import annotations

import re
from collections.abc import Mapping

from wmrgen.backends.registry import Place

_FUNCTION = re.compile(r"^void (\w+)\(")
_NAMED = re.compile(r"^    const \w+ \w+ = .*; /\* (.+) \*/$")
_ABOVE = re.compile(r"^    /\* (.+) \*/$")
_STORED = re.compile(r"^    (?:\w+->|\*)([\w.]+) = ")


def places(files: Mapping[str, bytes]) -> tuple[Place, ...]:
    """Every function of ``<robot>.c``, among the files that `emit` gives."""
    file = min((name for name in files if name.endswith(".c")), key=len)  # the others have longer names
    return places_in(file, files[file].decode())


def places_in(file: str, source: str) -> tuple[Place, ...]:
    """Every function of a generated C file."""
    functions: list[Place] = []
    for number, line in enumerate(source.splitlines(), 1):
        begun, above = _FUNCTION.match(line), _ABOVE.match(line)
        named = above or _NAMED.match(line) or _STORED.match(line)
        if begun:
            functions.append(Place(file, begun[1], number, ()))
        elif named and functions:
            last, at = functions[-1], number + bool(above)
            functions[-1] = Place(file, last.function, last.line, (*last.quantities, (named[1], at)))
    return tuple(functions)
