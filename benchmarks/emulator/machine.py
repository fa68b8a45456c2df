"""A Cortex-M that calls one function at a time and counts what it executes."""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from unicorn import UC_ARCH_ARM, UC_HOOK_BLOCK, UC_HOOK_CODE, UC_MODE_MCLASS, UC_MODE_THUMB, Uc
from unicorn import arm_const as arm

from benchmarks.emulator.cycles import cycles, is_wide
from benchmarks.emulator.image import Image
from benchmarks.emulator.zig import DATA, STACK

FLASH, RAM, SYSTEM = (0, 0x0020_0000), (DATA, STACK - DATA), (0xE000_E000, 0x1000)
CPACR = 0xE000_ED88  # coprocessor access: without full access to 10 and 11 the FPU faults
RETURN = 0x001F_0000  # where a called function returns to
LIMIT = 50_000_000
_ARGUMENTS = (arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3)
Trap = tuple[int, Callable[..., float]]  # how many floats, and what is computed of them


def _bits(x: float) -> int:
    """Return a float as a word."""
    return int.from_bytes(struct.pack("<f", x), "little")


@dataclass(frozen=True)
class Run:
    """One call: ``instructions`` outside trapped functions and the ``cycles`` that a Cortex-M4F takes for them, how
    often each trap was called (``calls``).

    ``stack``: bytes, 0 unless looked at.
    """

    instructions: int
    stack: int
    calls: Mapping[str, int]
    cycles: int = 0


class Machine:
    """An image in a Cortex-M4F (``fpu``) or a Cortex-M0, memory and registers kept between calls.

    ``traps`` are functions of floats that the host computes in place of the image's own. An instruction that
    its IT block skips counts: it takes its cycle. Without ``counts`` calls are quick, their runs empty, and only the
    function ends them; with ``stack`` they are slow, as the stack pointer is looked at before every instruction.
    """

    def __init__(
        self,
        image: Image,
        traps: Mapping[str, Trap] | None = None,
        fpu: bool = True,
        counts: bool = True,
        stack: bool = False,
    ) -> None:
        self.image, self._fpu = image, fpu
        self._uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        self._uc.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4 if fpu else arm.UC_CPU_ARM_CORTEX_M0)
        for start, size in (FLASH, RAM, SYSTEM):
            self._uc.mem_map(start, size)
        for start, data in image.segments:
            self._uc.mem_write(start, data)
        if fpu:
            self._uc.mem_write(CPACR, struct.pack("<I", 0xF << 20))
        # (address, size) of a block -> its instructions and cycles
        self._weights: dict[tuple[int, int], tuple[int, int]] = {}
        self._count, self._cycles, self._lowest = 0, 0, STACK
        self._calls: Counter[str] = Counter()
        self._free: list[range] = []  # what the traps occupy
        for name, (arity, function) in (traps or {}).items():
            symbol = image.symbols[name]
            self._free.append(range(symbol.address, symbol.address + symbol.size))
            answer = partial(self._answer, name, arity, function)
            self._uc.hook_add(UC_HOOK_CODE, answer, begin=symbol.address, end=symbol.address)
        if counts:
            self._uc.hook_add(UC_HOOK_BLOCK, self._block)
        if stack:
            self._uc.hook_add(UC_HOOK_CODE, self._look)

    def _block(self, uc: Uc, address: int, size: int, data: object) -> None:
        weight = self._weights.get((address, size))
        if weight is None:
            weight = self._weights[address, size] = self._weigh(address, size)
        self._count += weight[0]
        self._cycles += weight[1]
        if self._count > LIMIT:
            uc.emu_stop()

    def _weigh(self, address: int, size: int) -> tuple[int, int]:
        """Return the number of instructions in a block, and their cycles."""
        if any(address in places for places in self._free):
            return 0, 0
        place, count, time = address, 0, 0
        while place < address + size:
            first = self._halfword(place)
            time += cycles(first, self._halfword(place + 2))
            place += 4 if is_wide(first) else 2
            count += 1
        return count, time

    def _look(self, uc: Uc, address: int, size: int, data: object) -> None:
        self._lowest = min(self._lowest, uc.reg_read(arm.UC_ARM_REG_SP))

    def _halfword(self, address: int) -> int:
        return int.from_bytes(self.read(address, 2), "little")

    def _answer(
        self,
        name: str,
        count: int,
        function: Callable[..., float],
        uc: Uc,
        address: int,
        size: int,
        data: object,
    ) -> None:
        self._calls[name] += 1
        registers = [arm.UC_ARM_REG_S0 + k for k in range(count)] if self._fpu else _ARGUMENTS[:count]
        arguments = struct.pack(f"<{count}I", *(uc.reg_read(r) & 0xFFFF_FFFF for r in registers))
        result = struct.pack("<f", function(*struct.unpack(f"<{count}f", arguments)))
        uc.reg_write(registers[0], int.from_bytes(result, "little"))

    def call(self, name: str, *arguments: int | float) -> Run:
        """Call a function with words and floats, as the procedure call standard passes them: floats in registers of
        their own where there are such, words that no register is left for on the stack."""
        uc = self._uc
        words = [x if isinstance(x, int) else _bits(x) for x in arguments if not self._own_register(x)]
        for k, x in enumerate(x for x in arguments if self._own_register(x)):
            uc.reg_write(arm.UC_ARM_REG_S0 + k, _bits(x))
        for register, value in zip(_ARGUMENTS, words, strict=False):
            uc.reg_write(register, value)
        beyond = words[len(_ARGUMENTS) :]
        bottom = STACK - (4 * len(beyond) + 7) // 8 * 8
        self.write(bottom, struct.pack(f"<{len(beyond)}I", *beyond))
        uc.reg_write(arm.UC_ARM_REG_SP, bottom)
        uc.reg_write(arm.UC_ARM_REG_LR, RETURN | 1)
        self._count, self._cycles, self._lowest = 0, 0, bottom
        self._calls.clear()
        uc.emu_start(self.image.symbols[name].address | 1, RETURN)
        if uc.reg_read(arm.UC_ARM_REG_PC) != RETURN:
            raise RuntimeError(f"{name} did not return within {LIMIT} instructions")
        return Run(self._count, bottom - self._lowest, dict(self._calls), self._cycles)

    def _own_register(self, argument: float) -> bool:
        return self._fpu and not isinstance(argument, int)

    def write(self, address: int, values: bytes) -> None:
        self._uc.mem_write(address, values)

    def read(self, address: int, size: int) -> bytes:
        return bytes(self._uc.mem_read(address, size))
