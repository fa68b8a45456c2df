"""How C is written: the scalar type, the source of its sines, and the processor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from wmrgen.errors import UsageError

SCALARS = ("float", "double")
LIBM, INLINE = MATHS = ("libm", "inline")
M4F, M0, AVR, HOST = TARGETS = ("m4f", "m0", "avr", "host")


class Choice(NamedTuple):
    """The options ``--scalar``, ``--math`` and ``--target``."""

    scalar: str = "float"  # or "double"
    math: str = INLINE  # "inline": our own float kernels, "libm": the C library
    # "m4f": an FPU with fused multiply-add (Cortex-M4F, M7, M33, RISC-V F); "m0": no floating point; "avr": avr-libc;
    # "host": any FPU, without fused multiply-add.
    target: str = M4F

    def words(self) -> dict[str, str]:
        """Return the options as a manifest has them."""
        return {"scalar": self.scalar, "math": self.math, "target": self.target}


DEFAULT = Choice()


def choice(scalar: str = DEFAULT.scalar, math: str | None = None, target: str = DEFAULT.target) -> Choice:
    """Return a choice of options.

    Args:
        scalar: "float" or "double".
        math: "inline" or "libm"; by default inline for float, and libm for double, for which there are no kernels.
        target: the processor.

    Raises:
        UsageError: an unknown word, or inline with double.
    """
    for word, words in ((scalar, SCALARS), (math or LIBM, MATHS), (target, TARGETS)):
        if word not in words:
            raise UsageError(f"{word!r} is not one of {', '.join(words)}")
    if scalar == "double" and math == INLINE:
        raise UsageError("--math inline is for --scalar float: there are no kernels for double")
    return Choice(scalar, math or (INLINE if scalar == "float" else LIBM), target)


def noted(words: Mapping[str, str]) -> Choice:
    """Return the choice that a manifest has; the default if it has none or an unknown one."""
    options = {key: words[key] for key in ("scalar", "math", "target") if key in words}
    try:
        return choice(**options)
    except UsageError:
        return DEFAULT
