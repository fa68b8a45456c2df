"""Cycles of float instructions, by the manuals of processors: what decides where products are fused with sums."""

from __future__ import annotations

from typing import NamedTuple

from wmrgen.ir.kernels.choice import M4F


class Cycles(NamedTuple):
    """What float instructions take. ``copy``: from one register to another."""

    add: int
    multiply: int
    fused: int  # multiply-add
    divide: int  # and root
    copy: int


# Processors with a fused multiply-add. Arm Cortex-M4 Processor Technical Reference Manual (DDI 0439), table 7-1: VADD,
# VMUL, VFMA, VDIV and VSQRT, VMOV.
CYCLES = {M4F: Cycles(add=1, multiply=1, fused=3, divide=14, copy=1)}


def fused_pays(target: str, copied: bool = False) -> bool:
    """Whether a fused multiply-add costs no more than a product and a sum, in cycles and in instructions together.

    An instruction is fetched from flash as well, so each counts as a cycle more.

    Args:
        target: of `Choice`; one without the instruction has no use for it.
        copied: whether the number that is added is needed again. The instruction overwrites it, so it is copied first.
    """
    if target not in CYCLES:
        return False
    cycles = CYCLES[target]
    together = cycles.fused + 1 + copied * (cycles.copy + 1)
    return together <= cycles.multiply + cycles.add + 2
