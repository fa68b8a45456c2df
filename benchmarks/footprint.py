"""Bytes of code and of stack of each function on processors whose GNU compilers are installed."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.emulator import gcc
from benchmarks.emulator.gcc import PROCESSORS, Processor
from benchmarks.emulator.image import Image
from benchmarks.emulator.zig import INCLUDE
from benchmarks.flavours import DEFAULT, meta
from benchmarks.jobs import JOBS, derivations
from wmrgen.backends.c99 import sources
from wmrgen.ir.nodes import Module

SHOWN = ("m0+", "m4f", "m33", "rv32", "avr")


@dataclass(frozen=True)
class Footprint:
    """``text``: bytes of code and constants; ``stack``: of the function itself, libm's not in it."""

    text: int
    stack: int

    def __str__(self) -> str:
        return f"{self.text} / {self.stack}"


def measure(
    modules: Sequence[Module],
    processor: Processor,
    math: str = DEFAULT,
    flags: Sequence[str] = gcc.FLAGS,
    size: bool = False,
) -> dict[str, Footprint]:
    """C function -> what it occupies."""
    found = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for module in modules:
            header, source = sources(module, meta(math, target=processor.target, size=size))
            (folder / f"{module.name}.h").write_text(header)
            (folder / f"{module.name}.c").write_text(source)
        files = [f"{module.name}.c" for module in modules]
        include = () if "avr" in processor.compiler else ("-isystem", str(INCLUDE))
        words = (*processor.flags, *flags, *include, "-fstack-usage", "-c")
        gcc.run(folder, processor.compiler, *words, *files)
        for module in modules:
            symbols = Image(folder / f"{module.name}.o").symbols
            for line in (folder / f"{module.name}.su").read_text().splitlines():
                place, stack, kind = line.split("\t")
                assert kind in ("static", "dynamic,bounded"), line
                function = place.rpartition(":")[2]
                found[function] = Footprint(symbols[function].size, int(stack))
    return found


def table() -> Iterator[str]:
    """The functions of `JOBS` in Markdown, a column for each compiler that is there."""
    there = [PROCESSORS[key] for key in SHOWN if PROCESSORS[key].present]
    if not there:
        yield "Bytes of code and stack: needs arm-none-eabi-gcc, riscv64-unknown-elf-gcc or avr-gcc."
        return
    versions = ", ".join(dict.fromkeys(processor.version for processor in there))
    yield f"Bytes of code / of stack, `{gcc.FLAGS[0]}`, {DEFAULT}: {versions}."
    yield ""
    yield f"| layout | function | {' | '.join(processor.name for processor in there)} |"
    yield f"|---|---|{'---:|' * len(there)}"
    modules = [derivations()[name].c_module for name in dict.fromkeys(job.robot for job in JOBS)]
    measured = [measure(modules, processor) for processor in there]
    for job in JOBS:
        cells = [str(found[f"{job.robot}_{job.function}"]) for found in measured]
        yield f"| {job.layout} | {job.function} | {' | '.join(cells)} |"
