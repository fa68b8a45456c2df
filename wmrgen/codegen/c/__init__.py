"""C99: ``<robot>.h`` and ``<robot>.c``, straight-line code over structs with named wheels."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from wmrgen.codegen.c.emit import emit, sources
from wmrgen.codegen.registry import Place, Request
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module

__all__ = ["compiled", "emit", "evaluate", "places", "sources"]


def evaluate(module: Module, requests: Sequence[Request], **words: str) -> list[dict[str, float]]:
    """Outputs by contract name of each request, from the C of the `Choice` that ``words`` say, compiled."""
    from wmrgen.codegen.c.driver import evaluate_c

    return evaluate_c(module, requests, Choice(**words))


def compiled(module: Module, choice: Choice) -> Callable[[str, Mapping[str, Any]], dict[str, Any]]:
    """The functions of ``module`` over arrays, see `wmrgen.codegen.c.library.compiled`."""
    from wmrgen.codegen.c.library import compiled

    return compiled(module, choice)


# ---- on which lines the C that is printed computes what: for the report, which never sees the C itself

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
