"""Cycles of the instructions of a Cortex-M4F, by its manual.

Arm Cortex-M4 Processor Technical Reference Manual (DDI 0439), tables 3-1 and 7-1. Not in them: waits for flash, and the
cycle that an instruction waits for the result of the one just before it.
"""

from __future__ import annotations

from wmrgen.ir.kernels.choice import M4F
from wmrgen.ir.kernels.cycles import CYCLES

FLOATS = CYCLES[M4F]
# Every instruction that is not here takes one cycle.
MEMORY = 2  # load or store; of several registers 1, and one for each
JUMP = 3  # a branch, taken: 1, and 2 to fill the pipeline
INTEGER_DIVIDE = 12  # at most


def cycles(first: int, second: int) -> int:
    """Return the cycles of the instruction that starts with the halfwords ``first`` and ``second``."""
    return _wide(first, second) if is_wide(first) else _narrow(first)


def is_wide(first: int) -> bool:
    """Return whether an instruction has four bytes; these start with 0b11101, 0b11110 or 0b11111."""
    return first >> 11 >= 0b11101


def _narrow(word: int) -> int:
    if word >> 11 == 0b01001 or word >> 12 == 0b0101 or word >> 13 in (0b011, 0b100):
        return MEMORY
    if word & 0xF600 == 0xB400:  # push, pop
        listed = (word & 0x1FF).bit_count()
        return listed + (JUMP if word & 0x0900 == 0x0900 else 1)
    if word >> 12 == 0b1100:  # several registers
        return 1 + (word & 0xFF).bit_count()
    jumps = word >> 12 == 0b1101 or word >> 11 == 0b11100 or word & 0xF500 == 0xB100 or word >> 8 == 0x47
    return JUMP if jumps else 1


def _wide(first: int, second: int) -> int:
    if first >> 9 == 0b1110110 and second & 0x0E00 == 0x0A00:
        return _floats_in_memory(first, second)
    if first >> 8 == 0xEE and second & 0x0E10 == 0x0A00:
        return _arithmetic(first, second)
    if first >> 9 == 0b1111100:
        return MEMORY
    if first >> 9 == 0b1110100:  # several registers, or two
        return 3 if first & 0x40 else 1 + second.bit_count()
    if first & 0xFFD0 == 0xFB90:
        return INTEGER_DIVIDE
    return JUMP if first >> 11 == 0b11110 and second >> 15 else 1


def _floats_in_memory(first: int, second: int) -> int:
    """Return the cycles of VLDR, VSTR, their forms for several registers, and moves of two registers."""
    if first & 0x0120 == 0x0100 or first & 0x01E0 == 0x0040:
        return MEMORY
    return 1 + (second & 0xFF)


def _arithmetic(first: int, second: int) -> int:
    kind = (first >> 5 & 0b100) | (first >> 4 & 0b11)  # bits 7, 5 and 4
    root = kind == 0b111 and first & 0xF == 1 and second >> 6 & 0b11 == 0b11
    if kind == 0b100 or root:
        return FLOATS.divide
    alone = {
        0b010: FLOATS.multiply,
        0b011: FLOATS.add,
        0b111: FLOATS.copy,
    }  # or absolute value, comparison and the like
    return alone.get(kind, FLOATS.fused)
