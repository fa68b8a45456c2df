"""The mathematics of generated C that can be chosen: libm's, or kernels of its own."""

from __future__ import annotations

import importlib
import importlib.util
from dataclasses import fields

from wmrgen.backends.meta import Meta
from wmrgen.ir.nodes import Module

_KNOWN = {field.name for field in fields(Meta)}
MATHS = ("libm", "inline") if "math" in _KNOWN else ("libm",)
DEFAULT = MATHS[-1]


def meta(math: str = DEFAULT, scalar: str = "float") -> Meta:
    """How to print C with the mathematics ``math``."""
    return Meta(scalar=scalar, **({"math": math} if "math" in _KNOWN else {}))


def printed(module: Module, math: str = DEFAULT, scalar: str = "float") -> Module:
    """What the printed C computes: ``module`` with its kernels in the place of calls."""
    if importlib.util.find_spec("wmrgen.ir.kernels") is None:
        return module
    expanded: Module = importlib.import_module("wmrgen.ir.kernels").expand(module, scalar, math)
    return expanded
