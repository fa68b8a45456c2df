"""What a generated C file says about itself: the facts that every backend has, and how the C is written."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from wmrgen.backends.meta import Facts
from wmrgen.ir.kernels.choice import DEFAULT


@dataclass(frozen=True, slots=True)
class Meta(Facts):
    """`Facts`, with the options of C as attributes: ``scalar``, ``math`` and ``target``, see
    `wmrgen.ir.kernels.choice`. ``fuzz``: a fuzzing harness too."""

    scalar: str = DEFAULT.scalar
    math: str = DEFAULT.math
    target: str = DEFAULT.target
    fuzz: bool = False


def meta_of(facts: Facts) -> Meta:
    """``facts`` with their options, the usual ones where they have none."""
    if isinstance(facts, Meta):
        return facts
    shared: dict[str, Any] = {f.name: getattr(facts, f.name) for f in fields(Facts)}
    chosen: dict[str, Any] = dict(facts.options)
    return Meta(**shared, **chosen)
