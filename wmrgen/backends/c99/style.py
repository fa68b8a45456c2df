"""How C99 writes operations in a scalar type."""

from __future__ import annotations

from functools import cache, partial

from wmrgen.backends.c99.text import literal
from wmrgen.backends.expression import Style
from wmrgen.ir.ops import Choice, Op


@cache
def style(scalar: str) -> Style:
    """``scalar``: ``float`` (libm names end in f) or ``double``."""
    suffix = "f" if scalar == "float" else ""

    def form(op: Op) -> str:
        return op.c if isinstance(op.c, Choice) else op.c.replace("{f}", suffix)

    return Style(
        literal=partial(literal, scalar=scalar),
        form=form,
        declare="const {2} {0} = {1};",
        temporary="t{0}",
        grouped=True,
        scalar=scalar,
    )
