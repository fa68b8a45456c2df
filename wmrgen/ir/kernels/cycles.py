"""Cycles of float instructions from the manuals of processors, which decide where products are fused with sums."""

from __future__ import annotations

from typing import NamedTuple

from wmrgen.ir.kernels.choice import M4F


class Cycles(NamedTuple):
    """The cycles of float instructions."""

    add: int
    multiply: int
    fused: int  # fused multiply-add
    divide: int  # also the square root
    copy: int  # from one register to another


# Processors with a fused multiply-add. Arm Cortex-M4 Processor Technical Reference Manual (DDI 0439), table 7-1: VADD,
# VMUL, VFMA, VDIV and VSQRT, VMOV.
CYCLES = {M4F: Cycles(add=1, multiply=1, fused=3, divide=14, copy=1)}


def fused_pays(target: str, copied: bool = False) -> bool:
    """Return whether a fused multiply-add costs no more than a product and a sum.

    Each instruction costs its cycles, and one cycle more because it is fetched from flash.

    Args:
        target: the target of `Choice`; for one without the instruction the result is False.
        copied: whether the addend is needed again. The instruction overwrites it, so it is copied first.
    """
    if target not in CYCLES:
        return False
    cycles = CYCLES[target]
    together = cycles.fused + 1 + copied * (cycles.copy + 1)
    return together <= cycles.multiply + cycles.add + 2
