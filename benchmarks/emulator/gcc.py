"""GNU toolchains, if they are installed: newlib's libm, which firmware links, and processors other than Cortex-M4F."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.emulator.zig import CODE, DATA

FLAGS = ("-O2", "-std=c99", "-ffp-contract=off", "-fno-math-errno", "-ffunction-sections")
SMALL = ("-DWMRGEN_SMALL",)  # kernels are called, not inlined
_ARM = "arm-none-eabi-gcc"
_HARD = ("-mthumb", "-mfloat-abi=hard")


@dataclass(frozen=True)
class Processor:
    """What to compile with; ``target`` is wmrgen's word for it."""

    name: str
    compiler: str
    flags: tuple[str, ...]
    target: str

    @property
    def present(self) -> bool:
        return shutil.which(self.compiler) is not None

    @property
    def version(self) -> str:
        """Return name and version of the compiler, without the text of the packager."""
        done = subprocess.run(
            (self.compiler, "-dumpfullversion", "-dumpversion"), capture_output=True, text=True, check=True
        )
        return f"{self.compiler} {done.stdout.strip()}"


PROCESSORS = {
    "m0": Processor("Cortex-M0", _ARM, ("-mcpu=cortex-m0", "-mthumb"), "m0"),
    "m0+": Processor("Cortex-M0+", _ARM, ("-mcpu=cortex-m0plus", "-mthumb"), "m0"),
    "m4f": Processor("Cortex-M4F", _ARM, ("-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", *_HARD), "m4f"),
    "m33": Processor("Cortex-M33", _ARM, ("-mcpu=cortex-m33", "-mfpu=fpv5-sp-d16", *_HARD), "m4f"),
    "rv32": Processor(
        "RV32IMC", "riscv64-unknown-elf-gcc", ("-march=rv32imc", "-mabi=ilp32", "-ffreestanding"), "m0"
    ),
    "avr": Processor("ATmega328P", "avr-gcc", ("-mmcu=atmega328p",), "avr"),
}  # fmt: skip


def present() -> bool:
    """Return whether a toolchain with newlib is installed for the emulated processors."""
    return PROCESSORS["m4f"].present


def run(folder: Path, *command: str) -> None:
    """Run a compiler in ``folder``. RuntimeError with its output if it fails."""
    done = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)} failed:\n{done.stderr[:4000]}")


def build(
    folder: Path, sources: Sequence[str], name: str, processor: str = "m4f", flags: Sequence[str] = FLAGS
) -> Path:
    """Build a Cortex-M executable without an entry point from C files in ``folder``, with newlib's libm."""
    places = (f"-Wl,-Ttext={CODE:#x}", f"-Wl,-Tdata={DATA:#x}", "-Wl,-e,0", "-nostartfiles", "-I.")
    chosen = PROCESSORS[processor]
    libraries = ("-lm", "-lc", "-lgcc")
    run(folder, chosen.compiler, *chosen.flags, *flags, *places, *sources, "-o", name, *libraries)
    return folder / name
