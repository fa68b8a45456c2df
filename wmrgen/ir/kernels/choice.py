"""How C is to be written: the scalar type, whose sines it uses, and for which processor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from wmrgen.errors import UsageError

SCALARS = ("float", "double")
LIBM, INLINE = MATHS = ("libm", "inline")
M4F, M0, AVR, HOST = TARGETS = ("m4f", "m0", "avr", "host")


class Choice(NamedTuple):
    """What ``--scalar``, ``--math`` and ``--target`` say.

    ``math``: ``inline`` (own float kernels) or ``libm``. ``target``: ``m4f`` has a fused multiply-add (Cortex-M4F,
    M7, M33, RISC-V F), ``m0`` no floating point, ``avr`` avr-libc; ``host`` is any FPU, without fmaf.
    """

    scalar: str = "float"
    math: str = INLINE
    target: str = M4F

    def words(self) -> dict[str, str]:
        """As a manifest notes it."""
        return {"scalar": self.scalar, "math": self.math, "target": self.target}


DEFAULT = Choice()


def choice(scalar: str = DEFAULT.scalar, math: str | None = None, target: str = DEFAULT.target) -> Choice:
    """A choice that exists: the kernels are float code, so double takes libm. UsageError for other words."""
    for word, words in ((scalar, SCALARS), (math or LIBM, MATHS), (target, TARGETS)):
        if word not in words:
            raise UsageError(f"{word!r} is none of {', '.join(words)}")
    if scalar == "double" and math == INLINE:
        raise UsageError("--math inline is for --scalar float: there are no kernels for double")
    return Choice(scalar, math or (INLINE if scalar == "float" else LIBM), target)


def noted(words: Mapping[str, str]) -> Choice:
    """The choice that a manifest notes; the usual one where it notes none."""
    options = {key: words[key] for key in ("scalar", "math", "target") if key in words}
    try:
        return choice(**options)
    except UsageError:
        return DEFAULT
