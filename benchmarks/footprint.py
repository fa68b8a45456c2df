"""Code size and stack of each function on processors whose GNU compilers are installed."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.emulator import gcc
from benchmarks.emulator.gcc import PROCESSORS, Processor
from benchmarks.emulator.image import Image
from benchmarks.emulator.zig import INCLUDE
from benchmarks.jobs import JOBS, derivations
from wmrgen.codegen.c import sources
from wmrgen.ir.kernels.choice import DEFAULT, Choice
from wmrgen.ir.nodes import Module

SHOWN = ("m0+", "m4f", "m33", "rv32", "avr")


@dataclass(frozen=True)
class Footprint:
    """``text``: bytes of code and constants; ``stack``: both with the functions of the same file, without libm's."""

    text: int
    stack: int
    own: int = 0  # bytes of the function alone

    def __str__(self) -> str:
        return f"{self.text} / {self.stack}"


def measure(
    modules: Sequence[Module],
    processor: Processor,
    math: str = DEFAULT.math,
    flags: Sequence[str] = gcc.FLAGS,
    small: bool = False,
) -> dict[str, Footprint]:
    """C function -> what it occupies; a kernel by the robot and its name. ``small``: kernels called, not inlined."""
    footprints: dict[str, Footprint] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for module in modules:
            header, source = sources(module, Choice(math=math, target=processor.target))
            (folder / f"{module.name}.h").write_text(header)
            (folder / f"{module.name}.c").write_text(source)
        files = [f"{module.name}.c" for module in modules]
        include = () if "avr" in processor.compiler else ("-isystem", str(INCLUDE))
        words = (*processor.flags, *flags, *(gcc.SMALL if small else ()), *include, "-fstack-usage", "-c")
        gcc.run(folder, processor.compiler, *words, *files)
        for module in modules:
            own: dict[str, Footprint] = {}
            symbols = Image(folder / f"{module.name}.o").symbols
            for line in (folder / f"{module.name}.su").read_text().splitlines():
                place, stack, kind = line.split("\t")
                assert kind in ("static", "dynamic,bounded"), line
                function = place.rpartition(":")[2]
                # gcc may give a kernel an argument that is the same in all calls: `wmrgen_sine.constprop.0`
                name = next(s for s in symbols if s == function or s.startswith(f"{function}."))
                size = symbols[name].size
                own[function.partition(".")[0]] = Footprint(size, int(stack), size)
            own |= _whole(module.name, (folder / f"{module.name}.c").read_text(), own, small)
            kernel = f"{module.name}: "  # robots have kernels of one name
            footprints |= {
                f"{kernel if name.startswith('wmrgen_') else ''}{name}": o for name, o in own.items()
            }
    return footprints


# What a function does where least flash is asked for, and else.
_WHERE_SMALL = re.compile(
    r"^#if defined\(WMRGEN_SMALL\)\n(.*?)^#else\n(.*?)^#endif\n", re.MULTILINE | re.DOTALL
)


def _whole(robot: str, source: str, footprints: Mapping[str, Footprint], small: bool) -> dict[str, Footprint]:
    """Add to each function the code of the functions that it calls, and the stack of the deepest one."""
    calls: dict[str, set[str]] = {}
    for text in _WHERE_SMALL.sub(r"\1" if small else r"\2", source).split("\n}\n"):
        name = re.search(rf"^(?:void|WMRGEN_(?:KERNEL|ONCE) \w+) ((?:{robot}|wmrgen)_\w+)\(", text, re.M)
        if name is not None and name[1] in footprints:
            called = re.findall(rf"\b((?:{robot}|wmrgen)_\w+)\(", text)
            calls[name[1]] = {k for k in called if k in footprints and k != name[1]}

    def every(name: str) -> set[str]:
        return calls.get(name, set()).union(*map(every, calls.get(name, ())))

    def depth(name: str) -> int:
        return footprints[name].stack + max(map(depth, calls.get(name, ())), default=0)

    return {
        name: Footprint(
            footprints[name].own + sum(footprints[k].own for k in every(name)),
            depth(name),
            footprints[name].own,
        )
        for name, inner in calls.items()
        if inner
    }


def table() -> Iterator[str]:
    """Yield the functions of `JOBS` in Markdown, with a column for each installed compiler."""
    there = [PROCESSORS[key] for key in SHOWN if PROCESSORS[key].present]
    if not there:
        yield "Bytes of code and stack: needs arm-none-eabi-gcc, riscv64-unknown-elf-gcc or avr-gcc."
        return
    modules = [derivations()[name].c_module for name in dict.fromkeys(job.robot for job in JOBS)]
    measured = [measure(modules, processor) for processor in there]
    versions = ", ".join(dict.fromkeys(processor.version for processor in there))
    yield f"Bytes of code / of stack, `{gcc.FLAGS[0]}`, {DEFAULT.math}: {versions}."
    yield "The functions of the same file that it calls are included, such as integer arithmetic without an FPU."
    yield ""
    yield from rows(there, measured)


def rows(there: Sequence[Processor], measured: Sequence[Mapping[str, Footprint]]) -> Iterator[str]:
    """Yield a row for each of `JOBS`."""
    yield from heading("layout", "function", there)
    for job in JOBS:
        cells = [str(footprints[f"{job.robot}_{job.function}"]) for footprints in measured]
        yield f"| {job.layout} | {job.function} | {' | '.join(cells)} |"


def heading(first: str, second: str, there: Sequence[Processor]) -> Iterator[str]:
    """Return the heading, with a column for each processor."""
    yield f"| {first} | {second} | {' | '.join(processor.name for processor in there)} |"
    yield f"|---|---|{'---:|' * len(there)}"


def total(footprints: Mapping[str, Footprint], robot: str) -> int:
    """Return the code size of all functions of ``robot`` [bytes]."""
    return sum(
        footprint.own
        for name, footprint in footprints.items()
        if name.startswith((f"{robot}_", f"{robot}: "))
    )
