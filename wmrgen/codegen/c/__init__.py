"""C99: ``<robot>.h`` and ``<robot>.c``, straight-line code over structs with named wheels.

In come functions with kernels (`ir.Module`) and the facts for headers; out go C files as bytes, and values computed by
the compiled C. No module here sees a formula or another back end.
"""

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
    """Compile the C and return the outputs of each request by contract name.

    Args:
        module: The functions.
        requests: Names of functions with their inputs.
        **words: Fields of `Choice`: scalar, math, target.

    Raises:
        EnvironmentFailure: There is no C compiler, or it fails.
    """
    from wmrgen.codegen.c.driver import evaluate_c

    return evaluate_c(module, requests, Choice(**words))


def compiled(module: Module, choice: Choice) -> Callable[[str, Mapping[str, Any]], dict[str, Any]]:
    """Compile the functions of ``module`` for arrays; see `wmrgen.codegen.c.driver.compiled`."""
    from wmrgen.codegen.c.driver import compiled

    return compiled(module, choice)


# ---- the lines of the printed C that compute named quantities: for the report, which does not see the C

_FUNCTION = re.compile(r"^void (\w+)\(")
_NAMED = re.compile(r"^    const \w+ \w+ = .*; /\* (.+) \*/$")
_ABOVE = re.compile(r"^    /\* (.+) \*/$")
_STORED = re.compile(r"^    (?:\w+->|\*)([\w.]+) = ")


def places(files: Mapping[str, bytes]) -> tuple[Place, ...]:
    """Return the lines of every function of ``<robot>.c``, one of the ``files`` that `emit` gives."""
    file = min((name for name in files if name.endswith(".c")), key=len)  # the others have longer names
    return places_in(file, files[file].decode())


def places_in(file: str, source: str) -> tuple[Place, ...]:
    """Return the lines of every function of the C file ``file`` with the text ``source``."""
    functions: list[Place] = []
    for number, line in enumerate(source.splitlines(), 1):
        head, above = _FUNCTION.match(line), _ABOVE.match(line)
        named = above or _NAMED.match(line) or _STORED.match(line)
        if head:
            functions.append(Place(file, head[1], number, ()))
        elif named and functions:
            last, at = functions[-1], number + bool(above)
            functions[-1] = Place(file, last.function, last.line, (*last.quantities, (named[1], at)))
    return tuple(functions)
