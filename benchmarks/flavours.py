"""How generated C can be written: whose sines it uses, and for which processor."""

from __future__ import annotations

import importlib
import importlib.util
from dataclasses import fields

from wmrgen.backends.meta import Meta
from wmrgen.ir.nodes import Module

_KNOWN = {field.name for field in fields(Meta)}
MATHS = ("libm", "inline") if "math" in _KNOWN else ("libm",)
DEFAULT = MATHS[-1]


def _chosen(math: str, target: str) -> dict[str, str]:
    return {key: word for key, word in (("math", math), ("target", target)) if key in _KNOWN}


def meta(math: str = DEFAULT, scalar: str = "float", target: str = "m4f", size: bool = False) -> Meta:
    """What to print: ``math`` is libm's or wmrgen's own, ``target`` m4f, m0, avr or host; ``size``: the smallest."""
    return Meta(scalar=scalar, size=size, **_chosen(math, target))


def printed(module: Module, math: str = DEFAULT, scalar: str = "float", target: str = "m4f") -> Module:
    """What the printed C computes: ``module`` with its kernels in the place of calls."""
    if importlib.util.find_spec("wmrgen.ir.kernels") is None:
        return module
    expanded: Module = importlib.import_module("wmrgen.ir.kernels").expand(
        module, scalar, **_chosen(math, target)
    )
    return expanded
