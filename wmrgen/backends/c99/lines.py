"""Where generated C computes what its comments name: for the report, which never sees the C itself."""

from __future__ import annotations

import re
from collections.abc import Mapping

from wmrgen.backends.meta import Place

_FUNCTION = re.compile(r"^void (\w+)\(")
_NAMED = re.compile(r"^    const \w+ \w+ = .*; /\* (.+) \*/$")
_STORED = re.compile(r"^    out->([\w.]+) = ")


def places(files: Mapping[str, bytes]) -> tuple[Place, ...]:
    """Every function of ``<robot>.c``, among the files that `emit` gives."""
    file = min((name for name in files if name.endswith(".c")), key=len)  # the others have longer names
    return places_in(file, files[file].decode())


def places_in(file: str, source: str) -> tuple[Place, ...]:
    """Every function of a generated C file."""
    functions: list[Place] = []
    for number, line in enumerate(source.splitlines(), 1):
        begun, named = _FUNCTION.match(line), _NAMED.match(line) or _STORED.match(line)
        if begun:
            functions.append(Place(file, begun[1], number, ()))
        elif named and functions:
            last = functions[-1]
            functions[-1] = Place(file, last.function, last.line, (*last.quantities, (named[1], number)))
    return tuple(functions)
